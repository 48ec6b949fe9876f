"""The line of progress on a terminal: units, time left, and a line of its own for what comes after it."""

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


class Clock:
    """The time, and a timer of the system that strikes when a test says so."""

    def __init__(self, monkeypatch):
        self.now, self.times = 0.0, []
        monkeypatch.setattr(progress, "monotonic", lambda: self.now)
        monkeypatch.setattr(progress.signal, "setitimer", lambda which, *times: self.times.append(times))

    def strike(self, at: float) -> None:
        self.now = at
        signal.raise_signal(signal.SIGALRM)


@pytest.fixture
def clock(monkeypatch):
    return Clock(monkeypatch)


@pytest.fixture
def begin(monkeypatch):
    """A function that makes standard error a terminal."""

    def terminal() -> Terminal:
        found = Terminal()
        monkeypatch.setattr("sys.stderr", found)
        return found

    return terminal


def quiet() -> click.Context:
    """A call with --quiet."""
    return printing.quiet(click.command()(lambda: None)).make_context("check", ["-q"])


def shown(terminal: Terminal) -> list[str]:
    """The lines as they stand, each time that they are written anew."""
    return re.sub(r"\x1b\[\??[0-9]*[a-zA-Z]", "", terminal.getvalue()).replace("\r", "\n").splitlines()


def test_units_done_and_in_total_and_the_time_left(begin, clock):
    terminal, line = begin(), ProgressLine("spectrum", "chunks")
    for clock.now, done in ((10.0, 5), (20.0, 15), (24.0, 20)):
        line(done, 20)
    assert [text for text in shown(terminal) if text] == [
        "[--------------------] spectrum: still computing (0 s)",
        "[#####---------------] spectrum: still computing (5 of 20 chunks done, 10 s)",
        "[###############-----] spectrum: about 10 s more (15 of 20 chunks done)",
        "[####################] spectrum: 20 chunks in 24 s",
    ]
    assert terminal.getvalue().endswith("\n")


def test_what_is_said_next_stands_on_a_line_of_its_own_and_the_bar_begins_again(begin):
    terminal, line = begin(), ProgressLine("a\x1b[2Jb", "chunks")
    line(1, 3)
    streams.say("rocking: interrupted")
    streams.say("and more")
    assert terminal.getvalue().endswith(" s)\nrocking: interrupted\nand more\n")
    assert "\\x1b[2J" in terminal.getvalue()
    line(2, 3)
    assert "2 of 3" in shown(terminal)[-1]
    streams.end_line()


def test_a_terminal_shows_a_long_sentence_in_lines_of_whole_words(begin, monkeypatch):
    terminal = begin()
    monkeypatch.setenv("COLUMNS", "60")
    streams.say("many words " * 12)
    assert terminal.getvalue().split() == ["many", "words"] * 12
    assert max(map(len, terminal.getvalue().splitlines())) <= 60


def test_a_long_run_says_what_its_units_have_taken(clock, capsys):
    with progress.reporting():
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


def test_where_a_terminal_shows_the_line_and_where_silence_is_asked_for_nothing_is_said(clock, begin):
    terminal = begin()
    with progress.reporting():
        line = ProgressLine("spectrum", "chunks")
        line(1, 4)
        clock.strike(40.0)
        streams.end_line()
        assert "40 s" not in terminal.getvalue()
        before = terminal.getvalue()
        with quiet():
            ProgressLine("x", "chunks")(1, 2)
            clock.strike(70.0)
    assert terminal.getvalue() == before
    with progress.reporting():  # a command without a line of its own
        clock.strike(80.0)
    assert terminal.getvalue().endswith("still computing (10 s)\n")
