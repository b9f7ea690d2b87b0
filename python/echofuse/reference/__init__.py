"""The specification: NumPy, float64, slow and obvious, written from the papers' equations. Never imports ``_core``."""
