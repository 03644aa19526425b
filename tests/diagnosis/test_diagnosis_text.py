"""What the terminal says of a diagnosis."""

import pytest
from msgspec import structs

from frictioncli.diagnosis.documents.document import GainRecord
from frictioncli.diagnosis.documents.empirical_record import EmpiricalGainRecord, LocatedRecord
from frictioncli.diagnosis.documents.gain_text import worse_text
from frictioncli.diagnosis.documents.remainder_record import RemainderRecord
from frictioncli.diagnosis.documents.sentences import (
    empirical_text,
    lasting_text,
    size_text,
)
from frictioncli.diagnosis.documents.text import verdict_text
from frictioncli.diagnosis.search.effect_size import LACKING, TAKEN_BY_BASE
from tests.report.diagnosis_documents import cause, diagnosis

DELAY = cause(
    ["torque_delay"],
    kind="measurement",
    statement="The torque in these logs lags the position by 12 ms (11 to 13).",
    size=0.9,
    size_ci95=(0.8, 1.0),
)
STEP = cause(["step_change"], kind="friction", statement="Friction stepped by 1.2 N·m.")


def lines(**changed):
    return [line.strip() for line in verdict_text(diagnosis(**changed)).splitlines()]


def test_a_property_of_the_log_is_said_to_be_corrected():
    said = lines(causes=(DELAY,))
    assert said[1].startswith("measurement: torque_delay")
    assert said[1].endswith(
        "The torque in these logs lags the position by 12 ms (11 to 13); corrected."
    )
    assert said[2] == "size: 0.90 N·m (0.80 to 1.00) RMS in the friction; p-value 1e−09"


def test_a_change_that_did_not_last_says_when_it_was_there():
    document = diagnosis(sets=[["step_change"]])
    lost = cause(["step_change"], holds_on_new_run=False, when="in run day-1 from 3.1 h on")
    assert lasting_text(lost, document) == (
        "A change that did not last: present in run day-1 from 3.1 h on, absent on the held-out run"
        " (day-2)."
    )
    without = cause(["step_change"], holds_on_new_run=False)
    assert "present in run day-1, absent on" in lasting_text(without, document)
    kept = cause(["step_change"], holds_on_new_run=True, when="from 4.0 h on in every run")
    assert lasting_text(kept, document) == (
        "Present from 4.0 h on in every run, and also on the held-out run (day-2)."
    )
    assert lasting_text(STEP, document) == ""


def test_size_says_what_a_refit_of_the_base_model_would_leave():
    both = cause(["drift"], size=1.9, size_ci95=(1.5, 2.3), visible_size=0.8)
    document = diagnosis(torque_unit="A", load_unit="N·m")
    assert size_text(both, document) == (
        "1.9 A (1.5 to 2.3) RMS in the friction, of which 0.80 A would remain after refitting the"
        " base model"
    )
    assert "remain" not in size_text(cause(["drift"], size=1.0, visible_size=0.99), document)
    # a load channel is in N·m where the torque is a current
    assert size_text(cause(["dress_pack"], channel="load"), document).startswith("1.0 N·m RMS")


def test_what_is_not_named_is_listed_with_its_reason():
    small = cause(["drift"], standing="negligible", reason="below 0.23 N·m", size=0.12)
    said = lines(sets=[["stribeck"]], visible=(small,), margin=0.23)
    assert said[-4] == (
        "not named: drift, 0.12 N·m RMS in the friction, p-value 1e−09; too small to"
        " name: below 0.23 N·m"
    )
    assert said[-3] == "Effects below 0.23 N·m are not named (--margin)."
    assert "no cause is named" in lines(verdict="no_evidence", visible=(small,))
    assert "no cause found" in lines(verdict="no_evidence")


def test_what_is_left_is_said_with_size_and_axis():
    left = RemainderRecord(
        basis="new_run",
        rmse=1.38,
        noise_floor=0.67,
        size=1.21,
        axis="time",
        channel="friction",
        axis_size=0.95,
    )
    said = "\n".join(lines(sets=[["coulomb_temperature"]], remainder=left))
    assert (
        "Unexplained structure remains: on run day-2 the torque error of the extended model is"
        " 1.4 N·m (RMS), where noise alone is 0.67 N·m. Without the noise (difference of the"
        " squares) the error is 1.2 N·m; most of it, 0.95 N·m in the friction, varies with time."
    ) in said
    whole = structs.replace(left, axis="run")
    said = "\n".join(lines(sets=[["coulomb_temperature"]], remainder=whole))
    assert "0.95 N·m in the friction, is the same over the whole run." in said
    assert "Something is left" not in "\n".join(lines(sets=[["coulomb_temperature"]]))


