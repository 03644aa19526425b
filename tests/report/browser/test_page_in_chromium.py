"""The page as a reader has it: in a browser, narrow and wide, dark, on paper, without scripts."""

import base64
import json
import re

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.correction.settings import EvaluationGrid
from frictioncli.report.page import write_report
from frictioncli.report.results import read_results
from frictioncli.stages.evaluate import evaluate
from frictioncli.wording import number_text
from tests.report.diagnosis_documents import extended_document
from tests.report.test_contrast import contrast

HOSTILE = (
    "</script><script>window.broken = 1</script><img src=x onerror='window.broken = 2'>\u202e$x$"
)
GRID = EvaluationGrid(k=(1.0, 2.5, 5.0, 10.0), tmax=(1800.0, 3600.0, 14400.0))
WIDTHS = (390, 1440)


TEXT_COLOURS = """
const found = new Map();
const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (texts.nextNode()) {
  const element = texts.currentNode.parentElement, text = texts.currentNode.data.trim();
  const hidden = "script, style, noscript, title, desc";
  if (!text || element.closest(hidden) || !element.checkVisibility()) continue;
  const figure = element.closest("svg"), style = getComputedStyle(element);
  const filtered = figure !== null && getComputedStyle(figure).filter !== "none";
  let ground = figure && filtered ? null : element;
  while (ground && getComputedStyle(ground).backgroundColor === "rgba(0, 0, 0, 0)") {
    ground = ground.parentElement;
  }
  const below = ground ? getComputedStyle(ground).backgroundColor : "rgb(255, 255, 255)";
  const seen = [figure ? style.fill : style.color, below, filtered];
  found.set(seen.join(), [...seen, text.slice(0, 30)]);
}
return [...found.values()];
"""
"""Colours of all texts: the text's, that below it, whether a filter inverts both, an example."""


@pytest.fixture(scope="module")
def work(tmp_path_factory, write_work):
    """A work folder with a page; the base model's evaluation stands there, the other beside it."""
    work = write_work(tmp_path_factory.mktemp("browser"), runs=("day-1", HOSTILE), schedule=False)
    model = extended_document(work, read_results(work).joints[0].torques, held_out=HOSTILE)
    (work / "extended-model.json").write_text(json.dumps(model), encoding="utf-8")
    evaluate(work, GRID, extended=True)
    (work / "evaluation.parquet").rename(work / "extended.parquet")
    evaluate(work, GRID)
    write_report(work)
    return work


@pytest.fixture(scope="module")
def page(work):
    return work / "report" / "index.html"


