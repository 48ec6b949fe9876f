"""SMC (USGS): headers of fixed width, comments behind bars, and numbers of ten characters without a blank between."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.motions.records import read_record

SAMPLES = wave(805, -104.4)
NONE = 1.7e38


def short(x):
    """Ten characters as the USGS writes them: -1.2345E+0."""
    mantissa, exponent = f"{x:.4e}".split("e")
    return f"{mantissa:>7}E{int(exponent):+d}"


def written(
    path, *, values=SAMPLES, kind="2 CORRECTED ACCELEROGRAM", count=None, rate=200.0, peak=104.4, comments=3, lines=None, digits=-32768
):
    text = [kind, "*", "ABCD", "     1900  10  18    0004 Nowhere", "Moment Mag=      7.1", "station = Somewhere, F  component=    360"]
    text += [f"epicentral dist =     89.0       pk     = {peak:8.1f}", "inst type=SMA-1      data source = USGS", "*", "*", "*"]
    integers = np.full(48, -32768)
    integers[15], integers[16] = comments, len(values) if count is None else count
    integers[46] = digits
    reals = np.full(50, NONE)
    reals[1], reals[29], reals[31] = rate, peak, -0.5 * peak
    body = "\n".join(text) + "\n" + rows(integers, 8, "{:10d}") + rows(reals, 5, "{:15.7E}") + "| a comment\n" * comments
    printed = [short(x) for x in values]
    standard = "".join("".join(printed[i : i + 8]) + "\n" for i in range(0, len(printed), 8))
    body += rows(values, 5, "{:14.7E}") if digits == 8 else standard
    path.write_text("\n".join(body.splitlines()[:lines]) + "\n")
    return path


def test_numbers_of_ten_characters(tmp_path):
    record = read_record(written(tmp_path / "0001a.smc"))
    assert (record.format, record.component, record.dt, record.remarks) == ("SMC", "360", 0.005, ())
    np.testing.assert_allclose(record.acceleration, 1e-2 * np.array([float(short(x)) for x in SAMPLES]), rtol=1e-15)
    assert record.header_pga == pytest.approx(1.044, rel=1e-6, abs=0)


def test_numbers_of_eight_digits_where_the_header_says_so(tmp_path):
    record = read_record(written(tmp_path / "a", digits=8))
    np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(SAMPLES, "{:14.7E}"), rtol=1e-15)


def test_a_name_padded_with_nulls_and_no_comments(tmp_path):
    path = written(tmp_path / "a", comments=0)
    path.write_bytes(path.read_bytes().replace(b"ABCD", b"AB\0\0"))
    assert read_record(path).npts == 805


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"kind": "3 VELOCITY"}, "a:1: found '3 VELOCITY'; expected an accelerogram"),
        ({"kind": "0 UNKNOWN"}, "a:1: found '0 UNKNOWN'; expected an accelerogram"),
        ({"count": 806}, "a:131: found 5 numbers on a line; expected 6 (the header announces 806 values)"),
        ({"rate": 0.0}, "a sampling frequency of 0"),
        ({"rate": NONE}, "no sampling rate"),
        ({"lines": 60}, "a:60: the file ends after 240 of 805 values"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, changed, words):
    assert words in refusal(written(tmp_path / "a", **changed))
