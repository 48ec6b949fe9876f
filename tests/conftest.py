"""Shared by the tests: the command line as a user meets it, in this process, and a
spectra file to read.
"""

import gc
import io
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from support.documents import csv_rows

from rocking_cli import dimensionless_oscillator, parse_grid, sine, write_spectrum
from rocking_cli.commands import main, progress
from rocking_cli.interruption import STOPS

settings.register_profile(
    "the same everywhere", derandomize=True, database=None, deadline=None
)
settings.load_profile("the same everywhere")


def pytest_collection() -> None:
    """Collect tests without looking for garbage: all that is made stays."""
    gc.disable()


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()


ROOT = Path(__file__).resolve().parent.parent
# What the tests start keeps its compiled modules, as it does for a user; and so do the
# tests, whose assertions are rewritten once and not at each run.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False


class Done(subprocess.CompletedProcess[str]):
    """A finished call."""

    @property
    def records(self) -> list[dict[str, Any]]:
        """The JSON Lines that it printed."""
        return [json.loads(line) for line in self.stdout.splitlines()]

    @property
    def record(self) -> dict[str, Any]:
        """The only one of them."""
        return json.loads(self.stdout)

    @property
    def rows(self) -> list[dict[str, str]]:
        """The rows of the CSV that it printed, by the names of their columns without
        units.
        """
        return csv_rows(self.stdout)


Run = Callable[..., Done]


@pytest.fixture
def rocking(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run `rocking` in an empty folder; the repository's configs are at hand as
    `configs`.

    In this process, with streams of its own; an exception that `main` lets through, a
    traceback for the user, fails the test.
    """
    (tmp_path / "configs").symlink_to(ROOT / "configs")

    def run(*arguments: str, stdin: str | None = None, folder: Path = tmp_path) -> Done:
        handlers = {number: signal.getsignal(number) for number in STOPS}
        with monkeypatch.context() as patch:
            patch.chdir(folder)
            patch.setattr(
                progress, "_FIRST", 1e6
            )  # what is said to be long depends on the load
            if arguments[:1] == ("report",):  # maps of few cells
                patch.setattr("rocking_cli.reports.page_sections.SIDE", 4)
            # workers that nobody asked for take longer to start than to work
            patch.setattr("rocking_cli.processes.available_cpus", lambda: 1)
            patch.setattr(sys, "argv", ["rocking", *arguments])
            patch.setattr(
                sys, "unraisablehook", sys.unraisablehook
            )  # that of pytest again afterwards
            patch.setattr(
                sys,
                "stdin",
                io.TextIOWrapper(io.BytesIO((stdin or "").encode()), encoding="utf-8"),
            )
            streams = [
                io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
                for _ in range(2)
            ]
            patch.setattr(sys, "stdout", streams[0])
            patch.setattr(sys, "stderr", streams[1])
            try:
                with pytest.raises(SystemExit) as ended:
                    main(list(arguments))
            finally:
                for number, handler in handlers.items():
                    signal.signal(number, handler)
        said = [stream.buffer.getvalue().decode() for stream in streams]
        return Done(list(arguments), int(ended.value.code or 0), *said)

    return run


@pytest.fixture
def refused(rocking: Run, tmp_path: Path) -> Callable[..., str]:
    """Run a call that must be refused: exit code, one sentence, no traceback, nothing
    on standard output, no new file.
    """

    def run(code: int, *arguments: str, stdin: str | None = None) -> str:
        before = sorted(p.name for p in tmp_path.iterdir())
        done = rocking(*arguments, stdin=stdin)
        assert done.returncode == code, done.stderr
        assert done.stdout == ""
        assert "Traceback" not in done.stderr
        assert done.stderr.startswith("rocking"), done.stderr
        assert len(done.stderr.strip().splitlines()) == 1, done.stderr
        assert sorted(p.name for p in tmp_path.iterdir()) == before
        return done.stderr

    return run


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are planned and not drawn, for tests of the words around them."""

    def saved(_: object, target: io.BytesIO, **__: object) -> None:
        target.write(b"<?xml version='1.0'?><svg/>")

    pytest.importorskip("matplotlib")
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", saved)
    monkeypatch.setattr("rocking_cli.reports.figures.canvas._arrange", lambda *_: None)


@pytest.fixture(scope="session")
def spectrum_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A complete spectra file of one restitution, to be read only."""
    path = tmp_path_factory.mktemp("spectra") / "s.h5"
    write_spectrum(
        [dimensionless_oscillator(eta=0.9)],
        sine(),
        parse_grid("A=0.5:8:200,Omega=1:8:200"),
        path,
        workers=1,
        chunk_cells=5000,
    )
    return path
