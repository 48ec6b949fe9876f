"""A run that would take years is refused, with the number, before anything is computed or printed."""

from __future__ import annotations

import pytest

BLOCK = "kind: block\nwidth: 1\nheight: 5\nrestitution: 0.9"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--cycles", "1e5", "--grid", "A=1:20:100000,Omega=1:20:100000"], "which take years; accepted are up to 5e+08 cells"),
        (["--chunk", "1", "--grid", "A=1:20:10000,Omega=1:20:10000"], "100000000 units of work of 1 cells, accepted are up to 1000000"),
        (["--scheduler", "bogus", "--grid", "A=1:2:3,Omega=1:2:3"], "HOST:PORT or tcp://HOST:PORT is accepted"),
    ],
)
def test_a_sweep_without_end_is_refused(arguments, words, refused):
    assert words in refused(2, "spectrum", "--eta", "0.9", *arguments, "-o", "s.h5")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--grid", "f_g=1:2:2"], "no units"),
        (["--grid", "f_g=1:2:2", "--closed-form"], "no units"),
        (["--grid", "Omega=1:2:1000000", "--cycles", "1e5", "--a-max", "1e5"], "which take years; accepted are up to"),
        (["--grid", "Omega=1:2:2", "--model", "nonlinear"], "needs a critical angle"),
    ],
)
def test_an_envelope_is_refused_before_its_first_row(arguments, words, refused, tmp_path):
    (tmp_path / "b.yaml").write_text(BLOCK)
    assert words in refused(2, "envelope", "b.yaml", "--eta", "0.9", *arguments)
