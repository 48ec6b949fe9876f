"""The few numbers that govern rocking, and the document kind that states them directly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..documents.document import Document
from ..documents.quantities import STANDARD_GRAVITY
from ..errors import DocumentError
from .kinematics import Mechanism


@dataclass(frozen=True)
class RockingParameters:
    """What a rocking structure comes to (section 4 of the paper: p, alpha, eta, lambda, and a_scale).

    name; structure: the kind it came from; p frequency parameter [rad/s]; alpha critical angle [rad]; eta restitution
    [-]; uplift lambda, the static uplift acceleration over g [-]; a_scale [-]; eta_source: where eta comes from; gravity
    [m/s2]; details: what else the kind reports; mechanism: where it is no rigid body, for the nonlinear model. Raises
    ValueError when a number is not finite or out of range.
    """

    name: str
    structure: str
    p: float
    alpha: float
    eta: float
    uplift: float
    a_scale: float
    eta_source: str = "momentum"
    gravity: float = STANDARD_GRAVITY
    details: Mapping[str, Any] = field(default_factory=dict)
    mechanism: Mechanism | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        for label, x in (("p", self.p), ("alpha", self.alpha), ("lambda", self.uplift), ("a_scale", self.a_scale)):
            if not (math.isfinite(x) and x > 0.0):
                raise ValueError(f"{label} is {x:g}, accepted is a positive finite number")
        if not 0.0 <= self.eta <= 1.0:
            raise ValueError(f"eta is {self.eta:g}, accepted is a number from 0 to 1")

    def record(self) -> dict[str, Any]:
        """The record that `rocking params --json` prints, itself a document of kind `parameters`."""
        return {
            "name": self.name,
            "kind": "parameters",
            "structure": self.structure,
            "p": self.p,
            "alpha": self.alpha,
            "eta": self.eta,
            "lambda": self.uplift,
            "a_scale": self.a_scale,
            "eta_source": self.eta_source,
            "gravity": self.gravity,
            **self.details,
        }

    def dimensionless_amplitude(self, a_g: Any) -> Any:
        """A = a_scale a_g / (alpha g) for a ground acceleration a_g [m/s2]."""
        return self.a_scale * a_g / (self.alpha * self.gravity)

    def ground_acceleration(self, amplitude: Any) -> Any:
        """a_g [m/s2] for a dimensionless amplitude A."""
        return amplitude * (self.alpha * self.gravity) / self.a_scale


def dimensionless_oscillator(eta: float) -> RockingParameters:
    """The oscillator of a dimensionless spectrum: p, alpha, lambda, a_scale and gravity are 1, so a_g is A and omega_g Omega.

    Raises ValueError when eta is not within [0, 1].
    """
    return RockingParameters(f"eta={eta:g}", "dimensionless", 1.0, 1.0, eta, 1.0, 1.0, "given", 1.0)


REPORTED = (
    "structure",
    "eta_source",
    "hinges",
    "a_scale_3_7",
    "direction",
    "lambda_governing",
    "tip_height",
    "crack_height",
    "cap_ratio",
    "rocks_on",
    "varied",
)
"""Keys that a record may carry along and that do not change the parameters."""


def gravity_of(document: Document) -> float:
    """The document's gravity [m/s2], 9.81 unless given."""
    if not document.has("gravity"):
        return STANDARD_GRAVITY
    return document.quantity("gravity", "acceleration", above=0.0, where="a positive acceleration")


def restitution_of(document: Document, momentum: float, limit: str) -> tuple[float, str]:
    """(eta, where it comes from): the document's value, or the given one from momentum.

    `limit` says in words when the momentum model stops to hold (eta < 0), which is an error unless eta is given.
    """
    if document.has("restitution") and document.values["restitution"].content != "auto":
        wanted = "a number from 0 to 1, or auto"
        try:
            return abs(document.quantity("restitution", "number", least=0.0, most=1.0, where=wanted)), "given"
        except DocumentError:
            raise document.fault("restitution", str(document.values["restitution"]), wanted) from None
    if momentum < 0.0:
        raise document.fault(None, f"a restitution of {momentum:.4g} from momentum", f"{limit}; or give restitution")
    return momentum, "momentum"


def build(document: Document, name: str) -> RockingParameters:
    """The parameters as a document of kind `parameters` states them; lambda and a_scale give each other (Eq. 3.9)."""
    p = document.quantity("p", "frequency parameter", above=0.0, where="a positive number")
    alpha = document.quantity("alpha", "angle", above=0.0, below=math.pi, where="an angle between 0 and 180 deg")
    eta = document.quantity("eta", "number", least=0.0, most=1.0, where="a number from 0 to 1")
    given = {
        key: document.quantity(key, "number", above=0.0, where="a positive number") for key in ("lambda", "a_scale") if document.has(key)
    }
    if not given:
        raise document.fault(None, "neither lambda nor a_scale", "one of them, or both")
    details = {key: document.values[key].plain() for key in document.values if key in REPORTED and document.has(key)}
    structure = str(details.pop("structure", "parameters"))
    source = str(details.pop("eta_source", "given"))
    return RockingParameters(
        name=name,
        structure=structure,
        p=p,
        alpha=alpha,
        eta=eta,
        uplift=given.get("lambda", alpha / given.get("a_scale", 1.0)),
        a_scale=given.get("a_scale", alpha / given.get("lambda", 1.0)),
        eta_source=source,
        gravity=gravity_of(document),
        details=details,
    )
