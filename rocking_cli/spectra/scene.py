"""A scene is all that a sweep computes: structures, motions, grid and equation. It is
cut into units of work, one chunk of the file each.

Every result has three dimensions, such as (structure, frequency, amplitude) under one
pulse; a place is an index on a dimension. Units cut the first into single places.
Spectra of records are other scenes (`record_scene`).
"""

import json
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.method import LINEAR, Method
from ..dynamics.system import System
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid
from ..structures.friction import friction_that_slides
from ..structures.parameters import RockingParameters
from .dimensions import Frame, structure_lists, varied_units

if TYPE_CHECKING:
    from .verdicts import VerdictScene

CellPlace = tuple[int, int, int]  # indices of a cell on the three dimensions


@dataclass(frozen=True)
class Unit:
    """One unit of work: a block of the last two dimensions, computed once for all
    `places` on the first.
    """

    places: tuple[int, ...]  # indices on the first dimension
    row: int  # row of its first cell
    column: int  # column of its first cell
    shape: tuple[int, int] = (1, 1)  # (rows, columns)
    wanted: tuple[CellPlace, ...] = ()  # its cells that the verification looks at

    @property
    def first(self) -> CellPlace:
        """The place of its first cell."""
        return self.places[0], self.row, self.column

    @property
    def shared(self) -> int:
        """The number of cells that take the result of another place."""
        return (len(self.places) - 1) * math.prod(self.shape)

    @property
    def rows(self) -> slice:
        """Its rows."""
        return slice(self.row, self.row + self.shape[0])

    @property
    def columns(self) -> slice:
        """Its columns."""
        return slice(self.column, self.column + self.shape[1])


class SceneCells(NamedTuple):
    """Cells of one structure under one motion."""

    structure: RockingParameters  # the one that is computed
    motion: Motion  # the ground motion
    amplitude: Array  # A [-], (cells,)
    omega: Array  # Omega [-], (cells,)
    # the structures at all places of a unit; they have the rotations of `structure`,
    # which are computed once
    sharers: tuple[RockingParameters, ...] = ()


