"""Friction from any motion: regression of all samples of a moving joint, and its torques."""
