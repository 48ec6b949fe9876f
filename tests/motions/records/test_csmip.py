"""CSMIP volume 2: fixed columns in which numbers touch, several channels of three blocks each."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave, with_a_line_missing_or_twice

from rocking_cli.motions.records import read_record, read_records

FORM = "{:10.5f}"
SAMPLES = wave(997, 1234.56789)  # -1234.56789 fills its ten columns and one more
TOUCHING = np.clip(SAMPLES, -999.0, 9999.0)


def channel(
    number, degrees, values, *, dt="  .010", precise=0.01, unit="cm/sec2", form="(8f10.5)", peak=None, points=None, length=None,
    blocks="avd",
):  # fmt: skip
    peak = np.abs(values).max() if peak is None else peak
    n = len(values)
    title = f"Corrected accelerogram   12345-X0001-00001.02       Chan{number:3d}: {degrees:3d} Deg     from   "
    header = [
        title, "Uncorrected Accelerogram Data             Processed: 01/02/00, XYZ", "Record of Sun Jan  2, 1900 13:06:45.0 PST", "", "",
        "Station No. 12345   40.000N, 120.000W      Etna  s/n 1", "Somewhere", f"Chan{number:3d}: {degrees:3d} Deg",
        "", "", "Instr Period =  .0109 sec,  Damping =  .670,  Sensitivity =  .63  v/g",
        f"                        Record length = {n * precise if length is None else length:.3f} sec.", "", "", "",
        f"{n if points is None else points:6d} points of instrument- and baseline-corrected accel, veloc and displ data",
        f"At equally-spaced intervals of  {dt}  sec.", f"Peak acceleration = {peak:9.3f}    cm/sec/sec  at   30.585   sec.",
        "Peak   velocity   =     3.150      cm/sec    at   30.650   sec.", "Peak displacement =      .165        cm",
        "Initial velocity  =      .000   cm/sec;   Initial displacement =     .000   cm", "", "", "", "",
    ]  # fmt: skip
    reals = np.zeros(100)
    reals[60] = precise
    text = "\n".join(header) + "\n" + rows(np.arange(100), 16, "{:5d}").replace("   -1", " -999") + rows(reals, 8, "{:10.7f}")
    for kind, word, of in (("a", "accel", unit), ("v", "veloc", "cm/sec"), ("d", "displ", "cm")):
        if kind in blocks:
            text += f"{n:6d} points of {word} data equally spaced at {dt} sec, in {of}. {form}\n" + rows(values, 8, FORM)
    return text + f"/&  ---------- End of data for channel {number:2d} ----------\n"


def test_every_channel_has_its_acceleration_though_numbers_touch(tmp_path):
    path = tmp_path / "XY12345.V2"
    assert any(line[:10].strip() and line[10] == "-" for line in rows(TOUCHING, 8, FORM).splitlines())
    path.write_text(channel(1, 90, TOUCHING) + channel(2, 360, -TOUCHING / 2))
    first, second = read_records(path)
    assert (first.format, first.component, second.component, first.dt) == ("CSMIP V2", "90 Deg", "360 Deg", 0.01)
    np.testing.assert_allclose(first.acceleration, 1e-2 * as_printed(TOUCHING, FORM), rtol=1e-15)
    np.testing.assert_allclose(second.acceleration, 1e-2 * as_printed(-TOUCHING / 2, FORM), rtol=1e-15)
    assert first.header_pga == pytest.approx(9.99 if np.abs(TOUCHING).max() == 999.0 else 1e-2 * np.abs(TOUCHING).max(), rel=1e-6, abs=0)
    assert first.remarks == ()
    assert read_record(path, component="360 deg").component == "360 Deg"
    assert read_record(path, component="1").component == "90 Deg"


def test_what_is_no_acceleration_is_not_read(tmp_path):
    path = tmp_path / "a"
    text = channel(1, 90, TOUCHING)
    displaced = text.index("points of displ")
    path.write_text(text[:displaced] + text[displaced:].replace(FORM.format(TOUCHING[500]), "*" * 10) + channel(2, 360, SAMPLES / 10))
    assert [r.component for r in read_records(path)] == ["90 Deg", "360 Deg"]


def test_any_case_and_no_format(tmp_path):
    path = tmp_path / "a"
    path.write_text(channel(1, 90, TOUCHING, form="").upper())
    np.testing.assert_allclose(read_record(path).acceleration, 1e-2 * as_printed(TOUCHING, FORM), rtol=1e-15)


def test_a_unit_in_brackets_and_no_format_as_before_1990(tmp_path):
    path = tmp_path / "a"
    text = channel(1, 90, TOUCHING, form="").replace("sec, in cm/sec2. ", "sec.  (units: cm/sec/sec)")
    path.write_text(text.upper())
    assert "(UNITS: CM/SEC/SEC)" in path.read_text()
    np.testing.assert_allclose(read_record(path).acceleration, 1e-2 * as_printed(TOUCHING, FORM), rtol=1e-15)


def test_the_real_header_knows_the_step_to_more_digits(tmp_path):
    path = tmp_path / "a"
    path.write_text(channel(1, 90, SAMPLES / 10, dt="  .008", precise=0.0078125))
    assert read_record(path).dt == 0.0078125


def test_channels_of_one_name_are_told_apart(tmp_path):
    path = tmp_path / "a"
    path.write_text(channel(1, 90, SAMPLES / 10) + channel(2, 90, SAMPLES / 20))
    assert [r.component for r in read_records(path)] == ["90 Deg (1)", "90 Deg (2)"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "Response and Fourier amplitude spectra (78 periods)   for\n" + channel(1, 90, SAMPLES),
            "a:1: spectra (volume 3); expected an accel",
        ),
        (channel(1, 90, SAMPLES / 10, blocks="v"), "no points of accel data, only of veloc"),
        (channel(1, 90, SAMPLES / 10, blocks=""), "no line `n points of accel data`"),
        (channel(1, 90, SAMPLES / 10, points=996), "a:46: 996 points, where the header states 997"),
        (channel(1, 90, SAMPLES / 10, length=59.97), "a:46: 997 values every 0.01 s make 9.97 s, where the header states 59.970 s"),
        (channel(1, 90, SAMPLES / 10, unit="cm/sec"), "a:46: found"),
        (channel(1, 90, SAMPLES / 10, dt="  .000", precise=0.0), "a time step of"),
        (channel(1, 90, SAMPLES), "a:103: found '3-1056.335', two numbers run together"),  # eleven characters in ten columns
        (channel(1, 90, SAMPLES / 10).replace(FORM.format(SAMPLES[500] / 10), "*" * 10, 1), "'**********', stars in place of a number"),
        (channel(1, 90, SAMPLES / 10).replace(FORM.format(SAMPLES[500] / 10), "   1.2 3.4", 1), "found '1.2 3.4', "),
        ("\n".join(channel(1, 90, SAMPLES / 10).splitlines()[:200]) + "\n", "a:200: the file ends after 224 of 997 values"),
        ("\n".join(channel(1, 90, SAMPLES / 10).splitlines()[:100]) + "\n", "a:100: the file ends after 432 of 997 values"),
        ("\n".join([*channel(1, 90, SAMPLES / 10).splitlines()[:100], "/& End of data"]), "a:101: found '/&"),
    ],
)
def test_bad_files_are_told_with_file_and_line(tmp_path, text, words):
    assert words in refusal(tmp_path / "a", text)


@pytest.mark.parametrize("count", [43, 48])
def test_a_line_of_a_block_missing_or_twice_is_told(tmp_path, count):
    text = channel(1, 90, wave(count, 99.0)) + channel(2, 360, wave(count, 88.0))
    told = [refusal(tmp_path / "a", spoilt) for i, spoilt in with_a_line_missing_or_twice(text) if i in _of_blocks(text)]
    assert len(told) == 2 * 6 * 6


def test_a_channel_without_a_name_has_not_the_name_of_the_one_before(tmp_path):
    (tmp_path / "a").write_text(channel(1, 90, SAMPLES / 10) + channel(2, 360, SAMPLES / 20).partition("\n")[2])
    assert [r.component for r in read_records(tmp_path / "a")] == ["90 Deg", "channel (2)"]


def _of_blocks(text):
    """The lines below a line that announces points."""
    below, found = False, set()
    for i, line in enumerate(text.splitlines(), 1):
        numbers = not set(line.strip()) - set(" 0123456789.-")
        below = (below and numbers) or " points of " in line
        found |= {i} if below and numbers else set()
    return found
