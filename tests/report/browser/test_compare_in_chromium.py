"""The page of a comparison in a browser: whole at any width, no errors, links by keyboard."""

import pytest

from frictioncli.report.compare_page import compare_html
from tests.report.test_trend_figure import document

SVG = '<svg viewBox="0 0 10 10" role="img" aria-label="trend"><path d="M0 0h10"/></svg>'


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    found = document()
    path = tmp_path_factory.mktemp("comparison") / "compare.html"
    addresses = {found.folders[0]: "../one/report/index.html"}
    path.write_text(compare_html(found, SVG, addresses), encoding="utf-8")
    return path


@pytest.mark.parametrize("width", [390, 1440])
def test_nothing_overflows_and_nothing_fails(chromium, page, width):
    size = {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500}
    chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    chromium.get_log("browser")
    chromium.get(page.as_uri())
    assert chromium.get_log("browser") == []
    assert chromium.execute_script("return document.documentElement.scrollWidth") <= width


def test_links_and_buttons_are_reached_by_keyboard(chromium, page):
    chromium.get(page.as_uri())
    reached = []
    for _ in range(20):
        chromium.switch_to.active_element.send_keys("\ue004")  # the key for tab
        reached.append(chromium.switch_to.active_element.get_attribute("textContent").strip())
    assert {"SVG", "PNG", document().folders[0], "comparison.json", "trend.svg"} <= {*reached}


def test_print_has_no_links_to_files(chromium, page):
    chromium.get(page.as_uri())
    shown = """return [...document.querySelectorAll(arguments[0])].some(
        (element) => element.checkVisibility())"""
    for media, links in (("", True), ("print", False)):
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media})
        assert chromium.execute_script(shown, "a[href]") is links
        assert chromium.execute_script(shown, "#trend svg, table")
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
