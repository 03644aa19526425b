"""Progress is shown on a terminal after a while, and never in a pipe."""

import io
import sys
import threading

import pytest

from frictioncli.cli.terminal import working


class Terminal(io.StringIO):
    """A terminal that tells when a text was written."""

    def __init__(self, awaited=""):
        super().__init__()
        self.awaited, self.seen = awaited, threading.Event()

    def isatty(self):
        return True

    def write(self, text):
        if self.awaited and self.awaited in text:
            self.seen.set()
        return super().write(text)


def on_terminal(monkeypatch):
    """Put terminals in place of the streams; in the test, since pytest sets them before it."""
    made = Terminal("plan ... 0 s")
    monkeypatch.setattr(sys, "stdout", Terminal())
    monkeypatch.setattr(sys, "stderr", made)
    return made


def test_long_work_says_what_and_for_how_long_and_leaves_no_trace(monkeypatch):
    terminal = on_terminal(monkeypatch)
    with working("plan", patience=0.0):
        assert terminal.seen.wait(60)
    written = terminal.getvalue()
    assert written.endswith("\r\x1b[K")
    assert "\n" not in written


def test_short_work_writes_no_text(monkeypatch):
    terminal = on_terminal(monkeypatch)
    with working("fit", patience=1000.0):
        pass
    assert terminal.getvalue() == "\r\x1b[K"


def test_output_between_is_on_a_clear_line(monkeypatch):
    terminal = on_terminal(monkeypatch)
    with working("ingest", patience=0.0) as line, line.paused("plan"):
        terminal.write("done\n")
        assert terminal.getvalue().endswith("\r\x1b[Kdone\n")
    assert line.label == "plan"


def test_a_pipe_gets_nothing(monkeypatch):
    out, err = io.StringIO(), io.StringIO()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    with working("plan", patience=0.0) as line, line.paused("other"):
        pass
    assert out.getvalue() == err.getvalue() == ""


def test_an_error_removes_the_line_and_goes_on(monkeypatch):
    terminal = on_terminal(monkeypatch)
    with pytest.raises(ValueError, match="fault"), working("plan", patience=1000.0):
        raise ValueError("fault")
    assert terminal.getvalue().endswith("\r\x1b[K")
