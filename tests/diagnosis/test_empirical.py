"""The empirical term for what has no name: what it gains, where it is valid, when it is used."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli import documents
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.apply_extension import friction_beyond
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument, extended_model
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.documents.structure_record import structure_record
from frictioncli.diagnosis.documents.text import verdict_text
from frictioncli.diagnosis.empirical.describe import described
from frictioncli.diagnosis.empirical.estimate import empirical_term
from frictioncli.diagnosis.empirical.next_experiment import experiment
from frictioncli.diagnosis.empirical.on_new_run import structure_on_new_run
from frictioncli.diagnosis.empirical.random_functions import functions_of
from frictioncli.diagnosis.empirical.term import (
    EmpiricalTerm,
    FormFunction,
    SmoothFunction,
    validity,
)
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.extension import extend, misfits
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import TableError
from frictioncli.model.fitting import fit_joint
from frictioncli.model.late_torque import FREED
from frictioncli.model.settings import FitSettings
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.dense_noise import problem
from tests.simulation.torque_table import simulate_torques

MARGIN = 0.2
SETTINGS = DiagnosisSettings()
RANGES = {
    "position": (0.0, 100.0),
    "speed": (10.0, 100.0),
    "temperature": (20.0, 60.0),
    "load": (0.0, 90.0),
}
NOTHING = GravityCoefficients(cosine=0.0, sine=0.0, offset=0.0)
SECOND = SmoothFunction(
    axes=("position",), channel="friction", orders=(2,), coefficients=(0.0, 1.5)
)
TERM = EmpiricalTerm(functions=(SECOND,), ranges=RANGES, base_changes={}, gravity_changes=NOTHING)


def hump(rows):
    """Friction that is higher about 70 deg; no effect of the catalogue, broad enough to be seen."""
    return 2.0 * np.exp(-np.square((rows.position - 70.0) / 22.0) / 2)


def found(data, new=None):
    step = Step.of(Precomputed.of(data), [])
    beside = extend(data, step.predicting_fit(), [])
    judged = None if new is None else (new, lambda one: one)
    return empirical_term(step, (data, beside), judged, margin=MARGIN, floor=0.3, seed=0)


def test_it_predicts_another_day_as_well_as_the_law_does():
    """Gain beside that of knowing the law: the misfit without the hump is the noise."""
    seen, new = problem(3, friction=hump), problem(4, friction=hump)
    empirical = found(seen, new)
    without = problem(4)
    best = np.sqrt(np.mean(without.squared(without.friction_misfit, without.load_misfit)))
    assert empirical.gain.basis == "new_run"
    gained = empirical.gain.before**2 - empirical.gain.after**2
    assert gained > 0.8 * (empirical.gain.before**2 - best**2)


def test_where_nothing_is_there_it_is_not_used():
    assert all(found(problem(seed)) is None for seed in (3, 5, 6))


def test_what_does_not_recur_on_the_new_run_is_not_used():
    assert found(problem(3, friction=hump)) is not None
    assert found(problem(3, friction=hump), problem(4)) is None


def spot(rows):
    """Friction at a spot: the base of one short day has no place for it."""
    return 2.0 * np.exp(-np.square((rows.position - 70.0) / 10.0) / 2)


@pytest.mark.parametrize(
    ("level", "slope", "axis"), [(0.1, 0.0, None), (2.5, 0.0, "time"), (0.0, 0.2, "temperature")]
)
def test_a_model_that_misses_a_new_run_by_far_more_than_noise_lacks_something(level, slope, axis):
    """A day with other grease: its own base would take what the base of the day before misses."""

    def other(temperature):
        return level + slope * (temperature - 40.0)

    seen = problem(3, every=16)
    new = problem(4, every=16, friction=lambda rows: other(rows["motor_temperature"]))
    step = Step.of(Precomputed.of(seen), [])
    extension = extend(seen, step.predicting_fit(), [])
    alike = problem(4, every=16)
    noise = np.sqrt(np.mean(alike.squared(*misfits(alike, extension))))
    begun = structure_on_new_run(step, [], (new, extension), margin=MARGIN, floor=noise, seed=0)
    if axis is None:
        assert begun is None
        return
    structure, empirical = begun
    assert (structure.axes, structure.channel, empirical) == ((axis,), "friction", None)
    assert structure.only_on == new.runs[-1]
    torque = other(new.table.temperature)
    varying = torque if axis == "time" else torque - np.mean(torque)
    assert structure.size == pytest.approx(np.sqrt(np.mean(np.square(varying))), rel=0.15)
    assert structure.interval[0] < structure.size < structure.interval[1]


@pytest.mark.parametrize("measured", [True, False])
def test_the_model_lacks_nothing_at_temperatures_that_only_the_new_run_has(measured):
    """Stiff grease below 38 °C, where the other runs were never, or were without it."""
    seen = problem(3, every=16)
    if not measured:
        seen = seen.part(seen.table.temperature > 36.0)
    new = problem(
        4, every=16, friction=lambda rows: 0.5 * np.maximum(38 - rows.motor_temperature, 0)
    )
    step = Step.of(Precomputed.of(seen), [])
    extension = extend(seen, step.predicting_fit(), [])
    begun = structure_on_new_run(step, [], (new, extension), margin=MARGIN, floor=0.3, seed=0)
    if measured:
        structure, empirical = begun
        assert (structure.axes, structure.channel, empirical) == (
            ("temperature",),
            "friction",
            None,
        )
        assert structure.only_on == new.runs[-1]
    else:
        assert begun is None


@pytest.mark.parametrize(
    ("before", "day", "expected"),
    [(None, None, None), (spot, spot, ("position",)), (None, spot, ("position",))],
)
def test_what_the_new_run_has_is_located_and_described_where_it_begins(before, day, expected):
    seen, new = problem(3, every=16, friction=before), problem(4, every=16, friction=day)
    step = Step.of(Precomputed.of(seen), [])
    extension = extend(seen, step.predicting_fit(), [])
    begun = structure_on_new_run(step, [], (new, extension), margin=MARGIN, floor=0.3, seed=0)
    assert (begun and begun[0].axes) == expected
    if before is not None:
        structure, empirical = begun
        assert (structure.only_on, empirical) == ("", None)
    elif begun is not None:
        structure, empirical = begun
        assert structure.only_on == new.runs[-1]
        assert empirical.gain.basis == "within_run"
        (form,) = empirical.term.forms
        assert form.shape["centre"] == pytest.approx(70.0, abs=1.0)
        assert form.coefficients["peak"] == pytest.approx(2.0, rel=0.3)
        # the base, fitted to runs that lack it, has no part of it; without it the misfit is noise
        without = problem(4, every=16)
        left = misfits(without, extension)
        noise = np.sqrt(np.mean(without.squared(*left)))
        gained = empirical.gain.before**2 - empirical.gain.after**2
        assert gained > 0.7 * (empirical.gain.before**2 - noise**2)


def test_all_of_what_begins_on_the_new_run_counts_as_no_base_has_taken_a_part():
    """A broad bump, a part of which is a constant, which that day's own base would take."""

    def law(rows):
        return 2.5 * np.exp(-np.square((rows.position - 65.0) / 11.0) / 2)

    seen, new = problem(3, every=16), problem(4, every=16, friction=law)
    step = Step.of(Precomputed.of(seen), [])
    extension = extend(seen, step.predicting_fit(), [])
    _, empirical = structure_on_new_run(
        step, [], (new, extension), margin=MARGIN, floor=0.3, seed=0
    )
    (form,) = empirical.term.forms
    assert form.coefficients["peak"] == pytest.approx(2.5, rel=0.1)
    assert empirical.size == pytest.approx(np.sqrt(np.mean(np.square(law(new.table)))), rel=0.1)
    without = problem(4, every=16)
    noise = np.sqrt(np.mean(without.squared(*misfits(without, extension))))
    gained = empirical.gain.before**2 - empirical.gain.after**2
    assert gained > 0.9 * (empirical.gain.before**2 - noise**2)


