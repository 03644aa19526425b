"""Suggest a mapping file for a log with unknown columns, from their names and their values."""
