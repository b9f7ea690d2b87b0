"""References of what runs beside a radar: float64, from the formulas."""
