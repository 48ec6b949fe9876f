"""Ties and a tendon of a rigid body, and their statics.

A tie is anchored at the height h above the pivot and x behind it, and stays horizontal.
At the rotation theta it has

    u = x (1 - cos theta) + h sin theta,   lever = h cos theta + x sin theta,
    F = min(P0 + K u, F_y), 0 from u = u_ult on

A tendon on the centre line, at the distance b from the pivot, has the elongation 2 b
sin(theta/2) and the lever b cos(theta/2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .sketch import Sketch

SIDES = {"left": ("left",), "right": ("right",), "both": ("left", "right")}
_POINTS = 1000  # number of points of the search for an equilibrium


@dataclass(frozen=True)
class Tie:
    """A horizontal tie, elastic-plastic, in tension only."""

    height: float  # h of its anchor [m]
    stiffness: float  # K [N/m]
    prestress: float = 0.0  # P0 [N]
    yield_force: float = math.inf  # F_y [N]
    ultimate: float = math.inf  # u_ult [m]
    behind: float = 0.0  # x of its anchor [m]
    side: str = "both"  # on which it acts: "left", "right" or "both"

    def elongation(self, theta: float) -> float:
        """Return u [m] at a rotation [rad]."""
        return self.behind * (1.0 - math.cos(theta)) + self.height * math.sin(theta)

    def lever(self, theta: float) -> float:
        """Return du/dtheta [m] at a rotation [rad]."""
        return self.height * math.cos(theta) + self.behind * math.sin(theta)

    def breaks_at(self) -> float:
        """Return the rotation [rad] of u_ult, or infinity: u = R_t (sin a - sin(a -
        theta)), a being the angle of the anchor.
        """
        reach = math.hypot(self.behind, self.height)
        start = math.atan2(self.behind, self.height)
        sine = math.sin(start) - self.ultimate / reach
        return start - math.asin(sine) if sine >= -1.0 else math.inf

    def moment(self, theta: float) -> float:
        """Return the moment about the pivot [N m] at a rotation [rad] of a body that
        has not turned back before.
        """
        u = self.elongation(theta)
        return (
            0.0
            if u >= self.ultimate
            else min(self.prestress + self.stiffness * u, self.yield_force)
            * self.lever(theta)
        )


class Strand(Tie):
    """A tendon seen from one edge, as a tie of the height b."""

    def elongation(self, theta: float) -> float:
        return 2.0 * self.height * math.sin(0.5 * theta)

    def lever(self, theta: float) -> float:
        return self.height * math.cos(0.5 * theta)

    def breaks_at(self) -> float:
        sine = 0.5 * self.ultimate / self.height
        return 2.0 * math.asin(sine) if sine <= 1.0 else math.inf


@dataclass(frozen=True)
class Tendon:
    """An unbonded vertical tendon through the base."""

    stiffness: float  # k = EA/L [N/m]
    prestress: float = 0.0  # P0 [N]
    rupture: float = math.inf  # F_u [N]

    def at(self, lever: float) -> Strand:
        """Return the tendon at the distance `lever` [m] from an edge."""
        ultimate = (
            (self.rupture - self.prestress) / self.stiffness
            if self.stiffness
            else math.inf
        )
        return Strand(lever, self.stiffness, self.prestress, ultimate=ultimate)


class Stand(NamedTuple):
    """A body on one edge."""

    side: str  # "left" or "right"
    alpha: float  # critical angle [rad]
    moment: float  # m g R [N m]
    lever: float  # distance from the pivot to the centre line [m]


@dataclass(frozen=True)
class Restraints:
    """The ties and the tendon of a body."""

    ties: tuple[Tie, ...] = ()  # on either side
    tendon: Tendon | None = None  # None without one
    stands: tuple[Stand, ...] = ()  # the body on its left and on its right edge

    def on(self, side: str, lever: float) -> list[Tie]:
        """Return the ties of a side, and the tendon at the distance `lever` [m] from
        its edge.
        """
        return [tie for tie in self.ties if side in SIDES[tie.side]] + (
            [self.tendon.at(lever)] if self.tendon else []
        )

    def row(self) -> dict[str, Any]:
        """Return the restraints as a document states them, in SI units, with the
        further keys that a spectra file needs.
        """
        found: dict[str, Any] = (
            {"ties": [_stated(tie) for tie in self.ties]} if self.ties else {}
        )
        return (
            found
            | ({"tendon": _stated(self.tendon)} if self.tendon else {})
            | {"stands": [one._asdict() for one in self.stands]}
        )

    @classmethod
    def from_row(cls, row: Mapping[str, Any]) -> Restraints:
        """Return the restraints of a row of parameters, whose heights count from the
        pivots. Raises KeyError or TypeError.
        """
        ties = (
            Tie(
                **{
                    "yield_force" if key == "yield" else key: x
                    for key, x in one.items()
                }
            )
            for one in row.get("ties", ())
        )
        tendon = Tendon(**row["tendon"]) if "tendon" in row else None
        return cls(tuple(ties), tendon, tuple(Stand(**one) for one in row["stands"]))

    def statics(self, stand: Stand) -> dict[str, Any]:
        """Return lambda, the linear stiffness after uplift over m g R (-1 for the free
        body), and the equilibrium that replaces alpha: the first rotation [rad], up to
        a right angle, from which the body does not return; "none" without one.
        """
        ties = self.on(stand.side, stand.lever)
        pull = sum(tie.prestress * tie.height for tie in ties)
        stiff = sum(tie.stiffness * tie.height**2 for tie in ties)

        def returns(theta: float) -> bool:
            return (
                stand.moment * math.sin(stand.alpha - theta)
                + sum(tie.moment(theta) for tie in ties)
                > 0.0
            )

        low, high, step = 0.0, 0.0, 0.5 * math.pi / _POINTS
        while (stays := returns(high)) and high < 0.5 * math.pi:
            low, high = high, high + step
        for _ in range(60):  # bisection, which also ends at a rupture
            middle = 0.5 * (low + high)
            low, high = (middle, high) if returns(middle) else (low, middle)
        uplift = math.tan(stand.alpha) + pull / (stand.moment * math.cos(stand.alpha))
        return {
            "lambda": uplift,
            "stiffness": stiff / stand.moment - 1.0,
            "equilibrium": "none" if stays else high,
        }

    def drawn(self, drawing: Sketch) -> Sketch:
        """Return the drawing with the tendon and the ties added; a tie goes from its
        anchor across the body and beyond it.
        """
        (_, (left, level)), (_, (right, _)) = drawing.pivots[0], drawing.pivots[-1]
        x, z = zip(*(point for body in drawing.bodies for point in body), strict=True)
        ends = {"left": (left, 1.0, max(x)), "right": (right, -1.0, min(x))}
        lines = []
        for one, (pivot, away, end) in [
            (tie, ends[side]) for tie in self.ties for side in SIDES[tie.side]
        ]:
            height = level + one.height
            course = (
                (pivot + away * one.behind, height),
                (end + away * 0.15 * (max(z) - level), height),
            )
            lines.append(("tie", tuple(sorted(course))))
        if self.tendon:
            lines.append(
                (
                    "tendon",
                    ((0.5 * (left + right), level), (0.5 * (left + right), max(z))),
                )
            )
        return replace(drawing, lines=(*lines, *drawing.lines))


def _stated(one: Tie | Tendon) -> dict[str, Any]:
    return {
        key.removesuffix("_force"): value
        for key, value in vars(one).items()
        if value != math.inf
    }
