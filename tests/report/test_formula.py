"""The friction function as a formula with numbers and units."""

from frictioncli.report.formula import formula_symbols, friction_formula, unit_markup


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
