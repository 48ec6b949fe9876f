"""`Lanes` holds the state of many rocking bodies, a lane each, as arrays of one length;
`Cells` the drive of each cell on each side.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np

from ..arrays import Array


@dataclass
class Arrays:
    """Base of groups of lanes. A field is an array with the lanes on its last axis,
    another such group, or one value for all lanes.
    """

    def take(self, at: Array | slice) -> Self:
        """Return these lanes only: copies if `at` holds indices, views if it is a
        slice.
        """
        return type(self)(
            *[_taken(getattr(self, name), at) for name in self.__dataclass_fields__]
        )

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """The lanes of all parts, one after the other; fields that only a subclass has
        are left out.
        """
        fields = [
            [getattr(part, name) for part in parts] for name in cls.__dataclass_fields__
        ]
        return cls(*map(_joined, fields))

    def join(self, other: Self) -> Self:
        """These lanes followed by other lanes."""
        return self.joined([self, other])


def _taken(x: Any, at: Any) -> Any:
    if isinstance(x, np.ndarray):
        # `take` keeps rows of lanes contiguous; x[..., at] would not
        whole = x.ndim == 1 or isinstance(at, slice)
        return x[..., at] if whole else x.take(at, axis=-1)
    return x.take(at) if isinstance(x, Arrays) else x


def _joined(parts: list[Any]) -> Any:
    if isinstance(parts[0], np.ndarray):
        return np.concatenate(parts, axis=-1)
    return parts[0].joined(parts) if isinstance(parts[0], Arrays) else parts[0]


def ahead(lanes: Any, step: Callable[[Any, Array], Array], most: int) -> Any:
    """Return lanes after up to `most` steps, those that have moved (`time` > 0); step:
    moves those of some lanes that are going (True), in place, and returns True for
    those that may go on.
    """
    on, behind = np.ones(lanes.y.size, dtype=bool), []
    for _ in range(most):
        on = step(lanes, on)
        going = np.flatnonzero(on)
        if 2 * going.size < on.size:
            behind.append(lanes.take(np.flatnonzero(~on)))
            lanes, on = lanes.take(going), on[going]
        if not going.size:
            break
    lanes = lanes.joined([*behind, lanes])
    return lanes.take(np.flatnonzero(lanes.time > 0.0))


def of_each_cell(bodies: Sequence[Any], counts: Sequence[int]) -> dict[str, Any]:
    """Return the fields that are `cellwise`, for so many cells of each of these objects
    of one class: a number becomes an array (cells,), a tuple a tuple of arrays.
    """
    found = {}
    for name in bodies[0].cellwise:
        cells = np.repeat([getattr(one, name) for one in bodies], counts, axis=0)
        found[name] = cells if cells.ndim == 1 else tuple(cells.T)
    return found


class Cells(NamedTuple):
    """The drive of each cell. The arrays have one row, (1, cells), if the sides are
    alike; otherwise they have two, (2, cells), first the right edge (theta > 0), then
    the left.
    """

    # amplitude of the ground over the uplift acceleration of the side [-]
    amplitude: Array
    omega: Array  # omega_g / p of the side [-]
    # speed after over speed before the impact that leaves the side [-], each speed in
    # the unit of its side
    eta: Array

    def row(self, side: Array) -> Array | int:
        """The index of the row for each side, +1 or -1."""
        return 0 if len(self.amplitude) == 1 else (side < 0.0).astype(np.int64)


@dataclass
class Lanes(Arrays):
    """The state of rocking bodies, one body in each lane. Every array but one is
    (lanes,). The side is stored, never inferred from a sign.
    """

    cell: Array  # index of the cell that the lane computes
    amplitude: Array  # A of the present side, as in `Cells` [-]
    omega: Array  # Omega of the present side, as in `Cells` [-]
    eta: Array  # restitution of the present side, as in `Cells` [-]
    segment: Array  # index of the segment of the motion
    phase: Array  # phase since the start of the segment [rad]
    side: Array  # +1 on the right edge (theta > 0), -1 on the left
    y: Array  # displacement, in the unit of the side
    v: Array  # dy/dtau, tau = p t with the p of the side
    force: Array  # y'' + 2 zeta y'
    peak: Array  # largest y at a turning point so far, in the unit of the present side
    impacts: Array  # number of impacts so far
    steps: Array  # number of steps so far
    # second moments of an error (`condition`): yy, yv and vv of the present state, and
    # that of |theta|/alpha at the largest peak, (4, lanes)
    moments: Array

    @classmethod
    def at_rest(cls, cells: Cells, cell: Array, side: Array, **others: Any) -> Self:
        """Return lanes for these cells, at rest on these sides at the start of the
        motion; others: fields with other values, and those of a subclass.
        """
        row, size = cells.row(side), cell.size
        fields: dict[str, Array] = {
            "cell": cell,
            "side": side,
            "moments": np.zeros((4, size)),
            **{name: x[row, cell] for name, x in cells._asdict().items()},
            **{name: np.zeros(size) for name in ("phase", "y", "v", "force", "peak")},
            **{name: np.zeros(size, int) for name in ("segment", "impacts", "steps")},
        }
        return cls(**(fields | others))
