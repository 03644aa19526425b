"""Samples: rows converted, checked, put in the order of time, and written."""
