"""The page on simulated joints tells every nuisance, effect and axis, and no other."""

import re
from pathlib import Path

from frictioncli.simulator.nuisances.catalogue import NUISANCES
from frictioncli.simulator.planted.catalogue import EFFECTS
from frictioncli.simulator.settings import JOINT_KINDS

PAGE = (Path(__file__).parents[2] / "docs" / "simulation.md").read_text(encoding="utf-8")


def rows(section: str) -> dict[str, list[str]]:
    """Return the cells of a section's table rows by each name in their first cell."""
    text = PAGE.split(f"\n## {section}")[1].split("\n## ")[0]
    found = {}
    for line in text.splitlines():
        if line.startswith("| `"):
            first, *others = [cell.strip() for cell in line.strip("|").split("|")]
            found |= dict.fromkeys(re.findall(r"`(\w+)`", first), others)
    return found


def test_every_kind_of_joint_and_nuisance_is_told():
    assert tuple(rows("The joint")) == JOINT_KINDS
    assert set(rows("Nuisances")) == set(NUISANCES)


def test_every_effect_is_told_and_unlisted_ones_with_their_axes():
    told = rows("Effects")
    assert set(told) == set(EFFECTS)
    for name, effect in EFFECTS.items():
        if not effect.listed:
            assert told[name] == [", ".join(effect.axes)]
