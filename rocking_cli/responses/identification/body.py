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

if TYPE_CHECKING:
    from ...structures.mechanics.single_body import RigidBody
    from ...structures.parameters import RockingParameters

INSET, ALPHA, BOTH = "inset", "alpha", "alpha,p"
FITS = (INSET, ALPHA, BOTH)
_LARGEST = 1.5  # rad
# (theta [rad], theta_dot [rad/s], alpha, p) with their signs: returns the reading in SI
Reading = Callable[[Array, Array, Array, Array], Array]


class KnownBody(NamedTuple):
    """A rigid body with two edges."""

    known: RockingParameters  # what its document states
    rigid: RigidBody | None  # None for a body that takes no inset

    @property
    def lever(self) -> float | None:
        """The largest inset [m], None for a body that takes none."""
        return None if self.rigid is None else self.rigid.lever

    @property
    def height(self) -> float | None:
        """The height of the mass centre [m], None if it is not known."""
        side = self.known.left_and_right[0]
        return None if side.arm is None else side.arm * math.cos(side.alpha)

    def on(self, insets: Array) -> tuple[Array, float]:
        """Return (ln alpha right, left, ln p right, left, (4,); eta from angular
        momentum) on pivots inside the edges; insets: right and left [m].
        """
        if self.rigid is None:
            left, right = self.known.left_and_right
            edges, eta = [(x.alpha, x.p) for x in (right, left)], float(self.known.eta)
        else:
            bodies = [self.rigid.inset_by(x) for x in insets.tolist()]
            pair = [
                one.edges(self.known.gravity)[1 - i] for i, one in enumerate(bodies)
            ]
            edges, eta = (
                [(x.alpha, x.p) for x in pair],
                0.5 * (pair[0].eta + pair[1].eta),
            )
        return np.log(edges).T.ravel(), eta


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


def reading_of(quantity: str, body: KnownBody | None, z: float) -> Reading:
    """Return how a sensor reads the motion; z: height of a point whose displacement is
    measured [m].
    """
    if quantity == "theta_dot":
        return lambda theta, rate, alpha, p: rate
    if quantity == "theta":
        return lambda theta, rate, alpha, p: theta
    height = None if body is None else body.height
    if quantity == "uplift" and body is not None:
        other, above = body.lever or 0.0, height or 0.0
        return lambda theta, rate, alpha, p: (
            (other + above * np.tan(alpha)) * np.sin(np.abs(theta))
        )
    gravity = DEFAULT_GRAVITY if body is None else body.known.gravity

    def displaced(theta: Array, rate: Array, alpha: Array, p: Array) -> Array:
        # from the pivot to the middle of the base; of a block without a structure
        block = 0.75 * gravity / p**2 * np.sin(alpha)
        middle = block if height is None else height * np.tan(alpha)
        return z * np.sin(theta) - np.sign(theta) * middle * (np.cos(theta) - 1.0)

    return displaced


class Shape(NamedTuple):
    """The unknowns of a fit that hold for the whole trace."""

    fit: str  # one of FITS
    two_sides: bool
    # ln alpha of the right and the left edge and ln p of both, (4,), at the unknowns:
    # insets over the lever; or ln alpha, ln(p^2 alpha) unless p is known, and of two
    # sides ln of alpha right over left
    at: Callable[[Array], Array]
    starts: list[Array]  # unknowns to begin with


def shape_of(
    fit: str, two_sides: bool, release: Release, body: KnownBody | None
) -> Shape:
    """Return the unknowns of a fit of a release."""
    if fit == INSET and body is not None and body.lever is not None:
        lever, known = body.lever, body

        def with_insets(u: Array) -> Array:
            # beyond the lever there is no body: a large inset stays just below it
            return known.on(lever * np.minimum(np.broadcast_to(u, 2), 0.999))[0]

        shares = (0.0, 0.15, 0.3, 0.45, 0.6)
        return Shape(
            INSET, two_sides, with_insets, [np.full(1 + two_sides, x) for x in shares]
        )
    ln_p = body.on(np.zeros(2))[0][2:] if fit == ALPHA and body is not None else None

    def with_angles(u: Array) -> Array:
        # ln alpha as it is, but below a right angle
        ln_alpha = np.log(_LARGEST * np.tanh(np.exp(u[0]) / _LARGEST))
        half = (0.5 * u[-1] if two_sides else 0.0) * np.array([1.0, -1.0])
        both = np.full(2, 0.5 * (u[1] - ln_alpha)) if ln_p is None else ln_p
        return np.concatenate([ln_alpha + half, both])

    starts, tops, longs = [], release.peaks[1:], np.diff(release.impacts)
    for alpha in release.peaks[0] * np.array([1.03, 1.08, 1.3, 2.0, 4.0]):
        # the median p for which a peak gives the length of its half-cycle, linear, and
        # the alphas that lengths then give
        x = np.clip(tops / alpha, 1e-4, 0.97)
        p = np.median(2.0 * np.arccosh(1.0 / (1.0 - x)) / longs)
        alphas = np.log(tops / (1.0 - 1.0 / np.cosh(0.5 * p * longs)))
        right, left = (
            np.median(alphas[(k + 1 - release.side) % 2 :: 2]) for k in (0, 1)
        )
        angles = [np.log(alpha)] + [np.log(p**2 * alpha)] * (ln_p is None)
        starts.append(np.array(angles + [right - left] * two_sides))
    return Shape(fit, two_sides, with_angles, starts)
