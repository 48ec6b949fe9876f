"""PEER AT2 in the spellings of real files, and SMC (USGS): numbers of ten characters
without a blank between.
"""

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave
from support.refusals import refuses

from rocking_cli import DocumentError
from rocking_cli.documents.quantities import DEFAULT_GRAVITY
from rocking_cli.motions.records import read_record, read_records
from rocking_cli.motions.records.record import is_vertical

FORM = "{:15.7E}"
TITLE = (
    "PEER NGA STRONG MOTION DATABASE RECORD\nNowhere, 1/2/1999, Anystation,"
    " 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
)
SAMPLES = wave(1003, 0.31)
READ = DEFAULT_GRAVITY * as_printed(SAMPLES, FORM)


def body(samples=SAMPLES):
    return rows(samples, 5, FORM)


@pytest.mark.parametrize(
    "header",
    [
        TITLE + "NPTS=   1003, DT=   .0050 SEC,\n",
        TITLE + "NPTS= 1003, DT=   0.005 SEC\n",
        TITLE.lower() + "npts= 1003, dt=  .00500\n",
        TITLE + "NPTS=1003 DT=.5E-02 SEC\n",
        TITLE + "NPTS=1003 DT=0.5D-02 SEC\n",
        TITLE + "\n\n\n NPTS=   1003, DT= .00500 SEC\n",
        (
            "Title\nEvent\nStation\nSite\nFilter\nAcceleration in g\n    1003    0.0050"
            "    NPTS, DT\n"
        ),
    ],
)
@pytest.mark.parametrize(
    ("end", "trailer"),
    [
        ("\n", "*** End Data ***\n"),
        ("\r\n", ""),
        ("\r\r\n", ""),
        ("\r\n", "\x1a" + 60 * " "),
    ],
)
def test_every_spelling_gives_the_same_samples(tmp_path, header, end, trailer):
    path = tmp_path / "motion.dat"
    path.write_bytes((header + body() + trailer).replace("\n", end).encode())
    record = read_record(path)
    assert (
        record.format,
        record.name,
        record.component,
        record.header_pga,
        record.remarks,
    ) == ("PEER AT2", "motion", None, None, ())
    assert record.dt == 0.005
    np.testing.assert_array_equal(record.acceleration, READ)


def test_values_beyond_those_declared_are_left_out_and_said(tmp_path):
    path = tmp_path / "a.AT2"
    path.write_text(TITLE + "NPTS= 1000, DT= .005 SEC\n" + body())
    record = read_record(path)
    np.testing.assert_array_equal(record.acceleration, READ[:1000])
    assert "more values than the 1000 declared" in " ".join(record.remarks)


@pytest.mark.parametrize(
    ("line", "factor"),
    [
        ("ACCELERATION TIME SERIES IN UNITS OF CM/S/S", 1e-2),
        (
            (
                "ACCELERATION TIME HISTORY IN UNITS OF CM/SEC**2. FILTER POINTS: HP=0.2"
                " Hz LP=40.0 Hz"
            ),
            1e-2,
        ),
        (
            (
                "ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.2 Hz"
                " LP=40.0 Hz"
            ),
            DEFAULT_GRAVITY,
        ),
        ("  Acceleration in cm/s^2", 1e-2),
        ("Acceleration (cm/sec/sec)", 1e-2),
        ("Acc. [m/s2]", 1.0),
        ("ACCELERATION M/S2", 1.0),
        ("ACCELERATION-CM/S2", 1e-2),
        ("ACC. UNITS CM/S2", 1e-2),
        ("ACELERACION EN CM/S2", 1e-2),
        ("ACCELERATION TIME HISTORY (UNITS: CM/S2)", 1e-2),
    ],
)
def test_the_unit_wherever_the_header_states_it(tmp_path, line, factor):
    path = tmp_path / "a.AT2"
    path.write_text(f"Nowhere\n{line}\nNPTS=  1003, dt=  .00500\n" + body())
    np.testing.assert_allclose(
        read_record(path).acceleration, READ / DEFAULT_GRAVITY * factor, rtol=1e-15
    )


