"""The conical masonry spire (Fig. 3), uncracked or with a diagonal crack below its
solid tip.

The outer cone has the base radius r_b and the height H; its wall has the horizontal
thickness t at the base. The spire is solid above z_t = H (1 - t/r_b). The crack plane
passes through the pivot (r_b, 0) and the outer face on the other side at z_c. The part
above it rocks; a mirrored crack opens in the other direction. The paper gives Eqs.
3.1-3.3 for the uncracked thin wall, and no equations for the crack.
"""

import itertools
import math
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody
from ..mechanics.toe import Foot, RingBase, foot_of
from ..shared_keys import DENSITY
from ..sketch import Point, Sketch, rocker

REPORTS = ("tip_height", "crack_height")
SIZES = ("base_radius", "height")
KEYS = Keys(
    {"base_radius": length("outside"), "height": length("of the whole cone")},
    {
        "thickness": Key(
            "length", "of the wall at the base, horizontally; absent: thin"
        ),
        "tip_height": Key("length", "where the solid tip begins"),
        "crack": Key("choice", "that it rocks on", words=("none", "diagonal")),
        "crack_height": Key(
            "length", "where the crack leaves the windward face", least=0.0
        ),
        "density": DENSITY,
    },
)
_rule = cache(np.polynomial.legendre.leggauss)  # nodes and weights on (-1, 1)
_NODES = 64  # Gauss points for each interval; 32 already give 1e-13


