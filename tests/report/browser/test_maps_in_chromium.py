"""A click on a residual map shows the points of its cell in the chart."""

import re
import shutil

import pytest

from frictioncli.report.data_points import data_points
from frictioncli.report.page import write_report
from frictioncli.report.results import read_results

CLICK = """
const map = document.querySelector(`[id^="diagnosis-maps-cells-${arguments[0]}-friction"]`);
const { left, top, width, height } = map.getBoundingClientRect();
map.dispatchEvent(new MouseEvent("click", { bubbles: true,
  clientX: left + arguments[1] * width, clientY: top + (1 - arguments[2]) * height }));
return ["told", "axis", "what"].map((name) => {
  const part = document.querySelector(`.look [data-part=${name}]`);
  return part.value || part.textContent;
});
"""


@pytest.mark.usefixtures("without_figures")
def test_a_click_on_a_cell_shows_its_points(chromium, diagnosed_work, tmp_path):
    work = shutil.copytree(diagnosed_work, tmp_path / "work")
    chromium.get(write_report(work).as_uri())
    points = data_points(read_results(work).joints[0])
    speeds, temperatures = (points["cells"][name] for name in ("speed", "temperature"))
    row, column = 5, 5  # of the maps: a speed of the thermal cycle, and a temperature of heating
    count = sum(
        2 * length
        for length, speed, temperature in zip(
            points["length"], speeds["move"], temperatures["move"], strict=True
        )
        if (speed, temperature) == (row, column)
    )
    assert count > 0
    place = (column + 0.5) / len(temperatures["texts"]), (row + 0.5) / len(speeds["texts"])
    told, axis, what = chromium.execute_script(CLICK, "temperature-speed", *place)
    assert (axis, what) == ("motor", "residual")
    assert int(re.search(r"(\d+) points", told)[1]) == count
    assert f"{temperatures['texts'][column]}, {speeds['texts'][row]}" in told
    chromium.find_element("css selector", ".look [data-part=whole]").click()
    shown = chromium.find_element("css selector", ".look [data-part=told]").text
    assert shown == f"{points['moves']} moves."
