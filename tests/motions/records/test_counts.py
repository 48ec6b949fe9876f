"""A header that states fewer or more values than the file holds, in every layout: no
value is lost without a word.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

import numpy as np
import pytest
from support.packages import installed
from support.record_layouts import as_printed, at2, refusal, rows, wave

from rocking_cli.errors import DocumentError
from rocking_cli.motions.records import FORMATS, GROUP, read_records

DT = 0.01  # s, of every file here


class Written(NamedTuple):
    """A layout as files have it."""

    header: Callable[[int], str]  # of the number of values that it states
    per_line: int  # values, or values of a component where there are several
    form: str  # of a number
    # the line of a sample in place of `per_line` numbers
    line: Callable[[int, float], str] | None = None
    end: str = ""  # below the values

    def text(self, samples: np.ndarray, stated: int) -> str:
        if self.line is None:
            body = rows(samples, self.per_line, self.form)
        else:
            body = "".join(self.line(i, x) for i, x in enumerate(samples))
        return self.header(stated) + body + self.end


def keyed(*lines: str) -> Callable[[int], str]:
    """The header of such lines, with {n} for the number and {d} for the duration."""
    return lambda n: "".join(f"{x}\n" for x in lines).format(n=n, d=f"{n * DT:.2f}")


def smc(n: int) -> str:
    integers, reals = np.full(48, -32768), np.full(50, 1.7e38)
    integers[16], reals[1] = n, 1.0 / DT
    text = "2 CORRECTED ACCELEROGRAM\n" + 10 * "*\n"
    return text + rows(integers, 8, "{:10d}") + rows(reals, 5, "{:15.7E}")


def cosmos(n: int) -> str:
    reals = np.full(100, -999.0)
    reals[61] = 1e3 * DT
    return (
        "Corrected acceleration    (Format v01.20 with 1 text lines)\n"
        " 100 Integer-header values follow on  10 lines, Format= (10I8)\n"
        + rows([-999] * 100, 10, "{:8d}")
        + " 100 Real-header values follow on  17 lines, Format= (6F13.6)\n"
        + rows(reals, 6, "{:13.6f}")
        + " 0 Comment line(s) follow\n"
        + f"{n:7d}  acceleration pts, units=cm/sec2(04),Format=(8F10.5)\n"
    )


def geonet(n: int) -> str:
    numbers = np.zeros(100)
    numbers[33], numbers[65] = n, DT
    text = "Corrected accelerogram GNS Science\n" + 15 * "words\n"
    return text + rows(numbers, 10, "{:8.2f}")


def volume_1(*units: str, first: str = "UNCORRECTED ACCELEROGRAM DATA"):
    """The header of 13 lines of text and 14 of numbers, with `units` below the text."""
    above, *below = units
    numbers = 8 * ["    1    2"] + ["      100.       0.1"] + 5 * ["   1.0   2.0"]
    points = "No. of Points = {n}  Record Length = {d} sec"
    return keyed(first, *10 * ["words"], points, above, *numbers, *below)


TENTHS = "UNITS OF UNCOR ACCEL ARE SEC AND G/10."
AT2 = keyed("ACCELERATION TIME SERIES IN UNITS OF G", "NPTS= {n}, DT= .01 SEC")
TIMESERIES = "TIMESERIES XX_S_00_HNZ_D, {{n}} samples, 100 sps, {}, {}, FLOAT, M/S**2"
BEGIN = "2020-01-01T00:00:00.000000"
KNET = ("Origin Time  1900/01/02", "Sampling Freq(Hz) 100Hz", "Duration Time(s)  {d}")
KNET += ("Dir.              N-S", "Scale Factor      3920(gal)/6182761", "Memo.")
LAYOUTS = {
    "ESM": Written(
        keyed(
            "EVENT_NAME:",
            "NDATA: {n}",
            "SAMPLING_INTERVAL_S: 0.01",
            "UNITS: cm/s^2",
            "DATA_TYPE: ACCELERATION",
        ),
        1,
        "{:.5f}",
    ),
    "K-NET": Written(keyed(*KNET), 8, "{:9.0f}"),
    "AFAD": Written(
        keyed(
            "STRONG GROUND MOTION RECORDS OF TURKIYE",
            "NUMBER OF DATA: {n}",
            "SAMPLING INTERVAL (sec): 0.01",
            "N-S E-W U-D",
        ),
        1,
        "{:.5f}",
        lambda i, x: f"{x:13.5f}{x:13.5f}{x:13.5f}\n",
    ),
    "CWB": Written(
        keyed(
            "#Earthquake",
            "#RecordLength(sec): {d}",
            "#SampleRate(Hz): 100",
            "#AmplitudeUnit: gal.",
            "#DataSequence: Time U(+); N(+)",
            "#Data: 3F10.3",
        ),
        1,
        "{:.3f}",
        lambda i, x: f"{DT * i:10.3f}{x:10.3f}{x:10.3f}\n",
    ),
    "COSMOS": Written(cosmos, 8, "{:10.5f}", end="End-of-data\n"),
    "GeoNet": Written(geonet, 10, "{:8.1f}"),
    "SMC": Written(smc, 8, "{:10.3f}"),
    "CSMIP": Written(
        keyed(
            "Corrected accelerogram",
            "{n} points of accel data equally spaced at .010 sec, in cm/sec2. (8f10.5)",
        ),
        8,
        "{:10.5f}",
        end="/& end\n",
    ),
    "volume 1, announced": Written(
        volume_1(
            "UNITS g", "{n} Accelerogram points at 100 pts/sec in units of g (8f9.5)"
        ),
        8,
        "{:9.5f}",
        end="/& end\n",
    ),
    "volume 1, pairs": Written(
        volume_1(TENTHS),
        5,
        "{:7.3f}",
        lambda i, x: f"{DT * i:7.3f}{x:7.3f}" + ("\n" if i % 5 == 4 else ""),
        "\n/& end\n",
    ),
    "volume 1, alone": Written(
        volume_1(TENTHS, first="* VOL1DS"), 10, "{:13.6E}", end="/& end\n"
    ),
    "PEER": Written(AT2, 5, "{:15.7E}"),
    "PEER, an end": Written(AT2, 5, "{:15.7E}", end="END\n"),
    "PEER, one a line": Written(AT2, 1, "{:15.7E}"),
    "PEER, times": Written(AT2, 1, "{:.7f}", lambda i, x: f"{DT * i:.3f} {x:.7f}\n"),
    "CSMNC": Written(
        keyed(
            "CORRECTED ACCELERATION   UNIT: CM/SEC/SEC",
            "NO. OF POINTS: {n}  EQUALLY SPACED INTERVALS OF: .01 SEC",
        ),
        8,
        "{:14.6E}",
    ),
    "ASA": Written(
        keyed(
            "ARCHIVO ESTANDAR DE ACELERACION",
            "ORIENTACION : /L/V/T",
            "INTERVALO DE MUESTREO : /.01/.01/.01",
            "NUM. TOTAL DE MUESTRAS : /{n}/{n}/{n}",
            "UNIDADES DE LOS DATOS : Gal",
        ),
        1,
        "{:.3f}",
        lambda i, x: f"{x:10.3f}{x:10.3f}{x:10.3f}\n",
    ),
    "TIMESERIES": Written(keyed(TIMESERIES.format(BEGIN, "SLIST")), 6, "{:+.8e}\t"),
    "TIMESERIES, dates": Written(
        keyed(TIMESERIES.format(BEGIN, "TSPAIR")),
        1,
        "{:+.8e}",
        lambda i, x: f"2020-01-01T00:00:{DT * i:09.6f}  {x:+.8e}\n",
    ),
}


def of_length(count: int) -> np.ndarray:
    """Samples that every layout prints with some digits; whole numbers as K-NET has."""
    return np.rint(wave(count, 90.0)) + 0.0


def test_every_format_has_a_layout_here(tmp_path):
    modules = [import_module(f"rocking_cli.motions.records.{x}") for x in FORMATS]
    wanted = {f.NAME for m in modules for f in getattr(m, "FORMATS", (m,))}
    for written in LAYOUTS.values():
        (tmp_path / "a").write_text(written.text(of_length(100), 100))
        wanted -= {read_records(tmp_path / "a")[0].format}
    assert not wanted, f"no row of {', '.join(wanted)} in LAYOUTS of this file"


@pytest.mark.parametrize("count", [400, 403], ids=["full lines", "a part of a line"])
@pytest.mark.parametrize("name", LAYOUTS)
def test_another_number_in_the_header_is_refused_or_told(tmp_path, name, count):
    written = LAYOUTS[name]
    samples, path = of_length(count), tmp_path / "a"

    def read(stated: int):
        path.write_text(written.text(samples, stated))
        return read_records(path)

    for record in read(count):
        assert record.npts == count
        assert "left out" not in " ".join(record.remarks)
    whole = read(count)[0].acceleration

    for stated in {count - 1, count - written.per_line, count - count // 3}:
        try:
            found = read(stated)
        except DocumentError:
            continue
        for record in found:
            told = f"more values than the {stated} declared, which are left out"
            assert told in record.remarks
        # K-NET is read less its mean
        off = found[0].acceleration - whole[:stated]
        assert np.ptp(off) <= 1e-12
    for stated in {count + 1, count + written.per_line, count + count // 3}:
        refusal(path, written.text(samples, stated))


@pytest.mark.parametrize("missing", [-1, 1])
@pytest.mark.parametrize(
    "name", [x for x in LAYOUTS if not x.startswith(("PEER", "SMC"))]
)
def test_another_number_in_the_first_of_two_channels(tmp_path, name, missing):
    written, samples = LAYOUTS[name], of_length(403)
    text = written.text(samples, 403 + missing) + written.text(samples, 403)
    (tmp_path / "a").write_text(text)
    try:
        found = read_records(tmp_path / "a")
    except DocumentError:
        return
    assert missing == -1
    assert all("more values than the 402" in " ".join(x.remarks) for x in found)


@pytest.mark.parametrize(
    "name", ["ESM", "K-NET", "AFAD", "CWB", "CSMNC", "ASA", "PEER", "SMC"]
)
def test_a_second_record_in_a_file_of_one_is_told(tmp_path, name):
    written, samples = LAYOUTS[name], of_length(403)
    text = written.text(samples, 403)
    (tmp_path / "a").write_text(text + "\n" + text)
    line, first = text.count("\n") + 2, text.partition("\n")[0]
    told = f"{first!r} in line {line} and what follows, which are left out"
    for record in read_records(tmp_path / "a"):
        assert told in "; ".join(record.remarks)


OURS = """
from rocking_cli.motions.records.record import Series
from rocking_cli.motions.records.text import Layout, begins
NAME, recognise = "OURS", begins("OURS")
def read(text):
    text.lines(1)
    return [Series(None, 0.01, text.numbers(402, Layout(8)), "gal")]
