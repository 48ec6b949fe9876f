"""Formats whose header is lines of keys: ESM and ITACA, K-NET and KiK-net (NIED), AFAD
(NSMN), and CWB (now CWA).
"""

import re

import numpy as np

from .record import Series
from .text import Format, Layout, RecordText, begins, fortran_layout
from .times import even_step

_ESM_KEY = re.compile(r"\s*([A-Z][A-Z0-9_/^.()-]*)\s*:\s*(.*)")
_ESM_KINDS = ("ACCELERATION", "PROCESSED ACCELERATION", "UNPROCESSED ACCELERATION")
_KNET_KEY = re.compile(
    r"(\w[\w. ]*?)\s*(?:\(\w+\)\s*[,;:]?\s*|\s\s+|\s*[,;:]\s*|$)(.*)"
)
_KNET_MEMO = re.compile(r"Memo", re.IGNORECASE)
_KNET_SCALE = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)", re.IGNORECASE)
_KNET_RATE = re.compile(r"Sampling Freq\.?\s*\((\w+)\)", re.IGNORECASE)
_AFAD_KEY = re.compile(r"(.+?)\s*(?:\(sec\)\s*)?:(.*)", re.IGNORECASE)
_AFAD_COLUMNS = re.compile(r"\s*N-?S\s+E-?W\s+(?:U-?D|Z|V)\s*$", re.IGNORECASE)
_CWB_KEY, _CWB_PGA = re.compile(r"#([^:(]+)[^:]*:(.*)"), re.compile(r"\d*\.\d+")
_CWB_COMPONENT = re.compile(r"([A-Z])\s*\([-+]\)")


def _esm(text: RecordText) -> list[Series]:
    """Lines `KEY: value` from EVENT_NAME on (64 in DYNA 1.2, 55 in 1.0, 43 in the first
    ITACA), then one value on each line.
    """
    keys = text.keys(_ESM_KEY)
    kind, line = text.value(keys, "DATA_TYPE", "ACCELERATION")
    if kind.upper() not in _ESM_KINDS:
        raise text.no_acceleration(
            f"DATA_TYPE: found {kind!r}; expected ACCELERATION", line
        )
    unit = text.unit(*text.value(keys, "UNITS", "a unit of acceleration"), "UNITS")
    count = text.count(*text.value(keys, "NDATA", "a number of values"))
    dt = text.step(*text.value(keys, "SAMPLING_INTERVAL_S", "a step in s"))
    duration, line = keys.get("DURATION_S", ("", 0))
    if duration:
        text.agree(count, dt, duration, line)
    pga = next(
        (
            v
            for k, (v, _) in keys.items()
            if k.startswith("PGA_") and re.fullmatch(r"[-+\d.eE]+", v)
        ),
        None,
    )
    component = (
        keys.get("STREAM", ("", 0))[0] or keys.get("COMPONENT", ("", 0))[0] or None
    )
    return [Series(component, dt, text.numbers(count, Layout(1)), unit, pga)]


def _knet(text: RecordText) -> list[Series]:
    """Lines up to the memo, then counts; the header's Max. Acc. is the peak after their
    mean is removed.
    """
    keys = text.keys(_KNET_KEY, _KNET_MEMO)
    stated, line = text.value(
        keys,
        "Scale Factor",
        "a scale such as 7845(gal)/8223790, since counts have no unit",
    )
    scale = _KNET_SCALE.search(stated)
    if scale is None or not float(scale[2]) > 0.0:
        raise text.fault(
            f"Scale Factor: found {stated!r}; expected a value like 7845(gal)/8223790",
            line,
        )
    frequency, line = text.value(keys, "Sampling Freq")
    if (unit := _KNET_RATE.search(text.head)) is not None and unit[1].lower() != "hz":
        raise text.fault(
            f"found {unit[0]!r}; expected a sampling frequency in Hz", line
        )
    dt = text.step_of_rate(
        re.sub(r"\s*hz\s*$", "", frequency, flags=re.IGNORECASE), line
    )
    duration, line = text.value(keys, "Duration Time")
    count = text.count(f"{text.number(duration, line) / dt:.10g}", line)
    component, _ = text.value(keys, "Dir.")
    pga, _ = keys.get("MAX. ACC.", ("", 0))
    counts = text.numbers(count, Layout(8))
    samples = (counts - float(np.mean(counts))) * (float(scale[1]) / float(scale[2]))
    peak = pga if re.fullmatch(r"[\d.]+", pga) else None
    return [Series(component, dt, samples, "gal", peak)]


def _afad(text: RecordText) -> list[Series]:
    """Lines `KEY : value`, then three columns in gal, N-S, E-W and U-D."""
    keys = text.keys(_AFAD_KEY, _AFAD_COLUMNS)
    count = text.count(*text.value(keys, "NUMBER OF DATA"))
    dt = text.step(*text.value(keys, "SAMPLING INTERVAL"))
    unit = next((k for k in keys if "PGA VALUES" in k), "(GAL)")
    if "(GAL)" not in unit:
        raise text.fault(f"found {unit!r}; expected a record in gal", keys[unit][1])
    pgas = dict(re.findall(r"\(([^)]+)\)\s*([-+.\dEe]+)", keys.get(unit, ("", 0))[0]))
    values = text.rows(count, Layout(3))
    return [
        Series(name, dt, values[:, i], "gal", pgas.get(name))
        for i, name in enumerate(keys[""][0].split())
    ]


def _cwb(text: RecordText) -> list[Series]:
    """Lines `#Key: value`, then columns of time [s] and three components in gal."""
    keys = text.keys(_CWB_KEY)
    word, line = text.value(keys, "AmplitudeUnit")
    unit = text.unit(word.split()[0], line, "AmplitudeUnit")
    names = _CWB_COMPONENT.findall(text.value(keys, "DataSequence")[0])
    stated, line = text.value(keys, "Data")
    layout = fortran_layout(f"({stated})")
    if not names or layout is None or layout.columns != 1 + len(names):
        raise text.fault(
            f"Data: found {stated!r} for a time and {', '.join(names)}; expected a"
            " value like 4F10.3",
            line,
        )
    dt = text.step_of_rate(*text.value(keys, "SampleRate"))
    length, line = text.value(keys, "RecordLength")
    count, first = text.count(f"{text.number(length, line) / dt:.10g}", line), text.line
    values = text.rows(count, layout)
    text.agree(count, even_step(values[:, 0], text, first), length, line)
    found = []
    for i, name in enumerate(names, 1):
        pga = max(
            _CWB_PGA.findall(keys.get(f"AMPLITUDEMAX. {name}", ("", 0))[0]),
            key=float,
            default=None,
        )
        found.append(Series(name, dt, values[:, i], unit, pga))
    return found


FORMATS = (
    Format(
        "ESM",
        begins(r"EVENT_NAME:(?=[\s\S]*SAMPLING_INTERVAL_S)(?=[\s\S]*NDATA)"),
        _esm,
    ),
    Format(
        "CWB",
        begins(
            r"#(?=[\s\S]*#SampleRate\(Hz\):)(?=[\s\S]*#AmplitudeUnit:)"
            r"(?=[\s\S]*#DataSequence:)"
        ),
        _cwb,
    ),
    Format(
        "K-NET",
        begins(r"Origin Time(?=[\s\S]*Sampling Freq)(?=[\s\S]*Scale Factor)"),
        _knet,
    ),
    Format("AFAD", begins("STRONG GROUND MOTION RECORDS OF T"), _afad),
)
