"""Several structures under one motion, whose cells are marched together."""

from collections.abc import Callable, Hashable, Sequence

import numpy as np

from ..arrays import Array
from ..motions.motion import Motion
from ..structures.parameters import RockingParameters
from .method import Method
from .response import Response, cheaper, response
from .system import System


class SharedMarch:
    """Structures under one motion; the cells of those that can share a system are
    marched together.
    """

    def __init__(
        self,
        motion: Motion,
        structures: Sequence[RockingParameters],
        methods: Sequence[Method],
    ) -> None:
        self.motion = motion
        self.systems = [
            method.system_of(s) for s, method in zip(structures, methods, strict=True)
        ]
        groups: dict[Hashable, int] = {}
        mixed = motion.vertical is None
        # number of the group of each structure that shares a march, (structures,)
        self.group = np.array(
            [
                groups.setdefault(system.march_key(mixed), len(groups))
                for system in self.systems
            ]
        )

    def response(
        self, which: Array, amplitude: Array, omega: Array, peaks: bool = True
    ) -> tuple[Array, Array, Array]:
        """Return (theta_ratio, outcome, impacts_at_least) of cells: structure `which`
        at this amplitude A and Omega, (cells,) each; without peaks theta_ratio is NaN.
        """
        theta_ratio = np.full(which.size, np.nan)
        outcome = np.zeros(which.size, dtype=np.uint8)
        impacts = np.zeros(which.size, dtype=np.int32)
        for number in np.unique(self.group[which]):
            at = np.flatnonzero(self.group[which] == number)
            at = at[np.argsort(which[at], kind="stable")]  # by structure
            found = self._of_group(which[at], amplitude[at], omega[at], peaks)
            theta_ratio[at], outcome[at] = found.theta_ratio, found.outcome
            impacts[at] = found.impacts_at_least
        return theta_ratio, outcome, impacts

    def of_rows(
        self, which: Array, omega: Array
    ) -> Callable[[Array, Array], tuple[Array, Array]]:
        """Return the function of rows and amplitudes A, (cells,) each, that computes
        outcomes and impacts; which, omega: the structure and Omega of each row, (rows,)
        each.
        """
        return lambda row, amplitude: self.response(
            which[row], amplitude, omega[row], peaks=False
        )[1:]

    def _of_group(
        self, which: Array, amplitude: Array, omega: Array, peaks: bool
    ) -> Response:
        """Return the responses of cells of one group, which are in the order of their
        structures.
        """
        own, counts = np.unique(which, return_counts=True)
        systems = [self.systems[i] for i in own]
        system = System.of_each_cell(systems, counts.tolist())
        how = cheaper(system, self.motion, which.size) if own.size == 1 else "arrays"
        return response(system, self.motion, amplitude, omega, peaks=peaks, how=how)
