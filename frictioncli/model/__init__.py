"""The friction model (16) and its identification."""