@pytest.mark.parametrize("or_load", [pytest.param(False, marks=pytest.mark.long), True])
def test_forms_of_the_load_count_where_the_angle_does_not_tell_it(or_load):
    """Of structure that both explain alike; a peak at a load is at two angles."""
    data = problem(3, friction=lambda rows: 2.5 / np.cosh((np.abs(rows.load_torque) - 40.0) / 6.0))
    step = Step.of(Precomputed.of(data), [])
    along = Structure(
        axes=("position",),
        channel="friction",
        p_value=0.0,
        statistic=900.0,
        size=0.8,
        interval=(0.7, 0.9),
        or_load=or_load,
    )
    empirical = empirical_term(
        step,
        (data, extend(data, step.predicting_fit(), [])),
        None,
        margin=MARGIN,
        floor=0.3,
        seed=0,
        structure=along,
    )
    axes = {axis for form in empirical.term.forms for axis in form.axes}
    assert ("load" in axes) is or_load


def test_columns_are_what_the_base_leaves_and_the_term_is_their_sum():
    """The term, less its changes of the base, from its stated coefficients alone."""
    data = problem(3, friction=hump)
    step = Step.of(Precomputed.of(data), [])
    functions = functions_of(
        data, step.precomputed.discrepancy.components, step.fit.variances.amplitude
    )
    base = np.vstack(base_rows(data))
    for one in functions:
        inner = base.T @ one.columns
        bound = np.outer(np.linalg.norm(base, axis=0), np.linalg.norm(one.columns, axis=0))
        assert np.max(np.abs(inner) / bound) < 1e-6
    empirical = found(data)
    added = empirical.term.at(data)
    before = misfits(data, extend(data, step.predicting_fit(), []))
    without = replace(data, friction=data.friction - added.friction, load=data.load - added.load)
    again = extend(without, step.predicting_fit(), [])
    # what is left without it has the base that it is added to, within far less than its errors
    apart = np.abs(again.changes - empirical.without.changes)
    assert (apart < 0.02 * empirical.beside.errors[:5]).all()
    assert np.std(misfits(without, again)[0]) < 0.7 * np.std(before[0])


