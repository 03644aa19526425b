"""A cell of the residual maps shows its points in the chart, by mouse and by keyboard."""

import re
import shutil

import numpy as np
import pytest

from frictioncli.report.data_points import data_points
from frictioncli.report.page import write_report
from frictioncli.report.residual_maps import cell_means, map_axes
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


LABEL = "return document.activeElement.getAttribute('aria-label')"


@pytest.mark.usefixtures("without_figures")
def test_the_keyboard_reaches_every_cell(chromium, diagnosed_work, tmp_path):
    work = shutil.copytree(diagnosed_work, tmp_path / "work")
    chromium.get(write_report(work).as_uri())
    joint = read_results(work).joints[0]
    seen = joint.diagnosis.seen
    axes = map_axes(seen.problem.table, joint.model.temperature)
    cells = data_points(joint)["cells"]
    known = {
        model: cell_means(
            axes["temperature"], axes["speed"], misfit["friction"], seen.problem.table.pair
        )[0]
        for model, misfit in (("base", seen.before), ("extended", seen.after))
    }
    stops = chromium.find_elements("css selector", "#diagnosis-maps svg [tabindex='0']")
    assert len(stops) == 1
    assert chromium.execute_script("return arguments[0].closest('[role=img]')", stops[0]) is None
    chromium.execute_script("arguments[0].focus()", stops[0])
    rows, columns = known["base"].shape
    told = 0
    for column in range(columns):
        label = chromium.execute_script(LABEL)
        # the first cell is that of the fastest speed, at the left
        where = f"{cells['temperature']['texts'][column]}, {cells['speed']['texts'][-1]}"
        assert label.startswith(f"friction, base model: {where}: ")
        mean = known["base"][rows - 1, column]
        if np.isfinite(mean):
            value = float(re.search(r"mean residual (\S+) N·m", label)[1].replace("−", "-"))
            assert value == pytest.approx(mean, abs=0.011)
            told += 1
        else:
            assert "no data" in label
        chromium.switch_to.active_element.send_keys("\ue014")  # the key for right
    assert told > 0
    # beyond the last cell lies the map of the extended model
    assert chromium.execute_script(LABEL).startswith(
        f"friction, extended model: {cells['temperature']['texts'][0]}, "
    )
    for _ in range(rows):
        chromium.switch_to.active_element.send_keys("\ue015")  # the key for down
    # below the last one lies the map over time
    assert "extended model" in chromium.execute_script(LABEL)
    assert cells["position"]["texts"][-1] in chromium.execute_script(LABEL)
    assert len(chromium.find_elements("css selector", "#diagnosis-maps svg [tabindex='0']")) == 1
    chromium.switch_to.active_element.send_keys("\ue007")  # the key for enter
    assert chromium.execute_script("return document.activeElement.tagName") == "CANVAS"
    shown = chromium.find_element("css selector", ".look [data-part=told]").text
    assert cells["position"]["texts"][-1] in shown
