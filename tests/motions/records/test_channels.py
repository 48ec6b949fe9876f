"""Several channels a file: CSMIP volume 2 and GeoNet, whose numbers touch, COSMOS, and
the three layouts of volume 1.
"""

import numpy as np
import pytest
from support.record_layouts import (
    as_printed,
    refusal,
    rows,
    wave,
    with_a_line_missing_or_twice,
)
from support.refusals import refuses

from rocking_cli import DocumentError
from rocking_cli.documents.quantities import DEFAULT_GRAVITY
from rocking_cli.motions.records import read_record, read_records

SAMPLES = wave(997, 1234.56789)  # -1234.56789 fills its ten columns and one more
TOUCHING, TENTH = np.clip(SAMPLES, -999.0, 9999.0), SAMPLES / 10
SHORT = wave(733, -0.9875)  # g; -0.987500 fills its nine characters
EIGHT = wave(1234, 11024.7)  # -11024.7 fills its eight characters
LONG = wave(2000, 161.962)

CSMIP_HEADER = """Corrected accelerogram   12345-X0001-00001.02       \
Chan{number:3d}: {degrees:3d} Deg     from
Uncorrected Accelerogram Data             Processed: 01/02/00, XYZ
Record of Sun Jan  2, 1900 13:06:45.0 PST
Station No. 12345   40.000N, 120.000W      Etna  s/n 1
Instr Period =  .0109 sec,  Damping =  .670,  Sensitivity =  .63  v/g
                        Record length = {length:.3f} sec.
{points:6d} points of instrument- and baseline-corrected accel, veloc and displ data
At equally-spaced intervals of  {dt}  sec.
Peak acceleration = {peak:9.3f}    cm/sec/sec  at   30.585   sec.
Peak   velocity   =     3.150      cm/sec    at   30.650   sec.
"""
COSMOS_HEADER = """Corrected {quantity}    (Format v01.20 with 13 text lines) Src: none
Record of Nowhere
Hypocenter:
Origin:
Statn No:
Coords:
Recorder:
Rcrd start time:
Sta Cha:  1: 340 deg (Rcrdr Chan  1) Location: somewhere
Raw record length
Processed:
Record filtered
Values used when parameter or data value is unknown/unspecified:   -999, -999.0
 100 Integer-header values follow on  10 lines, Format= (10I8)
{integers} 100 Real-header values follow on {lines:3d} lines, Format= ({header})
{reals}  2 Comment line(s) follow, each starting with a "|":
 | one
 | two, of 7000 acceleration pts
{count:7d}  {quantity} pts, approx {length:4.0f} secs, units={unit},Format=({form})
"""
GEONET_HEADER = """{first} 19000102_030405_ABCD_20 GNS Science
Site ABCD      42 37 10S  173 03 13E
A Farm
Instrument X_1
Resolution: 18-bit
Accelerogram 19000102
5 km south-west of Nowhere
1900 January 02
Epicentre
Number of points {points:5d}    Duration {duration:.2f} sec
{readings} at {dt:.3f} sec intervals
Band-pass filter
Component {name}  Longitudinal Accelerometer Axis
Acceleration:  peak {peak:9.1f} mm/s/s at  44.88 sec     rms    719.0 mm/s/s
Velocity:      peak -1016.55 mm/s
Displacement:
"""
VOLUME_1_HEADER = """{first}
Record of Sun Jan  2, 1900 13:06:45.0 PST

12345-X0001
Station No. 12345   40.000N, 120.000W
Somewhere
{channel}


Instr Period =  .0109 sec,  Damping =  .670,  Sensitivity =  .63  v/g
No. of Points = {count:6d}  Record Length ={length:7.3f} sec   at 200 Samples/sec
{units}        Max  = {peak:7.4f} g , at  30.590 sec.
RMS calc for complete record =        .
"""


def largest(values):
    return values[np.argmax(np.abs(values))]


