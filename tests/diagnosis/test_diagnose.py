"""Hidden effects are found by name, and nothing is found where nothing is hidden."""

import hashlib
import json
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document
from frictioncli.diagnosis.documents.text import verdict_text
from frictioncli.diagnosis.search.effect_size import LACKING, TAKEN_BY_BASE
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import EFFECTS
from frictioncli.errors import NotEnoughData, OptionError, TableError
from frictioncli.provenance import Provenance
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.fit import fit
from frictioncli.stages.simulate import simulate
from frictioncli.workfiles import DIAGNOSIS, EVALUATION, EXTENDED, RAMPS, TORQUES
from tests.equation_16 import cycle_temperatures, torques


def days(seed, **columns):
    """Two days whose friction is exactly the base model, with noise in both channels."""
    temperature, time, phase = (values[::2] for values in cycle_temperatures())
    both = [
        torques(2 * seed + day, temperatures=(temperature, time, phase)).assign(run=f"day{day}")
        for day in (1, 2)
    ]
    rows = pd.concat(both, ignore_index=True).assign(load=np.nan, **columns)
    generator = np.random.default_rng(seed)
    pairs = rows.groupby(["run", "pair"]).ngroup().to_numpy()
    noise = generator.normal(0, 0.1, pairs.max() + 1)[pairs] + generator.normal(0, 0.3, len(rows))
    return rows.assign(load_torque=rows["load_torque"] + noise)


def diagnosed(rows):
    return diagnose_joint(rows, "motor", "N·m", DiagnosisSettings())


@cache
def clean(seed):
    """Return the diagnosis of days with nothing hidden."""
    return diagnosed(days(seed))


def said(diagnosis):
    """Return what the terminal says."""
    return verdict_text(diagnosis_document(diagnosis, DiagnosisSettings()))


def undetectable(diagnosis):
    return diagnosis_document(diagnosis, DiagnosisSettings()).undetectable


@pytest.mark.parametrize("seed", [pytest.param(one, marks=pytest.mark.long) for one in (0, 1, 2)])
def test_nothing_is_found_where_nothing_is_hidden(seed):
    diagnosis = clean(seed)
    assert diagnosis.verdict == "no_evidence"
    assert diagnosis.causes == ()
    assert diagnosis.gain is None
    assert "no cause" in said(diagnosis)


@pytest.mark.long
def test_a_ripple_is_named_with_its_order():
    rows = days(5)
    ripple = 0.8 * np.sin(9.3 * np.radians(rows["position"]) + 0.4)
    diagnosis = diagnosed(rows.assign(friction_torque=rows["friction_torque"] + ripple))
    assert diagnosis.verdict == "named"
    (cause,) = diagnosis.causes
    assert cause.effects == ("position_ripple",)
    assert cause.fit.shape["order"] == pytest.approx(9.3, abs=0.15)
    assert cause.size == pytest.approx(0.8 / np.sqrt(2), rel=0.1)


@pytest.mark.long
def test_a_spring_shows_in_the_load_and_is_named():
    rows = days(6)
    # gravity takes most of a spring: half a newton metre is left
    spring = 6.0 * np.radians(rows["position"] - 70)
    # the gear carries it: friction goes with the square of the whole load
    gravity = 95.0 * np.cos(np.radians(rows["position"]))
    friction = rows["friction_torque"] + 0.0014 * ((gravity + spring) ** 2 - gravity**2)
    diagnosis = diagnosed(
        rows.assign(load_torque=rows["load_torque"] + spring, friction_torque=friction)
    )
    assert [cause.effects for cause in diagnosis.causes] == [("dress_pack",)]
    # beside gravity a stiffening spring looks like one that is stiffer: what is left tells
    angle = np.radians(rows["position"])
    columns = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle)])
    left = spring - columns @ np.linalg.lstsq(columns, spring, rcond=None)[0]
    low, high = diagnosis.causes[0].visible_interval
    assert low < np.sqrt(np.mean(left**2)) < high


def test_a_spring_of_which_the_base_leaves_less_than_the_margin_is_not_named():
    """Of 1.5 N·m/rad 0.14 N·m are left, beside a margin of 0.26."""
    rows = days(6)
    spring = 1.5 * np.radians(rows["position"] - 70)
    diagnosis = diagnosed(rows.assign(load_torque=rows["load_torque"] + spring))
    assert diagnosis.verdict == "no_evidence"
    assert diagnosis.margin == pytest.approx(0.005 * rows["friction_torque"].mean(), rel=0.02)


