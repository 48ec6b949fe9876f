"""A tied body by SciPy's DOP853 in SI units, phase by phase: the ends of phases are looked for where signs change at points along each
step and bisected on the dense output. It shares no code with the package."""

import math
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy.integrate import DOP853


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
    largest: float = 0.0  # force
    farthest: float = 0.0

    def elongation(self, u):
        if self.linear:
            return self.height * u
        if self.tendon:
            return 2 * self.height * math.sin(u / 2)
        return self.behind * (1 - math.cos(u)) + self.height * math.sin(u)

    def lever(self, u):
        if self.linear:
            return self.height
        return self.height * math.cos(u / 2) if self.tendon else self.height * math.cos(u) + self.behind * math.sin(u)

    def tension(self, u):
        if self.broken:
            return 0.0
        if self.yielding:
            return self.force
        return max(0.0, self.prestress + self.stiffness * (self.elongation(u) - self.permanent))


@dataclass
class TiedBody:
    """m, R, alpha, I of a body that is alike on both edges; eta: after over before (negative: one-sided); ground: acceleration [m/s2]."""

    mass: float
    radius: float
    alpha: float
    inertia: float
    eta: float
    devices: list
    damping: float = 0.0
    gravity: float = 9.81
    linear: bool = False
    events: list = field(default_factory=list)

    def bend(self, side, ground, t, u, v):
        moment = sum(d.tension(u) * d.lever(u) for d in self.devices if d.side == side)
        sin, cos = (self.alpha - u, 1.0) if self.linear else (math.sin(self.alpha - u), math.cos(self.alpha - u))
        weight = self.mass * self.radius * (self.gravity * sin + side * ground(t) * cos)
        return -(weight + moment) / self.inertia - 2 * self.damping * math.sqrt(self.mass * self.gravity * self.radius / self.inertia) * v

    def rates(self, side, ground, t, state):
        return [state[1], self.bend(side, ground, t, *state)]

    def run(self, ground, breaks, end, release=0.0, step=math.inf):
        """(largest |theta|, outcome) from rest or a release to the right; breaks: instants at which the ground's law changes."""
        marks = sorted({*breaks, end})
        t, side, u, v = 0.0, 1, release, 0.0
        largest, bounced, rests = u, False, release == 0.0
        while t < end - 1e-12:
            stop = min(x for x in marks if x > t + 1e-12)
            if rests:
                t, side = self.uplift(ground, t, stop)
                if side == 0:
                    side = 1
                    continue
                self.events.append((t, "uplift"))
                u = v = 0.0
                rests = False
                stop = min((x for x in marks if x > t + 1e-12), default=end)
            on = [d for d in self.devices if d.side == side]
            first = 1e-5 if stop - t > 1e-5 else None
            solver = DOP853(partial(self.rates, side, ground), t, [u, v], stop, rtol=1e-12, atol=1e-15, max_step=step, first_step=first)
            hit = None
            while hit is None and solver.status == "running":
                before = solver.t
                solver.step()
                dense = solver.dense_output()
                low = before
                for high in np.linspace(before, solver.t, 9)[1:]:
                    found = []
                    for name, d, f in self.limits(on):
                        begins = f(*dense(low)) <= 0 or low == t
                        clear = low > t or name == "impact" or f(*dense(low + 1e-3 * (high - low))) <= 0
                        if f(*dense(high)) > 0 and begins and clear:
                            found.append((self.bisected(f, dense, low, high), name, d))
                    if found:
                        hit = min(found, key=lambda x: x[0])
                        break
                    low = high
            reach = solver.t if hit is None else hit[0]
            path = [solver.y[0]] if hit is None else [dense(hit[0])[0]]
            for d in on:
                if not d.broken:
                    e = d.elongation(path[0])
                    d.farthest, d.largest = max(d.farthest, e), max(d.largest, d.tension(path[0]))
            largest = max(largest, path[0])
            t, (u, v) = reach, (solver.y if hit is None else dense(reach))
            if u >= math.pi / 2 - 1e-9:
                return math.nan, "overturned"
            if hit is None:
                continue
            name, d = hit[1], hit[2]
            self.events.append((t, name))
            if name == "impact":
                bounced = True
                v = abs(self.eta * v)
                side = side if self.eta <= 0 else -side
                u = 0.0
                if v < 1e-9:
                    rests = True
            elif name == "turn":
                for d in on:
                    if d.yielding:
                        d.yielding = False
                        d.permanent = d.elongation(u) - (d.force - d.prestress) / d.stiffness
                v = 0.0
            elif name == "yield":
                d.yielding = True
            elif name == "rupture":
                if d.yielding:
                    d.permanent = d.ultimate - (d.force - d.prestress) / d.stiffness
                d.broken, d.yielding = True, False
                for other in self.devices:
                    other.broken |= d.tendon and other.tendon
            for other in on if name in ("yield", "rupture") else ():  # at the same instant
                over = other.prestress + other.stiffness * (other.elongation(u) - other.permanent) - other.force
                other.yielding |= not other.broken and over > 0
        self.bounced = bounced
        return largest, "stands"

    def limits(self, on):
        found = [("impact", None, lambda u, v: -u), ("turn", None, lambda u, v: -v)]
        for d in on:
            if d.broken:
                continue
            if math.isfinite(d.ultimate):
                found.append(("rupture", d, lambda u, v, d=d: d.elongation(u) - d.ultimate))
            if not d.yielding and math.isfinite(d.force):
                found.append(
                    ("yield", d, lambda u, v, d=d: d.prestress + d.stiffness * (d.elongation(u) - d.permanent) - d.force if v > 0 else -1.0)
                )
            if d.stiffness and not d.yielding:
                found.append(("slack", d, lambda u, v, d=d: -(d.prestress + d.stiffness * (d.elongation(u) - d.permanent))))
                found.append(("engagement", d, lambda u, v, d=d: d.prestress + d.stiffness * (d.elongation(u) - d.permanent)))
        return found

    def bisected(self, f, dense, low, high):
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if f(*dense(middle)) > 0 else (middle, high)
        return high

    def uplift(self, ground, t, stop):
        """(instant, side) of the next uplift up to `stop`, side 0 without one."""
        grid = np.linspace(t, stop, 2001)
        for i, now in enumerate(grid):
            for side in (1, -1) if self.eta > 0 else (1,):
                if self.bend(side, ground, now, 0.0, 0.0) > 0:
                    if i == 0:
                        return float(now), side
                    low, high = float(grid[i - 1]), float(now)
                    for _ in range(80):
                        middle = 0.5 * (low + high)
                        low, high = (low, middle) if self.bend(side, ground, middle, 0.0, 0.0) > 0 else (middle, high)
                    return high, side
        return stop, 0
