"""References of the stages in `signal/`: float64, from the formulas."""
