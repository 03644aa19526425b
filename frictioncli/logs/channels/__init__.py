"""Channels of a log: their names, their units, and how these are inferred."""
