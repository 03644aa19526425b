"""Effects that can be hidden in simulated logs, each by its own formula.

No formula here is taken from what a diagnosis tries: time is continuous, parameters are drawn off
any grid, and some effects are in no catalogue.
"""
