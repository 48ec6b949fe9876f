"""Responses of draws of a structure to a set of motions: each motion has draws of its
own, so that a share is a mean over the motions and the spreads.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..dynamics.outcome import Outcome, falls
from ..envelopes.together import Together
from ..errors import UsageError
from ..structures.draws import Draw, draws
from ..structures.parameters import RockingParameters
from .exposure import MotionSet, StudyProgress
from .fitted_curve import SlideLimit
from .measures import MotionMember


@dataclass(frozen=True, eq=False)
class DrawnExposure:
    """Responses of the draws of one structure, or of the structures of a class, to each
    motion of a set, scaled to each level of the intensity measure.
    """

    # max |theta|/alpha, NaN where it falls [-], (members, levels, n)
    theta_ratio: Array
    outcome: Array  # codes of `Outcome`, (members, levels, n)
    made: Array  # True for draws that make a structure, (members, n)
    fault: str | None = None  # why the first of the others makes none
    of_class: bool = False  # True for the structures of a class

    def counts(self, limit: float | None) -> tuple[Array, Array]:
        """Return the shares of the draws that are known, and that are known and beyond
        a limit state (None: overturning), (members, levels).
        """
        if isinstance(limit, SlideLimit):
            raise UsageError(
                f"limit state {limit}: draws have no displacement; expected a structure"
                " without a spread"
            )
        known = self.outcome != Outcome.FAILED
        beyond = falls(self.outcome)
        if limit is not None:
            with np.errstate(invalid="ignore"):
                beyond = beyond | (self.theta_ratio > limit)
        known &= self.made[:, None, :]
        total = self.made.sum(axis=1)[:, None]
        return known.sum(axis=2) / total, (known & beyond).sum(axis=2) / total


def drawn_exposure(
    structure: RockingParameters,
    motions: MotionSet,
    n: int,
    seed: int,
    progress: StudyProgress | None = None,
) -> DrawnExposure:
    """Return the responses of draws of a structure.

    Each motion has its own block of n draws: n consecutive points of one Sobol
    sequence, which are as even as its first n.

    Parameters
    ----------
    structure
        a structure whose document holds numbers with a spread
    motions
        the set, its measure and its levels
    n
        number of draws for each motion, rounded up to a power of two
    seed
        of the draws
    progress
        called with the number of finished motions, and of all

    Raises
    ------
    UsageError
        if the draws of a motion make no structure
    """
    assert structure.drawn_from is not None
    n = 1 << (n - 1).bit_length()
    count = len(motions.members)
    every = list(draws(structure.drawn_from, n * count, seed))
    found = []
    for i, member in enumerate(motions.members):
        found.append(_under(motions, member, every[i * n : (i + 1) * n]))
        if progress is not None:
            progress(i + 1, count)
    theta_ratio, outcome, made = (np.array(x) for x in zip(*found, strict=True))
    fault = next((draw.fault for draw in every if draw.fault), None)
    return DrawnExposure(theta_ratio, outcome, made, fault)


def _under(
    motions: MotionSet, member: MotionMember, block: Sequence[Draw]
) -> tuple[Array, Array, Array]:
    """Return (theta_ratio, outcome, made) of draws under one motion, the first two
    (levels, n). Raises UsageError if no draw makes a structure.
    """
    made = np.array([draw.parameters is not None for draw in block])
    bodies = [draw.parameters for draw in block if draw.parameters is not None]
    if not bodies:
        raise UsageError(f"no draw makes a structure: {block[0].fault}")
    omega = np.array([member.omega / body.p for body in bodies])
    together = Together(motions.method, member.motion, bodies, omega)
    unit = np.array([motions.unit(body, member) for body in bodies])
    amplitude = (motions.scales[:, None] * unit).ravel()
    which = np.tile(np.arange(len(bodies)), motions.levels.size)
    theta, codes = together.responses(which, amplitude)

    shape = (motions.levels.size, made.size)
    theta_ratio = np.full(shape, np.nan)
    outcome = np.full(shape, Outcome.FAILED, dtype=np.uint8)
    theta_ratio[:, made] = theta.reshape(-1, len(bodies))
    outcome[:, made] = codes.reshape(-1, len(bodies))
    return theta_ratio, outcome, made
