"""The friction function as a formula with numbers and units."""

from dataclasses import replace

from frictioncli.report.formula import formula_symbols, friction_formula, unit_markup
from frictioncli.report.model_section import formula_text


def test_formula_has_the_numbers_with_their_units(two_runs, without_temperature):
    assert friction_formula(two_runs.model).striptags() == (
        "τ = 10.57 N·m + 0.001400/(N·m) · L² + (3.480 N·m/(deg/s)½ + 15.66 N·m/(deg/s)½"
        " · e−0.05600/°C · T) · √v"
    )
    assert friction_formula(without_temperature.model).striptags() == (
        "τ = 10.57 N·m + 0.001400/(N·m) · L² + 6.500 N·m/(deg/s)½ · √v"
    )
    assert "T: motor temperature Tm in °C" in formula_symbols(two_runs)
    assert "T:" not in formula_symbols(without_temperature)
    assert unit_markup("<b>^2") == "&lt;b&gt;²"


def test_an_exponent_has_one_sign(two_runs):
    model = two_runs.model
    delta = replace(model.parameters["delta"], estimate=-0.02)
    rising = replace(model, parameters={**model.parameters, "delta": delta})
    assert "· e0.02000/°C · T" in friction_formula(rising).striptags()
    assert "exp(0.02*T)" in formula_text(rising)
    assert "exp(-0.056*T)" in formula_text(model)
