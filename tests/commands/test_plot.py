"""`rocking plot` at the shell; what figures show is tested with the reports."""

import sys

import pytest

from rocking_cli.reports.figures.canvas import STYLE


def test_a_figure_in_characters_goes_to_standard_output(rocking, spectrum_file):
    assert "overturns" in rocking("plot", str(spectrum_file), "--text").stdout
    assert (
        "Omega = 5"
        in rocking("plot", str(spectrum_file), "--text", "--slice", "Omega=5").stdout
    )


def test_standard_input_is_drawn(rocking, tmp_path):
    curves = rocking(
        "envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--closed-form", "--csv"
    ).stdout
    done = rocking("plot", "-", "-o", "curves.svg", stdin=curves)
    assert (done.returncode, done.stderr) == (0, "")
    assert "initiation" in (tmp_path / "curves.svg").read_text()


@pytest.mark.usefixtures("undrawn")
def test_a_slice_says_which_value_it_took(rocking, spectrum_file):
    done = rocking(
        "plot", str(spectrum_file), "--slice", "Omega=5.003", "-o", "slice.png"
    )
    assert done.stderr.startswith("slice at Omega = 5.0")
    assert (
        rocking(
            "plot", str(spectrum_file), "--slice", "Omega=5", "-o", "quiet.png", "-q"
        ).stderr
        == ""
    )


def test_only_plot_advises_text_where_matplotlib_is_not_there(
    rocking, monkeypatch, spectrum_file
):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    missing = "rocking: figures need matplotlib: pip install matplotlib"
    assert rocking("draw", "block:0.5x2", "-o", "x.svg").stderr == f"{missing}\n"
    assert (
        rocking("plot", str(spectrum_file), "-o", "x.svg").stderr
        == f"{missing}; --text needs nothing\n"
    )


def test_characters_that_the_font_has_not_are_told_in_a_sentence(rocking):
    done = rocking("draw", "block:0.5x2,name=柱", "-o", "x.png")
    assert (done.returncode, done.stderr) == (
        0,
        "x.png: the font of the figure has no 柱; boxes stand there\n",
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "call",
    [
        ("response", "configs/block.yaml", "--a-g", "0.3g", "--f-g", "2"),
        ("records", "configs/motions/synthetic.at2"),
        ("records", "configs/motions/synthetic.at2", "--export-spectrum"),
        ("compare", "configs/block.yaml", "--A", "2", "--Omega", "4"),
        (
            *("check", "configs/block.yaml", "configs/parameters.yaml"),
            *("--a-g", "0.35g", "--T-g", "0.7", "--pulse", "rectangular"),
        ),
    ],
    ids=lambda call: call[0],
)
def test_a_command_draws_its_rows_as_plot_draws_their_csv(
    rocking, tmp_path, monkeypatch, call
):
    monkeypatch.setitem(STYLE, "figure.constrained_layout.use", False)  # takes long
    assert rocking(*call, "-o", "own.svg").returncode == 0
    if call[0] == "records" and len(call) == 2:
        source = call[1]
    else:
        curves = ["--curves"] * (call[0] == "compare")
        (tmp_path / "rows.csv").write_text(rocking(*call, *curves, "--csv").stdout)
        source = "rows.csv"
    assert rocking("plot", source, "-o", "plot.svg").returncode == 0
    assert (tmp_path / "own.svg").read_text() == (tmp_path / "plot.svg").read_text()


@pytest.mark.usefixtures("undrawn")
def test_the_ends_of_the_axes_are_those_stated(rocking, tmp_path):
    call = ("plot", "configs/motions/synthetic.at2", "-o", "r.svg")
    assert rocking(*call, "--xlim", "2:4", "--ylim=-0.3:0.3").returncode == 0
    found = rocking(*call, "--overwrite", "--xlim", "4:2")
    assert found.returncode == 2
    assert "--xlim: found '4:2'; expected two numbers FROM:TO" in found.stderr


@pytest.mark.usefixtures("undrawn")
def test_a_family_is_drawn_over_a_ratio_with_a_key_of_the_document(rocking):
    call = ("params", "configs/arch.yaml", "--vary", "thickness=1.2:1.5:3", "-o")
    assert rocking(*call, "a.svg", "--over", "thickness/radius").returncode == 0
    refused = rocking(*call, "b.svg", "--over", "thickness/height")
    assert refused.returncode == 2
    assert "found no single value of height in the documents" in refused.stderr


@pytest.mark.slow
def test_solve_draws_its_scan_its_margin_and_its_boundary(rocking, tmp_path):
    vary = ("solve", "configs/block.yaml", "--vary", "width=0.6225:0.6235:2")
    call = (*vary, "--a-g", "0.4g", "--f-g", "1")
    assert rocking(*call, "-o", "s.svg").returncode == 0
    drawn = (tmp_path / "s.svg").read_text()
    for words in ("one cycle of a sine of 0.4 g at 1 Hz", "width [m]", "0.6231"):
        assert f"{words}</text>" in drawn


def test_a_measured_rotation_lies_over_a_response(rocking, refused, tmp_path):
    done = rocking("response", "block:0.5x2", "--release", "0.5", "--csv")
    (tmp_path / "r.csv").write_text(done.stdout)
    (tmp_path / "m.csv").write_text("t [s],theta [deg]\n0,1\n0.1,0.5\n0.2,-1\n")
    rocking("plot", "r.csv", "--data", "m.csv", "-o", "r.svg")
    assert "m.csv, measured" in (tmp_path / "r.svg").read_text(encoding="utf-8")
    (tmp_path / "m.csv").write_text("t [s],uplift [mm]\n0,1\n0.1,0.5\n")
    call = ("plot", "r.csv", "--data", "m.csv", "-o", "u.svg")
    assert "found uplift; expected the rotation, theta" in refused(2, *call)
    call = ("plot", "r.csv", "--data", "m.csv", "--align", "-o", "u.svg")
    assert "--data goes with a response over its time" in refused(2, *call)
