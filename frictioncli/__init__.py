"""Friction of a robot joint: from its torque logs to a judged model.

The stages that the command line offers are functions of :mod:`frictioncli.chain`;
the physics is in :mod:`frictioncli.model`, on plain arrays.
"""

__version__ = "0.1.0"
