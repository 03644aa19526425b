"""Patterns that meet text of others take a time proportional to its length."""

import ast
import importlib
import pkgutil
import re
import signal
from contextlib import contextmanager
from pathlib import Path

import pytest

import frictioncli

SECONDS = 1e-5
"""Processor time per character; a linear pattern needs 5e-7 to 5e-6 s, a quadratic one 1e-9 s or
more times the length of the text."""

BEFORE = ("", "A: ", "{ ", "a [", "2024-05-17T09:30 ")
LONG, SHORT = 100_000, 20_000
REPEATED = dict.fromkeys((" ", "1", '"', "[", "(", "{"), LONG) | dict.fromkeys(
    (
        *("\t", "\r", "\n", "]", "A", "a", "_", ".", ",", ":", "-", "?", "é"),
        *("A1 ", "A1 1 ", "A: ", "{ ", "[ ", "1,", "1 ", "1e", "a1", "a ["),
    ),
    SHORT,
)
"""What is repeated, and the number of characters."""

AFTER = ("x", "1")
METHODS = ("search", "match", "fullmatch", "sub", "split", "findall")


def _patterns():
    """Return module and name of every pattern that meets text of others."""
    for part in ("logs", "inspection"):
        package = importlib.import_module(f"frictioncli.{part}")
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            module = importlib.import_module(found.name)
            for name, value in vars(module).items():
                if isinstance(value, re.Pattern):
                    yield module, name


def _methods(module, name):
    """Return how a module uses a pattern; where it hands it on, the ways of the callers."""
    source = Path(module.__file__).read_text(encoding="utf-8")
    used = [method for method in METHODS if f"{name}.{method}(" in source]
    return used or [method for method in METHODS if f"pattern.{method}(" in source] or ["match"]


class TooLong(Exception):
    """A pattern has used up its processor time."""


@contextmanager
def limited(what, length):
    """End what the block does with a text after its processor time; patterns see signals."""

    def end(number, frame):
        raise TooLong(what)

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS * length)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def try_patterns(module_name):
    """Use the patterns of a module on hostile texts."""
    module = importlib.import_module(module_name)
    for name in (name for of, name in _patterns() if of is module):
        pattern = vars(module)[name]
        for before in BEFORE:
            for part, length in REPEATED.items():
                for after in AFTER:
                    text = before + part * (length // len(part)) + after
                    text = text.encode() if isinstance(pattern.pattern, bytes) else text
                    for method in _methods(module, name):
                        arguments = (text[:0], text) if method == "sub" else (text,)
                        what = f"{name}.{method} on {before!r} + {part!r} ... + {after!r}"
                        with limited(what, length):
                            getattr(pattern, method)(*arguments)


PATTERNS = list(_patterns())


@pytest.mark.slow
@pytest.mark.parametrize("module", sorted({module.__name__ for module, _ in PATTERNS}))
def test_a_pattern_needs_time_in_proportion_to_the_text(module):
    try_patterns(module)


@pytest.mark.parametrize("length", [LONG, SHORT])
def test_a_quadratic_pattern_is_ended(length):
    with pytest.raises(TooLong, match="blanks"), limited("blanks", length):
        re.compile(r"\s+x").search(" " * length)


def test_a_log_of_blanks_is_told_at_once():
    """What took 29 s: a line of blanks before the header."""
    from frictioncli.logs.formats.struct_cells import _cells

    assert _cells(" " * 100_000) == [""]
    assert _cells("0.1;{E6AXIS: A1 1.5, A2 -2e1};3") == [
        "0.1",
        [("A1", "1.5"), ("A2", "-2e1")],
        "3",
    ]


def test_every_pattern_has_a_name_and_so_is_tried():
    assert len(PATTERNS) > 30
    folder = Path(frictioncli.__file__).parent
    for path in [*folder.glob("logs/**/*.py"), *folder.glob("inspection/**/*.py")]:
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute):
                of_re = isinstance(call.func.value, ast.Name) and call.func.value.id == "re"
                assert not of_re or call.func.attr in ("compile", "escape"), ast.unparse(call)
