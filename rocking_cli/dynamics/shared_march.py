"""Several structures under one motion, whose cells are marched together."""

from collections.abc import Callable, Hashable, Sequence
from functools import cached_property
from typing import Any

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

    @cached_property
    def kept_to(self) -> Array:
        """The amplitude A of each structure up to which contact with the ground is
        proved [-], (structures,).
        """
        return self._of_groups(lambda system: system.safe_amplitude(self.motion))

    @cached_property
    def kept_while_low(self) -> Array:
        """As `kept_to`, while the energy stays below the barrier."""
        return self._of_groups(lambda system: system.safe_amplitude(self.motion, True))

    def supports(self, holds: Callable[[System, Motion], bool]) -> Array:
        """True for structures for which `holds` is, (structures,)."""
        return self._of_groups(lambda system: holds(system, self.motion)) > 0.0

    def system_of(self, which: Array) -> System:
        """Return one system for cells of these structures of one group, (cells,)."""
        systems = [self.systems[i] for i in which]
        return System.of_each_cell(systems, [1] * which.size)

    def _of_groups(self, number: Callable[[System], Any]) -> Array:
        """A number of each structure, (structures,); number: of those of a group."""
        found = np.empty(self.group.size)
        for group in np.unique(self.group):
            at = np.flatnonzero(self.group == group)
            found[at] = number(self.system_of(at))
        return found

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
        return response(
            system,
            self.motion,
            amplitude,
            omega,
            peaks=peaks,
            how=how,
            kept_to=self.kept_to[which],
        )
