"""CSMNC of China, ASA of Mexico, K-NET between commas, and ASDF workspaces."""

from __future__ import annotations

import io

import h5py
import numpy as np
import pytest
from support.record_layouts import as_printed, refusal, rows, wave

from rocking_cli import DocumentError, UsageError
from rocking_cli.errors import NoAcceleration
from rocking_cli.motions.reading import holds_records, read_motions
from rocking_cli.motions.records import read_record, read_records
from rocking_cli.motions.records.record import vertical_of

SAMPLES = wave(403, -812.5)

CSMNC_HEADER = """001ABC010120000101
0010120000101 2000-01-01 00:00:00 BTM
NOWHERE EARTHQUAKE, NOWHERE,CHN
EPICENTER  30.000N 103.000E DEPTH 13 KM
MAGNITUDE  7.0(Ms)
STATION: 01ABC 台站 30.000N 102.000E
SITE CONDITION: ROCK
INSTRUMENT TYPE: X/Y-100
OBSERVING POINT: GROUND
COMP. {component}
{quantity}          UNIT: {unit}
NO. OF POINTS:  {count}  EQUALLY SPACED INTERVALS OF:  {dt}  SEC
PEAK VALUE:    {peak:.3f}   AT   26.35 SEC    DURATION:  {duration} SEC
PRE-EVENT TIME:  20  SEC
CSMNC

"""


def csmnc(samples=SAMPLES, **changed):
    said = {
        "component": "EW",
        "quantity": "CORRECTED ACCELERATION",
        "unit": "CM/SEC/SEC",
        "count": 403,
        "dt": "0.005",
        "duration": 2,
    }
    return CSMNC_HEADER.format(
        **(said | {"peak": samples[np.argmax(np.abs(samples))]} | changed)
    ) + rows(samples, 8, "{:14.6E}")


@pytest.mark.parametrize("encoding", ["utf-8", "gb18030"])
def test_csmnc(tmp_path, encoding):
    (tmp_path / "a.dat").write_bytes(csmnc(component="UD").encode(encoding))
    (record,) = read_records(tmp_path / "a.dat")
    assert (
        record.format,
        record.component,
        record.dt,
        record.unit,
        record.remarks,
    ) == ("CSMNC", "UD", 0.005, "cm/s2", ())
    np.testing.assert_allclose(
        record.acceleration, 0.01 * as_printed(SAMPLES, "{:14.6E}"), rtol=1e-14
    )
    assert record.header_pga == pytest.approx(8.125, rel=1e-6)
    assert vertical_of([record]) is record


def test_an_uncorrected_record_of_csmnc_is_one_of_the_uncorrected(tmp_path):
    (tmp_path / "a.dat").write_text(
        csmnc(quantity="UNCORRECTED ACCCELERATION")
    )  # as some files spell it
    assert read_record(tmp_path / "a.dat").remarks == ("an uncorrected accelerogram",)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (
            {"quantity": "CORRECTED VELOCITY", "unit": "CM/SEC"},
            "a:11: found 'CORRECTED VELOCITY          UNIT: CM/SEC'; expected an acc",
        ),
        ({"unit": "CM/SEC"}, "a:11: found the unit 'CM/SEC'"),
        ({"count": 404}, "the file ends after 403 of 404 values"),
        ({"dt": "0"}, "a time step of 0"),
        (
            {"duration": 60},
            "403 values every 0.005 s make 2.015 s, where the header states 60 s",
        ),
    ],
)
def test_faults_of_csmnc(tmp_path, changed, words):
    assert words in refusal(tmp_path / "a", csmnc(**changed))


