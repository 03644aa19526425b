"""Every number on the page equals one of its table or document, rounded as it is written."""

import json
from dataclasses import replace
from itertools import pairwise
from shutil import copyfile

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.report import drawing
from frictioncli.report.page import write_report
from frictioncli.wording import in_words, number_text
from tests.report.page_numbers import Page, agrees, leaves, numbers, value
from tests.report.plan_document import PLAN

FIXED = {
    *range(3, 22),  # figures and equations of the paper
    2.0,  # its error, N·m
    4.0,  # good from 4 speeds over a ratio of 4
    10.0,  # good from a span of 10 °C
    20.0,  # good from a span of 20 °C; T0
    30.0,  # fair from 30 pairs
    50.0,  # a parameter is imprecise beyond ±50 %
    80.0,  # power of a test, %
    95.0,  # confidence, %
    99.0,  # a probability over 99 %
    100.0,  # good from 100 pairs
    2019.0,
    6931563.0,
}
"""Numbers that stand in the sentences themselves."""

TABLES = (
    "Parameters of both models",
    "Blocks in order",
    "Half-widths of 95 % intervals",
    "day-1: error",
    "day-2: error",
    "day-1: the same where",
    "day-2: the same where",
    "Largest mean errors",
    "Smallest size of each effect",
    "Parameters of the friction function",
    "Correlations of the estimates",
    "Pairs per speed and phase",
    "Reading",
    "Rejected rows and files",
    "Samples used and left out",
)
"""Beginnings of the captions of all tables on the page, in order; each has a test below."""

CORRELATION = {
    "tau_c": {"tau_c": 1.0, "beta": -0.954, "delta": 0.37},
    "beta": {"tau_c": -0.954, "beta": 1.0, "delta": 0.5},
    "delta": {"tau_c": 0.37, "beta": 0.5, "delta": 1.0},
}

UNDETERMINED = [-3.25, 34.5]
"""Interval of the extended model's gamma, which spans 0."""


@pytest.fixture(scope="module")
def work(tmp_path_factory, write_work, diagnosed_work):
    """A work folder with everything, and its page; figures are captioned but not drawn."""
    work = write_work(tmp_path_factory.mktemp("numbers"))
    copyfile(diagnosed_work / "diagnosis.json", work / "diagnosis.json")
    model = json.loads((work / "model.json").read_text(encoding="utf-8"))
    model["correlation"] = CORRELATION
    (work / "model.json").write_text(json.dumps(model), encoding="utf-8")
    (work / "plan.json").write_text(json.dumps(PLAN), encoding="utf-8")
    for name in PLAN["programme"]["files"]:
        (work / name).write_text("speed_deg_s\n", encoding="utf-8")
    extended = json.loads((diagnosed_work / "extended-model.json").read_text(encoding="utf-8"))
    extended["parameters"]["gamma"]["ci95"] = UNDETERMINED
    (work / "extended-model.json").write_text(json.dumps(extended), encoding="utf-8")

    def undrawn(specs):
        return [replace(spec, draw=lambda results: None) for spec in specs]

    diagnosis_figures = drawing.diagnosis_figures
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drawing, "FIGURES", undrawn(drawing.FIGURES))
        patch.setattr(drawing, "OVERVIEW", *undrawn([drawing.OVERVIEW]))
        patch.setattr(
            drawing, "diagnosis_figures", lambda diagnosis: undrawn(diagnosis_figures(diagnosis))
        )
        patch.setattr(drawing, "svg", lambda figure, name, title: "<svg></svg>")
        write_report(work)
    return work


