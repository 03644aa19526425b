"""The hidden temperature of the gear: estimated nonlinearly, against simpler rivals."""
