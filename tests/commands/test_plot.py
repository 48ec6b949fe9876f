"""`rocking plot` at the shell: the formats it writes and what it refuses. What figures show is tested with the reports."""

from __future__ import annotations

import pytest


@pytest.mark.parametrize(("name", "begins"), [("map.png", b"\x89PNG"), ("map.svg", b"<?xml"), ("map.pdf", b"%PDF")])
def test_a_figure_is_written_in_the_format_of_its_name(rocking, spectrum_file, tmp_path, name, begins):
    done = rocking("plot", str(spectrum_file), "--slice", "Omega=5", "-o", name)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / name).read_bytes().startswith(begins)


def test_a_figure_in_characters_goes_to_standard_output(rocking, spectrum_file):
    assert "overturns" in rocking("plot", str(spectrum_file), "--text").stdout
    assert "Omega = 5" in rocking("plot", str(spectrum_file), "--text", "--slice", "Omega=5").stdout


def test_refusals(rocking, refused, spectrum_file, tmp_path):
    (tmp_path / "params.csv").write_text(rocking("params", "configs/spire.yaml", "--vary", "base_radius=1:2:4", "--csv").stdout)
    (tmp_path / "foreign.csv").write_text("a,b\n1,2\n")
    (tmp_path / "there.png").write_text("mine")
    assert "exists" in refused(2, "plot", "params.csv", "-o", "there.png")
    assert "are none that a command" in refused(2, "plot", "foreign.csv", "-o", "x.png")
    assert "ends in .png" in refused(2, "plot", "params.csv", "-o", "x.bmp")
    assert "--slice" in refused(2, "plot", str(spectrum_file), "--text", "--slice", "B=3")
    assert "Omega=1 to 8" in refused(2, "plot", str(spectrum_file), "--text", "--slice", "Omega=99")
    assert "spectra files" in refused(2, "plot", "params.csv", "--text")
    assert "--slice goes with a spectra file" in refused(2, "plot", "params.csv", "--slice", "A=1", "-o", "x.png")
    assert "--over goes with" in refused(2, "plot", str(spectrum_file), "--over", "height", "-o", "x.png")
    assert "--all and --slice do not go together" in refused(2, "plot", str(spectrum_file), "--all", "--slice", "A=3", "-o", "x.png")


def test_standard_input_is_drawn(rocking, tmp_path):
    curves = rocking("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--closed-form", "--csv").stdout
    done = rocking("plot", "-", "-o", "curves.svg", stdin=curves)
    assert (done.returncode, done.stderr) == (0, "")
    assert "initiation" in (tmp_path / "curves.svg").read_text()


def test_a_slice_says_which_value_it_took(rocking, spectrum_file):
    done = rocking("plot", str(spectrum_file), "--slice", "Omega=5.003", "-o", "slice.png")
    assert done.stderr.startswith("slice at Omega = 5.0")
    assert rocking("plot", str(spectrum_file), "--slice", "Omega=5", "-o", "quiet.png", "-q").stderr == ""
