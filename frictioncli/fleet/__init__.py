"""Many joints: the chain for each, on the processors of this machine or of a cluster."""
