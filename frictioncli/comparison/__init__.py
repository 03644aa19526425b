"""Comparison of the runs of one joint on different days: changes, intervals and causes."""
