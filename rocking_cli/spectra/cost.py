"""Refusal of runs that would take years."""

from __future__ import annotations

from ..errors import UsageError

_MOST = 1e14  # cells times segments: years of a processor with the fastest equation


def refuse_endless(cells: float, segments: int) -> None:
    """Raise UsageError if these cells under a motion of so many segments would take years of a processor."""
    if cells * segments > _MOST:
        found = f"{cells:.3g} cells under {segments} segments of shaking"
        raise UsageError(f"found {found}, which would take years; expected up to {_MOST / segments:.3g} cells")
