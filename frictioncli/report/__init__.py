"""Figures and the page that a user reads; the only importer of matplotlib."""