def test_it_is_a_series_of_cosines_over_the_range():
    data = problem(3)
    place = data.table.position / 100.0
    inside = place <= 1.0
    table = replace(data.table, load=0 * place, speed=0 * place + 50, temperature=0 * place + 40)
    added = TERM.at(replace(data, table=table))
    expected = 1.5 * np.cos(2 * np.pi * place)
    assert added.friction[inside] == pytest.approx(expected[inside])
    assert not added.load.any()


@pytest.mark.parametrize(
    ("axis", "values"),
    [
        ("position", [-10.0, -5.0, 0.0, 100.0, 105.0, 110.0, 150.0]),
        ("temperature", [16.0, 18.0, 20.0, 60.0, 62.0, 64.0, 90.0]),
        ("load", [0.0, -90.0, 0.0, 90.0, 94.5, -99.0, 200.0]),
        (
            "speed",
            [10 / 10**0.1, 10 / 10**0.05, 10.0, 100.0, 100 * 10**0.05, 100 * 10**0.1, 400.0],
        ),
    ],
)
def test_outside_what_was_measured_it_fades_to_nothing_within_a_tenth_of_the_range(axis, values):
    table = problem(3).table
    here = {"position": 50.0, "speed": 50.0, "temperature": 40.0, "load": 40.0}
    rows = {name: np.full(len(table.speed), value) for name, value in here.items()}
    rows[axis][: len(values)] = values
    share = validity(replace(table, **rows), RANGES)
    ends = [1.0, 1.0] if axis == "load" else [0.0, 0.5]
    assert share[:7] == pytest.approx([*ends, 1.0, 1.0, 0.5, 0.0, 0.0], abs=1e-9)
    assert (share[7:] == 1.0).all()


