"""A single rigid body that rocks about the two edges of its base.

A one-sided body rocks on its right edge only. It returns, hits its base, then the
backing, then its base again. With the vectors r_L from its left edge and r_T from the
impact point on the backing to the mass centre, its restitution is e = eta_right
eta_left (I_G + m r_L.r_T) / (I_G + m r_T^2) (Sorrentino et al. 2011).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..parameters import RockingParameters, Side
from ..rigidity import of_cantilever
from ..shared_keys import (
    gravity_of,
    has_loads,
    mass_of,
    one_sided_restitution_of,
    restitution_of,
    restraints_in,
)
from ..sketch import Sketch, rectangle, redrawn, rocker
from .moments import BodyOnEdge, Moments, Point, edges_of
from .plane import top_arms
from .toe import Foot, toe_of

SIDES = ("left", "right")


@dataclass(frozen=True, kw_only=True)
class RigidBody:
    """A rigid body as its kind reads it from a document."""

    moments: Moments  # about the middle between its edges, of any density
    half: float  # half the distance of its edges [m]
    limit: str  # the bodies for which the momentum model holds
    drawing: Sketch  # its geometry
    # its contact area, for `strength`; a text says whose is not known
    foot: Foot | str = "such a body, whose contact area is not known"
    shaft: float | None = None  # height, if each section is that of the foot [m]
    # (x, z) of the impact point on a backing, from the middle of the base [m]; None if
    # the geometry does not define it
    top: Point | None = None
    # from angular momentum [-], of bodies of which other parts rock on the left edge,
    # the mirror image of those on the right; None for one that rocks as a whole
    eta: float | None = None
    # returns the body with its pivots inside the edges by a length [m]; None for one
    # that stays the same
    moved: Callable[[float], RigidBody] | None = None
    crown: float | None = None  # height [m], None for that of the drawing
    share: float = 1.0  # m g R of the parts over mass g R [-]
    details: Mapping[str, Any] = field(default_factory=dict)  # see `RockingParameters`

    def __post_init__(self) -> None:
        mass, x, _, polar = self.moments
        # An offset of rounding is none.
        if x and self.eta is None and abs(x) <= 1e-13 * math.sqrt(mass * polar):
            object.__setattr__(self, "moments", self.moments._replace(x=0.0))

    @property
    def lever(self) -> float:
        """The least horizontal distance from an edge to the mass centre [m]."""
        x, _ = self.moments.centre
        return self.half - (abs(x) if self.eta is None else x)

    def edges(self, gravity: float) -> tuple[BodyOnEdge, BodyOnEdge]:
        """Return (left edge, right edge) for a gravity [m/s2]."""
        left, right = edges_of(self.moments, self.half, gravity)
        if self.eta is None:
            return left, right
        right = right._replace(eta=self.eta)
        return right, right

    def inset_by(self, inset: float) -> RigidBody:
        """Return the body with its pivots inside the edges by a length [m]."""
        if self.moved is not None:
            return self.moved(inset)
        drawing = redrawn(self.drawing, inset)
        return replace(self, half=self.half - inset, drawing=drawing)

    @property
    def backing(self) -> float | None:
        """(I_G + m r_L.r_T)/(I_G + m r_T^2), the factor of the impact on the backing at
        T = `top`; None without `top`.
        """
        if self.top is None:
            return None
        shared = self.moments.between((-self.half, 0.0), self.top)
        return float(shared / self.moments.about(*self.top))

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
            # of a geometry that has a top
            "top": top_arms(
                list(chain(*body.drawing.bodies)) if body.top is not None else [],
                (pivot for _, pivot in body.drawing.pivots),
            ),
            "document": document,
        }
        if document.has("strength"):
            more["remarks"] = toe_of(document, self.foot).remarks
        if has_loads(document):
            from ..load_keys import loaded

            return loaded(document, body, more, self)
        found = (
            body._one_sided if document.flag("one_sided") else body._on_both_edges
        )(document, body.edges(gravity), more)
        if restraints_in(document):
            return body._restrained(document, found, inset)
        return found

    def _details(
        self, document: Document, inset: float, body: RigidBody
    ) -> dict[str, Any]:
        """Return the details of `body`, this body on pivots inside its edges."""
        details = {**body.details, **of_cantilever(document, self)}
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
        edges: tuple[BodyOnEdge, BodyOnEdge],
        more: dict[str, Any],
    ) -> RockingParameters:
        """Return the parameters of the body against a backing: those on its right edge,
        with the restitution of three impacts.
        """
        left, right = edges
        eta, source = one_sided_restitution_of(
            document, (right.eta, left.eta), self.backing
        )
        numbers = self._numbers(right, eta)
        return RockingParameters(**numbers, eta_source=source, one_sided=True, **more)

    def _on_both_edges(
        self,
        document: Document,
        edges: tuple[BodyOnEdge, BodyOnEdge],
        more: dict[str, Any],
    ) -> RockingParameters:
        """Return the parameters on the left and the right edge."""
        eta, source = restitution_of(document, edges[0].eta, self.limit)
        if edges[0] == edges[1]:
            numbers = self._numbers(edges[1], eta)
            return RockingParameters(**numbers, eta_source=source, **more)
        other, _ = restitution_of(document, edges[1].eta, self.limit)
        left, right = (
            Side(name, **self._numbers(edge, e))
            for name, edge, e in zip(SIDES, edges, (eta, other), strict=True)
        )
        weaker = min((left, right), key=lambda side: side.uplift)
        direction = {"direction": f"over the {weaker.side} edge"}
        more = {**more, "details": {**more["details"], **direction}}
        return RockingParameters.of_sides(
            left=left, right=right, eta_source=source, **more
        )

    def _numbers(self, edge: BodyOnEdge, eta: float) -> dict[str, Any]:
        """Return the numbers on an edge; R is told if the ground forces are known."""
        arm = edge.arm if self.eta is None else None
        return {**edge._asdict(), "arm": arm, "eta": eta}

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
            radius=self.edges(1.0)[1].arm,
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
        if not document.has("inset"):
            return 0.0, self
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


def rectangle_body(width: float, height: float, **more: Any) -> RigidBody:
    """Return a rectangle [m]: p^2 = 3g/(4R), eta = 1 - 3/2 sin^2 alpha; more: other
    fields of the body. A one-sided one hits its backing at its top: e = (1 - 3/2 sin^2
    alpha)^2 (1 - 3/2 cos^2 alpha).
    """
    half, centre = 0.5 * width, (0.0, 0.5 * height)
    outline = rectangle(-half, half, 0.0, height)
    return RigidBody(
        moments=Moments.of(1.0, centre, (width**2 + height**2) / 12.0),
        half=half,
        top=(-half, height),
        shaft=height,
        drawing=rocker([outline], (-half, 0.0), (half, 0.0), centre),
        **more,
    )


def sizes(width: str, height: str, radius: str) -> tuple[Keys, Keys]:
    """Return the two ways to state the sizes of a body; the arguments say what each
    length is.
    """
    alpha = Key("angle", "critical angle", above=0.0, below=0.5 * math.pi)
    return (
        Keys({"width": length(width), "height": length(height)}),
        Keys({"radius": length(radius), "alpha": alpha}),
    )


def half_and_height(document: Document, centroid: float = 0.5) -> Point:
    """Return the half width and the height of the mass centre [m] from radius and
    alpha, or from width and height, of which it is the share `centroid`. Raises
    DocumentError.
    """
    if document.has("radius") or document.has("alpha"):
        radius, alpha = document.length("radius"), document.quantity("alpha")
        return radius * math.sin(alpha), radius * math.cos(alpha)
    return 0.5 * document.length("width"), centroid * document.length("height")
