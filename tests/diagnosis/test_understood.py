"""Which causes lose their name to structure that no effect explains."""

from types import SimpleNamespace

import pytest

from frictioncli.diagnosis.search.understood import is_part
from frictioncli.effects import BY_NAME


def structure(size, *axes, channel="friction"):
    return SimpleNamespace(size=size, axes=axes, channel=channel)


@pytest.mark.parametrize(
    ("name", "unnamed", "expected"),
    [
        # along its own axis, more than a third of it
        ("stribeck", structure(0.4, "speed"), True),
        ("stribeck", structure(0.3, "speed"), False),
        ("stribeck", structure(5.0, "temperature"), False),
        # a step may be a part of anything that varies slowly, if that is larger
        ("step_change", structure(1.1, "temperature"), True),
        ("step_change", structure(0.9, "temperature"), False),
        ("step_change", structure(0.4, "time"), True),
        ("step_change", structure(5.0, "temperature", channel="load"), False),
        ("payload_change", structure(5.0, "temperature"), False),
        ("torque_delay", structure(5.0, "position"), False),
    ],
)
def test_a_cause_is_part_of_structure(name, unnamed, expected):
    assert is_part(BY_NAME[name], 1.0, unnamed) is expected
