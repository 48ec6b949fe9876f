"""COSMOS: headers that say how they are written, and a step that is value 62 and not 34."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave, with_a_line_missing_or_twice

from rocking_cli.documents.quantities import DEFAULT_GRAVITY
from rocking_cli.motions.records import read_record, read_records

SAMPLES = wave(2000, 161.962)


HEADER = """Corrected {quantity}    (Format v01.20 with 13 text lines) Src: none
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


def channel(
    values=SAMPLES, *, quantity="acceleration", unit="cm/sec2(04)", form="8F10.5", header="6F13.6",
    step=10.0, raw=0.005, length=20.0, count=None,
):  # fmt: skip
    reals = np.full(100, -999.0)
    reals[33], reals[61], reals[62], reals[63] = raw, step, length, values[np.argmax(np.abs(values))]
    columns, rest = header.split("F")
    printed = rows(reals, int(columns), f"{{:{rest}f}}")
    text = HEADER.format(
        integers=rows([-999] * 100, 10, "{:8d}"), lines=printed.count("\n"), reals=printed, count=len(values) if count is None else count,
        quantity=quantity, header=header, length=length, unit=unit, form=form,
    )  # fmt: skip
    per_line, width = form.replace("E", "F").split("F")
    return text + rows(values, int(per_line), f"{{:{width}{'e' if 'E' in form else 'f'}}}") + "End-of-data for Chan  1 acceleration\n"


@pytest.mark.parametrize("header", ["6F13.6", "5F15.6"])
@pytest.mark.parametrize(("form", "printed"), [("8F10.5", "{:10.5f}"), ("1E15.6", "{:15.6e}")])
def test_samples_step_and_peak(tmp_path, header, form, printed):
    path = tmp_path / "a.V2c"
    path.write_text(channel(form=form, header=header))
    record = read_record(path)
    assert (record.format, record.component, record.dt, record.remarks) == ("COSMOS", "340 deg", 0.01, ())
    np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(SAMPLES, printed), rtol=1e-15)
    assert record.header_pga == pytest.approx(1.61962, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("changed", "factor", "printed"),
    [
        ({"unit": "cm/s^2"}, 1e-2, "{:10.5f}"),
        ({"unit": "cm/s^2 (4)", "form": "10F8.3"}, 1e-2, "{:8.3f}"),  # neighbours touch
        ({"unit": "g.     (02)"}, DEFAULT_GRAVITY, "{:10.5f}"),
        ({"unit": "gal(04)"}, 1e-2, "{:10.5f}"),
        ({"quantity": "uncor. accel."}, 1e-2, "{:10.5f}"),
    ],
)
def test_how_writers_name_the_unit_and_the_block(tmp_path, changed, factor, printed):
    path = tmp_path / "a.V1c"
    path.write_text("".join(f"{line:<80}\n" for line in channel(**changed).splitlines()))  # card images
    np.testing.assert_allclose(read_record(path).acceleration, factor * as_printed(SAMPLES, printed), rtol=1e-15)


def test_other_quantities_in_the_file_are_passed_over(tmp_path):
    path = tmp_path / "a.V2c"
    path.write_text(channel(-SAMPLES, quantity="velocity", unit="cm/sec(05)") + channel())
    (record,) = read_records(path)
    np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(SAMPLES, "{:10.5f}"), rtol=1e-15)


def test_a_length_that_leaves_out_the_last_step_agrees(tmp_path):
    path = tmp_path / "a.V2c"
    path.write_text(channel(length=19.99))
    assert read_record(path).duration == pytest.approx(19.99)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (channel(step=5.0), "a:46: 2000 values every 0.005 s make 10 s, where the header states 20 s"),
        (channel(length=72.0), "2000 values every 0.01 s make 20 s, where the header states 72 s"),
        (channel(step=0.0), "a:46: a time step of 0"),
        (channel(quantity="velocity", unit="cm/sec(05)"), "no acceleration, only velocity in cm/sec"),
        (channel(unit="counts(50)"), "found the unit 'counts' (50)"),
        (channel(unit="in/sec2"), "a:46: found the unit 'in/sec2' (no code); expected cm/s2 (04)"),
        (channel(unit="g(04)"), "a:46: found the unit 'g' with the code 04, which is cm/s2"),
        (channel(count=2008, length=20.08), "after 2000 of 2008 values"),
        (channel().replace("Real-header", "Imaginary"), "100 real-header values follow"),
        ("\n".join(channel().splitlines()[:20]), "a:20: the file ends after 60 of 100 values"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, text, words):
    assert words in refusal(tmp_path / "a", text)


@pytest.mark.parametrize("count", [45, 48])
def test_a_line_of_numbers_missing_or_twice_is_told(tmp_path, count):
    text = channel(wave(count, 99.0), length=count / 100) + channel(
        wave(count, 9.0), length=count / 100, quantity="velocity", unit="cm/sec(05)"
    )
    told = [refusal(tmp_path / "a", spoilt) for _, spoilt in with_a_line_missing_or_twice(text)]
    assert len(told) == 2 * 2 * (10 + 17 + 6)
