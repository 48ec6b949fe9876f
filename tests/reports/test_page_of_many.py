"""A page on many structures: a histogram, the least capacities, a table by label, and
every row in a CSV file beside it.
"""

import csv
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from rocking_cli import check, parse_grid, sine
from rocking_cli.reports import page_of_many
from rocking_cli.reports.page_of_many import histogram

TABLE = "kind,name,width,height,outcome\n" + "".join(
    f"block,B{i},{0.3 + 0.06 * (5 * i % 7):.2f},2,hall {i % 2}\n" for i in range(7)
)
CALL = ("report", "t.csv", "--a-g", "0.35g", "--f-g", "1.5", "-o", "t.html")


@pytest.fixture
def table(tmp_path, monkeypatch):
    monkeypatch.setattr(page_of_many, "image", lambda plan: "data:x")
    monkeypatch.setattr(page_of_many, "WORST", 5)
    monkeypatch.setattr("rocking_cli.commands.report.MOST", 6)
    monkeypatch.setattr("rocking_cli.commands.report.LONG_TABLE", 0)  # no forces
    path = tmp_path / "t.csv"
    path.write_text(TABLE)
    return path


def test_the_page_holds_the_least_capacities_and_the_file_beside_it_all(
    rocking, table, tmp_path
):
    with open(table, "a") as file:
        file.write("block,B99,-1,2,hall 0\n")
    done = rocking(*CALL, "--by", "outcome", "--skip-faulty")
    assert done.returncode == 4
    assert "left out: t.csv:9:3: width: found -1" in done.stderr
    assert table.read_text().startswith(TABLE)
    rows = list(csv.DictReader((tmp_path / "t-rows.csv").read_text().splitlines()))
    assert [row["structure"] for row in rows] == [f"B{i}" for i in range(7)]
    assert rows[1]["label_outcome"] == "hall 1"

    page = (tmp_path / "t.html").read_text(encoding="utf-8")
    least = sorted(rows, key=lambda row: float(row["capacity_demand"]))
    shown = page.partition('id="verdicts"')[2].partition("</table>")[0]
    assert [
        cell.partition("<")[0] for cell in shown.split('data-head="structure">')[1:]
    ] == [row["structure"] for row in least[:5]]
    by = page.partition('id="by-label"')[2].partition("</table>")[0]
    for hall, count in (("hall 0", 4), ("hall 1", 3)):
        own = [row for row in least if row["label_outcome"] == hall]
        fallen = sum(row["outcome"].startswith("overturned") for row in own)
        cells = by.partition(f">{hall}<")[2].partition("</tr>")[0]
        assert f">{count}<" in cells
        assert f'"fall">{fallen}<' in cells
        below = sum(float(row["capacity_demand"]) < 1.0 for row in own)
        assert 0 < below < count
        assert f'"capacity below the demand">{below}<' in cells
        assert f'"of">{own[0]["structure"]}<' in cells


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--by", "outcom"), "--by: found 'outcom'; expected a label"),
        (("--summary",), "--summary goes with up to 6 structures"),
    ],
)
def test_what_a_page_of_many_lacks_is_refused(rocking, table, more, words):
    done = rocking(*CALL, *more)
    assert done.returncode == 2
    assert words in done.stderr


def test_a_row_file_that_exists_is_not_replaced(rocking, table, tmp_path):
    (tmp_path / "t-rows.csv").write_text("mine")
    done = rocking(*CALL)
    assert done.returncode == 2
    assert "t-rows.csv: exists" in done.stderr
    assert (tmp_path / "t-rows.csv").read_text() == "mine"


def test_a_bin_of_the_histogram_ends_where_the_capacity_is_the_demand():
    one = check("block:0.5x2", sine(), parse_grid("a_g=0.35g,f_g=1.5"), a_max=None)
    capacities = np.array([0.5, 0.9, 0.999, 1.001, 1.1, 3.0])
    found = [
        replace(one, first_overturning_a=float(x * one.demand_a)) for x in capacities
    ]
    figure = Figure()
    histogram(figure, [*found, one])
    (axes,) = figure.axes
    bars = [
        (bar.get_x(), bar.get_height(), bar.get_facecolor()) for bar in axes.patches
    ]
    below = sum(height for x, height, _ in bars if x < 1.0)
    assert (below, sum(height for _, height, _ in bars)) == (3, 6)
    colours = [
        {colour for x, _, colour in bars if (x < 0.9999) == side}
        for side in (True, False)
    ]
    assert len(colours[0]) == len(colours[1]) == 1
    assert colours[0] != colours[1]


def test_a_body_that_slides_is_not_one_that_nothing_overturns(rocking, table, tmp_path):
    """Of seven that slide the page says what `check` says: no capacity is known."""
    columns, *rows = TABLE.splitlines()
    slide = [f"{columns},friction", *(f"{row},0.1" for row in rows)]
    table.write_text("\n".join(slide))
    done = rocking(*CALL)
    assert "7 slide and never rock" in done.stderr
    assert "Nothing overturns" not in (tmp_path / "t.html").read_text()
