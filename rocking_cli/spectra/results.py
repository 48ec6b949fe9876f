"""The results of a sweep: arrays in memory and a summary."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from ..dynamics.method import LINEAR
from ..dynamics.outcome import Outcome, Work
from ..plugins import require
from ..showing import Shown
from .dimensions import VARIABLES
from .scene import Scene
from .verification import Validity

if TYPE_CHECKING:
    import xarray


_RECORDED = (
    "structures",
    "records",
    "cells",
    "model",
    "run_time",
    "time_per_cell",
    "workers",
    "error_bound",
    "error_bound_median",
    "cells_above_ten_medians",
    "largest_difference",
    "checked_by",
    "checked_cells",
    "sensitive_cells",
    "check_time",
)


@dataclass(frozen=True, repr=False)
class Summary(Shown):
    """Counts, times and checks of a sweep, as `write_spectrum` returns it.

    Of a resumed sweep the times, checks and counters are those of the last run only;
    the error bound is that of all cells.
    `error_bound`, `largest_difference` and `misjudged` say how far to trust the
    results, `row` is what `rocking spectrum --json` prints.

    Attributes
    ----------
    run_time: [s]
    outcomes: number of cells by the name of the outcome
    work: counters of the march
    shared_cells: cells taken from another structure of equal restitution
    checked_by: the reference that computed cells again
    sensitive_cells: checked cells that were chosen for their sensitivity
    largest_difference: of theta/alpha from the reference on the checked cells [-]
    error_bound: of theta/alpha, the tolerance times the largest condition of the cells
        that stand, 1 at most [-]
    error_bound_median: the tolerance times the median of these conditions [-]
    cells_above_ten_medians: cells whose bound is above ten times that median
    check_time: part of the run time that the checks took [s]
    misjudged: checked cells whose outcome differs
    resumed_cells: cells from an earlier run
    machine_differences: what its machine does differently
    records: number of records, 0 for a pulse
    compared: checked cells of a linear sweep of records that were also computed by the
        nonlinear equation
    differing: those of `compared` that differ in overturning
    differences: number of cells by the name of the `Difference`, if both equations were
        computed
    validity: of a linear sweep, if requested
    weighed: True if the ground also moved vertically
    beyond_tolerance: checked cells where theta/alpha differs by more than the tolerance
        times the condition

    Examples
    --------
    >>> grid = parse_grid("A=1:3:3,Omega=2:4:2")
    >>> found = spectrum([dimensionless_oscillator(eta=0.9)], sine(), grid, workers=1)
    >>> found.summary.cells, found.summary.misjudged
    (6, 0)
    """

    structures: int  # number of structures
    cells: int  # number of cells
    run_time: float  # [s]
    workers: int  # number of processes
    outcomes: dict[str, int]  # number of cells by the name of the outcome
    work: Work  # counters of the march
    shared_cells: int  # cells taken from another structure of equal restitution
    checked_by: str  # the reference that computed cells again
    checked_cells: int  # cells that were computed again by the reference
    sensitive_cells: int  # checked cells that were chosen for their sensitivity
    # largest difference of theta/alpha from the reference on the checked cells [-]
    largest_difference: float
    # tolerance times the largest condition of the cells that stand, 1 at most [-]
    error_bound: float
    error_bound_median: float  # tolerance times the median of these conditions [-]
    # cells whose bound is above ten times that median
    cells_above_ten_medians: int
    check_time: float  # part of the run time that the checks took [s]
    misjudged: int  # checked cells whose outcome differs
    resumed_cells: int = 0  # cells from an earlier run
    machine_differences: str = ""  # what its machine does differently
    model: str = LINEAR.model  # the equation of motion
    records: int = 0  # number of records, 0 for a pulse
    # checked cells of a linear sweep of records that were also computed by the
    # nonlinear equation
    compared: int = 0
    differing: int = 0  # those of `compared` that differ in overturning
    # number of cells by the name of the `Difference`, if both equations were computed
    differences: Mapping[str, int] = field(default_factory=dict)
    validity: Validity | None = None  # of a linear sweep, if requested
    weighed: bool = False  # True if the ground also moved vertically
    # checked cells where theta/alpha differs by more than the tolerance times the
    # condition
    beyond_tolerance: int = 0

    @property
    def time_per_cell(self) -> float:
        """Run time over the cells of this run [s], without cells of other shards."""
        return self.run_time / max(
            1,
            self.cells - self.resumed_cells - self.outcomes[Outcome.NOT_COMPUTED.flag],
        )

    @property
    def failed(self) -> int:
        """Cells that could not be decided."""
        return self.outcomes[Outcome.FAILED.flag]

    def _shown(self) -> dict[str, Any]:
        first = (
            "structures",
            "cells",
            "run_time",
            "workers",
            "model",
            "error_bound",
            "largest_difference",
            "checked_by",
            "checked_cells",
            "misjudged",
        )
        counts = {f"cells_{key}": n for key, n in self.outcomes.items() if n}
        return {name: getattr(self, name) for name in first} | counts

    def _rows(self) -> list[dict[str, Any]]:
        return [self.row()]

    def row(self) -> dict[str, Any]:
        """Return the fields as one flat mapping, for JSON and for the file's
        attributes.
        """
        compared = {"compared_cells": self.compared, "differing_cells": self.differing}
        work = {key: n for key, n in asdict(self.work).items() if key != "cells"}
        return {
            **{
                name: getattr(self, name)
                for name in _RECORDED
                if name != "records" or self.records
            },
            "misjudged_cells": self.misjudged,
            "beyond_tolerance": self.beyond_tolerance,
            **(compared if self.compared else {}),
            **{f"cells_{k}": v for k, v in self.outcomes.items()},
            **(
                {}
                if self.validity is None
                else {f"nonlinear_{k}": v for k, v in asdict(self.validity).items()}
            ),
            **{
                f"cells_{k}": v
                for k, v in self.differences.items()
                if k.startswith("linear")
            },
            "shared_cells": self.shared_cells,
            "resumed_cells": self.resumed_cells,
            **(
                {"machine_differences": self.machine_differences}
                if self.machine_differences
                else {}
            ),
            **work,
        }


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(Shown):
    """A rocking spectrum in memory, as `spectrum` returns it.

    All arrays have the dimensions of the scene, such as (structure, frequency,
    amplitude) or (record, structure, scale). `to_xarray` returns an xarray Dataset with
    labelled axes; the axes themselves are in `scene.grid`.

    Attributes
    ----------
    scene: structures, motions and grid
    theta_ratio: max |theta|/alpha [-]
    outcome: codes of `Outcome`
    impacts_at_least: number of impacts that were computed
    summary: counts, times and checks of the sweep
    quantities: the requested variables of `QUANTITIES` by name

    Examples
    --------
    >>> grid = parse_grid("A=1:3:3,Omega=2:4:2")
    >>> found = spectrum([dimensionless_oscillator(eta=0.9)], sine(), grid, workers=1)
    >>> [Outcome(int(code)).flag for code in found.outcome[0, 1]]
    ['no_uplift', 'overturned_after_impact', 'overturned_after_impact']
    >>> found.scene.grid.amplitude.values.tolist()
    [1.0, 2.0, 3.0]
    """

    scene: Scene  # structures, motions and grid
    theta_ratio: np.ndarray  # max |theta|/alpha [-]
    outcome: np.ndarray  # codes of `Outcome`
    impacts_at_least: np.ndarray  # number of impacts that were computed
    summary: Summary  # counts, times and checks of the sweep
    # the requested variables of `QUANTITIES` by name
    quantities: Mapping[str, np.ndarray] = field(default_factory=dict)

    def _shown(self) -> dict[str, Any]:
        frame, row = self.scene.frame(), {"motion": self.scene.title}
        for name, values in frame.dimensions.items():
            first, last = values[0], values[-1]
            ends = (
                f"{first}"
                if len(values) == 1
                else f"{first} to {last}"
                if isinstance(first, str)
                else f"{first:.4g} to {last:.4g}"
            )
            row[name] = f"{len(values)}: {ends}"
        row["model"] = self.scene.method.model
        codes, counts = np.unique(self.outcome, return_counts=True)
        for code, number in zip(codes.tolist(), counts.tolist(), strict=True):
            row[f"cells_{Outcome(code).flag}"] = str(number)
        return row

    @property
    def _variables(self) -> dict[str, np.ndarray]:
        """All variables by name."""
        return {
            "theta_ratio": self.theta_ratio,
            "outcome": self.outcome,
            "impacts_at_least": self.impacts_at_least,
            **self.quantities,
        }

    def _rows(self) -> Iterator[dict[str, Any]]:
        dimensions = self.scene.frame().dimensions
        columns = {name: cells.ravel() for name, cells in self._variables.items()}
        for number, place in enumerate(product(*dimensions.values())):
            cell = {name: values[number].item() for name, values in columns.items()}
            cell["outcome"] = Outcome(cell["outcome"]).flag
            yield dict(zip(dimensions, place, strict=True)) | cell

    @property
    def velocity_ratio(self) -> np.ndarray | None:
        """max |d theta/dt|/p [rad], in spectra of records over alpha and T and on
        request, otherwise None.
        """
        return self.quantities.get("velocity_ratio")

    @property
    def condition(self) -> np.ndarray | None:
        """The condition of each cell, None unless requested."""
        return self.quantities.get("condition")

    def to_xarray(self) -> "xarray.Dataset":
        """Return an xarray Dataset with the names, dimensions and attributes of the
        file. Raises OutputError without xarray.
        """
        require("to_xarray needs", "xarray")
        import xarray as xr

        frame = self.scene.frame()
        along = {
            name: xr.Variable(
                dimension,
                values,
                {"units": about.units, "long_name": about.long_name},
            )
            for name, (dimension, values) in frame.lists.items()
            for about in [frame.about(name)]
        }
        data = {
            name: xr.Variable(
                tuple(frame.dimensions),
                values,
                {
                    k: v
                    for k, v in VARIABLES[name].attributes.items()
                    if k != "_FillValue"
                },
            )
            for name, values in self._variables.items()
        }
        found = xr.Dataset({**data, **along})
        return found.set_coords(list(along)) if frame.of_records else found