def test_torque_constant_is_told_from_coulomb_friction_by_the_load():
    """Friction and gravity grow by 0.15 %/°C: only the load channel can decide that."""
    rows = days(7)
    factor = 1 + 0.0015 * (rows["motor_temperature"] - 25)
    diagnosis = diagnosed(
        rows.assign(
            friction_torque=rows["friction_torque"] * factor,
            load_torque=rows["load_torque"] * factor,
        )
    )
    assert ("torque_constant",) in [cause.effects for cause in diagnosis.causes]


def lagging(rows, minutes=25.0):
    """Friction obeys a gear that follows the motor with a delay; by plain Euler steps."""
    parts = []
    for _, day in rows.groupby("run"):
        heads = day.drop_duplicates("pair").sort_values("time")
        clock = np.arange(heads["time"].iloc[0], heads["time"].iloc[-1] + 60, 5.0)
        motor = np.interp(clock, heads["time"], heads["motor_temperature"])
        gear = motor.copy()
        for i in range(1, len(clock)):
            gear[i] = gear[i - 1] + 5.0 / (60 * minutes) * (motor[i - 1] - gear[i - 1])
        at = np.interp(day["time"], clock, gear)
        decay = np.exp(-0.056 * at) - np.exp(-0.056 * day["motor_temperature"])
        shift = 15.66 * np.sqrt(day["speed"]) * decay
        parts.append(day.assign(friction_torque=day["friction_torque"] + shift))
    return pd.concat(parts)


def test_a_lagging_gear_is_named_and_pays_on_a_new_day():
    rows = lagging(days(8))
    diagnosis = diagnosed(rows.assign(run=rows["run"].map({"day1": "day9", "day2": "day10"})))
    assert ("thermal_lag",) in [cause.effects for cause in diagnosis.causes]
    assert diagnosis.gain.basis == "new_run"
    assert diagnosis.held_out == "day10"
    assert diagnosis.gain.reduction > 0.3
    assert diagnosis.gain.interval[0] > 0.2


@pytest.mark.long
def test_a_lag_does_not_hide_a_ripple():
    rows = lagging(days(9))
    ripple = 1.0 * np.sin(6.7 * np.radians(rows["position"]))
    diagnosis = diagnosed(rows.assign(friction_torque=rows["friction_torque"] + ripple))
    names = [cause.effects for cause in diagnosis.causes]
    assert ("thermal_lag",) in names
    assert ("position_ripple",) in names


def test_one_day_only_says_that_its_gain_is_optimistic():
    rows = lagging(days(8))
    diagnosis = diagnosed(rows[rows["run"] == "day1"])
    assert diagnosis.gain.basis == "within_run"
    assert "optimistic" in said(diagnosis)


def detectable_sizes(diagnosis):
    return diagnosis.search.detectable_sizes(diagnosis.tried, 0.05, diagnosis.margin)


def test_detectable_sizes_cover_the_catalogue():
    diagnosis = clean(1)
    detectable = detectable_sizes(diagnosis)
    assert set(detectable) == {effect.name for effect in EFFECTS}
    known = [size for size in detectable.values() if size is not None]
    # a name needs more than the margin, whatever the noise
    assert all(size > diagnosis.margin for size in known)
    # of a ripple the base leaves nearly all
    assert detectable["position_ripple"] < 2 * diagnosis.margin
    settings = DiagnosisSettings(margin=0.0)
    whatever = detectable_sizes(diagnose_joint(days(1), "motor", "N·m", settings))
    # a ripple is averaged over 160 pairs of 34 bins of 0.3 N·m: about 0.3 * sqrt(2 * 25 / 5440),
    # and the discrepancy has as much again along the same axis
    assert 0.01 < whatever["position_ripple"] < 0.2


def test_claims_go_by_the_structure_that_decides_on_names():
    """Its forms, by which it is described, may be along other axes."""
    diagnosis = clean(1)
    described = Structure(
        axes=("time", "temperature"),
        channel="friction",
        p_value=1e-9,
        statistic=50.0,
        size=100.0,
        interval=(90.0, 110.0),
    )
    document = diagnosis_document(replace(diagnosis, structure=described), DiagnosisSettings())
    assert document.detectable["step_change"] is not None
    assert document.detectable == detectable_sizes(diagnosis)


@pytest.mark.long
def test_no_detectable_size_is_larger_than_the_friction():
    """At two speeds base and drift take a viscous term whole; at one it is not asked about."""
    rows = days(1)
    speeds = sorted(rows["speed"].unique())
    fast = rows[rows["speed"].isin(speeds[-2:])]
    two = diagnosed(fast)
    whole = fast["friction_torque"].abs().mean()
    sizes = detectable_sizes(two)
    assert all(size < 1.1 * whole for size in sizes.values() if size is not None)
    assert sizes["position_ripple"] < 1
    for name in ("linear_viscous", "quadratic_drag"):
        assert sizes[name] is None
        assert undetectable(two)[name] == TAKEN_BY_BASE
    one = diagnosed(rows[rows["speed"] == speeds[-1]])
    assert undetectable(one)["linear_viscous"] == LACKING
    for found in (one, two):
        missing = {name for name, size in detectable_sizes(found).items() if size is None}
        assert set(undetectable(found)) == missing


