"""Runs: which files belong together, what lies beside them, and opening them."""
