"""Keys of documents, each declared once: what its value is, its limits, what it means.

The reader, the JSON Schema, the lists of `rocking help documents`, the completion of
the shell and the comments of `rocking init` are made of these tables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

from .quantities import FACTORS, SMALLEST_LENGTH, UNITS, accepted, si_unit


class Usual(NamedTuple):
    """The values of a key that people mean; a number outside that states no unit was
    probably meant in another one.
    """

    least: float  # [SI]
    most: float  # [SI]
    # from the number to SI, by the units that may have been meant
    meant: Mapping[str, Callable[[float], float]]

    def doubt(self, number: float, unit: str) -> str:
        """Return a remark on a number without a unit, an empty text for a usual one."""
        if self.least <= number <= self.most:
            return ""
        likely = [
            f"{number:g} {form} = {x:.5g} {unit}".strip()
            for form, si in self.meant.items()
            if self.least <= (x := si(number)) <= self.most
        ]
        hint = f"; did you mean {' or '.join(likely)}?" if likely else ""
        found = (
            f"{number:g} without a unit is {number:g} {unit}" if unit else f"{number:g}"
        )
        usual = (
            f"{self.least:g} to {self.most:g}"
            if self.most < math.inf
            else f"{self.least:g} or more"
        )
        return f"{found}; usual is {usual}{hint}"


# the words of a range, ( and ) for ends that are not in it
_RANGES = {
    "[]": "from {} to {}",
    "[)": "from {} to below {}",
    "()": "between {} and {}",
    "(]": "above {} and up to {}",
    "[": "from {}",
    "(": "above {}",
    "]": "up to {1}",
    ")": "below {1}",
}


@dataclass(frozen=True, eq=False)
class Key:
    """One key of a document, or of a mapping inside it."""

    # a dimension of UNITS; or whole, choice, flag, text; pair: of quantities, pairs: a
    # list of them; name, names: of other parts of the document; part: a mapping, parts:
    # a list of mappings, named: a mapping of names to mappings; any: read otherwise
    form: str
    doc: str = ""  # what it is
    above: float = -math.inf  # the value itself must not reach it [SI]
    least: float = -math.inf  # the value may reach it [SI]
    below: float = math.inf  # the value itself must not reach it [SI]
    most: float = math.inf  # the value may reach it [SI]
    where: str = ""  # the range in words, by default made of the limits
    default: Any = None  # the value of an absent key [SI]
    # options of a choice; of other forms words that may stand in place of a value
    words: tuple[str, ...] = ()
    of: str = "length"  # dimension of pairs
    inner: Keys | None = None  # keys of the mappings; with a dimension: of one instead
    usual: Usual | None = None  # the values that people mean

    @property
    def is_quantity(self) -> bool:
        """True for a number with a unit."""
        return self.form in UNITS

    @property
    def low(self) -> float:
        """The lower limit [SI]."""
        return max(self.above, self.least)

    @property
    def high(self) -> float:
        """The upper limit [SI]."""
        return min(self.below, self.most)

    def narrowed(self, **limits: Any) -> Key:
        """Return the key with those of these fields that are not None."""
        given = {name: x for name, x in limits.items() if x is not None}
        return _narrowed(self, **given) if given else self

    def holds(self, number: float) -> bool:
        """True if a value [SI] is within the limits."""
        return self.above < number < self.below and self.least <= number <= self.most

    def range(self) -> str:
        """Return the accepted values in words."""
        return self.where or self._limits() + self._or_words()

    def told(self) -> str:
        """Return what it is in words, with its unit, its words or the keys in it."""
        if self.form == "choice":
            return f"{self.doc}: {' or '.join(self.words)}"
        unit = si_unit(self.form) if self.is_quantity else ""
        inner = self.inner.in_words() if self.inner and not self.is_quantity else ""
        more = [f" [{unit}]" * bool(unit), self._or_words(), f": {inner}" * bool(inner)]
        return self.doc + "".join(more)

    def _or_words(self) -> str:
        """Return the words in place of a value."""
        return "".join(f", or {word}" for word in self.words)

    def _limits(self) -> str:
        """Return the limits in words."""
        unit, scale = si_unit(self.form), 1.0
        if self.form == "angle":
            unit, scale = "deg", math.degrees(1.0)
        low = "(" if self.low == self.above else "["
        high = ")" if self.high == self.below else "]"
        ends = low * (self.low > -math.inf) + high * (self.high < math.inf)
        if not ends:
            return accepted(self.form)
        article = "an" if self.form[0] in "aeiou" else "a"
        if ends == "(" and self.above == 0.0:
            return f"a positive {self.form}"
        least, most = (
            f"{end * scale:g} {unit}".strip() for end in (self.low, self.high)
        )
        words = _RANGES[ends].format(least if len(ends) < 2 else least.split()[0], most)
        return f"{article} {self.form} {words}"


@lru_cache  # every row of a table asks for those of its columns
def _narrowed(key: Key, **limits: Any) -> Key:
    return replace(key, **limits)


@dataclass(frozen=True, eq=False)
class Keys:
    """The keys of a document, or of a mapping inside it."""

    required: Mapping[str, Key] = field(default_factory=dict)
    optional: Mapping[str, Key] = field(default_factory=dict)
    # groups of ways to say one thing, of which a document takes one
    ways: tuple[tuple[Keys, ...], ...] = ()

    @cached_property
    def all(self) -> dict[str, Key]:
        """The keys by name, in the order in which they are told."""
        ways = {
            k: key for group in self.ways for way in group for k, key in way.all.items()
        }
        return {**self.required, **ways, **self.optional}

    def __or__(self, other: Keys) -> Keys:
        return Keys(
            {**self.required, **other.required},
            {**self.optional, **other.optional},
            (*self.ways, *other.ways),
        )

    def way(self, stated: Iterable[str], group: int = 0) -> int:
        """Return the number of the way of a group that a document with these keys
        takes, the first one if it states no key of the group; -1 for none.
        """
        ways = self.ways[group]
        given = {key for key in stated if any(key in way.all for way in ways)}
        fits = (i for i, way in enumerate(ways) if given <= way.all.keys())
        return next(fits, -1)

    def in_words(self, explained: bool = False) -> str:
        """Return the keys in words: `height, stiffness (or length, area and modulus);
        optional: prestress, yield`; explained: each with what it is, without optional
        ones that do not say it.
        """

        def named(keys: Mapping[str, Key]) -> list[str]:
            return [
                f"{name} ({key.told()})" if explained and key.doc else name
                for name, key in keys.items()
            ]

        found = named(self.required)
        for first, *others in self.ways:
            either = ", or ".join(both(named(way.required)) for way in others)
            found.append(f"{both(named(first.required))} (or {either})")
        more = {k: key for k, key in self.optional.items() if key.doc or not explained}
        needed, optional = ", ".join(found), ", ".join(named(more))
        return "; optional: ".join(filter(None, [needed, optional]))


def both(words: Iterable[str]) -> str:
    """Return words as `a, b and c`."""
    *first, last = [*words]
    return f"{', '.join(first)} and {last}" if first else last


def positive(dimension: str, doc: str = "", **more: Any) -> Key:
    """Return the key of a positive quantity."""
    return Key(dimension, doc, above=0.0, **more)


def in_units(*units: str) -> dict[str, Callable[[float], float]]:
    """Return the factors to SI of units that may have been meant."""
    return {unit: FACTORS[unit].__mul__ for unit in units}


# few towers and spires of masonry are higher
OF_BUILDINGS = Usual(0.0, 30.0, in_units("cm", "mm"))


def length(doc: str = "", usual: Usual | None = OF_BUILDINGS) -> Key:
    """Return the key of a positive length."""
    where = f"a positive length, from {SMALLEST_LENGTH:g} m"
    return Key("length", doc, least=SMALLEST_LENGTH, where=where, usual=usual)
