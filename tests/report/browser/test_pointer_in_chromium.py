"""Values under the pointer: those of the axes, at the place of a drawn point those of the point."""

import re

import pytest

from frictioncli.report.page import write_report
from tests.report.page_numbers import value


@pytest.fixture(scope="module")
def driver(tmp_path_factory, write_work, chromium):
    page = write_report(write_work(tmp_path_factory.mktemp("pointer")))
    chromium.get(page.as_uri())
    return chromium


def shown_at(driver, figure, shift):
    """Title of a figure's first point, and what is shown with the pointer so far above it."""
    return driver.execute_script(
        """
        const [name, shift] = arguments;
        const svg = document.querySelector(`#${name} svg`);
        const point = svg.querySelector("use > title").parentElement;
        svg.scrollIntoView({ block: "center" });
        const box = point.getBoundingClientRect();
        const place = { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2,
          bubbles: true };
        place.clientY -= shift;
        (shift ? svg : point).dispatchEvent(new PointerEvent("pointermove", place));
        const readout = svg.closest(".card").querySelector(".pointer");
        return [point.textContent, readout.hidden ? "" : readout.innerText];
        """,
        figure,
        shift,
    )


def test_axes_say_what_the_point_says(driver):
    point, shown = shown_at(driver, "fig5", 1e-6)
    temperature, torque = re.search(r", ([\d.]+) °C: ([\d.]+) N·m", point).groups()
    found = re.fullmatch(
        r"motor temperature Tm: ([−\d.]+) °C\nfriction torque τ: ([−\d.]+) N·m", shown
    )
    # a pixel is 0.1 °C and 0.2 N·m
    assert value(found[1]) == pytest.approx(value(temperature), abs=0.2)
    assert value(found[2]) == pytest.approx(value(torque), abs=0.4)


def test_a_point_with_values_of_its_own_shows_these_alone(driver):
    point, shown = shown_at(driver, "fig5", 0)
    assert point
    assert shown == ""


def test_every_figure_has_values_under_the_pointer(driver):
    silent = driver.execute_script(
        """
        return [...document.querySelectorAll("figure:has(.card svg)")].filter((figure) =>
          figure.querySelector("svg").dataset.panels === "[]" && !figure.querySelector("svg title"))
          .map((figure) => figure.id);
        """
    )
    assert silent == []
