"""Units as the files of strangers write them, in any case, spelling and encoding.

Accelerations keep one name each (`WRITTEN_UNITS`); times become their factor to
seconds. A word that is a unit of something else is known by its dimension, so that it
can be refused with the right reason.
"""

import re
import unicodedata

from ...documents.quantities import UNITS

ACCELERATIONS = UNITS["acceleration"]
WRITTEN_UNITS = ("m/s2", "cm/s2", "mm/s2", "gal", "g", "mg", "%g", "ft/s2", "in/s2")

_LETTERS = str.maketrans(
    {
        "−": "-",  # minus sign
        "‐": "-",  # hyphen
        "‑": "-",  # hyphen that does not break
        "–": "-",  # dash
        "⁄": "/",  # fraction slash
        "∕": "/",  # division slash
        "μ": "u",
        "·": " ",
        "∙": " ",
        "⋅": " ",
        "•": " ",
        "×": " ",
        "^": "",
        "$": "",
        "'": "",
        "’": "",
        "ı": "i",  # Turkish
        "ß": "ss",
        "ø": "o",
    }
)
_WORDS = (
    (r"\*\*", ""),
    (r"[({](-?\d)[)}]", r"\1"),  # s^(-2), s^{-2}
    (r"/\(([^()]*)\)", r"/\1"),  # m/(s*s)
    (r"\bper ?cent\b|\bpct\b|\bprozent\b|\bpor ciento\b", "%"),
    (r"\bper\b|\bpro\b|\bpor\b", "/"),
    (r"(?<![a-z])(?:centimet(?:er|re)s?|centimetros?|zentimeter)(?![a-z])", "cm"),
    (r"(?<![a-z])(?:millimet(?:er|re)s?|milimetros?)(?![a-z])", "mm"),
    (r"(?<![a-z])(?:met(?:er|re)s?|metros?|metri)(?![a-z])", "m"),
    (r"(?<![a-z])(?:inch(?:es)?)(?![a-z])", "in"),
    (r"(?<![a-z])(?:feet|foot)(?![a-z])", "ft"),
    (
        r"(?<![a-z])(m|u|milli|mili|micro|mikro)?"
        r"(?:seconds?|secs?|seconde[ns]?|segundos?|segs?|secondi|"
        r"sekunden?|sek|saniye|sn|秒)(?![a-z])",
        r"\1s",
    ),
    (r"\b(?:milli|mili)s\b", "ms"),
    (r"\b(?:micro|mikro)s\b", "us"),
    (r"\s*(?:squared|square|sq\.?|cuadrado|quadrat)\b", "2"),
    (r"(?<=[a-z])\.(?=[a-z])|\*", " "),
    (r"\s*/\s*", "/"),
    (r"\s+", " "),
)
_LENGTH_OVER_TIME = re.compile(
    r"(m|cm|mm|ft|in) ?(?:/s/s|/s ?2|/s[ -]s|/s ?/ ?s|/s{2}|s ?-2|s-1 ?s-1)"
)
_GRAVITY = re.compile(
    r"(?:units? of |fractions? of )?(?:the )?(?:g(?:-units?|0|n|s)?|gravit(?:y|ies))"
)
_VALUE_OF_G = re.compile(r"\bg\s*=\s*[\d.]+\s*\S*", re.IGNORECASE)  # g = 9.81 m/s2
_BEFORE_A_UNIT = re.compile(
    r"in|en|of|units?|unidad(?:es)?|de|einheit|単位|单位|acc\w*\.?|aceler\w*"
)
_BOTH = re.compile(r"(.+?) ?[(\[](.+)[)\]]")  # gal (cm/s/s)
_TIMES = {
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    **dict.fromkeys(
        ("min", "mins", "minute", "minutes", "minuten", "minutos", "dk"), 60.0
    ),
    **dict.fromkeys(
        ("h", "hr", "hrs", "hour", "hours", "stunden", "horas", "ore"), 3600.0
    ),
}
_SCALED = re.compile(r"(?:x ?)?(\d*\.?\d+(?:e[-+]?\d+)?|10-\d+) ?(?:x ?)?([a-z]+)")
_RATES = {
    **dict.fromkeys(("hz", "hertz", "sps", "1/s", "s-1"), 1.0),
    **dict.fromkeys(("samples/s", "sample/s", "points/s", "pts/s", "muestras/s"), 1.0),
    "khz": 1e3,
}
_OTHERS = {
    "velocity": "m/s|cm/s|mm/s|km/s|in/s|ft/s|m s-1|cm s-1|ms-1|kine|kines",
    "length": "m|cm|mm|km|um|in|ft",
    "force": "n|kn|mn|kgf|tf|lb|lbf|kip|kips",
    "counts": "count|counts|cts|cnt|digit|digits|lsb|bit|bits",
    "voltage": "v|mv|uv|volt|volts",
    "stress": "pa|kpa|mpa|gpa|psi|ksi",
    "angle": "rad|mrad|urad|deg|degree|degrees|°",
    "rotation": "rad/s|rad/s2|deg/s|deg/s2|mrad/s",
    "share": "%|-|1",
    "jerk": "m/s3|cm/s3|g/s",
    "moment": "nm|knm|kn m|n m",
    "spectral density": "g s|cm s|m s|g2/hz|g/hz|m2/s3|m2/s4/hz|g2|m2/s4",
    "mass": "kg|t",
    "strain": "ustrain|microstrain|mm/mm",
    "temperature": "°c|k|c",
    "level": "db",
}
_DIMENSIONS = {
    unit: name for name, units in _OTHERS.items() for unit in units.split("|")
}
_LIKE = re.compile(r"(?:.*/)s\d?|.*[a-z] ?-\d|%.*|.*/hz")


