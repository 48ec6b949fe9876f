"""Figures by what they draw: the lines, their data, axes and labels, read back from the figure that would be saved."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib import colors
from matplotlib.figure import Figure
from written import csv_rows

from rocking_cli import Outcome, UsageError, closed_form_curves
from rocking_cli.reports.plot import draw, text_map
from rocking_cli.spectra.reader import SpectraFile


@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """Draw a file and give the figure instead of saving it."""
    saved = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, target: saved.append(figure))

    def run(source, **options):
        draw(source, tmp_path / "figure.png", **options)
        return saved[-1]

    return run


@pytest.fixture
def table(rocking, tmp_path):
    """The CSV of a call as a file, and its rows."""

    def run(*call):
        text = rocking(*call, "--csv").stdout
        (tmp_path / "table.csv").write_text(text)
        return tmp_path / "table.csv", csv_rows(text)

    return run


def numbers(rows, key):
    return np.array([float(r[key]) if r[key] else np.nan for r in rows])


def lines(axes):
    """{label: (x, y)} of the lines that a legend names."""
    return {line.get_label(): line.get_data() for line in axes.get_lines() if not line.get_label().startswith("_")}


def same(line, x, y):
    np.testing.assert_array_equal(line[0], x)
    np.testing.assert_array_equal(line[1], y)


def test_a_map_shows_the_outcome_of_every_cell(drawn, spectrum_file):
    with SpectraFile(spectrum_file) as file:
        outcome, grid = file.block(0, slice(None))["outcome"], file.grid
    (axes,) = drawn(spectrum_file).axes
    (mesh,) = axes.collections
    np.testing.assert_array_equal(mesh.get_array().reshape(outcome.T.shape), outcome.T)
    shown = mesh.cmap(mesh.norm(outcome.T))
    for o in {Outcome(int(x)) for x in np.unique(outcome)}:
        assert {tuple(x) for x in shown[o == outcome.T]} == {colors.to_rgba(o.colour)}
        assert o.sentence in [t.get_text() for t in axes.get_legend().get_texts()]
    assert axes.get_xlim() == (grid.frequency.values[0], grid.frequency.values[-1])
    assert axes.get_ylim() == (grid.amplitude.values[0], grid.amplitude.values[-1])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Ω = ω_g/p [-]", "A = a_scale a_g/(α g) [-]")
    assert axes.get_title() == "eta=0.9, η = 0.9: sine, 1 cycle"


def test_a_map_carries_the_closed_form_curves_of_its_motion(drawn, spectrum_file):
    curves = lines(drawn(spectrum_file).axes[0])
    assert set(curves) == {f"closed form: {c}" for c in ("initiation", "no impact", "after impact lower", "after impact upper")}
    for label, (x, y) in curves.items():
        name = label.removeprefix("closed form: ").replace(" ", "_")
        expected = [(p.omega, p.amplitude) for p in closed_form_curves(x[::20], 0.9) if p.curve == name]
        np.testing.assert_allclose(np.array([x[::20], y[::20]]).T, expected, rtol=1e-12)


@pytest.mark.parametrize("more", ["one_sided: true", "damping: 0.05"])
def test_a_map_of_another_body_carries_none(drawn, rocking, tmp_path, more):
    rocking("spectrum", "-", "--grid", "A=1:4:4,Omega=2:5:4", "-o", "other.h5", "-q", stdin=f"kind: block\nwidth: 1\nheight: 5\n{more}\n")
    assert lines(drawn(tmp_path / "other.h5").axes[0]) == {}


def test_a_slice_is_a_row_of_the_file_with_gaps_where_it_overturns(drawn, spectrum_file):
    with SpectraFile(spectrum_file) as file:
        frequency, amplitude = file.grid.frequency.values, file.grid.amplitude.values
        theta = file.block(0, slice(None))["theta_ratio"]
    at = int(np.abs(frequency - 5.0).argmin())
    (axes,) = drawn(spectrum_file, cut="Omega=5").axes
    ((label, line),) = lines(axes).items()
    assert label == "eta=0.9, η = 0.9"
    same(line, amplitude, theta[at])
    assert np.isnan(line[1]).any()
    assert f"Omega = {frequency[at]:.4g}; gaps: overturned" in axes.get_title()
    other = drawn(spectrum_file, cut="A=3").axes[0]
    same(next(iter(lines(other).values())), frequency, theta[:, int(np.abs(amplitude - 3.0).argmin())])
    assert (other.get_xlabel(), other.get_ylabel()) == ("Ω = ω_g/p [-]", "θ_max/α [-]")


@pytest.mark.parametrize(("log", "scales"), [("", ("linear", "linear")), ("x", ("log", "linear")), ("xy", ("log", "log"))])
def test_axes_are_logarithmic_where_asked(drawn, spectrum_file, log, scales):
    (axes,) = drawn(spectrum_file, log=log).axes
    assert (axes.get_xscale(), axes.get_yscale()) == scales


def test_an_envelope_is_a_stroke_from_where_overturning_begins_to_where_it_ends(drawn, table):
    source, rows = table("envelope", "--eta", "0.9", "--grid", "Omega=2:6:5")
    (axes,) = drawn(source).axes
    top = axes.get_ylim()[1]
    assert top == pytest.approx(1.1 * np.nanmax([numbers(rows, "A_from"), numbers(rows, "A_to")]))
    strokes = sorted(tuple(map(tuple, s)) for c in axes.collections for s in c.get_segments())
    expected = sorted(((float(r["Omega"]), float(r["A_from"])), (float(r["Omega"]), float(r["A_to"] or top))) for r in rows)
    assert np.array(strokes) == pytest.approx(np.array(expected))
    assert set(lines(axes)) == {o.sentence for o in Outcome if o.mode in {r["mode"] for r in rows}}


def test_curves_are_a_line_each(drawn, table):
    source, rows = table("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--closed-form")
    found = lines(drawn(source).axes[0])
    assert len(found) == 4
    for label, line in found.items():
        mine = [r for r in rows if r["curve"].replace("_", " ") in label]
        same(line, numbers(mine, "Omega"), numbers(mine, "A"))


@pytest.mark.parametrize(
    ("extra", "x", "y", "ground", "labels"),
    [
        (("--model", "both"), "t", ("theta_linear", "theta_nonlinear"), "ground_acceleration", ("time t [s]", "rotation θ [rad]")),
        (("--dimensionless",), "tau", ("theta_ratio",), "A", ("p t [-]", "θ/α [-]")),
    ],
)
def test_a_response_stands_above_its_motion(drawn, table, extra, x, y, ground, labels):
    source, rows = table("response", "configs/block.yaml", "--A", "2", "--Omega", "4", *extra)
    axes, below = drawn(source).axes
    for line, column in zip(axes.get_lines(), y, strict=True):
        same(line.get_data(), numbers(rows, x), numbers(rows, column))
    same(below.get_lines()[0].get_data(), numbers(rows, x), numbers(rows, ground))
    assert (below.get_xlabel(), axes.get_ylabel()) == labels
    assert (axes.get_legend() is not None) == (len(y) > 1)


def test_a_comparison_collapses_from_left_to_right(drawn, table):
    call = ("compare", "configs/block.yaml", "configs/spire.yaml", "--A", "2", "--Omega", "4", "--eta", "0.8", "--curves")
    source, rows = table(*call)
    left, right = drawn(source).axes
    assert set(lines(left)) == {"Column, linear", "Spire, linear"}
    for name in ("Column", "Spire"):
        mine = [r for r in rows if r["structure"] == name]
        same(lines(left)[f"{name}, linear"], numbers(mine, "t"), numbers(mine, "theta"))
        same(lines(right)[f"{name}, linear"], numbers(mine, "tau"), numbers(mine, "theta_ratio"))
    heights = [[np.abs(y).max() for _, y in lines(axes).values()] for axes in (left, right)]
    assert max(heights[0]) > 1.2 * min(heights[0])
    assert max(heights[1]) == pytest.approx(min(heights[1]), rel=1e-3)


def test_a_family_is_four_parameters_over_the_first_key_and_a_line_for_each_value_of_the_second(drawn, table):
    source, rows = table("params", "configs/spire.yaml", "--vary", "base_radius=1:2:4", "--vary", "height=8:16:3")
    figure = drawn(source)
    assert [a.get_xlabel() for a in figure.axes] == ["", "", "base radius [m]", "base radius [m]"]
    assert [a.get_ylabel() for a in figure.axes] == ["p [rad/s]", "α [rad]", "η [-]", "λ [-]"]
    for axes, key in zip(figure.axes, ("p", "alpha", "eta", "lambda"), strict=True):
        found = lines(axes)
        assert list(found) == ["height = 8 m", "height = 12 m", "height = 16 m"]
        for label, line in found.items():
            mine = [r for r in rows if float(r["height"]) == float(label.split()[2])]
            same(line, numbers(mine, "base_radius"), numbers(mine, key))


def test_accuracy_is_error_over_time(drawn, table):
    call = ("accuracy", "--eta", "0.9", "--grid", "A=1:9:9,Omega=1:9:9", "--sample", "3", "--scipy", "1")
    source, rows = table(*call)
    (axes,) = drawn(source).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    for method, line in lines(axes).items():
        mine = [r for r in rows if r["method"] == method]
        assert line[0] == pytest.approx(1e6 * numbers(mine, "time_per_cell"), rel=1e-12)
        same(line, line[0], np.maximum(numbers(mine, "error_max"), 1e-17))


def test_a_map_in_characters_has_the_sign_of_each_cell(spectrum_file):
    with SpectraFile(spectrum_file) as file:
        outcome = file.block(0, slice(None))["outcome"]
        told = text_map(file, None, None, width=200, height=200)
    assert [line.partition("|")[2] for line in told[1:201]] == ["".join(Outcome(int(o)).sign for o in row) for row in outcome.T[::-1]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a,b\n1,2\n", "are none that a command of this program writes"),
        ("p,alpha\n", "holds no rows"),
        ("event,t\nuplift,1\n", "holds events"),
        ("t,theta,ground_acceleration\n0,x,1\n", "cannot be drawn"),
        ("name,p,alpha,eta,lambda\nx,1,1,1,1\n", "a family is drawn over the keys that were varied"),
    ],
)
def test_tables_that_cannot_be_drawn(drawn, tmp_path, text, words):
    (tmp_path / "table.csv").write_text(text)
    with pytest.raises(UsageError, match=words):
        drawn(tmp_path / "table.csv")
