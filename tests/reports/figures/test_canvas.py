"""What all figures share: a layout that needs no second drawing."""

import io
from pathlib import Path

import pytest

from rocking_cli import Look
from rocking_cli.reports.figures.canvas import drawn_as, legend, place, styled


def planned(figure):
    """Two panels with long labels, and a legend below."""
    for axes in figure.subplots(1, 2):
        for name in ("of the first", "of the second"):
            axes.plot([0, 1000.0], [0, 3.0], label=name)
        axes.set(ylabel="$a_g$ [m/s²]", title="a title\nin two lines")
    legend(figure.axes[0])


@pytest.mark.parametrize(
    ("form", "dpi"),
    [
        pytest.param("png", 200, marks=pytest.mark.soak),
        ("svg", 600),
    ],
)
def test_a_figure_that_is_drawn_once_has_the_bytes_of_savefig(form, dpi):
    with styled(Look()) as figure:
        planned(figure)
        once, missing = drawn_as(figure, Path(f"figure.{form}"), Look())
    with styled(Look()) as figure:
        planned(figure)
        twice = io.BytesIO()
        dates = {"Date": None} if form == "svg" else None
        figure.savefig(twice, format=form, dpi=dpi, metadata=dates)
    assert (once, missing) == (twice.getvalue(), "")


def test_margins_are_inches():
    with styled(Look()) as figure:
        figure.set_size_inches(4.0, 2.0)
        axes = figure.add_subplot()
        axes.set_ylabel("a label")
        place(figure, axes, left=1.0, bottom=0.5, right=0.4, top=0.3)
        drawn_as(figure, Path("figure.svg"), Look())
        x, y, width, height = axes.get_position().bounds
    assert (x, y) == pytest.approx((0.25, 0.25))
    assert (width, height) == pytest.approx((0.65, 0.6))
