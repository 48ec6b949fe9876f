"""Shared by the tests: the command line as a user meets it, in a process of its own."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rocking_cli import dimensionless_oscillator, parse_grid, sine, write_spectrum

ROOT = Path(__file__).resolve().parent.parent
Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def rocking(tmp_path: Path) -> Run:
    """Run `rocking` in an empty folder; the repository's configs are at hand as `configs`."""
    (tmp_path / "configs").symlink_to(ROOT / "configs")

    def run(*arguments: str, stdin: str | None = None) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "rocking_cli", *arguments],
            cwd=tmp_path, input=stdin if stdin is not None else "", capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip

    return run


@pytest.fixture
def refused(rocking: Run, tmp_path: Path) -> Callable[..., str]:
    """Run a call that must be refused: exit code, one sentence, no traceback, nothing on standard output, no new file."""

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


@pytest.fixture(scope="session")
def spectrum_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A complete spectra file of one restitution, to be read only."""
    path = tmp_path_factory.mktemp("spectra") / "s.h5"
    write_spectrum([dimensionless_oscillator(0.9)], parse_grid("A=0.5:8:400,Omega=1:8:400"), sine(), path, workers=1, chunk_cells=20_000)
    return path
