"""A tied body as `collocation` integrates it, phase by phase: ties and a tendon that
slacken, unload, yield and break at roots along each step, in SI units. It shares no
code with the package.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from oracles.collocation import FINE_PARTS, Body, Edge, Shaking, Step, integrate, zero


@dataclass
class Device:
    """A tie (height, behind) or a tendon (lever) on one side: +1 or -1."""

    side: int
    stiffness: float
    prestress: float = 0.0
    force: float = math.inf
    ultimate: float = math.inf
    height: float = 0.0
    behind: float = 0.0
    tendon: bool = False
    linear: bool = False
    permanent: float = 0.0
    yielding: bool = False
    broken: bool = False
    taut: bool = True
    farthest: float = 0.0

    def elongation(self, u: Any) -> Any:
        if self.linear:
            return self.height * u
        return (
            2 * self.height * np.sin(u / 2)
            if self.tendon
            else self.behind * (1 - np.cos(u)) + self.height * np.sin(u)
        )

    def lever(self, u: Any) -> Any:
        if self.linear:
            return self.height
        return (
            self.height * np.cos(u / 2)
            if self.tendon
            else self.height * np.cos(u) + self.behind * np.sin(u)
        )

    def spring(self, u: Any) -> Any:
        return self.prestress + self.stiffness * (self.elongation(u) - self.permanent)

    def tension(self, u: Any) -> Any:
        return (
            self.force
            if self.yielding
            else self.spring(u)
            if self.taut and not self.broken
            else 0.0
        )

    def limits(self, u: Any) -> dict[str, Any]:
        """What is above 0 where its law changes; `slack` changes with either sign."""
        rupture = {} if self.broken else {"rupture": self.elongation(u) - self.ultimate}
        return (
            rupture
            if self.broken or self.yielding
            else rupture
            | {"slack": self.spring(u), "yield": self.spring(u) - self.force}
        )


def _first(
    function: Callable[[Any], Any], parts: np.ndarray, either: bool
) -> float | None:
    """The first of these parts of a step beyond which a function is positive, or has
    the other sign; none at the start itself.
    """
    values = function(parts)
    over = (
        (values > 0.0) != (values[1] > 0.0)
        if either
        else (values > 0.0) & (values[1] <= 0.0)
    )
    at = int(np.argmax(over[2:])) + 2
    return zero(function, parts[at - 1], parts[at]) if over[at] else None


class TiedBody(Body):
    """m, R, alpha, I of a body that is alike on both edges; eta: after over before
    (negative: one-sided).
    """

    def __init__(
        self,
        mass: float,
        radius: float,
        alpha: float,
        inertia: float,
        eta: float,
        devices: list[Device],
        damping: float = 0.0,
        gravity: float = 9.81,
        linear: bool = False,
    ) -> None:
        edge = Edge(math.sqrt(mass * gravity * radius / inertia), alpha, eta)
        super().__init__(
            edge, edge if eta > 0.0 else None, damping, not linear, gravity
        )
        self.inertia, self.devices, self.radius, self.weight = (
            inertia,
            devices,
            radius,
            mass * gravity,
        )

    def run(self, shaking: Shaking, **more: Any) -> tuple[float, bool]:
        """(largest |theta|/alpha, True if it overturns) up to the end of the shaking,
        still ground after it included.
        """
        answer = integrate(self, shaking, still_impacts=-1, **more)
        return answer.rotation, answer.outcome.startswith("overturned")

    def lowest_fz(self, shaking: Shaking, **more: Any) -> float:
        """The least Fz/(m g) up to the third impact after the shaking, at 97 instants
        of every step; bounces are followed down to 1e-9 of alpha p. A tie pulls
        horizontally, a tendon also downwards.
        """
        least, parts = [1.0], np.linspace(0.0, 1.0, 97)

        def seen(side: int, step: Step) -> None:
            u, v, t = step.height(parts), step.speed(parts), step.t + step.h * parts
            z = self.edge(side).alpha - u
            # Just inside the step, where the ground is that of the step.
            inside = step.t + step.h * np.clip(parts, 1e-9, 1.0 - 1e-9)
            ground = shaking.at(inside if t[-1] <= shaking.end else t)
            acceleration = self.acceleration(side, u, v, *ground)
            pressed = (
                sum(d.tension(u) * np.cos(0.5 * u) for d in self.on(side) if d.tendon)
                / self.weight
            )
            lifted = (
                self.radius
                / self.gravity
                * (acceleration * np.sin(z) - v * v * np.cos(z))
            )
            weight = 1.0 + ground[1] / self.gravity
            least.append(float(np.min(weight + lifted + pressed)))

        integrate(self, shaking, still_impacts=3, seen=seen, **more)
        return min(least)

    def on(self, side: int) -> list[Device]:
        return [d for d in self.devices if d.side == side]

    def acceleration(self, side: int, u: Any, v: Any, across: Any, up: Any) -> Any:
        moment = sum(d.tension(u) * d.lever(u) for d in self.on(side))
        return super().acceleration(side, u, v, across, up) - moment / self.inertia

    def excess(self, side: int, ground: tuple[Any, Any]) -> Any:
        self.begins(side, 0.0, 0.0)
        return super().excess(side, ground)

    def far(self, side: int, across: Any, up: Any) -> float:
        return 0.5 * math.pi

    def fallen(self, side: int, u: float, v: float) -> bool:
        return u >= 0.5 * math.pi

    def cut(self, side: int, step: Step, upto: float) -> float | None:
        """The first part of a step at which a device changes its law, or the body turns
        back; None if it is not before `upto`.
        """
        parts = np.append(FINE_PARTS[0], [1e-3 * FINE_PARTS[1], *FINE_PARTS[1:]])
        turn = _first(
            lambda part: step.speed(part), upto * parts, either=True
        )  # up to which every elongation is monotone
        parts, found = (upto if turn is None else turn) * parts, [turn]
        found += [
            _first(
                lambda part, d=d, name=name: d.limits(step.height(part))[name],
                parts,
                either=name == "slack",
            )
            for d in self.on(side)
            for name in d.limits(0.0)
        ]
        return min((part for part in found if part is not None), default=None)

    def begins(self, side: int, u: float, v: float) -> None:
        """Keep the largest elongations, and change the laws that end here."""
        if u <= 0.0:  # after a touch, which rounding may place below the ground
            u, v = 0.0, max(0.0, v)
        rest = (
            1e-6 * self.right.alpha * self.right.p
        )  # so slow, it goes no further that would count
        for d in self.on(side):
            if d.broken:
                continue
            stretch, spring, little = (
                d.elongation(u),
                d.spring(u),
                1e-12 * (d.prestress + d.stiffness * d.elongation(u)),
            )
            d.farthest, d.taut = (
                max(d.farthest, stretch),
                spring > little or (spring >= -little and v >= 0.0),
            )
            if stretch >= d.ultimate * (1.0 - 1e-12):
                d.permanent = (
                    d.ultimate - (d.force - d.prestress) / d.stiffness
                    if d.yielding
                    else d.permanent
                )
                d.broken, d.yielding = True, False
                for other in self.devices:
                    other.broken |= d.tendon and other.tendon
            elif d.yielding and v <= rest:
                d.yielding, d.permanent = (
                    False,
                    stretch - (d.force - d.prestress) / d.stiffness,
                )
            elif not d.yielding and v > rest and spring >= d.force * (1.0 - 1e-12):
                d.yielding = True


def wall(devices: list[Device], eta: float, damping: float = 0.0) -> TiedBody:
    """A wall of 0.6 x 6 m and 7200 kg."""
    radius = math.hypot(0.3, 3.0)
    return TiedBody(
        7200.0,
        radius,
        math.atan2(0.3, 3.0),
        4.0 / 3.0 * 7200.0 * radius**2,
        eta,
        devices,
        damping,
    )
