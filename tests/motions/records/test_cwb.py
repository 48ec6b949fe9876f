"""CWB: keys behind hash signs, and columns of time and three components."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.motions.records import read_records

SAMPLES = np.stack([wave(600, 12.25), wave(600, -1064.5), wave(600, -99999.125 / 128)], axis=1)


def written(
    path, *, values=SAMPLES, rate="50", unit="gal. DCoffset(corr)", length="12", step=0.02, form="4F10.3 ", lines=None, more="", order="UNE"
):
    keys = ["#Earthquake Information", "#Origin Time(GMT+08): 1900/01/02-03:04:05", "#Depth(km): 10.0", "", "#Station Information"]
    keys += ["#StationCode: ABC", f"#RecordLength(sec): {length}", f"#SampleRate(Hz): {rate}", f"#AmplitudeUnit:  {unit}"]
    for name, column in zip("UNE", values.T, strict=True):
        keys.append(f"#AmplitudeMAX. {name}: {column.max():8.3f}~ {column.min():8.3f}")
    keys += ["#DataSequence: Time " + "; ".join(f"{name}(+)" for name in order), f"#Data: {form}"]
    times = step * np.arange(len(values))
    text = "\n".join(keys) + "\n" + rows(np.column_stack([times, values]).ravel(), 4, "{:10.3f}") + more
    path.write_text("\n".join(text.splitlines()[:lines]) + "\n")
    return path


def test_three_components(tmp_path):
    records = read_records(written(tmp_path / "1-ABC.dat"))
    assert [r.component for r in records] == ["U", "N", "E"]
    for record, samples in zip(records, SAMPLES.T, strict=True):
        assert (record.format, record.dt, record.unit, record.remarks) == ("CWB", 0.02, "gal", ())
        np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(samples, "{:10.3f}"), rtol=1e-15)
        assert record.header_pga == pytest.approx(np.abs(record.acceleration).max(), rel=1e-9, abs=0)


def test_values_after_those_declared_are_a_remark(tmp_path):
    for record in read_records(written(tmp_path / "a", more="    12.000     0.000     0.000     0.000\n")):
        assert record.remarks == ("more values than the 600 declared, which are left out",)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"unit": "count"}, "a:9: AmplitudeUnit: found 'count'"),
        ({"unit": ""}, "a:9: no value of AmplitudeUnit"),
        ({"rate": "0"}, "a:8:"),
        ({"length": "12.01"}, "a:7: a number of values of 600.5"),
        ({"length": "14"}, "a:614: the file ends after 2400 of 2800 values"),
        ({"step": 0.01}, "a:7: 600 values every 0.01 s make 6 s, where the header states 12 s"),
        ({"length": "0"}, "a:15: found 0 values; expected at least two"),
        ({"form": "3F10.3"}, "a:14: Data: found '3F10.3' for a time and U, N, E"),
        ({"order": "", "form": "F10.3"}, "a:14: Data: found 'F10.3' for a time and "),
        ({"lines": 14}, "a:14: the file ends within its header"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, changed, words):
    assert words in refusal(written(tmp_path / "a", **changed))
