"""Cells of a sweep that the reference computes again: chosen while workers compute, looked at by whoever is idle, compared in the end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...dynamics.outcome import Outcome
from ...dynamics.response import Response, response
from ..scene import Scene, Unit
from .condition import condition_of
from .sampling import candidates, checked_cells

Array = np.ndarray
_EXACT = 1e-10  # in place of a tolerance where the method has none: two paths round differently
Place = tuple[int, int, int]  # (structure, row, column) of a cell


class Answer(NamedTuple):
    """Outcome and theta/alpha of a cell by the reference, and its outcome under the nonlinear equation (None if not compared)."""

    outcome: Outcome
    theta_ratio: float
    judged: Outcome | None


def reference(scene: Scene, place: Place) -> Answer:
    """A cell by the path that shares nothing with the march."""
    cell = scene.cell(*place)
    outcome, theta = scene.method.reference_of(cell.structure)(*cell[1:], cell.structure.eta)
    return Answer(outcome, theta, None if outcome == Outcome.FAILED else scene.judge_of(cell))


class Verification:
    """What is computed again of the units of a sweep, of so many rows and columns.

    candidates: (n, 3), the places of all cells that may be, known before anything is computed; seen: outcome and theta/alpha of those that
    the units hold; answers: of the reference, for each of `places`.
    """

    def __init__(self, scene: Scene, check: int, chunk: tuple[int, int], units: Sequence[Unit]) -> None:
        self.scene, self.check, self.chunk = scene, check, chunk
        self.candidates = candidates(scene, check)
        self._units = {(unit.places[0], unit.row, unit.column) for unit in units}
        self.seen: dict[Place, tuple[int, float]] = {}
        self.answers: dict[Place, Answer] = {}

    @cached_property
    def sensitive(self) -> dict[Place, bool]:
        """The cells of these units that are computed again, and whether each was chosen for its sensitivity. To find those takes as long
        as to march a few hundred cells."""
        rows, columns = self.chunk
        found = checked_cells(self.scene, self.check).tolist()
        return {(i, r, c): bool(flag) for i, r, c, flag in found if (i, r - r % rows, c - c % columns) in self._units}

    def places(self) -> Iterator[Place]:
        """Those cells, which are not looked for before the first is wanted."""
        yield from self.sensitive

    def compared(self) -> Mapping[str, Any]:
        """The result of the comparison, by the names of `Summary`."""
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
        """Whether a difference of theta/alpha exceeds the tolerance times the condition of the cell, or the tolerance where that is below 1
        or not known."""
        method, cell = self.scene.method, self.scene.cell(*place)
        tolerance = method.stated_tolerance or _EXACT
        if not apart > tolerance:
            return False

        def respond(amplitude: Array, omega: Array, eta: Array) -> Response:
            return response(method.system_of(cell.structure), cell.motion, amplitude, omega, eta)

        amplitude, omega, eta = (np.array([x]) for x in (cell.amplitude, cell.omega, cell.structure.eta))
        (condition,) = condition_of(respond, amplitude, omega, eta, method.stated_tolerance or 0.0)
        return not apart <= tolerance * np.nanmax([1.0, condition])
