"""Refusal of runs that would take years; how long other runs take is measured while they go on (`commands/progress.py`)."""

from __future__ import annotations

from ..errors import UsageError

_MOST = 1e14  # cells times segments: years of a processor by the quickest equation


def refuse_endless(cells: float, segments: int) -> None:
    """Refuse more cells than a processor computes in years under a motion of so many segments. Raises UsageError."""
    if cells * segments > _MOST:
        found = f"{cells:.3g} cells under {segments} segments of shaking"
        raise UsageError(f"found {found}, which take years; accepted are up to {_MOST / segments:.3g} cells")