def timed(step):
    return np.column_stack([step * np.arange(1003), SAMPLES]).ravel()


@pytest.mark.parametrize(
    ("text", "unit", "factor", "form"),
    [
        (
            TITLE.replace("IN UNITS OF G", "") + "NPTS= 1003, DT= 5 MSEC\n" + body(),
            "g",
            DEFAULT_GRAVITY,
            FORM,
        ),
        (TITLE + "NPTS= 1003, DT= 5 ms\n" + body(), "g", DEFAULT_GRAVITY, FORM),
        (TITLE + "NPTS= 1003, DT= .005 S\n" + body(), "g", DEFAULT_GRAVITY, FORM),
        (
            TITLE + "NPTS= 1003, DT= .005 SEC\n" + rows(timed(0.005), 2, "{:12.6f} "),
            "g",
            DEFAULT_GRAVITY,
            "{:12.6f}",
        ),
        (
            "Nowhere\nACCELERATION, M/S2\nNPTS= 1003, DT= .005\n" + body(),
            "m/s2",
            1.0,
            FORM,
        ),
        (
            "Nowhere\nACCELERATION: M/S2\nNPTS= 1003, DT= .005\n" + body(),
            "m/s2",
            1.0,
            FORM,
        ),
        (
            "Nowhere\nAcceleration in %g\nNPTS= 1003, DT= .005\n" + body(),
            "%g",
            DEFAULT_GRAVITY / 100,
            FORM,
        ),
        (
            "Nowhere\nAcceleration in mg\nNPTS= 1003, DT= .005\n" + body(),
            "mg",
            DEFAULT_GRAVITY / 1000,
            FORM,
        ),
        (
            "Nowhere\nACCELERATION (FT/SEC2)\nNPTS= 1003, DT= .005\n" + body(),
            "ft/s2",
            0.3048,
            FORM,
        ),
    ],
)
def test_step_unit_and_columns_as_the_two_lines_state_them(
    tmp_path, text, unit, factor, form
):
    (tmp_path / "a.AT2").write_text(text)
    record = read_record(tmp_path / "a.AT2")
    assert (record.dt, record.unit) == (0.005, unit)
    np.testing.assert_allclose(
        record.acceleration, factor * as_printed(SAMPLES, form), rtol=1e-14
    )


def test_a_file_that_states_no_quantity_is_read_in_the_unit_of_the_user(tmp_path):
    (tmp_path / "a.AT2").write_text("NPTS= 1003, DT= .005 SEC\n" + body())
    assert read_record(tmp_path / "a.AT2", unit="gal").unit == "gal"
    with pytest.raises(DocumentError, match="ACCELERATION IN UNITS OF G, or `unit`"):
        read_record(tmp_path / "a.AT2")


@pytest.mark.parametrize(
    "name",
    [
        "UP",
        "+V",
        "-V",
        "+Z",
        "HNZ",
        "BHZ00",
        "VRT",
        "UP COMPONENT",
        "DOWN",
        "Vertical",
        "U-D",
        "DWN",
        "V (corrected)",
    ],
)
def test_a_vertical_component_at_the_end_of_a_line_is_named(tmp_path, name):
    (tmp_path / "a.AT2").write_text(
        TITLE.replace(", 090", f", {name}") + "NPTS= 1003, DT= .005 SEC\n" + body()
    )
    (record,) = read_records(tmp_path / "a.AT2")
    assert record.component == name.split()[0]
    assert is_vertical(record)


@pytest.mark.parametrize(
    "words", ["VERTICAL ARRAY", "UP HILL", "090", "HNE", "N", "UPLAND", "D"]
)
def test_a_place_is_no_direction(tmp_path, words):
    (tmp_path / "a.AT2").write_text(
        TITLE.replace(", 090", f", {words}") + "NPTS= 1003, DT= .005 SEC\n" + body()
    )
    assert read_record(tmp_path / "a.AT2").component is None


