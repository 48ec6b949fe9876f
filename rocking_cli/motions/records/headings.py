"""What the heading of a column says: its quantity, its unit, its direction.

A heading is a name and a unit, as `Acc NS [gal]`, `t (s)`, `a, m/s2`, `acc_g`, `Zeit /
s`. Words that are in none of the lists below are not understood, and their column is
taken only where the user names it.
"""

import re
import unicodedata
from typing import NamedTuple

from .directions import is_direction
from .factors import states_factor
from .units import dimension_of, plain, time_unit, unit_of

TIME, PERIOD, FREQUENCY, INDEX = "time", "period", "frequency", "index"
ACCELERATION, BARE, UNKNOWN = "acceleration", "no quantity", "unknown"


def _listed(**words: str) -> dict[str, str]:
    return {word: name for name, text in words.items() for word in text.split()}


_FIRST = _listed(
    time="t time times tiempo zeit tempo temps zaman sure elapsed 时间 時間 时刻 時刻",
    period="period periods periodo periode periyot peryot tn 周期",
    frequency=(
        "f freq frequency frequencies frequencia frecuencia frequenza frequence"
        " frequenz frekans omega hz 频率 周波数"
    ),
    index="sample samples index idx no nr num number point points step i n k # id row",
)
_ACCELERATIONS = frozenset(
    _listed(
        acceleration=(
            "a ag ugdd xgdd acc accn accel accels acceleration accelerations"
            " accelerogram accelerograms accelerogramme accelerogramma acelerograma"
            " akzelerogramm accelerazione accelerazioni aceleracion aceleraciones"
            " aceleracao beschleunigung bodenbeschleunigung ivme ivmesi groundacc"
            " groundacceleration 加速度"
        )
    )
)
_OTHERS = _listed(
    velocity=(
        "скорость v vel vels velo veloc velocity velocities velocita velocidad vitesse"
        " geschwindigkeit hiz hizi 速度"
    ),
    displacement=(
        "drift drifts перемещение смещение d u dis disp disps displ displacement"
        " displacements desplazamiento spostamento deplacement verschiebung deplasman"
        " yerdegistirme 位移 変位"
    ),
    spectrum=(
        "spectrum spectra spectral spettro spettrale espectro espectral spektrum"
        " spektral spectre response psa sa rsa se sde sae psv sv sd rotd50 rotd100"
        " rotd00 uhs hvsr спектр geomean pseudo spa psacc spectrums 反应谱"
    ),
)
_OTHERS |= _listed(
    envelope="envelope max min peak pga pgv pgd maximum minimum rms mean abs",
    force="force forces kraft fuerza forza load loads shear moment reaction weight",
    counts="count counts adc raw digit volt volts voltage",
    stress="stress strain ε σ pressure pressione presion druck",
    rotation="rotation rotational angular angle theta rot tilt",
    jerk="jerk",
    temperature="temperature temp",
)
_OTHERS |= {
    "fourier": "Fourier spectrum",
    "fft": "Fourier spectrum",
    "fas": "Fourier spectrum",
    "psd": "power spectrum",
    "arias": "Arias intensity",
    "ia": "Arias intensity",
    "husid": "Arias intensity",
    "cav": "cumulative absolute velocity",
    "intensity": "intensity",
    "energy": "energy",
    "power": "power",
}
NEUTRAL = frozenset(
    _listed(
        neutral=(
            "value values amplitude amplitudes signal data record records motion ground"
            " input series history histories channel channels chan ch col column comp"
            " component pulse y corrected uncorrected filtered unfiltered processed"
            " unprocessed total base free field recorded measured scaled unscaled of"
            " the in unit units and baseline dir direction th canal kanal bilesen"
            " componente komponente"
        )
    )
)
_LONGEST = 200  # characters of a heading that may be understood
_LETTERS_WITH_DIRECTION = re.compile(
    r"(acc|accel|acceleration|ag|vel|velocity|disp|displ|displacement|dis)"
    r"(x|y|z|ns|ew|ud|n|e|w|s|h1|h2|h|l|t)|([avdu])(x|y|z|ns|ew|ud)"
)
_GLUED = {
    "ms2": "m/s2",
    "mps2": "m/s2",
    "cms2": "cm/s2",
    "cmps2": "cm/s2",
    "mms2": "mm/s2",
}
_BRACKETS = re.compile(r"[\[({<]([^\[\](){}<>]*)[\])}>]")
_INNER = re.compile(r"/\(([^()]*)\)|\^[({]([^(){}]*)[)}]")
_TAIL = re.compile(r"(.*?\S)\s*(?:[,:=|]|\bin\b|\s/)\s*([^,:=|]+)", re.IGNORECASE)
# ẍ, ü_g: two derivatives
_DOTS = re.compile(r"[a-zθ](\u0308|\u0307)[ _]?g?[ _]?(?:\(t\))?")
_DERIVED = re.compile(
    r"\b(?:integra(?:l|ted|ls)|squared?|derivative|differentiated|cumulative|cumulated"
    r"|log|ln|deviation|variance)\b"
    r"|^\|.*\|$"
    r"|^[^/]*[a-z]\s*(?:\^\s*2|\*\*\s*2|²)\s*$"
)
_OF_A_DIRECTION = re.compile(
    r"(?i)[-\s_.]*\b(?:comp(?:onent)?|dir(?:ection)?)\b\.?[-\s_.]*"
)
# a word, or one with brackets, which may hold blanks
_PIECE = re.compile(r"[^\s\[({<]*[\[({<][^\])}>]{0,200}[\])}>][^\s\[({<]*|\S+")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_SPLIT = re.compile(r"[\s_.,:;/|\-\"']+")


