"""A single rigid body that rocks about the two edges of its base (section 2 of the
paper, extended to unequal edges).

The mass centre is at the horizontal distances l and r from the left and right edge, at
height z; I_G is the moment of inertia about it. The body stands on its right edge while
theta > 0. An impact keeps the angular momentum about the new edge:

    eta_right = (I_G + m (z^2 - l r)) / (I_G + m (z^2 + l^2))
    eta_left  = (I_G + m (z^2 - l r)) / (I_G + m (z^2 + r^2))

A one-sided body rocks on its right edge only. It returns, hits its base, then the
backing, then its base again. With the vectors r_L from its left edge and r_T from the
impact point on the backing to the mass centre, its restitution is e = eta_right
eta_left (I_G + m r_L.r_T) / (I_G + m r_T^2) (Sorrentino et al. 2011).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..parameters import RockingParameters, Side
from ..shared_keys import (
    gravity_of,
    has_loads,
    mass_of,
    one_sided_restitution_of,
    restitution_of,
    restraints_in,
)
from ..sketch import Point, Sketch, rectangle, redrawn, rocker
from .moments import Moments
from .toe import Foot, toe_of


class EdgeParameters(NamedTuple):
    """A body on one edge."""

    p: float  # frequency parameter [rad/s]
    alpha: float  # critical angle [rad]
    uplift: float  # lambda [-]
    # from angular momentum at the impact that leaves this edge [-], negative if the
    # body is too squat to rock
    eta: float
    # R, distance to the mass centre [m]; None if the ground forces are not known
    arm: float | None

    def side(self, name: str, eta: float) -> Side:
        """Return the parameters on this edge with the restitution `eta`."""
        return Side(name, self.p, self.alpha, self.uplift, 1.0, eta, self.arm)

    def alone(self, eta: float, **more: Any) -> RockingParameters:
        """Return the parameters of a body on this edge, or on two edges that are like
        it; more: their other fields.
        """
        return RockingParameters(
            p=self.p,
            alpha=self.alpha,
            eta=eta,
            uplift=self.uplift,
            a_scale=1.0,
            arm=self.arm,
            **more,
        )


@dataclass(frozen=True, kw_only=True)
class RigidBody:
    """A rigid body as its kind reads it from a document."""

    # returns (left edge, right edge) for a gravity [m/s2]
    edges: Callable[[float], tuple[EdgeParameters, EdgeParameters]]
    lever: float  # least horizontal distance from an edge to the mass centre [m]
    # returns the body with its pivots inside the edges by a length [m]
    inset_by: Callable[[float], RigidBody]
    limit: str  # the bodies for which the momentum model holds
    drawing: Sketch  # its geometry
    # its contact area, for `strength`; a text says whose is not known
    foot: Foot | str = "such a body, whose contact area is not known"
    radius: float | None = None  # R of two equal edges [m]
    # (x, z) of the impact point on a backing, from the middle of the base [m]; None if
    # the geometry does not define it
    top: Point | None = None
    # factor of the impact on a backing [-]; None if the geometry does not define it
    backing: float | None = None
    crown: float | None = None  # height [m], None for that of the drawing
    share: float = 1.0  # m g R of the parts over mass g R [-]
    details: Mapping[str, Any] = field(default_factory=dict)  # see `RockingParameters`
    # details for unequal edges
    leaning: Mapping[str, Any] = field(default_factory=dict)

    def parameters(self, document: Document, name: str) -> RockingParameters:
        """Return the rocking parameters, with gravity, restitution, sides, mass and
        inset of the document. Raises DocumentError.
        """
        inset, body = self.moved_in(document)
        gravity = gravity_of(document)
        more: dict[str, Any] = {
            "name": name,
            "structure": str(document.values["kind"].content),
            "gravity": gravity,
            "details": self._details(document, inset, body),
            "top": body._top_arms(),
            "document": document,
        }
        if document.has("strength"):
            more["remarks"] = toe_of(document, self.foot).remarks
        if has_loads(document):
            from ..load_keys import loaded

            return loaded(document, body, more, self)
        left, right = body.edges(gravity)
        if document.flag("one_sided"):
            found = body._one_sided(document, left, right, more)
        else:
            found = body._on_both_edges(document, left, right, more)
        if restraints_in(document):
            return body._restrained(document, found, inset)
        return found

    def _details(
        self, document: Document, inset: float, body: RigidBody
    ) -> dict[str, Any]:
        """Return the details of `body`, this body on pivots inside its edges."""
        details = dict(body.details)
        mass = mass_of(document)
        if mass is not None:
            details["mass"] = mass
        if document.has("inset") or document.has("strength"):
            weaker = min(self.edges(1.0), key=lambda edge: edge.uplift)
            details |= {"inset": inset, "alpha_geometric": weaker.alpha}
        if document.has("strength"):
            details["base_stress"] = toe_of(document, self.foot).stress
        return details

    def _one_sided(
        self,
        document: Document,
        left: EdgeParameters,
        right: EdgeParameters,
        more: dict[str, Any],
    ) -> RockingParameters:
        """Return the parameters of the body against a backing: those on its right edge,
        with the restitution of three impacts.
        """
        eta, source = one_sided_restitution_of(
            document, (right.eta, left.eta), self.backing
        )
        return right.alone(eta, eta_source=source, one_sided=True, **more)

    def _on_both_edges(
        self,
        document: Document,
        left: EdgeParameters,
        right: EdgeParameters,
        more: dict[str, Any],
    ) -> RockingParameters:
        """Return the parameters on the left and the right edge."""
        eta_left, source = restitution_of(document, left.eta, self.limit)
        if left == right:
            return right.alone(eta_left, eta_source=source, **more)
        eta_right, _ = restitution_of(document, right.eta, self.limit)
        return RockingParameters.of_sides(
            left=left.side("left", eta_left),
            right=right.side("right", eta_right),
            eta_source=source,
            **{**more, "details": {**more["details"], **self.leaning}},
        )

    def _restrained(
        self, document: Document, found: RockingParameters, inset: float
    ) -> RockingParameters:
        """Return the parameters with the document's ties, tendon and dampers, which are
        placed by the geometry of the body. Raises DocumentError.
        """
        from ..restraint_keys import restrained

        (_, (left, level)), *_, (_, (right, _)) = self.drawing.pivots
        z = [
            z
            for outline in (*self.drawing.still, *self.drawing.bodies)
            for _, z in outline
        ]
        return restrained(
            document,
            found,
            crown=self.crown or max(z) - min(z),
            level=level - min(z),
            inset=inset,
            width=right - left + 2.0 * inset,
            radius=self.radius,
            share=self.share,
        )

    def moved_in(self, document: Document) -> tuple[float, RigidBody]:
        """Return the document's inset (the distance of the pivots inside the edges [m],
        default 0, or that of its strength), and the body on these pivots. Raises
        DocumentError.
        """
        if document.has("strength"):
            inset = toe_of(document, self.foot).inset
            if not inset < self.lever:
                raise document.fault(
                    "strength",
                    f"a strength whose pivots lie {inset:.4g} m inside the edges",
                    f"a larger one: the mass centre is {self.lever:.4g} m from an edge",
                )
            return inset, self.inset_by(inset)
        where = (
            f"a length from 0 to below {self.lever:g} m, beyond which the mass centre"
            " is not above the base"
        )
        inset = document.quantity("inset", below=self.lever, where=where)
        return inset, self.inset_by(inset) if inset else self

    def sketch(self, document: Document, built: RockingParameters) -> Sketch:
        """Return the geometry for a drawing, with what the document puts on the body.
        Raises DocumentError.
        """
        drawing = self.moved_in(document)[1].drawing
        if has_loads(document):
            from ..load_keys import drawn_with_loads

            return drawn_with_loads(document, drawing, built)
        return built.restraints.drawn(drawing) if built.restraints else drawing

    def _top_arms(self) -> tuple[float, ...]:
        """The distances from the left and the right edge to the farthest point of the
        top [m]; empty if the geometry defines no top.
        """
        points = (
            [point for outline in self.drawing.bodies for point in outline]
            if self.top is not None
            else []
        )
        highest = max((z for _, z in points), default=0.0)
        top = [point for point in points if highest - point[1] <= 1e-9 * highest]
        return tuple(
            max(math.dist(pivot, point) for point in top)
            for _, pivot in self.drawing.pivots
            if top
        )


def equal_edges(
    radius: float,
    alpha: float,
    inertia: float,
    *,
    drawing: Sketch,
    eta: float | None = None,
    whole: bool = True,
    **more: Any,
) -> RigidBody:
    """Return a rigid body with equal edges: p^2 = M g R/I_P, lambda = tan alpha (Eq.
    2.2), a_scale = 1 (Eq. 2.4). radius: R, from the edge to the mass centre [m]; alpha
    [rad]; inertia: I_P/(M R^2) about the edge [-]; eta: from angular momentum, by
    default 1 - (M R^2/I_P)(1 - cos 2 alpha) (Eqs. 2.6, 3.3); whole: true if the same
    body rocks on both edges, so that its ground forces are known; more: the other
    fields of the body.
    """
    half, z = radius * math.sin(alpha), radius * math.cos(alpha)
    # Eq. 2.6, where 1 - cos 2 alpha = 2 sin^2 alpha
    momentum = 1.0 - 2.0 * math.sin(alpha) ** 2 / inertia if eta is None else eta
    arm = radius if whole else None

    def edges(gravity: float) -> tuple[EdgeParameters, EdgeParameters]:
        edge = EdgeParameters(
            p=math.sqrt(gravity / (radius * inertia)),  # Eq. 2.3: p^2 = M g R/I_P
            alpha=alpha,
            uplift=math.tan(alpha),  # Eq. 2.2
            eta=momentum,
            arm=arm,
        )
        return edge, edge

    def inset_by(inset: float) -> RigidBody:
        moments = Moments(1.0, 0.0, z, (inertia - 1.0) * radius**2 + z * z)
        # `backing` follows from the top.
        kept = {key: x for key, x in more.items() if key != "backing"}
        return symmetric_body(
            moments, half - inset, drawing=redrawn(drawing, inset), **kept
        )

    return RigidBody(
        **{"inset_by": inset_by, **more},
        edges=edges,
        lever=half,
        drawing=drawing,
        radius=radius,
    )


def rectangle_body(radius: float, alpha: float, **more: Any) -> RigidBody:
    """Return a rectangle of half diagonal `radius` [m]: p^2 = 3g/(4R), eta = 1 - 3/2
    sin^2 alpha; more: other fields of the body. A one-sided one hits its backing at its
    top: e = (1 - 3/2 sin^2 alpha)^2 (1 - 3/2 cos^2 alpha).
    """
    half, z = radius * math.sin(alpha), radius * math.cos(alpha)
    drawing = rocker(
        [rectangle(-half, half, 0.0, 2.0 * z)], (-half, 0.0), (half, 0.0), (0.0, z)
    )
    backing = 1.0 - 1.5 * math.cos(alpha) ** 2
    return equal_edges(
        radius,
        alpha,
        4.0 / 3.0,
        top=(-half, 2.0 * z),
        backing=backing,
        drawing=drawing,
        **more,
    )


def symmetric_body(
    moments: Moments, half: float, *, top: Point | None = None, **more: Any
) -> RigidBody:
    """Return a rigid body on the right edge (half, 0) [m]; on the left edge its mirror
    image rocks. top: (x, z) [m] of the impact point on a backing, None if the geometry
    does not define it; more: the other arguments of `equal_edges`.
    """
    right, z = half - moments.x / moments.mass, moments.z / moments.mass
    radius = math.hypot(right, z)
    inertia = moments.about(half, 0.0) / (moments.mass * radius**2)
    alpha = math.atan2(right, z)
    return equal_edges(
        radius,
        alpha,
        inertia,
        top=top,
        backing=_against_backing(moments, half, top),
        **more,
    )


def body_on_edges(
    moments: Moments,
    half: float,
    *,
    drawing: Sketch,
    top: Point | None = None,
    **more: Any,
) -> RigidBody:
    """Return a body that rocks as a whole on the edges (-half, 0) and (half, 0) [m];
    arguments as for `symmetric_body`.
    """
    # An offset of rounding is none.
    if abs(moments.x) <= 1e-13 * math.sqrt(moments.mass * moments.polar):
        moments = moments._replace(x=0.0)
        return symmetric_body(
            moments,
            half,
            top=top,
            eta=edges_of(moments, half, 1.0)[1].eta,
            drawing=drawing,
            **more,
        )

    def inset_by(inset: float) -> RigidBody:
        return body_on_edges(
            moments, half - inset, drawing=redrawn(drawing, inset), top=top, **more
        )

    return RigidBody(
        **{"inset_by": inset_by, **more},
        edges=partial(edges_of, moments, half),
        lever=half - abs(moments.x / moments.mass),
        drawing=drawing,
        top=top,
        backing=_against_backing(moments, half, top),
        leaning={
            "direction": (
                "over the left edge" if moments.x < 0.0 else "over the right edge"
            )
        },
    )


def edges_of(
    body: Moments, half: float, gravity: float
) -> tuple[EdgeParameters, EdgeParameters]:
    """Return the parameters on the left edge (-half, 0) and the right edge (half, 0)
    [m]; the mass centre must be above the base.
    """
    z = body.z / body.mass
    # I_G + m (z^2 - l r), the angular momentum about one edge of a turn about the other
    shared = body.between((half, 0.0), (-half, 0.0))

    def on(edge: float) -> EdgeParameters:
        distance = abs(edge - body.x / body.mass)
        arm = math.hypot(distance, z)
        p = math.sqrt(gravity * arm * body.mass / body.about(edge, 0.0))
        return EdgeParameters(
            p,
            math.atan2(distance, z),
            distance / z,
            shared / body.about(-edge, 0.0),
            arm,
        )

    return on(-half), on(half)


def _against_backing(body: Moments, half: float, top: Point | None) -> float | None:
    """Return (I_G + m r_L.r_T)/(I_G + m r_T^2), the factor of the impact on the backing
    at T = `top`; None without `top`.
    """
    if top is None:
        return None
    return float(body.between((-half, 0.0), top) / body.about(*top))


def sizes(width: str, height: str, radius: str) -> tuple[Keys, Keys]:
    """Return the two ways to state the sizes of a body; the arguments say what each
    length is.
    """
    alpha = Key("angle", "critical angle", above=0.0, below=0.5 * math.pi)
    return (
        Keys({"width": length(width), "height": length(height)}),
        Keys({"radius": length(radius), "alpha": alpha}),
    )


def radius_and_alpha(document: Document, centroid: float = 0.5) -> tuple[float, float]:
    """Return (R [m], alpha [rad]) from radius and alpha, or from width and height.
    Raises DocumentError. The mass centre is at width/2 from the edge and at `centroid`
    x height.
    """
    if document.has("radius") or document.has("alpha"):
        return document.length("radius"), document.quantity("alpha")
    x, z = 0.5 * document.length("width"), centroid * document.length("height")
    return math.hypot(x, z), math.atan2(x, z)
