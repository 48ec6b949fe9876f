"""Plain columns of numbers: their unit, and the step of a single column, have to be
given.
"""

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, wave

from rocking_cli.errors import DocumentError
from rocking_cli.motions.records import read_record

SAMPLES = wave(400, 2.5)
READ = as_printed(SAMPLES, "{:.6f}")
COLUMN = "".join(f"{x:.6f}\n" for x in SAMPLES)


@pytest.mark.parametrize("separator", [",", ";", "\t", "   ", ", ", "  ,\t"])
@pytest.mark.parametrize(
    "title", ["", "Time[s]{}Accel[m/s^2]\n", "# made up\n# by hand\nt{}a\n\n"]
)
def test_two_columns(tmp_path, separator, title):
    path = tmp_path / "motion.csv"
    path.write_text(
        title.format(separator)
        + "".join(f"{0.01 * i:.3f}{separator}{x:.6f}\n" for i, x in enumerate(SAMPLES))
    )
    record = read_record(path, unit="m/s2")
    assert (record.format, record.dt, record.header_pga) == ("text", 0.01, None)
    np.testing.assert_array_equal(record.acceleration, READ)


ROWS = [f"{0.01 * i:.2f} {x:.6f}" for i, x in enumerate(SAMPLES)]
IN_MS = "".join(f"{10 * i} {x:.6f}\n" for i, x in enumerate(SAMPLES))
SAME = {
    "a title that begins with a number": (
        "1940 Nowhere NS\n2 400 points every 0.02 s\n" + COLUMN,
        {"unit": "m/s2", "dt": 0.02},
        1.0,
    ),
    "one column": (COLUMN, {"unit": "g", "dt": 0.02}, 9.81),
    "decimal commas between semicolons": (
        "".join(f"{row}\n" for row in ROWS).replace(" ", ";").replace(".", ","),
        {"unit": "m/s2"},
        1.0,
    ),
    "blank lines between the numbers": (
        "Time,Accel\n\n" + "\n".join([*ROWS[:200], "", "", *ROWS[200:]]),
        {"unit": "m/s2"},
        1.0,
    ),
    "a heading with units": (
        "Waveform\nTime [s],Acc [g]\n" + "\n".join(ROWS).replace(" ", ","),
        {},
        9.81,
    ),
    "a heading with times in ms": ("t (ms) a (cm/sec^2)\n" + IN_MS, {}, 0.01),
    "a heading with times in ms alone": (
        "t [ms], a\n# by hand\n" + IN_MS,
        {"unit": "m/s2"},
        1.0,
    ),
    "a heading above a remark": (
        "Time,Acc\n(s),(g)\n# filtered\n" + "\n".join(ROWS),
        {},
        9.81,
    ),
    "a heading of one column": ("a (g)\n" + COLUMN, {"dt": 0.02, "unit": "g"}, 9.81),
    "a heading that says no quantity": (
        "Time (s) Pulse (unfiltered)\n" + "\n".join(ROWS),
        {"unit": "g"},
        9.81,
    ),
    "options that agree": (
        "Time (s),Acc (g)\n" + "\n".join(ROWS).replace(" ", ","),
        {"unit": "g", "dt": 0.01},
        9.81,
    ),
}


@pytest.mark.parametrize(("text", "given", "factor"), SAME.values(), ids=SAME)
def test_other_ways_to_write_them(tmp_path, text, given, factor):
    (tmp_path / "motion.txt").write_text(text)
    record = read_record(tmp_path / "motion.txt", **given)
    np.testing.assert_array_equal(record.acceleration, factor * READ)
    assert record.duration == pytest.approx(399 * given.get("dt", 0.01))


@pytest.mark.parametrize("step", [1, 10])
def test_a_first_column_that_can_hardly_be_seconds_is_a_remark(tmp_path, step):
    (tmp_path / "a").write_text(
        "".join(f"{step * i} {x:.6f}\n" for i, x in enumerate(SAMPLES))
    )
    record = read_record(tmp_path / "a", unit="m/s2")
    assert (record.dt, record.remarks) == (
        step,
        (f"a time step of {step} s, which is unusually long",),
    )


@pytest.mark.parametrize(
    ("factor", "unit", "remarks"),
    [
        (0.3, "m/s2", ()),
        (0.3, "g", ()),
        (
            0.3,
            "gal",
            ("a PGA of 0.000765 g, where the unit is taken to be gal",),
        ),  # m/s2 or g taken for gal
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
            "a: one column of numbers without times; give their step as `dt`",
        ),
        (
            lines(),
            {"unit": "g", "dt": 0.02},
            "a: `dt`: found 0.02 s; the file says otherwise: times every 0.01 s",
        ),
        ("1 2 3\n4 5 6\n", {"unit": "g"}, "a:1: 3 columns"),
        (
            "t [s], acc [g]\n" + lines(),
            {"unit": "m/s2"},
            (
                "a: `unit`: found m/s2; the file says otherwise: g, which the heading"
                " 'acc [g]' states"
            ),
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
            "a:1: found 'Displ. [cm]' (displacement); expected an acceleration",
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


def test_words_are_as_long_as_a_header_has_them(tmp_path):
    title = "station of the network, a hill of Lixouri " * 100
    path = tmp_path / "a"
    path.write_text(f"{title[:1000]}\n{COLUMN}")
    assert read_record(path, unit="g", dt=0.01).npts == SAMPLES.size
    assert "a:1: found 1001 characters, 'station of" in refusal(
        path, f"{title[:1000]}x\n{COLUMN}", unit="g", dt=0.01
    )


def test_columns_are_as_many_as_a_file_has_them(tmp_path):
    path = tmp_path / "a.csv"
    names = ",".join(f"sensor {i}" for i in range(300))
    values = "".join(f"{i / 100:.2f}{',0.1' * 299},{i % 7 - 3}\n" for i in range(50))
    path.write_text(f"time,{names}\n{values}")
    assert read_record(path, unit="g", column="301").npts == 50
    path.write_text("  " + ",".join(f"{x:.6f}" for x in SAMPLES.tolist() * 10))
    assert read_record(path, unit="g", dt=0.01, column="all").npts == 4000


@pytest.mark.parametrize("below", [COLUMN, COLUMN.replace("\n", " 1 2\n")])
@pytest.mark.parametrize(
    "above", [f"{'1 ' * 201}\n", f"{'1 ' * 9000}\n", 300 * "1 2\n"]
)
def test_more_numbers_than_a_count_a_step_and_a_rate(tmp_path, above, below):
    words = refusal(tmp_path / "a", above + below, unit="g", dt=0.01)
    assert "a:1: found " in words
    assert " above " in words