class HeadingCell(NamedTuple):
    """What one heading says."""

    text: str  # the heading as the file has it
    role: str  # TIME … UNKNOWN, or the name of another quantity
    unit: str | None = None  # unit of acceleration
    seconds: float | None = None  # unit of time [s]
    component: str | None = None  # the direction, as the file has it
    odd: str = ""  # the words that are not understood, or the unit of something else

    @property
    def is_time_or_like(self) -> bool:
        """True for what stands in a first column: times,
        periods, frequencies, numbers.
        """
        return self.role in (TIME, PERIOD, FREQUENCY, INDEX)

    @property
    def is_other(self) -> bool:
        """True for a quantity that is known and no acceleration."""
        return (
            self.role not in (ACCELERATION, BARE, UNKNOWN) and not self.is_time_or_like
        )


def cell_of(text: str, first: bool = True) -> HeadingCell:
    """Return what the heading of a column says; first: whether it is
    the first column.
    """
    text = re.sub(r"^[#%](?=[^\W\d_]{2,})", "", text.strip().strip("\"'").strip())
    if len(text) > _LONGEST:
        return HeadingCell(text, UNKNOWN, odd=text)
    # The parts of the heading: units of acceleration, of time, and other (foreign)
    # ones, and the role that the name states.
    name, units, asides = _parted(text)
    accelerations = [unit for x in units if (unit := unit_of(x))]
    times = [time for x in units if (time := time_unit(x)) is not None]
    foreign = [x for x in units if not unit_of(x) and time_unit(x) is None]
    role, odd = _role(name)
    if not first and name.strip() in ("T", "N", "n"):  # transverse, north
        role = BARE

    component = None
    if role in (ACCELERATION, BARE):
        directions = [
            x for x in [*asides, *_directions(name)] if x != "t" and is_direction(x)
        ]
        component = next(iter(directions), None)
    unread = [
        x for x in asides if not is_direction(x) and not _is_neutral(x) and x != "t"
    ]

    # A unit decides what a bare name is.
    if accelerations and role == BARE and not odd:
        role = ACCELERATION
    if times and role == BARE and component is None:
        role = TIME
    # A text that contradicts the name, or is not understood, makes the column unknown;
    # `odd` is this text.
    if foreign and role in (ACCELERATION, BARE, UNKNOWN):
        dimension = dimension_of(foreign[0])
        other = dimension not in (None, "unknown") and role != ACCELERATION
        role, odd = dimension if dimension and other else UNKNOWN, foreign[0]
    elif times and role in (ACCELERATION, UNKNOWN) and not accelerations:
        role, odd = UNKNOWN, units[0]
    elif unread and role in (ACCELERATION, BARE):
        role, odd = UNKNOWN, unread[0]
    elif role == TIME and (foreign or [x for x in asides if x not in units]):
        role, odd = UNKNOWN, [*foreign, *asides][0]
    if role != UNKNOWN and states_factor(text):
        role, odd = UNKNOWN, text
    known, seconds = next(iter(accelerations), None), next(iter(times), None)
    return HeadingCell(text, role, known, seconds, component, odd)


