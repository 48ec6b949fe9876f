"""ESM and ITACA: 64 lines of keys, one value a line."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli.motions.records import read_record

SAMPLES = wave(1200, 87.5)
FORM = "{:.6f}"
KEYS = {
    "EVENT_NAME": "",
    "EVENT_ID": "XX-1900-0000",
    "EVENT_DATE_YYYYMMDD": "19000101",
    "EVENT_TIME_HHMMSS": "010203",
    "NETWORK": "XX",
    "STATION_CODE": "ABC",
    "STATION_NAME": "",
    "LOCATION": "",
    "VS30_M/S": "",
    "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": "19000101_010203.000",
    "SAMPLING_INTERVAL_S": "0.005000",
    "NDATA": "1200",
    "DURATION_S": "5.995000",
    "STREAM": "HNE",
    "UNITS": "cm/s^2",
    "INSTRUMENT": "sensor = X | digitizer = Y",
    "PGA_CM/S^2": "-87.500000",
    "TIME_PGA_S": "1.2",
    "BASELINE_CORRECTION": "BASELINE REMOVED",
    "FILTER_ORDER": "",
    "DATA_TYPE": "ACCELERATION",
}


def written(path, values=SAMPLES, **changed):
    keys = {**KEYS, **changed}
    keys |= {f"USER{i}": "" for i in range(1, 65 - len(keys))}
    lines = [f"{key}: {value}" for key, value in keys.items()]
    assert len(lines) == 64
    path.write_text("\n".join(lines) + "\n" + rows(values, 1, FORM))
    return path


def test_samples_peak_and_component(tmp_path):
    record = read_record(written(tmp_path / "XX.ABC..HNE.ASC"))
    assert (record.format, record.component, record.dt, record.remarks) == ("ESM", "HNE", 0.005, ())
    np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(SAMPLES, FORM), rtol=1e-15)
    assert record.header_pga == pytest.approx(0.875, rel=1e-14, abs=0)


@pytest.mark.parametrize("kind", ["PROCESSED ACCELERATION", "UNPROCESSED ACCELERATION"])
def test_the_first_header_of_itaca(tmp_path, kind):
    path = written(tmp_path / "19971014_152309ITDPC_NCR__WEX.DAT", DATA_TYPE=kind)
    path.write_text(path.read_text().replace("STREAM: HNE", "COMPONENT: WE"))
    record = read_record(path)
    assert record.component == "WE"
    np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(SAMPLES, FORM), rtol=1e-15)


def test_a_peak_that_the_samples_contradict_is_a_remark_with_both(tmp_path):
    (remark,) = read_record(written(tmp_path / "a", **{"PGA_CM/S^2": "-80.0"})).remarks
    assert "80" in remark
    assert "87.5" in remark


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"DATA_TYPE": "ACCELERATION RESPONSE SPECTRUM"}, "a:21: DATA_TYPE: found 'ACCELERATION RESPONSE SPECTRUM'"),
        ({"DATA_TYPE": "VELOCITY"}, "a:21: DATA_TYPE: found 'VELOCITY'"),
        ({"UNITS": "counts"}, "a:15: UNITS: found 'counts'"),
        ({"UNITS": ""}, "a:15: no value of UNITS"),
        ({"NDATA": "1201", "DURATION_S": "6"}, "a:1264: the file ends after 1200 of 1201 values"),
        ({"SAMPLING_INTERVAL_S": "0.0"}, "a:11: a time step of 0.0"),
        ({"DURATION_S": "59.95"}, "a:13: 1200 values every 0.005 s make 6 s, where the header states 59.95 s"),
        ({"NDATA": "many"}, "a:12: found 'many'"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, changed, words):
    assert words in refusal(written(tmp_path / "a", **changed))