def test_an_exponent_without_its_letter_is_one_number(tmp_path):
    text = (
        body()
        .replace(FORM.format(SAMPLES[3]), "  0.1234567-102", 1)
        .replace(FORM.format(SAMPLES[4]), "  0.1234567+000", 1)
    )
    (tmp_path / "a.AT2").write_text(TITLE + "NPTS= 1003, DT= .005 SEC\n" + text)
    found = read_record(tmp_path / "a.AT2").acceleration[3:5] / DEFAULT_GRAVITY
    np.testing.assert_allclose(found, [0.1234567e-102, 0.1234567], rtol=1e-15)


def broken(text):
    lines = body().splitlines()
    lines[7] = text
    return TITLE + "NPTS= 1003, DT= .005 SEC\n" + "\n".join(lines) + "\n"


REFUSED = [
    (
        TITLE + "NPTS= 1004, DT= .005 SEC\n" + body(),
        "a.AT2:205: the file ends after 1003 of 1004 values",
    ),
    (TITLE + "NPTS= 1003, DT= .005 SEC\n" + body()[:4000], "the file ends after"),
    (
        TITLE + "NPTS= 1003, DT= .005 SEC\n",
        "1003 values are declared, more than a file of",
    ),
    (TITLE + "NPTS= 1003, DT= 0.000 SEC\n" + body(), "a.AT2:4: a time step of 0.000"),
    (
        TITLE.replace("ACCELERATION", "VELOCITY")
        + "NPTS= 1003, DT= .005 SEC\n"
        + body(),
        "a.AT2:3: found 'VELOCITY",
    ),
    (
        TITLE.replace("UNITS OF G", "UNITS OF CM/S")
        + "NPTS= 1003, DT= .005 SEC\n"
        + body(),
        "a.AT2:3: found 'ACCELERATION TIME SERIES IN UNITS OF CM/S'",
    ),
    *(
        (
            f"Nowhere\n{line}\nNPTS= 1003, DT= .005 SEC\n" + body(),
            f"a.AT2:2: found {words}",
        )
        for line, words in {
            "VELOCITY (CM/S)": "'VELOCITY (CM/S)'",
            "VELOCITY HISTORY": "'VELOCITY HISTORY'",
            "DISPLACEMENT (CM)": "'DISPLACEMENT (CM)'",
            "Displ. in cm": "'Displ. in cm'",
            "RESPONSE SPECTRUM": "'RESPONSE SPECTRUM'",
            "SPECTRAL ACCELERATION (G)": "'SPECTRAL ACCELERATION (G)'",
            "PSEUDO-ACCELERATION (G)": "'PSEUDO-ACCELERATION (G)'",
            "FOURIER AMPLITUDE (G S)": "'FOURIER AMPLITUDE (G S)'",
            "ARIAS INTENSITY (M/S)": "'ARIAS INTENSITY (M/S)'",
            "COUNTS": "'COUNTS'",
            "FORCE (KN)": "'FORCE (KN)'",
            "JERK, G/S": "'JERK, G/S'",
            "ACCELERATION CM/S": "'ACCELERATION CM/S'",
            "ACELERACION EN CM/S": "'ACELERACION EN CM/S'",
            "INTEGRATED ACCELERATION": "'INTEGRATED ACCELERATION'",
            "ACCELERATION SQUARED": "'ACCELERATION SQUARED'",
            "VELOCITY FROM ACCELERATION": "'VELOCITY FROM ACCELERATION'",
            "NORMALIZED ACCELERATION": "'NORMALIZED ACCELERATION'",
            "ACCELERATION (RAD/S2)": "'ACCELERATION (RAD/S2)'",
            "ACCELERATION, VOLTS": "'ACCELERATION, VOLTS'",
            "UNITS: KN": "'UNITS: KN'",
            "SCALE FACTOR = 0.01": "'SCALE FACTOR = 0.01'",
            **{
                line: f"{line!r} above the number of values; expected a line such as"
                for line in (
                    "HELLO",
                    "ACCELERATION FURLONG",
                    "ACCELERATION IN FURLONGS",
                )
            },
        }.items()
    ),
    (
        TITLE + "NPTS= 1003, DT= 5 FURLONGS\n" + body(),
        "a.AT2:4: found 'FURLONGS' after a time step; expected s or ms",
    ),
    (
        TITLE + "NPTS= 1003, DT= 1/200\n" + body(),
        "a.AT2:4: found '/200' after the time step '1'",
    ),
    (
        TITLE + "NPTS= 400, DT= .005 SEC\n" + body(),
        "found more than twice the 400 values declared",
    ),
    (
        TITLE + "NPTS= 1003, DT= .01 SEC\n" + rows(timed(0.005), 2, "{:12.6f} "),
        "a.AT2:5: times every 0.005 s, where the header",
    ),
    (
        broken("  0.1 -0.2 0.3-0.4 0.5 0.6"),
        "a.AT2:12: found '0.3-0.4', two numbers run together, after 37 of 1003",
    ),
    (
        broken("  0.1 -0.2 0.30.4 0.5 0.6"),
        "a.AT2:12: found '0.30.4', two numbers run together",
    ),
    (
        broken("  0.1 -0.2 ******* 0.5 0.6"),
        "a.AT2:12: found '*******', stars in place of a number",
    ),
    (broken("  0.1 -0.2 1e999 0.5 0.6"), "a.AT2:12: found '1e999'"),
]
test_bad_files_are_told_with_file_and_line = refuses(
    read_records, DocumentError, REFUSED, file="a.AT2", literal=True
)
GAL = wave(805, -104.4)
NONE = 1.7e38