def csmip(
    number,
    degrees,
    values,
    *,
    dt="  .010",
    precise=0.01,
    unit="cm/sec2",
    form="(8f10.5)",
    points=None,
    length=None,
    blocks="avd",
):
    n, reals = len(values), np.zeros(100)
    said = {
        "points": n if points is None else points,
        "length": n * precise if length is None else length,
        "peak": abs(largest(values)),
    }
    reals[60] = precise
    text = CSMIP_HEADER.format(number=number, degrees=degrees, dt=dt, **said)
    text += rows(np.arange(100), 16, "{:5d}").replace("   -1", " -999") + rows(
        reals, 8, "{:10.7f}"
    )
    for word, of in (("accel", unit), ("veloc", "cm/sec"), ("displ", "cm")):
        if word[0] in blocks:
            text += (
                f"{n:6d} points of {word} data equally spaced at {dt} sec, in {of}."
                f" {form}\n" + rows(values, 8, "{:10.5f}")
            )
    return text + f"/&  ---------- End of data for channel {number:2d} ----------\n"


def cosmos(
    values=LONG,
    *,
    quantity="acceleration",
    unit="cm/sec2(04)",
    form="8F10.5",
    header="6F13.6",
    step=10.0,
    length=20.0,
    count=None,
):
    reals = np.full(100, -999.0)
    reals[33], reals[61], reals[62], reals[63] = 0.005, step, length, largest(values)
    columns, rest = header.split("F")
    printed = rows(reals, int(columns), f"{{:{rest}f}}")
    text = COSMOS_HEADER.format(
        integers=rows([-999] * 100, 10, "{:8d}"),
        lines=printed.count("\n"),
        reals=printed,
        count=len(values) if count is None else count,
        quantity=quantity,
        header=header,
        length=length,
        unit=unit,
        form=form,
    )
    per_line, width = form.replace("E", "F").split("F")
    return (
        text
        + rows(values, int(per_line), f"{{:{width}{'e' if 'E' in form else 'f'}}}")
        + "End-of-data for Chan  1 acceleration\n"
    )


def geonet(
    name,
    values,
    *,
    dt=0.02,
    first="Corrected accelerogram",
    readings="Instrument corrected data",
    **changed,
):
    n, integers, reals = len(values), np.zeros(40), np.zeros(60)
    said = {"points": n, "duration": (n - 1) * dt, "peak": largest(values), **changed}
    integers[33:36] = n, n, 3
    reals[24], reals[25] = 0.005, dt
    text = GEONET_HEADER.format(
        first=first, readings=readings, name=name, dt=dt, **said
    )
    text += (
        rows(integers, 10, "{:8.0f}")
        + rows(reals, 10, "{:8.4f}")
        + rows(values, 10, "{:8.1f}")
    )
    return (
        text + rows(values / 10, 10, "{:8.1f}") + rows([1.0, 2.0, 3.0], 10, "{:8.1f}")
    )


