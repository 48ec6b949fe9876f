"""Families of structures: one document with some values varied, in all combinations
(Figs. 4 and 6).
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from ..documents.document import Document
from ..documents.quantities import (
    headed,
    parse_quantity,
    si_unit,
    split_quantity,
    with_a_point,
)
from ..documents.spans import spaced, split_span
from ..documents.spreads import is_spread
from ..errors import DocumentError, UsageError
from .given import document_from
from .parameters import OTHERS, RockingParameters

MAX_MEMBERS = 1_000_000


class Variation(NamedTuple):
    """A key of a document and the values that it takes in turn.

    `parse_variation` makes one of a text; `family` and `boundaries` take it.

    Attributes
    ----------
    key: of the document
    values: numbers in `unit`
    unit: None: that of the document

    Examples
    --------
    >>> (document,) = read_documents("configs/block.yaml")
    >>> widths = Variation("width", (0.5, 1.0), "m")
    >>> [f"{member.parameters.alpha:.4f}" for member in family(document, [widths])]
    ['0.2450', '0.4636']
    """

    key: str  # of the document
    values: tuple[float, ...]  # numbers in `unit`
    unit: str | None  # None: that of the document


class Member(NamedTuple):
    """One structure of a `family`.

    Attributes
    ----------
    varied: SI values by key, empty without parameters
    shown: the same values in the units of the option, by heading with unit
    parameters: None if the document has no solution
    fault: the reason why the document has no solution

    Examples
    --------
    >>> (document,) = read_documents("configs/block.yaml")
    >>> member = next(family(document, ["height=2:4:3"]))
    >>> member.varied, member.fault
    ({'height': 2.0}, None)
    """

    varied: dict[str, float]  # SI values by key, empty without parameters
    # the same values in the units of the option, by heading with unit
    shown: dict[str, float]
    parameters: RockingParameters | None  # None if the document has no solution
    fault: str | None  # the reason why the document has no solution


class Choice(NamedTuple):
    """One of the varied values of a key."""

    key: str  # of the document
    number: float  # in `unit`
    unit: str  # empty: that of the document

    @property
    def text(self) -> str:
        """The text that stands in the document."""
        return f"{float(self.number)!r} {self.unit}".strip()


def parse_variation(text: str, count: int | None = None) -> Variation:
    """Return the variation that a text states.

    Parameters
    ----------
    text
        KEY=START:STOP:N or KEY=START:STOP:N:log; bounds without a unit take the unit of
        the document
    count
        the N of a text without N

    Returns
    -------
    Variation

    Raises
    ------
    UsageError
        for a text of another form

    Examples
    --------
    >>> parse_variation("angle=150deg:160deg:3")
    Variation(key='angle', values=(150.0, 155.0, 160.0), unit='deg')
    """
    key, equals, span = text.partition("=")
    key, wanted = key.strip(), "KEY=START:STOP:N[:log]"
    if count is not None:
        span += f":{count}" * (span.count(":") == 1)
        wanted = f"KEY=START:STOP or {wanted}"
    ends = [split_quantity(part) for part in span.split(":")[:2]]
    if not equals or not key or None in ends or len(ends) < 2:
        raise UsageError(
            f"`vary`: found {text!r}; expected {wanted}, such as thickness=1.2:2.0:9 or"
            " angle=150deg:180deg:31"
        )
    place = f"`vary` {key}"
    if "," in span:
        raise UsageError(
            f"{place}: found {span!r}; expected numbers without"
            f" commas{with_a_point(span)}"
        )
    *_, number, log = split_span(place, span, wanted, 1, MAX_MEMBERS)
    (start, unit), (stop, other) = (end for end in ends if end)
    if unit != other and unit and other:
        raise UsageError(
            f"{place}: found bounds in {unit} and {other}; expected one unit for both"
        )
    if number == 1 and start != stop:
        raise UsageError(
            f"{place}: found one value from {start:g} to {stop:g}; expected N of 2"
            " or more, or equal bounds"
        )
    values = spaced(place, start, stop, number, log)
    return Variation(key, tuple(values.tolist()), unit or other or None)


def members(variations: Sequence[Variation]) -> int:
    """Return the number of structures of a family. Raises UsageError if a key is varied
    twice or the number is too large.
    """
    if len({v.key for v in variations}) < len(variations):
        raise UsageError("`vary`: a key is varied twice")
    count = math.prod(len(v.values) for v in variations)
    if count > MAX_MEMBERS:
        raise UsageError(
            f"`vary`: found {count} structures; expected up to {MAX_MEMBERS}"
        )
    return count


def family(
    document: Document | str | Path,
    variations: Variation | str | Sequence[Variation | str],
    each: bool = False,
) -> Iterator[Member]:
    """Yield a structure for each combination of varied values.

    Parameters
    ----------
    document
        the structure: a document, a path, or a text such as "block:0.5x2"
    variations
        the keys and their values, or texts as `parse_variation` reads them, one or
        several; the last key varies fastest
    each
        True: a stack has a member for each interface, see `on_each_interface`

    Yields
    ------
    Member
        its `fault` says why a combination has no solution

    Raises
    ------
    DocumentError
        if a key is unknown
    UsageError
        if a key takes a text, or a text states no variation

    Examples
    --------
    >>> members = family("configs/block.yaml", "height=2:4:3")
    >>> [round(member.parameters.p, 4) for member in members]
    [2.6717, 2.1996, 1.9106]
    """
    from . import on_each_interface

    document = document_from(document)
    if isinstance(variations, str | Variation):
        variations = [variations]
    # parameters: each interface has its own keys
    if each and document.values.get(OTHERS):
        for one in on_each_interface(document):
            yield from family(one, variations)
        return
    parsed = [parse_variation(v) if isinstance(v, str) else v for v in variations]
    for key in [v.key for v in parsed]:
        value = document.value_at(key)
        if value is not None and is_spread(str(value.content)):
            raise UsageError(
                f"`vary` {key}: found {value}, which has a spread; expected a key"
                " without one"
            )
    units = [
        v.unit if v.unit is not None else _own_unit(document, v.key) for v in parsed
    ]
    for values in itertools.product(*(v.values for v in parsed)):
        choices = [
            Choice(v.key, value, unit)
            for v, value, unit in zip(parsed, values, units, strict=True)
        ]
        yield from _members(document, choices, each)


def _members(
    document: Document, choices: Sequence[Choice], each: bool
) -> Iterator[Member]:
    """Yield the member with these values, or that of each interface; the reason if the
    document has no solution.
    """
    varied = document
    for choice in choices:
        source = f"{document.source} with {choice.key}={choice.text}"
        varied = varied.with_value(choice.key, choice.text, source)
    structures, fault = _built(varied, [choice.key for choice in choices], each)
    dimensions = varied.dimensions
    shown = {
        headed(choice.key, choice.unit or si_unit(dimensions.get(choice.key))): (
            choice.number
        )
        for choice in choices
    }
    if fault is not None:
        yield Member({}, shown, None, fault)
        return

    si = {c.key: parse_quantity(c.text, dimensions[c.key]) for c in choices}
    details = {
        "varied": si,
        "varied_units": {c.key: si_unit(dimensions[c.key]) for c in choices},
    }
    suffix = [f"{choice.key}={choice.number:g}{choice.unit}" for choice in choices]
    for structure in structures:
        named = replace(
            structure,
            name=" ".join([structure.name, *suffix]),
            details={**structure.details, **details},
        )
        yield Member(si, shown, named, None)


def _built(
    varied: Document, keys: Sequence[str], each: bool
) -> tuple[list[RockingParameters], str | None]:
    """Return (structures, None), or ([], the reason) if these values have no solution.
    Raises DocumentError if no kind asks for a key, and UsageError if it takes a text.
    """
    from . import build_structure, on_each_interface

    try:
        documents = on_each_interface(varied) if each else [varied]
        structures = [build_structure(one) for one in documents]
    except DocumentError as error:
        known = {*varied.table, *varied.asked, *varied.dimensions}
        if any(key not in known for key in keys):
            raise
        return [], str(error)
    if words := [key for key in keys if key not in varied.dimensions]:
        raise UsageError(
            f"`vary` {words[0]}: found a key that takes a text; expected a key that"
            " takes a number"
        )
    return structures, None


def _own_unit(document: Document, key: str) -> str:
    """Return the unit that the document states for the value of a key; empty if it
    states none.
    """
    value = document.value_at(key)
    parts = (
        split_quantity(value.content)
        if value is not None and isinstance(value.content, str)
        else None
    )
    return parts[1] if parts else ""
