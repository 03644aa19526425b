"""Samples: rows checked, put in time order, and written."""
