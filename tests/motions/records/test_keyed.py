"""Headers of keys: ESM and ITACA, K-NET, AFAD in latin-1, and CWB."""

from __future__ import annotations

import numpy as np
import pytest
from support.record_layouts import as_printed, rows, wave
from support.refusals import refuses

from rocking_cli import DocumentError
from rocking_cli.motions.records import Record, read_records

ONE = wave(1200, 87.5)
COUNTS = np.rint(wave(3000, 40000.0) + 12567.0)
GAL = (COUNTS - COUNTS.mean()) * 3920.0 / 6182761.0
PEAK = f"{np.abs(GAL).max():.3f}"
THREE = np.stack([wave(700, 120.25), wave(700, -64.5), wave(700, 3.125)], axis=1)
TOUCHING = np.stack(
    [wave(600, 12.25), wave(600, -1064.5), wave(600, -99999.125 / 128)], axis=1
)
ESM_KEYS = {
    "EVENT_NAME": "",
    "EVENT_ID": "XX-1900-0000",
    "NETWORK": "XX",
    "VS30_M/S": "",
    "SAMPLING_INTERVAL_S": "0.005000",
    "NDATA": "1200",
    "DURATION_S": "5.995000",
    "STREAM": "HNE",
    "UNITS": "cm/s^2",
    "PGA_CM/S^2": "-87.500000",
    "DATA_TYPE": "ACCELERATION",
}
KNET_HEADER = """Origin Time       1900/01/02 03:04:00
Lat.              35.0
Station Height(m) 28
Sampling Freq(Hz) {rate}
Duration Time(s)  {duration}
Dir.              N-S
Scale Factor      {scale}
Max. Acc. (gal)   {peak}
Memo.
"""
AFAD_HEADER = """STRONG GROUND MOTION RECORDS OF TURKIYE
PLACE                   : KüTAHYA ÇIğLI
EPICENTER COORDINATES   : 36.9N-27.4E
NUMBER OF DATA          : {count}
SAMPLING INTERVAL (sec) : {dt}
RAW PGA VALUES ({unit})    : (N-S) 120.25 (E-W) 64.5 (U-D) 3.125
Copyright EARTHQUAKE DEPARTMENT
       N-S          E-W          U-D
"""
CWB_HEADER = """#Earthquake Information
#Origin Time(GMT+08): 1900/01/02-03:04:05

#RecordLength(sec): {length}
#SampleRate(Hz): {rate}
#AmplitudeUnit:  {unit}
{peaks}#DataSequence: Time {order}
#Data: {form}
"""


def esm(**changed):
    keys = ESM_KEYS | changed
    keys |= {f"USER{i}": "" for i in range(1, 65 - len(keys))}
    return "".join(f"{key}: {value}\n" for key, value in keys.items()) + rows(
        ONE, 1, "{:.6f}"
    )


def knet(values=COUNTS, **changed):
    header = {
        "scale": "3920(gal)/6182761",
        "rate": "100Hz",
        "duration": "30",
        "peak": PEAK,
    } | changed
    return KNET_HEADER.format(**header) + rows(values, 8, "{:8.0f} ")


def afad(**changed):
    return AFAD_HEADER.format(
        **({"count": 700, "dt": "0.01", "unit": "gal"} | changed)
    ) + rows(THREE.ravel(), 3, "{:13.6f}")


def cwb(step=0.02, **changed):
    header = {
        "rate": "50",
        "unit": "gal. DCoffset(corr)",
        "length": "12",
        "form": "4F10.3 ",
        "order": "U(+); N(+); E(+)",
    } | changed
    peaks = "".join(
        f"#AmplitudeMAX. {n}: {x.max():8.3f}~ {x.min():8.3f}\n"
        for n, x in zip("UNE", TOUCHING.T, strict=True)
    )
    times = step * np.arange(len(TOUCHING))
    return CWB_HEADER.format(peaks=peaks, **header) + rows(
        np.column_stack([times, TOUCHING]).ravel(), 4, "{:10.3f}"
    )


def written(path, text) -> list[Record]:
    path.write_bytes(text.encode("latin-1", "replace"))
    return read_records(path)


