"""The table of a fleet in a browser: sorted, searched, drawn as far as it is looked at."""

import time

import pytest

from frictioncli.report.fleet_page import fleet_html
from frictioncli.wording import change_text, number_text

TEXTS = "return [...document.querySelectorAll(arguments[0])].map((cell) => cell.textContent)"

ROBOTS = 100
HOSTILE = "<img src=x onerror='window.broken = 1'>"


def row(number):
    change = (number % 7) - 3.2
    return {
        "robot": f"R{number // 6}" if number else HOSTILE,
        "joint": number % 6 + 1,
        "runs": 4,
        "status": "done",
        "message": "",
        "torque_unit": "N·m",
        "verdict": ("named", "no_evidence")[number % 2],
        "causes": "drift" if number % 2 == 0 else "",
        "friction_40": 30.0 + 0.0137 * number,
        "change": change,
        "change_low": change - 1.0,
        "change_high": change + 1.0,
        "friction_by_run": [-0.1, 0.0, -0.1, 0.2],
    }


ROWS = [row(number) for number in range(6 * ROBOTS)]


@pytest.fixture(scope="module")
def opened(chromium, tmp_path_factory):
    page = tmp_path_factory.mktemp("fleet") / "fleet.html"
    addresses = [f"robot=R/joint={row['joint']}/report/index.html" for row in ROWS]
    page.write_text(fleet_html(ROWS, addresses), encoding="utf-8")
    size = {"width": 1440, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    chromium.get_log("browser")
    chromium.get(page.as_uri())
    return chromium


def texts(driver, place):
    """Texts of a column, from 1, of the rows that are drawn."""
    return driver.execute_script(TEXTS, f'[data-part="rows"] td:nth-child({place})')


def click(driver, heading):
    buttons = driver.find_elements("css selector", ".sort")
    next(button for button in buttons if button.get_attribute("textContent") == heading).click()


def test_no_errors_and_names_are_text(opened):
    assert opened.get_log("browser") == []
    assert opened.execute_script("return window.broken") is None
    assert HOSTILE in texts(opened, 1)


def test_values_are_those_of_the_rows_and_sorting_orders_them(opened):
    click(opened, "friction at 40\xa0°C [N·m]")
    assert texts(opened, 7)[:3] == [number_text(one["friction_40"]) for one in ROWS[:3]]
    click(opened, "friction at 40\xa0°C [N·m]")
    assert texts(opened, 7)[0] == number_text(ROWS[-1]["friction_40"])
    last = ROWS[-1]
    told = change_text(last["change"], (last["change_low"], last["change_high"]), "")
    assert texts(opened, 6)[0] == told
    pressed = opened.find_element("css selector", '[aria-sort="descending"]')
    assert "friction at 40" in pressed.get_attribute("textContent")


def test_headings_sort_by_the_keyboard(opened):
    opened.execute_script("document.querySelectorAll('.sort')[1].focus()")
    for order, joint in (("ascending", "1"), ("descending", "6")):
        opened.switch_to.active_element.send_keys("\ue007")  # the key for enter
        head = opened.find_element("css selector", f'[aria-sort="{order}"]')
        assert head.text.startswith("joint")
        assert texts(opened, 2)[0] == joint
        assert opened.switch_to.active_element.text.startswith("joint")


def test_rows_are_drawn_as_far_as_they_are_looked_at(opened):
    assert 100 <= len(texts(opened, 1)) <= 300
    opened.execute_script("scrollTo(0, document.body.scrollHeight)")
    patience = time.monotonic() + 20
    while len(texts(opened, 1)) <= 300 and time.monotonic() < patience:
        opened.execute_script("scrollTo(0, document.body.scrollHeight)")
    assert len(texts(opened, 1)) > 300


def test_a_search_and_a_group_leave_what_they_say(opened):
    field = opened.find_element("id", "find")
    field.clear()
    field.send_keys("drift")
    told = opened.find_element("css selector", '[data-part="told"]')
    assert told.text == "300 of 600 joints."
    assert set(texts(opened, 4)) == {"drift"}
    choice = opened.find_element("id", "only")
    choice.send_keys("changed")
    expected = sum(one["causes"] != "" and abs(one["change"]) > 1 for one in ROWS)
    assert told.text == f"{expected} of 600 joints."