def short(x):
    """Ten characters as the USGS writes them: -1.2345E+0."""
    mantissa, exponent = f"{x:.4e}".split("e")
    return f"{mantissa:>7}E{int(exponent):+d}"


def smc(
    *, kind="2 CORRECTED ACCELEROGRAM", count=805, rate=200.0, comments=3, digits=-32768
):
    text = [
        kind,
        "*",
        "ABCD",
        "     1900  10  18    0004 Nowhere",
        "Moment Mag=      7.1",
        "station = Somewhere, F  component=    360",
    ]
    text += [
        "epicentral dist =     89.0       pk     =    104.4",
        "inst type=SMA-1      data source = USGS",
        "*",
        "*",
        "*",
    ]
    integers = np.full(48, -32768)
    integers[15], integers[16], integers[46] = comments, count, digits
    reals = np.full(50, NONE)
    reals[1], reals[29], reals[31] = rate, 104.4, -52.2
    head = (
        "\n".join(text)
        + "\n"
        + rows(integers, 8, "{:10d}")
        + rows(reals, 5, "{:15.7E}")
        + "| a comment\n" * comments
    )
    return head + (
        rows(GAL, 5, "{:14.7E}") if digits == 8 else rows(map(short, GAL), 8, "{}")
    )


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        (smc(), short),
        (smc(comments=0).replace("ABCD", "AB\0\0"), short),
        (smc(digits=8), "{:14.7E}".format),
    ],
    ids=[
        "ten characters",
        "no comments and a name padded with nulls",
        "eight digits where the header says so",
    ],
)
def test_numbers_of_smc(tmp_path, text, printed):
    (tmp_path / "0001a.smc").write_text(text)
    record = read_record(tmp_path / "0001a.smc")
    assert (record.format, record.component, record.dt, record.remarks) == (
        "SMC",
        "360",
        0.005,
        (),
    )
    np.testing.assert_allclose(
        record.acceleration,
        1e-2 * np.array([float(printed(x)) for x in GAL]),
        rtol=1e-15,
    )
    assert record.header_pga == pytest.approx(1.044, rel=1e-6, abs=0)


