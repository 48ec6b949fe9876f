"""Cells of a sweep that the reference computes again: chosen while workers compute, looked at by whoever is idle, compared in the end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...dynamics.outcome import Outcome
from ..scene import Scene, Unit
from .sampling import candidates, checked_cells

Place = tuple[int, int, int]  # (structure, row, column) of a cell


class Answer(NamedTuple):
    """What the reference says of a cell, and the nonlinear equation where the scene asks for it."""

    outcome: Outcome
    theta_ratio: float
    judged: Outcome | None


def reference(scene: Scene, place: Place) -> Answer:
    """A cell by the path that shares nothing with the march."""
    cell = scene.cell(*place)
    outcome, theta = scene.method.reference_of(cell.structure, scene.weighed)(*cell[1:], cell.structure.eta)
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
        """What it came to, by the names of `Summary`."""
        worst, misjudged, checked, sensitive, compared, otherwise = 0.0, 0, 0, 0, 0, 0
        for place, answer in self.answers.items():
            if answer.outcome == Outcome.FAILED:
                continue
            outcome, theta = self.seen[place]
            if answer.judged is not None:
                compared, otherwise = compared + 1, otherwise + int(answer.judged.overturned != answer.outcome.overturned)
            checked, sensitive = checked + 1, sensitive + int(self.sensitive[place])
            misjudged += int(answer.outcome != outcome)
            if answer.outcome == outcome and np.isfinite(answer.theta_ratio):
                worst = max(worst, abs(answer.theta_ratio - theta))
        return {
            "estimated_error": worst, "misjudged": misjudged, "checked_cells": checked, "sensitive_cells": sensitive,
            "compared": compared, "otherwise": otherwise,
        }  # fmt: skip
