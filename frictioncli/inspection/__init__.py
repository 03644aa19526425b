"""Inspection of logs: content, quality, sufficiency for each stage, and a first mapping file."""
