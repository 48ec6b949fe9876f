"""Units as files write them, in any case, spelling and encoding.

Accelerations keep one name each (`WRITTEN_UNITS`); times become their factor to
seconds.
"""

import re
import unicodedata

from ...documents.quantities import UNITS

ACCELERATIONS = {**UNITS["acceleration"], "g/10": 0.1 * UNITS["acceleration"]["g"]}
WRITTEN_UNITS = (
    "m/s2",
    "cm/s2",
    "mm/s2",
    "gal",
    "g",
    "mg",
    "%g",
    "g/10",
    "ft/s2",
    "in/s2",
)

_LETTERS = str.maketrans(
    {
        **dict.fromkeys("−‐‑–", "-"),
        **dict.fromkeys("⁄∕", "/"),
        **dict.fromkeys("·∙⋅•×", " "),
        **dict.fromkeys("^$'’", ""),
        "μ": "u",
        "ı": "i",  # Turkish
        "ß": "ss",
        "ø": "o",
    }
)
_SPELLINGS = (
    (r"\*\*", ""),
    (r"[({](-?\d)[)}]", r"\1"),  # s^(-2), s^{-2}
    (r"/\(([^()]*)\)", r"/\1"),  # m/(s*s)
    (r"\bper ?cent\b|\bpct\b", "%"),
    (r"\bper\b", "/"),
    (r"\bcms\b(?=/)", "cm"),  # CMS/SEC/SEC
    (r"(?<![a-z])centimet(?:er|re)s?(?![a-z])", "cm"),
    (r"(?<![a-z])millimet(?:er|re)s?(?![a-z])", "mm"),
    (r"(?<![a-z])met(?:er|re)s?(?![a-z])", "m"),
    (r"(?<![a-z])inch(?:es)?(?![a-z])", "in"),
    (r"(?<![a-z])(?:feet|foot)(?![a-z])", "ft"),
    (
        r"(?<![a-z])(m|u|milli|micro)?"
        r"(?:seconds?|secs?|segundos?|segs?|sekunden?|sek|saniye|sn|秒)(?![a-z])",
        r"\1s",
    ),
    (r"\bmillis\b", "ms"),
    (r"\bmicros\b", "us"),
    (r"\s*(?:squared|square)\b", "2"),
    (r"(?<=[a-z])\.(?=[a-z])|\*", " "),
    (r"\s*/\s*", "/"),
    (r"\s+", " "),
)
_ACCELERATION = re.compile(
    r"(m|cm|mm|ft|in) ?(?:/s/s|/s ?2|/s[ -]s|/s{2}|p?s ?-?2|s-1 ?s-1)"
)
_NAMED = {
    "%g": "%g|% g|%of g|% of g",
    "mg": "mg|milli-g",
    "g/10": "g/10",
    "gal": "gal|gals",
    "g": "g|g0|gn|gs|gravity|units of g|fraction of g|g-units",
}
_NAMES = {word: unit for unit, words in _NAMED.items() for word in words.split("|")}
_TWICE = re.compile(r"(.+?) ?[(\[](.+)[)\]]")  # gal (cm/s/s)
_TIMES = {
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    **dict.fromkeys(("min", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0),
}
_SCALED = re.compile(r"(\d*\.?\d+(?:e[-+]?\d+)?|10-\d+) ?([a-z]+)")
# units of other quantities
_OTHERS = (
    "m/s|cm/s|mm/s|in/s|ft/s|m s-1|kine|hz|khz|1/s|um|km|kn|kgf|lbf|kip|kips|count"
    "|counts|cts|lsb|volt|volts|mv|uv|pa|kpa|mpa|psi|rad|mrad|deg|rad/s|rad/s2|deg/s"
    "|m/s3|g/s|g2/hz|m2/s3|db|ustrain"
)
_FOREIGN = frozenset(_OTHERS.split("|"))


def plain(words: str) -> str:
    """Return words in small letters without accents, with plain digits and signs."""
    flat = unicodedata.normalize("NFKC", words).casefold()
    flat = unicodedata.normalize("NFKD", flat.translate(_LETTERS))
    return "".join(x for x in flat if not unicodedata.combining(x)).translate(_LETTERS)


def _spelled(word: str) -> str:
    """Return a unit in the one spelling that the tables of this file have."""
    found = plain(word).strip(' .,:;"')
    for pattern, by in _SPELLINGS:
        found = re.sub(pattern, by, found)
    return found.strip(" .,:;")


def unit_of(word: str) -> str | None:
    """Return the unit of acceleration that a file writes as cm/sec/sec, CM/S^2 or gals.

    None for any other word, such as cm/sec.
    """
    found = _spelled(word)
    if both := _TWICE.fullmatch(found):
        first, second = unit_of(both[1]), unit_of(both[2])
        same = first and second and ACCELERATIONS[first] == ACCELERATIONS[second]
        return first if same else None
    if length := _ACCELERATION.fullmatch(found):
        return f"{length[1]}/s2"
    return _NAMES.get(found)


def time_unit(word: str) -> float | None:
    """Return the seconds of a unit of time, such as msec or 1e-3 s; None for others."""
    found = _spelled(word)
    if found in _TIMES:
        return _TIMES[found]
    scaled = _SCALED.fullmatch(found)
    if scaled is None or scaled[2] not in _TIMES:
        return None
    power = re.fullmatch(r"10(-\d+)", scaled[1])
    return (10.0 ** int(power[1]) if power else float(scaled[1])) * _TIMES[scaled[2]]


def is_foreign(word: str) -> bool:
    """True for a unit of another quantity than acceleration and time, such as cm/s."""
    return _spelled(word) in _FOREIGN


def require_known(word: str) -> str | None:
    """Return the unit of acceleration that a user states; None for any other word."""
    return word if word in ACCELERATIONS else unit_of(word)
