"""Samples to pairs to torques: constant-velocity parts, counter-directed partners, separation."""
