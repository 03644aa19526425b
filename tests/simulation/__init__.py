"""Simulations that only tests and studies need."""
