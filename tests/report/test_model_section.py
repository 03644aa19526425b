"""Both models side by side, with intervals, and formulas that other programs can read."""

import math
from dataclasses import replace

from msgspec import structs

from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.report.diagnosis_section import diagnosis_section
from frictioncli.report.model_section import (
    formula_text,
    model_cards,
    parameters_table,
    poorly_determined,
    undetermined_base,
)


def test_the_formula_as_text_gives_the_friction(diagnosed):
    formula = formula_text(diagnosed.model).removeprefix("tau = ")
    names = {"exp": math.exp, "sqrt": math.sqrt, "abs": abs, "L": 20.0, "v": 43.0, "T": 35.0}
    value = eval(formula, {"__builtins__": {}}, names)
    wanted = float(diagnosed.predict(load=20.0, speed=43.0, temperature=35.0))
    assert math.isclose(value, wanted, rel_tol=1e-5)


def test_both_models_stand_side_by_side(diagnosed, two_runs):
    base, extended = model_cards(diagnosed)
    assert "RMS torque error 2.00 N·m on run day-2, not used for fitting" in base.use
    assert "RMS torque error 1.00 N·m on run day-2, not used for fitting" in extended.use
    assert base.text in formula_text(diagnosed.model)
    assert [name for name, _, _ in extended.terms] == ["Stribeck friction", "direction asymmetry"]
    assert "ts*exp(-(v/vs)^k)" in extended.text
    assert "velocity = 8" in extended.text
    assert len(model_cards(two_runs)) == 1


def test_the_table_has_the_parameters_of_both_with_intervals(diagnosed, two_runs):
    table = parameters_table(diagnosed)
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["τc"][:2] == ("10.57", "10.0 to 11.1")
    assert float(rows["τc"][2]) != 10.57
    assert rows["Stribeck friction: boundary torque"] == ("–", "–", "3.000", "2.50 to 3.50", "N·m")
    assert parameters_table(two_runs) is None


def test_poorly_determined_parameters_stand_beside_the_name(diagnosed):
    def with_parameters(parameters):
        document = diagnosed.diagnosis.document
        first, *others = document.causes
        cause = structs.replace(first, parameters=parameters)
        changed = structs.replace(document, causes=(cause, *others))
        results = replace(diagnosed, diagnosis=replace(diagnosed.diagnosis, document=changed))
        return diagnosis_section(results).causes[0]

    sure = ParameterRecord(estimate=3.0, ci95=(2.9, 3.1), unit="N·m")
    lost = ParameterRecord(estimate=1.0, ci95=(-4.0, 6.0), unit="N·m")
    assert with_parameters({"boundary_torque": sure}).doubt == ""
    found = with_parameters({"boundary_torque": lost})
    assert found.doubt == "boundary torque not determined"
    assert any("boundary torque not determined" in one for one in found.against)
    assert poorly_determined({}) == ""
    any_size = ParameterRecord(estimate=0.8, ci95=(1e-10, 8e9), unit="N·m")
    found = with_parameters({"boundary_torque": any_size})
    assert found.doubt == found.parameters == "boundary torque not determined"


def test_what_the_extended_model_leaves_open_is_said(diagnosed, two_runs):
    def left_open(name, ci95):
        extended = diagnosed.extended_model
        one = replace(extended.parameters[name], ci95=ci95)
        changed = replace(extended, parameters=extended.parameters | {name: one})
        return undetermined_base(replace(diagnosed, extended_model=changed))

    assert undetermined_base(diagnosed) == undetermined_base(two_runs) == ""
    # left out of the model
    assert left_open("gamma", None) == ""
    assert left_open("gamma", (3.0, 20.0)) == ""
    assert left_open("gamma", (-3.0, 20.0)).startswith(
        "In the extended model these data do not determine γ, not even the sign"
    )
