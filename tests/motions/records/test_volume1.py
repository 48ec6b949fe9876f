"""Volume 1: uncorrected accelerograms as values that announce themselves, as pairs with their times, and as values alone."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.motions.records import read_records

SAMPLES = wave(733, -0.9875)  # g; -0.987500 fills its nine characters


def header(channel, units, values, *, count=None, length=None, first="Uncorrected Accelerogram Data   Processed: 01/02/00, XYZ"):
    """13 lines of text and 14 of numbers, which touch in places."""
    count, length = len(values) if count is None else count, len(values) / 200 if length is None else length
    lines = [first, "Record of Sun Jan  2, 1900 13:06:45.0 PST", "", "12345-X0001", "Station No. 12345   40.000N, 120.000W", "Somewhere"]
    lines += [channel, "", "", "Instr Period =  .0109 sec,  Damping =  .670,  Sensitivity =  .63  v/g"]
    lines += [f"No. of Points = {count:6d}  Record Length ={length:7.3f} sec   at 200 Samples/sec"]
    lines += [
        f"{units}        Max  = {values[np.argmax(np.abs(values))]:7.4f} g , at  30.590 sec.",
        "RMS calc for complete record =        .",
    ]
    reals = np.full(50, -999.0)
    reals[0], reals[6] = 0.019, 200.0
    reals = rows(reals, 6, "{:13.6E}") if first.startswith("*") else rows(reals, 8, "{:10.5f}")
    return "\n".join(lines) + "\n" + rows(np.arange(100), 16, "{:5d}") + "".join(reals.splitlines(keepends=True)[:7])


def announced(channel, values=SAMPLES, *, count=None, length=None, unit="g ", rate=200, points=None):
    n = len(values)
    text = header(f"Chan  1: {channel}", "Units of uncor data are sec and g .", values, count=count, length=length)
    text += f"{n if points is None else points:6d} Accelerogram points at {rate} pts/sec in units of {unit}.      Format: (8f9.6)  \n"
    return text + rows(values, 8, "{:9.6f}") + "/&  ----------  End of Data for Channel  1  ----------\n"


def paired(channel, values, *, uneven=0.0):
    times = 0.005 * np.arange(len(values))
    times[11] += uneven
    text = header(f"CHAN  1: {channel}        (STA CHN:  1)", "UNITS OF UNCOR ACCEL ARE SEC AND G/10.", values)
    return text.upper() + rows(np.stack([times, 10.0 * values], axis=1).ravel(), 10, "{:7.3f}") + "/&  ----------  END\n"


def alone(channel, values, *, length=None):
    text = header(f"COMP {channel}", "UNITS ARE SECONDS AND G/10", values, length=length, first="* VOL1DS FILE:  1/01")
    return text.replace("Record Length", "    DURATION") + rows(10.0 * values, 10, "{:13.6E}") + "/&\n"


@pytest.mark.parametrize(("write", "form", "ten"), [(announced, "{:9.6f}", 1.0), (paired, "{:7.3f}", 10.0), (alone, "{:13.6E}", 10.0)])
def test_channels_are_read_and_said_to_be_uncorrected(tmp_path, write, form, ten):
    path = tmp_path / "a.V1"
    path.write_text(write("360 Deg", SAMPLES) + write("Up", -SAMPLES / 3))
    for record, samples, component in zip(read_records(path), (SAMPLES, -SAMPLES / 3), ("360 Deg", "Up"), strict=True):
        assert (record.format, record.dt, record.unit, record.remarks) == ("Volume 1", 0.005, "g", ("an uncorrected accelerogram",))
        assert record.component.casefold() == component.casefold()
        np.testing.assert_allclose(record.acceleration, 9.81 / ten * as_printed(ten * samples, form), rtol=1e-15)
        assert record.header_pga == pytest.approx(9.81 * np.abs(samples).max(), abs=9.81 * 0.5e-4)  # as printed


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (paired("L", SAMPLES, uneven=0.001), "a:30: times that do not rise in even steps, such as 0.056 s"),
        (header("CHAN 1: L", "UNITS OF UNCOR ACCEL ARE SEC AND G/10.", SAMPLES, count=0, length=0.0), "a:28: found 0 values"),
        (announced("Up", unit="cm/sec2 "), None),
        (announced("Up", unit="counts"), "a:28: found the unit 'counts'"),
        (announced("Up", points=732), "a:28: 732 points, where the header states 733"),
        (announced("Up", length=3.0), "733 values every 0.005 s make 3.665 s, where the header states 3.000 s"),
        (announced("Up").replace("(8f9.6)", ""), "a:28: found '733 Accelerogram points at 200"),
        (announced("Up", rate=0), "a:28:"),
        (announced("Up").replace("No. of Points", "Points"), "no line `No. of Points = n"),
        (alone("V", SAMPLES, length=36.65), "733 values every 0.005 s make 3.665 s, where the header states 36.650 s"),
        ("\n".join(announced("Up").splitlines()[:60]) + "\n", "a:60: the file ends after 256 of 733 values"),
        ("\n".join(announced("Up").splitlines()[:20]), "a:20: the file ends within its header"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, text, words):
    path = tmp_path / "a"
    path.write_text(text)
    if words is None:  # another unit is read, and the peak in g is not held against it
        assert [(r.unit, r.header_pga) for r in read_records(path)] == [("cm/s2", None)]
        return
    assert words in refusal(path)
