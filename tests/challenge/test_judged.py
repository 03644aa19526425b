"""What is right, what is wrong, and what was there already."""

import pytest

from frictioncli.challenge.judged import judged
from frictioncli.diagnosis.documents.document import (
    CauseRecord,
    DiagnosisDocument,
    SimulationRecord,
    StructureRecord,
)
from frictioncli.diagnosis.settings import DiagnosisSettings


def cause(*effects):
    return CauseRecord(
        effects=effects,
        probabilities=dict.fromkeys(effects, 1.0 / max(len(effects), 1)),
        channel="friction",
        claim="",
        equation="",
        parameters={},
        size=1.0,
        p_value=0.0,
        seen_in="speed",
        figure=None,
        experiment="",
    )


def diagnosis(*causes, axis=()):
    structure = None
    if axis:
        structure = StructureRecord(axis=axis, channel="friction", description="", size=1.0)
        causes = (*causes, cause())
    return DiagnosisDocument(
        joint=1,
        verdict="",
        causes=causes,
        structure=structure,
        gain=None,
        detectable={},
        simulation=SimulationRecord(rmse=1.0),
        torque_unit="N·m",
        runs=("day1",),
        held_out=None,
        settings=DiagnosisSettings(),
    )


CLEAN = diagnosis()


@pytest.mark.parametrize(
    ("before", "after", "in_set", "alone", "already", "wrong"),
    [
        (CLEAN, CLEAN, False, False, False, ()),
        (CLEAN, diagnosis(cause("stribeck")), True, True, False, ()),
        (CLEAN, diagnosis(cause("drift", "stribeck")), True, False, False, ()),
        (CLEAN, diagnosis(cause("drift")), False, False, False, ("drift",)),
        (
            CLEAN,
            diagnosis(cause("stribeck"), cause("drift", "run_in")),
            True,
            True,
            False,
            ("drift or run_in",),
        ),
        (diagnosis(cause("drift")), diagnosis(cause("drift", "run_in")), False, False, False, ()),
        (
            diagnosis(cause("stribeck", "drift")),
            diagnosis(cause("stribeck")),
            True,
            True,
            True,
            (),
        ),
        (CLEAN, diagnosis(axis=("speed",)), False, False, False, ()),
    ],
)
def test_a_listed_effect_is_right_where_it_is_named(before, after, in_set, alone, already, wrong):
    found = judged("stribeck", before, after)
    assert (found.in_set, found.alone, found.already) == (in_set, alone, already)
    assert found.wrong == wrong
    assert found.found is (in_set and not already)


@pytest.mark.parametrize(
    ("after", "in_set", "wrong"),
    [
        (diagnosis(axis=("speed",)), True, ()),
        (diagnosis(axis=("position", "speed")), False, ()),
        (diagnosis(cause("stribeck")), False, ("stribeck",)),
    ],
)
def test_an_unlisted_effect_is_right_where_its_axes_are_located(after, in_set, wrong):
    found = judged("speed_resonance", CLEAN, after)
    assert (found.in_set, found.wrong) == (in_set, wrong)
    assert judged("speed_resonance", after, after).already is in_set


def test_nothing_planted_makes_nothing_right_or_wrong():
    found = judged("none", diagnosis(cause("drift")), diagnosis(cause("drift")))
    assert found.names == ("drift",)
    assert not found.in_set
    assert not found.wrong
