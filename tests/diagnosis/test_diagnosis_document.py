"""The document of a diagnosis: its numbers against the fits they are of."""

import json
from dataclasses import replace
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.document import read_diagnoses
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document
from frictioncli.diagnosis.documents.parameters import TorqueUnits
from frictioncli.diagnosis.documents.remainder import remainder_record
from frictioncli.diagnosis.documents.structure_record import structure_record, unnamed_record
from frictioncli.diagnosis.search.largest_structure import largest_structure
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.errors import TableError
from frictioncli.stages.diagnose import has_finding
from tests.diagnosis.test_diagnose import days
from tests.report.diagnosis_documents import DIAGNOSIS_DOCUMENT, cause_document

SETTINGS = DiagnosisSettings()
AMPLITUDE = 0.8


@pytest.fixture(scope="module")
def found():
    """The diagnosis of a ripple in two days of measurements."""
    rows = days(5)
    ripple = AMPLITUDE * np.sin(9.3 * np.radians(rows["position"]) + 0.4)
    rippled = rows.assign(friction_torque=rows["friction_torque"] + ripple)
    return diagnose_joint(rippled, "motor", "N·m", SETTINGS)


def test_a_named_cause_says_its_kind_and_an_interval_that_holds_its_size(found):
    document = diagnosis_document(found, SETTINGS)
    cause = next(one for one in document.causes if one.effects == ("position_ripple",))
    assert (cause.kind, cause.standing, cause.reason) == ("friction", "named", "")
    assert cause.visible_size == pytest.approx(AMPLITUDE / np.sqrt(2), rel=0.1)
    assert document.margin == found.margin >= 0.1
    assert cause.statement


def test_what_is_visible_has_parameters_of_its_own_fit(found):
    named = replace(found.causes[0], size_interval=None)
    count = len(named.fit.coefficients)
    fit = replace(
        named.fit, coefficients=np.arange(1.0, count + 1), covariance=0.04 * np.eye(count)
    )
    unnamed = replace(
        named, fit=fit, standing="undetermined", reason="why", visible_interval=(0.1, 0.9)
    )
    document = diagnosis_document(replace(found, visible=(unnamed,)), SETTINGS)
    (record,) = document.visible
    assert (record.standing, record.reason, record.figure) == ("undetermined", "why", None)
    assert record.visible_ci95 == record.size_ci95 == (0.1, 0.9)
    sine, order = record.parameters["sine"], record.parameters["order"]
    assert sine.estimate == 1.0
    assert sine.ci95 == pytest.approx((1 - 1.96 * 0.2, 1 + 1.96 * 0.2))
    assert (order.estimate, order.ci95, order.unit) == (fit.shape["order"], None, "1/turn")
    # the same keys as a named cause
    keys = {tuple(msgspec.to_builtins(one)) for one in (*document.causes, record)}
    assert len(keys) == 1


def test_size_of_a_single_coefficient_has_its_relative_interval(found):
    named = replace(found.causes[0], size_interval=None)
    fit = replace(named.fit, coefficients=np.array([-2.0]), covariance=np.array([[0.25]]))
    effect = SimpleNamespace(**{name: getattr(fit.effect, name) for name in fit.effect.__slots__})
    effect.kind, effect.coefficients = "friction", fit.effect.coefficients[:1]
    effect.statement = ""
    alone = replace(named, fit=replace(fit, effect=effect), size=3.0)
    (record,) = diagnosis_document(replace(found, visible=(alone,)), SETTINGS).visible
    assert record.size_ci95 == pytest.approx((3.0 * 1.02 / 2, 3.0 * 2.98 / 2))


def test_structure_is_stated_by_columns_and_stands_among_the_causes(found):
    structure = Structure(
        axes=("position", "speed"),
        channel="load",
        p_value=1e-9,
        statistic=90,
        size=0.7,
        interval=(0.5, 0.9),
    )
    document = diagnosis_document(replace(found, structure=structure), SETTINGS)
    assert document.structure.axis == ("position", "speed")
    assert (document.structure.channel, document.structure.formula) == ("load", None)
    assert document.causes[-1].effects == ()
    assert document.causes[-1].claim == document.structure.description
    assert "along angle and speed" in document.structure.description
    assert document.structure.ci95 == document.causes[-1].size_ci95 == (0.5, 0.9)


def test_structure_along_a_load_that_the_angle_tells_may_be_along_the_angle(found):
    """Two payloads, of which the angle tells neither, show that it is the load."""
    along = {"axes": ("load",), "channel": "load", "p_value": 1e-9, "statistic": 90.0}
    structure = Structure(**along, size=0.7, interval=(0.5, 0.9))
    table = found.base.table
    heavier = np.where(found.base.layout.row_pair % 2 == 0, table.load, 1.6 * table.load)
    two = replace(found.base, table=replace(table, load=heavier))
    for base, told in ((found.base, True), (two, False)):
        one = replace(found, structure=structure, base=base)
        record = unnamed_record(one)
        assert structure_record(one).axis == ("load",)
        assert ("along the angle" in record.claim) == told
        assert ("another payload" in record.experiment) == told


