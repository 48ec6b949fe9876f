"""`rocking plot` at the shell; what figures show is tested with the reports."""

import sys


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


def test_the_rows_of_a_check_are_drawn_as_check_draws_them(rocking, tmp_path):
    call = (
        "check",
        "configs/block.yaml",
        "configs/parameters.yaml",
        "--a-g",
        "0.35g",
        "--f-g",
        "1.5",
    )
    done = rocking(*call, "--csv", "-o", "own.svg", "--units", "g")
    (tmp_path / "verdicts.csv").write_text(done.stdout)
    assert rocking("plot", "verdicts.csv", "-o", "plotted.svg").returncode == 0
    assert (tmp_path / "plotted.svg").read_text() == (tmp_path / "own.svg").read_text()


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
