"""Least-squares fits of base and effects to both channels."""
