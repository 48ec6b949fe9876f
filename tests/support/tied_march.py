"""The march of tied bodies, called as tests call it."""

from typing import Any

import numpy as np

from rocking_cli import Motion, System
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.tied.tied_lanes import Found
from rocking_cli.dynamics.tied.tied_march import TiedMarch


def marched(system: System, motion: Motion, *cells: np.ndarray, **more: Any) -> Found:
    """The results of the march of cells (A, Omega, eta)."""
    batch = Batch.of(system, system.segments(motion), *cells)
    return TiedMarch(system.devices, batch, **more).run()
