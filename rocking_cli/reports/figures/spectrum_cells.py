"""A spectrum in memory, in the form of a spectra file that the figures take."""

from collections.abc import Iterable
from typing import cast

import numpy as np

from ...motions.grid import Grid
from ...motions.motion import Motion
from ...spectra.file.reader import SpectraFile
from ...spectra.results import Spectrum
from ...spectra.scene import PulseScene


class _Cells:
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


def cells_of(found: Spectrum) -> SpectraFile:
    """Return a spectrum in memory as a file of it."""
    return cast(SpectraFile, _Cells(found))
