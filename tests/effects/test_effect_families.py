"""Families that data cannot take apart."""

from frictioncli.effects import BY_NAME
from tests.effects.families import FAMILIES, families_of


def test_members_are_effects_and_texts_are_there():
    for family in FAMILIES:
        assert len(set(family.members)) == len(family.members) >= 2
        assert set(family.members) <= set(BY_NAME)
        assert family.reason.endswith(".")
        assert family.experiment.endswith(".")


def test_each_member_names_another_one_as_what_it_is_taken_for():
    for family in FAMILIES:
        for name in family.members:
            assert set(BY_NAME[name].confounders) & set(family.members)


def test_families_of_an_effect():
    assert [family.name for family in families_of("drift")] == ["slow change", "one thermal cycle"]
    assert families_of("position_ripple") == ()