@pytest.fixture
def opened(chromium, page):
    """Return a function that opens the page anew."""

    def open_page(width=1440, scheme="light", *, scripts=True):
        for command, settings in (
            (
                "Emulation.setDeviceMetricsOverride",
                {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500},
            ),
            (
                "Emulation.setEmulatedMedia",
                {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
            ),
            ("Emulation.setScriptExecutionDisabled", {"value": not scripts}),
            ("Network.enable", {}),
        ):
            chromium.execute_cdp_cmd(command, settings)
        chromium.get_log("browser"), chromium.get_log("performance")
        chromium.get(page.as_uri())
        return chromium

    yield open_page
    chromium.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def requests(driver):
    events = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    sent = [event for event in events if event["method"] == "Network.requestWillBeSent"]
    return {event["params"]["request"]["url"] for event in sent}


def part(driver, name):
    return driver.find_element("css selector", f'[data-part="{name}"]')


def curves(driver):
    return [
        step.get_attribute("d") for step in driver.find_elements("css selector", ".charts .step")
    ]


def cells(driver):
    """The explorer's table: phase to corrections, error, error without any."""
    rows = driver.find_elements("css selector", '[data-part="errors"] tr')
    texts = [[cell.text for cell in row.find_elements("tag name", "td")] for row in rows]
    return {text[0]: text[1:] for text in texts}


def drawn_errors(driver, run):
    """The errors that a run's marks are drawn at by their axis, phase by phase."""
    marks, labels = driver.execute_script(
        """
        const name = [...document.querySelectorAll(".charts h3")].find(
          (heading) => heading.textContent === arguments[0]);
        const chart = name.parentElement.querySelector("svg:not(.tradeoff)");
        const panel = 180;  // the errors are drawn below
        return [
          [...chart.querySelectorAll(".points")].map((phase) =>
            [...phase.querySelectorAll("path")].map((path) => path.getAttribute("d")).join("")),
          [...chart.querySelectorAll('text[text-anchor="end"]')].map((text) =>
            [Number(text.getAttribute("y")) - 4, text.textContent]).filter(([y]) => y > panel),
        ];
        """,
        run,
    )
    heights = [height for height, _ in labels]
    values = [float(text.replace("−", "-")) for _, text in labels]
    axis = np.polyfit(heights, values, 1)
    found = [[float(y) for y in re.findall(r"M[-\d.]+ ([-\d.]+)", one)] for one in marks]
    return [np.polyval(axis, phase) for phase in found]


def overflowing(driver):
    """Elements that reach beyond the window, but for what scrolls on its own."""
    return driver.execute_script(
        """
        const wide = document.documentElement.clientWidth + 0.5;
        const scrolls = (node) => node.closest(".scroll, .card, pre, .spoken");
        return [...document.querySelectorAll("body *")].filter((node) => !scrolls(node)
          && node.getBoundingClientRect().right > wide).map((node) => node.outerHTML.slice(0, 120));
        """
    )


def test_no_errors_and_no_request_beyond_the_page(opened, page):
    driver = opened()
    assert driver.get_log("browser") == []
    assert {url for url in requests(driver) if not url.startswith("data:")} == {page.as_uri()}


@pytest.mark.parametrize("width", WIDTHS)
def test_nothing_overflows(opened, width):
    driver = opened(width)
    assert driver.execute_script("return document.documentElement.scrollWidth") <= width
    assert overflowing(driver) == []


def evaluated(file):
    rows = tables.read(file, schemas.EVALUATION)
    own = rows[(rows["criterion"] == "first_degree") & (rows["run"] == "day-1")]
    return own.set_index(["phase", "k", "tmax"])


def assert_shown(driver, rows, k, tmax):
    shown = cells(driver)
    for phase, word in (("heat-up", "heating"), ("cool-down", "cooling")):
        row = rows.loc[(phase, k, tmax)]
        assert shown[f"day-1, {word}"][:2] == [str(row["corrections"]), number_text(row["epsilon"])]
    for phase, missed in zip(("heat-up", "cool-down"), drawn_errors(driver, "day-1"), strict=True):
        rms = np.sqrt(np.mean(np.square(missed)))
        assert rms == pytest.approx(rows.loc[(phase, k, tmax), "epsilon"], abs=0.01)


def test_sliders_move_the_curves_and_tell_what_was_evaluated(opened, work):
    driver, rows = opened(), evaluated(work / "evaluation.parquet")
    # the usual setting stands where nothing was simulated
    assert (part(driver, "k-now").text, part(driver, "tmax-now").text) == ("5", "60 min")
    assert_shown(driver, rows, 5.0, 3600.0)
    assert part(driver, "k").accessible_name == "k = 5"
    before = curves(driver)
    assert len(before) == 4
    part(driver, "k").send_keys("\ue012")  # the key for left
    assert part(driver, "k-now").text == "2.5"
    assert part(driver, "k").get_attribute("aria-valuetext") == "k = 2.5"
    assert_shown(driver, rows, 2.5, 3600.0)
    after = curves(driver)
    assert all(old != new for old, new in zip(before, after, strict=True))
    part(driver, "tmax").send_keys("\ue010")  # the key for the end
    assert part(driver, "tmax-now").text == "240 min"
    assert_shown(driver, rows, 2.5, 14400.0)
    assert "k = 2.5, tmax = 240 min" in part(driver, "told").get_attribute("textContent")


def test_switch_shows_the_extended_model(opened, work):
    driver = opened()
    before, base = curves(driver), cells(driver)
    part(driver, "extended").send_keys(" ")
    assert part(driver, "extended").is_selected()
    assert curves(driver) != before
    assert_shown(driver, evaluated(work / "extended.parquet"), 5.0, 3600.0)
    assert cells(driver)["day-1, heating"][2] != base["day-1, heating"][2]


def marks(driver, kind):
    """What the marks of the error over the number of corrections of day-1 tell."""
    return driver.execute_script(
        """
        const name = [...document.querySelectorAll(".charts h3")].find(
          (heading) => heading.textContent === "day-1");
        const run = name.parentElement.querySelector(".tradeoff");
        return [...run.querySelectorAll(`circle.${arguments[0]}`)].map((mark) => mark.textContent);
        """,
        kind,
    )


def test_error_over_corrections_tells_what_was_evaluated(opened, work):
    driver, rows = opened(), evaluated(work / "evaluation.parquet")
    told = marks(driver, "now")
    for phase, word in (("heat-up", "heating"), ("cool-down", "cooling")):
        row = rows.loc[(phase, 5.0, 3600.0)]
        assert (
            f"{word}, k = 5, tmax = 60 min: {row['corrections']} corrections,"
            f" ε {number_text(row['epsilon'])} N·m"
        ) in told
    schedules = {(row["corrections"], number_text(row["epsilon"])) for _, row in rows.iterrows()}
    assert 0 < len(marks(driver, "setting")) <= 2 * len(schedules)


def test_the_recommended_setting_is_one_click_away(opened, work):
    driver, rows = opened(), tables.read(work / "evaluation.parquet", schemas.EVALUATION)
    rows = rows[rows["criterion"] == "first_degree"]
    enough = rows.groupby(["k", "tmax"])["epsilon"].max() <= 2.0
    counts = rows.groupby(["k", "tmax"])["corrections"].sum()
    text = part(driver, "recommended").text
    k, tmax = re.search(r"k = ([\d.]+), tmax = ([\d.]+) min", text).groups()
    setting = (float(k), 60.0 * float(tmax))
    assert enough[setting]
    assert counts[setting] == counts[enough].min()
    part(driver, "use").send_keys("\ue007")  # the key for enter
    assert (part(driver, "k-now").text, part(driver, "tmax-now").text) == (k, f"{tmax} min")
    assert marks(driver, "best") == marks(driver, "now")


def test_a_setting_that_makes_it_worse_is_said(opened, work):
    driver = opened()
    part(driver, "extended").send_keys(" ")
    rows = tables.read(work / "extended.parquet", schemas.EVALUATION)
    without = rows[rows["criterion"] == "none"].set_index(["run", "phase"])["epsilon"]
    own = rows[(rows["criterion"] == "first_degree") & (rows["k"] == 5.0)]
    own = own[own["tmax"] == 3600.0].set_index(["run", "phase"])["epsilon"]
    worse = {phase for (run, phase), value in own.items() if value > without[run, phase]}
    said = part(driver, "worse")
    assert said.is_displayed() is bool(worse)
    assert ("heating" in said.text, "cooling" in said.text) == (
        "heat-up" in worse,
        "cool-down" in worse,
    )


def test_curves_follow_the_width(opened):
    driver = opened(1440)
    chart = driver.find_element("css selector", ".charts svg")
    wide = driver.execute_script("return arguments[0].getAttribute('viewBox')", chart)
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": False},
    )
    narrow = driver.execute_async_script(
        """
        const [before, done] = arguments;
        const look = () => {
          const box = document.querySelector(".charts svg").getAttribute("viewBox");
          box === before ? requestAnimationFrame(look) : done(box);
        };
        look();
        """,
        wide,
    )
    assert float(narrow.split()[2]) < 390 < float(wide.split()[2])


