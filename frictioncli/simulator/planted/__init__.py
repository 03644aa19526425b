"""Effects that are planted in simulated logs, each by a law of its own.

No law is in the span of the effects that the diagnosis tries: formulas differ, time is continuous,
and some effects are in no catalogue.
"""
