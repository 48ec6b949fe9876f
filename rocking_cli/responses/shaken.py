"""The answer of one body to a demand and to small changes of it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..dynamics.method import LINEAR, Method, governing_method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import Response, response
from ..dynamics.shared_march import SharedMarch
from ..envelopes.capacity import SHIFTS, Capacity, CapacitySearch
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid
from ..structures.parameters import RockingParameters

_SAME = 0.01  # of theta/alpha: rotations under them that differ by less are one


def capacity_search(
    structure: RockingParameters, motion: Motion, shaking: Grid, a_max: float
) -> CapacitySearch:
    """Return the search for the overturning amplitudes of a demand. Raises UsageError
    as `check` does.
    """
    if structure.dimensionless:
        raise UsageError("a restitution alone has no units: give a structure document")
    amplitude, omega = shaking.cell(structure)
    if not amplitude > 0.0:
        raise UsageError("the amplitude is 0; expected a positive one")
    return CapacitySearch(
        structure,
        motion,
        amplitude,
        omega,
        governing_method(structure, dimensionless=shaking.dimensionless),
        a_max,
    )


class Shaken(NamedTuple):
    """The answer of a body to a demand and to small changes of it."""

    search: CapacitySearch  # the search for its overturning amplitudes
    amplitudes: np.ndarray  # A [-]: the demand first, then amplitudes close to it
    codes: np.ndarray  # codes of `Outcome` at these, by the governing equation
    theta_ratio: np.ndarray  # largest |theta|/alpha at these [-], NaN where it falls
    linear: Outcome  # by the linear equation, under the demand
    uplift: float  # least amplitude that lifts the body [-], infinite if none does

    @property
    def outcome(self) -> Outcome:
        """The outcome under the demand."""
        return Outcome(int(self.codes[0]))

    @property
    def falling(self) -> np.ndarray:
        """Those of the amplitudes that overturn the body, (some,)."""
        return self.amplitudes[~safe(self.codes) & (self.codes != Outcome.FAILED)]

    @property
    def unsettled(self) -> bool:
        """True if small changes of the demand change the outcome or the rotation."""
        stands = safe(self.codes)
        if not stands.any():
            return False
        turned = self.theta_ratio[stands]
        return bool(self.falling.size or np.ptp(turned) > _SAME)

    def lowest(self, found: Capacity) -> tuple[float | None, float | None]:
        """(lowest overturning amplitude, end of the safe interval around the demand)
        [m/s2], None without one; found: what the search has found.
        """
        structure, demand = self.search.structure, self.search.amplitude
        near = self.falling if self.outcome.safe else self.falling[:0]
        return (
            least_acceleration(structure, found.first, *near),
            least_acceleration(structure, found.safe_to, *near[near > demand]),
        )


def answer_of(search: CapacitySearch) -> Shaken:
    """Compute the answer of a body to the demand of a search, on floats."""
    body, motion, omega = search.structure, search.motion, search.omega
    shifted = search.amplitude * (1.0 + SHIFTS)
    found = respond(search.method, body, motion, shifted, omega)
    linear = respond(LINEAR, body, motion, shifted[:1], omega)
    of_linear = Outcome(int(linear.outcome[0]))
    uplift = search.method.system_of(body).least_uplift(motion)
    return Shaken(search, shifted, found.outcome, found.theta_ratio, of_linear, uplift)


def answers_together(searches: Sequence[CapacitySearch]) -> list[Shaken]:
    """Compute the answers of many bodies to their demands; those under one motion are
    marched together, on arrays.
    """
    found: list[Shaken | None] = [None] * len(searches)
    motions: dict[int, list[int]] = {}
    for i, one in enumerate(searches):
        motions.setdefault(id(one.motion), []).append(i)
    for at in motions.values():
        own = [searches[i] for i in at]
        bodies, motion = [one.structure for one in own], own[0].motion
        omega = np.array([one.omega for one in own])
        shifted = np.array([one.amplitude for one in own])[:, None] * (1.0 + SHIFTS)
        which = np.arange(len(own))
        march = SharedMarch(motion, bodies, [one.method for one in own])
        each = np.repeat(which, SHIFTS.size)
        turned, codes, _ = march.response(each, shifted.ravel(), omega[each])
        _, linear, _ = SharedMarch(motion, bodies, [LINEAR] * len(own)).response(
            which, shifted[:, 0], omega, peaks=False
        )
        codes, turned = codes.reshape(shifted.shape), turned.reshape(shifted.shape)
        for n, i in enumerate(at):
            of_linear = Outcome(int(linear[n]))
            uplift = march.systems[n].least_uplift(motion)
            found[i] = Shaken(
                own[n], shifted[n], codes[n], turned[n], of_linear, uplift
            )
    return [one for one in found if one is not None]


def least_acceleration(
    structure: RockingParameters, *amplitudes: float | None
) -> float | None:
    """Return the least of these amplitudes A as an acceleration [m/s2], None without
    one.
    """
    least = min((x for x in amplitudes if x is not None), default=None)
    return None if least is None else float(structure.ground_acceleration(least))


def respond(
    method: Method,
    structure: RockingParameters,
    motion: Motion,
    amplitude: np.ndarray,
    omega: float,
) -> Response:
    """Return the response at these amplitudes, computed on floats."""
    return response(
        method.system_of(structure),
        motion,
        amplitude,
        omega,
        how="floats",
    )
