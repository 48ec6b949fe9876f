"""`rocking info` at the shell."""

from dataclasses import replace

import pytest
from support.documents import same_file
from support.shown_commands import shell

from rocking_cli import dimensionless_oscillator, parse_grid, sine, write_spectrum


@pytest.mark.slow
@pytest.mark.parametrize(
    "call",
    [
        (
            "spectrum",
            "b.yaml",
            "block:0.3x2",
            "--grid",
            "a_g=0.2g:0.9g:5,f_g=1:2:3",
            "--cycles",
            "1.5",
            "--impacts",
            "--tolerance=1e-7",
        ),
        (
            "spectrum",
            "--eta",
            "0.9",
            "--eta",
            "0.7",
            "--grid",
            "A=1:4:9,Omega=2:5:4",
            "-q",
        ),
        (
            "spectrum",
            "b.yaml",
            "--motion",
            "configs/motions/synthetic.at2",
            "configs/motions/synthetic.at2",
            "--grid",
            "A=1:2:3",
        ),
    ],
    ids=["documents", "oscillators", "records"],
)
def test_the_command_of_a_file_makes_it_again(rocking, tmp_path, call):
    (tmp_path / "b.yaml").write_text(
        "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: auto\n"
    )
    assert rocking(*call, "-o", "one.h5", "--workers", "1").returncode == 0
    (tmp_path / "b.yaml").unlink()
    record = rocking("info", "one.h5", "--command", "--json").record
    assert record["command"].startswith(
        "rocking info one.h5 --documents | rocking spectrum -"
    ) == ("b.yaml" in call)
    shell(rocking, record["command"], tmp_path)
    same_file(tmp_path / "one-again.h5", tmp_path / "one.h5")
    again = rocking("info", "one-again.h5", "--command", "--json").record
    for key in ("structures", "eta", "tolerance", "cells", "motion"):
        assert again[key] == record[key]
    shown = rocking("info", "one.h5", "--command").stdout
    assert record["command"] in shown.replace(" \\\n  ", " ")
    assert max(map(len, shown.splitlines())) <= 100


def test_a_file_without_a_command_says_so(rocking, spectrum_file):
    done = rocking("info", str(spectrum_file), "--command", "--json")
    assert done.record["command"] is None
    assert "holds no command" in done.stderr


def test_names_do_not_steer_the_terminal(rocking, tmp_path):
    structure = replace(dimensionless_oscillator(eta=0.9), name="a\x1b[31mb")
    write_spectrum(
        [structure], sine(), parse_grid("A=1:2:3,Omega=1:2:3"), tmp_path / "s\x1b[2J.h5"
    )
    for call in (("info",), ("info", "--json"), ("convert",), ("convert", "--json")):
        done = rocking(*call, "s\x1b[2J.h5")
        assert done.returncode == 0
        assert "31mb" in done.stdout
        assert "\x1b" not in done.stdout + done.stderr
    (tmp_path / "t\x1b[2J.h5").write_text("nothing")
    assert "\x1b" not in rocking("info", "t\x1b[2J.h5").stderr
