"""The linear equation of a sweep compared with the nonlinear one at some cells, half of them drawn, half next to a boundary.

The cells depend on the scene alone, like those of `sampling`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...dynamics.method import Method
from ...dynamics.outcome import Difference, difference, falls
from ...dynamics.response import response
from ..scene import PulseScene, Scene
from .sampling import sampled_cells

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


class _Judged(NamedTuple):
    """Cells (row, column) of a structure, and `Difference` of each."""

    cells: Array
    codes: Array


def validity(scene: Scene, tolerance: float = 1e-6) -> Validity | None:
    """The comparison at cells of a linear sweep under a pulse; None if the nonlinear equation holds for none of the structures, or
    no cell leaves the ground. tolerance: of the nonlinear equation."""
    nonlinear = Method("nonlinear", tolerance)
    if not (isinstance(scene, PulseScene) and scene.method.exact):
        return None
    known = [i for i, s in enumerate(scene.structures) if nonlinear.serves(s)]
    if not known:
        return None
    some = [known[i] for i in np.linspace(0, len(known) - 1, min(_STRUCTURES, len(known))).astype(int)]
    found = [_judged(scene, i, nonlinear, _CELLS // len(some)) for i in some]
    codes = np.concatenate([one.codes for one in found])
    codes = codes[codes != Difference.NOT_COMPUTED]
    if not codes.size:
        return None
    return Validity(codes.size, int(np.count_nonzero(codes != Difference.AGREES)), int(np.count_nonzero(codes == Difference.LINEAR_UNSAFE)))


def _judged(scene: PulseScene, place: int, nonlinear: Method, count: int) -> _Judged:
    """Up to `count` cells of one structure: half of them drawn, half with another outcome at the next amplitude."""
    structure = scene.structures[place]
    alone = PulseScene((structure,), scene.grid, scene.motion, scene.method)
    drawn = sampled_cells(alone, _DRAWN, _SEED)[:, 1:]
    if not drawn.size:
        return _Judged(drawn, np.zeros(0, dtype=np.uint8))
    amplitude, omega = scene.grid.scaled(structure)
    system = scene.method.system_of(structure)
    beside = np.stack([drawn[:, 1], np.minimum(drawn[:, 1] + 1, amplitude.size - 1)])
    linear = response(system, scene.motion, amplitude[beside], omega[drawn[:, 0]], structure.eta, peaks=False).outcome
    changes = falls(linear[0]) != falls(linear[1])
    near = np.flatnonzero(changes)[: count // 2]
    others = np.ones(len(drawn), dtype=bool)
    others[near] = False
    at = np.concatenate([near, np.flatnonzero(others)[: count - near.size]])
    decided = response(
        nonlinear.system_of(structure), scene.motion, amplitude[drawn[at, 1]], omega[drawn[at, 0]], structure.eta, peaks=False
    )
    return _Judged(drawn[at], difference(decided.outcome, linear[0][at]))
