"""The specification: NumPy, float64, slow and obvious, from the papers' equations. Never imports ``_core``."""