@pytest.fixture(scope="module")
def page(work):
    return Page((work / "report" / "index.html").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def documents(work):
    return {
        name: json.loads((work / f"{name}.json").read_text(encoding="utf-8"))
        for name in ("model", "extended-model", "diagnosis", "plan")
    }


def table(page, beginning):
    """The only table whose caption begins so: rows of stripped cells."""
    ((rows,),) = [found for caption, found in page.tables.items() if caption.startswith(beginning)]
    return [[cell.strip() for cell in row] for row in rows]


def test_parameters_are_those_of_the_model(page, documents):
    rows = table(page, "Parameters of the friction function")[1:]
    stated = documents["model"]["parameters"]
    assert len(rows) == len(stated)
    for row, one in zip(rows, stated.values(), strict=True):
        assert row[1] == number_text(one["estimate"], 4)
        assert row[2] == " to ".join(number_text(end) for end in one["ci95"])


def test_both_models_stand_beside_each_other(page, documents):
    rows = {row[0]: row[1:] for row in table(page, "Parameters of both models")[2:]}
    for place, name in ((0, "model"), (2, "extended-model")):
        for one, cells in zip(documents[name]["parameters"].values(), rows.values(), strict=False):
            assert agrees(cells[place], [one["estimate"]])
    assert rows["γ"][3] == " to ".join(number_text(end) for end in UNDETERMINED)
    assert any("do not determine γ, not even the sign" in text for _, _, text in page.texts)


def test_every_table_is_walked(page):
    # the table of the explorer is filled by its script
    captions = [caption for caption in page.tables if caption]
    assert len(captions) == len(TABLES)
    assert all(map(str.startswith, captions, TABLES))


CRITERIA = {
    "first degree": "first_degree",
    "latest degree": "latest_degree",
    "equally spaced": "equal",
    "uncertainty": "uncertainty",
}


@pytest.mark.parametrize(("title", "column"), [("error", "k"), ("the same where", "bound")])
def test_errors_are_those_of_the_evaluation(page, work, title, column):
    rows = tables.read(work / "evaluation.parquet", schemas.EVALUATION)
    seen = 0
    for run in ("day-1", "day-2"):
        groups, header, without, *body = table(page, f"{run}: {title}")
        half = sum(name in CRITERIA for name in header) // 2
        assert groups[1:] == ["heating", "cooling"]
        own = rows[rows["run"] == run]
        for phase, place in (("heat-up", -2 * half), ("cool-down", -half)):
            (none,) = own[(own["criterion"] == "none") & (own["phase"] == phase)]["epsilon"]
            assert without[place] == f"{number_text(none)} (0)"
        keyed = own.set_index(["phase", "criterion", column])
        for row in body:
            setting = float(row[0].removeprefix("k = "))
            for place, name in enumerate(header):
                if name not in CRITERIA:
                    continue
                phase = "heat-up" if place < len(header) - half else "cool-down"
                key = (phase, CRITERIA[name], setting)
                if key not in keyed.index:
                    assert row[place] == "–"
                    continue
                one = keyed.loc[key]
                failed = f", {one['failed']} failed" if one["failed"] else ""
                assert row[place] == f"{number_text(one['epsilon'])} ({one['corrections']}{failed})"
                seen += 1
    assert seen > 10


def test_correlations_are_those_of_the_model(page):
    (_, *names), *body = table(page, "Correlations of the estimates")
    keys = dict(zip(names, CORRELATION, strict=True))
    for row in body:
        for name, cell in zip(names, row[1:], strict=True):
            if cell:
                assert agrees(cell.removeprefix("+"), [CORRELATION[keys[row[0]]][keys[name]]])
    assert [row[1] for row in body] == ["1", "−0.95", "+0.37"]


def test_the_next_experiment_is_that_of_the_plan(page):
    blocks = PLAN["programme"]["blocks"]
    rows = table(page, "Blocks in order")[1:]
    assert [row[0] for row in rows] == [block["name"] for block in blocks]
    for row, block in zip(rows, blocks, strict=True):
        assert row[1:3] == [block["reason"], "1"]
        assert agrees(row[3], [block["duration_s"] / 60])
    (row,) = table(page, "Half-widths of 95 % intervals")[1:]
    one = PLAN["intervals"][0]
    assert row[0] == "run-in: travel"
    for cell, key in zip(row[1:4], ("estimate", "half_width_now", "half_width_after"), strict=True):
        assert agrees(cell.removeprefix("±"), [one[key]])
    assert row[4] == one["unit"]


def test_counts_are_those_of_reading_and_pairing(page, work):
    recordings = tables.read(work / "recordings.parquet", schemas.RECORDINGS)
    columns = ["rows_read", "rows_kept", "rows_rejected"]
    for run, files, *counts in table(page, "Reading")[1:]:
        own = recordings[recordings["run"] == run]
        assert int(files) == len(own)
        assert [value(count) for count in counts] == own[columns].sum().tolist()
    rejected = tables.read(work / "rejected.parquet", schemas.REJECTED)["reason"].value_counts()
    found = {reason: int(count) for reason, count in table(page, "Rejected rows and files")[1:]}
    assert found == rejected.to_dict()
    torques = tables.read(work / "torques.parquet", schemas.TORQUES)
    used = int(torques[["n_forward", "n_reverse"]].to_numpy().sum())
    wanted = {**tables.facts(work / "pairs.parquet")["dropped"], "used in pairs": used}
    assert {
        reason: value(count) for reason, count in table(page, "Samples used and left out")[1:]
    } == wanted


def test_pairs_are_those_of_the_torques(page, work):
    torques = tables.read(work / "torques.parquet", schemas.TORQUES)
    pairs = torques.drop_duplicates(["run", "joint", "pair"])
    header, *body = table(page, "Pairs per speed and phase")
    assert header[1:] == ["heating", "cooling", "sweep", "all"]
    for row in body:
        own = pairs[pairs["speed"].round(1) == float(numbers(row[0])[0])]
        counts = [int((own["phase"] == phase).sum()) for phase in ("heat-up", "cool-down", "sweep")]
        assert [int(cell) for cell in row[1:]] == [*counts, len(own)]


def test_smallest_sizes_are_those_of_the_diagnosis(page, documents):
    stated = documents["diagnosis"]["detectable"]
    rows = {row[0]: row[1] for row in table(page, "Smallest size of each effect")[1:]}
    for name, size in stated.items():
        shown = rows[in_words(name)]
        if size is not None and numbers(shown):
            assert agrees(numbers(shown)[0], [size])


def test_largest_misfits_are_those_of_the_diagnosis(page, documents):
    worst = documents["diagnosis"]["simulation"]["worst"]
    rows = table(page, "Largest mean errors of the simulated torque")[1:]
    assert len(rows) == len(worst)
    for row, one in zip(rows, worst, strict=True):
        low, high = numbers(row[0])
        assert agrees(low, [one["low"]])
        assert agrees(high, [one["high"]])
        assert agrees(numbers(row[-1])[0], [one["misfit"]])


def derived(work, documents):
    """What the sentences state of the tables: ranges, counts, errors of the schedule, shares."""
    torques = tables.read(work / "torques.parquet", schemas.TORQUES)
    pairs = torques.drop_duplicates(["run", "pair"])
    evaluation = tables.read(work / "evaluation.parquet", schemas.EVALUATION)
    schedule = tables.read(work / "schedule.parquet", schemas.SCHEDULE)
    recordings = tables.read(work / "recordings.parquet", schemas.RECORDINGS)
    rejected = tables.read(work / "rejected.parquet", schemas.REJECTED)
    model = documents["model"]
    yield from (len(pairs), pairs["run"].nunique(), pairs["speed"].nunique())
    for column in ("speed", "motor_temperature", "housing_temperature", "load_torque"):
        yield from (torques[column].min(), torques[column].max())
    for _, own in pairs[pairs["phase"] != "sweep"].groupby(["run", "phase"], observed=True):
        in_time = own.sort_values("time")
        yield from in_time["motor_temperature"].iloc[[0, -1]]
        yield from (own["motor_temperature"].min(), own["motor_temperature"].max())
        minutes = (own["time"].max() - own["time"].min()) / 60
        yield from (minutes, minutes % 60, minutes // 60)
        fastest = own[own["speed"] == own["speed"].max()]
        yield from fastest["housing_temperature"]
        yield from fastest["motor_temperature"]
    alpha = model["parameters"]["alpha"]["estimate"]
    unloaded = torques["friction_torque"] - alpha * np.square(torques["load_torque"])
    by_pair = unloaded.groupby([torques["run"], torques["pair"]]).mean()
    yield from (by_pair.min(), by_pair.max(), torques["joint"].iloc[0])
    fastest = pairs[pairs["speed"] == pairs["speed"].max()].set_index(["run", "pair"])
    yield from by_pair[fastest.index]
    yield from pairs["speed"].unique()
    for (_, phase), own in schedule.groupby(["run", "phase"], observed=True):
        missed = own["friction_smoothed"] - own["friction_predicted"]
        yield float(np.sqrt(np.mean(np.square(missed))))
        yield from (own["corrected"].sum(), (own["corrected"] | own["failed"]).sum())
        yield from (own["failed"].sum(), own["time"].max() - own["time"].min(), len(phase))
    yield from schedule["temperature_correction"].dropna()
    yield from (schedule["k"].iloc[0], schedule["tmax"].iloc[0] / 60)
    settings = evaluation.groupby(["run", "phase", "criterion", "corrections"], dropna=False)
    yield from settings["epsilon"].median()
    yield from evaluation["corrections"]
    yield from (len(recordings), recordings["rows_read"].sum(), recordings["rows_kept"].sum())
    used = torques[["n_forward", "n_reverse"]].sum().sum()
    yield 100 * used / tables.facts(work / "pairs.parquet")["samples"]
    yield from (len(rejected), *rejected["reason"].value_counts())
    for stated in (model["parameters"], documents["extended-model"]["parameters"]):
        for one in stated.values():
            if one["ci95"]:
                low, high = one["ci95"]
                yield 100 * abs((high - low) / 2 / one["estimate"])
    gain = documents["diagnosis"]["gain"]
    yield from (100 * share for share in (gain["reduction"], *gain["ci95"]))


def operating_point(page, documents):
    """Friction at the operating point of the first screen, by equation (16)."""
    stated = [text for _, tag, text in page.texts if tag == "dd" and "unloaded, at" in text]
    speed, temperature = (float(one) for one in numbers(stated[0])[:2])
    values = {n: one["estimate"] for n, one in documents["model"]["parameters"].items()}
    viscous = values["beta"] + values["gamma"] * np.exp(-values["delta"] * temperature)
    return temperature, values["tau_c"] + viscous * np.sqrt(speed)


def test_every_number_of_the_text_has_a_source(page, work, documents):
    sources = [one for document in documents.values() for one in leaves(document)]
    # minutes and milliseconds, shares in per cent, positive and negative
    sources += [factor * one for one in tuple(sources) for factor in (1 / 60, 100, 1000)]
    sources += [float(one) for one in derived(work, documents)]
    sources += operating_point(page, documents)
    sources += [-one for one in tuple(sources)]
    sources += [float(one) for one in FIXED]
    # provenance and citation quote files and settings, explanations of effects the catalogue
    quoted = ("origin", "cite", "effect")
    texts = [(tag, text) for section, tag, text in page.texts if not section.startswith(quoted)]
    walked = [(written, text) for _, text in texts for written in numbers(text)]
    assert len(walked) > 80
    strangers = [one for one in walked if not agrees(one[0], sources)]
    assert strangers == []


def test_a_number_from_elsewhere_would_be_seen():
    assert agrees("1.33", [1.3349])
    assert not agrees("1.33", [1.336])
    assert agrees("−0.0618", [-0.06182])
    assert agrees("629,802", [629802])
    assert numbers("day1: 1.95 against 2.27 N·m (95 %)") == ["1.95", "2.27", "95"]
    assert not any(agrees("2.27", [one]) for one, _ in pairwise([1.95, 2.2, 2.28]))
