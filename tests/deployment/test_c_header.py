"""The C header compiles without a warning and does, to the last digits, what Python does."""

import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from frictioncli.correction.evaluation import simulate
from frictioncli.correction.replay import phase_data
from frictioncli.correction.settings import CorrectionSettings, ScheduleSettings
from frictioncli.deployment.export import export
from frictioncli.deployment.settings import ExportSettings
from frictioncli.model.friction import temperature_from_friction
from frictioncli.model.zero_load import friction_at_zero_load
from tests.deployment.joints import LAG, TERMS, day, effect, extended, joint
from tests.equation_16 import torques

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
FLAGS = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wshadow"]

PROGRAM = """
#include <stdio.h>
#include "friction-joint2.h"

int main(void)
{
    struct friction_joint2 joint;
    double a, b, c, d, e;
    char what;
    friction_joint2_init(&joint);
    while (scanf(" %c", &what) == 1) {
        if (what == 'f' && scanf("%lf %lf %lf", &a, &b, &c) == 3)
            printf("%a %d\\n", friction_joint2_friction(&joint, a, b, c),
                   friction_joint2_in_range(a, b, c));
        STATEFUL
    }
    return 0;
}
"""
STATEFUL = """
        if (what == 't' && scanf("%lf %lf %lf", &a, &b, &c) == 3)
            printf("%a\\n", friction_joint2_temperature(&joint, a, b, c));
        if (what == 'u' && scanf("%lf %lf %lf %lf %lf", &a, &b, &c, &d, &e) == 5) {
            friction_joint2_update(&joint, a, b, c MORE);
            printf("%d\\n", friction_joint2_is_due(&joint));
        }
        if (what == 'c' && scanf("%lf %lf %lf %lf", &a, &b, &c, &d) == 4) {
            int done = friction_joint2_correct(&joint, a, b, c, d);
            printf("%d %a\\n", done, joint.correction);
        }
        if (what == 'p' && scanf("%lf %lf", &a, &b) == 2)
            printf("%a\\n", friction_joint2_predicted(&joint, a, b));
"""
GEAR = """
        if (what == 'g')
            printf("%a %a\\n", friction_joint2_gear_excess(&joint),
                   friction_joint2_gear_uncertainty(&joint));
"""

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler (cc, gcc or clang)")


