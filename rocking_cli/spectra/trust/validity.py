"""The linear equation of a sweep compared with the nonlinear one at some cells, half of them drawn, half next to a boundary.

The cells depend on the scene alone, like those of `verification`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...dynamics.method import Method
from ...dynamics.outcome import Difference, difference, falls
from ...dynamics.response import response
from ..scene import PulseScene, Scene
from .verification import sampled_cells

Array = np.ndarray

_CELLS = 64  # that the nonlinear equation judges
_DRAWN = 512  # candidates for cells next to a boundary
_STRUCTURES = 4  # each structure costs a few further rounds
_SEED = 20120925


@dataclass(frozen=True)
class Validity:
    """Numbers of cells: computed by both equations, with different outcomes, and with a body that falls but stands in the linear one."""

    sampled: int
    differ: int
    unsafe: int


def validity(scene: Scene, tolerance: float = 1e-6) -> Validity | None:
    """The comparison at cells of a linear sweep under a pulse; None if the nonlinear equation holds for none of the structures, or
    no cell leaves the ground. tolerance: of the nonlinear equation."""
    nonlinear = Method("nonlinear", tolerance)
    if not (isinstance(scene, PulseScene) and scene.method.exact):
        return None
    known = [s for s in scene.structures if nonlinear.serves(s)]
    some = [known[i] for i in np.linspace(0, len(known) - 1, min(_STRUCTURES, len(known))).astype(int)]
    judged = [_differences(replace(scene, structures=(structure,)), nonlinear, _CELLS // len(some)) for structure in some]
    codes = np.concatenate([np.zeros(0, np.uint8), *judged])
    codes = codes[codes != Difference.NOT_COMPUTED]
    if not codes.size:
        return None
    return Validity(codes.size, int(np.count_nonzero(codes != Difference.AGREES)), int(np.count_nonzero(codes == Difference.LINEAR_UNSAFE)))


def _differences(scene: PulseScene, nonlinear: Method, count: int) -> Array:
    """`Difference` of up to `count` cells of one structure: half of them drawn, half with another outcome at the next amplitude."""
    (structure,), drawn = scene.structures, sampled_cells(scene, _DRAWN, _SEED)[:, 1:]
    amplitude, omega = scene.grid.scaled(structure)
    beside = np.stack([drawn[:, 1], np.minimum(drawn[:, 1] + 1, amplitude.size - 1)])
    respond = partial(response, motion=scene.motion, eta=structure.eta, peaks=False)
    linear = respond(scene.method.system_of(structure), amplitude=amplitude[beside], omega=omega[drawn[:, 0]]).outcome
    changes = falls(linear[0]) != falls(linear[1])
    near = np.flatnonzero(changes)[: count // 2]
    at = np.append(near, np.setdiff1d(np.arange(len(drawn)), near)[: count - near.size])
    decided = respond(nonlinear.system_of(structure), amplitude=amplitude[drawn[at, 1]], omega=omega[drawn[at, 0]])
    return difference(decided.outcome, linear[0][at])
