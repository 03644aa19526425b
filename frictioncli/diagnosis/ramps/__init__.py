"""Ramps of moves: evidence on inertia and on friction after a reversal."""
