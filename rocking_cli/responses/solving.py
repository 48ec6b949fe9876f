"""Boundaries of the values of a key for which a structure stands under motions with a
margin.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from ..documents.document import Document
from ..dynamics.method import direction_in_words
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import Limit
from ..envelopes.worst import at_worst_frequency
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid
from ..structures.family import Variation, family
from ..structures.parameters import RockingParameters
from .check import verdicts

_DIGITS = (
    6  # significant digits of a boundary, which is rounded to the side that stands
)
# times the demand and the margin: the reach of the search; capacities above it count as
# this one
_BEYOND = 2.0
_EXACT = 1e-8  # of a boundary before it is rounded


@dataclass(frozen=True)
class Boundary:
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
    >>> column = parse_documents("{kind: block, width: 0.5, height: 2}")[0]
    >>> shakes = [(sine(), parse_grid("a_g=0.1g,f_g=1"))]
    >>> (found,), _ = boundaries(column, parse_variation("width=0.5:0.6:2"), shakes)
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

    def row(self) -> dict[str, Any]:
        """Return the boundary as `rocking solve --json` prints it."""
        return {
            key: value
            for key, value in asdict(self).items()
            if key not in ("shown", "unit")
        }


def boundaries(
    document: Document,
    varied: Variation,
    shakes: Sequence[tuple[Motion, Grid]],
    *,
    margin: float = 1.0,
    share: float = 1.0,
    opposite: Sequence[tuple[Motion, Grid]] = (),
    up_to: Grid | None = None,
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
        the structure
    varied
        the key and the values between which boundaries are searched
    shakes
        motions with grids of one cell, the demands
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
    >>> (column,) = read_documents("configs/block.yaml")
    >>> shakes = [(sine(), parse_grid("a_g=0.4g,f_g=1"))]
    >>> (found,), _ = boundaries(column, parse_variation("width=0.4:0.8:3"), shakes)
    >>> found.side, f"{found.value:.5f} m", round(found.capacity_demand, 4)
    ('stands above', '0.62312 m', 1.0)
    """
    from scipy.optimize import brentq

    if not (0.0 < share <= 1.0 and margin > 0.0):
        raise UsageError(
            f"found `share` {share:g} and `margin` {margin:g}; expected a share above 0"
            " and up to 1, and a positive margin"
        )
    for _, grid in (*shakes, *opposite):
        grid.require_one_cell()
    most = max(float(grid.amplitude.values[0]) for _, grid in shakes)
    reach = Limit(_BEYOND * margin * most, shakes[0][1].amplitude.name == "a_g")
    remarks: list[str] = []
    at_ends: dict[
        float, set[str]
    ] = {}  # the ends of the range that are the worst, of each value

    def own_name(member: RockingParameters) -> str:
        return member.name[: member.name.rindex(f" {varied.key}=")]

    @cache
    def excess(value: float) -> float:
        """Return ln(capacity_demand/margin) for a value of the key; NaN if there is no
        such structure, or no verdict.
        """
        members = list(family(document, [varied._replace(values=(value,))], each=True))
        structures = [
            member.parameters for member in members if member.parameters is not None
        ]
        if not structures:
            remarks.append(
                f"no solution for {varied.key} = {value:g}: {members[0].fault}"
            )
            return math.nan
        for one in () if opposite else structures:
            remarks.extend(
                direction_in_words(
                    replace(one, name=own_name(one)), opposite="the other `sign`"
                )
            )
        demands = [
            (one, *shake) for shake in (*shakes, *opposite) for one in structures
        ]
        if up_to is not None:
            found_at = [
                at_worst_frequency(s, motion, low, up_to, reach)
                for s, motion, low in demands
            ]
            demands = [
                (s, motion, worst.grid)
                for (s, motion, _), worst in zip(demands, found_at, strict=True)
            ]
            ends = {
                f"{worst.end} end of the range, {worst.frequency:.4g} Hz"
                for worst in found_at
                if worst.end
            }
            at_ends[value] = ends
        found = list(verdicts(demands, a_max=reach, workers=workers))
        if any(v.outcome == Outcome.FAILED for v in found):
            remarks.append(f"no verdict for {varied.key} = {value:g}")
            return math.nan
        least = [
            min(
                _BEYOND * margin,
                math.inf if (c := v.capacity_demand) is None else c,
                math.nextafter(1.0, 0.0) if v.falls else math.inf,
            )
            for v in found
        ]
        capacities = np.sort(
            np.reshape(least, (-1, len(shakes), len(structures))).min(axis=(0, 2))
        )  # of each motion
        return math.log(
            capacities[math.floor(len(capacities) * (1.0 - share) + 1e-9)] / margin
        )

    def boundary(low: float, high: float, above: bool) -> Boundary | None:
        outwards = math.ceil if above else math.floor
        try:
            exact = brentq(excess, low, high, xtol=_EXACT * abs(high), rtol=_EXACT)
        except (
            ValueError
        ):  # a value without a structure or a verdict, which is remarked on
            return None
        for digits in range(
            _DIGITS, 16
        ):  # the first that stands: close by there may be another boundary
            unit = 10.0 ** (math.floor(math.log10(abs(exact) or 1.0)) - digits + 1)
            value = min(
                high, max(low, float(f"{outwards(exact / unit) * unit:.{digits}g}"))
            )
            if excess(value) >= 0.0:
                break
        else:
            value = high if above else low
        for end in sorted(at_ends.get(value, ())):
            beyond = "slower" if end.startswith("lower") else "faster"
            remarks.append(
                f"the worst frequency at this boundary is the {end}; {beyond} motions"
                " may overturn it"
            )
        return row(
            value,
            "stands above" if above else "stands below",
            margin * math.exp(excess(value)),
        )

    def row(value: float, side: str, capacity_demand: float | None) -> Boundary:
        """Return the row of a value, which it does not state if capacity_demand is
        None.
        """
        (member,) = family(document, [varied._replace(values=(value,))])
        assert member.parameters is not None
        name, known = own_name(member.parameters), capacity_demand is not None
        at, shown = (
            member.varied[varied.key] if known else None,
            {key: x if known else None for key, x in member.shown.items()},
        )
        unit = member.parameters.details["varied_units"][varied.key]
        return Boundary(name, varied.key, at, side, capacity_demand, shown, unit)

    scanned = []
    for i, value in enumerate(sorted(varied.values), 1):
        scanned.append((value, excess(value)))
        if scanned_at is not None:
            scanned_at(value, margin * math.exp(scanned[-1][1]))
        if progress is not None:
            progress(i, len(varied.values))
    changes = [
        (a, b, y >= 0.0)
        for (a, x), (b, y) in pairwise(scanned)
        if (x >= 0.0) != (y >= 0.0) and not math.isnan(x + y)
    ]
    found = [one for change in changes if (one := boundary(*change)) is not None]
    known = [(a, x >= 0.0) for a, x in scanned if not math.isnan(x)]
    if len({stands for _, stands in known}) == 1:
        value, stands = known[0]
        found = [row(value, "stands everywhere" if stands else "stands nowhere", None)]
        remarks.append(
            f"{'stands' if stands else 'does not stand'} with this margin at any value"
            " of the scan"
        )
    return found, list(dict.fromkeys(remarks))
