"""Explanations of the effects that a diagnosis mentions."""

import re

import pytest

from frictioncli.effects import BY_NAME
from frictioncli.report.effect_explanations import explained, explanation, source_markup
from frictioncli.report.page import write_report


@pytest.mark.parametrize("name", BY_NAME)
def test_every_effect_is_explained_with_its_symbols_and_source(name):
    found = explanation(name, "A")
    assert found.summary.endswith(".")
    for symbol, meaning, unit in found.parameters:
        assert symbol in found.equation
        assert meaning
        assert "torque" not in unit
    assert found.source


def test_identifiers_of_publications_are_links():
    text = source_markup("After <Dahl>, doi:10.1016/0005-1098(94)90209-7; see arXiv:2410.08650")
    assert re.findall(r'href="([^"]*)"', text) == [
        "https://doi.org/10.1016/0005-1098(94)90209-7",
        "https://arxiv.org/abs/2410.08650",
    ]
    assert "&lt;Dahl&gt;" in text


def test_names_outside_of_the_catalogue_have_no_explanation():
    assert explained(("other_joint", "stribeck")) == ("stribeck",)


def test_each_cause_leads_to_its_explanation(diagnosed_work):
    page = write_report(diagnosed_work).read_text(encoding="utf-8")
    targets = re.findall(r'<article id="(effect-\w+)"', page)
    assert len(targets) == len({*targets})
    links = re.findall(r'href="#(effect-\w+)"', page)
    assert {"effect-stribeck", "effect-dress_pack"} <= {*links} <= {*targets}
