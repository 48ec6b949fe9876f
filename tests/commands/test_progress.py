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


@pytest.fixture
def begin(monkeypatch):
    """A function that makes standard error a terminal; the clock goes on by two seconds at each look."""
    times = iter(range(0, 1000, 2))
    monkeypatch.setattr(progress, "monotonic", lambda: float(next(times)))

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


def test_units_done_and_in_total_and_the_time_left(begin):
    terminal, line = begin(), ProgressLine("spectrum", "chunks")
    assert shown(terminal)[-1].startswith("[--------------------] spectrum: still computing")  # before anything is done
    for done in (5, 15):
        line(done, 20)
    assert re.fullmatch(r"\[#{15}-{5}\] spectrum: about [\d.]+ s more \(15 of 20 chunks done\)", shown(terminal)[-1])
    line(20, 20)
    assert re.fullmatch(r"\[#{20}\] spectrum: 20 chunks in \d+ s", shown(terminal)[-1])
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
    shown = terminal.getvalue().splitlines()
    assert (" ".join(shown), max(map(len, shown)) <= 60) == (("many words " * 12).strip(), True)


def test_nothing_is_shown_where_nobody_looks(begin, monkeypatch):
    terminal = begin()
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


def test_where_a_terminal_shows_the_line_and_where_silence_is_asked_for_nothing_is_said(clock, begin, monkeypatch):
    terminal = begin()
    monkeypatch.setattr(progress, "monotonic", lambda: clock.now)
    with progress.told():
        line = ProgressLine("spectrum", "chunks")
        line(1, 4)
        clock.strike(40.0)
        streams.end_line()
        assert "40 s" not in terminal.getvalue()
        with quiet():
            ProgressLine("x", "chunks")
            clock.strike(70.0)
    assert "70 s" not in terminal.getvalue()
    with progress.told():  # a command without a line of its own
        clock.strike(80.0)
    assert terminal.getvalue().endswith("still computing (10 s)\n")
