"""Samples to pairs to torques: constant-speed segments, counter-directed pairs, separation."""
