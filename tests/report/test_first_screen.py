"""First screen: four answers in few words, with numbers that the tables have."""

import html
import re
from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from frictioncli.diagnosis.documents.document import StructureRecord
from frictioncli.diagnosis.documents.remainder_record import RemainderRecord
from frictioncli.diagnosis.documents.remainder_words import remainder_text
from frictioncli.report.first_screen import answers, word_count
from frictioncli.report.operating_point import operating_point, overview_figure
from frictioncli.report.page import write_report
from frictioncli.wording import number_text


def by_question(results):
    return {one.question: f"{one.value} {one.text}" for one in answers(results)}


def test_answers_have_less_than_sixty_words(two_runs, diagnosed, current_log, without_temperature):
    for results in (two_runs, diagnosed, current_log, without_temperature):
        found = answers(results)
        assert len(found) == 4
        assert word_count(found) < 60


def test_the_first_screen_of_a_page_has_no_other_prose(diagnosed_work, diagnosed):
    """Beside the picture there are the questions, the answers and the names of the lights."""
    page = write_report(diagnosed_work).read_text(encoding="utf-8")
    first = re.search(r'<div class="first">.*?(<dl class="answers">.*?</dl>)(.*?)<nav', page, re.S)
    shown = html.unescape(re.sub(r"<[^>]+>", " ", first[1]))
    assert (
        shown.split()
        == " ".join(f"{one.question} {one.value} {one.text}" for one in answers(diagnosed)).split()
    )
    assert len(shown.split()) < 60
    lights = re.sub(r'<span class="(lamp|spoken)".*?</span>', "", first[2])
    assert len(re.sub(r"<[^>]+>", " ", lights).split()) <= 2 * 8


def test_how_much_is_equation_16_at_the_medians(diagnosed):
    point = operating_point(diagnosed)
    pairs = diagnosed.thermal_pairs
    assert point.speed in set(pairs["speed"])
    assert point.temperature == pytest.approx(np.median(pairs["motor_temperature"]))
    p = diagnosed.model.friction
    by_hand = p.tau_c + (p.beta + p.gamma * np.exp(-p.delta * point.temperature)) * np.sqrt(
        point.speed
    )
    assert point.friction == pytest.approx(by_hand, rel=1e-12)
    said = by_question(diagnosed)["How much"]
    assert said.startswith(f"{number_text(by_hand)} N·m unloaded, at {point.speed:g} deg/s")


def test_how_sure_is_the_misfit_on_the_new_run(diagnosed, two_runs):
    said = by_question(diagnosed)["How sure"]
    assert said == (
        "±2.00 N·m RMS misfit, equation (16); extended model ±1.00 N·m, tested on day-2"
    )
    assert by_question(two_runs)["How sure"] == "±1.13 N·m RMS misfit, equation (16)"


def test_what_is_wrong_names_the_causes(diagnosed, two_runs):
    said = by_question(diagnosed)["What the simulation gets wrong"]
    assert "Stribeck friction" in said
    assert "not diagnosed yet" in by_question(two_runs)["What the simulation gets wrong"]


def test_structure_without_a_name_is_said_beside_the_causes(diagnosed):
    document = structs.replace(
        diagnosed.diagnosis.document,
        verdict="unnamed",
        structure=StructureRecord(
            axis=("position",), channel="friction", description="a bump", size=1.2
        ),
        remainder=RemainderRecord(
            basis="new_run",
            rmse=1.3,
            noise_floor=0.5,
            size=1.2,
            axis="load",
            channel="friction",
            axis_size=1.0,
        ),
    )
    changed = replace(diagnosed, diagnosis=replace(diagnosed.diagnosis, document=document))
    said = by_question(changed)["What the simulation gets wrong"]
    assert said.startswith("Stribeck friction")
    assert "and structure without a name" in said
    assert said.endswith("1.2 N·m unexplained, structure over angle")


