"""Channels of a log: recognising them by name and inferring their units from the values."""
