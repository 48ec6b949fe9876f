"""Forces over a weight, as rows and extremes of a history take them."""

from typing import NamedTuple

import numpy as np

from ...arrays import Array


class Measured(NamedTuple):
    """Forces at instants, over a weight."""

    columns: dict[str, Array]  # by column, (n,)
    # by quantity, the larger the worse (thrust_min is -N), (n, places)
    measures: dict[str, Array]


def ratio_of(shear: Array, thrust: Array) -> Array:
    """Return |T|/N, infinite without compression."""
    with np.errstate(all="ignore"):
        return np.where(thrust > 0.0, shear / thrust, np.inf)
