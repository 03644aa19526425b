"""Colours of the page by WCAG 2.1: text 4.5 to 1 (AA, 1.4.3), marks and borders 3 to 1 (1.4.11)."""

import re
from importlib.resources import files

import pytest

CSS = (files("frictioncli.report") / "style.css").read_text(encoding="utf-8")


def palettes():
    """The colours of the light page, the dark one and the printed one."""
    blocks = re.findall(r":root \{([^}]*)\}", CSS)
    assert len(blocks) == 3
    light, dark, printed = (
        dict(re.findall(r"--([a-z]+):\s*(#[0-9a-f]{6})", block)) for block in blocks
    )
    return {"light": light, "dark": light | dark, "print": light | printed}


def luminance(colour):
    """Relative luminance of sRGB, as WCAG defines it."""
    parts = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_the_measure_itself():
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    # the example that is often given for the least grey on white that passes
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)


@pytest.mark.parametrize("theme", ["light", "dark", "print"])
@pytest.mark.parametrize("ground", ["page", "tint"])
@pytest.mark.parametrize(
    "text", ["text", "quiet", "accent", "warn", "good", "fair", "poor", "heating", "cooling"]
)
def test_text_stands_out(theme, ground, text):
    colours = palettes()[theme]
    assert contrast(colours[text], colours[ground]) >= 4.5


@pytest.mark.parametrize("theme", ["light", "dark", "print"])
@pytest.mark.parametrize("lamp", ["good", "fair", "poor"])
def test_signs_stand_out_of_their_lamps(theme, lamp):
    colours = palettes()[theme]
    assert contrast(colours["page"], colours[lamp]) >= 4.5


def test_every_colour_of_the_page_is_one_of_these():
    rules = re.sub(r":root \{[^}]*\}", "", CSS)
    # figures are drawn on white and inverted in the dark, with the frames of their cells
    assert set(re.findall(r"#[0-9a-fA-F]{3,8}\b(?![\w-]*\s*\{)", rules)) <= {
        "#ffffff",
        "#000000",
    }
