"""Scenes of records: structures times records times scales, or rocking spectra over the
critical angle and 2 pi/p.

The dimensions are (record, structure, scale | A | a_g) or (record, alpha, T). A record
runs in its own time, so that Omega = 1/p with its phase in s, and in its own amplitude
times the scale; on an axis A or a_g it is scaled to that peak.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import LINEAR, TOLERANCE, Method, governing_method
from ..errors import StructureError, UsageError
from ..motions.grid import MAX_CELLS, Axis, parse_angles, parse_axes, written_axes
from ..motions.recording import Recording
from ..structures.parameters import RockingParameters
from .dimensions import RECORDED, Frame, lists_of, structure_lists, varied_units
from .scene import Scene, SceneCells, Unit, require_finite

COLUMNS = ("scale", "A", "a_g", "T")
AS_RECORDED = Axis("scale", np.array([1.0]))


def block_of(alpha: float, eta: float | None) -> RockingParameters:
    """Return a rigid block of critical angle alpha [rad] without a size; eta: None for
    1 - 3/2 sin^2 alpha. Its p is 1 rad/s; its forces over its weight hold for every
    size (p^2 = 3g/(4R)). Raises StructureError for a restitution out of range, such as
    that of a block wider than 1.41 times its height.
    """
    own, arm = 1.0 - 1.5 * math.sin(alpha) ** 2, 0.75 * DEFAULT_GRAVITY
    return RockingParameters(
        name=f"alpha={alpha:.6g}",
        structure="block",
        p=1.0,
        alpha=alpha,
        eta=own if eta is None else eta,
        uplift=math.tan(alpha),
        a_scale=1.0,
        eta_source="momentum" if eta is None else "given",
        arm=arm,
    )


@dataclass(frozen=True, eq=False)
class RecordScene(Scene):
    """Structures under records. With columns of T the structures are blocks of one size
    each, whose p is 2 pi/T instead, and the second dimension is their alpha. Raises
    UsageError when there is no structure or record, one has no units or the model does
    not hold for it, or there are too many cells.
    """

    structures: tuple[RockingParameters, ...]  # the second dimension
    recordings: tuple[Recording, ...]  # the first dimension
    columns: Axis = AS_RECORDED  # the third dimension, one of `COLUMNS`
    method: Method = LINEAR  # equation of motion and its tolerance
    of_records = True

    def __post_init__(self) -> None:
        if self.columns.name not in COLUMNS:
            raise UsageError(
                f"axis {self.columns.name}: expected under records:"
                f" {', '.join(COLUMNS)}"
            )
        if not self.recordings:
            raise UsageError("no record")
        if not self.structures:
            raise UsageError(
                "no structure, and a restitution alone has no units: give a structure"
                " document, or critical angles as `alpha`"
            )
        for s in self.structures:
            if s.dimensionless:
                raise UsageError(
                    "a restitution alone has no units: give a structure document, or"
                    " critical angles as `alpha`"
                )
            self.method.system_of(s)
            strongest = max(r.acceleration for r in self.recordings)
            require_finite(s, *self._scaled(s, strongest))
        if self.cells > MAX_CELLS:
            raise UsageError(
                f"found {self.cells:.3g} cells; expected up to {MAX_CELLS:.0e} in one"
                " file"
            )

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that the scene always has: velocity_ratio for a rocking
        spectrum over alpha and T, slide if a structure slides and never rocks.
        """
        return ("velocity_ratio",) if self.over_angles else super().quantities

    @property
    def over_angles(self) -> bool:
        """True if the dimensions are record, alpha and T."""
        return self.columns.name == "T"

    @property
    def mixed(self) -> bool:
        return self.over_angles and super().mixed

    @property
    def weighed(self) -> bool:
        return any(r.upwards is not None for r in self.recordings)

    @property
    def shape(self) -> tuple[int, int, int]:
        """(records, structures or alphas, columns)."""
        return len(self.recordings), len(self.structures), self.columns.values.size

    @property
    def segments(self) -> int:
        return max(
            r.record.npts - 1 if r.building is None else len(r.motion.segments)
            for r in self.recordings
        )

    @property
    def title(self) -> str:
        return (
            self.recordings[0].label
            if len(self.recordings) == 1
            else f"{len(self.recordings)} records"
        )

    def _scaled(
        self, structure: RockingParameters, acceleration: float
    ) -> tuple[Array, Array]:
        """Return (A, Omega) of the columns for one structure under a record with this
        peak [m/s2], broadcast against each other.
        """
        values, name = self.columns.values, self.columns.name
        with np.errstate(all="ignore"):
            if name == "T":
                return np.array(
                    [structure.dimensionless_amplitude(acceleration)]
                ), values / (2.0 * np.pi)
            amplitude = values * acceleration if name == "scale" else values
            return (
                amplitude
                if name == "A"
                else structure.dimensionless_amplitude(amplitude)
            ), np.array([1.0 / structure.p])

    def sharing(self) -> list[tuple[int, ...]]:
        return [(i,) for i in range(len(self.recordings))]

    def cells_of(self, unit: Unit) -> Iterator[SceneCells]:
        recording = self.recordings[unit.places[0]]
        for structure in self.structures[unit.rows]:
            amplitude, omega = np.broadcast_arrays(
                *self._scaled(structure, recording.acceleration)
            )
            yield SceneCells(
                structure,
                recording.motion,
                amplitude[unit.columns],
                omega[unit.columns],
                (structure,),
            )

    def only(self, units: Sequence[Unit]) -> "RecordScene":
        """Return the scene with the samples of only those records that these units
        need, to send less data.
        """
        wanted = {place for unit in units for place in unit.places}
        some = self.recordings[min(wanted)]
        return replace(
            self,
            recordings=tuple(
                r if i in wanted else some for i, r in enumerate(self.recordings)
            ),
        )

    def stated(self) -> dict[str, Any]:
        if self.over_angles:
            alphas = Axis("alpha", np.array([s.alpha for s in self.structures]))
            rows: dict[str, Any] = {
                "axis alpha": alphas.stated(),
                "eta": [s.eta for s in self.structures],
            }
        else:
            rows = {"structures": [s.row() for s in self.structures]}
        return {
            "records": [r.identity() for r in self.recordings],
            **rows,
            f"axis {self.columns.name}": self.columns.stated(),
        }

    def frame(self) -> Frame:
        records = [r.label for r in self.recordings]
        columns = {self.columns.name: self.columns.values}
        extra = lists_of(RECORDED, "record", self.recordings)
        if not self.over_angles:
            names = [s.name for s in self.structures]
            of_each = {**structure_lists(self.structures), **extra}
            return Frame(
                {"record": records, "structure": names, **columns},
                of_each,
                varied_units(self.structures),
            )
        alpha, eta = (
            np.array([getattr(s, key) for s in self.structures])
            for key in ("alpha", "eta")
        )
        sizes = 2.0 * np.pi / self.columns.values
        angles = {
            "eta": ("alpha", eta),
            "tan_alpha": ("alpha", np.tan(alpha)),
            "p": ("T", sizes),
        }
        return Frame(
            {"record": records, "alpha": alpha, **columns}, {**angles, **extra}
        )


