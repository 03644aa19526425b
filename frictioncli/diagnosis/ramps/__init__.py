"""Ramps of moves: what they tell of inertia and of friction after a reversal."""