class Cone(NamedTuple):
    """A solid cone on z = 0."""

    radius: float  # radius of the base [m]
    height: float  # [m]
    thin: bool = False  # True: only its lateral shell, of unit horizontal thickness

    def whole(self) -> Moments:
        """Return the moments of the whole cone."""
        r, h = self.radius, self.height
        if self.thin:
            mass = math.pi * r * h
            return Moments(mass, 0.0, mass * h / 3.0, mass * (0.25 * r**2 + h**2 / 6.0))
        mass = math.pi * r**2 * h / 3.0
        return Moments(mass, 0.0, mass * h / 4.0, mass * (0.15 * r**2 + 0.1 * h**2))

    def above(self, edge: float, slope: float, both: bool = False) -> Moments:
        """Return moments of the part above the plane through (edge, 0) that rises by
        `slope` towards -x; both: also above its mirror image. A slice is a circle or
        ring cut by a chord and has closed forms. The integral over z is Gauss-Legendre
        in theta, with z = middle - half cos(theta), which removes the square roots at
        the ends of an interval.
        """
        total = Moments(0.0, 0.0, 0.0, 0.0)
        for start, stop in self._intervals(edge, slope):
            z, weight = _gauss_points(start, stop)
            area, x, xx = self._slices(z, edge - z / slope, both)
            integrands = (area, x, area * z, xx + area * z * z)
            total = total.plus(
                Moments(*(float((weight * f).sum()) for f in integrands))
            )
        return total

    def _slices(
        self, z: np.ndarray, chord: np.ndarray, both: bool
    ) -> tuple[np.ndarray, ...]:
        """Return (int dA, int x dA, int x^2 dA) of the slices at the heights z beyond
        their chord at this x [m]; both: only what also lies above the mirror image.
        """
        radius = self.radius * (1.0 - z / self.height)
        with np.errstate(over="ignore"):  # the slope of a nearly flat crack
            angle = np.arccos(np.clip(chord / radius, -1.0, 1.0))
        above = self._slice(radius, angle)
        if not both:
            return above

        # Above both planes lies chord <= x <= -chord: what is beyond the chord without
        # what is beyond its mirror image; nothing for a positive chord.
        beyond = self._slice(radius, math.pi - angle)
        return tuple(
            np.where(angle > 0.5 * math.pi, a - b, 0.0)
            for a, b in zip(above, beyond, strict=True)
        )

    def _slice(
        self, radius: np.ndarray, angle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return (int dA, int x dA, int x^2 dA) over the part x >= R cos(angle) of a
        circle or ring of radius R.
        """
        sin, cos = np.sin(angle), np.cos(angle)
        if self.thin:
            return (
                2.0 * radius * angle,
                2.0 * radius**2 * sin,
                radius**3 * (angle + sin * cos),
            )
        chord = radius**2 * (angle - sin * cos)
        return (
            chord,
            2.0 / 3.0 * (radius * sin) ** 3,
            0.25 * radius**4 * (angle - 0.25 * np.sin(4.0 * angle)),
        )

    def _intervals(self, edge: float, slope: float) -> list[tuple[float, float]]:
        """Return the intervals of z between the base, the apex, and the points where
        the plane meets the faces and the axis.
        """
        marks = [0.0, self.height, slope * edge]
        for side in (1.0, -1.0):  # edge - z / slope = side R (1 - z / H)
            fall = 1.0 / slope - side * self.radius / self.height
            if fall != 0.0:
                marks.append((edge - side * self.radius) / fall)
        marks = sorted(z for z in marks if 0.0 <= z <= self.height)
        return [(a, b) for a, b in itertools.pairwise(marks) if b > a]


def _gauss_points(start: float, stop: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the points z in an interval, and their weights, of the rule in theta that
    `Cone.above` describes.
    """
    nodes, weights = _rule(_NODES)
    theta = 0.5 * math.pi * (nodes + 1.0)
    half = 0.5 * (stop - start)
    z = 0.5 * (start + stop) - half * np.cos(theta)
    return z, 0.5 * math.pi * weights * half * np.sin(theta)


class Spire(NamedTuple):
    """The geometry of a spire."""

    base_radius: float  # [m]
    height: float  # [m]
    thickness: float  # thickness of the wall [m], 0 for a thin wall
    tip_height: float  # [m]
    crack_height: float  # [m], 0 for an uncracked spire

    def rocking(self, both: bool = False) -> Moments:
        """Return the moments of the part above the crack; both: only what also lies
        above the mirror image of the crack.
        """
        outer = self._part(
            Cone(self.base_radius, self.height, thin=self.thickness == 0.0), both
        )
        if self.thickness == 0.0:
            return outer
        return outer.minus(
            self._part(Cone(self.base_radius - self.thickness, self.tip_height), both)
        )

    def _part(self, cone: Cone, both: bool) -> Moments:
        """Return the moments of the part of a cone above the crack."""
        if self.crack_height == 0.0:
            return cone.whole()
        windward = self.base_radius * (1.0 - self.crack_height / self.height)
        return cone.above(
            self.base_radius, self.crack_height / (self.base_radius + windward), both
        )

    def restitution(self) -> float:
        """eta from angular momentum: only the part above both cracks moves before and
        after an impact.
        """
        left, right = (-self.base_radius, 0.0), (self.base_radius, 0.0)
        shared: float = self.rocking(both=True).between(left, right)
        return shared / float(self.rocking().about(*right))


def body(document: Document) -> RigidBody:
    """A spire; the drawing shows its section, the crack and its mirror image. Raises
    DocumentError. Keys: base_radius, height, thickness (absent: thin wall), tip_height,
    crack: none | diagonal, crack_height.
    """
    spire = _read(document)
    moments, radius = spire.rocking(), spire.base_radius
    foot, mass = _foot(document, spire, moments.mass)
    whole = RigidBody(
        moments=moments,
        half=radius,
        top=(0.0, spire.height),
        drawing=_drawing(spire, moments.centre),
        limit="a spire more slender, or cracked lower",
        foot=foot,
        details=mass,
    )
    if not spire.crack_height:
        return whole

    def refused(_: float) -> RigidBody:
        raise document.fault(
            "inset", "an inset of a cracked spire", "no inset, or crack: none"
        )

    heights = {"tip_height": spire.tip_height, "crack_height": spire.crack_height}
    # Another part of the spire rocks on each edge.
    eta = spire.restitution()
    return replace(whole, eta=eta, top=None, details=heights | mass, moved=refused)


def _drawing(spire: Spire, centre: Point) -> Sketch:
    """Return the section of a spire, with its crack and the crack's mirror image."""
    radius, crack = spire.base_radius, spire.crack_height
    left, right, apex = (-radius, 0.0), (radius, 0.0), (0.0, spire.height)
    inner = radius - spire.thickness
    cavity = (-inner, 0.0), (inner, 0.0), (0.0, spire.tip_height)
    hollows = (cavity,) if spire.thickness else ()
    if not crack:
        return rocker([(left, right, apex)], left, right, centre, hollows=hollows)
    windward = (-radius * (1.0 - crack / spire.height), crack)
    return rocker(
        [(windward, right, apex)],
        left,
        right,
        centre,
        still=((left, right, windward),),
        hollows=hollows,
        lines=(
            ("crack", (right, windward)),
            ("its mirror image", (left, (-windward[0], crack))),
        ),
    )


def _foot(
    document: Document, spire: Spire, volume: float
) -> tuple[Foot | str, dict[str, float]]:
    """Return (the foot of a spire, its mass as a detail if a density gives it); volume:
    of the part that rocks [m3]. Raises DocumentError.
    """
    if spire.crack_height:
        return "a cracked spire, which stands on another part on each edge", {}
    if not spire.thickness:
        return "a spire with a thin wall, whose contact area is not known", {}
    area = RingBase(spire.base_radius, spire.base_radius - spire.thickness)
    return foot_of(document, area, volume)


def _read(document: Document) -> Spire:
    """Return the geometry of the document. Raises DocumentError."""
    base, height = document.length("base_radius"), document.length("height")
    thickness = 0.0
    if document.has("thickness"):
        # for a thinner wall the difference of the two cones has no digits left
        thinnest = 1e-9 * base
        where = (
            f"a positive length below base_radius ({base:g} m) and above {thinnest:g}"
            " m; absent: a thin wall"
        )
        thickness = document.quantity(
            "thickness", above=thinnest, below=base, where=where
        )
    tip = height * (1.0 - thickness / base)
    if document.has("tip_height"):
        if thickness == 0.0:
            raise document.fault(
                "tip_height",
                "a solid tip on a thin wall",
                "tip_height only together with thickness",
            )
        where = f"a positive length up to height ({height:g} m)"
        tip = document.quantity(
            "tip_height", above=1e-9 * height, most=height, where=where
        )
    crack = document.choice(
        "crack", default="diagonal" if document.has("crack_height") else "none"
    )
    if crack == "none":
        if document.has("crack_height"):
            raise document.fault(
                "crack_height",
                "a crack height",
                "crack_height only together with crack: diagonal",
            )
        return Spire(base, height, thickness, tip, 0.0)
    where = f"a length from 0 (the base) to {tip:g} m (where the solid tip begins)"
    crack_height = document.quantity("crack_height", most=tip, where=where, default=tip)
    if crack_height > (1.0 - 1e-3) * height:
        raise document.fault(
            "crack_height",
            "a crack up to the apex, above which nothing is left",
            f"crack_height well below {height:g} m",
        )
    # A lower crack is the same as none in double precision.
    return Spire(
        base,
        height,
        thickness,
        tip,
        0.0 if crack_height < 1e-16 * height else crack_height,
    )
