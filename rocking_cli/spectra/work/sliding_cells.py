"""The cells of structures that slide and never rock.

The slides of a body depend on g/a_g alone: in the phase of the motion they are the same
at every frequency, with lengths over a_g/omega_g^2. So each amplitude is computed once.
"""

from collections.abc import Sequence

import numpy as np

from ...arrays import Array
from ...dynamics.outcome import Difference, Outcome
from ...dynamics.sliding import Base
from ...structures.friction import friction_that_slides
from ...structures.parameters import RockingParameters
from ..dimensions import QUANTITIES
from ..scene import SceneCells


def sliding_block(
    structure: RockingParameters, cells: SceneCells, quantities: Sequence[str]
) -> dict[str, Array]:
    """Return the variables of these cells, (cells,), for a structure that slides; its
    theta_ratio is 0, and NaN where contact is lost, as slide_max is. quantities: names
    of those of `QUANTITIES` that are wanted.
    """
    friction = friction_that_slides(structure)
    assert friction is not None  # the caller says so
    base = Base(cells.motion, friction)
    peaks, place = np.unique(cells.amplitude, return_inverse=True)
    a_g = np.asarray(structure.ground_acceleration(peaks), dtype=float)
    with np.errstate(divide="ignore"):
        found = [base.under(ratio) for ratio in (structure.gravity / a_g).tolist()]
    outcome = np.array([one.outcome for one in found], dtype=np.uint8)[place]
    largest = np.array([one.largest for one in found])
    length = (a_g * largest)[place] / (cells.omega * structure.p) ** 2
    lost = outcome == Outcome.LOST_CONTACT
    still = np.where(lost, np.nan, 0.0)
    every = {
        "theta_ratio": still,
        "outcome": outcome,
        "impacts_at_least": np.zeros(place.shape, dtype=np.int32),
        "velocity_ratio": still,
        "condition": np.full(place.shape, np.nan),
        "theta_ratio_linear": still,
        "outcome_linear": outcome,
        "difference": np.full(place.shape, Difference.AGREES, dtype=np.uint8),
        "slide_max": np.where(lost, np.nan, length),
    }
    left_out = {
        name
        for key in QUANTITIES.keys() - {*quantities, "condition"}
        for name in QUANTITIES[key]
    }
    return {name: every[name] for name in every.keys() - left_out}
