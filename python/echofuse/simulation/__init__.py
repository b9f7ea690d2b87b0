"""Scenes, people, propagation and radar front-ends: raw data with ground truth."""
