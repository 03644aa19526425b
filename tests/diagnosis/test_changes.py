"""Changes that last, recur or vanish: the whole diagnosis of simulated joints that have one."""

import json

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.extended_document import extended_model
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.documents.reload import reload
from frictioncli.diagnosis.documents.sentences import lasting_text
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects.history_text import history_text
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.changed_table import hours, middle, with_friction_step, with_payload
from tests.simulation.torque_table import simulate_torques
from tests.studies.blind_examined import examined
from tests.studies.blind_worlds import World

pytestmark = pytest.mark.slow


def days(count, seed=3):
    """Return days of a joint that is equation (16) of the motor temperature."""
    return simulate_torques(SynthesisSettings(seed=seed, runs=count, joint_kind="plain"))


def every_noon(table):
    return middle(table)


def first_noon(table):
    return middle(table) & (table["run"] == "day1").to_numpy()


def from_the_first_noon_on(table):
    return first_noon(table) | (table["run"] != "day1").to_numpy()


def at_hours_that_differ(table):
    moment = table["run"].astype(str).map({"day1": 1.2, "day2": 3.1, "day3": 2.2}).to_numpy()
    return hours(table) > moment


def on_the_second_day(table):
    return (table["run"] == "day2").to_numpy()


HELD = [
    (2, every_noon, True, "from 3.6 h on in every run"),
    (3, every_noon, True, "from 3.6 h on in every run"),
    (2, first_noon, False, "in run day1 from 3.7 h on"),
    (2, from_the_first_noon_on, True, "from 3.7 h of run day1 on"),
    (
        3,
        at_hours_that_differ,
        True,
        "in run day1 from 1.2 h on and in run day2 from 3.1 h on and in run day3 from 2.2 h on",
    ),
]
"""Days, when the change is there, whether it holds on the last day, and what is said of it."""

with_history = pytest.mark.parametrize(
    ("count", "there", "holds", "text"),
    [
        HELD[3],
        *(pytest.param(*HELD[number], marks=pytest.mark.long) for number in (0, 1, 2, 4)),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)


def found(table):
    """Return the diagnosis, and the history of its only cause in words."""
    diagnosis = diagnose_joint(table, "motor", "N·m", DiagnosisSettings())
    (cause,) = diagnosis.causes
    runs = (*diagnosis.runs, diagnosis.held_out)
    return diagnosis, cause, history_text(cause.fit.shape, diagnosis.base.all_runs, runs)


@with_history
def test_a_payload(count, there, holds, text):
    """10 N·m of gravity amplitude."""
    table = days(count)
    diagnosis, cause, when = found(with_payload(table, there(table), 10.0))
    assert (diagnosis.verdict, cause.effects) == ("named", ("payload_change",))
    assert cause.holds_on_new_run is holds
    assert when == text
    assert cause.fit.coefficients == pytest.approx([10.0, 0.0], abs=0.1)
    assert diagnosis.gain.after < 1.25 * diagnosis.floor


@pytest.mark.parametrize(
    ("count", "there", "holds", "text"), [HELD[2], pytest.param(*HELD[4], marks=pytest.mark.long)]
)
def test_a_step_of_friction(count, there, holds, text):
    """2 N·m, whose moments are resolved to a pair or two: a change that ends, and moments that
    differ. Histories are the payload's: every kind of them is above."""
    table = days(count)
    diagnosis, cause, when = found(with_friction_step(table, there(table), 2.0))
    assert (diagnosis.verdict, cause.effects) == ("named", ("step_change",))
    assert cause.holds_on_new_run is holds
    assert when == text
    (change,) = diagnosis.extension.effects[0].coefficients
    assert change == pytest.approx(2.0, abs=0.5)
    assert diagnosis.gain.after < 1.4 * diagnosis.floor


@pytest.mark.long
def test_a_payload_on_the_second_of_three_days():
    table = days(3)
    diagnosis, cause, when = found(with_payload(table, on_the_second_day(table), 10.0, 2.0))
    assert (diagnosis.verdict, cause.effects) == ("named", ("payload_change",))
    assert cause.holds_on_new_run is False
    assert when == "in run day2"
    assert cause.fit.coefficients == pytest.approx([10.0, 2.0], abs=0.1)
    assert diagnosis.gain.after < 1.25 * diagnosis.floor


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "name", "size"),
    [
        (with_payload, "payload_change", [6.0, 0.0]),
        (with_friction_step, "step_change", [3.0]),
    ],
)
def test_a_change_on_the_last_day_only(change, name, size):
    """It is found on the held-out run, so that the gain is no gain on data never seen."""
    table = days(2)
    table = change(table, on_the_second_day(table) & middle(table), size[0])
    diagnosis, cause, when = found(table)
    assert (diagnosis.verdict, cause.effects) == ("named", (name,))
    assert (cause.holds_on_new_run, cause.only_on_new_run) == (True, True)
    assert when == "in run day2 from 3.6 h on"
    assert cause.fit.coefficients == pytest.approx(size, abs=0.5)
    assert diagnosis.gain.basis == "within_run"
    assert diagnosis.gain.after < 1.25 * diagnosis.floor < diagnosis.gain.before
    settings = DiagnosisSettings()
    document = diagnosis_document(diagnosis, settings)
    (record,) = document.causes
    assert lasting_text(record, document) == (
        "Present in run day2 from 3.6 h on only: found and fitted on the held-out run (day2)."
    )
    extended = extended_document(diagnosis, fit_joint(table, {}, FitSettings(temperature="motor")))
    again = reload(table, document, extended_model(extended)).new
    squared = again.problem.squared(again.after["friction"], again.after["load"])
    assert np.sqrt(np.mean(squared)) == pytest.approx(diagnosis.gain.after)


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, 4])
def test_nothing_is_said_of_days_without_a_change(seed):
    diagnosis = diagnose_joint(days(2, seed), "motor", "N·m", DiagnosisSettings())
    assert diagnosis.causes == ()
    assert np.isfinite(diagnosis.floor)


@pytest.mark.long
def test_a_step_in_noise_that_drifts_is_structure_along_time():
    """Friction steps by 1.7 N·m on the held-out run, in noise that drifts by 0.5 N·m RMS.

    Friction that changes gradually, or in proportion, explains the run nearly as well.
    """
    world = World("single", "step_change", 1, size=1.0, protocol="enriched")
    row = examined(world, "")
    friction = [one for one in json.loads(str(row["causes_json"])) if one["kind"] == "friction"]
    structure = json.loads(str(row["structure_json"]))
    (hidden,) = json.loads(str(row["hidden_json"]))
    assert friction == []
    assert structure["axis"] == ["time"]
    assert structure["size"] == pytest.approx(hidden["on_new_run"], rel=0.15)
