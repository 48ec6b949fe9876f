"""What a sweep computes, and how it is cut into units of work. A unit is one chunk of the file."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from ..dynamics.equations.equation import Model
from ..dynamics.equations.linear import LinearModel
from ..dynamics.equations.mechanism import MechanismModel
from ..dynamics.equations.rigid_body import RigidModel
from ..dynamics.equations.taylor import order_for
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .grid import Grid

if TYPE_CHECKING:
    from ..dynamics.references.general_solver import Equation

_SEED = 20120924
MODELS = ("linear", "nonlinear")
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Method:
    """The equation of motion, and for the nonlinear one the error of theta/alpha that is aimed at. Raises UsageError."""

    model: str = "linear"
    tolerance: float = TOLERANCE

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UsageError(f"unknown model {self.model!r}, accepted are {', '.join(MODELS)}")
        try:
            order_for(self.tolerance)
        except ValueError as error:
            raise UsageError(str(error)) from None

    def model_of(self, structure: RockingParameters) -> Model:
        """The equation of motion of one structure. Raises UsageError when the model does not hold for it."""
        if self.model == "linear":
            return LinearModel()
        if structure.structure == "dimensionless":
            raise UsageError("the nonlinear model needs a critical angle: give a structure document")
        try:
            if structure.mechanism is not None:
                return MechanismModel(structure.mechanism, self.tolerance)
            if structure.a_scale == 1.0:
                return RigidModel(structure.alpha, self.tolerance)
        except ValueError as error:
            raise UsageError(f"{structure.name}: {error}") from None
        raise UsageError(
            f"{structure.name}: the nonlinear model needs the structure itself (an arch) or a rigid body, whose a_scale is 1; "
            f"found parameters with a_scale {structure.a_scale:.6g}"
        )

    def reference_of(self, structure: RockingParameters) -> Callable[[Motion, float, float, float], tuple[Outcome, float]]:
        """The slower, independent path to (outcome, theta_ratio) of a single cell (motion, A, Omega, eta)."""
        if self.model == "linear":
            from ..dynamics.references.taylor_series import reference_cell

            return reference_cell
        from ..dynamics.references.general_solver import reference_nonlinear

        return partial(reference_nonlinear, equation=self.equation_of(structure))

    def equation_of(self, structure: RockingParameters) -> Equation:
        """The equation of motion of one structure as general solvers take it."""
        from ..dynamics.references.general_solver import Linkage, Oscillator, RigidBody

        if self.model == "linear":
            return Oscillator()
        return RigidBody(structure.alpha) if structure.mechanism is None else Linkage(structure.mechanism)


LINEAR = Method()


@dataclass(frozen=True, eq=False)
class Scene:
    """What a sweep computes: structures, grid, motion, and the equation of motion.

    Structures of equal restitution share one dimensionless linear spectrum, which is computed once (section 3.3 of the paper).
    Raises UsageError when a structure has no units but the grid does, or the scene holds no structure.
    """

    structures: tuple[RockingParameters, ...]
    grid: Grid
    motion: Motion
    method: Method = LINEAR

    def __post_init__(self) -> None:
        if not self.structures:
            raise UsageError("no structure: give a structure document, or a restitution for a dimensionless grid")
        for s in self.structures:
            if s.structure == "dimensionless" and not self.grid.dimensionless:
                raise UsageError("a restitution alone has no units: give a structure document, or axes A and Omega")
            self.method.model_of(s)
            with np.errstate(all="ignore"):
                amplitude, omega = self.grid.scaled(s)
            if not (np.all(np.isfinite(amplitude)) and np.all(np.isfinite(omega)) and np.all(omega > 0.0)):
                raise UsageError(f"{s.name}: the grid in units of this structure (A, Omega) leaves the range of double precision")

    @property
    def cells(self) -> int:
        """Cells of the result."""
        return len(self.structures) * self.grid.shape[0] * self.grid.shape[1]

    def identity(self) -> dict[str, Any]:
        """What the result depends on, by name, as JSON values; two scenes of equal identity have equal spectra."""
        return {
            "version": __version__,
            "structures": [json.loads(json.dumps(s.record())) for s in self.structures],
            **{f"axis {axis.name}": axis.stated() for axis in (self.grid.frequency, self.grid.amplitude)},
            "motion": [self.motion.name, [json.loads(json.dumps(asdict(piece))) for piece in self.motion.pieces]],
            "model": self.method.model,
            "tolerance": self.method.tolerance if self.method.model != "linear" else None,
        }

    def sharing(self) -> list[tuple[int, ...]]:
        """Structures, by index, that share one computation."""
        if not self.grid.dimensionless:
            return [(i,) for i in range(len(self.structures))]
        groups: dict[tuple[Any, ...], list[int]] = {}
        for i, s in enumerate(self.structures):
            groups.setdefault((s.eta, *(() if self.method.model == "linear" else (s.alpha, s.mechanism))), []).append(i)
        return [tuple(g) for g in groups.values()]


@dataclass(frozen=True)
class Unit:
    """One unit of work: the structures it serves and its block of the grid."""

    structures: tuple[int, ...]
    row: int
    column: int


def chunk_shape(shape: tuple[int, int], cells: int) -> tuple[int, int]:
    """(rows, columns) of a unit of work of about `cells` cells: whole rows where they fit. Raises UsageError if cells < 1."""
    if cells < 1:
        raise UsageError(f"a unit of work has at least one cell, found {cells}")
    columns = min(shape[1], cells)
    return min(shape[0], max(1, cells // columns)), columns


def cut_into_units(scene: Scene, chunk: tuple[int, int]) -> Iterator[Unit]:
    rows, columns = scene.grid.shape
    for group in scene.sharing():
        for row in range(0, rows, chunk[0]):
            for column in range(0, columns, chunk[1]):
                yield Unit(group, row, column)


def default_check(scene: Scene) -> int:
    """Cells to compute again where the user does not say: so few that large sweeps spend under 3 % of their time on them."""
    return 4 if scene.method.model != "linear" else max(4, min(64, scene.cells // 250_000))


def sampled_cells(scene: Scene, check: int, seed: int = _SEED) -> np.ndarray:
    """(structure, row, column) of the cells to check: drawn without regard to units, among the cells that uplift."""
    if check < 1:
        return np.zeros((0, 3), dtype=np.int64)
    random = np.random.default_rng(seed)
    rows, columns = scene.grid.shape
    found: list[tuple[int, int, int]] = []
    owners = [group[0] for group in scene.sharing()]
    models = [scene.method.model_of(s) for s in scene.structures]
    for _ in range(20 * check):
        i, r, c = owners[int(random.integers(len(owners)))], int(random.integers(rows)), int(random.integers(columns))
        amplitude = scene.grid.scaled(scene.structures[i])[0][c]
        if amplitude * scene.motion.peak > models[i].initiation and (i, r, c) not in found:
            found.append((i, r, c))
        if len(found) == check:
            break
    return np.array(found, dtype=np.int64).reshape(-1, 3)
