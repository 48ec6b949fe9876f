"""The line of progress on a terminal: unit, rate, time left, and a line of its own for what comes after it."""

from __future__ import annotations

import io
import re

import pytest

from rocking_cli.commands import progress, streams
from rocking_cli.commands.progress import ProgressLine


class Terminal(io.StringIO):
    """Standard error as a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch):
    """What is written to a terminal, once a test has called it; the clock goes on by two seconds at each look."""
    times = iter(range(0, 1000, 2))
    monkeypatch.setattr(progress, "monotonic", lambda: float(next(times)))

    def begin() -> Terminal:
        found = Terminal()
        monkeypatch.setattr("sys.stderr", found)
        return found

    return begin


def shown(terminal: Terminal) -> list[str]:
    """The lines as they stand, each time that they are written anew."""
    return re.sub(r"\x1b\[\??[0-9]*[a-zA-Z]", "", terminal.getvalue()).replace("\r", "\n").splitlines()


def test_the_first_line_is_there_before_anything_is_done(terminal):
    terminal = terminal()
    ProgressLine("spectrum", False, "chunks")
    assert "spectrum" in shown(terminal)[-1]
    assert "0%" in terminal.getvalue()
    streams.end_line()


def test_done_total_unit_rate_and_time_left(terminal):
    terminal = terminal()
    line = ProgressLine("spectrum", False, "chunks")
    for done in (10, 15):
        line(done, 20)
    assert "15/20" in shown(terminal)[-1]
    assert "1.25 chunks/s" in shown(terminal)[-1]  # five in the four seconds since the line began, at ten
    line(20, 20)
    assert "20/20" in shown(terminal)[-1]
    assert terminal.getvalue().endswith("\n")


def test_the_time_left_is_told(terminal, monkeypatch):
    terminal = terminal()
    monkeypatch.setattr("time.time", iter(range(0, 10_000, 60)).__next__)
    line = ProgressLine("spectrum", False, "chunks")
    line(1, 4)
    line(2, 4)
    assert re.search(r"2/4 +50%  00:0[1-9]:", shown(terminal)[-1])
    streams.end_line()


def test_what_is_said_next_stands_on_a_line_of_its_own(terminal):
    terminal = terminal()
    line = ProgressLine("a\x1b[2Jb", False, "chunks")
    line(1, 3)
    streams.say("rocking: interrupted")
    streams.say("and more")
    assert terminal.getvalue().endswith("\x1b[?25h\nrocking: interrupted\nand more\n")  # the cursor is back, too
    assert "\\x1b[2J" in terminal.getvalue()


def test_a_bar_that_goes_on_begins_again(terminal):
    terminal = terminal()
    line = ProgressLine("x", False, "chunks")
    line(1, 3)
    streams.say("a remark")
    line(2, 3)
    assert "2/3" in shown(terminal)[-1]
    streams.end_line()


def test_nothing_is_shown_where_nobody_looks(terminal, monkeypatch):
    terminal = terminal()
    ProgressLine("x", True, "chunks")(1, 2)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    ProgressLine("x", False, "chunks")(1, 2)
    assert terminal.getvalue() == ""
