"""Monitors of the inspection: statistics collected in one pass while a log is read."""