@pytest.mark.parametrize(
    ("text", "form", "dt", "samples"),
    [
        (esm(), "ESM", 0.005, {"HNE": as_printed(ONE, "{:.6f}")}),
        (
            esm(DATA_TYPE="PROCESSED ACCELERATION").replace(
                "STREAM: HNE", "COMPONENT: WE"
            ),
            "ESM",
            0.005,
            {"WE": as_printed(ONE, "{:.6f}")},
        ),
        (knet(), "K-NET", 0.01, {"N-S": GAL}),
        (
            afad(),
            "AFAD",
            0.01,
            {
                n: as_printed(x, "{:13.6f}")
                for n, x in zip(("N-S", "E-W", "U-D"), THREE.T, strict=True)
            },
        ),
        (
            cwb(),
            "CWB",
            0.02,
            {
                n: as_printed(x, "{:10.3f}")
                for n, x in zip("UNE", TOUCHING.T, strict=True)
            },
        ),
    ],
)
def test_samples_peaks_and_components(tmp_path, text, form, dt, samples):
    records = written(tmp_path / "a", text)
    assert [r.component for r in records] == list(samples)
    for record, wanted in zip(records, samples.values(), strict=True):
        assert (record.format, record.dt, record.remarks) == (form, dt, ())
        np.testing.assert_allclose(
            record.acceleration, 1e-2 * wanted, rtol=1e-12, atol=1e-15
        )
        assert record.header_pga == pytest.approx(
            np.abs(record.acceleration).max(), rel=1e-4, abs=0
        )


def test_what_the_header_contradicts_is_a_remark(tmp_path):
    (record,) = written(
        tmp_path / "a",
        esm(DATA_TYPE="UNPROCESSED ACCELERATION", **{"PGA_CM/S^2": "-80.0"}),
    )
    contradicted = (
        "component HNE: the header states a PGA of 80 cm/s2, the samples have 87.5"
        " cm/s2"
    )
    assert record.remarks == ("an uncorrected accelerogram", contradicted)
    for record in written(
        tmp_path / "a", cwb() + "    12.000     0.000     0.000     0.000\n"
    ):
        assert record.remarks == (
            "more values than the 600 declared, which are left out",
        )


REFUSED = [
    (
        esm(DATA_TYPE="ACCELERATION RESPONSE SPECTRUM"),
        "a:11: DATA_TYPE: found 'ACCELERATION RESPONSE SPECTRUM'",
    ),
    (esm(DATA_TYPE="VELOCITY"), "a:11: DATA_TYPE: found 'VELOCITY'"),
    (esm(UNITS="counts"), "a:9: UNITS: found 'counts'"),
    (esm(UNITS=""), "a:9: no value of UNITS"),
    (
        esm(NDATA="1201", DURATION_S="6"),
        "a:1264: the file ends after 1200 of 1201 values",
    ),
    (esm(SAMPLING_INTERVAL_S="0.0"), "a:5: a time step of 0.0"),
    (
        esm(DURATION_S="59.95"),
        "a:7: 1200 values every 0.005 s make 6 s, where the header states 59.95 s",
    ),
    (esm(NDATA="many"), "a:6: found 'many'"),
    (
        knet(scale=""),
        (
            "a:7: no value of Scale Factor; expected a scale such as 7845(gal)/8223790,"
            " since counts have no unit"
        ),
    ),
    (knet(scale="3920(gal)/0"), "Scale Factor"),
    (knet(rate="0Hz"), "a:4: a sampling frequency of 0"),
    (
        knet().replace("Freq(Hz)", "Freq(kHz)"),
        "a:4: found 'Sampling Freq(kHz)'; expected a sampling frequency in Hz",
    ),
    (knet(duration="31"), "a:384: the file ends after 3000 of 3100 values"),
    (knet(COUNTS[:-3]), "a:384: the file ends after 2997 of 3000 values"),
    (afad(count=701), "a:708: the file ends after 2100 of 2103 values"),
    (afad(count=""), "a:4: no value of NUMBER OF DATA"),
    (afad(dt="0"), "a:5: a time step of 0"),
    (afad(unit="cm/s"), "a:6: found 'RAW PGA VALUES (CM/S)'"),
    (afad().partition("       N-S")[0], "a:7: the file ends within its header"),
    (cwb(unit="count"), "a:6: AmplitudeUnit: found 'count'"),
    (cwb(unit=""), "a:6: no value of AmplitudeUnit"),
    (cwb(rate="0"), "a:5:"),
    (cwb(length="12.01"), "a:4: a number of values of 600.5"),
    (cwb(length="14"), "a:611: the file ends after 2400 of 2800 values"),
    (
        cwb(step=0.01),
        "a:4: 600 values every 0.01 s make 6 s, where the header states 12 s",
    ),
    (cwb(length="0"), "a:12: found 0 values; expected at least two"),
    (cwb(form="3F10.3"), "a:11: Data: found '3F10.3' for a time and U, N, E"),
    (cwb(order="", form="F10.3"), "a:11: Data: found 'F10.3' for a time and "),
    (cwb().partition("     0.000")[0], "a:11: the file ends within its header"),
]
test_bad_files_are_told_with_file_and_line = refuses(
    read_records, DocumentError, REFUSED, file="a", literal=True
)
