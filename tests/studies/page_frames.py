"""Frames of pages in Chromium: how long one takes while a reader scrolls, sorts, zooms, filters.

Usage: python -m tests.studies.page_frames PAGE... [--joints 1000 ...]

Pages are files; for each number of joints the overview of a simulated fleet is made as well. Frames
are those of a headless browser without a graphics processor, one picture of 1440 x 900 each.
"""

import shutil
import tempfile
import time
from argparse import ArgumentParser
from pathlib import Path
from typing import Any

import numpy as np

from frictioncli.report.fleet_page import fleet_html

_FRAMES = """
const [act, count, done] = [new Function("n", arguments[0]), arguments[1], arguments[2]];
const times = [];
let n = 0, before = null;
requestAnimationFrame(function frame(now) {
  if (before !== null) times.push(now - before);
  before = now;
  if (n > count) { done(times); return; }
  act(n);
  n += 1;
  requestAnimationFrame(frame);
});
"""

_KEY = (
    "document.querySelector('.look canvas')"
    ".dispatchEvent(new KeyboardEvent('keydown', {key: n %% 20 < 10 ? '%s' : '%s'}))"
)

_ACTS = {
    "scroll": ("body", "scrollTo(0, n * 120)", 100),
    "zoom the chart": (".look canvas", _KEY % ("+", "-"), 60),
    "pan the chart": (".look canvas", _KEY % ("ArrowLeft", "ArrowRight"), 60),
    "move the slider": (
        ".explorer [data-part=k]",
        "const s = document.querySelector('.explorer [data-part=k]');"
        "s.value = n % (Number(s.max) + 1); s.dispatchEvent(new Event('input', {bubbles: true}))",
        60,
    ),
    "sort": (".sort", "const s = document.querySelectorAll('.sort'); s[n % s.length].click()", 40),
    "filter": (
        "input[type=search]",
        "const s = document.querySelector('input[type=search]'); s.value = 'R00' + n % 10;"
        "s.dispatchEvent(new Event('input', {bubbles: true}))",
        40,
    ),
}
"""What is done in every frame, by what it needs, and how often."""


def fleet_page(joints: int, seed: int = 0) -> str:
    """Return the overview of a fleet of so many joints with twelve runs each."""
    random = np.random.default_rng(seed)
    rows: list[dict[str, Any]] = []
    for number in range(joints):
        where = {"robot": f"R{number // 6:04d}", "joint": number % 6 + 1}
        if number % 37 == 0:
            failure = "000.csv, row 12: torque is 'abc', expected a number"
            rows.append({**where, "status": "failed", "message": failure})
            continue
        levels = random.normal(0.0, 0.3, 12)
        change = float(levels[-1] - levels[:-1].mean())
        verdict = str(random.choice(["named", "no_evidence", "ambiguous", "unnamed"]))
        rows.append(
            {
                **where,
                "runs": 12,
                "status": "done",
                "message": "",
                "torque_unit": "N·m",
                "verdict": verdict,
                "causes": {"named": "thermal_lag; drift", "ambiguous": "drift or run_in"}.get(
                    verdict, ""
                ),
                "change": change,
                "change_low": change - 0.5,
                "change_high": change + 0.5,
                "friction_by_run": levels.tolist(),
                "friction_20": 40.0,
                "friction_40": 30.0 + random.normal(),
                "gain": random.random(),
                "epsilon_heating": 1.0 + random.random(),
                "epsilon_cooling": 1.0 + random.random(),
            }
        )
    links = [f"robot={row['robot']}/joint={row['joint']}/report/index.html" for row in rows]
    return fleet_html(rows, links)


def measured(driver: Any, page: Path) -> list[str]:
    """Return the rows of the table on a page: its size, its time to open, its frames."""
    began = time.monotonic()
    driver.get(page.resolve().as_uri())
    driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
    opened = time.monotonic() - began
    rows = [f"| opens, {page.stat().st_size / 1e6:.1f} MB | {1e3 * opened:.0f} | |"]
    for name, (needed, act, count) in _ACTS.items():
        shown = driver.execute_script(
            "const found = document.querySelector(arguments[0]);"
            "if (found) found.scrollIntoView(); return Boolean(found && found.offsetParent);",
            needed,
        )
        if shown or needed == "body":
            frames = driver.execute_async_script(_FRAMES, act, count)
            low, high = np.percentile(frames, (50, 95))
            rows.append(f"| {name} | {low:.0f} | {high:.0f} |")
    return rows


def main() -> None:
    """Print a table per page."""
    from selenium import webdriver

    parser = ArgumentParser(description=__doc__)
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--joints", nargs="*", type=int, default=[])
    asked = parser.parse_args()
    options = webdriver.ChromeOptions()
    options.binary_location = str(shutil.which("chromium"))
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(flag)
    options.add_argument("--window-size=1440,900")
    service = webdriver.ChromeService(str(shutil.which("chromedriver")))
    driver = webdriver.Chrome(options=options, service=service)
    try:
        with tempfile.TemporaryDirectory() as folder:
            made = []
            for joints in asked.joints:
                made.append(Path(folder) / f"fleet-{joints}.html")
                made[-1].write_text(fleet_page(joints), encoding="utf-8")
            for page in (*asked.pages, *made):
                print(f"\n{page}\n\n| | median [ms] | 95 % below [ms] |\n|---|---|---|")
                print(*measured(driver, page), sep="\n")
    finally:
        driver.quit()


if __name__ == "__main__":
    main()
