"""Shared by the tests of figures: a figure instead of a file, the files that it is
drawn from, and what its axes hold.
"""

import pytest
from matplotlib.figure import Figure
from support.documents import csv_rows

from rocking_cli.reports.drawing_files import draw


@pytest.fixture
def figures(monkeypatch):
    """The figures that would be saved, in order; their axes are not yet arranged,
    which takes as long as all the rest.
    """
    saved = []
    monkeypatch.setattr("rocking_cli.reports.figures.canvas._arrange", lambda *_: None)
    monkeypatch.setattr(
        Figure, "savefig", lambda figure, target, **_: saved.append(figure)
    )
    return saved


@pytest.fixture
def drawn(figures, tmp_path):
    """A function that draws a file, or the text of a CSV, and returns the figure; its
    attribute `remark` is what `draw` returned.
    """

    def run(source, **options):
        if isinstance(source, str):
            (tmp_path / "text.csv").write_text(source)
            source = tmp_path / "text.csv"
        remark = draw(source, tmp_path / "figure.png", **options)
        figures[-1].remark = remark
        return figures[-1]

    return run


@pytest.fixture
def table(rocking, tmp_path):
    """The CSV of a call as a file, and its rows by plain names."""

    def run(*call):
        text = rocking(*call, "--csv").stdout
        (tmp_path / "table.csv").write_text(text)
        return tmp_path / "table.csv", csv_rows(text)

    return run


@pytest.fixture
def swept(rocking, tmp_path):
    """A function that writes the spectra file of a call and returns its path."""

    def run(*call, stdin=None):
        path = tmp_path / f"{len(list(tmp_path.glob('*.h5')))}.h5"
        done = rocking(
            "spectrum", *call, "--verify-cells", "0", "-o", path.name, "-q", stdin=stdin
        )
        assert done.returncode == 0, done.stderr
        return path

    return run
