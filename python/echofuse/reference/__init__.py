"""The specification: NumPy, float64, slow and obvious, from the equations. Never imports ``_core``."""
