"""Names of the effects that studies hide: properties of the joint, not of the measurement."""

from frictioncli.effects import EFFECTS

EFFECT_NAMES: tuple[str, ...] = tuple(effect.name for effect in EFFECTS)
"""In the order of the catalogue."""