def units_row(cells: list[str]) -> list[str] | None:
    """Return the units of a row such as `[s],[g]` or `s,m/s2`; None if one
    is no unit.
    """
    whole = [x.strip().strip("\"'") for x in cells]
    held = [_BRACKETS.fullmatch(x) for x in whole]
    bare = [found[1] if found else x for found, x in zip(held, whole, strict=True)]
    first = bare[0] if bare else ""
    if time_unit(first) is None and unit_of(first) is None:
        return None
    return bare if all(dimension_of(x) for x in bare) else None


def cells_in(line: str) -> list[str]:
    """Return the headings of a line without separators, as `Time (s) Acc NS (g)`."""
    found: list[str] = []
    for piece in _PIECE.findall(line):
        alone = _BRACKETS.fullmatch(piece)
        if alone and found and not _BRACKETS.search(found[-1]):
            found[-1] += " " + piece
        else:
            found.append(piece)
    return found


def others_in(words: str) -> list[str]:
    """Return the quantities but accelerations that words of several letters name."""
    tokens = [x for x in _SPLIT.split(_BRACKETS.sub(" ", plain(words))) if len(x) > 2]
    return [_OTHERS[x] for x in tokens if x in _OTHERS]


def names_acceleration(words: str) -> bool:
    """True if one of the words is a word for acceleration."""
    tokens = [x for x in re.split(r"[^a-z加速度]+", plain(words)) if len(x) > 2]
    return any(x in _ACCELERATIONS or x.startswith("acceler") for x in tokens)


def _parted(text: str) -> tuple[str, list[str], list[str]]:
    """(name, units, other words in brackets) of a heading."""
    whole = _INNER.sub(
        lambda found: f"/{found[1]}" if found[1] else f"^{found[2]}", text
    )
    ratio = re.fullmatch(r"([^/\[({]+?)\s*/\s*(.+)", text)  # a / (m/s²), as in DIN
    if (
        ratio is not None
        and _has_role(ratio[1])
        and dimension_of(ratio[2].strip("()[]"))
    ):
        return ratio[1], [ratio[2].strip("()[]")], []
    held = [
        re.sub(r"(?i)^in\s+", "", x.strip())
        for x in _BRACKETS.findall(whole)
        if x.strip()
    ]
    name = _BRACKETS.sub(" ", whole).strip()
    units = [x for x in held if dimension_of(x) or not _words_known(x)]
    if any(unit_of(x) for x in units):
        units = [x for x in units if unit_of(x) or not is_direction(x)]
    asides = [x for x in held if x not in units]
    if units:
        return name, units, asides
    letter = is_direction(name) and dimension_of(name) not in ("time", "acceleration")
    if dimension_of(name) and not _has_role(name) and not letter:
        return "", [name], asides
    tail = _TAIL.fullmatch(name)
    if tail is not None and (dimension_of(tail[2]) or re.search(r"/|\bin\b", name)):
        return tail[1], [tail[2].strip()], asides
    pieces = re.split(r"[\s_]+", name)
    for count in (1, 2):  # `acc_g`, `Acc cm/s2`, `acc m s-2`
        last = " ".join(pieces[-count:])
        first = name[: len(name) - len(last)].strip(" _")
        unit = _GLUED.get(plain(last), last)
        named = len(pieces) > count and dimension_of(unit) and _has_role(first)
        letter = is_direction(last) and not (unit_of(unit) or time_unit(unit))
        if named and not letter:
            return first, [unit], asides
    return name, [], asides


