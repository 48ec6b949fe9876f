"""Overturning maps, read back from the figure that would be saved."""

import math

import numpy as np
import pytest
from matplotlib import colors
from matplotlib.figure import Figure
from support.axes import lines
from support.record_layouts import rows, wave

from rocking_cli import (
    Outcome,
    SpectraFile,
    UsageError,
    closed_form_curves,
    draw,
)
from rocking_cli.reports.figures.colours import COLOURS
from rocking_cli.reports.units import parse_units


def entries(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.fixture(scope="module")
def figure(spectrum_file, tmp_path_factory):
    """The map of the shared file, drawn once: its closed-form curves take a second."""
    with pytest.MonkeyPatch.context() as patch:
        saved = []
        patch.setattr(
            Figure, "savefig", lambda figure, target, **_: saved.append(figure)
        )
        patch.setattr("rocking_cli.reports.figures.canvas._arrange", lambda *_: None)
        draw(spectrum_file, tmp_path_factory.mktemp("map") / "map.png")
    return saved[0]


def test_a_map_shows_the_outcome_of_every_cell(figure, spectrum_file):
    with SpectraFile(spectrum_file) as file:
        outcome, grid = file.block(0, slice(None))["outcome"], file.grid
    (axes,) = figure.axes
    (mesh,) = axes.collections
    np.testing.assert_array_equal(mesh.get_array().reshape(outcome.T.shape), outcome.T)
    shown = mesh.cmap(mesh.norm(outcome.T))
    for o in {Outcome(int(x)) for x in np.unique(outcome)}:
        assert {tuple(x) for x in shown[o == outcome.T]} == {colors.to_rgba(COLOURS[o])}
        assert o.sentence in entries(figure)
    assert axes.get_xlim() == (grid.frequency.values[0], grid.frequency.values[-1])
    assert axes.get_ylim() == (grid.amplitude.values[0], grid.amplitude.values[-1])
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        r"$\Omega = \omega_g/p$ [-]",
        r"$A = a_{scale}\,a_g/(\alpha g)$ [-]",
    )
    assert axes.get_title() == "$\\eta$ = 0.9\none cycle of a sine, linear equation"


def test_its_curves_go_up_to_their_nose_and_have_their_names_on_them(figure):
    curves = lines(figure.axes[0])
    assert set(curves) == {
        f"closed form: {c}"
        for c in ("initiation", "no impact", "after impact lower", "after impact upper")
    }
    assert not any("closed form" in text for text in entries(figure))
    assert {text.get_text() for text in figure.axes[0].texts} == {
        label.removeprefix("closed form: ") for label in curves
    }
    for label, (x, y) in curves.items():
        name = label.removeprefix("closed form: ").replace(" ", "_")
        expected = [
            (p.omega, p.amplitude)
            for p in closed_form_curves(x[::20], 0.9)
            if p.curve == name
        ]
        np.testing.assert_allclose(np.array([x[::20], y[::20]]).T, expected, rtol=1e-12)
    (low_x, low_y), (high_x, high_y) = (
        curves[f"closed form: after impact {end}"] for end in ("lower", "upper")
    )
    # Both end at the nose, where the two roots run together as a square root does.
    assert low_x[-1] == pytest.approx(high_x[-1], rel=1e-3)
    assert (
        0.0
        < high_y[-1] - low_y[-1]
        < 0.1
        * np.max(high_y - low_y[: high_y.size] if high_y.size == low_y.size else high_y)
    )
    assert not closed_form_curves(np.array([1.001 * max(low_x[-1], high_x[-1])]), 0.9)[
        2:
    ]


