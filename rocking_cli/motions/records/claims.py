"""What the lines above the numbers say: unit, step, rate, count, direction, quantity.

A line may be a title, which says none of these, and is passed over. A line that states
one of them has to be understood: it is refused with its words otherwise.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field

from .aims import begins_with_spectrum, names_spectrum, without_aim
from .directions import (
    direction_behind,
    is_direction,
    is_up_alone,
    up_at_end,
    vertical_by_angle,
)
from .factors import states_factor
from .headings import (
    ACCELERATION,
    UNKNOWN,
    cell_of,
    is_derived,
    names_acceleration,
    others_in,
)
from .units import (
    ACCELERATIONS,
    WRITTEN_UNITS,
    dimension_of,
    plain,
    rate_unit,
    time_unit,
    unit_of,
    units_in,
)

_NUM = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[ed][-+]?\d+)?)"
_UNIT = r"\s*(?:[\[(]\s*([^\])]{1,20})[\])])?"
_WORD = r"\s*((?:1e-3 |10-3 )?[a-z]+(?:/[a-z]+|-1)?\.?)?"
_KEY = r"\s*(?:[:=,;\t]|\bis\b|\bof\b|\bde\b)*\s*"
_STEP_WORDS = (
    r"\bd_?t\b|\bdelta[ _-]?t\b|\bδt\b|\btime["
    r" _-]?(?:step|interval|increment|spacing)\b|"
    r"\btimestep\b|\b(?:delta|ts)\b(?=\s*[:=])|\b(?:points|samples|values|pts)"
    r" at\b(?=[^a-z]*s)|"
    r"サンフリンク間隔|\bsampl(?:e|ing)[ _-]?(?:interval|period|step|time)\b|"
    r"\bintervalo de (?:muestreo|tiempo)\b|\bpaso (?:de tiempo|temporal)\b|\bpas de"
    r" temps\b|"
    r"\bpasso (?:temporale|di campionamento)\b|\bintervallo di campionamento\b|"
    r"\bzeitschritt\b|\babtastintervall\b|\bzaman (?:adimi|araligi)\b|"
    r"\bornekleme araligi\b|时间间隔|采样间隔|\b(?:time )?step(?:"
    r" size)?\b(?=\s*[\[(:=])|"
    r"\b(?:equally )?spaced (?:intervals )?(?:at|of|by)\b|"
    r"\binterval(?:s|o)? (?:of\b|de\b|:)|\bincrement\b|\bevery\b|\bat intervals of\b|"
    r"\bd\.\s?t\.|\bt_?step\b|\bsampling t\b|"
    r"^(?:interval|step)\b(?=\s*[:=]?\s*\.?\d[\d.e-]*\s*(?:m?s|secs?|seconds?|msec)\b)"
)
_RATE_WORDS = (
    r"^(?:frequency|freq|rate)\b(?=\s*[:=(]?\s*[\d(])|"
    r"\bsampl(?:e|ing|es)?["
    r" _-]?(?:rate|freq\w*)\b|\bsamplerate\b|\bsps\b|\bfs\b|\bf_s\b|"
    r"\bsamples per sec\w*\b|"
    r"\b(?:frecuencia|velocidad|tasa) de muestreo\b|\bfrequenza di campionamento\b|"
    r"\bfrequence d'?echantillonnage\b|\babtast(?:rate|frequenz)\b|\bornekleme"
    r" (?:frekansi|hizi)\b|"
    r"采样频率|采样率|サンフリンク周波数"
)
_COUNT_WORDS = (
    r"\bnpts\b|\bnpt\b|\bnpoints\b|\bndata\b|\bnum(?:ber|\.)? ?of ?(?:data"
    r" )?(?:points|samples|data|"
    r"values)\b|\bno\.? ?of ?(?:data )?(?:points|samples|data|values)\b|"
    r"\b(?:data )?points(?=\s*[:=])|\bsamples(?=\s*[:=])|\bnumero (?:de|di)"
    r" (?:muestras|puntos|datos|"
    r"punti|campioni)\b|\banzahl(?: der)?(?: \w+)?\b|\bcount(?=\s*[:=])|\bn(?=\s*=)"
)
_STEP = re.compile(rf"(?:{_STEP_WORDS}){_UNIT}{_KEY}(?:{_NUM}{_WORD})?")
_RATE = re.compile(rf"(?:{_RATE_WORDS}){_UNIT}{_KEY}(?:{_NUM}{_WORD})?")
_AT_RATE = re.compile(
    rf"(?:\bat\s+|^\s*|[,;]\s*){_NUM}\s*(hz|sps|khz|samples?/s\w*|pts/s\w*|samples per"
    r" sec\w*)(?![a-z])"
)
_NUMBER_BEFORE = re.compile(r"\d[.\d]*\s*$")  # of the number in `100 sps, 4.0 s`
_ALONE = re.compile(rf"\s*{_NUM}\s*(s|sec|secs|seconds?|ms|msec|us)\.?\s*")
_STEP_BEHIND = re.compile(
    rf"{_NUM}\s*(s|sec|secs|seconds?|ms|msec)\.?\s*(?:time |sampling )?"
    r"(?:steps?|intervals?|spacing|sampling)\b"
)
# a time by a name that does not say which: the step, or a period
_A_TIME = re.compile(
    r"\W*(?:t|h|tau|time|zeit|tiempo|tempo|temps|period|sec|s)(?!\w)"
    rf"\s*(?:[\[(]\s*[a-z]+\s*[\])])?\s*[:=,;]?\s*{_NUM}(?![\w/])"
)
_ARITHMETIC = re.compile(r"\s*(?:/|-|\.\.|\bx\b|\*)\s*[.\d]")  # 1/100, 0.01 - 0.02
_COUNT = re.compile(rf"(?:{_COUNT_WORDS}){_KEY}(\d+)(?![\d.])")
_SO_MANY = re.compile(
    r"\b(\d+)\s+(?:data )?(?:points|samples|pts|values)\b(?!\s*/|\s*per)"
)
_UNITS = re.compile(
    r"(?:\b(?:units?|einheit(?:en)?|unidad(?:es)?|unita|unites?|birim(?:i|ler)?)\b"
    r"|单位|単位)"
    r"(?:\s+of\s+\w+)?(?:\s*(?:[:=,;\t]|\b(?:of|are|is|in)\b)\s*)+(\S.*)"
)
_COMPONENT = re.compile(
    r"\b(?:comp(?:onent|onente)?|(?:ch(?:an(?:nel)?)?|chn|kanal|canale?)(?=[\s\d.:=])"
    r"|dir(?:ection|eccion|ezione)?|orientation|composante|richtung|bilesen|yon)"
    r"(?![a-z])\.?\s*(?:\d+\s*)?",
    re.IGNORECASE,
)
_NOT_OF_THE_RECORD = re.compile(
    r"\b(?:peak|max\w*|pg[avd]|vs"
    r" ?_?30|wave|magnitude|highest|largest)\b|\bvs\b|\b(?:arias|ia|cav)\b\D*\d"
)
_KEYED = re.compile(r"\s*[^:=]{1,60}[:=]\s*\S|[^,;\t]{1,60}[,;\t]\s*[-+]?\.?\d")
# a step behind something else in the key of a line, as of `velocity, cm/s, dt=0.01 s`
_STEP_AT_END = re.compile(
    rf"(?:^|[\s,;]+)(?:{_STEP_WORDS}|{_RATE_WORDS}|npts|points)[^,;]*$"
)
# the key of a line that says what the numbers are, as `Quantity: displacement`
_OF_THE_NUMBERS = re.compile(
    r"(?:physical )?quantity|(?:(?:data|record|file|channel) )?type(?: of data)?|data"
    r"|kind|parameter|values?|contents?|grandezza|magnitud|messgroesse|groesse"
)
# keys of a title, in which only a spectrum is refused
_OF_A_TITLE = re.compile(
    r"(?:(?:data|record|file|plot|figure) )?(?:title|titel|titolo|titulo|titre|name"
    r"|caption|description|heading|subject)"
)
_AFTER = re.compile(
    r"(?:\bin\b|[,:=])\s*(?:units? of\s+)?([^,:=;]+?)\s*(?=[;,]|\. |$)", re.IGNORECASE
)
_IN = re.compile(r"\bin\s+(?:units?\s+of\s+)?([^\s,;]+)", re.IGNORECASE)
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*(?:\([^()]*\)[^\[\]()]*)?)[\])]")
_MARKS = re.compile(r"^[\s#%!*;/\"'>|-]+(?=\S)")
_GAP = re.compile(r"\s{3,}")  # patterns may take the cube of its length
_UNLIKE = (
    "velocity",
    "displacement",
    "spectrum",
    "Fourier spectrum",
    "Arias intensity",
)
_BESIDE = re.compile(
    r"\bacc\w*\.?\s*(?:(?:time|series|history|data|values?|corrected|uncorrected)\s*)*"
    r"[\[(]\s*([^\])]+?)\s*[\])]",
    re.IGNORECASE,
)
_GOES_ON = frozenset(
    [
        "and",
        "at",
        "for",
        "with",
        "of",
        "in",
        "or",
        "n",
        "npts",
        "dt",
        "unit",
        "units",
        "values",
        "points",
    ]
)
_ACCELERATION = re.compile(r"\b(?:ac[ce]\w*|beschleunigung\w*|akzel\w*|ivme\w*)|加速度")
_LONG = 12 * " "  # a direction is shorter
_DECIMAL_COMMA = re.compile(r"(?<![\d.,])0,(\d+)(?![\d.,])")
_SLACK = 1e-3  # relative; two statements of a step that differ by less agree


@dataclass
class Claims:
    """What lines above the numbers say; a field is None where they say nothing."""

    fault: Callable[[str, int], Exception]  # makes the error of a line
    unit: str | None = None  # unit of acceleration
    step: float | None = None  # time step [s]
    count: int | None = None  # number of values
    component: str | None = None  # direction, as the file has it
    seconds: float | None = None  # unit of the times [s]
    acceleration: bool = False  # a line names an acceleration
    quoted: dict[str, str] = field(default_factory=dict)  # the line of each statement
    # a line that states the step or a period, as `T = 0.01 s`, and its number
    some_time: tuple[str, int] | None = None

    def take(self, line: str, at: int, strict: bool = False) -> None:
        """Take what a line says; strict: a line that is there to state the quantity.

        Raises the error of `fault` if it is not understood.
        """
        words = _GAP.sub("  ", _MARKS.sub("", line).strip().strip("\"'").strip())
        text = _DECIMAL_COMMA.sub(r"0.\1", plain(words))
        if not re.search(r"[^\W\d_]", text):
            return
        self._factor(words, at)
        self._quantity(text, words, at)
        if strict and self.acceleration:
            self._no_other(words, at)
        elif strict and begins_with_spectrum(text):
            raise self.fault(f"found {words!r}; expected an acceleration", at)
        self._units(text, words, at)
        for unit in () if _NOT_OF_THE_RECORD.search(text) else units_in(words):
            self.state("unit", unit, words, at)
        self._steps(text, words, at)
        self._counts(text, words)
        named = cell_of(words)
        if (len(words) > 1 or words in "zZ") and is_up_alone(words):
            self.component = words
        elif (
            named.role == ACCELERATION
            and not re.search("[:=]", words)
            and len(named.component or _LONG) < len(_LONG)
        ):
            self.component = named.component
        elif not _KEYED.match(words) and (up := up_at_end(words)) is not None:
            self.component = up
        self.component = vertical_by_angle(words) or self.component
        for found in _COMPONENT.finditer(words):
            said = direction_behind(words[found.end() :])
            if is_direction(said) or cell_of(said).component is not None:
                self.component = said if is_direction(said) else cell_of(said).component

    def state(self, name: str, value: object, words: str, at: int) -> None:
        """Keep one statement. Raises the error of `fault` if another line contradicts
        it.
        """
        before = getattr(self, name)
        if before is not None and not _same(before, value):
            said = f"found {words!r}, where {self.quoted[name]!r} says otherwise"
            raise self.fault(said, at)
        setattr(self, name, value)
        self.quoted.setdefault(name, words)

    def _factor(self, words: str, at: int) -> None:
        if states_factor(words):
            raise self.fault(
                f"found {words!r}, a factor; it is not known whether the numbers have"
                " it: apply it and take the line away",
                at,
            )

    def _quantity(self, text: str, words: str, at: int) -> None:
        """Refuse a line that names another quantity; take the unit
        of an acceleration.
        """
        said = without_aim(text)
        others = others_in(said)
        kind = dimension_of(words)
        if kind not in (None, "acceleration", "time", "frequency", "unknown"):
            raise self.fault(f"found {words!r}; expected an acceleration", at)
        if kind == "acceleration":
            self.state("unit", unit_of(words), words, at)
            return
        spectral = names_spectrum(said)
        if names_acceleration(words) and not spectral:
            if _NOT_OF_THE_RECORD.search(text):
                return
            self.acceleration = True
            self._unit_beside(words, at)
            return
        beside = _NOT_OF_THE_RECORD.search(text) or _KEYED.match(words)
        if (others or spectral) and not beside:
            raise self.fault(f"found {words!r}; expected an acceleration", at)
        if _KEYED.match(words):
            self._keyed(words, at)
            return
        for found in _IN.finditer(words):
            self._in(found[1], words, at)
        for bracket in _BRACKETS.finditer(words):
            held, kind = bracket[1], dimension_of(bracket[1])
            if re.search(r"\d", words[bracket.end() :]):  # Height (m) 28
                continue
            if kind not in (None, "acceleration", "time", "frequency", "share"):
                raise self.fault(f"found {words!r}; expected an acceleration", at)
            if kind == "acceleration":
                self.state("unit", unit_of(held), words, at)

    def _in(self, word: str, words: str, at: int) -> None:
        """Take the unit of a line such as `data in cm/s2`."""
        kind = dimension_of(word)
        if kind == "acceleration":
            self.state("unit", unit_of(word), words, at)
        elif kind in (
            "velocity",
            "counts",
            "voltage",
            "force",
            "stress",
            "jerk",
            "rotation",
        ):
            raise self.fault(f"found {words!r}; expected an acceleration", at)

    def _keyed(self, words: str, at: int) -> None:
        """Take a line such as `a: m/s2` or `velocity: cm/s`."""
        key, _, value = words.replace("=", ":", 1).partition(":")
        cell = cell_of(key)
        said, what = without_aim(plain(value)), plain(key).strip()
        self._before_step(what, words, at)
        spectral = names_spectrum(said)
        if (spectral and _OF_A_TITLE.fullmatch(what)) or (
            (spectral or others_in(said)) and _OF_THE_NUMBERS.fullmatch(what)
        ):
            raise self.fault(f"found {words!r}; expected an acceleration", at)
        number = re.match(r"\s*[-+]?\.?\d", value)
        unlike = cell.role in _UNLIKE and not _NOT_OF_THE_RECORD.search(plain(key))
        if not number and (unlike or (cell.is_other and dimension_of(value))):
            raise self.fault(f"found {words!r}; expected an acceleration", at)
        if cell.role != UNKNOWN and (unit := unit_of(value)):
            self.state("unit", unit, words, at)
        if cell.role == "time" and (seconds := time_unit(value)) is not None:
            self.state("seconds", seconds, words, at)

    def _before_step(self, key: str, words: str, at: int) -> None:
        """Refuse another quantity that a line names before its step."""
        first = _STEP_AT_END.search(key)
        named = without_aim(key[: first.start()]) if first is not None else ""
        if _NOT_OF_THE_RECORD.search(named) or ":" in named:
            return
        other = others_in(named) and not names_acceleration(named)
        if other or names_spectrum(named):
            raise self.fault(f"found {words!r}; expected an acceleration", at)

    def _unit_beside(self, words: str, at: int) -> None:
        """Take the unit that stands beside the word acceleration, or in its line."""
        if stated := units_in(words):
            self.state("unit", stated[0], words, at)
            return
        after = _BRACKETS.findall(words) + [x[1] for x in _AFTER.finditer(words)]
        after += [y.strip() for x in after for y in re.split(r"\band\b|\s{2,}", x)]
        for word in after:
            if unit := unit_of(re.sub(r"(?i)^units? of\s+", "", word)):
                self.state("unit", unit, words, at)
                return
        odd = [x for x in after if not x[:1].isdigit() and len(x) > 1]
        odd = [x for x in odd if dimension_of(x) not in (None, "time", "frequency")]
        beside = [x for x in _BESIDE.findall(words) if _unknown(x)]
        last = re.findall(r"\bin\s+(\S+)\s*$", words, re.IGNORECASE)
        for word in [*odd, *beside, *last]:
            raise self.fault(f"found the unit {word!r} in {words!r}", at)

    def _no_other(self, words: str, at: int) -> None:
        """Refuse a second quantity, and words that may be a unit, as ACCELERATION
        FURLONG.
        """
        said = _ACCELERATION.split(plain(words))[0]
        if is_derived(words) or set(others_in(said)) & {"velocity", "displacement"}:
            raise self.fault(f"found {words!r}; expected an acceleration", at)
        if self.unit is not None:
            return
        found = re.search(rf"(?i)(?:{_ACCELERATION.pattern})\.?\W*(.*)", words)
        rest = [] if found is None else re.findall(r"[^\s,:;()\[\]]+", found[1])
        odd = [x for x in rest if cell_of(x).role == UNKNOWN or _is_foreign(x)]
        if (
            odd
            and len(rest) <= 3
            and not re.search(r"(?i)\b(?:of|at|from|for)\b", words)
        ):
            raise self.fault(
                f"found {' '.join(odd)!r} in {words!r}; expected a unit", at
            )

    def _units(self, text: str, words: str, at: int) -> None:
        """State the units of acceleration, and of time, that a line names. Raises the
        fault of a unit that is not known.
        """
        found = _UNITS.search(text)
        if found is None:
            return
        said = found[1].strip().strip("()[] ")
        first = re.split(r"\.\s|\s{2,}|;", said)[0].strip(" .,()[]")
        whole = unit_of(said) or unit_of(first) or unit_of(found[1])
        units = [whole] if whole else []
        listed = re.split(r"\s*[,;&\t]\s*|\s+and\s+|\s+", first) if not whole else []
        for word in (x.strip("()[] ") for x in listed):
            if unit := unit_of(word):
                units.append(unit)
                continue
            if (seconds := time_unit(word)) is not None:
                self.state("seconds", seconds, words, at)
                continue
            if not units:
                raise self.fault(
                    f"found the unit {said!r}; expected {', '.join(WRITTEN_UNITS)}", at
                )
            break
        for unit in units:
            self.state("unit", unit, words, at)

    def _steps(self, text: str, words: str, at: int) -> None:
        """State the time step, or the sampling rate, that a line names."""
        if (alone := _ALONE.fullmatch(text)) is not None:
            self._step(alone[1], alone[2], words, at)
            return
        rates = [
            found
            for found in _RATE.finditer(text)
            if found[2] is not None and not _NUMBER_BEFORE.search(text[: found.start()])
        ]
        for found in rates:
            self._whole_number(text[found.end(2) :], words, at)
            self._rate(found, words, at)
        for found in _AT_RATE.finditer(text) if not rates else ():
            self._hertz(found[1], rate_unit(found[2]) or 1.0, words, at)
        if (behind := _STEP_BEHIND.match(text)) is not None:
            self._step(behind[1], behind[2], words, at)
        if self.step is None and _A_TIME.match(text) is not None:
            self.some_time = words, at
        for found in _STEP.finditer(text):
            if found[2] is not None:
                self._whole_number(text[found.end(2) :], words, at)
                self._step(found[2], found[3] or found[1] or "", words, at)
            elif found[0].rstrip()[-1:] in (":", "="):
                raise self.fault(
                    f"found {words!r}; expected a time step, such as 0.01 s", at
                )

    def _step(self, number: str, unit: str, words: str, at: int) -> None:
        """State a time step [s] from its number and unit; the unit may be one of a
        rate. Raises the fault of the line.
        """
        value = float(number.replace("d", "e"))
        if (rate := rate_unit(unit)) is not None and value > 0.0:
            self._hertz(number, rate, words, at)
            return
        seconds = time_unit(unit) if unit.strip(". ") else None
        if (unit.strip(". ") and seconds is None and _is_unit(unit)) or not value > 0.0:
            raise self.fault(
                f"found {words!r}; expected a time step, such as 0.01 s", at
            )
        if seconds is None and value >= 1.0:
            raise self.fault(f"found {words!r}, a time step without a unit", at)
        self.state("step", value * (seconds or 1.0), words, at)

    def _whole_number(self, behind: str, words: str, at: int) -> None:
        """Refuse a number that goes on, as of `dt = 1/100 s`."""
        if _ARITHMETIC.match(behind):
            raise self.fault(
                f"found {words!r}; expected one number, such as 0.01 s or 100 Hz", at
            )

    def _rate(self, found: re.Match[str], words: str, at: int) -> None:
        """State the time step of a sampling rate; the unit may be one of time. Raises
        the fault of the line.
        """
        unit = found[3] or found[1] or ""
        if time_unit(unit) is not None and unit:
            self._step(found[2], unit, words, at)
            return
        hertz = rate_unit(unit) if unit.strip() else None
        if unit.strip() and hertz is None and _is_unit(unit):
            raise self.fault(
                f"found {words!r}; expected a sampling rate, such as 100 Hz", at
            )
        if hertz is None and float(found[2].replace("d", "e")) < 1.0:
            raise self.fault(f"found {words!r}, a sampling rate without a unit", at)
        self._hertz(found[2], hertz or 1.0, words, at)

    def _hertz(self, number: str, hertz: float, words: str, at: int) -> None:
        value = float(number.replace("d", "e")) * hertz
        if not value > 0.0:
            raise self.fault(
                f"found {words!r}; expected a sampling rate, such as 100 Hz", at
            )
        self.state("step", 1.0 / value, words, at)

    def _counts(self, text: str, words: str) -> None:
        found = _COUNT.search(text) or _SO_MANY.search(text)
        if found is not None and self.count is None:
            self.count = int(found[1])
            self.quoted["count"] = words


def _is_unit(word: str) -> bool:
    """True if a word after a number claims to be its unit, and does not go
    on the text.
    """
    return word.strip(" .") not in _GOES_ON


def _is_foreign(word: str) -> bool:
    """True for a unit of something else, as CM/S."""
    return dimension_of(word) in (
        "velocity",
        "length",
        "force",
        "counts",
        "voltage",
        "stress",
    )


def _unknown(word: str) -> bool:
    """True if what stands in brackets beside a quantity is no words, and
    no known unit.
    """
    return (" " not in word or bool(re.search(r"\d", word))) and cell_of(
        word
    ).role == UNKNOWN


def _same(one: object, other: object) -> bool:
    """True if two statements agree: equal numbers to their digits, units of one size,
    or equal texts.
    """
    if isinstance(one, float) and isinstance(other, float):
        return agree(one, other)
    same_unit = one in ACCELERATIONS and other in ACCELERATIONS
    return (
        ACCELERATIONS[str(one)] == ACCELERATIONS[str(other)]
        if same_unit
        else one == other
    )


def agree(one: float, other: float) -> bool:
    """True if two steps [s] differ by no more than the digits that files print."""
    return abs(one - other) <= _SLACK * abs(one)
