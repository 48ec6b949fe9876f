"""Units of what is shown: headings, values, and what is asked for."""

import csv
import json
import math

import pytest
from support.refusals import refuses

from rocking_cli import UsageError
from rocking_cli.documents.quantities import UNITS, parse_quantity
from rocking_cli.motions.records.units import WRITTEN_UNITS
from rocking_cli.reports.tables import lines
from rocking_cli.reports.units import (
    COLUMNS,
    Units,
    dimension_of,
    dimension_of_measure,
    parse_units,
    si_of,
)

RECORD = {
    "structure": "x",
    "omega_g": 2 * math.pi,
    "a_from": 9.81,
    "theta_linear": math.pi,
    "theta_dot": math.pi,
    "left_p": 2.0,
    "A": 3.0,
}


def shown(units, form="csv"):
    header, row = csv.reader(lines([RECORD], form, units=units))
    return dict(zip(header, row, strict=True))


def test_headings_tell_si_units_and_those_asked_for():
    assert list(shown(None)) == [
        "structure",
        "omega_g [rad/s]",
        "a_from [m/s2]",
        "theta_linear [rad]",
        "theta_dot [rad/s]",
        "left_p [rad/s]",
        "A",
    ]
    found = shown(parse_units("g,Hz,deg"))
    assert list(found) == [
        "structure",
        "f_g [Hz]",
        "a_from [g]",
        "theta_linear [deg]",
        "theta_dot [deg/s]",
        "left_p [rad/s]",
        "A",
    ]
    assert [float(x) for x in list(found.values())[1:]] == pytest.approx(
        [1, 1, 180, 180, 2, 3], rel=1e-14, abs=0
    )


def test_a_table_says_the_same_and_json_does_not_change():
    shown = list(lines([RECORD], "table", units=parse_units("g,deg"), width=200))
    assert "a_from [g]" in shown[0]
    assert "180" in shown[1].split()
    (line,) = lines([RECORD], "json", units=parse_units("g,deg"))
    assert json.loads(line) == RECORD


def test_the_header_of_no_rows_tells_units_too():
    assert list(lines([], "csv", ["structure", "a_from"], units=parse_units("g"))) == [
        "structure,a_from [g]"
    ]


@pytest.mark.parametrize("text", [None, "g,Hz,deg,cm,cm/s", "gal,mrad,mm", "cm/s2"])
def test_a_heading_is_read_back_as_what_was_meant(text):
    units = parse_units(text) if text else Units()
    for column in COLUMNS:
        heading, factor = units.heading(column)
        assert si_of(heading) == (column, factor)


def test_the_dimension_of_a_side_an_item_and_a_model_is_that_of_the_column():
    assert [
        dimension_of(x)
        for x in (
            "right_alpha",
            "hinges_3_angle",
            "interfaces_2_p",
            "theta_max_nonlinear",
            "theta_ratio",
            "name",
        )
    ] == ["angle", "angle", "frequency parameter", "angle", None, None]
    restraints = (
        "ties_2_height",
        "tendon_rupture",
        "ties_1_stiffness",
        "stands_1_moment",
        "restrained_1_stiffness",
        "tie_force",
        "ties_1_side",
    )
    assert [dimension_of(x) for x in restraints] == [
        "length",
        "force",
        "stiffness",
        "moment",
        None,
        None,
        None,
    ]  # two are ratios
    assert si_of("base_radius [cm]") == ("base_radius [cm]", 1.0)


def test_a_spectral_acceleration_of_any_period_has_its_unit():
    names = ("SA(0.5)", "AvgSA(0.5,1)", "SA(T1)", "sa", "Arias", "nPGA", "IM of a site")
    assert [dimension_of_measure(x) for x in names] == [
        *(4 * ["acceleration"]),
        "intensity",
        None,
        None,
    ]


def test_documents_records_and_tables_share_one_table_of_units():
    assert parse_quantity("32.174 ft/s2", "acceleration") == 32.174 * 0.3048
    assert set(WRITTEN_UNITS) - {"g/10"} <= set(UNITS["acceleration"])
    units = parse_units("ft,ft/s2,in/s")
    assert units.of("length") == ("ft", 0.3048)
    assert units.of("acceleration") == ("ft/s2", 0.3048)
    assert units.of("velocity") == ("in/s", 0.0254)


REFUSED = [
    ("furlong", "`units`: found 'furlong'; expected g, "),
    ("g,", "`units`: found ''"),
    ("g,gal", "found g and gal; expected one unit of acceleration"),
]
test_units_that_cannot_be_used = refuses(parse_units, UsageError, REFUSED)