@pytest.mark.parametrize(
    ("axis_size", "words"),
    [
        (0.9, ", varying mostly with the joint angle"),
        (0.6, ", varying partly with the joint angle"),
        (0.1, ""),
    ],
)
def test_an_axis_is_said_as_far_as_the_remainder_varies_along_it(diagnosed, axis_size, words):
    """The axis has 0.81, 0.36 and 0.01 of the mean square."""
    left = RemainderRecord(
        basis="new_run",
        rmse=1.1,
        noise_floor=0.5,
        size=1.0,
        axis="position",
        channel="friction",
        axis_size=axis_size,
    )
    document = structs.replace(diagnosed.diagnosis.document, remainder=left)
    changed = replace(diagnosed, diagnosis=replace(diagnosed.diagnosis, document=document))
    assert by_question(changed)["What the simulation gets wrong"].endswith(
        f"1.0 N·m unexplained{words}"
    )
    told = remainder_text(document)
    assert ("does not clearly vary" in told) == (not words)
    assert ("most of it, 0.90 N·m" in told) == ("mostly" in words)


def test_without_temperature_the_point_has_none(without_temperature):
    point = operating_point(without_temperature)
    assert np.isnan(point.temperature)
    assert "°C" not in point.conditions
    assert len(overview_figure(without_temperature).axes[0].get_lines()) > 0


def test_the_picture_holds_the_point_and_both_intervals(diagnosed):
    panel = overview_figure(diagnosed).axes[0]
    point = operating_point(diagnosed)
    bars = [container for container in panel.containers if container.has_yerr]
    heights = []
    for container in bars:
        (segments,) = container.lines[2]
        ((_, low), (_, high)) = segments.get_segments()[0]
        assert (low + high) / 2 == pytest.approx(point.friction)
        heights.append((high - low) / 2)
    assert heights == pytest.approx([1.96 * 2.0, 1.96 * 1.0])


def test_a_gain_on_its_own_training_data_is_not_recommended(diagnosed):
    document = diagnosed.diagnosis.document
    own = structs.replace(document, gain=structs.replace(document.gain, basis="within_run"))
    results = replace(diagnosed, diagnosis=replace(diagnosed.diagnosis, document=own))
    assert by_question(results)["What to do next"].strip() == "test on a new run"
    assert word_count(answers(results)) < 60


def test_a_model_with_undetermined_parameters_is_not_recommended(diagnosed, without_temperature):
    clean = structs.replace(diagnosed.diagnosis.document, verdict="no_evidence", gain=None)
    found = replace(diagnosed.diagnosis, document=clean)
    said = by_question(replace(diagnosed, diagnosis=found))
    assert said["What to do next"].strip() == "use equation (16)"
    said = by_question(replace(without_temperature, diagnosis=found))
    assert said["What to do next"].startswith("measure more γ and δ not determined;")


def test_curves_are_dotted_beyond_the_measured_speeds(diagnosed):
    panel = overview_figure(diagnosed).axes[0]
    curves = [line for line in panel.lines if len(line.get_xdata()) > 100]
    solid = [line for line in curves if line.get_linestyle() == "-"]
    dotted = [line for line in curves if line.get_linestyle() == ":"]
    assert len(solid) == len(dotted) == 3
    speeds = diagnosed.pairs["speed"]
    for line in solid:
        drawn = line.get_xdata()[np.isfinite(line.get_ydata())]
        assert speeds.min() <= drawn.min() < drawn.max() <= speeds.max()
    assert all(line.get_xdata()[0] == 0.0 for line in dotted)


def test_a_gain_that_may_be_none_is_not_recommended(diagnosed):
    document = diagnosed.diagnosis.document
    unsure = structs.replace(document, gain=structs.replace(document.gain, ci95=(-0.1, 0.4)))
    results = replace(diagnosed, diagnosis=replace(diagnosed.diagnosis, document=unsure))
    said = by_question(results)
    assert "extended model" not in said["How sure"]
    assert "use the extended model" not in said["What to do next"]
