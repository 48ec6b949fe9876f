"""The body beside its trace: what a structure tells of it, how a sensor reads it, and
which unknowns a fit has.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import Array
from ...documents.quantities import DEFAULT_GRAVITY
from ...errors import DocumentError
from ...structures.given import Structure, structure_from
from ...structures.kinds import rigid_body_of
from .first_look import Release
from .unknowns import ALPHA, INSET, Shape, angle_shape, inset_shape

if TYPE_CHECKING:
    from ...structures.mechanics.single_body import RigidBody
    from ...structures.parameters import RockingParameters


class KnownBody(NamedTuple):
    """A rigid body with two edges."""

    known: RockingParameters  # what its document states
    rigid: RigidBody | None  # None for a body that takes no inset

    @property
    def p(self) -> tuple[float, float]:
        """p of the right and the left edge without an inset [rad/s]."""
        if self.rigid is not None:
            return self.edge(0.0, 0)[1], self.edge(0.0, 1)[1]
        left, right = self.known.left_and_right
        return right.p, left.p

    @property
    def alpha(self) -> float:
        """alpha without an inset, the mean of both edges [rad]."""
        if self.rigid is not None:
            return 0.5 * (self.edge(0.0, 0)[0] + self.edge(0.0, 1)[0])
        return 0.5 * sum(side.alpha for side in self.known.left_and_right)

    @property
    def height(self) -> float | None:
        """The height of the mass centre [m], None if it is not known."""
        side = self.known.left_and_right[0]
        return None if side.arm is None else side.arm * math.cos(side.alpha)

    def edge(self, inset: float, side: int) -> tuple[float, float]:
        """Return (alpha, p) on a pivot inside its edge; side: 0 right, 1 left."""
        assert self.rigid is not None
        found = self.rigid.inset_by(inset).edges(self.known.gravity)[1 - side]
        return found.alpha, found.p

    def momentum(self, insets: Array) -> float:
        """Return the restitution from angular momentum, the mean of both edges; insets:
        that of both, or of the right and the left one [m].
        """
        if self.rigid is None:
            return float(self.known.eta)
        edges = [
            self.rigid.inset_by(float(x)).edges(self.known.gravity) for x in insets
        ]
        return 0.5 * (edges[0][1].eta + edges[-1][0].eta)


def body_of(structure: Structure) -> KnownBody:
    """Return what a structure tells. Raises DocumentError for one that is no rigid body
    with two edges.
    """
    known = structure_from(structure)
    document = known.document
    refused = {
        "one_sided": known.one_sided,
        "ties": known.restraints is not None,
        "damping": known.damping > 0.0,
        known.structure: known.mechanism is not None or "interfaces" in known.details,
        f"a_scale = {known.a_scale:g}": known.a_scale != 1.0,
        "no units": known.dimensionless,
        "strength, which states the inset": "base_stress" in known.details,
    }
    for what in (what for what, is_so in refused.items() if is_so):
        raise DocumentError(
            f"{known.name}: found {what}; identify fits two-sided rigid bodies"
        )
    return KnownBody(known, None if document is None else rigid_body_of(document))


def reading_of(quantity: str, body: KnownBody | None, z: float) -> Callable[..., Array]:
    """Return how a sensor reads the motion, see `fit.Reading`; z: height of a point
    whose displacement is measured [m].
    """
    if quantity == "theta_dot":
        return lambda theta, rate, alpha, p: rate
    if quantity == "theta":
        return lambda theta, rate, alpha, p: theta
    centre = None if body is None else body.height
    if quantity == "uplift" and body is not None and body.rigid is not None:
        other, above = body.rigid.lever, centre or 0.0
        return lambda theta, rate, alpha, p: (
            (other + above * np.tan(alpha)) * np.sin(np.abs(theta))
        )
    gravity = DEFAULT_GRAVITY if body is None else body.known.gravity

    def displaced(theta: Array, rate: Array, alpha: Array, p: Array) -> Array:
        # from the pivot to the middle of the base; of a block without a structure
        middle = (
            0.75 * gravity / p**2 * np.sin(alpha)
            if centre is None
            else centre * np.tan(alpha)
        )
        return z * np.sin(theta) - np.sign(theta) * middle * (np.cos(theta) - 1.0)

    return displaced


def shape_of(
    fit: str, two_sides: bool, release: Release, body: KnownBody | None
) -> Shape:
    """Return the unknowns of a fit of a release."""
    longs, tops = np.diff(release.impacts), release.peaks

    def p_at(alpha: float) -> float:
        """The median p for which a peak gives the length of its half-cycle, linear."""
        x = np.clip(tops[1:] / alpha, 1e-4, 0.97)
        return float(np.median(2.0 * np.arccosh(1.0 / (1.0 - x)) / longs))

    if fit == INSET and body is not None and body.rigid is not None:
        return inset_shape(body.edge, body.rigid.lever, two_sides)
    # alpha of each side over the other, from peaks and lengths of their half-cycles
    alphas = tops[1:] / (1.0 - 1.0 / np.cosh(0.5 * p_at(1.3 * tops[0]) * longs))
    means = [np.median(alphas[i::2]) for i in (1 - release.side, release.side)]
    ratio = float(np.clip(means[0] / means[1], 0.5, 2.0)) if two_sides else None
    p = body.p if fit == ALPHA and body is not None else None
    return angle_shape(float(tops[0]), p_at, p, ratio)
