"""What a sweep or the scan of an envelope takes, roughly, before it begins: said where that is long, refused where it has no end."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..dynamics.march.engine import MAX_STEPS
from ..dynamics.method import BY_GENERAL_SOLVER, Method
from ..errors import UsageError
from ..structures.parameters import RockingParameters
from .scene import Scene
from .trust.sampling import default_check
from .units import TOGETHER

Tell = Callable[[str], None]


_MOST_UNITS = 1_000_000
_LONG = 60.0  # s from which on the time is said beforehand
_ENDLESS = 10 * 365.25 * 86400.0  # s of all processors together
_CALLS = 5  # of the march in which the scan of an envelope meets such bodies
_BETWEEN = 20_000  # of their bounces between two uplifts under a record: after the last one they are not followed
# s of a batch of cells under a record, of each of them, through which they fly, and of the tables of a sample.
_FLIGHT, _FLOWN, _TABLED = 0.3, 3e-4, 1e-6
# Those through which they walk: s of a batch for one sample, and of each cell, or this part of what a segment costs on the march.
_STRIDE, _WALKED, _OF_MARCH = 2e-4, 1.5e-7, 0.02
_OF_CHECK = 1e-2  # part of what it costs to check a segment of a pulse that a sample takes
_UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0, "days": 86400.0, "years": 365.25 * 86400.0}


def expected_seconds(
    method: Method, structure: RockingParameters, segments: int, *, cells: int, batches: int, checked: int = 0, record: bool = False
) -> float:
    """Seconds of a processor, to within a factor of a few, for cells in batches under a motion of so many segments; record: whether it
    is one: the undamped linear oscillator is propagated over its samples at a cost of its impacts, any other takes Taylor steps."""
    rates = method.kind_of(structure).cost
    checking = rates.checked if structure.plain or not method.exact else BY_GENERAL_SOLVER
    if record:
        checking *= _OF_CHECK
    if record and method.system_of(structure).equation.bounded:
        return batches * (_FLIGHT + segments * _TABLED) + cells * _FLOWN + segments * checked * checking
    batch, cell = (_STRIDE, max(_WALKED, _OF_MARCH * rates.cell)) if record else (rates.batch, rates.cell)
    return segments * (batches * batch + cells * cell + checked * checking)


def bouncing_seconds(method: Method, structure: RockingParameters, *, record: bool = False) -> float:
    """Seconds of a processor, as roughly, that a scan spends on bodies that lose next to nothing at an impact: their bounces are
    marched one by one until their speed has fallen by twelve orders, or they are given up, or until nothing lifts them again."""
    keeps, calls, most = abs(structure.eta), 1 if record else _CALLS, _BETWEEN if record else MAX_STEPS
    bounces = most if keeps >= 1.0 else min(most, 28.0 / -math.log(max(keeps, 1e-12)))
    return calls * bounces * method.kind_of(structure).cost.batch


def announce_sweep(
    scene: Scene, chunk: tuple[int, int], workers: int, check: int | None = None, parts: int = 1, tell: Tell | None = None
) -> None:
    """`announce` one of the parts of a sweep in units of work of so many rows and columns. Raises UsageError, for too many of them too."""
    rows, columns = (-(-n // size) for n, size in zip(scene.shape[1:], chunk, strict=True))
    systems = len(scene.sharing())
    units, cells = rows * columns * systems, scene.shape[1] * scene.shape[2] * systems
    if units > _MOST_UNITS:
        raise UsageError(f"{units} units of work of {chunk[0] * chunk[1]} cells, accepted are up to {_MOST_UNITS}; make them larger")
    checked = min(cells, default_check(scene) if check is None else check)
    batches = max(cells // TOGETHER, 1) if scene.method.exact and not scene.of_records else scene.batches(units)
    segments = scene.segments
    counts = {"cells": cells, "batches": batches, "checked": checked}
    seconds = max(expected_seconds(scene.method, s, segments, **counts, record=scene.of_records) for s in scene.structures)
    what = f"{cells // parts} cells under {segments} segments of shaking" + (f", {checked} of them checked" if checked else "")
    announce(seconds / parts, what, min(workers, units), tell)


def announce(seconds: float, what: str, workers: int, tell: Tell | None, *, always: bool = False) -> None:
    """Announce how long it takes if more than a minute, or always. Raises UsageError, with that time, for what takes ten years of a
    processor."""
    if seconds > _ENDLESS:
        raise UsageError(f"{what} take roughly {_in_words(seconds)} of a processor, accepted are up to {_in_words(_ENDLESS)}")
    if (always or seconds > _LONG * workers) and tell is not None:
        on = f" on {workers} processes" if workers > 1 else ""
        tell(f"{what}: up to roughly {_in_words(seconds / workers)}{on}")


def _in_words(seconds: float) -> str:
    unit = max((u for u, length in _UNITS.items() if seconds >= 2.0 * length), key=_UNITS.__getitem__, default="s")
    return f"{float(f'{seconds / _UNITS[unit]:.2g}'):g} {unit}"
