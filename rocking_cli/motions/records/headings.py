"""What the heading of a column says, in one grammar: a name and a unit, as `acc NS
[gal]`, `t (s)`, `a, m/s2`, `acc_g`, `Zeit / s`, `acceleration in g`.

The name is a time, an acceleration with or without a direction, or a direction alone.
"""

import re
import unicodedata
from collections.abc import Iterable
from typing import NamedTuple

from ...documents.quantities import FACTORS
from .directions import is_component
from .units import is_foreign, plain, time_unit, unit_of

TIME, INDEX, ACCELERATION, UNKNOWN = "time", "index", "acceleration", "unknown"
AMBIGUOUS = "direction or another quantity"
NO_UNIT = "no unit that is known:"  # with the word, of words that may be no heading


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_TIMES = _words("t time times zeit tiempo tempo temps zaman elapsed 时间 時間")
_INDICES = _words("# no nr index idx id i k row sample number")
ACCELERATION_NAMES = _words(
    "a ag acc accn accel accels acceleration accelerations accelerogram groundacc"
    " accelerazione aceleracion beschleunigung ivme 加速度"
)
# what a heading may name instead
_OTHERS = {
    "velocity": "v vel vels velo veloc velocity velocities velocita velocidad vitesse"
    " geschwindigkeit hiz скорость 速度",
    "displacement": "d u dis disp displ displacement displacements desplazamiento"
    " spostamento deplacement verschiebung deplasman drift перемещение смещение 変位",
    "period": "period periods periodo periode periyot tn",
    "frequency": "f freq frequency frequencies frecuencia frequenza frequence omega hz",
    "spectrum": "spectrum spectra spectral spettro espectro spektrum spectre response"
    " psa sa rsa se sd sv psv pseudo rotd50 rotd100 uhs hvsr fourier fft fas psd",
    "intensity": "arias ia husid cav intensity energy",
    "force": "force forces kraft load shear moment weight",
    "count": "count counts adc raw digit volt volts voltage",
    "stress": "stress strain pressure",
    "rotation": "rotation rotational angular angle theta rot tilt",
    "temperature": "temperature temp",
    "statistic": "envelope max min peak pga pgv pgd rms mean std sd sigma stdev"
    " standard deviation variance magnitude norm resultant",
    "transformed acceleration": "abs absolute relative log log10 ln integrated integral"
    " squared square cumulative derivative jerk normalized normalised scaled factor",
}
_OTHER = {word: role for role, words in _OTHERS.items() for word in words.split()}
_TRANSFORMED = re.compile(r"[|^²³√∫×*]|\bx\s*\d|^\s*[-−]\s*[^\W\d_]{3}|/\s*\d")
# alone, as a number such as 360: a direction or another quantity
_AMBIGUOUS = frozenset("uvdf")
_INNER = re.compile(r"/\(([^()]*)\)|\^[({]([^(){}]*)[)}]")  # m/(s^2), s^{-2}
_BRACKETS = re.compile(r"[\[({<]([^\[\](){}<>]*)[\])}>]")
_TAIL = re.compile(
    r"(.*?)\s*(?:[,:=_]|\s/|\bin\b|\s)\s*([^\s,:=_]+(?: s\S+)?)", re.IGNORECASE
)
_GLUED = re.compile(
    r"(?:acceleration|accel|acc|a)[-.]?(x|y|z|ns|ew|ud|n-s|e-w|u-d|[nez])"
)
_COMPONENT = re.compile(r"[-\s_.]*\b(?:comp(?:onent)?|dir(?:ection)?)\b\.?", re.I)
_SPLIT = re.compile(r"[\s_.,:;/\"']+")
_SECOND, _FIRST = "\u0308", "\u0307"  # two dots above a letter, or one: derivatives
LONGEST = 200  # characters of a heading


class Heading(NamedTuple):
    """What the heading of one column says."""

    text: str  # as the file has it
    role: str  # TIME, INDEX, ACCELERATION, UNKNOWN, or another quantity
    unit: str | None = None  # unit of acceleration
    seconds: float = 1.0  # unit of time [s]
    component: str | None = None  # the direction, as the file has it

    @property
    def is_other(self) -> bool:
        """True for a heading that names another quantity, whatever the options say."""
        return self.role not in (TIME, INDEX, ACCELERATION, UNKNOWN)


