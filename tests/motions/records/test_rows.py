"""Rows of numbers: first lines that are no samples, decimal commas, quotes, values in a
row.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.errors import RockingError
from rocking_cli.motions.records import Given, read_record, records_of

SAMPLES = wave(40, 0.5)
READ = 9.81 * as_printed(SAMPLES, "{:.6f}")
COLUMN = "".join(f"{x:.6f}\n" for x in SAMPLES)
TWO = "".join(f"{0.01 * i:.2f} {x:.6f}\n" for i, x in enumerate(SAMPLES))
STATED = {"unit": "g", "dt": 0.01}

LEADS = {
    "40\n": "40, the number of values",
    "40.000000\n": "40.000000, the number of values",
    "0.01\n": "0.01, the time step",
    "0.010000\n": "0.010000, the time step",
    "100\n": "100, the sampling rate",
    "40\n0.01\n": "40, the number of values and 0.01, the time step",
    "0.01\n40\n": "0.01, the time step and 40, the number of values",
    "40 0.01\n": "40, the number of values and 0.01, the time step",
    "# 40 100\n": "40, the number of values and 100, the sampling rate",
    "40\nacc [g]\n": "40, the number of values",
}


@pytest.mark.parametrize(("lead", "said"), LEADS.items())
def test_a_count_step_or_rate_above_a_column_is_told(tmp_path, lead, said):
    (tmp_path / "a").write_text(lead + COLUMN)
    record = read_record(tmp_path / "a", **STATED)
    assert record.remarks == (f"above the samples stand {said}",)
    np.testing.assert_array_equal(record.acceleration, READ)


@pytest.mark.parametrize(
    "lead",
    [
        "200\n",
        "200.0\n",
        "0.005\n",
        "0.005000\n",
        "41\n",
        "0.005\n40\n",
        "40 0.005\n",
        "200 0.005\n",
        "0.02\n",
    ],
)
def test_a_first_number_that_may_be_no_sample_is_refused(tmp_path, lead):
    for stated in (STATED, {"unit": "g"}):
        found = refusal(tmp_path / "a", lead + COLUMN, **stated)
        assert "above the others; it may be the" in found
        assert found.startswith(f"{tmp_path / 'a'}:")


@pytest.mark.parametrize(
    "first", ["0.000000\n", "0\n", "0.012345\n", "-0.010000\n", "0.499999\n0.490000\n"]
)
def test_a_first_sample_stays_one(tmp_path, first):
    (tmp_path / "a").write_text(first + COLUMN)
    assert read_record(tmp_path / "a", **STATED).npts == 40 + first.count("\n")


@pytest.mark.parametrize("lead", ["40\n", "40 0.01\n", "100\n"])
def test_a_count_or_step_above_two_columns_is_told(tmp_path, lead):
    (tmp_path / "a").write_text(lead + TWO)
    record = read_record(tmp_path / "a", unit="g")
    assert record.remarks[0].startswith("above the samples stand ")
    np.testing.assert_array_equal(record.acceleration, READ)
    assert "50 above the others" in refusal(tmp_path / "a", "50\n" + TWO, unit="g")


def in_commas(text):
    return text.replace(".", ",")


COMMAS = {
    "semicolons": ("t [s];a [g]\n" + in_commas(TWO).replace(" ", ";"), {}),
    "tabs": ("t [s]\ta [g]\n" + in_commas(TWO).replace(" ", "\t"), {}),
    "blanks": ("t [s] a [g]\n" + in_commas(TWO), {}),
    "one column": ("a [g]\n" + in_commas(COLUMN), {"dt": 0.01}),
    "one column without a heading": (in_commas(COLUMN), STATED),
    "whole numbers first": (
        "t [s];a [g]\n0;0\n" + in_commas(TWO).replace(" ", ";").partition("\n")[2],
        {},
    ),
    "quotes": (
        '"t [s]";"a [g]"\n'
        + "".join(
            f'"{in_commas(line)}"\n'.replace(" ", '";"') for line in TWO.splitlines()
        ),
        {},
    ),
    "points and quotes": (
        '"t [s]","a [g]"\n'
        + "".join(f'"{line}"\n'.replace(" ", '","') for line in TWO.splitlines()),
        {},
    ),
    "commas and quotes": (
        '"t [s]","a [g]"\n'
        + "".join(
            f'"{in_commas(line)}"\n'.replace(" ", '","') for line in TWO.splitlines()
        ),
        {},
    ),
    "empty cells at each end": (
        "t [s],a [g],,\n" + TWO.replace(" ", ",").replace("\n", ",,\n"),
        {},
    ),
    "a separator at each end": (
        "t [s];a [g];\n" + in_commas(TWO).replace(" ", ";").replace("\n", ";\n"),
        {},
    ),
    "minus signs of a word processor": ("t [s] a [g]\n" + TWO.replace("-", "−"), {}),
}


@pytest.mark.parametrize(("text", "given"), COMMAS.values(), ids=COMMAS)
def test_decimal_commas_and_quotes(tmp_path, text, given):
    (tmp_path / "a").write_text(text, encoding="utf-8")
    record = read_record(tmp_path / "a", **given)
    assert record.dt == pytest.approx(0.01, rel=2e-15)
    np.testing.assert_array_equal(record.acceleration, READ)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "t;a [g]\n0;0\n0,01;0.5\n0,02;0,1\n",
            "a:3: found '0,01', which is no finite number",
        ),
        (
            "t;a [g]\n0;1.000,5\n0,01;0,5\n",
            "a:2: found '1.000,5', which is no finite number",
        ),
        (
            "t,NS [g],EW [g]\n0,1,2\n0.01,,2\n0.02,1,2\n",
            "a:3: an empty cell between two numbers",
        ),
        (
            "t,a [g]\n0.00x,0\n0.01,1\n0.02,2\n",
            "a:2: found '0.00x,0' above the numbers, which is not understood",
        ),
        (
            "t a [g]\n0 1\n0.01 1 2\n0.02\n0.03 1\n",
            "a:3: found 3 numbers, 2 on the lines before",
        ),
        (
            "t a [g]\n" + TWO.replace("0.20 ", "0.205 "),
            "times that do not rise in even steps",
        ),
        (
            "t a [g]\n" + "\n".join(x for x in TWO.splitlines() if x[:4] != "0.20"),
            "a:22: times that do not rise in even steps, such as 0.21 s",
        ),
    ],
)
def test_faults_of_rows_are_told_with_their_line(tmp_path, text, words):
    assert words in refusal(tmp_path / "a", text)


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("NUMBER OF POINTS: 40\nDT: 0.01 s\nin g\n" + rows(SAMPLES, 8, "{:11.6f}"), {}),
        (
            "acceleration in g\n" + rows(SAMPLES, 7, "{:11.6f}"),
            {"dt": 0.01},
        ),  # five on the last line
        (
            "acceleration in g\n" + rows(SAMPLES, 4, "{:11.6f}"),
            {"dt": 0.01, "column": "all"},
        ),
    ],
)
def test_several_values_a_line(tmp_path, text, given):
    (tmp_path / "a").write_text(text)
    record = read_record(tmp_path / "a", **given)
    assert record.dt == 0.01
    np.testing.assert_array_equal(record.acceleration, READ)


def test_a_table_that_ends_in_a_line_is_no_row_of_values(tmp_path):
    for columns in (3, 4):
        text = rows(SAMPLES[: 8 * columns + 1], columns, "{:11.6f}")
        assert f"found 1 numbers, {columns} on the lines before" in refusal(
            tmp_path / "a", text, **STATED, column="2"
        )
    assert "5 columns without headings" in refusal(
        tmp_path / "a", rows(SAMPLES, 5, "{:11.6f}"), **STATED
    )


PAIRS = "".join(
    f"{0.02 * i:.2f} {x:.6f} {0.02 * i + 0.01:.2f} {x:.6f}\n"
    for i, x in enumerate(SAMPLES)
)


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        (TWO, "all", "a:1: the first numbers of the lines rise evenly, as times do"),
        (PAIRS, "all", "a:1: the first numbers of the lines rise evenly"),
        (
            PAIRS,
            "2",
            "a:1: columns 1 and 3 rise alike, as times do; expected one time a line",
        ),
    ],
)
def test_times_are_not_taken_for_values(tmp_path, text, column, words):
    assert words in refusal(tmp_path / "a", text, unit="g", dt=0.01, column=column)


@pytest.mark.parametrize("mark", ["-999", "-9999.0", "99999", "999.9"])
def test_a_mark_of_a_missing_value_is_refused(tmp_path, mark):
    text = TWO.replace(TWO.split()[11], mark)
    assert f"sample 6 is {float(mark):.10g}, which marks a missing value" in refusal(
        tmp_path / "a", text, unit="g"
    )


HEADS = st.sampled_from(
    [
        "t [s],a [g]",
        "T,Sa",
        "dt=0.01",
        "units: gal",
        "40",
        "# x",
        "a [m/s²]",
        "NPTS=40",
        "",
        "t;a",
        "scale = 2",
        "()[]",
        "=:",
    ]
)
BITS = st.sampled_from(
    [
        "0.01,0.5",
        "0;0",
        "1,5;2",
        "x",
        "0.1 0.2 0.3",
        '"1","2"',
        "-",
        "**",
        "nan",
        "1e400",
        "200",
        ",,",
        "\t1",
        "0,1",
        "",
    ]
)


@given(heads=st.lists(HEADS, max_size=4), bits=st.lists(BITS, max_size=8))
@settings(max_examples=150, deadline=None)
def test_any_text_is_a_record_or_one_sentence(heads, bits):
    text = "\n".join([*heads, *bits])
    for stated in ({}, STATED, {**STATED, "column": "2"}):
        refused, found = "", None
        try:
            found = records_of("a", text.encode(), Given(**stated))
        except RockingError as error:
            refused = str(error)
        assert found is None or found[0].npts >= 2
        assert not refused or (refused.startswith("a:") and "\n" not in refused)
