"""COSMOS V1 and V2: the header says how many lines of text, integers, reals and comments there are, and how numbers stand in them.

The step is real-header value 62 in ms; value 34 is that of the raw record. Points, step and length have to agree.
"""

from __future__ import annotations

import re

import numpy as np

from ...documents.quantities import UNITS
from .numbers import Layout, fortran_layout
from .record import Series, unit_of
from .text import RecordText

NAME = "COSMOS"
_FIRST = re.compile(r"\(Format\s+v(\d[\d.]*)\s+with\s+(\d+)\s+text lines\)", re.IGNORECASE)
_NUMBERS = re.compile(r"^\s*(\d+)\s*(?:integer|real)-header values follow on\s*\d+\s*lines", re.IGNORECASE)
_COMMENTS = re.compile(r"^\s*(\d+)\s*comment line", re.IGNORECASE)
_BLOCK = re.compile(
    r"^\s*(\d+)\s+([\w.]+(?: [\w.]+)?)\s*(?:pts|points|counts)\b.*?units\s*=\s*([^,(]+?)\s*(?:\(\s*(\d+)\s*\)|,)", re.IGNORECASE
)
_ACCELERATION = re.compile(r"\bacc", re.IGNORECASE)  # as in `acceleration` and `uncor. accel.`
_APPROXIMATELY = re.compile(r"approx\s+([\d.]+)\s*secs", re.IGNORECASE)
_CHANNEL = re.compile(r"^\s*Sta\s+Cha\w*\s*\S*?\s*:\s*(?:\d+\s*:)?\s*(.*?)\s*(?:\(|$)", re.IGNORECASE)
_CODE = re.compile(r"<SCNL>\s*[^.\s]*\.([^.\s]+)\.", re.IGNORECASE)
_UNITS = {2: "g", 4: "cm/s2", 10: "gal"}
_STEP_MS, _LENGTH, _PEAK, _RAW_STEP = 61, 62, 63, 33  # places among the real-header values, from 0


def recognise(head: str) -> bool:
    """True if the first line states the COSMOS format."""
    return bool(_FIRST.search(head.lstrip().split("\n", 1)[0]))


def read(text: RecordText) -> list[Series]:
    """The acceleration of every channel of the file. Raises DocumentError."""
    found: list[Series] = []
    others = ""
    while (first := text.find(_FIRST)) is not None:
        lines = text.lines(int(first[2]) - 1)
        _header(text, "integer")
        reals = _header(text, "real")
        comments = text.next_line() or ""
        stated = _COMMENTS.match(comments)
        if stated is None:
            raise text.fault(f"found {comments.strip()!r}; expected the number of comment lines")
        lines += text.lines(int(stated[1]))
        line = text.next_line() or ""
        block, layout = _BLOCK.match(line), fortran_layout(line)
        if block is None or layout is None:
            raise text.fault(f"found {line.strip()!r}; expected a line like 7000 acceleration pts, units=cm/sec2(04),Format=(8F10.5)")
        count = text.count(block[1])
        if not _ACCELERATION.search(block[2]):
            others = f"{block[2]} in {block[3]}"
            text.skip(count, layout)
            text.demand_end(count)
            continue
        unit = _unit(text, block[3], block[4])
        dt = _step(text, reals, count, line)
        component = next((m[1] for x in lines if (m := _CODE.search(x))), None) or next(
            (m[1] for x in lines if (m := _CHANNEL.match(x))), None
        )
        peak = f"{reals[_PEAK]:.6f}" if reals[_PEAK] not in (-999.0, 0.0) else None
        found.append(Series(component or None, dt, text.numbers(count, layout), unit, peak))
        text.demand_end(count)
    if not found and others:
        raise text.no_acceleration(f"no acceleration, only {others}; expected an acceleration with a unit")
    if not found:
        raise text.fault("no channel")
    return found


def _unit(text: RecordText, word: str, code: str | None) -> str:
    """The unit of a block by its code, or by its word where it has none; raises where they contradict each other."""
    known, coded = unit_of(word), None if code is None else _UNITS.get(int(code))
    unit = known if code is None else coded
    if unit is None:
        raise text.no_acceleration(f"found the unit {word!r} ({code or 'no code'}); expected cm/s2 (04), g (02) and gal (10)")
    if known is not None and UNITS["acceleration"][known] != UNITS["acceleration"][unit]:
        raise text.fault(f"found the unit {word!r} with the code {code}, which is {unit}")
    return unit


def _header(text: RecordText, kind: str) -> np.ndarray:
    line = text.next_line() or ""
    stated, layout = _NUMBERS.match(line), fortran_layout(line)
    if stated is None or layout is None or kind not in line.lower():
        raise text.fault(f"found {line.strip()!r}; expected a line like 100 {kind}-header values follow on 10 lines, Format= (10I8)")
    values = text.numbers(int(stated[1]), Layout(*layout))
    if values.size <= _PEAK:
        raise text.fault(f"{values.size} {kind}-header values; expected {_PEAK + 1} or more")
    return values


def _step(text: RecordText, reals: np.ndarray, count: int, line: str) -> float:
    """dt [s]; raises where the points, the step and the length do not agree."""
    raw = reals[_RAW_STEP]
    dt = text.step(f"{reals[_STEP_MS] if reals[_STEP_MS] != -999.0 else 1e3 * raw:.12g}") / 1e3
    approximately = _APPROXIMATELY.search(line)
    if reals[_LENGTH] > 0.0:
        text.agree(count, dt, f"{reals[_LENGTH]:.6g}")
    elif approximately is not None:
        text.agree(count, dt, approximately[1], slack=1.0)
    return dt