"""


def test_a_reader_that_forgets_what_follows_loses_nothing(tmp_path, monkeypatch):
    installed(monkeypatch, tmp_path, GROUP, "ours", OURS)
    (tmp_path / "a").write_text("OURS\n" + rows(of_length(403), 8, "{:9.0f}"))
    (record,) = read_records(tmp_path / "a")
    assert record.npts == 402
    assert "more values than the 402 declared, which are left out" in record.remarks


def test_a_line_of_a_table_has_a_number_for_each_column(tmp_path):
    """A word less on one line and a word more on another do not exchange columns."""
    for name in ("AFAD", "ASA", "PEER, times"):
        written = LAYOUTS[name]
        lines = written.text(of_length(50), 50).splitlines()
        lines[-9] += " " + lines[-8].split()[0]
        lines[-8] = " ".join(lines[-8].split()[1:])
        said = refusal(tmp_path / "a", "\n".join(lines))
        assert "numbers on a line; expected" in said


def test_times_are_never_read_as_accelerations(tmp_path):
    """A file of times and values is told from one of two values a line, also where it
    ends too early."""
    written = LAYOUTS["PEER, times"]
    for held in (303, 240, 201):
        said = refusal(tmp_path / "a", written.text(of_length(held), 304 + held % 2))
        assert "the file ends after" in said
    for columns in (3, 6):  # also with velocities and displacements behind them
        table = [[DT * i, *(columns - 1) * [x]] for i, x in enumerate(of_length(240))]
        text = rows(np.ravel(table), columns, "{:10.3f}")
        refusal(tmp_path / "a", AT2(240 * columns * 2 // 3) + text)
    (tmp_path / "a").write_text(AT2(403) + rows(of_length(403), 2, "{:10.3f}"))
    (record,) = read_records(tmp_path / "a")
    np.testing.assert_array_equal(
        record.acceleration, 9.81 * as_printed(of_length(403), "{:10.3f}")
    )


@pytest.mark.parametrize("end", ["-4.486", "-4.4860000E-0", "-4"])
def test_a_number_that_the_end_of_the_file_cuts_is_refused(tmp_path, end):
    whole = at2(wave(100))
    *_, last = whole.split()
    said = refusal(tmp_path / "a.at2", whole.rstrip().removesuffix(last) + end + "\n")
    assert f"found '{end}' at the end of the file" in said