def uncorrected(name, values, unit="1.00"):
    """As V1A is: no velocities and displacements, whose numbers of values are 0."""
    text = geonet(
        name,
        values,
        first="Uncorrected accelerogram",
        readings=f"Raw readings in units of {unit} mm/s/s ",
    )
    lines = text.splitlines(keepends=True)
    lines[19] = lines[19][:32] + rows([0.0] * 6, 6, "{:8.0f}")
    return "".join(lines[: 26 - (-len(values) // 10)])


def volume_1(
    channel,
    units,
    values,
    *,
    length=None,
    first="Uncorrected Accelerogram Data   Processed: 01/02/00, XYZ",
):
    """13 lines of text and 14 of numbers, which touch in places."""
    count, length, reals = (
        len(values),
        len(values) / 200 if length is None else length,
        np.full(50, -999.0),
    )
    text = VOLUME_1_HEADER.format(
        first=first,
        channel=channel,
        count=count,
        length=length,
        units=units,
        peak=largest(values) if count else 0.0,
    )
    reals[0], reals[6] = 0.019, 200.0
    numbers = (
        rows(reals, 6, "{:13.6E}")
        if first.startswith("*")
        else rows(reals, 8, "{:10.5f}")
    )
    return (
        text
        + rows(np.arange(100), 16, "{:5d}")
        + "".join(numbers.splitlines(keepends=True)[:7])
    )


def announced(channel, values=SHORT, *, length=None, unit="g ", rate=200, points=None):
    text = volume_1(
        f"Chan  1: {channel}",
        "Units of uncor data are sec and g .",
        values,
        length=length,
    )
    text += (
        f"{points or len(values):6d} Accelerogram points at {rate} pts/sec in units of"
        f" {unit}.      Format: (8f9.6)  \n"
    )
    return (
        text
        + rows(values, 8, "{:9.6f}")
        + "/&  ----------  End of Data for Channel  1  ----------\n"
    )


def paired(channel, values, *, uneven=0.0):
    times = 0.005 * np.arange(len(values))
    times[11:12] += uneven
    text = volume_1(
        f"CHAN  1: {channel}        (STA CHN:  1)",
        "UNITS OF UNCOR ACCEL ARE SEC AND G/10.",
        values,
    )
    return (
        text.upper()
        + rows(np.stack([times, 10.0 * values], axis=1).ravel(), 10, "{:7.3f}")
        + "/&  ----------  END\n"
    )


def alone(channel, values, *, length=None):
    text = volume_1(
        f"COMP {channel}",
        "UNITS ARE SECONDS AND G/10",
        values,
        length=length,
        first="* VOL1DS FILE:  1/01",
    )
    return (
        text.replace("Record Length", "    DURATION")
        + rows(10.0 * values, 10, "{:13.6E}")
        + "/&\n"
    )


VELOCITY = cosmos(-LONG, quantity="velocity", unit="cm/sec(05)")
OLD = (
    csmip(1, 90, TOUCHING, form="")
    .replace("sec, in cm/sec2. ", "sec.  (units: cm/sec/sec)")
    .upper()
)  # before 1990
WAYS = (
    (announced, "{:9.6f}", 1.0, "Deg", "Up"),
    (paired, "{:7.3f}", 10.0, "DEG", "UP"),
    (alone, "{:13.6E}", 10.0, "Deg", "Up"),
)


@pytest.mark.parametrize(
    ("text", "form", "dt", "unit", "printed", "samples"),
    [
        (
            csmip(1, 90, TOUCHING) + csmip(2, 360, TENTH),
            "CSMIP V2",
            0.01,
            1e-2,
            "{:10.5f}",
            {"90 Deg": TOUCHING, "360 Deg": TENTH},
        ),
        (
            csmip(1, 90, TOUCHING, form="").upper(),
            "CSMIP V2",
            0.01,
            1e-2,
            "{:10.5f}",
            {"90 DEG": TOUCHING},
        ),
        (OLD, "CSMIP V2", 0.01, 1e-2, "{:10.5f}", {"90 DEG": TOUCHING}),
        (
            csmip(1, 90, TENTH, dt="  .008", precise=0.0078125),
            "CSMIP V2",
            0.0078125,
            1e-2,
            "{:10.5f}",
            {"90 Deg": TENTH},
        ),
        *(
            (
                cosmos(form=form, header=header),
                "COSMOS",
                0.01,
                1e-2,
                printed,
                {"340 deg": LONG},
            )
            for form, printed in (
                ("8F10.5", "{:10.5f}"),
                ("1E15.6", "{:15.6e}"),
                ("10F8.3", "{:8.3f}"),
            )
            for header in ("6F13.6", "5F15.6")
        ),
        (
            VELOCITY + cosmos(length=19.99),
            "COSMOS",
            0.01,
            1e-2,
            "{:10.5f}",
            {"340 deg": LONG},
        ),
        (
            geonet("N28W", np.minimum(EIGHT, 9999.0))
            + geonet("S62W", -EIGHT / 3)
            + geonet("Up", EIGHT / 7),
            "GeoNet",
            0.02,
            1e-3,
            "{:8.1f}",
            {"N28W": np.minimum(EIGHT, 9999.0), "S62W": -EIGHT / 3, "Up": EIGHT / 7},
        ),
        (
            uncorrected("N40W", EIGHT / 2) + uncorrected("Up", EIGHT / 7),
            "GeoNet",
            0.02,
            1e-3,
            "{:8.1f}",
            {"N40W": EIGHT / 2, "Up": EIGHT / 7},
        ),
        *(
            (
                write("360 Deg", SHORT) + write("Up", -SHORT / 3),
                "Volume 1",
                0.005,
                9.81 / ten,
                printed,
                {f"360 {degrees}": ten * SHORT, up: -ten * SHORT / 3},
            )
            for write, printed, ten, degrees, up in WAYS
        ),
    ],
)
def test_samples_step_and_peak_of_every_channel(
    tmp_path, text, form, dt, unit, printed, samples
):
    (tmp_path / "a").write_text(text)
    records = read_records(tmp_path / "a")
    assert [r.component for r in records] == list(samples)
    for record, wanted in zip(records, samples.values(), strict=True):
        assert (record.format, record.dt) == (form, dt)
        assert record.remarks == (
            ("an uncorrected accelerogram",)
            if "ncorrected accelerogram 1" in text or form == "Volume 1"
            else ()
        )
        np.testing.assert_allclose(
            record.acceleration, unit * as_printed(wanted, printed), rtol=1e-15
        )
        assert record.header_pga == pytest.approx(
            np.abs(record.acceleration).max(), rel=1e-4, abs=0.05
        )


def of_1990(*, unit="G", form="", count=None, rate="010"):
    """As CSMIP wrote volume 1 in the 1990s, without a Fortran format."""
    text = volume_1(
        "CHAN  1: 90 DEG", "UNITS OF UNCOR ACCEL IS G.", SHORT, length=len(SHORT) / 100
    ).upper()
    said = (
        f"{count or len(SHORT):5d} POINTS OF ACCEL DATA EQUALLY SPACED AT .{rate} SEC. "
        f" (UNITS: {unit}) {form}\n"
    )
    return text + said + rows(SHORT, 8, "{:9.6f}")


def test_volume_1_of_the_1990s_states_step_and_unit_above_its_samples(tmp_path):
    present = announced("90 DEG").replace("(8f9.6)", "")
    for text in (of_1990(), of_1990(form="(8F9.6)"), present):
        (tmp_path / "a.RAW").write_text(text)
        record = read_record(tmp_path / "a.RAW")
        assert (record.format, record.component, record.dt, record.unit) == (
            "Volume 1",
            "90 DEG",
            0.005 if text is present else 0.01,
            "g",
        )
        np.testing.assert_allclose(
            record.acceleration, 9.81 * as_printed(SHORT, "{:9.6f}"), rtol=1e-15
        )
    assert "found the unit 'FURLONG'" in refusal(
        tmp_path / "a.RAW", of_1990(unit="FURLONG")
    )
    assert "732 points, where the header states 733" in refusal(
        tmp_path / "a.RAW", of_1990(count=732)
    )
    assert "where the header states" in refusal(tmp_path / "a.RAW", of_1990(rate="020"))


@pytest.mark.parametrize(
    ("changed", "factor", "printed"),
    [
        ({"unit": "in/sec2"}, 0.0254, "{:10.5f}"),
        ({"unit": "cm/s^2"}, 1e-2, "{:10.5f}"),
        ({"unit": "cm/s^2 (4)", "form": "10F8.3"}, 1e-2, "{:8.3f}"),  # neighbours touch
        ({"unit": "g.     (02)"}, DEFAULT_GRAVITY, "{:10.5f}"),
        ({"unit": "gal(04)"}, 1e-2, "{:10.5f}"),
        ({"quantity": "uncor. accel."}, 1e-2, "{:10.5f}"),
    ],
)
def test_how_writers_of_cosmos_name_the_unit_and_the_block(
    tmp_path, changed, factor, printed
):
    (tmp_path / "a").write_text(
        "".join(f"{line:<80}\n" for line in cosmos(**changed).splitlines())
    )  # card images
    np.testing.assert_allclose(
        read_record(tmp_path / "a").acceleration,
        factor * as_printed(LONG, printed),
        rtol=1e-15,
    )


def test_what_is_no_acceleration_is_not_read(tmp_path):
    text = csmip(1, 90, TOUCHING)
    displaced = text.index("points of displ")
    spoilt = text[:displaced] + text[displaced:].replace(
        f"{TOUCHING[500]:10.5f}", "*" * 10
    )
    (tmp_path / "a").write_text(spoilt + csmip(2, 360, TENTH))
    assert [r.component for r in read_records(tmp_path / "a")] == ["90 Deg", "360 Deg"]
    assert read_record(tmp_path / "a", component="360 deg").component == "360 Deg"


def test_channels_of_one_name_or_none_are_told_apart(tmp_path):
    (tmp_path / "a").write_text(csmip(1, 90, TENTH) + csmip(2, 90, TENTH / 2))
    assert [r.component for r in read_records(tmp_path / "a")] == [
        "90 Deg (1)",
        "90 Deg (2)",
    ]
    (tmp_path / "a").write_text(
        csmip(1, 90, TENTH) + csmip(2, 360, TENTH / 2).partition("\n")[2]
    )
    assert [r.component for r in read_records(tmp_path / "a")] == [
        "90 Deg",
        "channel (2)",
    ]


def test_volume_1_in_another_unit_is_not_held_against_its_peak_in_g(tmp_path):
    (tmp_path / "a").write_text(announced("Up", unit="cm/sec2 "))
    assert [(r.unit, r.header_pga) for r in read_records(tmp_path / "a")] == [
        ("cm/s2", None)
    ]


def head(text, lines, end="\n"):
    return "\n".join(text.splitlines()[:lines]) + end


REFUSED = [
    (
        "Response and Fourier amplitude spectra (78 periods)   for\n"
        + csmip(1, 90, SAMPLES),
        "a:1: spectra (volume 3)",
    ),
    (csmip(1, 90, TENTH, blocks="v"), "no points of accel data, only of vel"),
    (csmip(1, 90, TENTH, blocks=""), "no line `n points of accel data`"),
    (csmip(1, 90, TENTH, points=996), "a:31: 996 points, where the header states 997"),
    (
        csmip(1, 90, TENTH, length=59.97),
        "a:31: 997 values every 0.01 s make 9.97 s, where the header states 59.970 s",
    ),
    (csmip(1, 90, TENTH, unit="cm/sec"), "a:31: found"),
    (csmip(1, 90, TENTH, dt="  .000", precise=0.0), "a time step of"),
    (
        csmip(1, 90, SAMPLES),
        "a:88: found '3-1056.335', two numbers run together",
    ),  # eleven characters in ten columns
    (
        csmip(1, 90, TENTH).replace(f"{TENTH[500]:10.5f}", "*" * 10, 1),
        "'**********', stars in place of a number",
    ),
    (
        csmip(1, 90, TENTH).replace(f"{TENTH[500]:10.5f}", "   1.2 3.4", 1),
        "found '1.2 3.4', ",
    ),
    (head(csmip(1, 90, TENTH), 200), "a:200: the file ends after 344 of 997 values"),
    (head(csmip(1, 90, TENTH), 100), "a:100: the file ends after 552 of 997 values"),
    (head(csmip(1, 90, TENTH), 100, "\n/& End of data"), "a:101: found '/&"),
    (
        cosmos(step=5.0),
        "a:46: 2000 values every 0.005 s make 10 s, where the header states 20 s",
    ),
    (
        cosmos(length=72.0),
        "2000 values every 0.01 s make 20 s, where the header states 72 s",
    ),
    (
        cosmos(np.where(np.arange(2000) == 5, -999.0, LONG)),
        "a:296: sample 6 is -999.0, which marks an unknown value",
    ),
    (cosmos(step=0.0), "a:46: a time step of 0"),
    (
        cosmos(quantity="velocity", unit="cm/sec(05)"),
        "no acceleration, only velocity in cm/sec",
    ),
    (cosmos(unit="counts(50)"), "found the unit 'counts' (50)"),
    (
        cosmos(unit="furlong/sec2"),
        "a:46: found the unit 'furlong/sec2' (no code); expected cm/s2 (04)",
    ),
    (
        cosmos(unit="cm/sec(04)"),
        "a:46: found the unit 'cm/sec' with the code 04, which is cm/s2",
    ),
    (cosmos(unit="g(04)"), "a:46: found the unit 'g' with the code 04, which is cm/s2"),
    (cosmos(count=2008, length=20.08), "after 2000 of 2008 values"),
    (cosmos().replace("Real-header", "Imaginary"), "100 real-header values follow"),
    (head(cosmos(), 20, ""), "a:20: the file ends after 60 of 100 values"),
    (
        geonet("Up", EIGHT / 2, points=1235),
        "a:10: 1235 points, where the header states 1234",
    ),
    (
        geonet("Up", EIGHT / 2, duration=30.0),
        "a:10: 1234 values every 0.02 s make 24.68 s, where the header states 30.00 s",
    ),
    (geonet("Up", EIGHT / 2, dt=0.0, duration=24.66), "a time step of 0"),
    (
        uncorrected("Up", EIGHT / 2, unit="0.10"),
        "a:11: found raw readings in units of 0.10 mm/s/s; expected units of 1 mm/s/s",
    ),
    (
        uncorrected("Up", EIGHT / 2).replace("1.00 mm/s/s", "1.00 cm/s/s"),
        "a:11: found raw readings in units of 1.00 cm/s/s",
    ),
    (head(geonet("Up", EIGHT / 2), 60), "a:60: the file ends after 340 of 1234 values"),
    (
        geonet("Up", EIGHT / 2) + head(geonet("N", EIGHT / 2), 20, ""),
        "the file ends after",
    ),
    (
        geonet("N", EIGHT / 2)
        + geonet("E", EIGHT / 2).partition("\n")[2]
        + geonet("Up", EIGHT / 2),
        (
            "a:276: found 'Site ABCD      42 37 10S  173 03 13E'; expected the first"
            " line of a component"
        ),
    ),
    (
        paired("L", SHORT, uneven=0.001),
        "a:30: times that do not rise in even steps, such as 0.056 s",
    ),
    (paired("L", SHORT[:0]), "a:28: found 0 values"),
    (announced("Up", unit="counts"), "a:28: found the unit 'counts'"),
    (announced("Up", points=732), "a:28: 732 points, where the header states 733"),
    (
        announced("Up", length=3.0),
        "733 values every 0.005 s make 3.665 s, where the header states 3.000 s",
    ),
    (
        announced("Up").replace("Accelerogram points", "points of accelerograms"),
        "a:28: found '733 points of accelerograms at 200",
    ),
    (announced("Up", rate=0), "a:28:"),
    (announced("Up").replace("No. of Points", "Points"), "no line `No. of Points = n"),
    (
        alone("V", SHORT, length=36.65),
        "733 values every 0.005 s make 3.665 s, where the header states 36.650 s",
    ),
    (head(announced("Up"), 60), "a:60: the file ends after 256 of 733 values"),
    (head(announced("Up"), 20, ""), "a:20: the file ends within its header"),
]
test_bad_files_are_told_with_file_and_line = refuses(
    read_records, DocumentError, REFUSED, file="a", literal=True
)


@pytest.mark.parametrize(
    "count",
    [13, *(pytest.param(count, marks=pytest.mark.soak) for count in (37, 40, 45, 48))],
)
def test_a_line_of_numbers_missing_or_twice_loses_no_channel(tmp_path, count):
    long = {"length": count / 100}
    texts = [
        geonet("N", wave(count, 900.0))
        + geonet("E", wave(count, 800.0))
        + geonet("Up", wave(count, 70.0))
    ]
    texts += [
        cosmos(wave(count, 99.0), **long)
        + cosmos(wave(count, 9.0), quantity="velocity", unit="cm/sec(05)", **long)
    ]
    for text in texts:
        for number, spoilt in with_a_line_missing_or_twice(text):
            assert refusal(tmp_path / "a", spoilt).count(":") >= 2, number
    text = csmip(1, 90, wave(count, 99.0)) + csmip(2, 360, wave(count, 88.0))
    below, of_blocks = False, set()  # the lines below a line that announces points
    for i, line in enumerate(text.splitlines(), 1):
        numbers = not set(line.strip()) - set(" 0123456789.-")
        below = (below and numbers) or " points of " in line
        of_blocks |= {i} if below and numbers else set()
    refusals = [
        refusal(tmp_path / "a", spoilt)
        for i, spoilt in with_a_line_missing_or_twice(text)
        if i in of_blocks
    ]
    assert len(refusals) == 2 * 6 * -(-count // 8)
