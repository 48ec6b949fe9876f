"""K-NET and KiK-net: counts about an offset, with the scale in the header."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import refusal, rows, wave

from rocking_cli.motions.records import read_record

COUNTS = np.rint(wave(3000, 40000.0) + 12567.0)
GAL = (COUNTS - COUNTS.mean()) * 3920.0 / 6182761.0
PEAK = f"{np.abs(GAL).max():.3f}"


HEADER = """Origin Time       1900/01/02 03:04:00
Lat.              35.0
Long.             139.0
Depth. (km)       10
Mag.              4.2
Station Code      XYZ001
Station Lat.      35.1
Station Long.     139.1
Station Height(m) 28
Record Time       1900/01/02 03:04:20
Sampling Freq(Hz) {rate}
Duration Time(s)  {duration}
Dir.              N-S
Scale Factor      {scale}
Max. Acc. (gal)   {peak}
Last Correction   1900/01/02 03:04:20
Memo.
"""


def written(path, *, values=COUNTS, scale="3920(gal)/6182761", rate="100Hz", duration="30", peak=PEAK):
    path.write_text(HEADER.format(scale=scale, rate=rate, duration=duration, peak=peak) + rows(values, 8, "{:8.0f} "))
    return path


def test_counts_become_an_acceleration_about_their_mean(tmp_path):
    record = read_record(written(tmp_path / "XYZ001.NS"))
    assert (record.format, record.component, record.dt, record.npts) == ("K-NET", "N-S", 0.01, 3000)
    np.testing.assert_allclose(record.acceleration, 1e-2 * GAL, rtol=1e-12, atol=1e-15)
    assert record.remarks == ()
    assert record.header_pga == pytest.approx(float(PEAK) * 1e-2, rel=1e-14, abs=0)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"scale": ""}, "a:14: no value of Scale Factor; expected a scale such as 7845(gal)/8223790, since counts have no unit"),
        ({"scale": "3920(gal)/0"}, "Scale Factor"),
        ({"rate": "0Hz"}, "a:11: a sampling frequency of 0"),
        ({"duration": "31"}, "a:392: the file ends after 3000 of 3100 values"),
        ({"values": COUNTS[:-3]}, "a:392: the file ends after 2997 of 3000 values"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, changed, words):
    assert words in refusal(written(tmp_path / "a", **changed))