class Scene(ABC):
    """The structures, motions and method of a sweep, on a grid of three dimensions: the
    interface of every kind of scene.
    """

    # in the order of the document or of the dimension
    structures: tuple[RockingParameters, ...]
    method: Method  # equation of motion and its tolerance
    of_records = False

    @property
    @abstractmethod
    def shape(self) -> tuple[int, int, int]:
        """The number of places on each of the three dimensions."""

    @property
    @abstractmethod
    def segments(self) -> int:
        """The number of segments of the motion; of several motions
        the largest number.
        """

    @property
    @abstractmethod
    def title(self) -> str:
        """The motion in a few words."""

    @abstractmethod
    def stated(self) -> dict[str, Any]:
        """Return the input of the scene by name, without its method."""

    @abstractmethod
    def sharing(self) -> list[tuple[int, ...]]:
        """Groups of places of the first dimension that are computed together, once."""

    @abstractmethod
    def cells_of(self, unit: Unit) -> Iterator[SceneCells]:
        """Yield the cells of a unit, row by row, those of each structure together."""

    @abstractmethod
    def frame(self) -> Frame:
        """Return the values at all places, as a spectra file has them."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """The names of QUANTITIES that the result always has: slide if a structure
        slides and never rocks.
        """
        slides = any(friction_that_slides(s) is not None for s in self.structures)
        return ("slide",) * slides

    def cell(self, place: int, row: int, column: int) -> SceneCells:
        """Return the cell at these indices on the three dimensions."""
        return next(self.cells_of(Unit((place,), row, column)))

    def identity(self) -> dict[str, Any]:
        """Return the input of the result by name, as JSON values; two scenes of equal
        identity have equal spectra.
        """
        from .work.machine import version

        stated = {
            "version": version(),
            **self.stated(),
            "model": self.method.model,
            "tolerance": self.method.stated_tolerance,
        }
        return dict(json.loads(json.dumps(stated)))

    def only(self, units: Sequence[Unit]) -> "Scene":
        """Return the scene with only the data that these units need."""
        return self

    @property
    def cells(self) -> int:
        """Cells of the result."""
        return math.prod(self.shape)

    @property
    @abstractmethod
    def weighed(self) -> bool:
        """True if the ground also moves vertically, so that the weight varies."""

    @property
    def mixed(self) -> bool:
        """True if one run computes the cells of bodies that differ in their numbers."""
        return not self.weighed

    def system_of(self, structure: RockingParameters) -> System:
        """Return the system that is marched. That of the linear oscillator has no body,
        whose forces are computed afterwards, so that bodies may share its rotations.
        """
        system = self.method.system_of(structure)
        if not self.method.exact:
            return system
        return system._replace(body=None, scale=system.scale if self.weighed else None)


@dataclass(frozen=True, eq=False)
class PulseScene(Scene):
    """Structures over a grid of amplitude and frequency, under one motion. Structures
    of equal restitution share one dimensionless linear spectrum, which is computed once
    (section 3.3 of the paper). Raises UsageError when a structure has no units but the
    grid does, or the scene holds no structure.
    """

    structures: tuple[RockingParameters, ...]  # the first dimension
    grid: Grid  # frequencies and amplitudes, the second and the third dimension
    motion: Motion  # the one motion of all cells
    method: Method = LINEAR  # equation of motion and its tolerance

    def __post_init__(self) -> None:
        if not self.structures:
            raise UsageError(
                "no structure: give a structure document, or a restitution for a"
                " dimensionless grid"
            )
        for s in self.structures:
            if s.dimensionless and not self.grid.dimensionless:
                raise UsageError(
                    "a restitution alone has no units: give a structure document, or"
                    " axes A and Omega"
                )
            if s.dimensionless and self.weighed:
                raise UsageError(
                    "a restitution alone has no weight that a vertical motion could"
                    " change: give a structure document"
                )
            self.method.system_of(s)
            with np.errstate(all="ignore"):
                require_finite(s, *self.grid.scaled(s))

    @property
    def shape(self) -> tuple[int, int, int]:
        """(structures, frequencies, amplitudes)."""
        return (len(self.structures), *self.grid.shape)

    @property
    def weighed(self) -> bool:
        return self.motion.vertical is not None

    @property
    def segments(self) -> int:
        return len(self.motion.segments)

    @property
    def title(self) -> str:
        return self.motion.name

    def cells_of(self, unit: Unit) -> Iterator[SceneCells]:
        sharers = tuple(self.structures[i] for i in unit.places)
        amplitude, omega = self.grid.scaled(sharers[0])
        yield SceneCells(
            sharers[0],
            self.motion,
            np.tile(amplitude[unit.columns], unit.shape[0]),
            np.repeat(omega[unit.rows], unit.shape[1]),
            sharers,
        )

    def frame(self) -> Frame:
        axes = {
            axis.name: axis.values
            for axis in (self.grid.frequency, self.grid.amplitude)
        }
        names = [s.name for s in self.structures]
        return Frame(
            {"structure": names, **axes},
            structure_lists(self.structures),
            varied_units(self.structures),
        )

    def stated(self) -> dict[str, Any]:
        return {
            "structures": [s.row() for s in self.structures],
            **{
                f"axis {axis.name}": axis.stated()
                for axis in (self.grid.frequency, self.grid.amplitude)
            },
            **stated_motion(self.motion),
        }

    def sharing(self) -> list[tuple[int, ...]]:
        if not self.grid.dimensionless:
            return [(i,) for i in range(len(self.structures))]
        groups: dict[tuple[Any, ...], list[int]] = {}
        for i, s in enumerate(self.structures):
            slides = friction_that_slides(s)
            own = None if slides is None else (slides, s.uplift)
            groups.setdefault((self.system_of(s).key(), own), []).append(i)
        return [tuple(g) for g in groups.values()]


def stated_motion(motion: Motion) -> dict[str, Any]:
    """Return what a result depends on of a pulse, with its vertical motion."""
    found: dict[str, Any] = {"motion": [motion.name, list(map(asdict, motion.pieces))]}
    if motion.vertical is not None:
        found["vertical"] = list(map(asdict, motion.vertical.pieces))
    return found


def require_finite(
    structure: RockingParameters, amplitude: Array, omega: Array
) -> None:
    """Raise UsageError unless all A and Omega of a structure are finite numbers."""
    every = np.append(amplitude, omega)
    if not (np.isfinite(every).all() and np.all(omega > 0.0)):
        raise UsageError(
            f"{structure.name}: the grid in units of this structure (A, Omega) leaves"
            " the range of double precision"
        )


def cut_into_units(
    scene: "Scene | VerdictScene", chunk: tuple[int, int]
) -> Iterator[Unit]:
    """Yield the units of work of a scene, row by row; chunk: (rows, columns)
    of a unit.
    """
    _, rows, columns = scene.shape
    for group in scene.sharing():
        for row in range(0, rows, chunk[0]):
            for column in range(0, columns, chunk[1]):
                shape = min(chunk[0], rows - row), min(chunk[1], columns - column)
                yield Unit(group, row, column, shape)
