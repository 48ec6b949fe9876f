"""The overturning spectrum of a set of records: quantiles of the first overturning against the size of a body."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from .record_scene import RecordScene

QUANTILES = (16, 50, 84)


def overturning_spectrum(scene: RecordScene, records: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """The rows of a spectrum, one for each size or structure, from the rows of `tracing_records` with `first`.

    structure, or alpha [rad] and T [s]; p [rad/s]; pga_ratio_16, _50, _84: quantiles of the first overturning PGA/(lambda g)
    over the records [%], None if too few of them overturn the body; overturned, records: their numbers.
    """
    found: dict[tuple[Any, ...], list[float]] = {}
    keys = ("alpha", "T") if scene.over_angles else ("structure",)
    for record in records:
        a = record["A_from"]
        found.setdefault(tuple(record[key] for key in keys), []).append(math.inf if a is None else a)
    bodies = {s.alpha if scene.over_angles else s.name: s for s in scene.structures}
    for place, amplitudes in found.items():
        body = bodies[place[0]]
        uplift = math.tan(body.alpha) if scene.over_angles else body.uplift
        ratio = np.sort(amplitudes) * body.ground_acceleration(1.0) / (uplift * body.gravity)
        yield {
            **dict(zip(keys, place, strict=True)),
            "p": 2.0 * math.pi / place[1] if scene.over_angles else body.p,
            **{f"pga_ratio_{q}": _quantile(ratio, q / 100.0) for q in QUANTILES},
            "overturned": int(np.isfinite(ratio).sum()),
            "records": ratio.size,
        }


def _quantile(rising: np.ndarray, share: float) -> float | None:
    """The quantile, linear between the order statistics; None if it is infinite."""
    place = share * (rising.size - 1)
    low, high = float(rising[math.floor(place)]), float(rising[math.ceil(place)])
    return low + (place - math.floor(place)) * (high - low) if math.isfinite(high) else None
