"""Plain columns of numbers under at most one heading line: what the file does not say
the user states.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.errors import DocumentError, RockingError, UsageError
from rocking_cli.motions.reading import load_records
from rocking_cli.motions.records import Given, read_record, records_of

SAMPLES = wave(400, 2.5)
READ = as_printed(SAMPLES, "{:.6f}")
COLUMN = "".join(f"{x:.6f}\n" for x in SAMPLES)
ROWS = [f"{0.01 * i:.2f} {x:.6f}" for i, x in enumerate(SAMPLES)]
TWO = "\n".join(ROWS) + "\n"
STATED = {"unit": "m/s2", "dt": 0.01}


def commas(text):
    return text.replace(".", ",")


@pytest.mark.parametrize("separator", [",", ";", "\t", "   ", ", ", "  ,\t"])
@pytest.mark.parametrize("title", ["", "Time[s]{}Accel[m/s^2]\n", "# t{}a\n\n"])
def test_two_columns(tmp_path, separator, title):
    path = tmp_path / "motion.csv"
    path.write_text(title.format(separator) + TWO.replace(" ", separator))
    record = read_record(path, unit="m/s2")
    assert (record.format, record.dt, record.header_pga) == ("text", 0.01, None)
    np.testing.assert_array_equal(record.acceleration, READ)


INDEXED = "".join(f"{i},{row}\n" for i, row in enumerate(TWO.replace(" ", ",").split()))
CARDS = "".join(
    f"{row} {i}\n" for i, row in enumerate(rows(SAMPLES, 6, "{:11.6f}").splitlines(), 1)
)
SAME = {
    "one column": (COLUMN, STATED),
    "a heading of one column": ("a (m/s2)\n" + COLUMN, {"dt": 0.01}),
    "semicolons": ("t [s];a [m/s2]\n" + commas(TWO).replace(" ", ";"), {}),
    "semicolons without a heading": (commas(TWO).replace(" ", ";"), {"unit": "m/s2"}),
    "tabs": ("t [s]\ta [m/s2]\n" + commas(TWO).replace(" ", "\t"), {}),
    "blanks": ("t [s] a [m/s2]\n" + commas(TWO), {}),
    "decimal commas in one column": ("a [m/s2]\n" + commas(COLUMN), {"dt": 0.01}),
    "decimal commas alone": (commas(COLUMN), STATED),
    "whole numbers first": (
        "t [s];a [m/s2]\n0;0\n" + commas(TWO).replace(" ", ";").partition("\n")[2],
        {},
    ),
    "quotes": (
        '"t [s]";"a [m/s2]"\n'
        + "".join(f'"{x}"\n'.replace(" ", '";"') for x in commas(TWO).splitlines()),
        {},
    ),
    "commas and quotes": (
        '"t [s]","a [m/s2]"\n'
        + "".join(f'"{x}"\n'.replace(" ", '","') for x in commas(TWO).splitlines()),
        {},
    ),
    "empty cells at each end": (
        "t [s],a [m/s2],,\n" + TWO.replace(" ", ",").replace("\n", ",,\n"),
        {},
    ),
    "minus signs of a word processor": ("t [s] a [m/s2]\n" + TWO.replace("-", "−"), {}),
    "blank lines": ("Time,Accel\n\n" + TWO.replace("\n", "\n\n"), {"unit": "m/s2"}),
    "times in ms": (
        "t (ms) a (m/sec^2)\n"
        + "".join(f"{10 * i} {x:.6f}\n" for i, x in enumerate(SAMPLES)),
        {},
    ),
    "options that agree": ("t [s] a [m/s2]\n" + TWO, STATED),
    "an index as pandas writes it": (",time (s),acc (m/s2)\n" + INDEXED, {}),
    "an index without a name": ("Unnamed: 0,time (s),acc (m/s2)\n" + INDEXED, {}),
    "an index without a heading": (INDEXED, {"unit": "m/s2"}),
    "an index and values": (
        "".join(f"{i} {x:.6f}\n" for i, x in enumerate(SAMPLES)),
        STATED,
    ),
    "values in a row": (rows(SAMPLES, 7, "{:11.6f}"), {**STATED, "column": "all"}),
    "numbers of cards behind values": (CARDS, {**STATED, "column": "all"}),
    "fields that touch": (rows(SAMPLES, 7, "{:9.6f}"), {**STATED, "column": "all"}),
    "fields that touch under exponents": (
        rows(READ, 7, "{:13.6E}"),
        {**STATED, "column": "all"},
    ),
    "a line at the end": (COLUMN + "*** End Data ***\n", STATED),
    "prose above": (
        f"Kobe, Japan\ndt = 0.01 s\n\nunits: g\n{COLUMN}",
        {**STATED, "skip": 4},
    ),
    "prose above a heading": (f"Kobe, Japan\nt [s] a [m/s2]\n{TWO}", {"skip": 1}),
    "a block of velocities below": (
        f"Kobe\nDATA TYPE=AC\n{COLUMN}\nDATA TYPE=VL\n{COLUMN}",
        {**STATED, "skip": "2:402"},
    ),
    "pairs of times and values": (
        "UNITS ARE SEC AND G/10\n" + TWO.replace("\n", " ", 350),
        {"unit": "m/s2", "column": "pairs", "skip": 1},
    ),
    "pairs below headings": (
        "t [s] a [m/s2]\n" + TWO.replace("\n", " ", 397),
        {"column": "pairs"},
    ),
    "a number of values above": (f"400\n{COLUMN}", {**STATED, "skip": 1}),
}


@pytest.mark.parametrize(("text", "given"), SAME.values(), ids=SAME)
def test_other_ways_to_write_them(tmp_path, text, given):
    (tmp_path / "a").write_text(text, encoding="utf-8")
    record = read_record(tmp_path / "a", **given)
    assert record.dt == pytest.approx(0.01, rel=2e-15)
    np.testing.assert_array_equal(record.acceleration, READ)
    told = " ".join(record.remarks)
    index = "index" in "".join(k for k, v in SAME.items() if v[0] is text)
    assert ("counts the lines, left out" in told) == (index or text is CARDS)


def test_lines_above_are_counted_by_the_user_and_told(tmp_path):
    path, above = tmp_path / "a", "Kobe \x07\nt [s] velocity [cm/s]\n"
    path.write_text(above + TWO)
    record = read_record(path, unit="m/s2", skip=2)
    assert record.remarks == (
        "line 1, not read: 'Kobe \\x07'; line 2, not read: 't [s] velocity [cm/s]'",
    )
    assert "a:1: found 'Kobe" in refusal(path)
    for heading, lines in (("t [s] a [m/s2]", 2), ("what is this", 3)):
        said = refusal(path, f"Kobe\nJapan\n{heading}\n{TWO}")
        assert "a:1: found 'Kobe' and more lines above the numbers" in said
        assert f"`skip` {lines} passes over lines above" in said
    assert "a:203: times that do not rise" in refusal(
        path, f"Kobe\n1\n{TWO.replace('2.00 ', '2.05 ')}", unit="g", skip=2
    )
    for skip, words in (
        (403, "found 403; the file has 402 lines"),
        ("2:400", "found 2:400; the file has 402 lines"),
        (-1, "from 0"),
        ("2:", "two as 4:60, of lines above and below"),
    ):
        with pytest.raises(UsageError, match=words):
            read_record(path, skip=skip)


@pytest.mark.parametrize("skip", [0, 1])
def test_words_below_the_numbers_are_left_out_by_the_user(tmp_path, skip):
    path, above = tmp_path / "a", skip * "Kobe\n" + "acc [m/s2]\n"
    text = f"{above}{COLUMN}DATA TYPE=VL\n{COLUMN}"
    said = refusal(path, text, dt=0.01, skip=skip)
    assert f"a:{402 + skip}: found 'DATA'" in said
    assert f"`skip` {skip}:401 passes over lines above and below" in said
    record = read_record(path, dt=0.01, skip=f"{skip}:401")
    np.testing.assert_array_equal(record.acceleration, READ)
    told = f"line {402 + skip} and below, not read: 'DATA TYPE=VL'"
    assert record.remarks[0].endswith(told)
    assert "`skip`" not in refusal(path, f"{above}{COLUMN}nan\n", dt=0.01, skip=skip)


def test_tenths_of_g_are_a_unit(tmp_path):
    (tmp_path / "a").write_text("t [s],acc [G/10]\n" + TWO.replace(" ", ","))
    record = read_record(tmp_path / "a")
    np.testing.assert_allclose(record.acceleration, 0.981 * np.array(READ), rtol=1e-15)
    assert record.unit == "g/10"


def test_lines_of_pairs_hold_two_numbers_each(tmp_path):
    text = "0 0.1 0.01 -0.2\n0.02 0.3 0.03\n0.04 0.1\n"
    said = refusal(tmp_path / "a", text, column="pairs", unit="g")
    assert "a:2: found 3 numbers; expected pairs of two" in said


def test_lines_above_any_format_are_passed_over(tmp_path):
    head = "ACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 400, DT= 0.01 SEC\n"
    (tmp_path / "a").write_text(f"VELOCITY\n{head}{rows(SAMPLES, 5, '{:11.6f}')}")
    record = read_record(tmp_path / "a", skip=1)
    assert (record.format, record.unit) == ("PEER AT2", "g")


@pytest.mark.parametrize(
    ("lead", "lines"),
    [
        ("400\n", 1),
        ("400.000000\n", 1),
        ("0.01\n", 1),
        ("0.010000\n", 1),
        ("100\n", 1),
        ("400\n0.01\n", 2),
        ("0.005\n400\n", 2),
        ("50.000000\n", 1),
    ],
)
def test_first_numbers_that_may_be_no_samples_are_refused(tmp_path, lead, lines):
    path = tmp_path / "a"
    said = refusal(path, lead + COLUMN, **STATED)
    assert said.startswith(f"{path}:1: found {lead.split()[0]} ")
    assert f"`skip` {lines} passes over it, `as_it_stands` takes it" in said
    np.testing.assert_array_equal(
        read_record(path, **STATED, skip=lines).acceleration, READ
    )
    assert read_record(path, **STATED, as_it_stands=True).npts == 400 + lines


@pytest.mark.parametrize("first", ["0.000000\n", "0\n", "0.012345\n", "-0.010000\n"])
def test_a_first_sample_stays_one(tmp_path, first):
    (tmp_path / "a").write_text(first + COLUMN)
    assert read_record(tmp_path / "a", **STATED).npts == 401


def test_a_row_above_times_is_refused(tmp_path):
    said = refusal(tmp_path / "a", "400 0.01\n" + TWO, unit="g")
    assert "a:1: found 400 above times that rise evenly" in said
    assert "`skip` 1" in said


def test_columns_without_headings_are_named_by_the_user(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(
        "".join(f"{i / 100:.2f},{x:.6f},{2 * x:.6f}\n" for i, x in enumerate(SAMPLES))
    )
    said = refusal(path, unit="g")
    assert "a.csv:1: 3 columns without headings" in said
    assert "as `column`, or `column` all" in said
    np.testing.assert_array_equal(
        read_record(path, unit="m/s2", column="2").acceleration, READ
    )
    for column, words in (("1", "that of the times"), ("4", "the file has 3 columns")):
        with pytest.raises(UsageError, match=words):
            read_record(path, unit="g", column=column)


PAIRS = "".join(
    f"{0.02 * i:.2f} {x:.6f} {0.02 * i + 0.01:.2f} {x:.6f}\n"
    for i, x in enumerate(SAMPLES)
)


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        (TWO, "all", "a:1: the first numbers of the lines rise evenly, as times do"),
        (PAIRS, "all", "a:1: the first numbers of the lines rise evenly"),
        (PAIRS, "2", "a:1: columns 1 and 3 rise alike, as times do; expected one time"),
        (PAIRS, None, "a:1: columns 1 and 3 rise alike, as times do; expected one"),
    ],
)
def test_times_are_not_taken_for_values(tmp_path, text, column, words):
    assert words in refusal(tmp_path / "a", text, unit="g", dt=0.01, column=column)


@pytest.mark.parametrize("step", [1, 10])
def test_times_that_can_hardly_be_seconds_are_told(tmp_path, step):
    text = "".join(f"{step * i} {x:.6f}\n" for i, x in enumerate(SAMPLES))
    (tmp_path / "a").write_text("t [s] a [m/s2]\n" + text)
    record = read_record(tmp_path / "a")
    told = f"a time step of {step} s, which is unusually long"
    assert (record.dt, record.remarks) == (step, (told,))
    if step == 1:
        assert "column 1 counts the lines, left out; numbers without times" in refusal(
            tmp_path / "a", text, unit="g"
        )


@pytest.mark.parametrize(
    ("factor", "unit", "remarks"),
    [
        (0.3, "g", ()),
        # m/s2 or g taken for gal
        (0.3, "gal", ("a PGA of 0.000765 g, where the unit is taken to be gal",)),
        (1e-5, "g", ()),  # far from a small earthquake
        (300.0, "g", ("a PGA of 750 g, where the unit is taken to be g",)),
    ],
)
def test_a_peak_that_speaks_against_the_unit_is_a_remark(
    tmp_path, factor, unit, remarks
):
    (tmp_path / "a").write_text("".join(f"{factor * x:.9f}\n" for x in SAMPLES))
    assert read_record(tmp_path / "a", unit=unit, dt=0.01).remarks == remarks


def test_times_printed_to_few_digits_are_an_even_grid(tmp_path):
    (tmp_path / "a").write_text(
        "".join(f"{i / 128:.3f} {x:.6f}\n" for i, x in enumerate(SAMPLES[:129]))
    )
    assert read_record(tmp_path / "a", unit="m/s2").dt == 1 / 128


def lines(**changed):
    return (
        "\n".join(
            {
                **dict(enumerate(ROWS)),
                **{int(k[1:]): v for k, v in changed.items()},
            }.values()
        )
        + "\n"
    )


@pytest.mark.parametrize(
    ("text", "given", "words"),
    [
        (
            lines(),
            {},
            "a: plain numbers without a unit; give it as `unit`, one of m/s2",
        ),
        (
            "1\n2\n3\n",
            {"unit": "g"},
            "a: numbers without times; give their step as `dt`",
        ),
        (
            lines(),
            {"unit": "g", "dt": 0.02},
            "a: `dt`: found 0.02 s; the file says otherwise: 0.01 s (text)",
        ),
        ("1 2 3\n4 5 6\n", {"unit": "g"}, "a:1: 3 columns without headings"),
        (
            "t [s], acc [g]\n" + lines(),
            {"unit": "m/s2"},
            ("a: `unit`: found m/s2; the file says otherwise: g (text)"),
        ),
        (
            (
                ' Result ID, Spectral Ordinate, Event\n 1, SRSS, "Nowhere"\n 2, SRSS,'
                ' "Elsewhere"\n'
            ),
            {"unit": "g"},
            "no record format",
        ),
        ("Time,Accel\n\n" + lines(_100="1.00 x"), {"unit": "g"}, "a:103: found 'x'"),
        (
            "Time,Accel\n\n" + lines(_100="1.00 1 2"),
            {"unit": "g"},
            "a:103: found 3 numbers, 2",
        ),
        (
            "Time,Accel\n\n" + lines(_100="9.00 0.1"),
            {"unit": "g"},
            "a:103: times that do not rise in even steps, such as 9 s",
        ),
        (
            lines(_7="0.07"),
            {"unit": "g"},
            "a:8: found 1 numbers, 2 on the lines before",
        ),
        (
            lines(_7="0.07 0.1 0.2"),
            {"unit": "g"},
            "a:8: found 3 numbers, 2 on the lines before",
        ),
        (
            lines(_7="0.07 0.1-0.2"),
            {"unit": "g"},
            "a:8: found '0.1-0.2', two numbers run together",
        ),
        (
            lines(_7="0.07 ****"),
            {"unit": "g"},
            "a:8: found '****', stars in place of a number",
        ),
        (
            lines(_7="0.07 nan"),
            {"unit": "g"},
            "a:8: found 'nan', which is no finite number",
        ),
        (
            lines(_7="0.05 0.1"),
            {"unit": "g"},
            "a:8: times that do not rise in even steps, such as 0.05 s",
        ),
        (
            "t velocity\n" + lines(),
            {"unit": "g"},
            "a:1: found 'velocity' (velocity); expected an acceleration",
        ),
        (
            "t [s],Displ. [cm]\n" + lines(),
            {"unit": "g"},
            "a:1: found 'Displ. [cm]' (quantity in cm); expected an acceleration",
        ),
        (
            "own motion in g (8F9.6)\n0.1 -0.2\n-0.3 0.1\n",
            {"column": "all"},
            "(no unit that is known: 8F9.6); expected an acceleration, or `skip` 1",
        ),
        ("0 1\n0 2\n0 3\n", {"unit": "g"}, "times that do not rise"),
        (
            "0\n1e7\n",
            {"unit": "m/s2", "dt": 0.01},
            "an acceleration that is not finite or beyond 1e+06 m/s2",
        ),
        (
            "0\n1e308\n",
            {"unit": "g", "dt": 0.01},
            "an acceleration that is not finite or beyond 1e+06 m/s2",
        ),
        (
            "0\n1\n",
            {"unit": "g", "dt": 1e4},
            "a time step of 10000 s; expected a step from 1e-07 to 1000 s",
        ),
        ("0.5\n", {"unit": "g", "dt": 0.01}, "1 samples; a record has at least two"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, text, given, words):
    assert words in refusal(tmp_path / "a", text, **given)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t;a [g]\n0;0\n0,01;0.5\n0,02;0,1\n", "a:3: found '0.5'; expected a decimal"),
        ("t;a [g]\n0,00;0,5\n0,01;1.000,5\n", "a:3: found '1.000,5'; expected a dec"),
        ("t,NS [g],EW [g]\n0,1,2\n0.01,,2\n0.02,1,2\n", "a:3: an empty cell between"),
        (
            "t a [g]\n" + TWO.replace("0.20 ", "0.205 "),
            "times that do not rise in even",
        ),
        (
            "t [s],a [g]\n2003-01-02T03:04:05.00,-0.1\n2003-01-02T03:04:05.01,0.1\n",
            "a:2: found '2003-01-02T03:04:05.00'; expected a time in s",
        ),
        (
            f"{TWO}\nOWN STATION\n{TWO}",
            "a:402: found 'OWN', which is no finite number; expected one block",
        ),
    ],
)
def test_faults_of_rows_are_told_with_their_line(tmp_path, text, words):
    assert words in refusal(tmp_path / "a", text, unit="g")


@pytest.mark.parametrize("mark", ["-999", "-9999.0", "99999", "999.9"])
def test_a_mark_of_a_missing_value_is_refused(tmp_path, mark):
    text = TWO.replace(TWO.split()[11], mark)
    assert f"sample 6 is {float(mark):.10g}, which marks a missing value" in refusal(
        tmp_path / "a", text, unit="g"
    )


def test_a_file_named_as_velocities_is_read_only_where_it_says_acceleration(tmp_path):
    for name in (
        "S.vel",
        "S.DIS",
        "S_E.vt2",
        "S_E_disp.txt",
        "S.psa",
        "NS_velocity.txt",
    ):
        (tmp_path / name).write_text(TWO)
        with pytest.raises(DocumentError, match=rf"{name}:1: a file that is named as "):
            read_record(tmp_path / name, unit="g")
        (tmp_path / name).write_text("t acc\n" + TWO)
        assert read_record(tmp_path / name, unit="g").unit == "g"


def test_a_list_of_factors_in_a_directory_is_no_motion(tmp_path):
    (tmp_path / "factors.txt").write_text("1.2\n-0.8\n0.5\n")
    (tmp_path / "motion.txt").write_text("acc [g]\n" + COLUMN)
    told: list[str] = []
    found = load_records([tmp_path], unit="g", dt=0.01, tell=told.append)
    assert [r.label for r in found] == ["motion"]
    assert told == [
        f"{tmp_path / 'factors.txt'}:1: 3 numbers, too few for a motion; they are taken"
        " where the file itself is named; left out"
    ]
    assert read_record(tmp_path / "factors.txt", unit="g", dt=0.01).npts == 3


# Patterns take the square or the cube of the characters of such a line, so that words
# are bounded before a pattern sees them.
@pytest.mark.parametrize(
    "begin", ["", "acc ", "component", "scale factor", "x\n", "1", "sampling rate"]
)
@pytest.mark.parametrize("mark", ' \t\n([{"1a.,;:=-_*#', ids=repr)
def test_a_line_of_words_is_bounded(tmp_path, begin, mark):
    path = tmp_path / "a"
    path.write_text(f"{begin}{mark * 60_000}@\n{COLUMN}")
    with pytest.raises(DocumentError) as found:
        read_record(path, unit="g", dt=0.01)
    assert len(str(found.value)) < 1000 + len(str(path))


def test_columns_are_as_many_as_a_file_has_them(tmp_path):
    path = tmp_path / "a.csv"
    names = ",".join(f"sensor {i}" for i in range(300))
    values = "".join(f"{i / 100:.2f}{',0.1' * 299},{i % 7 - 3}\n" for i in range(50))
    path.write_text(f"time,{names}\n{values}")
    assert read_record(path, unit="g", column="301").npts == 50
    path.write_text("  " + ",".join(f"{x:.6f}" for x in SAMPLES.tolist() * 10))
    assert read_record(path, unit="g", dt=0.01, column="all").npts == 4000


HEADS = st.sampled_from(
    [
        "t [s],a [g]",
        "T,Sa",
        "dt=0.01",
        "40",
        "# x",
        "a [m/s²]",
        ",t,a",
        "",
        "t;a",
        "()[]",
        "=:",
        "[g",
    ]
)
BITS = st.sampled_from(
    [
        "0.01,0.5",
        "0;0",
        "1,5;2",
        "x",
        "0.1 0.2 0.3",
        "0.10.2-0.3",
        '"1","2"',
        "-",
        "**",
        "nan",
        "1e400",
        "200",
        ",,",
        "\t1",
        "0,1",
        "2003-01-02T03:04:05,1",
        "end",
        "",
    ]
)


@given(heads=st.lists(HEADS, max_size=4), bits=st.lists(BITS, max_size=8))
@settings(max_examples=200, deadline=None)
def test_any_text_is_a_record_or_one_sentence(heads, bits):
    text = "\n".join([*heads, *bits])
    unit_and_step = {"unit": "g", "dt": 0.01}
    for more in ({}, {"column": "2"}, {"column": "all"}, {"skip": 1}):
        refused, found = "", None
        try:
            found = records_of("a", text.encode(), Given(**unit_and_step, **more))
        except RockingError as error:
            refused = str(error)
        assert found is None or found[0].npts >= 2
        assert not refused or (refused.startswith("a:") and "\n" not in refused)