@pytest.mark.parametrize(
    "changed",
    [
        {"ranges": {}},
        {"ranges": RANGES | {"speed": (0.0, 100.0)}},
        {"ranges": RANGES | {"position": (5.0, 5.0)}},
        {"functions": (replace(SECOND, orders=(3,)),)},
        {"functions": (replace(SECOND, axes=("load",)),)},
    ],
)
def test_a_term_that_is_no_function_is_refused(changed):
    TERM.check()
    with pytest.raises(TableError, match="empirical"):
        replace(TERM, **changed).check()


def test_a_bump_in_a_late_torque_is_described():
    """3 N·m at 62 deg, 7 deg wide, 40 ms late: in both channels."""

    def late(way):
        def torque(rows):
            away = rows.position - way * 0.04 * rows.speed - 62.0
            return 3.0 * np.exp(-np.square(away / 7.0) / 2)

        return torque

    both = [late(1), late(-1)]
    data = problem(
        3,
        friction=lambda rows: (both[0](rows) + both[1](rows)) / 2,
        load=lambda rows: (both[0](rows) - both[1](rows)) / 2,
    )
    (part,) = found(data).parts
    assert part.form.kind == "bump"
    assert part.form.shape["centre"] == pytest.approx(62.0, abs=0.3)
    assert part.form.shape["width"] == pytest.approx(7.0, rel=0.05)
    assert part.form.shape["lag"] == pytest.approx(0.04, rel=0.1)
    assert part.form.coefficients["peak"] == pytest.approx(3.0, rel=0.05)
    assert "Move through 41" in experiment(part.form)
    assert "to 82" in experiment(part.form)
    assert described(part.form, "N·m") == (
        f"a bump of friction of {part.form.coefficients['peak']:.1f} N·m at"
        f" {part.form.shape['centre']:.1f} deg, {part.form.shape['width']:.1f} deg wide (standard"
        f" deviation), in a torque that is logged {1e3 * part.form.shape['lag']:.0f} ms late"
    )
    # beside another delay a reader must learn which is which
    both_stated = described(part.form, "N·m", delay_is_stated=True)
    assert both_stated.startswith(described(part.form, "N·m"))
    assert "by this form alone" in both_stated
    at_once = replace(part.form, shape=part.form.shape | {"lag": 0.0})
    assert described(at_once, "N·m", delay_is_stated=True) == described(at_once, "N·m")


@pytest.mark.parametrize(
    ("law", "axes", "shape"),
    [
        (
            lambda rows: -2.0 * np.exp(-np.square((np.abs(rows.load_torque) - 40.0) / 8.0) / 2),
            ("load",),
            {"centre": (40.0, 2.0), "width": (8.0, 2.0)},
        ),
        (
            lambda rows: 5.0 * np.exp(-np.square((rows.motor_temperature - 45.0) / 3.0) / 2),
            ("temperature",),
            {"centre": (45.0, 1.0)},
        ),
    ],
    ids=["dent in the load", "peak in the temperature"],
)
def test_forms_are_found_with_their_places(law, axes, shape):
    (part,) = found(problem(3, friction=law)).parts
    assert (part.axes, part.channel) == (axes, "friction")
    for name, (value, within) in shape.items():
        assert part.form.shape[name] == pytest.approx(value, abs=within)
    low, high = part.interval
    assert low < part.size < high


def test_a_switch_at_a_temperature_is_described():
    """A logistic step of 3 N·m at 42 °C, as where a fan goes on."""
    data = problem(
        3, friction=lambda rows: -3.0 / (1 + np.exp(-(rows.motor_temperature - 42.0) / 0.8))
    )
    (part,) = found(data).parts
    assert part.form.kind == "step"
    assert part.form.shape["centre"] == pytest.approx(42.0, abs=0.5)
    assert part.form.coefficients["step"] == pytest.approx(-3.0, rel=0.15)
    assert "friction that falls by" in described(part.form, "N·m")
    assert "switches" in experiment(part.form)


