"""What the simulated torque gets wrong: found, named, extended, and the gain measured."""
