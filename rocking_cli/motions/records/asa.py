"""ASA, Mexico's `ARCHIVO ESTANDAR DE ACELERACION` (Instituto de Ingeniería, UNAM):
lines `KEY : value`, where lists of channels stand between strokes, then a column a
channel.
"""

import re

from .record import Series
from .text import Keys, Layout, RecordText, begins

NAME = "ASA"
_KEY = re.compile(r"\s*([A-Z][^:]*?)\s*:\s*(.*)", re.IGNORECASE)
_NUMBER = re.compile(r"[-+]?\d*\.?\d+")
_NUMBERS = re.compile(
    r"^\s*[-+]?\d*\.?\d+(?:[ED][-+]?\d+)?(?:\s+[-+]?\d*\.?\d+(?:[ED][-+]?\d+)?)*\s*$",
    re.I,
)

recognise = begins(r"(?:.*\n){0,20}?.*ARCHIVO EST[AÁ]NDAR DE ACELERACI[OÓ]N")


def read(text: RecordText) -> list[Series]:
    """Return every channel. Raises DocumentError."""
    keys = _keys(text)
    names = [_direction(x) for x, _ in _listed(text, keys, "ORIENTACION")]
    width = len(names)
    steps = [text.step(*x) for x in _listed(text, keys, "INTERVALO DE MUESTREO", width)]
    counts = [
        text.count(*x) for x in _listed(text, keys, "NUM. TOTAL DE MUESTRAS", width)
    ]
    if len(set(counts)) > 1 or len(set(steps)) > 1:
        raise text.fault(
            "channels of different lengths or steps, which are not read", 1
        )
    said, line = _stated(text, keys, "UNIDADES DE LOS DATOS", "a unit of acceleration")
    unit = text.unit(said, line, "UNIDADES DE LOS DATOS")
    factor, line = keys.get(_key(keys, "FACTOR DE DECIMACION"), ("", 1))
    if factor and text.number(factor, line) != 1.0:
        raise text.fault(f"found {factor!r}; expected FACTOR DE DECIMACION: 1", line)
    key = next((k for k in keys if re.match(r"ACEL\. ?MAX\.? ?\(GAL\)", k)), "")
    listed = [x.strip() for x in keys.get(key, ("", 1))[0].split("/") if x.strip()]
    peaks = [x if _NUMBER.fullmatch(x) else None for x in listed] + [None] * width
    values = text.rows(counts[0], Layout(width)).T
    found = zip(names, steps, values, peaks, strict=False)
    return [Series(name, dt, x.copy(), unit, pga) for name, dt, x, pga in found]


def _keys(text: RecordText) -> Keys:
    """The keys up to the first line of numbers, comments and titles passed over."""
    found: Keys = {}
    while True:
        at, line = text.at, text.line
        words = text.lines(1)[0]
        if _NUMBERS.match(words):
            text.at, text.line = at, line
            return found
        if pair := _KEY.match(words):
            found.setdefault(pair[1].strip().upper(), (pair[2].strip(), line))


def _key(keys: Keys, begin: str) -> str:
    """The first key that begins so."""
    return next((k for k in keys if k.startswith(begin)), begin)


def _stated(text: RecordText, keys: Keys, begin: str, wanted: str) -> tuple[str, int]:
    """The value of a key, and its line. Raises DocumentError without one."""
    return text.value(keys, _key(keys, begin), wanted)


def _listed(
    text: RecordText, keys: Keys, begin: str, width: int = 1
) -> list[tuple[str, int]]:
    """The values of a key between strokes, each with its line. Raises DocumentError for
    fewer than `width`.
    """
    wanted = "values between strokes, such as /N00E/V/N90W"
    value, line = _stated(text, keys, begin, wanted)
    found = [(x.strip(), line) for x in value.split("/") if x.strip()]
    if len(found) < width:
        raise text.fault(
            f"{begin}: found {value!r}, {len(found)} values; expected {width} {wanted}",
            line,
        )
    return found


def _direction(said: str) -> str:
    """The direction of `S00E;L` or `V;+`, a bearing and an orientation."""
    bearing, _, name = (x.strip() for x in said.partition(";"))
    if name in ("+", "-"):
        return bearing if name == "+" else f"-{bearing}"
    return name or bearing
