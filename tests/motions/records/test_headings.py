"""What headings of plain columns say: a name and a unit, in one grammar."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.motions.records import read_record, read_records
from rocking_cli.motions.records.headings import heading_of
from rocking_cli.motions.records.record import is_horizontal, is_vertical
from rocking_cli.motions.records.units import ACCELERATIONS, time_unit, unit_of

SAMPLES = wave(50, 1.5)
READ = as_printed(SAMPLES, "{:.5f}")
SPELLINGS = {
    "m/s2": "m/s²|m/s^2|M/S2|m s-2|m·s⁻²|m.s-2|m s^-2|m s^{-2}|ms-2|ms2|m/s/s|m/(s^2)"
    "|m/(s*s)|m/s**2|m/sec²",
    "cm/s2": "cm/s²|CM/SEC/SEC|cm/sec2|CMS/SEC/SEC|cm/sec^2|cm s-2|centimeters per"
    " second squared",
    "mm/s2": "mm/s2|mm/s/s",
    "gal": "gal|Gal|GALS|gal (cm/s/s)|gal(cm/s2)|GAL.",
    "g": "g|G|g's|units of g|gravity",
    "mg": "mg|MG|milli-g",
    "%g": "%g|% g|percent g|% of g",
    "ft/s2": "ft/s2|ft/sec/sec|feet per second squared",
    "in/s2": "in/s2|in/sec^2",
}
NO_UNIT = "cm/s|m s-1|m|kN|counts|m/s3|rad/s2|furlong/s2|%|s|Hz|gal (m/s2)|0.1 g"
TIMES = {
    1.0: "s|sec|SEC.|seconds|seg|Sek|sn|秒",
    1e-3: "ms|MS|msec|milliseconds|1e-3 s|10^-3 s|0.001 s",
    1e-6: "us|µs|μs|usec",
    60.0: "min",
    3600.0: "h|hours",
}


def test_units_in_the_spellings_of_files():
    for unit, words in SPELLINGS.items():
        assert {unit_of(word) for word in words.split("|")} == {unit}, unit
    assert {unit_of(word) for word in NO_UNIT.split("|")} == {None}
    for seconds, words in TIMES.items():
        assert [time_unit(x) for x in words.split("|")] == pytest.approx(
            [seconds] * (words.count("|") + 1), rel=2e-15
        )
    assert {time_unit(x) for x in ("d", "fortnight", "m", "")} == {None}


def table(heading, *factors, separator=",", comma=False):
    """A heading above times and, for each factor, a column of samples."""
    cells = [
        [f"{0.01 * i:.2f}", *(f"{k * x:.5f}" for k in factors)]
        for i, x in enumerate(SAMPLES)
    ]
    text = "".join(separator.join(row) + "\n" for row in cells)
    return heading + "\n" + (text.replace(".", ",") if comma else text)


TWO = {
    "Time (s), Acceleration (g)": "g",
    "t [s];a [m/s2]": "m/s2",
    "time [s],acc [m/s²]": "m/s2",
    "time [s],acc [m s-2]": "m/s2",
    "Time(s),Accel. (in/s2)": "in/s2",
    "time,acc [%g]": "%g",
    "time,Acc in mg": "mg",
    "time_s,acc_g": "g",
    "time [s],acc_ms2": "m/s2",
    "t / s,a / (m/s²)": "m/s2",
    "Zeit [s],Beschleunigung [m/s²]": "m/s2",
    "zaman (sn),ivme (g)": "g",
    "时间(s),加速度(gal)": "gal",
    '"Time","Acc, g"': "g",
    "# Time {s},Acc {g}": "g",
    "// t <s>, a <gal>": "gal",
    "t (s),ẍg (m/s²)": "m/s2",
    "s,g": "g",
    "time (s)  acc (g)": "g",
    "t a cm/s2": None,
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize(("heading", "unit"), TWO.items())
def test_two_columns_are_read_in_the_unit_of_their_heading(
    tmp_path, heading, unit, encoding
):
    path = tmp_path / "a.csv"
    path.write_bytes(table(heading, 1.0).encode(encoding, "replace"))
    if encoding == "cp1252" and ("时" in heading or "ẍ" in heading):
        return
    if unit is None:
        assert "above 2 columns; expected a heading for each" in refusal(path)
        return
    for given in ({}, {"unit": unit}, {"unit": unit, "dt": 0.01}):
        record = read_record(path, **given)
        assert (record.unit, record.dt, record.component) == (unit, 0.01, None)
        np.testing.assert_allclose(
            record.acceleration, ACCELERATIONS[unit] * READ, rtol=1e-14
        )
    for given, said in (
        ({"unit": "ft/s2"}, "`unit`: found ft/s2; the file says otherwise"),
        ({"dt": 0.02}, "`dt`: found 0.02 s; the file says otherwise: 0.01 s"),
    ):
        assert said in refusal(path, **given)


# what names another quantity is refused, whatever the options say
OTHERS = """T [s],S_a [g]|T,a|Period (s),PSA (m/s2)|Frequency [Hz],Fourier amplitude [g]
f,a [g]|t,Sa [g]|t,Spectral acceleration [g]|t [s],v [cm/s]|t [s],u [m]|t,S_a [g]
Time [s],Force [kN]|t [s],channel 1 [counts]|Time [s],Arias intensity [m/s]|t,D|t,u
time,strain|time,theta [rad]|tiempo,desplazamiento|tempo,velocità|t,|a| [g]|t,ẋ [g]
t,Angular acceleration [rad/s2]|t,max acc [g]|t,v|t,V|t,d|t,acc [furlong]|t,acc [V]
t,acc [m/s3]|t,acc [g*1000]|t [fortnight],acc [g]|t,Acceleration^2|t,a² [g]
t,ln acc [g]|t,integral of acc [g]|t,log10 a [g]|t,acc x 100 [g]|t,relative acc [g]
t,standard deviation [g]|t,-Acceleration [g]|t,Absolute acceleration (m/s^2)
t,acc (corrected)|t,acc [0.1 g]|t,scaled acc [g]|t,velocity_g|t,acc cm/s"""


@pytest.mark.parametrize(
    "heading", OTHERS.replace("t,|a| [g]", "t,‖a‖ [g]").replace("\n", "|").split("|")
)
def test_another_quantity_is_refused_whatever_the_options_say(tmp_path, heading):
    text = table(heading.replace("‖", "|"), 1.0)
    for given in ({}, {"unit": "g"}, {"unit": "g", "column": "2"}):
        said = refusal(tmp_path / "a.csv", text, **given)
        assert said.startswith(f"{tmp_path / 'a.csv'}:1: found ")
        assert "expected a" in said


@pytest.mark.parametrize(
    "heading",
    ["v [cm/s]", "[counts]", "velocity", "T [s]", "Sa [g]", "v", "|a|", "foo"],
)
def test_a_heading_above_one_column_or_values_in_a_row(tmp_path, heading):
    column = "".join(f"{x:.5f}\n" for x in SAMPLES)
    for text, more in (
        (column, {}),
        (column, {"column": "all"}),
        (rows(SAMPLES, 7, "{:9.5f}"), {"column": "all"}),
    ):
        said = refusal(tmp_path / "a", f"{heading}\n{text}", **more, unit="g", dt=0.01)
        assert said.startswith(f"{tmp_path / 'a'}:1: found ")


@pytest.mark.parametrize(
    "heading",
    [
        "t,foo [g]",
        "t,v (NS)",
        "t,t (UD) [g]",
        "t,HN1 NS [g]",
        "t,foo",
        "foo,a [g]",
        "t,ch1",
        "t,Acc Kobe [g]",
    ],
)
def test_a_heading_that_is_not_understood_is_read_where_the_user_names_the_column(
    tmp_path, heading
):
    path = tmp_path / "a.csv"
    said = refusal(path, table(heading, 1.0), unit="g")
    assert "a.csv:1: found the heading" in said
    assert "the number of a column of accelerations as `column`, or `skip` 1" in said
    for given in ({"column": "2"}, {"skip": 1}):
        np.testing.assert_allclose(
            read_record(path, unit="g", **given).acceleration, 9.81 * READ, rtol=1e-14
        )


SEVERAL = {
    "time [s],NS [gal],EW [gal],UD [gal]": ("NS", "EW", "UD"),
    "t,acc_x [gal],acc_y [gal],acc_z [gal]": ("x", "y", "z"),
    "t,ax [gal],ay [gal],az [gal]": ("x", "y", "z"),
    "t,Acc-NS [gal],Acc-EW [gal],Acc-UD [gal]": ("NS", "EW", "UD"),
    "t,AccX [gal],AccY [gal],AccZ [gal]": ("X", "Y", "Z"),
    "t,Acc N (gal),Acc E (gal),Acc Z (gal)": ("N", "E", "Z"),
    "t,Acc (NS) [gal],Acc (EW) [gal],Acc (UD) [gal]": ("NS", "EW", "UD"),
    "t,N [gal],E [gal],D [gal]": ("N", "E", "D"),
    "t,HNN [gal],HNE [gal],HNZ [gal]": ("HNN", "HNE", "HNZ"),
    "t,L [gal],T [gal],V [gal]": ("L", "T", "V"),
    "t,N-component [gal],E comp. [gal],Component Z [gal]": ("N", "E", "Z"),
    "t,360 [gal],090 [gal],Up [gal]": ("360", "090", "Up"),
}


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize(("heading", "names"), SEVERAL.items())
def test_components_in_columns(tmp_path, heading, names, separator):
    path = tmp_path / "a.csv"
    heading = heading.replace(",", separator)
    path.write_text(
        table(heading, 1.0, 0.5, -0.25, separator=separator, comma=separator != ",")
    )
    records = read_records(path)
    assert tuple(r.component for r in records) == names
    assert [is_vertical(r) for r in records] == [False, False, True]
    for i, (record, factor) in enumerate(
        zip(records, (1.0, 0.5, -0.25), strict=True), 2
    ):
        wanted = 0.01 * as_printed(factor * SAMPLES, "{:.5f}")
        np.testing.assert_allclose(record.acceleration, wanted, rtol=1e-14)
        np.testing.assert_array_equal(
            read_record(path, column=str(i)).acceleration, record.acceleration
        )


@pytest.mark.parametrize("heading", ["t,L,T,V", "t,N,E,U", "t,N,E,D", "t,H1,H2,v"])
def test_a_letter_is_a_direction_beside_other_directions(tmp_path, heading):
    (tmp_path / "a.csv").write_text(table(heading, 1.0, 0.5, -0.25))
    records = read_records(tmp_path / "a.csv", unit="gal")
    assert [r.component for r in records] == heading.split(",")[1:]
    assert [is_vertical(r) for r in records] == [False, False, True]


def test_a_vertical_column_that_the_user_names_stays_vertical(tmp_path):
    (tmp_path / "a.csv").write_text(table("t,Vertical sensor 5 [g],ch2 [g]", 1.0, 0.5))
    vertical = read_record(tmp_path / "a.csv", column="2")
    assert (vertical.component, is_vertical(vertical)) == (
        "Vertical sensor 5 [g]",
        True,
    )
    assert read_record(tmp_path / "a.csv", column="3").component is None


def test_codes_without_a_direction_are_told_and_never_horizontal(tmp_path):
    (tmp_path / "a.csv").write_text(
        table("t [s],HN1 [g],HN2 [g],HN3 [g]", 1.0, 0.5, -0.25)
    )
    records = read_records(tmp_path / "a.csv")
    assert [is_horizontal(r) for r in records] == [True, True, False]
    assert not any(map(is_vertical, records))
    assert "component HN3: no direction is known" in records[2].remarks[0]


def test_columns_of_other_quantities_are_left_out_and_named(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(table("t [s],acc [g],vel [cm/s],disp [cm]", 1.0, 2.0, 3.0))
    (record,) = read_records(path)
    assert record.remarks == ("columns left out: vel [cm/s], disp [cm]",)
    np.testing.assert_allclose(record.acceleration, 9.81 * READ, rtol=1e-14)
    assert "in column 3; expected an acceleration" in refusal(path, column="3")
    said = refusal(path, table("t,acc [g],a NS [g]", 1.0, 2.0))
    assert "the headings 'acc [g]' state no direction" in said


def test_a_heading_is_as_long_as_files_have_them():
    assert heading_of(f"acc{' ' * 190}[g]").unit == "g"
    assert heading_of("acc " + "N" * 200).role == "unknown"
