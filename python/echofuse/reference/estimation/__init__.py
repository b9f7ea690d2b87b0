"""Filters and decisions in float64: Kalman, assignment, resampling, mixtures."""