ASA_HEADER = """================================
INSTITUTO DE INGENIERIA, UNAM

ARCHIVO ESTANDAR DE ACELERACION

VERSION DEL FORMATO : 2.0
NOMBRE DE LA ESTACION : DE NADIE
ALTITUD (msnm) : 20
COORDENADAS DE LA ESTACION : 17.0 LAT. N
                           : 99.0 LONG. W
ORIENTACION C1-C6 (rumbo;orientacion) : /{names}/ / / /
VEL. DE MUESTREO, C1-C6 (muestras/s) : /100/100/100/ / / /
INTERVALO DE MUESTREO, C1-C6 (s) : /.01/.01/{last}/ / / /
NUM. TOTAL DE MUESTRAS, C1-C6 : /{count}/{count}/{count}/ / / /
ACEL. MAX.(Gal), C1-C6 : /{peak}/-40.25/12.5/ / / /
UNIDADES DE LOS DATOS : {unit}
FACTOR DE DECIMACION : {factor}
FORMATO DATOS : 3F10.2
COMENTARIOS : 2 canales

 DATOS DE ACELERACION
  CANAL 1   CANAL 2   CANAL 3
"""
THREE = np.stack([wave(60, 99.5), wave(60, -40.25), wave(60, 12.5)], axis=1)


def asa(**changed):
    said = {
        "names": "S00E;L/+V/N90E;T",
        "last": ".01",
        "count": 60,
        "peak": "99.50",
        "unit": "Gal (cm/s/s)",
        "factor": 1,
    }
    return ASA_HEADER.format(**(said | changed)) + rows(THREE.ravel(), 3, "{:10.2f}")


def test_asa(tmp_path):
    (tmp_path / "a").write_text(asa())
    records = read_records(tmp_path / "a")
    assert [(r.format, r.component, r.dt, r.unit, r.npts) for r in records] == [
        ("ASA", x, 0.01, "gal", 60) for x in ("L", "+V", "T")
    ]
    np.testing.assert_allclose(
        [r.acceleration for r in records], 0.01 * np.round(THREE.T, 2), atol=1e-12
    )
    assert vertical_of(records).component == "+V"
    assert records[0].header_pga == pytest.approx(0.995, rel=1e-12)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"unit": "cm/s"}, "UNIDADES DE LOS DATOS: found 'cm/s'; expected m/s2"),
        ({"factor": 10}, "found '10'; expected FACTOR DE DECIMACION: 1"),
        ({"count": 61}, "the file ends after 180 of 183 values"),
        ({"last": ".02"}, "channels of different lengths or steps, which are not read"),
        ({"names": "S00E/V"}, "found"),
    ],
)
def test_faults_of_asa(tmp_path, changed, words):
    assert words in refusal(tmp_path / "a", asa(**changed))


KNET = (
    "Origin Time,2000/01/01 00:00:00\nLat.,35.0\nStation Height(m),28\nSampling"
    " Freq(Hz),100Hz\nDuration Time(s),4\n"
)


def test_knet_between_commas(tmp_path):
    counts = np.rint(wave(400, 40000.0) + 1234.0)
    text = (
        f"{KNET}Dir.,U-D\nScale Factor,3920(gal)/6182761\nMax. Acc."
        " (gal),25.0\nMemo.,\n" + rows(counts, 1, "{:.0f}")
    )
    (tmp_path / "a.csv").write_text(text)
    (record,) = read_records(tmp_path / "a.csv")
    assert (record.format, record.component, record.dt) == ("K-NET", "U-D", 0.01)
    np.testing.assert_allclose(
        record.acceleration,
        0.01 * (counts - counts.mean()) * 3920 / 6182761,
        rtol=1e-12,
        atol=1e-15,
    )


def workspace(path, tags=("ev_default",), samples=SAMPLES, **attributes):
    with h5py.File(path, "w") as file:
        station = file.create_group("Waveforms/XX.ABC")
        station.create_dataset("StationXML", data=np.zeros(10, dtype=np.int8))
        for i, channel in enumerate(("HNE", "HNN", "HNZ"), 1):
            for tag in tags:
                span = "2000-01-01T00:00:00__2000-01-01T00:00:04"
                name = f"XX.ABC.00.{channel}__{span}__{tag}"
                data = station.create_dataset(
                    name, data=samples / i if samples.dtype == float else samples
                )
                data.attrs.update(
                    {"sampling_rate": 100.0, "starttime": np.int64(946684800) * 10**9}
                    | attributes
                )
    return path


