"""The next experiment: what to measure so that open questions of a diagnosis are settled."""
