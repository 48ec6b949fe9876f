"""What can be drawn, and how: axes, legends, and tables that are refused."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.axes import lines, numbers, same

from rocking_cli import (
    OutputError,
    UsageError,
    build_structure,
    draw,
    load_structures,
    parse_documents,
    parse_grid,
    sine,
    spectrum,
)
from rocking_cli.reports.figures.canvas import (
    FIGURE_UNITS,
    Look,
    canvas,
    legend,
    line_style,
    styled,
)
from rocking_cli.reports.figures.drawing import structure_axes
from rocking_cli.structures.kinds import sketch_of


@pytest.mark.parametrize(
    ("log", "scales"),
    [("", ("linear", "linear")), ("x", ("log", "linear")), ("xy", ("log", "log"))],
)
def test_axes_are_logarithmic_where_asked(drawn, spectrum_file, log, scales):
    (axes,) = drawn(spectrum_file, cut="Omega=5", log=log).axes
    assert (axes.get_xscale(), axes.get_yscale()) == scales
    for axis, scale in zip((axes.xaxis, axes.yaxis), scales, strict=True):
        if scale == "log":  # plain numbers, which do not overlap
            steps = [
                x / 10.0 ** np.floor(np.log10(x)) for x in axis.get_majorticklocs()
            ]
            assert {round(x, 9) for x in steps} <= {1.0, 2.0, 5.0}
            assert axis.get_major_formatter()(0.5) == "0.5"


def test_accuracy_is_error_over_time(drawn, table):
    call = (
        "accuracy",
        "--eta",
        "0.9",
        "--grid",
        "A=1:9:9,Omega=1:9:9",
        "--sample",
        "3",
        "--scipy",
        "1",
    )
    source, rows = table(*call)
    (axes,) = drawn(source).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    for method, line in lines(axes).items():
        mine = [r for r in rows if r["method"] == method]
        assert line[0] == pytest.approx(1e6 * numbers(mine, "time_per_cell"), rel=1e-12)
        same(line, line[0], np.maximum(numbers(mine, "largest_difference"), 1e-17))


@pytest.mark.parametrize(
    ("count", "name", "grows"),
    [(2, "a", 1), (9, "a", 1), (10, "a", 0), (2, "a" * 40, 0)],
)
def test_a_legend_stands_below_the_axes_or_if_it_is_long_beside_them(
    count, name, grows
):
    for room in (True, False):  # Axes of a caller have no room outside
        with styled(Look()) as own:
            figure = own if room else Figure(layout="constrained")
        size = figure.get_size_inches().copy()
        axes = figure.add_subplot()
        for i in range(count):
            axes.plot([0, 1], [0, i], label=f"{name}{i}")
        legend(axes)
        assert (len(figure.legends), axes.get_legend() is None) == (int(room), room)
        assert list(figure.get_size_inches() > size) == (
            [grows == 0, grows == 1] if room else [False, False]
        )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a,b\n1,2\n", "found the columns a, b; expected the CSV table"),
        ("p,alpha\n", "holds no rows"),
        ("event,t\nuplift,1\n", "found events"),
        ("t,theta,theta_dot,ground_acceleration\n0,x,0,1\n", "cannot be drawn"),
        (
            "t,theta,theta_dot,ground_acceleration\n0,,,\n1,,,\n",
            "holds nothing to draw",
        ),
        (
            "structure,Omega,A_from,A_to,mode\nx,1,,,none\nx,2,,,none\n",
            "holds nothing to draw",
        ),
    ],
)
def test_tables_that_cannot_be_drawn(drawn, text, words):
    with pytest.raises(UsageError, match=words):
        drawn(text)


@pytest.mark.parametrize(
    ("form", "begins"),
    [
        ("png", b"\x89PNG"),
        ("svg", b"<?xml"),
        pytest.param("pdf", b"%PDF", marks=pytest.mark.soak),
    ],
)
def test_a_figure_is_written_whole_or_not_at_all_and_alike_each_time(
    tmp_path, monkeypatch, form, begins
):
    target, again = tmp_path / f"x.{form}", tmp_path / f"y.{form}"
    for path in (target, again):
        with canvas(path) as figure:
            figure.add_subplot().plot([0, 1], [0, 1])
    assert target.read_bytes() == again.read_bytes()
    assert target.read_bytes().startswith(begins)

    def full(source, to):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    with (
        pytest.raises(
            OutputError, match=r"x.\w+: cannot be written: No space left on device"
        ),
        canvas(target) as figure,
    ):
        figure.add_subplot()
    assert target.read_bytes() == again.read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == [target.name, again.name]


def test_a_figure_has_the_size_the_title_and_the_style_asked_for_and_its_texts_as_text(
    tmp_path,
):
    (tmp_path / "grey.mplstyle").write_text(
        "axes.prop_cycle: cycler('color', ['808080'])\nlines.linewidth: 3\n"
    )
    with canvas(
        tmp_path / "x.svg",
        look=Look(0.085, None, "Hall $1", tmp_path / "grey.mplstyle"),
    ) as figure:
        figure.add_subplot(title="its own").plot([0, 1], [0, 1], **line_style(0))
    drawn = (tmp_path / "x.svg").read_text()
    assert f'width="{85 / 25.4 * 72:.6f}pt"' in drawn
    assert "Hall $1</text>" in drawn
    assert "its own" not in drawn
    assert "stroke: #808080; stroke-width: 3" in drawn
    with canvas(tmp_path / "y.png", look=Look(0.1, 100.0)) as figure:
        figure.add_subplot()
    assert int.from_bytes((tmp_path / "y.png").read_bytes()[16:20], "big") == int(
        0.1 / 0.0254 * 100
    )
    with (
        pytest.raises(UsageError, match="cannot be read as a style"),
        canvas(tmp_path / "z.png", look=Look(style="none.mplstyle")),
    ):
        pass


def test_a_drawing_in_narrow_axes_keeps_legend_and_title_inside():
    """A column of a journal is 85 mm wide."""
    figure = Figure(figsize=(3.35, 2.8), layout="constrained", dpi=100)
    axes = figure.add_subplot()
    (body,) = load_structures("block:0.5x2")
    found = spectrum([body], sine(), parse_grid("a_g=0.1g:1g:6,f_g=0.5:3:6"), check=0)
    draw(found, axes)
    figure.draw_without_rendering()
    assert not figure.legends
    frame = axes.get_window_extent()
    inside = axes.get_legend().get_window_extent()
    assert frame.x0 <= inside.x0 < inside.x1 <= frame.x1
    assert frame.y0 <= inside.y0 < inside.y1 <= frame.y1
    title = axes.title.get_window_extent()
    assert 0.0 <= title.x0 < title.x1 <= figure.bbox.x1


@pytest.mark.parametrize(
    ("keys", "lengths", "said"),
    [
        ("span: 12 m, rise: 4 m, thickness: 0.8 m", {"12 m", "4 m", "0.8 m"}, ""),
        (
            "radius: 10 m, angle: 157.5 deg, thickness: 1.5 m",
            {"1.5 m"},
            "radius 10 m, angle 157.5°",
        ),
    ],
)
def test_an_arch_is_drawn_with_the_dimensions_of_its_document(keys, lengths, said):
    with styled(Look()) as figure:
        axes = figure.add_subplot()
        (document,) = parse_documents(f"{{kind: arch, name: A, {keys}}}")
        structure = build_structure(document)
        structure_axes(axes, structure, sketch_of(document, structure), FIGURE_UNITS)
    texts = {text.get_text() for text in axes.texts}
    assert {text for text in texts if re.fullmatch(r"[\d.]+ m", text)} == lengths
    assert said == "" or said in texts
