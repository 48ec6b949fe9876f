"""A run that would take years is refused, with the number, before anything is computed or printed."""

import pytest

SWEEP, ENVELOPE = ("spectrum", "--eta", "0.9", "-o", "s.h5"), ("envelope", "b.yaml", "--eta", "0.9")


@pytest.mark.parametrize(
    ("call", "arguments", "words"),
    [
        (SWEEP, ["--cycles", "1e5", "--grid", "A=1:20:100000,Omega=1:20:100000"], "which would take years; expected up to 5e+08 cells"),
        (SWEEP, ["--chunk", "1", "--grid", "A=1:20:10000,Omega=1:20:10000"], "found 100000000 units of work of 1 cells; expected up to"),
        (ENVELOPE, ["--grid", "f_g=1:2:2"], "no units"),
        (ENVELOPE, ["--grid", "f_g=1:2:2", "--closed-form"], "no units"),
        (ENVELOPE, ["--grid", "Omega=1:2:1000000", "--cycles", "1e5", "--a-max", "1e5"], "which would take years; expected up to"),
        (ENVELOPE, ["--grid", "Omega=1:2:2", "--model", "nonlinear"], "needs a critical angle"),
    ],
)
def test_a_run_without_end_is_refused(call, arguments, words, refused, tmp_path):
    (tmp_path / "b.yaml").write_text("kind: block\nwidth: 1\nheight: 5\nrestitution: 0.9")
    assert words in refused(2, *call, *arguments)
