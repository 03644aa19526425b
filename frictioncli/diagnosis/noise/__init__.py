"""Noise of pair means: covariance spectra, restricted likelihoods, and significance."""
