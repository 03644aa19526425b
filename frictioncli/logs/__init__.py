"""Logs to samples: the only place where units are converted."""
