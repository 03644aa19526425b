"""A fitted joint outside this program: online in Python, in C, in simulators, as a table."""
