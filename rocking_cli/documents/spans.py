"""Numbers from a start to a stop, as `START:STOP:N` or `START:STOP:N:log`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import UsageError
from .quantities import parse_whole

if TYPE_CHECKING:
    from ..arrays import Array


def split_span(
    key: str, text: str, wanted: str, least: int, most: int
) -> tuple[str, str, int, bool]:
    """Return (START, STOP, N, True for equal ratios) of a span; key, wanted: for
    messages; least, most: of N. Raises UsageError.
    """
    parts = text.split(":")
    log = parts[3:] == ["log"]
    if len(parts) != 3 + log:
        raise UsageError(f"{key}: found {text!r}; expected {wanted}")
    count = parse_whole(parts[2])
    if count is None or not least <= count <= most:
        raise UsageError(
            f"{key}: found N = {parts[2]!r}; expected a whole number from {least} to"
            f" {most}"
        )
    return parts[0], parts[1], count, log


def spaced(key: str, start: float, stop: float, count: int, log: bool) -> Array:
    """Return numbers in equal steps, or in equal ratios. Raises UsageError for ratios
    from a bound that is not positive.
    """
    import numpy as np

    if not log:
        return np.linspace(start, stop, count)
    if min(start, stop) <= 0.0:
        raise UsageError(
            f"{key}: found START {start:g}; a logarithmic axis needs a positive START"
        )
    return np.asarray(np.geomspace(start, stop, count))