def test_detectable_sizes_are_said():
    said = lines(detectable={"stribeck": 0.2, "run_in": None, "drift": 1.5})
    assert said[-1] == (
        "Smallest effects that would be named in 80 % of cases: 0.20 N·m RMS (Stribeck"
        " friction) to 1.5 N·m (drift)."
    )
    alone = lines(detectable={"stribeck": 0.2, "run_in": None})
    assert alone[-1] == (
        "Smallest effect that would be named in 80 % of cases: 0.20 N·m RMS (Stribeck friction)."
    )
    assert lines(detectable={"run_in": None})[-1] == (
        "The smallest size that would be named is not known for any effect."
    )


def test_detectable_sizes_of_friction_and_load_are_said_in_their_own_units():
    sizes = {"payload_change": 0.33, "dress_pack": 0.5, "stribeck": 0.02}
    assert lines(torque_unit="A", load_unit="N·m", detectable=sizes)[-1] == (
        "Smallest effects that would be named in 80 % of cases: 0.33 N·m RMS (payload change) to"
        " 0.50 N·m (dress pack) and 0.020 A RMS (Stribeck friction)."
    )


def test_what_would_settle_a_cause_is_not_taken_for_the_plan():
    said = lines(causes=(STEP,))
    assert f"settled by: {STEP.experiment}" in said
    assert said[-1].startswith("next: 'frictioncli plan'")
    assert not any(line.startswith("next:") for line in lines(verdict="no_evidence"))


def test_values_of_several_possible_effects_are_said_to_be_those_of_the_first():
    either = cause(["linear_viscous", "quadratic_drag"], statement="Drag grows to 0.2 N·m.")
    assert lines(causes=(either,))[1].endswith(": If linear viscous: Drag grows to 0.2 N·m.")


def test_what_the_base_takes_entirely_is_said():
    why = {"run_in": TAKEN_BY_BASE, "load_linear": LACKING, "velocity_exponent": TAKEN_BY_BASE}
    sizes = {"stribeck": 0.2} | dict.fromkeys(why)
    said = (
        "Cannot be distinguished from the base model with these data: run-in and velocity exponent."
    )
    assert lines(detectable=sizes, undetectable=why)[-1].endswith(
        f"N·m RMS (Stribeck friction). {said}"
    )
    assert lines(detectable=dict.fromkeys(why), undetectable=why)[-1].endswith(f"effect. {said}")


def test_the_larger_parts_of_an_empirical_term_are_told_with_their_sizes():
    parts = [
        LocatedRecord(axes=axes, channel=channel, size=size, ci95=(0.4, 0.7), share=share)
        for axes, channel, size, share in (
            (("position", "temperature"), "friction", 0.5, 0.7),
            (("speed",), "load", 0.3, 0.25),
            (("temperature",), "friction", 0.1, 0.05),
        )
    ]
    gain = EmpiricalGainRecord(
        size=0.6,
        size_kept_out=0.5,
        basis="kept_out_blocks",
        rmse_before=0.8,
        rmse_after=0.5,
        reduction=0.4,
        ci95=(0.3, 0.5),
        noise_floor=0.4,
        ranges={"position": (10.0, 90.0)},
        parts=tuple(parts),
    )
    assert (
        "It varies with angle and temperature in the friction (0.50 N·m RMS, 0.40 to 0.70) and"
        " speed in the load (0.30 N·m RMS, 0.40 to 0.70). It names no cause"
    ) in empirical_text(diagnosis(empirical=gain))
    assert empirical_text(diagnosis(discrepancy=gain)).startswith(
        "An empirical term for the smooth error that any model has reduces the misfit on pairs not"
        " used for fitting from 0.80 to 0.50 N·m (RMS): 40 % less (30 to 50). It names no cause"
    )


@pytest.mark.parametrize(
    ("ci95", "without_level", "said"),
    [
        ((-0.4, 0.1), (0.4, 0.3), ""),
        ((-0.4, -0.2), None, "The extended model is worse than the base model: do not use it."),
        (
            (-0.4, -0.2),
            (0.3, 0.4),
            "The extended model is worse than the base model: do not use it.",
        ),
        (
            (-0.4, -0.2),
            (0.4, 0.31),
            "The extended model is worse than the base model: do not use it. Apart from torque that"
            " is the same over the whole run it is better: 0.31 instead of 0.40 N·m.",
        ),
    ],
)
def test_a_model_that_is_surely_worse_is_said_to_be(ci95, without_level, said):
    """A day with another level of friction may hide what a cause gains."""
    gain = GainRecord(
        basis="new_run",
        rmse_before=0.5,
        rmse_after=0.6,
        reduction=-0.2,
        ci95=ci95,
        noise_floor=0.1,
        rmse_without_level=without_level,
    )
    (line,) = (one for one in lines(gain=gain) if one.startswith("extended model"))
    assert line.endswith(f"noise floor 0.1 N·m{said and '. '}{said}")
    assert worse_text(gain, "N·m") == said
