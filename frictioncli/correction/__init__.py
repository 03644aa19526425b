"""The temperature correction of Algorithm 3, simulated and evaluated."""
