"""Figures that cannot be drawn say what data they need."""

from dataclasses import replace

import pytest

from tests.report.figure_contents import FIGURE_SPECS


@pytest.mark.parametrize("name", ["fig4", "fig5", "fig6", "fig7", "fig9", "fig10", "fig11"])
def test_without_temperature_there_is_a_statement(without_temperature, name):
    missing = FIGURE_SPECS[name].missing(without_temperature)
    assert "temperature" in missing
    assert "This needs a channel" in missing


def test_without_a_schedule_the_statement_names_the_command(two_runs):
    bare = replace(
        two_runs, schedule=two_runs.schedule.iloc[:0], evaluation=two_runs.evaluation.iloc[:0]
    )
    assert "frictioncli simulate" in FIGURE_SPECS["fig9"].missing(bare)
    assert "frictioncli evaluate" in FIGURE_SPECS["fig11"].missing(bare)


def test_sweep_alone_has_no_phases(two_runs):
    pairs = two_runs.pairs[two_runs.pairs["phase"] == "sweep"]
    sweep = replace(two_runs, pairs=pairs)
    assert "no heating or cooling phase" in FIGURE_SPECS["fig5"].missing(sweep)
    assert FIGURE_SPECS["fig8"].missing(sweep) == ""