def heading_of(text: str, first: bool = False) -> Heading:
    """Return what a heading says; first: that of a first column, which may be times."""
    text = text.strip().strip("\"'").strip()
    if len(text) > LONGEST:
        return Heading(text, UNKNOWN)
    if not text or re.fullmatch(r"Unnamed: \d+", text):  # as pandas writes its index
        return Heading(text, INDEX if first else UNKNOWN)
    name, word = _parted(text, first)
    unit, seconds = unit_of(word), time_unit(word)
    if word and unit is None and seconds is None:
        known = is_foreign(word) or word in FACTORS or other_quantity(text)
        return Heading(text, f"{'quantity in' if known else NO_UNIT} {word}")
    role, component = _named(name, first, unit is not None)
    found = Heading(text, role, unit, seconds or 1.0, component)
    odd = word and (seconds if role == TIME else unit) is None and not found.is_other
    return Heading(text, f"{role} in {word}") if odd else found


def headings_of(words: Iterable[str]) -> list[Heading]:
    """Return what the headings of all columns say. A letter such as V that may be
    another quantity is a direction beside a heading that states one.
    """
    found: list[Heading] = []
    for word in words:
        found.append(heading_of(word, first=all(x.role == INDEX for x in found)))
    if any(x.role == ACCELERATION and x.component for x in found):
        found = [
            x._replace(role=ACCELERATION, component=x.text)
            if x.role == AMBIGUOUS and is_component(x.text)
            else x
            for x in found
        ]
    return found


def other_quantity(words: str) -> str | None:
    """Return the quantity, other than time and acceleration, that words name."""
    tokens = [x for x in _SPLIT.split(plain(words)) if len(x) > 1]
    return next((_OTHER[x] for x in tokens if x in _OTHER), None)


def _parted(text: str, first: bool) -> tuple[str, str]:
    """(name, unit, "" without one) of a heading."""
    whole = _INNER.sub(lambda x: f"/{x[1]}" if x[1] else f"^{x[2]}", text)
    held = [re.sub(r"(?i)^in\s+", "", x.strip()) for x in _BRACKETS.findall(whole)]
    # a letter in brackets is a unit: (N) and (V) are newton and volt
    names = [x for x in held if len(x) > 1 and is_component(x)]
    names = [x for x in names if unit_of(x) is None and time_unit(x) is None]
    units = [x for x in held if x and x not in names]
    name = " ".join([_BRACKETS.sub(" ", whole).strip(" /,:="), *names])
    if units:
        return name, next((x for x in units if not unit_of(x)), units[0])
    alone = unit_of(name) or is_foreign(name)
    if alone or (first and time_unit(name) and name.casefold() != "h"):
        return "", name
    if tail := _TAIL.fullmatch(name):  # `acc_g`, `acc m s-2`, `acc in cm/s2`
        before, word = tail[1].strip(), tail[2]
        timed = plain(before) in _TIMES and time_unit(word) is not None
        if unit_of(word) or is_foreign(word) or timed:
            return before, word
    return name, ""


def _named(name: str, first: bool, accelerates: bool) -> tuple[str, str | None]:
    """(role, direction) of a name; accelerates: its unit is one of acceleration."""
    letters = unicodedata.normalize("NFD", name.strip().casefold())
    if re.fullmatch(rf"[a-z][{_SECOND}{_FIRST}]_?g?", letters):  # ü, ẍg
        return (ACCELERATION if _SECOND in letters else "velocity"), None
    if _TRANSFORMED.search(name):
        return "transformed acceleration", None
    if first and name.strip() == "T":  # a time is t
        return "period", None
    text = plain(name).strip()
    if first and text in _INDICES:
        return INDEX, None
    if text in _TIMES and (first or text != "t"):
        return TIME, None
    if not text:
        return (ACCELERATION if accelerates else TIME if first else UNKNOWN), None
    if (text in _AMBIGUOUS or text.isdecimal()) and not accelerates:
        return AMBIGUOUS, None
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    words = [x for x in re.split(r"[\s_]+", apart) if x]
    if other := other_quantity(apart) or other_quantity("".join(words)):
        return other, None
    rest = " ".join(y for x in words for y in _without_acceleration(x))
    rest = _COMPONENT.sub("", rest).strip()
    if rest and not is_component(rest):
        return UNKNOWN, None
    return ACCELERATION, rest or None


def _without_acceleration(word: str) -> list[str]:
    """Return the direction in a word such as accX, Acc-NS or az, none for acc; another
    word as it stands.
    """
    text = plain(word).strip(".,:;-/")
    if text in ACCELERATION_NAMES:
        return []
    glued = _GLUED.fullmatch(text)
    return [word[len(word) - len(glued[1]) :]] if glued else [word]
