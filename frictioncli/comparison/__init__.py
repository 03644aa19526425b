"""The same joint on different days: what changed, how sure that is, and what it looks like."""