def _words_known(words: str) -> bool:
    return is_direction(words) or _is_neutral(words) or _role(words)[0] != UNKNOWN


def _is_neutral(words: str) -> bool:
    tokens = [x for x in _SPLIT.split(plain(words)) if x]
    return all(x in NEUTRAL or x.isdecimal() for x in tokens)


def _has_role(name: str) -> bool:
    return _role(name)[0] not in (UNKNOWN, BARE)


def _directions(name: str) -> list[str]:
    """The words of a name that may be its direction, the longest first."""
    if _DOTS.fullmatch(unicodedata.normalize("NFD", name.strip().casefold())):
        return []
    name = _OF_A_DIRECTION.sub(" ", name).strip() or name
    if is_direction(name) and not names_acceleration(name):
        return [name]
    name = re.sub(r"(?i)\b(acc\w*)\s*[-.]\s*(?=\w)", r"\1 ", name)  # Acc-NS
    words = [x for x in re.split(r"[\s_]+", _CAMEL.sub(" ", name)) if x]
    glued = [_LETTERS_WITH_DIRECTION.fullmatch(plain(x)) for x in words]
    ends = [found[2] or found[4] for found in glued if found is not None]
    alone = [x for x in words if plain(x) not in _ACCELERATIONS]
    joined = [" ".join(alone)] if len(alone) < len(words) else []
    return [*joined, *alone, *(x.upper() for x in ends)]


def is_derived(name: str) -> bool:
    """True for the name of what is made from a quantity, as acceleration squared."""
    return _DERIVED.search(name.strip().casefold()) is not None


def _role(name: str) -> tuple[str, str]:
    """(role, the words that are not understood) of a name."""
    if is_derived(name):
        return UNKNOWN, name.strip()
    if dots := _DOTS.fullmatch(unicodedata.normalize("NFD", name.strip().casefold())):
        return (ACCELERATION if dots[1] == "\u0308" else _OTHERS["velocity"]), ""
    if name.strip() == "T":  # a period; a time is t
        return PERIOD, ""
    if name.strip() == "N":  # north; a number is n
        return BARE, ""
    if not name.strip():
        return BARE, ""
    text = plain(name).strip()
    close = re.sub(r"[\s_.\-]+", "", text) if len(text) < 12 else text
    for known in (text, close):
        if known in _FIRST:
            return _FIRST[known], ""
        if known in _ACCELERATIONS:
            return ACCELERATION, ""
    if close in _OTHERS and (len(close) > 1 or not is_direction(name)):
        return _OTHERS[close], ""
    alone = _OF_A_DIRECTION.sub(" ", name).strip()
    if is_direction(alone) and not names_acceleration(name):
        return BARE, ""
    roles: list[str] = []
    odd: list[str] = []
    for token in (x for x in _SPLIT.split(plain(_CAMEL.sub(" ", name))) if x):
        role = _role_of_token(token)
        (odd if role == UNKNOWN else roles).append(token if role == UNKNOWN else role)
    for role in (*dict.fromkeys(_OTHERS.values()), ACCELERATION, PERIOD, FREQUENCY):
        if role in roles:
            return role, ""
    if odd:
        return UNKNOWN, " ".join(odd)
    first = [x for x in roles if x != BARE]
    return (first[0] if len(set(first)) == 1 else BARE), ""


def _role_of_token(token: str) -> str:
    """Return the role that one word of a heading states: BARE for a neutral word or a
    direction, UNKNOWN for a word that is not known.
    """
    if token in NEUTRAL or token.isdecimal():
        return BARE
    stem = token.rstrip("0123456789")
    for known in (token, stem):
        if known in _FIRST:
            return _FIRST[known]
        if known in _ACCELERATIONS:
            return ACCELERATION
        if known in _OTHERS and len(known) > 1:
            return _OTHERS[known]
        if known in NEUTRAL:
            return BARE
    if is_direction(token):
        return BARE
    if glued := _LETTERS_WITH_DIRECTION.fullmatch(token):
        stem = glued[1] or glued[3]
        return ACCELERATION if stem in _ACCELERATIONS else _OTHERS[stem]
    return UNKNOWN
