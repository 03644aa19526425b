"""Friction of a robot joint: from its torque logs to a judged model.

Every command is a function in a module of its name in :mod:`frictioncli.stages`;
the physics is in :mod:`frictioncli.model`, on plain arrays.
"""

__version__ = "0.1.0"
