"""Verification of some cells of a sweep by the reference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ...dynamics.outcome import Outcome
from ...dynamics.response import Response, response
from ..scene import Scene, Unit
from .condition import condition_of
from .sampling import checked_cells

Array = np.ndarray
_EXACT = 1e-10  # tolerance for an exact method, for the rounding of two paths
Place = tuple[int, int, int]  # (structure, row, column) of a cell


class Answer(NamedTuple):
    """Outcome and theta/alpha of a cell by the reference, and its outcome under the nonlinear equation (None if not compared)."""

    outcome: Outcome
    theta_ratio: float
    judged: Outcome | None


def reference(scene: Scene, place: Place) -> Answer:
    """The answer for a cell by the reference, which shares no code with the march."""
    cell = scene.cell(*place)
    outcome, theta = scene.method.reference_of(cell.structure)(*cell[1:], cell.structure.eta)
    return Answer(outcome, theta, None if outcome == Outcome.FAILED else scene.judge_of(cell))


class Verification:
    """The cells of some units, of `size` rows and columns, that are computed again.

    sensitive: their places, with True for those chosen for their sensitivity; seen: outcome and theta/alpha of each in the sweep; answers:
    of the reference.
    """

    def __init__(self, scene: Scene, check: int, chunk: tuple[int, int], units: Sequence[Unit]) -> None:
        (rows, columns), there = chunk, {(unit.places[0], unit.row, unit.column) for unit in units}
        found = checked_cells(scene, check).tolist() if units else []
        self.scene = scene
        self.sensitive = {(i, r, c): bool(flag) for i, r, c, flag in found if (i, r - r % rows, c - c % columns) in there}
        self.seen: dict[Place, tuple[int, float]] = {}
        self.answers: dict[Place, Answer] = {}

    def compared(self) -> Mapping[str, Any]:
        """The result of the comparison, by the fields of `Summary`."""
        worst, misjudged, checked, sensitive, compared, otherwise, beyond = 0.0, 0, 0, 0, 0, 0, 0
        for place, answer in self.answers.items():
            if answer.outcome == Outcome.FAILED:
                continue
            outcome, theta = self.seen[place]
            if answer.judged is not None:
                compared, otherwise = compared + 1, otherwise + int(answer.judged.overturned != answer.outcome.overturned)
            checked, sensitive = checked + 1, sensitive + int(self.sensitive[place])
            misjudged += int(answer.outcome != outcome)
            if answer.outcome == outcome and np.isfinite(answer.theta_ratio):
                apart = abs(answer.theta_ratio - theta)
                worst, beyond = max(worst, apart), beyond + int(self._unexplained(place, apart))
        return {
            "estimated_error": worst, "misjudged": misjudged, "checked_cells": checked, "sensitive_cells": sensitive,
            "compared": compared, "otherwise": otherwise, "beyond_tolerance": beyond,
        }  # fmt: skip

    def _unexplained(self, place: Place, apart: float) -> bool:
        """True if a difference of theta/alpha exceeds the tolerance times max(1, condition of the cell); the condition is 1 if unknown."""
        method, cell = self.scene.method, self.scene.cell(*place)
        tolerance = method.stated_tolerance or _EXACT
        if not apart > tolerance:
            return False

        def respond(amplitude: Array, omega: Array, eta: Array) -> Response:
            return response(method.system_of(cell.structure), cell.motion, amplitude, omega, eta)

        amplitude, omega, eta = (np.array([x]) for x in (cell.amplitude, cell.omega, cell.structure.eta))
        (condition,) = condition_of(respond, amplitude, omega, eta, method.stated_tolerance or 0.0)
        return not apart <= tolerance * np.nanmax([1.0, condition])