def structures_scene(
    structures: Sequence[RockingParameters],
    recordings: Sequence[Recording],
    columns: Axis = AS_RECORDED,
    method: Method = LINEAR,
) -> RecordScene:
    """Return the scene of structures under records at the values of an axis `scale`,
    `A` or `a_g`. Raises UsageError.
    """
    if columns.name == "T":
        raise UsageError(
            "found axis T (the size 2 pi/p) with structures, which have their own size;"
            " expected scale, A or a_g"
        )
    return RecordScene(tuple(structures), tuple(recordings), columns, method)


def angles_scene(
    alphas: Axis,
    periods: Axis,
    recordings: Sequence[Recording],
    eta: float | None = None,
    method: Method = LINEAR,
) -> RecordScene:
    """Return the scene of rigid blocks over alpha and T = 2 pi/p under records; eta:
    None for the value of a block. Raises UsageError.
    """

    def block(alpha: float) -> RockingParameters:
        try:
            return block_of(alpha, eta)
        except StructureError as error:
            hint = (
                "; `eta` gives it another one"
                if eta is None and str(error).startswith("eta")
                else ""
            )
            raise UsageError(f"alpha {alpha:.6g} rad: {error}{hint}") from None

    return RecordScene(
        tuple(map(block, alphas.values.tolist())), tuple(recordings), periods, method
    )


def scene_of_words(
    structures: Sequence[RockingParameters],
    recordings: Sequence[Recording],
    *,
    axes: str | None = None,
    alphas: str | None = None,
    etas: Sequence[float | None] = (),
    model: str | None = None,
    tolerance: float = TOLERANCE,
) -> RecordScene:
    """Return the scene that the texts `axes` (None: records as they are), `alphas` and
    `etas` (None: of a block) state. model, tolerance: arguments of `governing_method`.
    Raises UsageError.
    """
    found = parse_axes(axes, records=True) if axes is not None else {}
    if alphas is not None:
        if "alpha" in found:
            raise UsageError("`alpha` does not go with alpha in `grid`")
        found["alpha"] = parse_angles(alphas)
    if "alpha" in found or "T" in found:
        if structures:
            raise UsageError(
                "found alpha or T with structures, which have their own; expected"
                " scale, A or a_g, or no structures"
            )
        if set(found) != {"alpha", "T"}:
            named = [written_axes(axes or ""), "" if alphas is None else "alpha"]
            raise UsageError(
                f"found {' and '.join(filter(None, named))}; expected `alpha` and"
                " `grid` T=START:STOP:N together"
            )
        if len(etas) > 1:
            raise UsageError(
                f"`eta`: found {len(etas)} values; expected one over alpha and T"
            )
        method = governing_method(model=model, tolerance=tolerance)
        return angles_scene(
            found["alpha"], found["T"], recordings, etas[0] if etas else None, method
        )
    if len(found) > 1:
        raise UsageError(
            f"`grid`: found {written_axes(axes or '')}; expected one axis: scale, A"
            " or a_g"
        )
    columns = next(iter(found.values()), AS_RECORDED)
    return structures_scene(
        structures,
        recordings,
        columns,
        governing_method(*structures, model=model, tolerance=tolerance),
    )
