"""Noise of pair means: spectra, likelihoods under each, and significance."""
