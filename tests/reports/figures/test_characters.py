"""Maps and slices in characters."""

import pytest

from rocking_cli import Outcome, SpectraFile
from rocking_cli.reports.figures.characters import text_map
from rocking_cli.reports.figures.colours import SIGNS
from rocking_cli.reports.units import Units, parse_units


def test_a_map_has_the_sign_of_each_cell(swept):
    with SpectraFile(swept("--eta", "0.9", "--grid", "A=1:8:16,Omega=1:8:40")) as file:
        outcome = file.block(0, slice(None))["outcome"]
        lines = text_map(file, None, None, Units())
    rows = [line.partition("|")[2] for line in lines if " |" in line]
    assert rows == [
        "".join(SIGNS[Outcome(int(o))] for o in row) for row in outcome.T[::-1]
    ]


@pytest.mark.parametrize("cut", [None, "Omega=5", "A=3"])
def test_it_fits_a_terminal_of_80_columns_and_24_rows_with_its_prompt(
    spectrum_file, cut
):
    with SpectraFile(spectrum_file) as file:
        lines = text_map(file, None, cut, Units())
    assert len(lines) <= 23
    assert max(map(len, lines)) <= 80


def test_slices_of_many_structures_fit_too(swept):
    many = swept(
        *(f"block:0.5x{height}" for height in range(2, 9)),
        "--grid",
        "a_g=0.1g:1g:5,f_g=1:2:3",
    )
    with SpectraFile(many) as file:
        lines = text_map(file, None, "f_g=1.5", parse_units("g,Hz"))
    assert len(lines) <= 23
    assert lines[0].startswith("theta_max/alpha at f_g = 1.5 Hz over a_g [g] 0.1 to 1")
