"""The empirical term outside the program: in C and JSON what Python says, and what the log gave."""

import csv
import subprocess
from dataclasses import replace
from itertools import groupby

import numpy as np
import pytest

from frictioncli.deployment.document import load_deployed
from frictioncli.deployment.export import export
from frictioncli.deployment.settings import ExportSettings
from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients
from frictioncli.diagnosis.empirical.forms import forms_of
from frictioncli.diagnosis.empirical.term import EmpiricalTerm, FormFunction, SmoothFunction
from frictioncli.errors import OptionError, TableError
from frictioncli.model.friction import PUBLISHED
from tests.deployment.joints import extended, joint
from tests.deployment.test_c_header import COMPILER, FLAGS
from tests.equation_16 import torques

RANGES = {
    "position": (5.0, 175.0),
    "speed": (2.3, 101.2),
    "temperature": (20.0, 65.0),
    "load": (1.0, 95.0),
}

FORMS = tuple(
    FormFunction(
        kind=one.kind,
        axes=one.axes,
        channel=one.channel,
        shape={axis.name: axis.values[len(axis.values) // 2] for axis in one.shape},
        coefficients={name: 1.5 - number for number, name in enumerate(one.coefficients)},
        formula=one.formula,
        sign=-1.0 if one.kind == "uneven_bump" or one.channel == "load" else 1.0,
    )
    for one in forms_of(RANGES)
)

GENERATOR = np.random.default_rng(0)


def smooth(axes, orders, channel="friction"):
    values = GENERATOR.normal(0, 0.3, int(np.prod(orders)))
    return SmoothFunction(
        axes=axes, channel=channel, orders=orders, coefficients=tuple(values.tolist())
    )


TERM = EmpiricalTerm(
    forms=FORMS,
    functions=(
        smooth(("position",), (16,)),
        smooth(("temperature",), (5,)),
        smooth(("position", "speed"), (6, 3)),
        smooth(("speed", "temperature"), (3, 3)),
        smooth(("position", "temperature"), (6, 3), "load"),
    ),
    ranges=RANGES,
    base_changes={"tau_c": 0.3, "alpha": -1e-4, "beta": 0.05, "gamma": -0.6, "delta": 2e-3},
    gravity_changes=GravityCoefficients(cosine=0.4, sine=-0.2, offset=0.1),
)


def points(count=400):
    """Inside the ranges and outside, 0 and standstill among them."""
    generator = np.random.default_rng(5)
    found = {
        "position": generator.uniform(-20, 200, count),
        "load": generator.uniform(-110, 110, count),
        "speed": generator.uniform(1.5, 115, count),
        "temperature": generator.uniform(15, 70, count),
    }
    found["load"][:3] = 0.0
    found["speed"][3] = 0.0
    return found


def deployed():
    return joint(extension=replace(extended(), empirical=TERM))


def test_it_is_what_the_analysis_adds_to_the_rows_of_a_log():
    rows = torques(1).assign(load=np.nan)
    gravity = np.array([95.0, 0.0, 0.0])
    _, problem = simulated(rows, "motor", PUBLISHED, gravity)
    added = TERM.at(problem)
    table = problem.table
    told = deployed().extension.empirical_torque(
        position=table.position,
        load=table.load,
        speed=table.speed,
        temperature=table.temperature,
    )
    assert np.std(added.friction) > 1.0
    np.testing.assert_allclose(told.friction, added.friction, atol=1e-9)
    np.testing.assert_allclose(told.load, added.load, atol=1e-9)


def test_json_brings_it_back_and_refuses_a_damaged_one(tmp_path):
    path = tmp_path / "joint.json"
    text = export(deployed(), ExportSettings(to="json")).text
    path.write_text(text, encoding="utf-8")
    assert load_deployed(path).extension.empirical == TERM
    path.write_text(text.replace('"warm_wave"', '"cold_wave"'), encoding="utf-8")
    with pytest.raises(TableError, match="cold_wave"):
        load_deployed(path)


def test_without_a_term_it_is_nothing():
    both = extended().empirical_torque(position=[1.0, 2.0], load=3.0, speed=4.0, temperature=5.0)
    assert both.friction.tolist() == both.load.tolist() == [0.0, 0.0]


PROGRAM = """
#include <stdio.h>
#include "friction-joint2.h"

int main(void)
{
    double a, b, c, d;
    while (scanf("%lf %lf %lf %lf", &a, &b, &c, &d) == 4)
        printf("%a %a\\n", friction_joint2_empirical_friction(a, b, c, d),
               friction_joint2_empirical_load(a, b, c, d));
    return 0;
}
"""


@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler (cc, gcc or clang)")
def test_c_says_what_python_says(tmp_path):
    """Every form and series, in both channels, to 1e-10 N·m."""
    header = export(deployed(), ExportSettings(to="c"))
    (tmp_path / header.name).write_text(header.text, encoding="ascii")
    (tmp_path / "main.c").write_text(PROGRAM, encoding="ascii")
    program = tmp_path / "program"
    command = [COMPILER, *FLAGS, "-o", program, "main.c", "-lm"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    at = points()
    lines = [
        " ".join(repr(float(value)) for value in row)
        for row in zip(at["position"], at["load"], at["speed"], at["temperature"], strict=True)
    ]
    answer = subprocess.run(
        [program], input="\n".join(lines), capture_output=True, text=True, check=True
    )
    told = np.array(
        [[float.fromhex(word) for word in line.split()] for line in answer.stdout.splitlines()]
    )
    both = deployed().extension.empirical_torque(**at)
    assert np.mean(both.friction != 0) > 0.3
    assert np.any(both.friction == 0)
    np.testing.assert_allclose(told[:, 0], both.friction, atol=1e-10)
    np.testing.assert_allclose(told[:, 1], both.load, atol=1e-10)


def looked_up(rows, at):
    """Interpolate one table linearly, by hand: along its second quantity, then along its first."""
    place = []
    for number in (1, 2):
        label = rows[0][f"quantity {number}"]
        if label:
            values = at[label.removeprefix("absolute ").split()[0]]
            place.append(np.abs(values) if label.startswith("absolute") else values)
    values = np.array([float(one["value"]) for one in rows])
    first = np.array([float(one["value 1"]) for one in rows])
    if len(place) == 1:
        return np.interp(place[0], first, values)
    second = np.array([float(one["value 2"]) for one in rows])
    knots = np.unique(first)
    along = np.array(
        [np.interp(place[1], second[first == one], values[first == one]) for one in knots]
    )
    left = np.clip(np.searchsorted(knots, place[0]) - 1, 0, len(knots) - 2)
    share = np.clip((place[0] - knots[left]) / (knots[left + 1] - knots[left]), 0, 1)
    rows = np.arange(len(share))
    return (1 - share) * along[left, rows] + share * along[left + 1, rows]


def test_tables_say_what_python_says():
    """Every form and series, inside the ranges, where they fade and beyond, to the tolerance."""
    written = export(deployed(), ExportSettings(to="csv", extended=True, tolerance=1.0))
    assert written.name == "friction-joint2-empirical.csv"
    lines = [one for one in written.text.splitlines() if not one.startswith("#")]
    found = list(csv.DictReader(lines))
    at = points()
    valid, told = np.ones(len(at["load"])), {"friction": 0.0, "load": 0.0}
    for (part, channel, *_), rows in groupby(
        found, lambda one: (one["part"], one["torque"], one["quantity 1"], one["quantity 2"])
    ):
        values = looked_up(list(rows), at)
        if part == "validity [1]":
            valid = valid * values
        else:
            assert part.endswith("[N·m]")
            told[channel] = told[channel] + values
    both = deployed().extension.empirical_torque(**at)
    for channel in ("friction", "load"):
        right = getattr(both, channel)
        np.testing.assert_allclose(valid * told[channel], right, atol=1.0)
        # most of what is allowed is for the few places where errors of all tables are greatest
        assert np.sqrt(np.mean(np.square(valid * told[channel] - right))) < 0.1
        outside = right == 0
        assert outside.any()
        assert np.abs((valid * told[channel])[outside]).max() < 1e-9


def test_tables_of_a_model_without_a_term_are_refused():
    with pytest.raises(OptionError, match="no empirical term"):
        export(joint(extension=extended()), ExportSettings(to="csv", extended=True))
