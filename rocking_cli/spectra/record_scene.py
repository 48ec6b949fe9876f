"""Scenes of records: structures times records times scales, or rocking spectra over the critical angle and 2 pi/p.

The dimensions are (record, structure, scale | A | a_g) or (record, alpha, T). A record runs in its own time, so that Omega = 1/p
with its phase in s, and in its own amplitude times the scale; on an axis A or a_g it is scaled to that peak.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import __version__
from ..dynamics.method import LINEAR, Method
from ..errors import UsageError
from ..motions.recording import Recording
from ..structures.parameters import RockingParameters
from .frame import Frame, beside_records, beside_structures
from .grid import MAX_CELLS, Axis
from .scene import Array, Band, Cell, Scene, Unit

COLUMNS = ("scale", "A", "a_g", "T")
AS_RECORDED = Axis("scale", np.array([1.0]))


def block_of(alpha: float, eta: float | None) -> RockingParameters:
    """A rigid block of critical angle alpha [rad] whatever its size (p = 1 rad/s); eta: None for 1 - 3/2 sin^2 alpha.

    Raises StructureError for a restitution out of range, which that of a block wider than high by 1.41 is.
    """
    if eta is None:
        eta, source = 1.0 - 1.5 * math.sin(alpha) ** 2, "momentum"
    else:
        source = "given"
    return RockingParameters(f"alpha={alpha:.6g}", "block", 1.0, alpha, eta, alpha, 1.0, source)


@dataclass(frozen=True, eq=False)
class RecordScene(Scene):
    """Structures under records.

    columns: the third dimension, one of `COLUMNS`; with T [s] the structures are blocks of one size each, whose p is 2 pi/T
    instead, and the second dimension is their alpha. Raises UsageError when there is no structure or record, one has no units or the
    model does not hold for it, or there are too many cells.
    """

    structures: tuple[RockingParameters, ...]
    recordings: tuple[Recording, ...]
    columns: Axis = AS_RECORDED
    method: Method = LINEAR
    of_records = True

    def __post_init__(self) -> None:
        if self.columns.name not in COLUMNS:
            raise UsageError(f"axis {self.columns.name}: accepted under records are {', '.join(COLUMNS)}")
        if not self.recordings:
            raise UsageError("no record")
        if not self.structures:
            raise UsageError("no structure: give a structure document, or the critical angles as --alpha")
        for s in self.structures:
            if s.dimensionless:
                raise UsageError("a restitution alone has no units: give a structure document, or the critical angles as --alpha")
            self.method.system_of(s)
            amplitude, omega = self._scaled(s, max(r.acceleration for r in self.recordings))
            if not (np.all(np.isfinite(amplitude)) and np.all(np.isfinite(omega)) and np.all(omega > 0.0)):
                raise UsageError(f"{s.name}: the scales in units of this structure (A, Omega) leave the range of double precision")
        if self.cells > MAX_CELLS:
            raise UsageError(f"{self.cells:.3g} cells, accepted are up to {MAX_CELLS:.0e} in one file")

    @property
    def over_angles(self) -> bool:
        """Whether the dimensions are record, alpha and T."""
        return self.columns.name == "T"

    @property
    def shape(self) -> tuple[int, int, int]:
        """(records, structures or alphas, columns)."""
        return len(self.recordings), len(self.structures), self.columns.values.size

    @property
    def segments(self) -> int:
        """Intervals of the longest record."""
        return max(r.record.npts for r in self.recordings) - 1

    @property
    def title(self) -> str:
        """The record, or how many there are."""
        return self.recordings[0].label if len(self.recordings) == 1 else f"{len(self.recordings)} records"

    def _scaled(self, structure: RockingParameters, acceleration: float) -> tuple[Array, Array]:
        """(A, Omega) of the columns for one structure under a record of this peak [m/s2], broadcast against each other."""
        values, name = self.columns.values, self.columns.name
        with np.errstate(all="ignore"):
            if name == "T":
                return np.array([structure.dimensionless_amplitude(acceleration)]), values / (2.0 * np.pi)
            peak = values * acceleration if name == "scale" else values
            return peak if name == "A" else structure.dimensionless_amplitude(peak), np.array([1.0 / structure.p])

    def sharing(self) -> list[tuple[int, ...]]:
        """Every record by itself."""
        return [(i,) for i in range(len(self.recordings))]

    def bands(self, unit: Unit, size: tuple[int, int]) -> Iterator[Band]:
        """A band for each structure."""
        recording = self.recordings[unit.places[0]]
        motion, columns = recording.motion, slice(unit.column, unit.column + size[1])
        for structure in self.structures[unit.row : unit.row + size[0]]:
            amplitude, omega = np.broadcast_arrays(*self._scaled(structure, recording.acceleration))
            yield Band(structure, motion, 1, amplitude[columns], omega[columns])

    def cell(self, place: int, row: int, column: int) -> Cell:
        """One cell."""
        recording, structure = self.recordings[place], self.structures[row]
        amplitude, omega = np.broadcast_arrays(*self._scaled(structure, recording.acceleration))
        return Cell(structure, recording.motion, float(amplitude[column]), float(omega[column]))

    def batches(self, units: int) -> int:
        """Runs of the engine that so many units of work take: one for each system in each."""
        return units * len({self.method.shares(s) for s in self.structures})

    def identity(self) -> dict[str, Any]:
        """What the result depends on, by name, as JSON values; two scenes of equal identity have equal spectra."""
        if self.over_angles:
            alphas = Axis("alpha", np.array([s.alpha for s in self.structures]))
            rows: dict[str, Any] = {"axis alpha": alphas.stated(), "eta": [s.eta for s in self.structures]}
        else:
            rows = {"structures": [json.loads(json.dumps(s.record())) for s in self.structures]}
        return {
            "version": __version__,
            "records": [r.identity() for r in self.recordings],
            **rows,
            f"axis {self.columns.name}": self.columns.stated(),
            "model": self.method.model,
            "tolerance": self.method.stated_tolerance,
        }

    def frame(self) -> Frame:
        """What the cells lie on."""
        records, columns = [r.label for r in self.recordings], {self.columns.name: self.columns.values}
        beside = beside_records(self.recordings)
        if not self.over_angles:
            names = [s.name for s in self.structures]
            return Frame({"record": records, "structure": names, **columns}, {**beside_structures(self.structures), **beside})
        alpha, eta = (np.array([getattr(s, key) for s in self.structures]) for key in ("alpha", "eta"))
        sizes = 2.0 * np.pi / self.columns.values
        angles = {"eta": ("alpha", eta), "tan_alpha": ("alpha", np.tan(alpha)), "p": ("T", sizes)}
        return Frame({"record": records, "alpha": alpha, **columns}, {**angles, **beside})


def structures_scene(
    structures: Sequence[RockingParameters], recordings: Sequence[Recording], columns: Axis = AS_RECORDED, method: Method = LINEAR
) -> RecordScene:
    """Structures under records at the values of an axis `scale`, `A` or `a_g`. Raises UsageError."""
    if columns.name == "T":
        raise UsageError("axis T: structures have a size of their own; accepted are scale, A and a_g")
    return RecordScene(tuple(structures), tuple(recordings), columns, method)


def angles_scene(
    alphas: Axis, periods: Axis, recordings: Sequence[Recording], eta: float | None = None, method: Method = LINEAR
) -> RecordScene:
    """Rigid blocks over alpha and T = 2 pi/p under records; eta: None for that of a block. Raises UsageError, StructureError."""
    return RecordScene(tuple(block_of(a, eta) for a in alphas.values.tolist()), tuple(recordings), periods, method)
