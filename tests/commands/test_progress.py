"""The progress of a call: units, time left, in a log and on a terminal,
from a thread.
"""

import io
import os
import re
import select
import subprocess
import sys
import time

import click
import pytest

from rocking_cli.commands import printing, progress, streams
from rocking_cli.commands.progress import ProgressLine


class Terminal(io.StringIO):
    """Standard error as a terminal."""

    def isatty(self) -> bool:
        return True


class Clock:
    """The time. A tick is what the thread does each second, here when a
    test says so.
    """

    def __init__(self, monkeypatch):
        self.now = 0.0
        monkeypatch.setattr(progress, "monotonic", lambda: self.now)
        monkeypatch.setattr(progress, "_TICK", 1e6)  # the thread only waits

    def tick(self, at: float) -> None:
        self.now = at
        progress._reporter.tick()


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
    return [
        line
        for part in re.split(r"[\r\n]", terminal.getvalue())
        if (line := part.rstrip())
    ]


def test_units_done_and_in_total_and_the_time_left(begin, clock):
    terminal, line = begin(), ProgressLine("spectrum", "chunks")
    for clock.now, done in ((10.0, 5), (20.0, 15), (24.0, 20)):
        line(done, 20)
    assert shown(terminal) == [
        "[--------------------] spectrum: still computing (0 s)",
        "[#####---------------] spectrum: still computing (5 of 20 chunks done, 10 s)",
        "[###############-----] spectrum: about 10 s more (15 of 20 chunks done, 20 s)",
        "[####################] spectrum: 20 chunks in 24 s",
    ]
    assert terminal.getvalue().endswith("\n")


def test_a_terminal_shows_every_second_what_is_left_though_nothing_is_reported(
    begin, clock
):
    terminal = begin()
    with progress.reporting():
        line = ProgressLine("check", "checks")
        line(1.5, 22)  # a part of a check counts
        for second in (9.0, 10.0, 11.0):
            clock.tick(second)
        line(22, 22)
        clock.tick(12.0)
    assert shown(terminal)[2:] == [
        "[#-------------------] check: still computing (6.8 % of 22 checks, 9 s)",
        "[#-------------------] check: still computing (6.8 % of 22 checks, 10 s)",
        "[#-------------------] check: still computing (6.8 % of 22 checks, 11 s)",
        "[####################] check: 22 checks in 11 s",
        "still computing (after check; 12 s in all)",
    ]
    assert re.search(r"\r +\r\Z", terminal.getvalue())


def test_other_output_takes_the_place_of_the_line_and_the_line_begins_again(begin):
    terminal, line = begin(), ProgressLine("a\x1b[2Jb", "chunks")
    line(1, 3)
    streams.say("rocking: interrupted")
    streams.say("and more")
    *_, line_of_progress, erased, said = terminal.getvalue().split("\r")
    assert "\\x1b[2J" in line_of_progress
    assert erased == " " * len(line_of_progress)
    assert said == "rocking: interrupted\nand more\n"
    line(2, 3)
    assert "2 of 3" in shown(terminal)[-1]
    streams.erase()


def test_a_shorter_line_covers_a_longer_one(begin):
    """Without a sequence that clears the line, which Windows may print as it is."""
    terminal = begin()
    streams.renew("a long line")
    streams.renew("short")
    streams.say("end")
    assert terminal.getvalue() == "\ra long line\rshort      \r     \rend\n"


def test_a_terminal_shows_a_long_sentence_in_lines_of_whole_words(begin, monkeypatch):
    terminal = begin()
    monkeypatch.setenv("COLUMNS", "60")
    streams.say("many words " * 12)
    assert terminal.getvalue().split() == ["many", "words"] * 12
    assert max(map(len, terminal.getvalue().splitlines())) <= 60


def test_the_line_never_reaches_the_end_of_the_terminal(begin, monkeypatch):
    """There a second line would begin, which the terminal does not renew."""
    terminal = begin()
    monkeypatch.setenv("COLUMNS", "40")
    ProgressLine("a structure with a long name", "frequencies")(1, 30)
    assert max(map(len, shown(terminal))) == 39
    streams.erase()


@pytest.mark.parametrize(("width", "bar"), [(100, 20), (80, 17), (66, 0)])
def test_the_bar_gives_way_to_the_words(begin, monkeypatch, width, bar):
    terminal = begin()
    monkeypatch.setenv("COLUMNS", str(width))
    ProgressLine("frequencies", "structures")(0, 12)
    words = "frequencies: still computing (0 of 12 structures done, 0 s)"
    assert shown(terminal)[-1] == (f"[{'-' * bar}] " if bar else "") + words
    streams.erase()


def test_a_share_just_below_one_is_not_told_as_all(begin):
    terminal, line = begin(), ProgressLine("check", "checks")
    for done, percent in ((11.99, "99 %"), (6.5, "54 %"), (0.06, "0.5 %")):
        line(done, 12)
        assert f"({percent} of 12 checks, " in shown(terminal)[-1]
    streams.erase()