def test_hostile_names_are_harmless(opened):
    driver = opened()
    assert driver.execute_script("return window.broken") is None
    shown = HOSTILE.replace("\u202e", "\N{REPLACEMENT CHARACTER}")
    assert shown in [heading.text for heading in driver.find_elements("css selector", ".charts h3")]
    assert f"{shown}, heating" in cells(driver)
    assert driver.find_elements("css selector", "img[onerror]") == []
    assert driver.find_elements("tag name", "script")[-1].get_attribute("type") == ""


def test_a_script_that_slips_in_does_not_run_and_nothing_can_be_fetched(opened):
    driver = opened()
    refused = driver.execute_async_script(
        """
        const done = arguments[0];
        const refused = [];
        document.addEventListener("securitypolicyviolation", (event) => {
          refused.push(event.effectiveDirective);
          if (refused.length === 2) done(refused);
        });
        const script = document.createElement("script");
        script.textContent = "window.broken = 3";
        document.body.append(script);
        fetch("https://example.invalid/").catch(() => {});
        """
    )
    assert sorted(refused) == ["connect-src", "script-src-elem"]
    assert driver.execute_script("return window.broken") is None


def test_without_scripts_the_page_is_whole_and_says_what_is_missing(opened):
    driver = opened(390, scripts=False)
    assert "With scripts" in driver.find_element("css selector", "noscript .missing").text
    for shown, wanted in ((".explorer", False), ("#fig11 svg", True), (".lights", True)):
        assert driver.find_element("css selector", shown).is_displayed() is wanted


