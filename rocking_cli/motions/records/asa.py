"""ASA, Mexico's `ARCHIVO ESTANDAR DE ACELERACION` (Instituto de Ingeniería, UNAM):
lines `KEY : value`, where lists of channels stand between strokes, then a column a
channel.
"""

import re

from .record import Series
from .text import Keys, Layout, RecordText, begins

NAME = "ASA"
_KEY = re.compile(r"\s*([A-Z][^:]*?)\s*:\s*(.*)", re.IGNORECASE)
_NUMBERS = re.compile(
    r"^\s*[-+]?\d*\.?\d+(?:[ED][-+]?\d+)?(?:\s+[-+]?\d*\.?\d+(?:[ED][-+]?\d+)?)*\s*$",
    re.I,
)

recognise = begins(r"(?:.*\n){0,20}?.*ARCHIVO EST[AÁ]NDAR DE ACELERACI[OÓ]N")


def read(text: RecordText) -> list[Series]:
    """Return every channel. Raises DocumentError."""
    keys = _keys(text)
    names = _listed(text, keys, "ORIENTACION")
    width = len(names)
    steps = [
        text.step(x, n) for x, n in _of(text, keys, "INTERVALO DE MUESTREO", width)
    ]
    counts = [
        text.count(x, n) for x, n in _of(text, keys, "NUM. TOTAL DE MUESTRAS", width)
    ]
    peaks = _peaks(keys, width)
    key = next((k for k in keys if k.startswith("UNIDADES DE LOS DATOS")), None)
    if key is None:
        raise text.fault(
            "no value of UNIDADES DE LOS DATOS; expected a unit of acceleration", 1
        )
    unit = text.unit(*keys[key], "UNIDADES DE LOS DATOS")
    factor = next(
        (keys[k] for k in keys if k.startswith("FACTOR DE DECIMACION")), ("1", 1)
    )
    if factor[0] and text.number(*factor) != 1.0:
        raise text.fault(
            f"found {factor[0]!r}; expected FACTOR DE DECIMACION: 1", factor[1]
        )
    if len(set(counts)) > 1 or len(set(steps)) > 1:
        raise text.fault(
            "channels of different lengths or steps, which are not read", 1
        )
    values = text.rows(counts[0], Layout(width))
    found = zip(names, steps, values.T, peaks, strict=True)
    return [Series(name, dt, x.copy(), unit, pga) for name, dt, x, pga in found]


def _keys(text: RecordText) -> Keys:
    """The keys up to the first of two lines of numbers, comments and titles passed
    over.
    """
    found: Keys = {}
    while True:
        at, line = text.at, text.line
        words = text.lines(1)[0]
        if _NUMBERS.match(words):
            text.at, text.line = at, line
            return found
        if pair := _KEY.match(words):
            found.setdefault(pair[1].strip().upper(), (pair[2].strip(), line))


def _listed(text: RecordText, keys: Keys, begin: str) -> list[str]:
    """The values of a key between strokes. Raises DocumentError without any."""
    key = next((k for k in keys if k.startswith(begin)), begin)
    value, line = text.value(keys, key, "values between strokes, such as /N00E/V/N90W")
    found = [x.strip() for x in value.split("/") if x.strip()]
    if not found:
        raise text.fault(
            f"{begin}: found {value!r}; expected values between strokes", line
        )
    return [_direction(x) if begin == "ORIENTACION" else x for x in found]


def _direction(said: str) -> str:
    """The direction of `S00E;L` or `V;+`, a bearing and an orientation."""
    bearing, _, name = (x.strip() for x in said.partition(";"))
    if name in ("+", "-"):
        return bearing if name == "+" else f"-{bearing}"
    return name or bearing


def _of(text: RecordText, keys: Keys, begin: str, width: int) -> list[tuple[str, int]]:
    key = next((k for k in keys if k.startswith(begin)), begin)
    found = _listed(text, keys, begin)
    line = keys[key][1]
    if len(found) < width:
        raise text.fault(f"{begin}: found {len(found)} values; expected {width}", line)
    return [(x, line) for x in found[:width]]


def _peaks(keys: Keys, width: int) -> list[str | None]:
    """The largest accelerations [gal] that the header states, None if
    it states none.
    """
    key = next((k for k in keys if re.match(r"ACEL\. ?MAX\.? ?\(GAL\)", k)), None)
    found = (
        [] if key is None else [x.strip() for x in keys[key][0].split("/") if x.strip()]
    )
    number = re.compile(r"[-+]?\d*\.?\d+")
    return [x if number.fullmatch(x) else None for x in found[:width]] + [None] * (
        width - len(found)
    )
