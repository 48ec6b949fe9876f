"""What headings of plain files say: read to the value, or refused with their words."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, wave

from rocking_cli import DocumentError, UsageError
from rocking_cli.motions.reading import load_records
from rocking_cli.motions.records import read_record, read_records
from rocking_cli.motions.records.record import is_vertical
from rocking_cli.motions.records.units import ACCELERATIONS

SAMPLES = wave(50, 1.5)
READ = as_printed(SAMPLES, "{:.5f}")
TIMES = [f"{0.01 * i:.2f}" for i in range(50)]


def table(heading, *factors, separator=",", comma=False, times=TIMES):
    """A heading above times and, for each factor, a column of samples."""
    cells = [
        [*([t] if times else []), *(f"{k * x:.5f}" for k in factors)]
        for t, x in zip(TIMES, SAMPLES, strict=True)
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
    "Tiempo (s),Aceleración (cm/s²)": "cm/s2",
    "tempo [s],accelerazione [m/s^2]": "m/s2",
    "Temps (s),Accélération (g)": "g",
    "zaman (sn),ivme (g)": "g",
    "时间(s),加速度(gal)": "gal",
    '"Time","Acc, g"': "g",
    "# Time {s},Acc {g}": "g",
    "% t [s], a [g]": "g",
    "// t <s>, a <gal>": "gal",
    "Time,Acc\n[s],[gal]": "gal",
    "Time,Acc\ns,g": "g",
    "Kobe, Japan\n\ntime,acc [g]": "g",
    "units: s, g\ntime,acc": "g",
    "Units of acceleration: gal\ntime,acc": "gal",
    "Einheit: m/s²\nt,a": "m/s2",
    "recorded in cm/s2\nt,a": "cm/s2",
    "NPTS = 50, DT = 0.01 s\nt,a [g]": "g",
    "sampling rate: 100 Hz\nt,a [g]": "g",
    "Station Height (m) 28\nVs30 = 760 m/s\nPGV = 12 cm/s\nt,a [g]": "g",
    "Spectrum-compatible accelerogram\nt,a [g]": "g",
    "Time (s),Accel (g)\n(corrected)": "g",
    "time,acceleration (in g)": "g",
    "t [s],ag [m s^{-2}]": "m/s2",
    "t (s),acc ($m/s^2$)": "m/s2",
    "t (s),ẍg (m/s²)": "m/s2",
    "t,ü [gal]": "gal",
    "Column 1: Time (s)\nColumn 2: Acceleration (gal)": "gal",
    "# columns: time (s), acceleration (mg)": "mg",
    "x-axis: t [s]\ny-axis: a [m/s2]": "m/s2",
    "Scaled to PGA 0.35 g, Arias intensity 1.2 m/s\nt,a [g]": "g",
    "Butterworth filter 0.1-25 Hz, order 4\nt,a [g]": "g",
}


# headings whose letters an encoding tells apart
FOREIGN = [two for two in TWO.items() if not two[0].isascii()]


@pytest.mark.parametrize(
    ("heading", "unit", "encoding"),
    [
        *((*two, "utf-8") for two in TWO.items()),
        *(
            (*two, encoding)
            for two in FOREIGN
            for encoding in ("utf-8-sig", "utf-16", "cp1252")
        ),
    ],
)
def test_two_columns_are_read_in_the_unit_of_their_heading(
    tmp_path, heading, unit, encoding
):
    if (
        encoding == "cp1252"
        and not heading.isascii()
        and ("时" in heading or "ẍ" in heading)
    ):
        return
    (tmp_path / "a.csv").write_bytes(table(heading, 1.0).encode(encoding))
    for given in ({}, {"unit": unit}, {"unit": unit, "dt": 0.01}):
        record = read_record(tmp_path / "a.csv", **given)
        assert (record.unit, record.dt, record.component) == (unit, 0.01, None)
        np.testing.assert_allclose(
            record.acceleration, ACCELERATIONS[unit] * READ, rtol=1e-14
        )
    for given, said in (
        ({"unit": "ft/s2"}, "`unit`: found ft/s2; the file says otherwise"),
        ({"dt": 0.02}, "`dt`: found 0.02 s; the file"),
    ):
        assert said in refusal(tmp_path / "a.csv", **given)


REFUSED = {
    "T [s],S_a [g]": "'T [s]', a period; expected a time: a spectrum is no record",
    "T,a": "'T', a period",
    "Period (s),PSA (m/s2)": "'Period (s)', a period",
    "Frequency [Hz],Fourier amplitude [g]": "'Frequency [Hz]', a frequency",
    "f,a [g]": "'f', a frequency",
    "t,Sa [g]": "'Sa [g]' (spectrum)",
    "t,Spectral acceleration [g]": "'Spectral acceleration [g]' (spectrum)",
    "t [s],v [cm/s]": "'v [cm/s]' (velocity)",
    "t [s],u [m]": "'u [m]' (length)",
    "Time [s],Force [kN]": "'Force [kN]' (force)",
    "t [s],channel 1 [counts]": "'channel 1 [counts]' (counts)",
    "Time [s],Arias intensity [m/s]": "'Arias intensity [m/s]' (Arias intensity)",
    "time,strain": "'strain' (stress)",
    "time,theta [rad]": "'theta [rad]' (rotation)",
    "tiempo,desplazamiento": "'desplazamiento' (displacement)",
    "tempo,velocità": "'velocità' (velocity)",
    "t,Angular acceleration [rad/s2]": "(rotation)",
    "t,max acc [g]": "'max acc [g]' (envelope)",
    "t,v": "'v', a direction or another quantity",
    "t,V": "'V', a direction or another quantity",
    "t,d": "'d' (displacement)",
    "t,foo": "'foo' in the heading 'foo', which is not understood",
    "t,foo [g]": "'foo' in the heading 'foo [g]'",
    "foo,a [g]": "'foo' in the heading 'foo'",
    "t,acc [furlong]": "'furlong' in the heading 'acc [furlong]'",
    "t,acc [m/s3]": "'m/s3' in the heading",
    "t,acc [g*1000]": "'g*1000' in the heading",
    "t,acc [V]": "'V' in the heading",
    "t [d],acc [g]": "'d' in the heading 't [d]'",
    "t [fortnight],acc [g]": "'fortnight' in the heading",
    "t,acc,vel": "3 headings in 't,acc,vel' above 2 columns",
    "Time,Acc\n(s),(cm/s)": "'cm/s' in the heading",
    "Velocity of Nowhere\nt,a": "'Velocity of Nowhere'; expected an acceleration",
    "Response spectrum\nt,a": "'Response spectrum'; expected an acceleration",
    "Quantity: Displacement\nt,a": "'Quantity: Displacement'; expected an acc",
    "Data type: Response spectrum\nt,a": "'Data type: Response spectrum'; expected",
    "Title: Response spectrum of Nowhere\nt,a": "'Title: Response spectrum of Nowhere'",
    "velocity, cm/s, dt=0.01 s\nt,a": "'velocity, cm/s, dt=0.01 s'; expected",
    "jerk g/s dt=0.01 s\nt,a": "'jerk g/s dt=0.01 s'; expected an acceleration",
    "floor response spectrum (g), dt=0.01 s\nt,a": "(g), dt=0.01 s'; expected",
    "Values in counts\nt,a": "'Values in counts'; expected an acceleration",
    "units: furlongs\nt,a": "the unit 'furlongs'; expected m/s2",
    "units: m, s, kN\nt,a": "the unit 'm, s, kn'",
    "Scale factor = 2\nt,a [g]": "'Scale factor = 2', a factor",
    "values x1000\nt,a [g]": "'values x1000', a factor",
    "a x 0.01\nt,a [g]": "'a x 0.01', a factor",
    "in tenths of g\nt,a": "'in tenths of g', a factor",
    "Acceleration [10^-2 m/s2] of Nowhere\nt,a": "the unit '10^-2 m/s2'",
    "frequency: 50 Hz\nt,a [g]": "where 'frequency: 50 Hz' says otherwise",
    "gain: 0.5\nt,a [g]": "'gain: 0.5', a factor",
    "units: gal\nt,a\nacc in g": "where 'units: gal' says otherwise",
    "units: gal\nt [s],a [g]": "'a [g]', where 'units: gal' says otherwise",
    "dt = 0.02\nt,a [g]": "times every 0.01 s, where 'dt = 0.02' says otherwise",
    "dt: see the report\nt,a [g]": "'dt: see the report'; expected a time step",
    "dt = 5 fortnights\nt,a [g]": "'dt = 5 fortnights'; expected a time step",
    "sampling rate: 50 Hz\nt,a [g]": "where 'sampling rate: 50 Hz' says otherwise",
    "sampling rate: 0.01\nt,a [g]": (
        "'sampling rate: 0.01', a sampling rate without a unit"
    ),
    "npts=51\nt,a [g]": "50 values, where 'npts=51' states 51",
    "Column 1: Period (s)\nColumn 2: Acceleration (g)": "'Period (s)', a period",
    "x: Frequency [Hz]\ny: Amplitude [g]": "'Frequency [Hz]', a frequency",
    "Target Spectrum\nt,a": "'Target Spectrum'; expected an acceleration",
    "t,Acceleration^2": "'Acceleration^2' in the heading",
    "t,integrated acceleration [g]": "'integrated acceleration' in the heading",
    "t,|a| [g]": "'|a|' in the heading",
    "t,log a [g]": "'log a' in the heading",
    "t,acc x 100 [g]": "'acc x 100 [g]' in the heading",
    "t,ẋ [g]": "'ẋ [g]' (velocity)",
    "#,a [g]": "numbers without times; give their step as `dt`",
    "no,acc [g]": "numbers without times; give their step as `dt`",
}


@pytest.mark.parametrize(("heading", "words"), REFUSED.items())
def test_what_is_no_acceleration_or_not_understood_is_refused_with_its_words(
    tmp_path, heading, words
):
    for given in ({}, {"unit": "g"}):
        found = refusal(tmp_path / "a.csv", table(heading, 1.0), **given)
        assert words in found
        assert found.startswith(f"{tmp_path / 'a.csv'}:")


ONE = {
    "a [g]\ndt=0.01": ("g", None),
    "Acceleration (g), dt = 0.01 s": ("g", None),
    "dt=10 ms\nacc: m/s2": ("m/s2", None),
    "# sampling rate: 100 Hz\n# units: gal": ("gal", None),
    "Time Step: 0.01\nUnits: cm/sec/sec": ("cm/s2", None),
    "DT (s) = 0.01\nin %g": ("%g", None),
    "Δt = 0.01 s\nBeschleunigung in m/s²": ("m/s2", None),
    "Sampling Freq(Hz),100Hz\nUnit,gal\nMax. Acc. (gal),12.5": ("gal", None),
    "Intervalo de muestreo: 0.01 s\nUnidades: gal": ("gal", None),
    "50 points equally spaced at 0.01 sec, in g\nComponent: Vertical": (
        "g",
        "Vertical",
    ),
    "freq 100 Hz\nin gal\nUP": ("gal", "UP"),
    "100 sps\nComp. HNZ\nunits = mg": ("mg", "HNZ"),
    "dt=0.01 s, g": ("g", None),
    "100 Hz, gal": ("gal", None),
    "Time step 0.01 s, acceleration in m/s2": ("m/s2", None),
    "50 points at 0.01 sec, acceleration in g": ("g", None),
    "NPTS 50 DT 0.01 s units gal": ("gal", None),
    "Δt = 0.01 s, a in m/s²": ("m/s2", None),
    "delta: 0.01\nnpts: 50\ncalib: 1.0\nunit: m/s**2": ("m/s2", None),
    "Zeitschritt: 0,01 s\nEinheit: m/s²": ("m/s2", None),
    "サンプリング周波数 100 Hz\n単位 gal": ("gal", None),
    "CH3 (UP)\ndt=0.01 s, g": ("g", "UP"),
    "Channel: acc_z\ndt=0.01 s, g": ("g", "acc_z"),
    "Component: CHAN 2: UP\ndt=0.01 s, g": ("g", "UP"),
    "Azimuth: UP\ndt=0.01 s, g": ("g", "UP"),
    "Azimuth: 0\nDip: -90\ndt=0.01 s, g": ("g", "vertical"),
    "Azimuth: 90\nDip: 0\ndt=0.01 s, g": ("g", None),
    "Comp: Ch. 3 (Vertical)\nstep 0.01 s, g": ("g", "Vertical"),
    "Component: Sensor 2 - 90 deg\ninterval 10 ms, g": ("g", "90 deg"),
    "Nowhere - UP\n0.01 sec step, g": ("g", "UP"),
    "Filter interval: 0.1-25 Hz\nProcessing step 3\nD.T. = 0.01 s, g": ("g", None),
}


@pytest.mark.parametrize(("heading", "said"), ONE.items())
def test_one_column_is_read_as_the_lines_above_it_say(tmp_path, heading, said):
    (tmp_path / "a.txt").write_text(table(heading, 1.0, times=None))
    record = read_record(tmp_path / "a.txt")
    assert (record.unit, record.component) == said
    assert record.dt == pytest.approx(0.01, rel=2e-15)
    np.testing.assert_allclose(
        record.acceleration, ACCELERATIONS[said[0]] * READ, rtol=1e-14
    )
    for given in ({"unit": "ft/s2"}, {"dt": 0.02}, {"unit": said[0], "dt": 0.005}):
        assert "the file says otherwise" in refusal(tmp_path / "a.txt", **given)


@pytest.mark.parametrize("line", ["T = 0.01 s", "t: 10 ms", "Period (s) 0.01"])
def test_a_time_that_may_be_the_step_or_a_period_is_asked_for(tmp_path, line):
    path = tmp_path / "a.txt"
    found = refusal(path, table(line, 1.0, times=None), unit="g")
    assert f"1: found {line!r}, which may be the step or a period" in found
    assert "give the step as `dt`" in found
    assert read_record(path, unit="g", dt=0.01).dt == 0.01


@pytest.mark.parametrize("line", ["dt = 0.5/100 s", "fs = 1/0.01 Hz", "dt = .01 - .02"])
def test_a_step_that_goes_on_behind_its_number_is_refused(tmp_path, line):
    found = refusal(tmp_path / "a.txt", table(line, 1.0, times=None), unit="g")
    assert f"found {line!r}; expected one number" in found


@pytest.mark.parametrize(
    "heading",
    [
        "v [cm/s]",
        "[counts]",
        "Velocity",
        "displ (cm)",
        "Force [kN]",
        "a [furlong]",
        "T [s]",
        "Sa [g]",
        "m/s",
        "u",
        "spectrum",
        "t,a",
        "acc m",
        "Drift",
        "ε",
        "скорость",
        "SPL (dB)",
    ],
)
def test_one_column_of_something_else_is_refused(tmp_path, heading):
    found = refusal(
        tmp_path / "a.txt", table(heading, 1.0, times=None), unit="g", dt=0.01
    )
    assert (
        found.startswith(f"{tmp_path / 'a.txt'}:1: found {heading!r}")
        or f"the heading {heading!r}" in found
    )


SEVERAL = {
    "time [s],NS [gal],EW [gal],UD [gal]": ("NS", "EW", "UD"),
    "Time,N-S,E-W,U-D\ns,gal,gal,gal": ("N-S", "E-W", "U-D"),
    "t,acc_x [gal],acc_y [gal],acc_z [gal]": ("x", "y", "z"),
    "t,Acc-NS [gal],Acc-EW [gal],Acc-UD [gal]": ("NS", "EW", "UD"),
    "t,AccX [gal],AccY [gal],AccZ [gal]": ("X", "Y", "Z"),
    "t,Acc N (gal),Acc E (gal),Acc Z (gal)": ("N", "E", "Z"),
    "units: gal\nt,HNN,HNE,HNZ": ("HNN", "HNE", "HNZ"),
    "units: gal\nt,L,T,V": ("L", "T", "V"),
    "t,N-component [gal],E-component [gal],Z-component [gal]": ("N", "E", "Z"),
    "units: gal\nt,H1,H2,V": ("H1", "H2", "V"),
    "units: gal\nt,360,090,Up": ("360", "090", "Up"),
    "SAMPLING RATE= 100Hz\nUNIT  = gal(cm/s/s)\nTime,NS,EW,UD": ("NS", "EW", "UD"),
}


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize(("heading", "names"), SEVERAL.items())
def test_components_in_columns(tmp_path, heading, names, separator):
    path = tmp_path / "a.csv"
    path.write_text(
        table(
            heading.replace(",", separator),
            1.0,
            0.5,
            -0.25,
            separator=separator,
            comma=separator != ",",
        )
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


def test_columns_of_other_quantities_are_left_out_and_named(tmp_path):
    (tmp_path / "a.csv").write_text(
        table("t [s],acc [g],vel [cm/s],disp [cm]", 1.0, 2.0, 3.0)
    )
    (record,) = read_records(tmp_path / "a.csv")
    assert record.remarks == ("columns left out: vel [cm/s], disp [cm]",)
    np.testing.assert_allclose(
        record.acceleration, ACCELERATIONS["g"] * READ, rtol=1e-14
    )
    assert "'vel [cm/s]' (velocity) in column 3; expected an acceleration" in refusal(
        tmp_path / "a.csv", column="3"
    )


def test_a_column_is_named_where_no_heading_says_which(tmp_path):
    path, g = tmp_path / "a.csv", ACCELERATIONS["g"]
    for heading, words in (
        (
            "",
            (
                "4 columns without headings, the first of times; give the one of the"
                " accelerations as `column`"
            ),
        ),
        ("t,ch1,ch2,ch3", "'ch1', 'ch2', 'ch3' state no direction"),
        ("t,RSN1,RSN2,RSN3", "'rsn1' in the heading 'RSN1', which is not understood"),
    ):
        text = table(heading, 1.0, 2.0, 3.0).lstrip("\n")
        assert words in refusal(path, text, unit="g")
        record = read_record(path, unit="g", column="3")
        np.testing.assert_allclose(
            record.acceleration, g * as_printed(2.0 * SAMPLES, "{:.5f}"), rtol=1e-14
        )
        assert (
            record.component
            == (
                {"": "column 3"} | {"t,ch1,ch2,ch3": "ch2", "t,RSN1,RSN2,RSN3": "RSN2"}
            )[heading]
        )
        for column, said in (
            ("1", "which holds the times"),
            ("5", "the file holds 4 columns"),
        ):
            with pytest.raises(UsageError, match=said):
                read_record(path, unit="g", column=column)


def test_a_file_named_as_velocities_is_read_only_where_it_says_acceleration(tmp_path):
    for name in (
        "S.vel",
        "S.DIS",
        "S_E.vt2",
        "S_E_disp.txt",
        "S.psa",
        "velocity_NS.txt",
    ):
        (tmp_path / name).write_text(table("", 1.0, separator=" ").lstrip("\n"))
        with pytest.raises(
            DocumentError,
            match=(
                rf"{name}:1: a file that is named as (velocities|displacements|a"
                r" spectrum)"
            ),
        ):
            read_record(tmp_path / name, unit="g")
        (tmp_path / name).write_text(table("t,acc [g]", 1.0))
        assert read_record(tmp_path / name).unit == "g"


def test_a_list_of_factors_in_a_directory_is_no_motion(tmp_path):
    (tmp_path / "factors.txt").write_text("1.2\n-0.8\n0.5\n")
    (tmp_path / "motion.txt").write_text(table("acc [g]", 1.0, times=None))
    told: list[str] = []
    found = load_records([tmp_path], unit="g", dt=0.01, tell=told.append)
    assert [r.label for r in found] == ["motion"]
    assert told == [
        f"{tmp_path / 'factors.txt'}:1: 3 numbers, too few for a motion; they are taken"
        " where the file itself is named; left out"
    ]
    assert read_record(tmp_path / "factors.txt", unit="g", dt=0.01).npts == 3
