"""Boundaries of the values of a key for which a structure stands under motions with a
margin.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..documents.document import Document
from ..dynamics.method import direction_in_words
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import Limit
from ..envelopes.worst import at_worst_frequency
from ..errors import UsageError
from ..motions import Motion
from ..motions.given import AnyMotion, Shake, demand_of, demands_of
from ..motions.grid import Grid
from ..processes import available_cpus
from ..showing import Shown
from ..structures.family import Variation, family, parse_variation
from ..structures.friction import sliders
from ..structures.given import document_from
from ..structures.parameters import RockingParameters
from .check import Demand, Standing, standings

_DIGITS = (
    6  # significant digits of a boundary, which is rounded to the side that stands
)
# times the demand and the margin: the reach of the search; capacities above it count as
# this one
_BEYOND = 2.0
_EXACT = 1e-8  # of a boundary before it is rounded
SCAN = 17  # values of a range that states no number
_AT_ONCE = 3  # values of the scan for each process, which are judged together


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
        "stands nowhere"
    capacity_demand: the number that `check` finds for the document with this value;
        under a set of motions the least one over the motions of the required share
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
    # "stands nowhere"
    side: str
    # the number that `check` finds for the document with this value; under a set of
    # motions the least one over the motions of the required share
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
        margin; NaN without a verdict

    Returns
    -------
    tuple of (list of Boundary, list of str)
        the boundaries, and remarks; without a boundary one row, which says whether the
        structure stands at all values

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
    scanned = search.scanned(progress)
    if scanned_at is not None:
        for value, excess in scanned:
            scanned_at(value, margin * math.exp(excess))
    found = search.boundaries(scanned)
    return found, list(dict.fromkeys(search.remarks))


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
        # ln(capacity_demand/margin) of each value, NaN if there is no such structure,
        # or no verdict
        self.known: dict[float, float] = {}
        # the ends of the range that are the worst, of each value
        self.at_ends: dict[float, set[str]] = {}

    def scanned(
        self, progress: Callable[[int, int], None] | None
    ) -> list[tuple[float, float]]:
        """Return the values of the range, rising, with the excess of each."""
        values, found = sorted(self.varied.values), []
        at_once = _AT_ONCE * (self.workers or available_cpus())
        for begin in range(0, len(values), at_once):
            some = values[begin : begin + at_once]
            found += list(zip(some, self.excesses(some), strict=True))
            if progress is not None:
                progress(len(found), len(values))
        return found

    def boundaries(self, scanned: Sequence[tuple[float, float]]) -> list[Boundary]:
        """Return the boundaries between neighbours of the scan; a single row without a
        value if the structure stands, or falls, at all of them.
        """
        found = []
        for (low, x), (high, y) in pairwise(scanned):
            if (x >= 0.0) != (y >= 0.0) and not math.isnan(x + y):
                found.append(self.boundary(low, high, y >= 0.0))
        known = [(value, x >= 0.0) for value, x in scanned if not math.isnan(x)]
        if len({stands for _, stands in known}) != 1:
            return [one for one in found if one is not None]
        value, stands = known[0]
        self.remarks.append(
            f"{'stands' if stands else 'does not stand'} with this margin at any value"
            " of the scan"
        )
        side = "stands everywhere" if stands else "stands nowhere"
        return [self.row(value, side, None)]

    def excess(self, value: float) -> float:
        """Return ln(capacity_demand/margin) for a value of the key; NaN if there is no
        such structure, or no verdict.
        """
        return self.excesses([value])[0]

    def excesses(self, values: Sequence[float]) -> list[float]:
        """Return `excess` for each value; processes share what is new."""
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
            self.known[value] = self._excess_of(
                value, list(islice(found, len(demands)))
            )
        return [self.known[value] for value in values]

    def _demands(self, value: float) -> list[Demand]:
        """Return the demands on the structures of a value of the key, one motion after
        the other; none without a structure.
        """
        varied = self.varied._replace(values=(value,))
        members = list(family(self.document, [varied], each=True))
        structures = [x.parameters for x in members if x.parameters is not None]
        if not structures:
            self.known[value] = math.nan
            self.remarks.append(
                f"no solution for {varied.key} = {value:g}: {members[0].fault}"
            )
        if sliders(structures):
            self.remarks.append(
                "with a friction below lambda it slides, never rocks, and counts as"
                " standing however far it slides; rocking check tells how far"
            )
        for one in () if self.opposite else structures:
            named = replace(one, name=self._own_name(one))
            self.remarks.extend(direction_in_words(named, opposite="the other `sign`"))
        demands = [
            (one, *shake)
            for shake in (*self.shakes, *self.opposite)
            for one in structures
        ]
        return demands if self.up_to is None else self._at_worst(value, demands)

    def _at_worst(self, value: float, demands: Sequence[Demand]) -> list[Demand]:
        """Return the demands at the worst frequency of the range."""
        assert self.up_to is not None  # a range is stated
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

    def _excess_of(self, value: float, found: Sequence[Standing]) -> float:
        """Return ln(capacity_demand/margin) of the required share of the motions;
        found: what stands under the demands of a value.
        """
        if any(one.outcome == Outcome.FAILED for one in found):
            self.remarks.append(f"no verdict for {self.varied.key} = {value:g}")
            return math.nan
        least = [
            min(
                _BEYOND * self.margin,
                math.inf if one.capacity_demand is None else one.capacity_demand,
                math.nextafter(1.0, 0.0) if one.falls else math.inf,
            )
            for one in found
        ]
        motions = len(self.shakes)
        directions = 2 if self.opposite else 1
        structures = len(found) // (motions * directions)
        capacities = np.sort(
            np.reshape(least, (directions, motions, structures)).min(axis=(0, 2))
        )  # of each motion
        which = math.floor(motions * (1.0 - self.share) + 1e-9)
        return math.log(capacities[which] / self.margin)

    def boundary(self, low: float, high: float, above: bool) -> Boundary | None:
        """Return the boundary between two values; above: True if the structure stands
        above it. None next to a value without a structure or a verdict.
        """
        from scipy.optimize import brentq

        try:
            exact = brentq(self.excess, low, high, xtol=_EXACT * abs(high), rtol=_EXACT)
        except ValueError:  # such a value is remarked on
            return None
        value = self._rounded(exact, low, high, above)
        for end in sorted(self.at_ends.get(value, ())):
            beyond = "slower" if end.startswith("lower") else "faster"
            self.remarks.append(
                f"the worst frequency at this boundary is the {end}; {beyond} motions"
                " may overturn it"
            )
        side = "stands above" if above else "stands below"
        return self.row(value, side, self.margin * math.exp(self.excess(value)))

    def _rounded(self, exact: float, low: float, high: float, above: bool) -> float:
        """Return the boundary rounded to the side that stands: the first number of
        digits that stands, since close by there may be another boundary. Where the
        boundary itself does not stand, as a friction of lambda, a unit away from it.
        """
        outwards, out = (math.ceil, 1) if above else (math.floor, -1)
        for away, digits in itertools.product((0, out), range(_DIGITS, 16)):
            unit = 10.0 ** (math.floor(math.log10(abs(exact) or 1.0)) - digits + 1)
            rounded = float(f"{(outwards(exact / unit) + away) * unit:.{digits}g}")
            value = min(high, max(low, rounded))
            if self.excess(value) >= 0.0:
                return value
        return high if above else low

    def row(self, value: float, side: str, capacity_demand: float | None) -> Boundary:
        """Return the row of a value, which it does not state if capacity_demand is
        None.
        """
        key = self.varied.key
        (member,) = family(self.document, [self.varied._replace(values=(value,))])
        assert member.parameters is not None
        known = capacity_demand is not None
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