def plain(words: str) -> str:
    """Return words in small letters without accents, with plain digits and signs."""
    flat = unicodedata.normalize("NFKC", words).casefold()
    flat = unicodedata.normalize("NFKD", flat.translate(_LETTERS))
    return "".join(x for x in flat if not unicodedata.combining(x)).translate(_LETTERS)


def spelled(word: str) -> str:
    """Return a unit in the one spelling that the tables of this file have."""
    found = plain(word).strip(' .,:;"')
    for pattern, by in _WORDS:
        found = re.sub(pattern, by, found)
    return found.strip(" .,:;")


def unit_of(word: str) -> str | None:
    """Return the unit of acceleration that a file writes as cm/sec/sec, CM/S^2 or gals.

    None for any other word, such as cm/sec.
    """
    found = spelled(word)
    if both := _BOTH.fullmatch(found):
        first, second = unit_of(both[1]), unit_of(both[2])
        same = first and second and ACCELERATIONS[first] == ACCELERATIONS[second]
        return first if same else None
    if length := _LENGTH_OVER_TIME.fullmatch(found):
        return f"{length[1]}/s2"
    if _GRAVITY.fullmatch(found):
        return "g"
    if found in ("gal", "gals", "gales"):
        return "gal"
    if re.fullmatch(r"(?:mg|milli ?-?g)", found):
        return "mg"
    return "%g" if re.fullmatch(r"% ?(?:of )?g", found) else None


def units_in(words: str) -> list[str]:
    """Return the units of acceleration that a line states in any place.

    A unit of letters alone, such as g or gal, has to stand between commas or behind a
    word such as `in`; a unit behind a number is that of a value, as in PGA 0.25 m/s2.
    """
    found: list[str] = []
    for field in re.split(r"[,;\t|]", _VALUE_OF_G.sub(" ", words)):
        if alone := unit_of(field):
            found.append(alone)
            continue
        for piece in re.split(r"[:=()\[\]{}]", field):
            apart = re.sub(r"(?<=[a-zA-Z])-(?=[a-zA-Z])", " ", piece)
            found += _units_of_tokens(apart.split())
    return list(dict.fromkeys(found))


def _units_of_tokens(tokens: list[str]) -> list[str]:
    """Return the units of acceleration among words; a unit has up to three words. A
    unit of letters alone counts after a word such as `in` only, and a unit after a
    number belongs to that number.
    """
    found: list[str] = []
    at = 0
    while at < len(tokens):
        before = plain(tokens[at - 1]) if at else ""
        size = 0
        for size in (3, 2, 1):
            phrase = " ".join(tokens[at : at + size])
            letters = spelled(phrase).isalpha()
            stated = not letters or _BEFORE_A_UNIT.fullmatch(before)
            if at + size <= len(tokens) and stated and unit_of(phrase):
                if not re.match(r"[-+]?\.?\d", before):
                    found.append(unit_of(phrase) or "")
                break
        else:
            size = 1
        at += size
    return found


def time_unit(word: str) -> float | None:
    """Return the seconds of a unit of time, such as msec or 1e-3 s; None for others."""
    found = spelled(word)
    if found in _TIMES:
        return _TIMES[found]
    scaled = _SCALED.fullmatch(found)
    if scaled is None or scaled[2] not in _TIMES:
        return None
    power = re.fullmatch(r"10(-\d+)", scaled[1])
    return (10.0 ** int(power[1]) if power else float(scaled[1])) * _TIMES[scaled[2]]


def rate_unit(word: str) -> float | None:
    """Return the Hz of a unit of a sampling rate, such as sps; None for others."""
    return _RATES.get(spelled(word))


def dimension_of(word: str) -> str | None:
    """Return the dimension of a word that is a unit or looks like one, else None."""
    if unit_of(word):
        return "acceleration"
    if time_unit(word) is not None:
        return "time"
    if rate_unit(word) is not None:
        return "frequency"
    found = spelled(word)
    if found in _DIMENSIONS:
        return _DIMENSIONS[found]
    return "unknown" if _LIKE.fullmatch(found) else None


def require_known(word: str) -> str | None:
    """Return the unit of acceleration that a user states; None for any other word."""
    return word if word in ACCELERATIONS else unit_of(word)