def test_the_page_follows_a_dark_screen(opened):
    found = {}
    for scheme in ("light", "dark"):
        driver = opened(scheme=scheme)
        found[scheme] = [
            driver.execute_script(
                "return getComputedStyle(document.querySelector(arguments[0]))[arguments[1]]",
                *where,
            )
            for where in (
                ("body", "backgroundColor"),
                ("body", "color"),
                (".charts .step", "stroke"),
                (".charts .points path", "fill"),
            )
        ]
    assert found["light"][0] == "rgb(255, 255, 255)"
    assert all(light != dark for light, dark in zip(*found.values(), strict=True))


def test_all_text_stands_out(opened):
    """By WCAG 2.1 AA, on the page and in its figures, on light and on dark screens."""
    for scheme in ("light", "dark"):
        found = opened(scheme=scheme).execute_script(TEXT_COLOURS)
        assert len(found) > 8
        faint = {
            text: ratio
            for colour, ground, filtered, text in found
            if (ratio := contrast(*(seen(one, filtered=filtered) for one in (colour, ground))))
            < 4.5
        }
        assert faint == {}


def seen(colour, *, filtered):
    """A colour rgb(r, g, b) as #rrggbb; of a figure in the dark inverted, its hue turned back."""
    channels = np.array([float(one) for one in re.findall(r"[\d.]+", colour)[:3]]) / 255
    if filtered:
        inverted = channels * (1 - 2 * 0.915) + 0.915
        grey = np.array([0.213, 0.715, 0.072])  # of the filter, not of WCAG
        channels = np.clip(2 * grey @ inverted - inverted, 0, 1)
    return "#" + "".join(f"{round(255 * one):02x}" for one in channels)


def test_print_is_a_summary_that_says_what_it_leaves_out(opened):
    driver = opened()
    shown = """return [...document.querySelectorAll(arguments[0])].filter(
        (element) => element.checkVisibility()).map((element) => element.id)"""
    assert driver.execute_script(shown, ".printed") == []
    on_screen = driver.execute_script(shown, "figure")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    printed = driver.execute_script(shown, "figure")
    assert {"overview", "fig5", "fig8", "fig11"} <= {*printed}
    assert not {"fig3", "fig9", "residuals"} & {*printed}
    assert {*printed} < {*on_screen}
    assert driver.execute_script(shown, ".explorer, #origin, #downloads, #effects") == []
    assert len(driver.execute_script(shown, ".printed")) == 1
    sheet = driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})
    pages = base64.b64decode(sheet["data"]).count(b"/Type /Page\n")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    assert 5 < pages <= 15


def test_marks_of_the_explorer_tell_their_values(opened):
    driver = opened()
    told = driver.execute_script(
        """
        const group = document.querySelector(".charts .points");
        const [x, y] = group.firstElementChild.getAttribute("d").slice(1).split(/[ m]/);
        const at = new DOMPoint(x, y).matrixTransform(group.ownerSVGElement.getScreenCTM());
        group.dispatchEvent(new PointerEvent("pointermove", {clientX: at.x, clientY: at.y}));
        return group.querySelector("title").textContent;
        """
    )
    assert re.fullmatch(r"[\d.]+ deg/s, \d+ min, Tm = [\d.]+ °C: [−\d.]+ N·m", told)
    shown = float(re.search(r"([−\d.]+) N·m$", told)[1].replace("−", "-"))
    drawn = drawn_errors(driver, "day-1")[0]
    # marks overlap within the pixel that a pointer is at
    assert shown == pytest.approx(drawn[0], abs=0.3)
    assert np.abs(drawn - shown).min() < 0.02