@pytest.fixture
def compiled(tmp_path):
    """Return a function that talks to a joint's header: lines in, rows of numbers out."""

    def of(deployed):
        stateful = STATEFUL.replace("MORE", ", d, e" if deployed.extension else "")
        stateful += GEAR if deployed.extension else ""
        if not deployed.can_correct:
            stateful = "(void)d; (void)e;"
        header = export(deployed, ExportSettings(to="c"))
        (tmp_path / header.name).write_text(header.text, encoding="ascii")
        # compiled twice into one program: a header that defined anything would clash
        (tmp_path / "main.c").write_text(PROGRAM.replace("STATEFUL", stateful), encoding="ascii")
        (tmp_path / "other.c").write_text(
            f'#include "{header.name}"\n#include "{header.name}"\ntypedef int nothing;\n',
            encoding="ascii",
        )
        program = tmp_path / "program"
        command = [COMPILER, *FLAGS, "-o", program, "main.c", "other.c", "-lm"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

        def ask(lines):
            answer = subprocess.run(
                [program], input="\n".join(lines), capture_output=True, text=True, check=True
            )
            rows = [line.split() for line in answer.stdout.splitlines()]
            return [[float.fromhex(word) for word in row] for row in rows]

        return ask

    return of


def line(what, *values):
    return " ".join([what, *(repr(float(value)) for value in values)])


def random_joint(seed, **options):
    generator = np.random.default_rng(seed)
    return joint(
        tau_c=generator.uniform(0, 20),
        alpha=generator.uniform(0, 0.003),
        beta=generator.uniform(0, 5),
        gamma=generator.uniform(1, 30),
        delta=generator.uniform(0.01, 0.1),
        **options,
    )


@pytest.mark.parametrize("seed", range(3))
def test_friction_and_its_inverse_are_python_s(compiled, seed):
    """Within 1e-12 of it, on 2000 random inputs; no temperature where Python finds none."""
    deployed, generator = random_joint(seed), np.random.default_rng(seed)
    load, speed = generator.uniform(-150, 150, 2000), generator.uniform(0, 200, 2000)
    warm, friction = generator.uniform(-20, 120, 2000), generator.uniform(-20, 200, 2000)
    speed[:5] = 0.0
    ask = compiled(deployed)
    found = np.array(ask(line("f", *row) for row in zip(load, speed, warm, strict=True)))
    wanted = deployed.friction(load=load, speed=speed, temperature=warm)
    np.testing.assert_allclose(found[:, 0], wanted, rtol=1e-12)
    known = (load >= -95) & (load <= 90) & (speed >= 2.3) & (speed <= 101.2)
    known &= (warm >= 20) & (warm <= 65)
    np.testing.assert_array_equal(found[:, 1], known)
    found = np.array(ask(line("t", *row) for row in zip(friction, load, speed, strict=True)))
    wanted = temperature_from_friction(deployed.base, friction=friction, load=load, speed=speed)
    assert 100 < np.isnan(wanted).sum() < 1900
    np.testing.assert_allclose(found[:, 0], wanted, rtol=1e-12, atol=1e-11)


def replayed(ask, deployed, seen):
    """Tell C and Python the same day; return what both said, line by line."""
    corrector, lines, wanted = deployed.corrector(), [], []
    gear = deployed.extension is not None
    for i in range(len(seen["time"])):
        at = {name: float(values[i]) for name, values in seen.items()}
        more = {"housing_temperature": at["housing"], "power": at["power"]} if gear else {}
        corrector.update(at["time"], at["motor"], at["registered"], **more)
        told = ("time", "motor", "registered", "housing", "power")
        lines.append(line("u", *(at[name] for name in told)))
        wanted.append([float(corrector.is_due)])
        if corrector.is_due:
            measured = (at["friction"], at["load"], at["speed"])
            done = corrector.correct(*measured)
            lines.append(line("c", *measured, at["motor"]))
            wanted.append([float(done), corrector.correction])
        lines.append(line("p", at["load"], at["speed"]))
        wanted.append([corrector.friction(at["load"], at["speed"])])
        if gear and corrector.gear is not None:
            lines.append("g")
            wanted.append([corrector.gear.excess, corrector.gear.uncertainty])
    return ask(lines), wanted


def same(found, wanted):
    """Events are exactly the same, numbers within 1e-12 of the largest part they are made of."""
    assert [len(row) for row in found] == [len(row) for row in wanted]
    flat = [np.concatenate(rows) for rows in (found, wanted)]
    np.testing.assert_allclose(*flat, rtol=1e-12, atol=1e-10)


@pytest.mark.parametrize("reading", ["first_degree", "latest_degree"])
def test_a_day_is_corrected_at_the_same_moments(compiled, reading):
    deployed = joint(schedule=ScheduleSettings(criterion=reading, k=2.5, tmax=1800.0))
    ask = compiled(deployed)
    for seed in range(6):
        found, wanted = replayed(ask, deployed, day(seed))
        same(found, wanted)
        tried = [row for row in wanted if len(row) == 2]
        assert len(tried) > 10
        assert {row[0] for row in tried} == {0.0, 1.0}


@pytest.mark.parametrize("criterion", ["first_degree", "latest_degree"])
def test_a_whole_log_gives_the_schedule_that_simulate_wrote(compiled, criterion):
    """Told only what a controller knows, pair by pair; measured is the pair at 67.5 deg/s."""
    rule = ScheduleSettings(criterion=criterion, k=3.0, tmax=2400.0)
    deployed, log = joint(schedule=rule), torques(6)
    ask = compiled(deployed)
    rows = simulate(log, deployed.model, CorrectionSettings(), rule)
    pairs = friction_at_zero_load(log, deployed.base.alpha)
    for name, wanted in rows.groupby("phase"):
        data = phase_data(pairs[pairs["phase"] == name], correction_speed=67.5, degree=3)
        lines = []
        for i, corrects in enumerate(wanted["corrected"]):
            warm = data.temperature[i]
            lines.append(line("u", data.time[i], warm, data.reading[i], 0.0, 0.0))
            if corrects:
                used = data.correction_pair[i]
                measured = data.friction[used], 0.0, data.speed[used], data.temperature[used]
                lines.append(line("c", *measured))
            lines.append(line("p", 0.0, data.speed[i]))
        found = [row for row in ask(lines) if len(row) == 1]
        due, predicted = np.array(found).reshape(-1, 2).T
        np.testing.assert_array_equal(due, wanted["corrected"])
        np.testing.assert_allclose(predicted, wanted["friction_predicted"], rtol=1e-12)
        assert 5 < due.sum() < 40


def test_the_extended_model_carries_the_same_gear(compiled):
    deployed = joint(extension=extended())
    ask = compiled(deployed)
    for seed in range(4):
        same(*replayed(ask, deployed, day(seed)))


@pytest.mark.parametrize("term", [*TERMS, effect("load_temperature", 0.3, bend=0.0)])
def test_each_effect_without_memory_is_the_catalogue_s(compiled, term):
    """The C expression against the effect's own basis, alone and without a gear."""
    deployed = joint(extension=extended(terms=(term,), gear=None))
    same(*replayed(compiled(deployed), deployed, day(3, length=60)))


@pytest.mark.parametrize("kind", ["housing", "mean"])
def test_a_model_of_another_temperature_is_given_that_one(compiled, kind):
    deployed = joint(extension=extended())
    deployed = replace(deployed, model=replace(deployed.model, temperature=kind))
    seen = day(2, length=60)
    seen["housing"] = np.nan_to_num(seen["housing"], nan=25.0)
    same(*replayed(compiled(deployed), deployed, seen))


def test_without_a_temperature_there_is_friction_and_no_corrector(compiled):
    deployed = joint(gamma=0.0, delta=0.0)
    found = compiled(deployed)([line("f", 10.0, 50.0, 30.0)])
    assert found[0][0] == pytest.approx(10.57 + 0.14 + 3.48 * np.sqrt(50.0))
    header = export(deployed, ExportSettings(to="c"))
    assert "_correct(" not in header.text
    assert "temperature spans 1 °C" in header.notes[0]


def test_the_head_says_what_it_is_made_from_and_units():
    text = export(joint(unit="A"), ExportSettings(to="c")).text
    assert "frictioncli 1.2.3" in text
    assert "0" * 64 in text
    assert "/* [A] 95 %: 9.513 to 11.63 */" in text
    assert "1/(A)" in text
    assert max(map(len, text.splitlines())) <= 100


def test_what_the_log_says_cannot_end_the_comment():
    deployed = joint()
    noted = replace(deployed, model=replace(deployed.model, notes=("*/ int x; /*",)))
    assert export(noted, ExportSettings(to="c")).text.count("int x;") == 1
    assert "*/ int x" not in export(noted, ExportSettings(to="c")).text


def test_a_gear_without_an_interval_is_only_uncertain_of_its_start(compiled):
    deployed = joint(extension=extended(gear=replace(LAG, time_constant_ci95=None)))
    same(*replayed(compiled(deployed), deployed, day(5, length=50)))
