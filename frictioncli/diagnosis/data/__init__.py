"""What a diagnosis works on: torques per pair, gravity, motion history, base models."""
