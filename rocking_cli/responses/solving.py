"""Boundaries of the values of a key for which a structure stands under motions with a
margin.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..digits import rounded_down
from ..documents.document import Document
from ..dynamics.method import has_direction
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import Limit
from ..envelopes.capacity import falls_may_be_narrow
from ..envelopes.intervals import A_MAX
from ..envelopes.withstanding import withstand
from ..envelopes.worst import at_worst_frequency
from ..errors import UsageError
from ..motions import Motion
from ..motions.floors import on_floors
from ..motions.given import AnyMotion, Shake, demand_of, demands_of
from ..motions.grid import Grid
from ..processes import available_cpus
from ..showing import Shown
from ..structures.family import Member, Variation, family, parse_variation
from ..structures.friction import friction_that_slides, refuse_range, sliders
from ..structures.given import document_from
from ..structures.parameters import RockingParameters
from .check import Demand, Standing, standings
from .shaken import capacity_search
from .verdict import KNOWN

_DIGITS = (
    6  # significant digits of a boundary, which is rounded to the side that stands
)
# times the demand and the margin: the reach of the search; capacities above it count as
# this one
_BEYOND = 2.0
_EXACT = 1e-8  # of a boundary before it is rounded
_EDGE = 1e-6  # of a value: the first one with a structure is found to it
SCAN = 17  # values of a range that states no number
_AT_ONCE = 3  # values of the scan for each process, which are judged together
_ASKED_TOGETHER = 20  # values of the scan whose outcomes are asked together
_PARTS = 8  # parts of a bracket in one cut, of structures that share a march


@dataclass(frozen=True, repr=False)
class Boundary(Shown):
    """A value of a key at which a structure begins or ceases to stand.

    `boundaries` returns them. Without a boundary the value and capacity_demand are
    None.

    Attributes
    ----------
    structure: its name
    key: of the document
    value: [SI]
    side: "stands above" or "stands below"; without a boundary "stands everywhere" or
        "stands nowhere", and "stands at 14 of 17 values" or "falls at 14 of 17 values"
        if values of the scan have no structure or no verdict
    capacity_demand: the number that `check` finds for the document with this value;
        under a set of motions the least one over the motions of the required share;
        None if nothing overturns the structure, as one that slides
    shown: the value in the unit of the range, by heading
    unit: SI unit of the value, "" for a plain number

    Examples
    --------
    >>> (found,), _ = boundaries(
    ...     "block:0.5x2", "width=0.5:0.6:2", "sine", "a_g=0.1g,f_g=1"
    ... )
    >>> found.side, found.value
    ('stands everywhere', None)
    """

    structure: str  # its name
    key: str  # of the document
    value: float | None  # [SI]
    # "stands above" or "stands below"; without a boundary "stands everywhere" or
    # "stands nowhere", and "stands at 14 of 17 values" or "falls at 14 of 17 values" if
    # values of the scan have no structure or no verdict
    side: str
    # the number that `check` finds for the document with this value; under a set of
    # motions the least one over the motions of the required share; None if nothing
    # overturns the structure, as one that slides
    capacity_demand: float | None
    shown: dict[str, float | None]  # the value in the unit of the range, by heading
    unit: str = ""  # SI unit of the value, "" for a plain number

    def _shown(self) -> dict[str, Any]:
        found = {"structure": self.structure, **self.shown, "side": self.side}
        return {**found, "capacity_demand": self.capacity_demand}

    def _rows(self) -> list[dict[str, Any]]:
        return [self.row()]

    def row(self) -> dict[str, Any]:
        """Return the boundary as `rocking solve --json` prints it."""
        return {
            key: value
            for key, value in asdict(self).items()
            if key not in ("shown", "unit")
        }


class NoAnswer(str):
    """A remark on a value of which it is not known whether the structure stands."""


def boundaries(
    document: Document | str | Path,
    varied: Variation | str,
    shakes: AnyMotion | Sequence[AnyMotion | Shake],
    shaking: Grid | str | None = None,
    *,
    margin: float = 1.0,
    share: float = 1.0,
    opposite: Sequence[Shake] = (),
    up_to: Grid | str | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    scanned_at: Callable[[float, float], None] | None = None,
) -> tuple[list[Boundary], list[str]]:
    """Return the values of a key at which a structure begins or ceases to stand.

    On one side of a boundary the first overturning amplitude, of a stack the least of
    its interfaces, is at least `margin` times the demand under this share of the
    motions.

    Parameters
    ----------
    document
        the structure: a document, a path, or a text such as "block:0.5x2"
    varied
        the key and the values between which boundaries are searched, or a text such as
        "width=0.4:0.8:5"; without a number of values there are 17
    shakes
        the motion of the ground: an object, the name of a pulse, or a path; or several,
        each alone or as a pair (motion, grid)
    shaking
        amplitude and frequency, a grid of one cell or its text, of the motions without
        one; a record does not need it
    margin
        least accepted capacity over demand [-]
    share
        share of the motions under which the structure must stand [-], above 0, up to 1
    opposite
        the same motions in the opposite direction, if both count
    up_to
        the demand at the other end of a range of frequencies, of which the worst counts
    workers
        number of processes, None for all cores if that saves time
    progress
        called with the number of finished values and of all
    scanned_at
        called with each value of `varied` and capacity_demand there, at most twice the
        margin; NaN without a verdict; None spares the search for these numbers

    Returns
    -------
    tuple of (list of Boundary, list of str)
        the boundaries, and remarks; without a boundary one row, which says whether the
        structure stands at all values, or at how many of them

    Raises
    ------
    UsageError
        for a number out of range, or a grid of several cells
    DocumentError
        if the document is not valid, or the key is unknown

    Notes
    -----
    Two boundaries between neighbouring values of `varied` may be missed.

    Examples
    --------
    >>> column = "configs/block.yaml"
    >>> (found,), _ = boundaries(column, "width=0.4:0.8:3", "sine", "a_g=0.4g,f_g=1")
    >>> found.side, f"{found.value:.5f} m", round(found.capacity_demand, 4)
    ('stands above', '0.62312 m', 1.0)
    """
    if not (0.0 < share <= 1.0 and margin > 0.0):
        raise UsageError(
            f"found `share` {share:g} and `margin` {margin:g}; expected a share above 0"
            " and up to 1, and a positive margin"
        )
    demands = demands_of(shakes, shaking)
    search = _BoundarySearch(
        document_from(document),
        parse_variation(varied, SCAN) if isinstance(varied, str) else varied,
        demands,
        margin,
        share,
        demands_of(opposite),
        None if up_to is None else demand_of(demands[0][0], up_to)[1],
        workers,
    )
    scanned = search.scanned(progress, with_capacities=scanned_at is not None)
    if scanned_at is not None:
        for value, _ in scanned:
            scanned_at(value, search.capacities([value])[0])
    found = search.boundaries(scanned)
    return found, list(dict.fromkeys(search.remarks))


class _NoVerdict(Exception):
    """Between two values of the key lies one without a structure or a verdict."""


class _BoundarySearch:
    """The capacities of a structure for values of a key, each computed once, and the
    boundaries between them.
    """

    def __init__(
        self,
        document: Document,
        varied: Variation,
        shakes: Sequence[tuple[Motion, Grid]],
        margin: float,
        share: float,
        opposite: Sequence[tuple[Motion, Grid]],
        up_to: Grid | None,
        workers: int | None,
    ) -> None:
        # as the arguments of `boundaries`
        self.document, self.varied, self.shakes = document, varied, shakes
        self.margin, self.share, self.opposite = margin, share, opposite
        self.up_to, self.workers = up_to, workers
        most = max(float(grid.amplitude.values[0]) for _, grid in shakes)
        in_units = shakes[0][1].amplitude.name == "a_g"
        self.reach = Limit(_BEYOND * margin * most, in_units)
        self.remarks: list[str] = []
        # the capacity over the demand of each value [-], at most `_BEYOND` times the
        # margin; NaN if there is no such structure, or no verdict
        self.known: dict[float, float] = {}
        # the values at which many narrow intervals overturn the structure
        self.narrow: set[float] = set()
        # True if outcomes tell whether a structure stands: the worst frequency is not
        # searched, and overturning intervals are wide
        self.by_outcomes = up_to is None and not any(
            falls_may_be_narrow(motion) for motion, _ in (*shakes, *opposite)
        )
        # the demands on the structures of each value
        self.demands: dict[float, list[Demand]] = {}
        # the ends of the range that are the worst, of each value
        self.at_ends: dict[float, set[str]] = {}

    def scanned(
        self, progress: Callable[[int, int], None] | None, *, with_capacities: bool
    ) -> list[tuple[float, bool | None]]:
        """Return the values of the range, rising, and whether the structure stands at
        each; None without a verdict. with_capacities: True if `capacities` is asked
        too.
        """
        values, found = sorted(self.varied.values), []
        at_once = _AT_ONCE * (self.workers or available_cpus())
        if self.by_outcomes and not with_capacities:
            at_once = _ASKED_TOGETHER
        for begin in range(0, len(values), at_once):
            some = values[begin : begin + at_once]
            if with_capacities:
                self.capacities(some)
            found += list(zip(some, self.stand(some), strict=True))
            if progress is not None:
                progress(len(found), len(values))
        return found

    def boundaries(
        self, scanned: Sequence[tuple[float, bool | None]]
    ) -> list[Boundary]:
        """Return the boundaries between neighbours of the scan, and between its values
        and the first ones that have a structure; a single row without a value if the
        structure stands, or falls, at all of them.
        """
        found = []
        judged = self._with_edges(scanned)
        for (low, x), (high, y) in pairwise(judged):
            if x is not None and y is not None and x != y:
                found.append(self.boundary(low, high, y))
        known = [(value, x) for value, x in judged if x is not None]
        if len({stands for _, stands in known}) != 1:
            return [one for one in found if one is not None]
        value, stands = known[0]
        return [self.row(value, self._without_boundary(scanned, stands))]

    def _without_boundary(
        self, scanned: Sequence[tuple[float, bool | None]], stands: bool
    ) -> str:
        """Return the side of a row without a boundary, and remark on it; stands: True
        if the structure stands at all values that have a verdict.
        """
        judged = sum(x is not None for _, x in scanned)
        said = "stands" if stands else "does not stand"
        if judged == len(scanned):
            self.remarks.append(f"{said} with this margin at any value of the scan")
            return "stands everywhere" if stands else "stands nowhere"
        self.remarks.append(
            f"{said} with this margin at {judged} of the {len(scanned)} values of the"
            " scan; nothing is said of the others, which have no structure or no"
            " verdict"
        )
        return f"{'stands' if stands else 'falls'} at {judged} of {len(scanned)} values"

    def _with_edges(
        self, scanned: Sequence[tuple[float, bool | None]]
    ) -> list[tuple[float, bool | None]]:
        """Return the scan and, between a value without a structure and a neighbour with
        a verdict, a value of `_edge`.
        """
        judged = list(scanned[:1])
        for (low, x), (high, y) in pairwise(scanned):
            if x is None and y is not None and not self._demands(low):
                judged.append(self._edge(low, high, y, "from"))
            elif y is None and x is not None and not self._demands(high):
                judged.append(self._edge(high, low, x, "up to"))
            judged.append((high, y))
        return judged

    def _edge(
        self, without: float, judged: float, stands: bool, to: str
    ) -> tuple[float, bool]:
        """Return the value closest to one without a structure that has a structure and
        a verdict, or one with the other verdict, and whether the structure stands
        there. Remark on the structures that exist from, or up to, a value.

        stands: True if the structure stands at the value `judged`.
        """

        def exists(value: float) -> bool | None:
            return None if any(one.fault for one in self._members(value)) else stands

        edge, _ = self._closest(without, judged, stands, exists)
        said = f"there is a structure {to} {self._at(edge)}"
        there = self._verdict(edge)
        if there is None:  # no equation holds, or the search fails
            edge, there = self._closest(edge, judged, stands, self._verdict)
            said += f", and a verdict {to} {self._at(edge)}" * (there is stands)
        if there is stands:
            said += f", where it {'stands' if stands else 'does not stand'}"
        self.remarks.append(said)
        return edge, there

    def _closest(
        self,
        without: float,
        known: float,
        stands: bool,
        asked: Callable[[float], bool | None],
    ) -> tuple[float, bool]:
        """Return the value closest to `without` at which `asked` is not None, or one at
        which it is not `stands`, and what it is there; `stands` is that of `known`.
        """
        close = _EDGE * max(abs(without), abs(known))
        there = stands
        while there is stands and abs(known - without) > close:
            middle = 0.5 * (without + known)
            found = asked(middle)
            if found is None:
                without = middle
            else:
                known, there = middle, found
        return known, there

    def _verdict(self, value: float) -> bool | None:
        """Return `stand` of a value that the user did not ask: without a line if there
        is no verdict, also None if no equation holds.
        """
        before = len(self.remarks)
        try:
            (stands,) = self.stand([value])
        except UsageError:
            stands = None
        if stands is None:
            del self.remarks[before:]
        return stands

    def stand(
        self, values: Sequence[float], *, scanned: bool = True
    ) -> list[bool | None]:
        """Return whether the structure stands at each value; None without a structure
        or a verdict. scanned: as of `withstand`.
        """
        asked = {
            value: demands
            for value in (values if self.by_outcomes else ())
            if (demands := self._demands(value))
            and all(
                friction_that_slides(structure) is None for structure, _, _ in demands
            )
        }
        every = [
            capacity_search(*demand, 0.0)
            for demands in asked.values()
            for demand in demands
        ]
        found = iter(withstand(every, self.margin, scanned=scanned))
        stands = {
            value: self._stands_under(value, list(islice(found, len(demands))))
            for value, demands in asked.items()
        }
        others = [value for value in values if value not in asked]
        for value, capacity in zip(others, self.capacities(others), strict=True):
            stands[value] = None if math.isnan(capacity) else capacity >= self.margin
        return [stands[value] for value in values]

    def _stands_under(self, value: float, found: Sequence[bool | None]) -> bool | None:
        """Return whether the structure of a value stands under the required share of
        the motions; found: whether it does under each demand.
        """
        if None in found:
            self._no_verdict(value)
            return None
        _, motions, _ = shape = self._shape(len(found))
        falls = ~np.reshape(np.array(found, dtype=bool), shape).all(axis=(0, 2))
        return int(falls.sum()) <= self._left_out(motions)

    def _shape(self, demands: int) -> tuple[int, int, int]:
        """(directions, motions, structures) of the demands of a value."""
        motions = len(self.shakes)
        directions = 2 if self.opposite else 1
        return directions, motions, demands // (motions * directions)

    def _left_out(self, motions: int) -> int:
        """The number of motions under which the structure may fall."""
        return math.floor(motions * (1.0 - self.share) + 1e-9)

    def _at(self, value: float) -> str:
        """Return the key with a value in words, and the unit that the range states."""
        unit = f" {self.varied.unit}" if self.varied.unit else ""
        return f"{self.varied.key} = {value:.6g}{unit}"

    def _no_verdict(self, value: float) -> None:
        self.remarks.append(NoAnswer(f"no verdict for {self._at(value)}"))

    def excess(self, value: float) -> float:
        """Return ln(capacity_demand/margin) for a value of the key; NaN if there is no
        such structure, or no verdict.
        """
        return math.log(self.capacities([value])[0] / self.margin)

    def capacities(self, values: Sequence[float]) -> list[float]:
        """Return `known` for each value; processes share what is new."""
        new = {
            value: demands
            for value in dict.fromkeys(values)
            if value not in self.known and (demands := self._demands(value))
        }
        found = iter(
            standings(
                [demand for demands in new.values() for demand in demands],
                a_max=self.reach,
                workers=self.workers,
            )
        )
        for value, demands in new.items():
            self.known[value] = self._capacity_of(
                value, list(islice(found, len(demands)))
            )
        return [self.known[value] for value in values]

    def _demands(self, value: float) -> list[Demand]:
        """Return the demands on the structures of a value of the key, one motion after
        the other; none without a structure.
        """
        if value not in self.demands:
            self.demands[value] = self._new_demands(value)
        return self.demands[value]

    def _new_demands(self, value: float) -> list[Demand]:
        """As `_demands`, for a value that is asked for the first time."""
        members = self._members(value)
        faults = [x.fault for x in members if x.fault is not None]
        if faults:
            self.known[value] = math.nan
            self.remarks.append(
                NoAnswer(f"no solution for {self._at(value)}: {faults[0]}")
            )
            return []
        structures = [x.parameters for x in members if x.parameters is not None]
        if sliders(structures):
            self.remarks.append(
                "with a friction below lambda it slides, never rocks, and counts as"
                " standing however far it slides; rocking check tells how far"
            )
        self.remarks.extend(
            "one direction of the motion only, though the sides differ:"
            f" {self._own_name(one)}; the other `sign` gives the opposite one"
            for one in (() if self.opposite else structures)
            if has_direction(one)
        )
        demands = [
            (one, *shake)
            for shake in (*self.shakes, *self.opposite)
            for one in structures
        ]
        if self.up_to is not None:
            demands = self._at_worst(value, demands)
        return list(on_floors(demands))

    def _members(self, value: float) -> list[Member]:
        """Return the structures of a value of the key, of a stack each interface."""
        varied = self.varied._replace(values=(value,))
        return list(family(self.document, [varied], each=True))

    def _at_worst(self, value: float, demands: Sequence[Demand]) -> list[Demand]:
        """Return the demands at the worst frequency of the range. Raises UsageError for
        a structure that slides.
        """
        assert self.up_to is not None  # a range is stated
        refuse_range((one for one, _, _ in demands), "a range of frequencies")
        worst = [
            at_worst_frequency(structure, motion, low, self.up_to, self.reach)
            for structure, motion, low in demands
        ]
        self.at_ends[value] = {
            f"{one.end} end of the range, {one.frequency:.4g} Hz"
            for one in worst
            if one.end
        }
        return [
            (structure, motion, one.grid)
            for (structure, motion, _), one in zip(demands, worst, strict=True)
        ]

    def _capacity_of(self, value: float, found: Sequence[Standing]) -> float:
        """Return `known` of a value; found: what stands under its demands."""
        if any(one.outcome == Outcome.FAILED for one in found):
            self._no_verdict(value)
            return math.nan
        if any(one.narrow for one in found):
            self.narrow.add(value)
        return min(_BEYOND * self.margin, self._least_capacity(found))

    def _least_capacity(self, found: Sequence[Standing]) -> float:
        """Return the capacity over the demand of the required share of the motions,
        infinite if nothing overturns; found: as of `_capacity_of`.
        """
        least = [
            min(
                math.inf if one.capacity_demand is None else one.capacity_demand,
                math.nextafter(1.0, 0.0) if one.falls else math.inf,
            )
            for one in found
        ]
        _, motions, _ = shape = self._shape(len(found))
        # of each motion
        capacities = np.sort(np.reshape(least, shape).min(axis=(0, 2)))
        return float(capacities[self._left_out(motions)])

    def capacity_demand(self, value: float) -> float | None:
        """Return the number that `check` finds for a value, None if nothing overturns
        the structure.
        """
        (capacity,) = self.capacities([value])
        narrow = value in self.narrow
        if not capacity < _BEYOND * self.margin:  # it is above the reach of the search
            most = max(A_MAX, _BEYOND * self.margin)
            demands = self._demands(value)
            found = list(standings(demands, a_max=most, workers=self.workers))
            capacity = self._least_capacity(found)
            narrow = any(one.narrow for one in found)
        if not math.isfinite(capacity):
            return None
        return rounded_down(capacity, KNOWN, self.margin) if narrow else capacity

    def boundary(self, low: float, high: float, above: bool) -> Boundary | None:
        """Return the boundary between two values; above: True if the structure stands
        above it. None next to a value without a structure or a verdict.
        """
        try:
            exact = self._narrowed(low, high, above)
        except UsageError as error:  # no equation holds at a value between them
            self.remarks.append(
                NoAnswer(
                    f"no verdict for {self.varied.key} between {low:g} and {high:g}:"
                    f" {error}"
                )
            )
            return None
        if exact is None:
            return None
        value = self._rounded(exact, low, high, above)
        if self.capacities([value])[0] < self.margin:
            self._no_verdict(value)
            return None
        for end in sorted(self.at_ends.get(value, ())):
            beyond = "slower" if end.startswith("lower") else "faster"
            self.remarks.append(
                f"the worst frequency at this boundary is the {end}; {beyond} motions"
                " may overturn it"
            )
        side = "stands above" if above else "stands below"
        return self.row(value, side, value, self.capacity_demand(value))

    def _narrowed(self, low: float, high: float, above: bool) -> float | None:
        """Return a value closer than `_EXACT` to the boundary between two values, at
        which the structure may fall; None next to a value without a structure or a
        verdict.
        """
        stands, falls = (high, low) if above else (low, high)
        if not self.by_outcomes:
            return self._root(low, high)
        # Where the structure falls at the margin itself, no scan is needed.
        if self.stand([falls], scanned=False) == [False]:
            ends = self._cut(falls, stands, scanned=False)
            if ends is None or self.stand([ends[1]]) == [True]:
                return None if ends is None else ends[0]
            falls = ends[1]  # a lower amplitude overturns it
        ends = self._cut(falls, stands, scanned=True)
        return None if ends is None else ends[0]

    def _root(self, low: float, high: float) -> float | None:
        """`_narrowed` by the root of `excess`."""
        from scipy.optimize import brentq

        def excess(value: float) -> float:
            found = self.excess(value)
            if math.isnan(found):
                raise _NoVerdict
            return found

        try:
            if excess(low) * excess(high) > 0.0:
                return None
            found = brentq(excess, low, high, xtol=_EXACT * abs(high), rtol=_EXACT)
        except _NoVerdict:  # such a value is remarked on
            return None
        return float(found)

    def _cut(
        self, falls: float, stands: float, *, scanned: bool
    ) -> tuple[float, float] | None:
        """Return two values closer than `_EXACT`: the structure falls at the first one
        and stands at the second; scanned: as of `withstand`. None next to a value
        without a structure or a verdict.
        """
        parts, largest = self._parts(falls), max(abs(falls), abs(stands))
        while abs(stands - falls) > _EXACT * largest:
            share = np.arange(1, parts) / parts
            values = (falls + (stands - falls) * share).tolist()
            found = self.stand(values, scanned=scanned)
            if None in found:  # such a value is remarked on
                return None
            # The last value that falls, and the one after it, which stands.
            ends, known = [falls, *values, stands], [False, *found, True]
            at = max(i for i, one in enumerate(known) if not one)
            if {ends[at], ends[at + 1]} == {falls, stands}:
                break
            falls, stands = ends[at], ends[at + 1]
        return falls, stands

    def _parts(self, value: float) -> int:
        """Return the parts of a bracket in one cut: several if the structures of all
        values share one march, which costs little more than a single structure.
        """
        return _PARTS if all(s.plain for s, _, _ in self._demands(value)) else 2

    def _rounded(self, exact: float, low: float, high: float, above: bool) -> float:
        """Return the boundary rounded to the side that stands: the first number of
        digits that stands, since close by there may be another boundary. Where the
        boundary itself does not stand, as a friction of lambda, a unit away from it.
        """
        outwards, out = (ROUND_CEILING, 1) if above else (ROUND_FLOOR, -1)
        for away, digits in itertools.product((0, out), range(_DIGITS, 16)):
            # Decimals: a quotient of floats may be a unit off.
            rounded = Context(prec=digits, rounding=outwards).create_decimal(exact)
            unit = Decimal(1).scaleb(rounded.adjusted() - digits + 1)
            value = min(high, max(low, float(rounded + away * unit)))
            if self.capacities([value])[0] >= self.margin:
                return value
        return high if above else low

    def row(
        self,
        value: float,
        side: str,
        stated: float | None = None,
        capacity_demand: float | None = None,
    ) -> Boundary:
        """Return the row of a value; stated: the value that it states, None without a
        boundary.
        """
        key = self.varied.key
        (member,) = family(self.document, [self.varied._replace(values=(value,))])
        assert member.parameters is not None
        known = stated is not None
        return Boundary(
            self._own_name(member.parameters),
            key,
            member.varied[key] if known else None,
            side,
            capacity_demand,
            {heading: x if known else None for heading, x in member.shown.items()},
            member.parameters.details["varied_units"][key],
        )

    def _own_name(self, member: RockingParameters) -> str:
        return member.name[: member.name.rindex(f" {self.varied.key}=")]