def test_a_log_has_a_line_every_half_a_minute_with_the_time_left(clock, capsys):
    with progress.reporting():
        clock.tick(9.0)
        clock.tick(10.0)
        line = ProgressLine("spectrum", "chunks")
        line(100, 1000)  # there before
        line(102, 1000)
        clock.tick(39.0)
        clock.tick(40.0)
        for at, done in ((70.0, 110), (100.0, 400), (3610.0, 990), (3640.0, 1000)):
            line(done, 1000)
            clock.tick(at)
    assert capsys.readouterr().err.splitlines() == [
        "still computing (10 s)",
        "spectrum: still computing (102 of 1000 chunks done, 30 s)",
        "spectrum: about 89 min more (110 of 1000 chunks done, 60 s)",
        "spectrum: about 33 min more (400 of 1000 chunks done, 90 s)",
        "spectrum: about 40 s more (990 of 1000 chunks done, 3600 s)",
        "still computing (after spectrum; 3640 s in all)",
    ]


def test_quiet_is_silent_on_a_terminal_and_in_a_log(begin, clock, capsys):
    with progress.reporting(), quiet():
        ProgressLine("x", "chunks")(1, 2)
        clock.tick(70.0)
    assert not capsys.readouterr().err
    terminal = begin()
    with progress.reporting(), quiet():
        ProgressLine("x", "chunks")(1, 2)
        clock.tick(140.0)
    assert not shown(terminal)


def test_a_command_without_a_line_of_its_own_is_told_after_ten_seconds(begin, clock):
    terminal = begin()
    with progress.reporting():
        clock.tick(9.0)
        clock.tick(11.0)
    assert shown(terminal) == ["still computing (11 s)"]


# A call whose main thread waits for worker processes, which report parts of their work
# until the thread of the progress has shown a number of lines: how fast the machine is
# changes nothing.
WAITS = """
import sys, threading, time
from pathlib import Path
from rocking_cli.commands import progress, streams
from rocking_cli.processes import processes, report_part

progress._TICK, progress._FIRST, progress._EVERY = 0.05, 0.1, 0.1
ENOUGH, ENDED = int(sys.argv[1]), Path(sys.argv[2])

def work(item):
    while not ENDED.exists():
        time.sleep(0.02)
        report_part(1e-6)
    return item

def counted(write):
    shown = []
    def told(text):
        write(text)
        if "of 4 checks" in text and threading.current_thread().name == "progress":
            shown.append(text)
        if len(shown) >= ENOUGH:
            ENDED.touch()
    return told

if __name__ == "__main__":
    if not ENOUGH:
        ENDED.touch()
        sys.stderr = None
    streams.say, streams.renew = counted(streams.say), counted(streams.renew)
    with streams.guarded(), progress.reporting():
        line = progress.ProgressLine("check", "checks")
        with processes(2, work, "", lambda parts: line(parts, 4)) as run:
            list(run(range(4)))
        line(4, 4)
        streams.put("a row")
"""


def waiting(folder, lines):
    """The call that ends after so many lines; without any if standard error is
    closed."""
    (folder / "waits.py").write_text(WAITS)
    return [sys.executable, "waits.py", str(lines), f"ended_{lines}"]


def test_it_is_told_while_the_main_thread_waits_for_processes(tmp_path):
    call = {"cwd": tmp_path, "capture_output": True, "timeout": 60, "check": True}
    done = subprocess.run(waiting(tmp_path, 3), text=True, **call)
    assert done.stdout == "a row\n"
    lines = done.stderr.splitlines()
    # a line may become due when all is done, before the row
    form = r"check: .* \(.*\d s( in all)?\)"
    assert all(re.fullmatch(form, line) for line in lines), lines
    assert sum("of 4 checks" in line for line in lines) >= 3
    closed = subprocess.run(waiting(tmp_path, 0), **call)
    assert (closed.stdout, closed.stderr) == (b"a row\n", b"")


@pytest.mark.soak
@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals")
def test_a_terminal_is_renewed_while_the_main_thread_waits_for_processes(tmp_path):
    import pty

    ours, theirs = pty.openpty()
    call = waiting(tmp_path, 8)
    child = subprocess.Popen(call, cwd=tmp_path, stdout=theirs, stderr=theirs)
    os.close(theirs)
    seen, end = b"", time.monotonic() + 60.0
    while time.monotonic() < end and select.select([ours], [], [], 60.0)[0]:
        try:
            seen += os.read(ours, 4096)
        except OSError:  # it has ended
            break
    os.close(ours)
    assert child.wait(60) == 0
    text = seen.decode()
    states = re.findall(r"\r(\[[#-]{20}\] check: [^\r]*)", text)
    assert len(states) >= 8
    # on a busy machine the line may be renewed once more before the row
    assert re.search(r"check: 4 checks in \d+ s\r\n[^\n]*a row\r\n$", text)
    assert text.count("4 checks in") == 1
