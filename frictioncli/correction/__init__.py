"""Temperature correction by Algorithm 3 and by a Kalman filter, simulated and evaluated."""