def test_points_of_figures_tell_their_values(opened):
    driver = opened()
    first = driver.find_element("css selector", "#fig5 use > title").get_attribute("textContent")
    assert "deg/s, heating, 25.0 °C: " in first
    assert first.endswith(" N·m")


def look(driver, name):
    return driver.find_element("css selector", f'.look [data-part="{name}"]')


def painted(driver):
    """How many pixels of the chart have each of its colours."""
    return driver.execute_async_script(
        """
        const [names, done] = arguments;
        requestAnimationFrame(() => requestAnimationFrame(() => {
          const canvas = document.querySelector(".look canvas");
          const style = getComputedStyle(canvas);
          const picture = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          const pixels = picture.data;
          done(Object.fromEntries(names.map((name) => {
            const [red, green, blue] = [1, 3, 5].map((at) =>
              parseInt(style.getPropertyValue(name).trim().slice(at, at + 2), 16));
            let count = 0;
            for (let at = 0; at < pixels.length; at += 4) {
              count += pixels[at] === red && pixels[at + 1] === green && pixels[at + 2] === blue;
            }
            return [name, count];
          })));
        }));
        """,
        ["--text", "--heating"],
    )


def test_the_chart_shows_what_is_chosen(opened):
    driver = opened()
    assert "moves." in look(driver, "told").text
    found = painted(driver)
    assert found["--text"] > 0
    assert found["--heating"] > 0
    look(driver, "base").click()
    assert painted(driver)["--heating"] == 0
    look(driver, "base").click()
    look(driver, "what").send_keys("residual")
    found = painted(driver)
    assert found["--heating"] > 0
    assert found["--text"] == 0


def test_a_move_is_told_with_its_values(opened, work):
    driver = opened()
    points = json.loads(
        driver.find_element("id", "joint2-points").get_attribute("textContent"),
    )
    look(driver, "move").send_keys("7")
    speed = f"{points['speed'][6]:.1f} deg/s"
    assert look(driver, "told").text.startswith("Move 7: ")
    assert speed in look(driver, "told").text
    canvas = look(driver, "canvas")
    # the pointer rests on the first measured point
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    told = driver.execute_script(
        """
        const canvas = arguments[0], box = canvas.getBoundingClientRect();
        for (let x = 55; x < box.width; x += 4) for (let y = 10; y < 330; y += 8) {
          canvas.dispatchEvent(new PointerEvent("pointermove",
            { clientX: box.left + x, clientY: box.top + y, pointerId: 1 }));
          const text = document.querySelector(".look [data-part=under]").textContent;
          if (text) return text;
        }
        """,
        canvas,
    )
    numbers = re.search(r"measured (\S+) N·m; base (\S+) \(missed by (\S+?)\)", told).groups()
    measured, base, missed = (float(number.replace("−", "-")) for number in numbers)
    assert measured - base == pytest.approx(missed, abs=0.011)
    assert speed in told
    torques = tables.read(work / "torques.parquet", schemas.TORQUES)
    both = torques[["torque_forward", "torque_reverse"]].to_numpy()
    assert np.abs(both - measured).min() < 0.05


def test_the_keyboard_zooms_and_pans_the_chart(opened):
    driver = opened()
    canvas = look(driver, "canvas")
    picture = "return document.querySelector('.look canvas').toDataURL()"
    painted(driver)
    seen = [driver.execute_script(picture)]
    for key in ("+", "\ue014", "\ue013"):  # plus, right, up
        canvas.send_keys(key)
        painted(driver)
        seen.append(driver.execute_script(picture))
    assert len(set(seen)) == 4
    canvas.send_keys("0")
    painted(driver)
    assert driver.execute_script(picture) == seen[0]