def test_too_few_pairs_are_named():
    rows = days(1)
    with pytest.raises(NotEnoughData, match="8 pairs to learn from"):
        diagnosed(rows[(rows["run"] == "day1") & (rows["pair"] < 8)])


def test_pairs_without_a_temperature_are_left_out_and_counted():
    """A sensor that failed for some pairs; a temperature of zero would be wrong by far."""
    rows = days(1)
    failed = (rows["run"] == "day1") & (rows["pair"] % 5 == 0)
    some = diagnosed(rows.assign(motor_temperature=rows["motor_temperature"].mask(failed)))
    count = rows[failed].groupby("pair").ngroups
    assert count > 5
    assert some.without_temperature == count
    assert f"left out: {count} pairs without temperature" in said(some)
    without = diagnosed(rows[~failed])
    assert (some.verdict, some.rmse) == (without.verdict, without.rmse)
    assert without.without_temperature == 0
    # the held-out run is the last one with a temperature
    last = rows["run"] == "day2"
    alone = diagnosed(rows.assign(motor_temperature=rows["motor_temperature"].mask(last)))
    assert (alone.runs, alone.held_out) == (("day1",), None)


@pytest.mark.parametrize("wrong", [{"alpha": 0.0}, {"most": 5}])
def test_senseless_settings_are_refused(wrong):
    with pytest.raises(OptionError, match="expected"):
        DiagnosisSettings(**wrong)


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """A work folder with the torques of a lagging gear and no ramps, fitted and diagnosed."""
    folder = tmp_path_factory.mktemp("work")
    rows = lagging(days(8)).assign(torque_forward=1.0, torque_reverse=1.0, n_forward=1, n_reverse=1)
    tables.write(
        folder / TORQUES, rows, schemas.TORQUES, Provenance("test"), {"torque_unit": "N·m"}
    )
    none = pd.DataFrame(columns=[column.name for column in schemas.RAMPS.columns])
    tables.write(folder / RAMPS, none, schemas.RAMPS, Provenance("test"))
    fit(folder)
    diagnose(folder)
    return folder


def test_files_have_the_keys_of_the_contract(work):
    found = json.loads((work / DIAGNOSIS).read_text(encoding="utf-8"))
    keys = {"verdict", "causes", "gain", "detectable", "simulation", "settings"}
    assert keys <= set(found)
    cause = found["causes"][0]
    assert {"effects", "probabilities", "channel", "claim", "equation", "parameters"} <= set(cause)
    assert {"size", "p_value", "seen_in", "figure", "experiment"} <= set(cause)
    gain = {"basis", "rmse_before", "rmse_after", "reduction", "ci95", "noise_floor"}
    assert set(found["gain"]) == gain | {"rmse_without_level"}
    assert {"rmse", "worst"} <= set(found["simulation"])
    assert found["settings"]["alpha"] == 0.05


@pytest.mark.parametrize("file", [DIAGNOSIS, EXTENDED])
def test_files_name_all_that_they_were_made_from(work, file):
    found = json.loads((work / file).read_text(encoding="utf-8"))
    assert found["provenance"]["inputs"] == {
        name: hashlib.sha256((work / name).read_bytes()).hexdigest()
        for name in ("torques.parquet", "model.json", "ramps.parquet")
    }


def test_the_extended_model_needs_fewer_corrections(work):
    """Uncorrected, it must predict better than the base does uncorrected."""
    errors = {}
    for extended in (False, True):
        evaluate(work, extended=extended)
        rows = tables.read(work / EVALUATION, schemas.EVALUATION)
        errors[extended] = rows[rows["criterion"] == "none"]["epsilon"].to_numpy()
    assert (errors[True] < 0.6 * errors[False]).all()


def test_a_schedule_of_the_extended_model_shows_measured_friction(work):
    plain = simulate(work)
    rows = tables.read(plain.path, schemas.SCHEDULE)
    simulate(work, extended=True)
    extended = tables.read(plain.path, schemas.SCHEDULE)
    # alpha may differ a little; friction at zero load must be the measured one in both
    difference = extended["friction_torque"] - rows["friction_torque"]
    assert np.abs(difference).max() < 0.2


def test_a_missing_extended_model_names_the_command(tmp_path, work):
    (tmp_path / TORQUES).write_bytes((work / TORQUES).read_bytes())
    with pytest.raises(TableError, match="frictioncli diagnose"):
        simulate(tmp_path, extended=True)
