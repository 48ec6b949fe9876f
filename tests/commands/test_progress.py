"""The line of progress on a terminal: unit, rate, time left, and a line of its own for what comes after it."""

from __future__ import annotations

import io
import re
import signal

import click
import pytest

from rocking_cli.commands import printing, progress, streams
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


def quiet() -> click.Context:
    """A call with --quiet."""
    return printing.quiet(click.command()(lambda: None)).make_context("check", ["-q"])


def shown(terminal: Terminal) -> list[str]:
    """The lines as they stand, each time that they are written anew."""
    return re.sub(r"\x1b\[\??[0-9]*[a-zA-Z]", "", terminal.getvalue()).replace("\r", "\n").splitlines()


def test_the_first_line_is_there_before_anything_is_done(terminal):
    terminal = terminal()
    ProgressLine("spectrum", "chunks")
    assert "spectrum" in shown(terminal)[-1]
    assert "0%" in terminal.getvalue()
    streams.end_line()


def test_done_total_unit_rate_and_time_left(terminal):
    terminal = terminal()
    line = ProgressLine("spectrum", "chunks")
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
    line = ProgressLine("spectrum", "chunks")
    line(1, 4)
    line(2, 4)
    assert re.search(r"2/4 +50%  00:0[1-9]:", shown(terminal)[-1])
    streams.end_line()


def test_what_is_said_next_stands_on_a_line_of_its_own(terminal):
    terminal = terminal()
    line = ProgressLine("a\x1b[2Jb", "chunks")
    line(1, 3)
    streams.say("rocking: interrupted")
    streams.say("and more")
    assert terminal.getvalue().endswith("\x1b[?25h\nrocking: interrupted\nand more\n")  # the cursor is back, too
    assert "\\x1b[2J" in terminal.getvalue()


def test_a_bar_that_goes_on_begins_again(terminal):
    terminal = terminal()
    line = ProgressLine("x", "chunks")
    line(1, 3)
    streams.say("a remark")
    line(2, 3)
    assert "2/3" in shown(terminal)[-1]
    streams.end_line()


def test_nothing_is_shown_where_nobody_looks(terminal, monkeypatch):
    terminal = terminal()
    with quiet():
        ProgressLine("x", "chunks")(1, 2)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    ProgressLine("x", "chunks")(1, 2)
    assert terminal.getvalue() == ""


class Clock:
    """A timer of the system that strikes when a test says so."""

    def __init__(self, monkeypatch):
        self.now, self.handler = 0.0, signal.SIG_DFL
        monkeypatch.setattr(progress, "monotonic", lambda: self.now)
        monkeypatch.setattr(progress.signal, "setitimer", lambda which, *times: self.times.append(times))
        self.times: list[tuple[float, ...]] = []

    def strike(self, at: float) -> None:
        self.now = at
        signal.raise_signal(signal.SIGALRM)


@pytest.fixture
def clock(monkeypatch):
    return Clock(monkeypatch)


def test_a_long_run_says_what_its_units_have_taken(clock, capsys):
    with progress.told():
        clock.strike(10.0)
        line = ProgressLine("spectrum", "chunks")
        line(100, 1000)  # there before
        line(102, 1000)
        clock.strike(40.0)
        for at, done in ((70.0, 110), (100.0, 400), (3610.0, 990), (3640.0, 1000)):
            line(done, 1000)
            clock.strike(at)
    assert clock.times == [(10.0, 30.0), (0.0,)]
    assert capsys.readouterr().err.splitlines() == [
        "still computing (10 s)",
        "spectrum: still computing (102 of 1000 chunks done, 30 s)",
        "spectrum: about 89 min more (110 of 1000 chunks done)",
        "spectrum: about 3 min more (400 of 1000 chunks done)",
        "spectrum: about 40 s more (990 of 1000 chunks done)",
        "spectrum: still computing (3630 s)",
    ]


def test_the_time_left_is_right_within_a_factor_of_three_where_units_cost_alike(clock, capsys):
    with progress.told():
        line = ProgressLine("fragility", "motions")
        for done in range(1, 21):
            clock.now = 7.0 * done
            line(done, 20)
            if 4 <= done < 20:
                clock.strike(clock.now + 3.0)
                number, unit = capsys.readouterr().err.split()[2:4]
                assert 1.0 / 3.0 < float(number) * {"min": 60.0, "s": 1.0}[unit] / (7.0 * 20 - clock.now) < 3.0


def test_where_a_terminal_shows_the_line_and_where_silence_is_asked_for_nothing_is_said(clock, terminal, monkeypatch):
    terminal = terminal()
    monkeypatch.setattr(progress, "monotonic", lambda: clock.now)
    with progress.told():
        line = ProgressLine("spectrum", "chunks")
        line(1, 4)
        clock.strike(40.0)
        streams.end_line()
        assert "computing" not in terminal.getvalue()
        with quiet():
            ProgressLine("x", "chunks")
            clock.strike(70.0)
    assert "computing" not in terminal.getvalue()
    with progress.told():  # a command without a line of its own
        clock.strike(80.0)
    assert terminal.getvalue().endswith("still computing (10 s)\n")
