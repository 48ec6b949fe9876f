"""COSMOS V1 and V2: the header counts its lines of text, integers, reals and comments,
and states how numbers stand in them. The step is real-header value 62 in ms (34 is that
of the raw record). Points, step and duration have to agree.
"""

import re

import numpy as np

from .record import Series
from .text import FORTRAN, Layout, RecordText, begins, stated
from .units import ACCELERATIONS, is_foreign, unit_of

NAME = "COSMOS"
_FIRST = re.compile(
    r"\(Format\s+v(\d[\d.]*)\s+with\s+(\d+)\s+text lines\)", re.IGNORECASE
)
_COMMENTS = re.compile(r"^\s*(\d+)\s*comment line", re.IGNORECASE)
_BLOCK = re.compile(
    r"^\s*(\d+)\s+([\w.]+(?: [\w.]+)?)\s*(?:pts|points|counts)\b"
    rf".*?units\s*=\s*([^,(]+?)\s*(?:\(\s*(\d+)\s*\)|,).*?{FORTRAN}",
    re.IGNORECASE,
)
# as in `acceleration` and `uncor. accel.`
_ACCELERATION = re.compile(r"\bacc", re.IGNORECASE)
_APPROXIMATELY = re.compile(r"approx\s+([\d.]+)\s*secs", re.IGNORECASE)
_CHANNEL = re.compile(
    r"^\s*Sta\s+Cha\w*\s*\S*?\s*:\s*(?:\d+\s*:)?\s*(.*?)\s*(?:\(|$)", re.IGNORECASE
)
_CODE = re.compile(r"<SCNL>\s*[^.\s]*\.([^.\s]+)\.", re.IGNORECASE)
_UNITS = {2: "g", 4: "cm/s2", 10: "gal"}
# Places among the values of the real header, from 0.
_STEP_MS = 61
_LENGTH = 62
_PGA = 63
_RAW_STEP = 33
_NONE = -999.0  # a value that is not known

recognise = begins(rf".*{_FIRST.pattern}")


def read(text: RecordText) -> list[Series]:
    """Return the acceleration of every channel of the file. Raises DocumentError."""
    found: list[Series] = []
    others = ""
    while (first := text.find(_FIRST)) is not None:
        lines = text.lines(int(first[2]) - 1)
        _header(text, "integer")
        reals = _header(text, "real")
        lines += text.lines(int(text.like(_COMMENTS, "2 Comment line(s) follow")[1]))
        block = text.like(
            _BLOCK, "7000 acceleration pts, units=cm/sec2(04),Format=(8F10.5)"
        )
        count, layout = text.count(block[1]), Layout.of(block)
        if _ACCELERATION.search(block[2]):
            unit = _unit(text, block[3], block[4])
            dt = _step(text, reals, count, block.string)
            component = stated(_CODE, lines) or stated(_CHANNEL, lines) or None
            pga = f"{reals[_PGA]:.6f}" if reals[_PGA] not in (_NONE, 0.0) else None
            samples = text.numbers(count, layout)
            if (samples == _NONE).any():
                raise text.fault(
                    f"sample {np.argmax(samples == _NONE) + 1} is {_NONE}, which marks"
                    " an unknown value"
                )
            found.append(Series(component, dt, samples, unit, pga))
        else:
            others = f"{block[2]} in {block[3]}"
            text.skip(count, layout)
    if not found:
        raise text.no_acceleration(
            f"no acceleration, only {others}; expected an acceleration with a unit"
        )
    return found


def _unit(text: RecordText, word: str, code: str | None) -> str:
    """The unit of a block by its code, or by its word if it has none."""
    known = unit_of(word)
    unit = known if code is None else _UNITS.get(int(code))
    if unit is None:
        raise text.no_acceleration(
            f"found the unit {word!r} ({code or 'no code'}); expected cm/s2 (04), g"
            " (02) or gal (10)"
        )
    foreign = known is None and is_foreign(word)
    if foreign or (known is not None and ACCELERATIONS[known] != ACCELERATIONS[unit]):
        raise text.fault(
            f"found the unit {word!r} with the code {code}, which is {unit}"
        )
    return unit


def _header(text: RecordText, kind: str) -> np.ndarray:
    """Return the values of the integer or the real header. Raises DocumentError."""
    line = re.compile(
        rf"^\s*(\d+)\s*{kind}-header values follow on\s*\d+\s*lines.*?{FORTRAN}",
        re.IGNORECASE,
    )
    said = text.like(
        line, f"100 {kind}-header values follow on 10 lines, Format= (10I8)"
    )
    values = text.numbers(int(said[1]), Layout.of(said))
    if values.size <= _PGA:
        raise text.fault(
            f"{values.size} {kind}-header values; expected {_PGA + 1} or more"
        )
    return values


def _step(text: RecordText, reals: np.ndarray, count: int, line: str) -> float:
    """The step dt [s]; line: that before the values, which may state their duration."""
    step = reals[_STEP_MS] if reals[_STEP_MS] != _NONE else 1e3 * reals[_RAW_STEP]
    dt = text.step(f"{step:.12g}") / 1e3
    if reals[_LENGTH] > 0.0:
        text.agree(count, dt, f"{reals[_LENGTH]:.6g}")
    elif length := stated(_APPROXIMATELY, [line]):
        text.agree(count, dt, length, slack=1.0)
    return dt
