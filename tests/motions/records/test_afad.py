"""AFAD (NSMN): three columns in gal below lines of keys, in latin-1."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, wave

from rocking_cli.errors import UsageError
from rocking_cli.motions.records import read_record, read_records

SAMPLES = np.stack([wave(700, 120.25), wave(700, -64.5), wave(700, 3.125)], axis=1)
FORM = "{:13.6f}"


def written(path, *, values=SAMPLES, count=700, dt="0.01", title="STRONG GROUND MOTION RECORDS OF TURKIYE", unit="gal", lines=None):
    text = [title, "PLACE                   : KüTAHYA ÇIğLI", "EARTHQUAKE DATE         : 1900/01/02 03:04:05 (GMT)"]
    text += ["EPICENTER COORDINATES   : 36.9N-27.4E", "STATION ID              : 0001", f"NUMBER OF DATA          : {count}"]
    text += [
        f"SAMPLING INTERVAL (sec) : {dt}",
        f"RAW PGA VALUES ({unit})    : (N-S) 120.25 (E-W) 64.5 (U-D) 3.125",
        "Copyright EARTHQUAKE DEPARTMENT",
    ]
    text += ["       N-S          E-W          U-D"] + ["".join(FORM.format(x) for x in row) for row in values]
    path.write_bytes(("\n".join(text[:lines]) + "\n").encode("latin-1", "replace"))
    return path


def test_three_columns(tmp_path):
    records = read_records(written(tmp_path / "19000102_0001.txt"))
    assert [r.component for r in records] == ["N-S", "E-W", "U-D"]
    for i, record in enumerate(records):
        assert (record.format, record.dt, record.remarks) == ("AFAD", 0.01, ())
        np.testing.assert_allclose(record.acceleration, 1e-2 * as_printed(SAMPLES[:, i], FORM), rtol=1e-15)
    assert [r.header_pga for r in records] == pytest.approx([1.2025, 0.645, 0.03125], rel=1e-14, abs=0)


def test_one_of_several_components_has_to_be_named(tmp_path):
    path = written(tmp_path / "a")
    assert read_record(path, component="e-w").component == "E-W"
    with pytest.raises(UsageError, match="holds the components N-S, E-W, U-D"):
        read_record(path)
    with pytest.raises(UsageError, match="found 'NS'; expected N-S, E-W, U-D"):
        read_record(path, component="NS")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"count": 701}, "a:710: the file ends after 2100 of 2103 values"),
        ({"count": ""}, "a:6: no value of NUMBER OF DATA"),
        ({"dt": "0"}, "a:7: a time step of 0"),
        ({"unit": "cm/s"}, "a:8: found 'RAW PGA VALUES (CM/S)'"),
        ({"lines": 9}, "a:9: the file ends within its header"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, changed, words):
    assert words in refusal(written(tmp_path / "a", **changed))