def test_a_map_with_units_is_in_g_and_hz_or_those_asked_for_with_a_panel_a_structure(
    drawn, swept
):
    towers = swept(
        "configs/block.yaml",
        "configs/spire.yaml",
        "--pulse",
        "cosine",
        "--grid",
        "a_g=0.2g:1g:9,f_g=0.5:2:7",
    )
    figure = drawn(towers, every=True)
    axes, other = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$f_g$ [Hz]", "$a_g$ [g]")
    assert (*axes.get_xlim(), *axes.get_ylim()) == pytest.approx(
        (0.5, 2, 0.2, 1), rel=1e-12
    )
    assert [one.get_title().partition(",")[0] for one in figure.axes] == [
        "Column",
        "Spire",
    ]
    assert len(figure.legends) == 1
    (si,) = drawn(towers, structure="Spire", units=parse_units("m/s2,rad/s")).axes
    assert (si.get_xlabel(), si.get_ylabel()) == (r"$\omega_g$ [rad/s]", "$a_g$ [m/s²]")
    assert si.get_xlim() == pytest.approx((math.pi, 4 * math.pi), rel=1e-12)
    np.testing.assert_array_equal(
        other.collections[0].get_array(), si.collections[0].get_array()
    )


def test_curves_over_a_map_with_units_are_in_them(drawn, swept):
    call = (
        "configs/block.yaml",
        "--pulse",
        "rectangular",
        "--grid",
        "a_g=0.2g:1g:9,f_g=0.5:2:7",
        "--model",
        "linear",
    )
    curves = lines(drawn(swept(*call)).axes[0])
    x, y = curves["closed form: initiation"]
    np.testing.assert_allclose(y, math.atan(0.25), rtol=1e-12)  # A = 1 is a_g = alpha g
    assert x[[0, -1]] == pytest.approx([0.5, 2], rel=1e-12)
    x, y = curves["closed form: no impact"]
    p = math.sqrt(0.75 * 9.81 / math.hypot(0.25, 1.0))
    np.testing.assert_allclose(
        y, math.atan(0.25) / -np.expm1(-p / x), rtol=1e-12
    )  # A = 1/(1 - exp(-p t_d)), t_d = 1/f_g


@pytest.mark.parametrize("more", ["one_sided: true", "damping: 0.05"])
def test_a_map_of_another_body_carries_no_curves(drawn, swept, more):
    other = swept(
        "-",
        "--grid",
        "A=1:4:4,Omega=2:5:4",
        stdin=f"kind: block\nwidth: 1\nheight: 5\n{more}\n",
    )
    assert lines(drawn(other).axes[0]) == {}


def test_blocks_under_a_record_are_a_map_and_structures_are_lines_over_its_factor(
    drawn, swept, tmp_path
):
    (tmp_path / "wave.txt").write_text(rows(wave(30, 3.0), 1, "{:.9e}"))
    record = (
        "--motion",
        "wave.txt",
        "--unit",
        "m/s2",
        "--dt",
        "0.05",
        "--model",
        "linear",
    )
    path = swept(*record, "--alpha", "10,15,20deg", "--grid", "T=3:4:2")
    with SpectraFile(path) as file:
        outcome = file.block(0, slice(None))["outcome"]
    (axes,) = drawn(path, structure="wave", units=parse_units("deg")).axes
    np.testing.assert_array_equal(
        axes.collections[0].get_array().reshape(outcome.shape), outcome
    )
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        r"$T = 2\pi/p$ [s]",
        r"$\alpha$ [deg]",
    )
    assert axes.get_ylim() == pytest.approx((10, 20), rel=1e-12)
    path = swept("configs/block.yaml", *record, "--grid", "scale=0.5:1:2")
    with SpectraFile(path) as file:
        theta = file.block(0, slice(None))["theta_ratio"][0]
    (axes,) = drawn(path).axes
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), theta)
    assert axes.get_xlabel() == "factor of the record [-]"


def test_a_file_without_a_cell_is_refused(drawn, swept):
    with pytest.raises(UsageError, match="holds no computed cell"):
        drawn(swept("--eta", "0.9", "--grid", "A=1:2:3,Omega=1:2:3", "--shard", "2/2"))


def test_a_map_has_closed_forms_and_none_of_a_vertical_motion(drawn, swept):
    call = ("configs/block.yaml", "--grid", "A=0.5:3:6,Omega=2:6:5", "--no-validity")
    path, upwards = (
        swept(*call),
        swept(*call, "--vertical", "cosine", "--vertical-scale", "0.5"),
    )
    assert any("closed form" in label for label in lines(drawn(path).axes[0]))
    assert not drawn(upwards).axes[0].get_lines()
    with (
        SpectraFile(upwards) as file,
        pytest.raises(UsageError, match="found a vertical motion"),
    ):
        file.motion()
