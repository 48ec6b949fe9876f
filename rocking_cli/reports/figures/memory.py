"""Results in memory, in the forms that the figures take: rows in SI units, the cells of
a spectra file, and results that have a figure of their own.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from ...envelopes.intervals import Interval
from ...errors import ArgumentError
from ...fragility.fitted_curve import Fit
from ...motions.grid import Grid
from ...motions.motion import Motion
from ...motions.recording import Recording
from ...motions.records import Record
from ...responses.code_check import CodeCheck
from ...responses.sliding import SlideHistory
from ...responses.time_history import TimeHistory
from ...responses.verdict import Verdict
from ...spectra.file.reader import SpectraFile
from ...spectra.results import Spectrum
from ...spectra.scene import PulseScene
from ..rows import Rows, rows_in_memory
from ..units import Units
from .canvas import Axes, Figure
from .capacities import capacities, capacity_curves
from .records import traces

# draws into a figure in these units; into the Axes of the caller, if there are some
Plan = Callable[[Figure, Units, Axes | None], list[Axes]]

_EXPECTED = (
    "a path, several paths, or a result of time_history, spectrum, check, code_check,"
    " envelope, trace_envelope, closed_form_curves, fragility, slide_history or"
    " load_records; draw_structures draws structures"
)


class _InMemory:
    """A spectrum in memory with the attributes of `SpectraFile` that figures read."""

    path = "the spectrum"

    def __init__(self, found: Spectrum) -> None:
        scene = found.scene
        assert isinstance(scene, PulseScene)
        self._scene, self.structures = scene, scene.structures
        self.frame = scene.frame()
        self.scene = {**scene.stated(), "model": scene.method.model}
        self._arrays = {
            "theta_ratio": found.theta_ratio,
            "outcome": found.outcome,
            **found.quantities,
        }

    @property
    def grid(self) -> Grid:
        """The grid of a scene of a pulse."""
        return self._scene.grid

    def motion(self) -> Motion:
        """Return the ground motion of a scene of a pulse."""
        return self._scene.motion

    def block(
        self, place: int, rows: slice, columns: slice = slice(None)
    ) -> dict[str, np.ndarray]:
        """Return the variables over a part of the cells of one structure."""
        return {name: cells[place, rows, columns] for name, cells in self.items()}

    def array(self, name: str) -> np.ndarray:
        """Return one variable over all cells."""
        return self._arrays[name].copy()

    def items(self) -> Iterable[tuple[str, np.ndarray]]:
        """Return the variables by name."""
        return self._arrays.items()


def memory_file(source: Any) -> SpectraFile | None:
    """Return an open file, or a spectrum in memory as a file of it; None for another
    thing.
    """
    if isinstance(source, SpectraFile):
        return source
    return (
        cast(SpectraFile, _InMemory(source)) if isinstance(source, Spectrum) else None
    )


def memory_plan(several: Sequence[Any]) -> Plan | None:
    """Return what draws records, verdicts or checks by a code; None for other results,
    which have rows.
    """

    def are(*kinds: type) -> bool:
        return all(isinstance(one, kinds) for one in several)

    if are(Record, Recording):
        records = [
            replace(one.record, acceleration=one.factor * one.record.acceleration)
            if isinstance(one, Recording)
            else one
            for one in several
        ]
        return lambda figure, units, alone: traces(figure, records, units, alone)
    if are(Verdict):
        return lambda figure, units, _: capacities(figure, several, units)
    if are(CodeCheck):
        return lambda figure, _, __: capacity_curves(figure, several)
    return None


def memory_rows(several: Sequence[Any]) -> Rows:
    """Return the rows of one result, or of several of one kind. Raises ArgumentError
    for another thing.
    """
    rows = [row for one in several for row in _rows(one)]
    if not rows or not all(rows):
        raise ArgumentError(
            f"draw: `source`: found an empty {type(several).__name__}; expected"
            f" {_EXPECTED}"
        )
    return rows_in_memory(rows)


def _rows(one: Any) -> Iterator[Mapping[str, Any]]:
    """Yield the rows of one result."""
    from ...envelopes.closed_form import CurvePoint

    if isinstance(one, Mapping):
        yield one
    elif isinstance(one, TimeHistory | SlideHistory):
        yield from one.rows()
    elif isinstance(one, Fit):
        yield from one.points_of_curve()
    elif isinstance(one, Interval):
        yield {
            "Omega": one.omega,
            "A_from": one.a_from,
            "A_to": one.a_to,
            "mode": one.mode,
        }
    elif isinstance(one, CurvePoint):
        yield {"curve": one.curve, "Omega": one.omega, "A": one.amplitude}
    else:
        raise ArgumentError(
            f"draw: `source`: found a {type(one).__name__}; expected {_EXPECTED}"
        )
