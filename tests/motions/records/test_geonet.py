"""GeoNet V2A and V1A: three components a file, ten numbers of eight characters a line."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave, with_a_line_missing_or_twice

from rocking_cli.motions.records import read_records

FORM = "{:8.1f}"
SAMPLES = wave(1234, 11024.7)  # -11024.7 fills its eight characters


HEADER = """{first} 19000102_030405_ABCD_20 GNS Science
Site ABCD      42 37 10S  173 03 13E
A Farm
Instrument X_1
Resolution: 18-bit
Accelerogram 19000102
5 km south-west of Nowhere
1900 January 02
Epicentre
Number of points {points:5d}    Duration {duration:.2f} sec
Instrument corrected data at {dt:.3f} sec intervals
Band-pass filter
Component {name}  Longitudinal Accelerometer Axis
Acceleration:  peak {peak:9.1f} mm/s/s at  44.88 sec     rms    719.0 mm/s/s
Velocity:      peak -1016.55 mm/s
Displacement:
"""


def component(name, values, *, dt=0.02, first="Corrected accelerogram", **changed):
    n = len(values)
    said = {"points": n, "duration": (n - 1) * dt, "peak": values[np.argmax(np.abs(values))], **changed}
    integers, reals = np.zeros(40), np.zeros(60)
    integers[33:36] = n, n, 3
    reals[24], reals[25] = 0.005, dt
    text = HEADER.format(first=first, name=name, dt=dt, **said) + rows(integers, 10, "{:8.0f}") + rows(reals, 10, "{:8.4f}")
    return text + rows(values, 10, FORM) + rows(values / 10, 10, FORM) + rows([1.0, 2.0, 3.0], 10, FORM)


def uncorrected(name, values, unit="1.00"):
    """As V1A is: no velocities and displacements, whose numbers of values are 0."""
    lines = component(name, values, first="Uncorrected accelerogram").splitlines(keepends=True)
    lines[10] = f"Raw readings in units of {unit} mm/s/s  at intervals of 0.020 s\n"
    lines[19] = lines[19][:32] + rows([0.0] * 6, 6, "{:8.0f}")
    return "".join(lines[: 26 - (-len(values) // 10)])


def test_uncorrected_as_v1a_has_them(tmp_path):
    path = tmp_path / "a.V1A"
    path.write_text(uncorrected("N40W", SAMPLES / 2) + uncorrected("Up", SAMPLES / 7))
    first, second = read_records(path)
    assert (first.component, second.component, first.dt) == ("N40W", "Up", 0.02)
    assert first.remarks == second.remarks == ("an uncorrected accelerogram",)
    np.testing.assert_allclose(first.acceleration, 1e-3 * as_printed(SAMPLES / 2, FORM), rtol=1e-15)
    np.testing.assert_allclose(second.acceleration, 1e-3 * as_printed(SAMPLES / 7, FORM), rtol=1e-15)


def test_three_components_whose_numbers_touch(tmp_path):
    path = tmp_path / "a.V2A"
    shaken = {"N28W": np.minimum(SAMPLES, 9999.0), "S62W": -SAMPLES / 3, "Up": SAMPLES / 7}
    path.write_text("".join(component(name, x) for name, x in shaken.items()))
    records = read_records(path)
    assert [r.component for r in records] == list(shaken)
    for record, samples in zip(records, shaken.values(), strict=True):
        assert (record.format, record.dt, record.remarks) == ("GeoNet", 0.02, ())
        np.testing.assert_allclose(record.acceleration, 1e-3 * as_printed(samples, FORM), rtol=1e-15)
        assert record.header_pga == pytest.approx(np.abs(record.acceleration).max(), rel=1e-6, abs=0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (component("Up", SAMPLES / 2, points=1235), "a:10: 1235 points, where the header states 1234"),
        (component("Up", SAMPLES / 2, duration=30.0), "a:10: 1234 values every 0.02 s make 24.68 s, where the header states 30.00 s"),
        (component("Up", SAMPLES / 2, dt=0.0, duration=24.66), "a time step of 0"),
        (uncorrected("Up", SAMPLES / 2, unit="0.10"), "a:11: raw readings in units of 0.10 mm/s/s; expected units of 1"),
        ("\n".join(component("Up", SAMPLES / 2).splitlines()[:60]) + "\n", "a:60: the file ends after 340 of 1234 values"),
        (component("Up", SAMPLES / 2) + "\n".join(component("N", SAMPLES / 2).splitlines()[:20]), "the file ends after"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, text, words):
    assert words in refusal(tmp_path / "a", text)


@pytest.mark.parametrize("count", [37, 40])
def test_a_line_of_numbers_missing_or_twice_loses_no_component(tmp_path, count):
    text = component("N", wave(count, 900.0)) + component("E", wave(count, 800.0)) + component("Up", wave(count, 70.0))
    for number, spoilt in with_a_line_missing_or_twice(text):
        assert refusal(tmp_path / "a", spoilt).count(":") >= 2, number


def test_a_component_without_its_first_line_is_not_passed_over(tmp_path):
    lines = component("E", SAMPLES / 2).splitlines(keepends=True)
    first = component("N", SAMPLES / 2)
    words = f"a:{first.count(chr(10)) + 1}: found 'Site ABCD      42 37 10S  173 03 13E'; expected the first line of a component"
    assert words in refusal(tmp_path / "a", first + "".join(lines[1:]) + component("Up", SAMPLES / 2))