def test_a_workspace_gives_every_channel_in_the_unit_of_the_user(tmp_path):
    path = workspace(tmp_path / "w.h5", ("ev_default", "ev_unprocessed"))
    records = read_records(path, unit="cm/s2")
    assert [r.component for r in records] == [
        f"XX.ABC.00.{x}" for x in ("HNE", "HNN", "HNZ")
    ]
    for i, record in enumerate(records, 1):
        assert (record.format, record.dt, record.remarks) == ("ASDF", 0.01, ())
        np.testing.assert_allclose(record.acceleration, 0.01 * SAMPLES / i, rtol=1e-15)
    assert vertical_of(records).component == "XX.ABC.00.HNZ"
    assert holds_records(str(path))
    assert [r.label for r in read_motions([str(path)], unit="cm/s2")] == [
        "w XX.ABC.00.HNE",
        "w XX.ABC.00.HNN",
    ]
    with pytest.raises(
        DocumentError,
        match=r"w.h5: waveforms \(ASDF\) without a unit; give it as `unit`",
    ):
        read_records(path)
    with pytest.raises(
        DocumentError, match=r"`dt`: found 0.02 s; the file says otherwise: 0.01 s"
    ):
        read_records(path, unit="g", dt=0.02)
    with pytest.raises(UsageError, match=r"`column` goes with plain columns.*ASDF"):
        read_records(path, unit="g", column="2")


def test_unprocessed_waveforms_and_counts(tmp_path):
    path = workspace(tmp_path / "w.h5", ("ev_unprocessed",))
    assert read_records(path, unit="g")[0].remarks[0] == "unprocessed waveforms"
    told: list[str] = []
    with pytest.raises(UsageError, match="no record among the files"):
        read_motions([str(tmp_path)], unit="g", tell=told.append)
    assert (
        "unprocessed waveforms, which are taken where the file itself is named;"
        " left out" in told[0]
    )
    for changed, words in (
        ({"samples": np.arange(9)}, "whole numbers, which are counts"),
        ({"sampling_rate": 0.0}, "no attribute sampling_rate"),
    ):
        with pytest.raises(DocumentError, match=words):
            read_records(workspace(tmp_path / "w.h5", **changed), unit="g")


def test_another_hdf5_file_is_no_record(tmp_path):
    held = io.BytesIO()
    with h5py.File(held, "w") as file:
        file["theta_ratio"] = np.zeros(3)
    (tmp_path / "s.h5").write_bytes(held.getvalue())
    with pytest.raises(NoAcceleration, match="found an HDF5 file"):
        read_records(tmp_path / "s.h5")
    assert not holds_records(str(tmp_path / "s.h5"))


def timeseries(
    kind="SLIST", name="XX_STA_00_HNZ_D", unit="M/S**2", count=403, rate=200
):
    """The text of ObsPy."""
    head = (
        f"TIMESERIES {name}, {count} samples, {rate} sps, 2020-01-01T00:00:00.000000,"
        f" {kind}, FLOAT, {unit}\n"
    )
    if kind == "SLIST":
        return head + rows(SAMPLES, 6, "{:+.10e}\t")
    return head + "".join(
        f"2020-01-01T00:00:{0.005 * i:09.6f}  {x:+.10e}\n"
        for i, x in enumerate(SAMPLES)
    )


@pytest.mark.parametrize("kind", ["SLIST", "TSPAIR"])
def test_the_text_of_obspy(tmp_path, kind):
    (tmp_path / "a").write_text(
        timeseries(kind) + timeseries(kind, "XX_STA_00_HNE_D", "CM/S**2")
    )
    up, east = read_records(tmp_path / "a")
    assert (up.format, up.component, east.component, up.dt) == (
        "TIMESERIES",
        "HNZ",
        "HNE",
        0.005,
    )
    assert vertical_of([up, east]) is up
    np.testing.assert_array_equal(up.acceleration, as_printed(SAMPLES, "{:+.10e}"))
    np.testing.assert_allclose(east.acceleration, 0.01 * up.acceleration, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (timeseries(unit="Counts"), "a:1: found the unit 'Counts'"),
        (timeseries(unit="M/S"), "a:1: found the unit 'M/S'"),
        (
            timeseries() + timeseries(),
            "a second stretch of XX_STA_00_HNZ_D, after a gap",
        ),
        (timeseries(count=402), "a:69: found numbers after the 402"),
        (timeseries(count=404), "the file ends after 403 of 404 values"),
        (
            timeseries("TSPAIR", rate=100),
            "a:3: found '2020-01-01T00:00:00.005000', 1 steps of 0.01 s after",
        ),
        (timeseries() + "x\n", "found 'x'; expected a line like TIMESERIES"),
    ],
)
def test_other_texts_of_obspy_are_refused(tmp_path, text, words):
    assert words in refusal(tmp_path / "a", text)