def test_next_step_for_structure_along_time_is_a_temperature_where_the_log_has_none(found):
    along = {"axes": ("time",), "channel": "friction", "p_value": 1e-9, "statistic": 90.0}
    structure = Structure(**along, size=0.7, interval=(0.5, 0.9))
    table = found.base.table
    unknown = np.full_like(table.speed, np.nan)
    none = replace(table, motor_temperature=unknown, housing_temperature=unknown)
    for base, told in ((found.base, False), (replace(found.base, table=none), True)):
        record = unnamed_record(replace(found, structure=structure, base=base))
        assert ("Log the temperature" in record.experiment) == told
        assert ("another day" in record.experiment) != told


def test_what_is_left_on_the_new_run_is_found_along_its_axis(found):
    problem = found.judged
    as_fitted = replace(
        found.predicted,
        changes=np.zeros_like(found.predicted.changes),
        gravity=problem.gravity,
        effects=(),
    )
    clean = replace(
        found,
        extension=None,
        predicted=as_fitted,
        judged=replace(
            problem,
            friction=problem.table.friction
            + np.random.default_rng(1).normal(0, 0.5, len(problem.friction)),
            load=problem.load_base @ problem.gravity,
        ),
        floor=0.5,
    )
    assert remainder_record(clean) is None
    hours = problem.table.clock / 3600
    slow = 1.5 * np.sin(2 * np.pi * (hours - hours.min()) / np.ptp(hours))
    drifting = replace(clean.judged, friction=clean.judged.friction + slow)
    left = remainder_record(replace(clean, judged=drifting))
    assert (left.axis, left.channel, left.basis) == ("time", "friction", "new_run")
    assert left.size == pytest.approx(np.sqrt(np.mean(slow**2)), rel=0.1)
    assert left.axis_size == pytest.approx(left.size, rel=0.15)
    # a day on which friction is higher throughout: bins of any axis have that mean, too
    higher = replace(drifting, friction=drifting.friction + 2.0)
    left = remainder_record(replace(clean, judged=higher))
    assert (left.axis, left.channel) == ("run", "friction")
    assert left.axis_size == pytest.approx(2.0 + np.mean(slow), abs=0.05)


def test_noise_has_hardly_any_structure(found):
    problem = found.judged
    generator = np.random.default_rng(3)
    pairs = generator.normal(0, 0.3, len(problem.layout.time))[problem.layout.row_pair]
    noise = pairs + generator.normal(0, 0.5, len(problem.friction))
    one = largest_structure(problem, noise, generator.normal(0, 0.5, len(noise)))
    assert one.size < 0.12


def test_what_goes_with_the_load_goes_with_the_angle_too_where_there_is_one_payload(found):
    problem = found.judged
    load = problem.table.load
    heavier = np.where(problem.layout.row_pair % 2 == 0, load, 1.6 * load)
    two = replace(problem, table=replace(problem.table, load=heavier))
    nothing = np.zeros_like(load)
    for rows, axis in ((problem, "position"), (two, "load")):
        carried = 2.0 * np.square(rows.table.load / np.max(np.abs(rows.table.load)))
        one = largest_structure(rows, carried - carried.mean(), nothing)
        assert (one.axis, one.channel) == (axis, "friction")


def write(path, **changed):
    path.write_text(json.dumps(DIAGNOSIS_DOCUMENT | changed), encoding="utf-8")


def test_findings_are_what_is_named_measurement_included(tmp_path):
    path = tmp_path / "diagnosis.json"
    write(path, causes=[])
    assert not has_finding(tmp_path, named_only=False)
    delay = cause_document(1, ["torque_delay"], {}, kind="measurement", standing="named")
    write(path, causes=[delay])
    assert has_finding(tmp_path, named_only=True)
    either = cause_document(1, ["drift", "run_in"], {})
    write(path, causes=[either])
    assert has_finding(tmp_path, named_only=False)
    assert not has_finding(tmp_path, named_only=True)


def test_files_of_earlier_versions_are_read_or_refused_with_the_command(tmp_path):
    path = tmp_path / "diagnosis.json"
    old = {name: value for name, value in DIAGNOSIS_DOCUMENT.items() if name != "margin"}
    path.write_text(json.dumps(old | {"visible": []}), encoding="utf-8")
    (document,) = read_diagnoses(path).values()
    assert document.margin is None
    assert document.structure is None
    assert {cause.standing for cause in document.causes} == {"named"}
    assert document.causes[0].kind is None
    write(path, visible=[{"effects": ["inertia"], "size": 0.05, "p_value": 0.0}])
    with pytest.raises(TableError, match="run 'frictioncli diagnose' again"):
        read_diagnoses(path)


def test_a_load_channel_has_its_own_unit():
    units = TorqueUnits("A", "N·m")
    wanted = {
        ("stribeck", 0): "A",
        ("dress_pack", 0): "N·m/rad",
        ("load_offset", 0): "N·m",
        ("rest_recovery", 0): "A",
        ("rest_recovery", 1): "N·m",
    }
    for (name, number), unit in wanted.items():
        assert units.of(BY_NAME[name], BY_NAME[name].coefficients[number]) == unit
