"""What devices pull: their elongations and levers, and the moment of their forces, on
floats or arrays. `devices` has the formulas.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np


class Pull(NamedTuple):
    """What devices on their branches pull. Numbers are floats or (lanes,); tuples hold
    one for each device.
    """

    fixed: tuple[Any, ...]  # force at e = 0 [N]
    rate: tuple[Any, ...]  # growth of the force with e [N/m]
    height: tuple[Any, ...]  # h, of a tendon b [m]
    behind: tuple[Any, ...]  # x, of a tendon 0 [m]
    kind: tuple[str, ...]  # the geometry, as of `elongation`
    unit: Any  # rotation of y = 1 [rad]
    moment: Any  # m g R times the unit [N m]

    def at(self, y: Any) -> Any:
        """The restoring acceleration -y'' that the devices add at y."""
        theta, total = self.unit * y, 0.0
        for fixed, rate, height, behind, kind in zip(
            self.fixed, self.rate, self.height, self.behind, self.kind, strict=True
        ):
            force = fixed + rate * elongation(height, behind, kind, theta)
            total = total + force * lever(height, behind, kind, theta)
        return total / self.moment


def elongation(height: Any, behind: Any, kind: str, theta: Any) -> Any:
    """The elongation e [m] of a device of a geometry (`Devices`) at theta."""
    if kind == "linear":
        return height * theta
    sin = math.sin if isinstance(theta, float) else np.sin
    if kind == "tendon":
        return 2.0 * height * sin(0.5 * theta)
    return behind * (2.0 * sin(0.5 * theta) ** 2) + height * sin(theta)


def lever(height: Any, behind: Any, kind: str, theta: Any) -> Any:
    """The lever de/dtheta [m] of a device at theta."""
    if kind == "linear":
        return height
    functions = math if isinstance(theta, float) else np
    if kind == "tendon":
        return height * functions.cos(0.5 * theta)
    return height * functions.cos(theta) + behind * functions.sin(theta)