def stored_apart(file, **how):
    (station,) = file["Waveforms"].values()
    name = next(x for x in station if "HNE" in x)
    del station[name]
    data = station.create_dataset(name, shape=(500,), dtype="f8", **how)
    data.attrs["sampling_rate"] = 100.0


def put(place, what):
    def edit(file):
        file.pop(place, None)
        file[place] = what

    return edit


def elsewhere(file):
    stored_apart(file, external=[("secret.bin", 0, 4000)])


def of_another_file(file):
    layout = h5py.VirtualLayout((500,), "<f8")
    layout[:] = h5py.VirtualSource("secret.h5", "secret", (500,))
    name = "XX.ABC.00.HNX__a__b__c"
    file["Waveforms/XX.ABC"].create_virtual_dataset(name, layout)


NOT_OWN = "is not a group of its own"
HOSTILE = {
    "values in another file": (elsewhere, "is stored in another file"),
    "values of another dataset": (of_another_file, "is stored in another file"),
    "a link to another file": (
        put("Waveforms", h5py.ExternalLink("secret.h5", "/Waveforms")),
        f"Waveforms {NOT_OWN}",
    ),
    "a soft link": (put("Waveforms/a", h5py.SoftLink("/Waveforms/XX.ABC")), NOT_OWN),
    "a link to nothing": (put("Waveforms/a", h5py.SoftLink("/nowhere")), NOT_OWN),
    "a link to itself": (put("Waveforms/a", h5py.SoftLink("/Waveforms/a")), NOT_OWN),
    "a dataset of waveforms": (put("Waveforms", SAMPLES), NOT_OWN),
    "a dataset for a station": (put("Waveforms/a", SAMPLES), NOT_OWN),
    "a table": (
        put("Waveforms/XX.ABC/a__b__c__d", np.ones((9, 9))),
        "a is not one row of samples",
    ),
    "chunks that are not there": (
        lambda file: stored_apart(file, chunks=(100,)),
        "states 500 values and stores fewer",
    ),
    "values that are not there": (stored_apart, "states 500 values and stores fewer"),
    "a huge chunk": (
        lambda file: stored_apart(file, chunks=(1 << 26,), maxshape=(None,)),
        "waveforms larger than 256 MiB when unpacked",
    ),
}


@pytest.mark.parametrize(("edit", "words"), HOSTILE.values(), ids=HOSTILE)
def test_a_workspace_gives_only_what_it_stores_itself(tmp_path, edit, words):
    path = workspace(tmp_path / "w.h5")
    (tmp_path / "secret.bin").write_bytes(np.linspace(-1.0, 1.0, 500).tobytes())
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["secret"] = np.linspace(-1.0, 1.0, 500)
        file.create_group("Waveforms")
    with h5py.File(path, "r+") as file:
        edit(file)
    with pytest.raises(DocumentError, match=words):
        read_records(path, unit="cm/s2")


@pytest.mark.parametrize(
    "rate", ["abc", [100.0, 100.0], [], h5py.Empty("f8"), 1 + 2j, np.inf, np.nan, -1.0]
)
def test_a_rate_is_one_positive_number(tmp_path, rate):
    path = workspace(tmp_path / "w.h5", sampling_rate=rate)
    with pytest.raises(DocumentError, match="no attribute sampling_rate that is a"):
        read_records(path, unit="cm/s2")