@pytest.mark.parametrize("sizes", [(3.0, 6.0), pytest.param((5.0, 5.0), marks=pytest.mark.long)])
def test_two_laws_at_once_are_described_one_after_the_other(sizes):
    """A narrow bump at 57 deg, whose place lies between those tried, and a peak at 45 °C."""

    def law(rows):
        away = np.clip(np.abs(rows.position - 57.0) / 13.0, 0, 1)
        warm = 1 / np.cosh((rows.motor_temperature - 45.0) / 2.5)
        return sizes[0] * (1 + np.cos(np.pi * away)) / 2 + sizes[1] * warm

    parts = found(problem(3, friction=law)).parts
    by_axes = {part.axes: part.form for part in parts}
    assert set(by_axes) == {("position",), ("temperature",)}
    assert by_axes["position",].shape["centre"] == pytest.approx(57.0, abs=0.6)
    assert by_axes["position",].coefficients["peak"] == pytest.approx(sizes[0], rel=0.15)
    assert by_axes["temperature",].shape["centre"] == pytest.approx(45.0, abs=0.6)
    # so few pairs hardly tell a broad peak from drift, but that it rises
    assert by_axes["temperature",].coefficients["peak"] > 0.4 * sizes[1]


@pytest.mark.parametrize(("size", "is_structure"), [(0.8, False), (2.0, True)])
def test_free_functions_no_larger_than_any_joint_has_predict_and_are_no_structure(
    size, is_structure
):
    """On two days alike, of an RMS of 0.7 % of friction and of 1.8 %; what any has is 0.75 %."""

    def law(rows):
        angle, speed = np.radians(rows.position), np.log(rows.speed / 40.0)
        return size * np.sin(5 * angle) * np.sin(2.5 * speed + 0.5)

    seen, new = problem(3, friction=law), problem(4, friction=law)
    planted = seen.friction - problem(3).friction
    share = np.sqrt(np.mean(np.square(planted))) / np.mean(seen.friction)
    assert (share < SHARE) is not is_structure
    empirical = found(seen, new)
    assert empirical.is_structure is is_structure
    without = problem(4)
    noise = np.mean(without.squared(without.friction_misfit, without.load_misfit))
    before, after = np.square([empirical.gain.before, empirical.gain.after])
    assert before - after > 0.6 * (before - noise)


def test_a_peak_between_four_speeds_is_located_only():
    """Friction that falls below the fastest but one is as likely."""
    data = problem(
        3, friction=lambda rows: 2.0 * np.exp(-np.square(np.log(rows.speed / 70.0) / 0.3) / 2)
    )
    empirical = found(data)
    assert len(np.unique(data.table.speed)) == 4
    assert not empirical.term.forms
    assert empirical.parts[0].axes == ("speed",)


def test_what_no_form_describes_is_located_only():
    """Friction that goes up and down over angle and speed in no simple way."""

    def law(rows):
        angle, speed = np.radians(rows.position), np.log(rows.speed / 40.0)
        return 2.0 * np.sin(5 * angle) * np.sin(2.5 * speed + 0.5)

    empirical = found(problem(3, friction=law))
    assert not empirical.term.forms
    assert empirical.parts[0].axes == ("position", "speed")
    assert sum(part.share for part in empirical.parts) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "changed",
    [
        {"kind": "spline"},
        {"axes": ("speed",)},
        {"channel": "torque"},
        {"shape": {"centre": 1.0}},
        {"coefficients": {"height": 1.0}},
    ],
)
def test_a_form_that_is_unknown_is_refused(changed):
    form = FormFunction(
        kind="bump",
        axes=("position",),
        channel="friction",
        shape={"centre": 50.0, "width": 5.0, "lag": 0.0},
        coefficients={"peak": 1.0},
        formula="",
    )
    form.check()
    with pytest.raises(TableError, match="empirical"):
        replace(form, **changed).check()


