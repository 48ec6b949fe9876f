"""The work of a run in numbers."""

from __future__ import annotations

from dataclasses import dataclass, fields


@dataclass(frozen=True)
class Work:
    """Numbers of cells, impacts and steps that were computed, and of those that a proof left out."""

    cells: int = 0
    no_uplift: int = 0
    certain_overturning: int = 0
    free_phase: int = 0
    rests_skipped: int = 0
    chatters_closed: int = 0
    impacts: int = 0
    steps: int = 0

    def __add__(self, other: Work) -> Work:
        return Work(**{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)})