REFUSED = [
    (smc(kind="3 VELOCITY"), "a:1: found '3 VELOCITY'; expected an accelerogram"),
    (smc(kind="0 UNKNOWN"), "a:1: found '0 UNKNOWN'; expected an accelerogram"),
    (
        smc(count=806),
        (
            "a:131: found 5 numbers on a line; expected 6 (the header announces 806"
            " values)"
        ),
    ),
    (smc(rate=0.0), "a sampling frequency of 0"),
    (smc(rate=NONE), "no sampling rate"),
    (
        "\n".join(smc().splitlines()[:60]) + "\n",
        "a:60: the file ends after 240 of 805 values",
    ),
]


def test_a_rate_in_seconds_is_a_remark(tmp_path):
    (tmp_path / "a").write_text(smc(rate=0.005))
    assert (
        "component 360: a time step of 200 s, which is unusually long"
        in read_record(tmp_path / "a").remarks
    )


test_bad_files_of_smc_are_told_with_file_and_line = refuses(
    read_records, DocumentError, REFUSED, file="a", literal=True
)


@pytest.mark.parametrize(
    "line",
    [
        "RESPONSE SPECTRUM TIME SERIES IN UNITS OF G",
        "SPECTRAL ACCELERATION TIME HISTORY IN UNITS OF G",
        "PSEUDO ACCELERATION TIME SERIES IN UNITS OF G",
        "SA TIME SERIES IN UNITS OF G",
        "SYNTHETIC RESPONSE SPECTRUM, ACCELERATION IN UNITS OF G",
        "COMPATIBLE RESPONSE SPECTRUM, UNITS OF G",
        "VALUES FROM RESPONSE SPECTRUM IN UNITS OF G",
        "ARIAS INTENSITY TIME SERIES IN UNITS OF G",
    ],
)
def test_a_spectrum_is_no_motion_whatever_stands_beside_its_name(tmp_path, line):
    header = f"Title\nNowhere, 090\n{line}\nNPTS= 1003, DT= 0.005 SEC\n"
    (tmp_path / "a.at2").write_text(header + body())
    with pytest.raises(DocumentError) as raised:
        read_record(tmp_path / "a.at2")
    assert f"a.at2:3: found {line!r}; expected an acceleration" in str(raised.value)


@pytest.mark.parametrize(
    "title", ["Component: CHAN 2: UP", "NOWHERE VERTICAL", "Nowhere - Up", "COMP V"]
)
def test_a_vertical_component_is_found_in_a_title(tmp_path, title):
    header = TITLE.replace("Nowhere, 1/2/1999, Anystation, 090", title)
    (tmp_path / "a.at2").write_text(header + "NPTS= 1003, DT= 0.005 SEC\n" + body())
    assert is_vertical(read_record(tmp_path / "a.at2"))


@pytest.mark.parametrize("line", ["Scale factor = 2.4072", "SCALING_FACTOR: -.5"])
def test_samples_under_a_factor_are_taken_only_as_they_stand(tmp_path, line):
    header = TITLE.replace("Nowhere, 1/2/1999, Anystation, 090", line)
    text = header + "NPTS= 1003, DT= 0.005 SEC\n" + body()
    said = refusal(tmp_path / "a.at2", text)
    assert f"a.at2:2: found {line!r}, and no word on" in said
    assert "`as_it_stands`, which takes them without a factor" in said
    record = read_record(tmp_path / "a.at2", as_it_stands=True)
    assert record.remarks == (f"the header states {line!r}; the samples do not get it",)
    np.testing.assert_array_equal(record.acceleration, READ)

    (tmp_path / "a.at2").write_text(text.replace(line, "SCALE FACTOR: 1.0"))
    assert read_record(tmp_path / "a.at2").remarks == ()


def test_fields_that_touch_are_as_wide_as_their_points_are_apart(tmp_path):
    text = TITLE + "NPTS= 1003, DT= 0.005 SEC\n" + rows(SAMPLES, 8, "{:9.6f}")
    assert "-0." in text.replace(" -0.", "")
    (tmp_path / "a.at2").write_text(text)
    np.testing.assert_array_equal(
        read_record(tmp_path / "a.at2").acceleration,
        DEFAULT_GRAVITY * as_printed(SAMPLES, "{:9.6f}"),
    )
