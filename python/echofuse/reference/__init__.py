"""The specification: NumPy, float64, slow and obvious, from the papers alone. Never imports ``_core``."""
