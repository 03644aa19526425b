"""Deployment of a fitted joint: in Python, in C, in robot simulators, and as a table."""