@pytest.fixture(scope="module")
def diagnosed():
    """Two days of a joint with a law that no catalogue lists, and its diagnosis."""
    rows = simulate_torques(
        SynthesisSettings(
            seed=7, joint_kind="plain", effects=("position_temperature:1.0",), highest=45
        )
    )
    rows = rows.assign(load=np.nan)
    return rows, diagnose_joint(rows, "motor", "N·m", SETTINGS)


@pytest.mark.slow
def test_documents_and_text_say_what_it_gains(diagnosed):
    rows, diagnosis = diagnosed
    document = diagnosis_document(diagnosis, SETTINGS)
    assert document.empirical.basis == "new_run"
    assert document.empirical.reduction > 0.25
    (part,) = document.empirical.forms
    assert part.axes == document.structure.axis == ("position", "temperature")
    assert part.formula == document.structure.formula
    assert "2 times per turn" in document.structure.description
    (unnamed,) = [cause for cause in document.causes if not cause.effects]
    assert "three constant temperatures" in unnamed.experiment
    assert document.empirical.rmse_after < 0.8 * document.empirical.rmse_before
    assert "An empirical term for the unexplained part" in verdict_text(document)
    assert "no cause" in verdict_text(document)
    low, high = document.empirical.ranges["temperature"]
    assert low == rows.loc[rows["run"] != diagnosis.held_out, "motor_temperature"].min()
    assert low < high


@pytest.mark.slow
def test_structure_says_all_that_it_depends_on(diagnosed):
    """A form of the angle alone, of structure that changes with the temperature, on one run."""
    _, diagnosis = diagnosed
    (part,) = diagnosis.empirical.parts
    of_angle = replace(diagnosis.empirical, parts=(replace(part, axes=("position",)),))
    found = structure_record(replace(diagnosis, empirical=of_angle))
    assert found.axis == ("position", "temperature")
    assert "an amount that changes with the temperature" in found.description
    only = replace(diagnosis.structure, only_on="monday")
    found = structure_record(replace(diagnosis, structure=only))
    assert found.axis == ("position", "temperature", "time")
    assert found.description.endswith(", on run monday only.")


@pytest.mark.slow
def test_the_extended_model_as_it_is_read_back_predicts_the_new_run(diagnosed):
    """From the file, by the way of ``simulate`` and ``evaluate``, friction alone."""
    rows, diagnosis = diagnosed
    model = fit_joint(rows, {}, FitSettings(temperature="motor"))
    text = documents.to_json(extended_document(diagnosis, model))
    stated = documents.decode(text.encode(), ExtendedDocument)
    assert stated.empirical.note.startswith("empirical")
    extended = extended_model(stated)
    new = diagnosis.judged
    beyond = extended.beyond(new)
    left = new.squared(new.friction_misfit - beyond.friction, new.load_misfit - beyond.load)
    assert np.sqrt(np.mean(left)) == pytest.approx(diagnosis.empirical.gain.after, rel=1e-6)
    torques = rows[rows["run"] == diagnosis.held_out]
    added, base = friction_beyond(torques, stated, extended)
    ordered = torques.sort_values(["run", "time", "pair", "position"]).index
    assert added.loc[ordered].to_numpy() == pytest.approx(beyond.friction, abs=1e-9)
    assert np.std(added) > 0.8
    assert base.parameters["tau_c"].estimate == diagnosis.base.parameters.tau_c
    # fitted to torques as logged: what a delay adds to friction must not be taken off as well
    known = replace(model.parameters["tau_c"], estimate=0.006, ci95=(0.004, 0.008), unit="s")
    late = replace(model, delay=known, notes=(f"a torque that lags; {FREED}",))
    stated = extended_document(diagnosis, late)
    assert (late.late_by, stated.late_by) == (0.006, None)
    assert FREED not in stated.notes[0]


@pytest.mark.long
def test_a_joint_with_all_nuisances_and_nothing_hidden_gets_none():
    nuisances = ("all", "friction_zones:0.02")
    rows = simulate_torques(
        SynthesisSettings(seed=11, joint_kind="plain", nuisances=nuisances, highest=45)
    )
    assert diagnose_joint(rows, "motor", "N·m", SETTINGS).empirical is None
