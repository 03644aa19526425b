"""Effects that are planted in simulated logs, each by a law of its own.

No law is taken from the effects that the diagnosis tries: time is continuous, parameters are drawn
off every search grid, and some effects are in no catalogue.
"""
