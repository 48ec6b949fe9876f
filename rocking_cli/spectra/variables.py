"""The variables of a spectrum, and their attributes in a file.

A new variable is one entry of a table below.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..dynamics.outcome import Difference, Outcome

Codes = type[Outcome] | type[Difference]


class Variable(NamedTuple):
    """The type of a variable, its attributes in a file, and the meaning of its values where they are codes."""

    dtype: np.dtype
    attributes: dict[str, Any]
    codes: Codes | None = None

    @property
    def fill(self) -> float:
        """The value of cells that are not computed."""
        return float(self.attributes.get("_FillValue", 0))


def _real(long_name: str, comment: str = "", units: str = "1") -> Variable:
    about = {"units": units, "long_name": long_name, "_FillValue": np.nan, "comment": comment}
    return Variable(np.dtype("<f8"), {key: value for key, value in about.items() if value != ""})


def _coded(long_name: str, codes: Codes) -> Variable:
    flags = {"flag_values": np.array([c.value for c in codes], dtype="u1"), "flag_meanings": " ".join(c.flag for c in codes)}
    return Variable(np.dtype("u1"), {"units": "1", "long_name": long_name, **flags}, codes)


VARIABLES: dict[str, Variable] = {
    "theta_ratio": _real("largest rotation over critical angle", "max over time of abs(theta)/alpha; NaN where overturned or not computed"),
    "outcome": _coded("outcome", Outcome),
    "impacts": Variable(np.dtype("<i4"), {"units": "1", "long_name": "impacts during shaking"}),
    "velocity_ratio": _real(
        "largest angular speed over p", "max over time of abs(d theta/dt)/p; NaN where overturned or not computed", units="rad"
    ),
    "condition": _real(
        "condition of the largest rotation",
        "sum of abs(d theta_ratio / d ln x) over the amplitude, the frequency and the restitution, by central differences; NaN "
        "where overturned, failed or not computed, or if a cell of the differences is",
    ),
    "friction": _real(
        "required coefficient of friction",
        "max over time of abs(Fx)/Fz between impacts; infinite where Fz <= 0, NaN where overturned or not computed",
    ),
    "fz_min": _real("least vertical force over weight", "min over time of Fz/(m g) between impacts; NaN where overturned or not computed"),
    "theta_ratio_linear": _real("largest rotation over critical angle by the linear equation"),
    "outcome_linear": _coded("outcome by the linear equation", Outcome),
    "difference": _coded("how the linear equation judges what the nonlinear one decides", Difference),
}
"""A file has theta_ratio and outcome, and others on request, in this order; a chunk's checksum runs over them in the same order."""

QUANTITIES: dict[str, tuple[str, ...]] = {
    "velocity_ratio": ("velocity_ratio",),
    "condition": ("condition",),
    "friction": ("friction",),
    "fz_min": ("fz_min",),
    "linear": ("theta_ratio_linear", "outcome_linear", "difference"),
}
"""The quantities that may be asked for, each with its variables."""
