"""What logs hold, how good they are, what they suffice for, and a first mapping file."""
