"""The friction model, equation (16) of the source paper, and its identification."""
