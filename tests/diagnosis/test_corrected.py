"""Effects of the measurement that the extended model corrects though they are not named."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.extended_document import extended_model
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.documents.reload import reload
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.measurement import corrected_without_name
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_standing import cause
from tests.equation_16 import TRUTH, friction, table
from tests.simulation.torque_table import simulate_world
from tests.studies.blind_worlds import World


def of(name, p_value, standing="visible"):
    one = cause(p_value=p_value)
    fit = EffectFit(BY_NAME[name], {}, np.array([0.01]), np.array([[1e-6]]), 50.0)
    return replace(one, fit=fit, effects=(name,), standing=standing, reason="small")


DATA = problem(1)


def corrected(judged, causes):
    return [one.fit.effect.name for one in corrected_without_name(judged, causes, DATA)]


def test_what_noise_hardly_explains_is_corrected():
    named: Cause = of("load_offset", 1e-9, "named")
    clear, doubtful = of("torque_delay", 1e-3), of("backlash", 0.2)
    ripple = of("position_ripple", 1e-9)
    judged = (named, clear, doubtful, ripple)
    assert corrected(judged, [named]) == ["torque_delay"]
    assert corrected(judged, [ripple]) == ["load_offset", "torque_delay"]
    assert corrected(judged, []) == ["load_offset", "torque_delay"]
    impossible = replace(clear, fit=replace(clear.fit, coefficients=np.array([-9.0])))
    assert corrected((named, impossible), [named]) == []
    (one,) = corrected_without_name(judged, [named], DATA)
    assert one.reason == "small; corrected nonetheless"


def late_run(run, delay, generator):
    """Torques of a small joint, to first order as a log shows them whose torque is late."""
    angle, speed = np.radians(np.arange(-62.5, 63.0, 5.0)), np.resize([8, 20, 50, 100, 200.0], 60)
    warm = np.linspace(22.0, 45.0, len(speed))
    small = TRUTH | {name: TRUTH[name] / 10 for name in ("tau_c", "beta", "gamma")}
    ways = []
    for way in (1, -1):
        load = 12 * np.cos(angle - way * delay * np.radians(speed[:, np.newaxis]))
        known = {"load": load, "speed": speed[:, np.newaxis], "temperature": warm[:, np.newaxis]}
        ways.append(load + way * friction(small, **known) + generator.normal(0, 0.03, load.shape))
    half, mean = (ways[0] - ways[1]) / 2, (ways[0] + ways[1]) / 2
    columns = {"speed": speed, "time": 60.0 * np.arange(len(speed)), "phase": "heat-up"}
    columns |= dict.fromkeys(("motor_temperature", "motor_temperature_reading"), warm)
    columns = {name: np.broadcast_to(values, speed.shape) for name, values in columns.items()}
    rows = table(
        columns, position=np.degrees(angle), friction_torque=half, load_torque=mean[0], run=run
    )
    forward, reverse = (one.ravel() for one in ways)
    rows = rows.assign(load_torque=mean.ravel(), torque_forward=forward, torque_reverse=reverse)
    return rows.assign(**dict.fromkeys(("housing_temperature", "load", "payload"), np.nan))


def test_a_delay_too_small_for_a_name_is_no_structure_of_the_held_out_run():
    """It misses three times the noise there, as it does on the run seen."""
    generator = np.random.default_rng(4)
    runs = [late_run(run, 0.0082, generator) for run in ("day1", "day2")]
    found = diagnose_joint(pd.concat(runs, ignore_index=True), "motor", "N·m", DiagnosisSettings())
    assert found.rmse > 3 * found.floor
    assert not found.causes
    assert [one.effects for one in found.visible] == [("torque_delay",)]
    assert found.structure is None


@pytest.mark.long
def test_what_is_corrected_follows_the_causes_and_counts_for_the_prediction():
    """A joint that does many small things; its documents predict the new run as the diagnosis."""
    world = World("single", "load_temperature", 0)
    torques = simulate_world(world.settings(world.names)).torques
    settings = DiagnosisSettings()
    diagnosis = diagnose_joint(torques, "motor", "N·m", settings)
    names = [one.fit.effect.name for one in diagnosis.corrected]
    assert names
    assert all(BY_NAME[name].measurement for name in names)
    document = diagnosis_document(diagnosis, settings)
    extended = extended_document(diagnosis, fit_joint(torques, {}, FitSettings()))
    causes = [one.fit.effect.name for one in diagnosis.causes]
    assert [one.name for one in extended.effects] == [*causes, *names]
    assert all(
        one.reason.endswith("corrected nonetheless")
        for one in document.visible
        if one.effects[0] in names
    )
    new = reload(torques, document, extended_model(extended)).new
    square = np.square(new.after["friction"]) + np.square(new.after["load"])
    assert np.sqrt(np.mean(square)) == pytest.approx(diagnosis.gain.after, rel=1e-6)
    assert diagnosis.gain.after < diagnosis.gain.before
