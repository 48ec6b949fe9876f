"""Stretches of amplitudes A with one outcome under one cycle of a sine (Lemmas 15, 16).

The path of the least amplitude of a stretch and a bound of the distance to those of the
others decide the outcome of all, if the body has no impact before the shaking ends. The
scan of an envelope then computes the least amplitude alone. With impacts to come they
may still exclude that any overturns: the search of a capacity begins above them.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.contacts.contact import FreeMotion, Symmetric, Unequal
from ..dynamics.equations.rigid_body import RigidBodyEquation
from ..dynamics.impulse_bound import ImpulseBound
from ..dynamics.lanes import Lanes
from ..dynamics.outcome import Outcome
from ..dynamics.shared_march import SharedMarch
from ..dynamics.system import System
from ..motions import Motion, sine

UNKNOWN = int(Outcome.NOT_COMPUTED)
_SAFE = 1.0 - 1e-9
# widths in A of the stretches that are tried one above the other: the first and the
# least one
_FIRST_TRIED, _LEAST_TRIED = 0.1, 0.008
_ABOVE_UPLIFT = 1.0 + 2e-9  # over uplift, from which on Lemma 15 is tried
_SLOWEST = 1.0  # least Omega for which a proof is tried
# From an Omega on, the number of steps of the integration over half a cycle
_STEPS = {_SLOWEST: 96, 4.0: 32}
_LONGEST = 0.1  # longest step, over the time in which a distance may grow e-fold
# What the integration may be off, over 1 + Z, in y and in y': 15 times the largest
# error that was found, for alpha from 0.05 to 0.6, Omega to 15 and A to 100
_ERROR = 2e-4
_WIDEST, _NARROWEST = 512, 32  # points of a stretch
# Up to `_NEAR` times the y of the equilibrium a step takes |theta - alpha| <= alpha,
# which holds if it ends below `_BOUNDED` times this y.
_NEAR, _BOUNDED = 1.7, 1.9


class _LeastPath(NamedTuple):
    """A body and the bound of its neighbours. Every array is (stretches,)."""

    y: Array  # displacement of the least amplitude, in the unit of its side
    v: Array  # y'
    z: Array  # bound of |dy/dA|, A over that of uplift
    w: Array  # bound of |dy'/dA|


class _Distance(NamedTuple):
    """How far all bodies of a stretch are from its path. Every array is
    (stretches,).
    """

    y: Array  # bound of the distance of y
    v: Array  # bound of the distance of y'


class _Step(NamedTuple):
    """The stretches at the end of a step. Every array is (stretches,)."""

    second: bool  # True in the second half of the cycle
    phase: Array  # of the motion [rad]
    path: _LeastPath  # of the least amplitude
    off: _Distance  # of all amplitudes from it
    highest: Array  # bound of y of all amplitudes up to here
    fastest: Array  # bound of |y'| of all amplitudes in the step
    near: Array  # True if |theta - alpha| <= alpha so far
    clear: Array  # True if the bounds hold, and no body has had an impact


class AmplitudeStretches:
    """Stretches of amplitudes, each at one Omega, of one system under a motion."""

    def __init__(
        self, system: System, motion: Motion, omega: Array, ends: Array
    ) -> None:
        """omega: Omega of each stretch; ends: its least and its largest A,
        (2, stretches).
        """
        self.system, self.motion = system, motion
        self.ends, self.reference = ends, omega
        self.steps = _steps(float(omega.min()))  # over half a cycle
        # The first half cycle lifts the body onto the side against which it pushes.
        self.side = np.full(
            omega.size, -np.sign(motion.pieces[0].harmonics[0].amplitude)
        )
        assert isinstance(system.equation, RigidBodyEquation)
        self.both = system.equation  # of both sides
        self.equation = self.both.on(self.side, np.arange(omega.size))
        low, high = (system.contact.cells(system.equation, a, omega) for a in ends)
        at = low.row(self.side), np.arange(omega.size)
        # A over that of uplift onto this side, Omega and eta of this side
        self.least, self.largest = low.amplitude[at], high.amplitude[at]
        self.omega, self.eta = low.omega[at], low.eta[at]
        self.gap = self.largest - self.least

    @staticmethod
    def supports(system: System, motion: Motion) -> bool:
        """True if Lemma 15 holds for a system under a motion."""
        one = sine()
        return (
            isinstance(system.equation, RigidBodyEquation)
            and isinstance(system.contact, Symmetric | Unequal)
            and not system.equation.damped
            and system.devices is None
            and motion.vertical is None
            and motion.pieces in (one.pieces, one.scaled(-1.0).pieces)
        )

    def outcomes(self) -> Array:
        """The outcome of every amplitude of each stretch, `UNKNOWN` without a proof,
        (stretches,).
        """
        found = np.full(self.omega.size, UNKNOWN, dtype=np.uint8)
        for now in self._followed():
            rises = now.near & (not now.second)
            falls = self._certainly_fall(now.path, now.off, rises)
            found[falls & now.clear] = Outcome.OVERTURNED_NO_IMPACT

        at = np.flatnonzero((found == UNKNOWN) & now.clear)
        found[at] = self._after_shaking(
            at,
            _LeastPath(*(x[at] for x in now.path)),
            _Distance(*(x[at] for x in now.off)),
        )
        return found

    def cannot_overturn(self, kept: tuple[Array, Array]) -> Array:
        """True for stretches of which no amplitude overturns or loses contact (Lemma
        16), (stretches,). kept: A up to which contact is proved, of a body that does
        not overturn, and of one whose energy stays below the barrier [-].
        """
        most, equation = self.ends[1], self.equation
        cells = self.system.contact.cells(self.both, most, self.reference)
        bound = ImpulseBound.of(self.both, cells, self.motion.segments)
        unit = bound.unit[cells.row(self.side), np.arange(most.size)]
        stands = np.zeros(most.size, dtype=bool)
        highest, fastest = np.zeros((2, most.size))  # up to the proof
        for now in self._followed():
            # Lemma 16: c v, and what is still to come.
            y, v = now.path.y + now.off.y, np.abs(now.path.v) + now.off.v
            np.copyto(highest, np.fmax(highest, now.highest), where=~stands)
            np.copyto(fastest, np.fmax(fastest, now.fastest), where=~stands)
            below = y <= self._top
            speed = np.sqrt(2.0 * equation.fall(np.clip(y, 0.0, self._top), v)[1])
            # int |s| dphi up to the end of the cycle
            cos = np.cos(now.phase)
            to_come = 1.0 - cos if now.second else 3.0 + cos
            proved = unit * speed + bound.growth * to_come < _SAFE * bound.least
            stands |= proved & now.clear & below
            if stands.all():
                break
        stands &= (most <= kept[0]) | (
            (most <= kept[1]) & self._keep_contact(highest, fastest)
        )
        return stands

    def _keep_contact(self, highest: Array, fastest: Array) -> Array:
        """True where Lemma 13 holds up to these bounds of y and |y'|."""
        body, sin = self.system.body, self.equation.sin
        if body is None:
            return np.ones(highest.size, dtype=bool)
        edge = body.on(self.side, np.arange(highest.size))
        push = self.largest * self.equation.tan
        return body.contact_proved(edge, push, sin * highest, fastest=sin * fastest)

    def _followed(self) -> Iterator["_Step"]:
        """Yield the stretches at the uplift of the least amplitude, and at the end of
        each step over the cycle.
        """
        start = np.arcsin(1.0 / np.maximum(self.least, 1.0))
        path = self._at_uplift(start)
        off, near = self._distances(path), np.ones(start.size, dtype=bool)
        growth = np.sqrt(self._rate(1.0, 1.0))
        valid = (self.least > 1.0 + 1e-9) & (
            growth * np.pi <= _LONGEST * self.steps * self.omega
        )
        # a bound of y of all bodies so far; y of the path after half a cycle
        highest, middle = off.y, np.full(start.size, np.inf)
        yield _Step(False, start, path, off, highest, off.v, near, valid)
        for second, begin in ((False, start), (True, np.full(start.size, np.pi))):
            step = ((1 + second) * np.pi - begin) / self.steps
            for n in range(self.steps):
                near = highest <= _NEAR * self._top
                path = self._stepped(path, begin + n * step, step, near)
                off = self._distances(path)
                highest = np.fmax(highest, self._highest(path, off, step))
                fastest = np.abs(path.v) + off.v + self._force * step / self.omega
                valid = valid & (~near | (highest <= _BOUNDED * self._top))
                phase = begin + (n + 1) * step
                if second:
                    clear = np.minimum(np.minimum(middle, path.y), 1.0) > off.y
                else:
                    # The least path is the lowest, and rises up to the end of a > 1.
                    clear = path.y > _ERROR * (1.0 + path.z)
                    clear |= phase <= np.pi - start
                clear &= valid
                yield _Step(second, phase, path, off, highest, fastest, near, clear)
            middle = path.y

    @property
    def _top(self) -> Array | float:
        """y of the unstable equilibrium."""
        return self.equation.alpha / self.equation.sin

    def _highest(self, path: _LeastPath, off: "_Distance", step: Array) -> Array:
        """A bound of y of all bodies of each stretch in a step that ends here."""
        h = step / self.omega
        return np.asarray(path.y + off.y + 0.125 * self._force * h * h)

    @property
    def _force(self) -> Array:
        """A bound of |y''|."""
        return np.asarray(1.0 / self.equation.sin + self.largest / self.equation.cos)

    def _certainly_fall(
        self, path: _LeastPath, off: "_Distance", rises: Array
    ) -> Array:
        """True where Lemma 6 holds for all bodies of a stretch; rises: True where y and
        y' may grow with A so far.
        """
        rises = rises & (self.largest * self.equation.tan**2 <= 1.0)
        return self.equation.certainly_overturns(
            path.y - np.where(rises, _ERROR * (1.0 + path.z), off.y),
            path.v - np.where(rises, _ERROR * (1.0 + path.w), off.v),
            self.largest,
        )

    def _at_uplift(self, start: Array) -> _LeastPath:
        """The path at the uplift of the least amplitude; the largest one has lifted the
        body before.
        """
        before = np.arcsin(1.0 / np.maximum(self.largest, 1.0))
        root = self._rate(1.0, self.equation.sin)
        past = np.sqrt(root) * (start - before) / self.omega
        return _LeastPath(
            np.zeros_like(start),
            np.zeros_like(start),
            (np.cosh(past) - 1.0) / (root * self.equation.cos),
            np.sinh(past) / (np.sqrt(root) * self.equation.cos),
        )

    def _rate(self, push: Array | float, sin: Array | float) -> Array:
        """Bound of |dy''/dy| under the outward drive `push` at A = 1; sin: bound of
        |sin(theta - alpha)|.
        """
        return 1.0 + self.largest * np.abs(push) * self.equation.tan * sin

    def _slopes(self, path: _LeastPath, phase: Array, sin: Array) -> _LeastPath:
        """The derivatives of a path by tau."""
        equation, push = self.equation, np.sin(phase)
        z = equation.alpha - path.y * equation.sin
        force = self.least * push * np.cos(z) / equation.cos - np.sin(z) / equation.sin
        bound = self._rate(push, sin) * path.z + np.abs(push) / equation.cos
        return _LeastPath(path.v, force, path.w, bound)

    def _stepped(
        self, path: _LeastPath, phase: Array, step: Array, near: Array
    ) -> _LeastPath:
        """The path after a step of phase, by the Runge-Kutta method of order 4; near:
        True for |theta - alpha| <= alpha.
        """
        h, sin = step / self.omega, np.where(near, self.equation.sin, 1.0)

        def moved(slopes: _LeastPath, share: float) -> _LeastPath:
            return _LeastPath(
                *(x + share * h * dx for x, dx in zip(path, slopes, strict=True))
            )

        one = self._slopes(path, phase, sin)
        two = self._slopes(moved(one, 0.5), phase + 0.5 * step, sin)
        three = self._slopes(moved(two, 0.5), phase + 0.5 * step, sin)
        four = self._slopes(moved(three, 1.0), phase + step, sin)
        mean = _LeastPath(
            *(
                (a + 2.0 * (b + c) + d) / 6.0
                for a, b, c, d in zip(one, two, three, four, strict=True)
            )
        )
        return moved(mean, 1.0)

    def _distances(self, path: _LeastPath) -> _Distance:
        """How far all bodies of each stretch may be from its path."""
        return _Distance(
            *(
                1.01 * self.gap * bound + _ERROR * (1.0 + bound)
                for bound in (path.z, path.w)
            )
        )

    def _after_shaking(self, at: Array, end: _LeastPath, off: _Distance) -> Array:
        """The outcomes of the stretches `at`, which had no impact, from the end of the
        shaking on.
        """
        corners = [
            (end.y + up * off.y, end.v + right * off.v)
            for up in (-1.0, 1.0)
            for right in (-1.0, 1.0)
        ]
        free = [self._free(at, y, v) for y, v in corners]
        found = np.full(at.size, UNKNOWN, dtype=np.uint8)
        # A larger y or y' overturns too.
        found[free[0].overturns] = Outcome.OVERTURNED_NO_IMPACT

        # On one side of the equilibrium the energy is monotone in y.
        top = np.broadcast_to(self._top, self.side.shape)[at]
        back = (end.y + off.y <= 1.0) | ((end.y - off.y >= top) & (end.v + off.v < 0.0))
        for one in free:
            back &= ~one.overturns
        after = [one.overturns_after_impact for one in free]
        found[back & np.all(after, axis=0)] = Outcome.OVERTURNED_AFTER_IMPACT

        # Lemma 13: up to this amplitude none loses contact with the ground.
        kept = self.ends[1, at] <= self.system.safe_amplitude(self.motion)
        found[back & ~np.any(after, axis=0) & kept] = Outcome.ROCKED
        return found

    def _free(self, at: Array, y: Array, v: Array) -> FreeMotion:
        """The free motion of bodies of the stretches `at`."""
        zero, none = np.zeros(at.size), np.zeros(at.size, dtype=np.int32)
        lanes = Lanes(
            np.arange(at.size),
            self.largest[at],
            self.omega[at],
            self.eta[at],
            none,
            zero,
            self.side[at],
            y,
            v,
            zero,
            zero,
            none,
            none,
            np.zeros((4, at.size)),
        )
        return self.system.contact.free_motion(
            self.both, lanes, np.arange(at.size), y, v
        )


def _steps(omega: float) -> int:
    """The number of steps over half a cycle at this Omega, at least `_SLOWEST`."""
    return [n for least, n in _STEPS.items() if least <= omega][-1]


def proved_to(
    march: SharedMarch, which: Array, omega: Array, low: Array, high: Array
) -> Array:
    """The amplitude A of each row up to which nothing overturns or loses contact from
    `low` on, `low` itself without a proof, (rows,). which, omega, low, high: the
    structure of each row in the march, its Omega, and the ends of its amplitudes,
    (rows,) each.
    """
    reach, width = low * _ABOVE_UPLIFT, np.full(low.size, _FIRST_TRIED)
    begin = reach.copy()
    kept = march.kept_to[which], march.kept_while_low[which]
    tried = (reach < high) & march.supports(AmplitudeStretches.supports)[which]
    kinds = np.searchsorted(list(_STEPS), omega, side="right")
    kinds = np.stack([march.group[which], kinds])
    for kind in np.unique(kinds[:, tried & (kinds[1] > 0)], axis=1).T:
        going = np.flatnonzero(tried & (kinds == kind[:, None]).all(axis=0))
        while going.size:
            ends = np.array([reach[going], reach[going] + width[going]])
            ends[1] = np.minimum(ends[1], high[going])
            stretches = AmplitudeStretches(
                march.system_of(which[going]), march.motion, omega[going], ends
            )
            stands = stretches.cannot_overturn((kept[0][going], kept[1][going]))
            reach[going[stands]] = ends[1, stands]
            width[going] *= np.where(stands, 1.5, 0.5)
            going = going[(reach[going] < high[going]) & (width[going] >= _LEAST_TRIED)]
    return np.where(reach > begin, reach, low)


def outcomes_of_stretches(
    system: System, motion: Motion, omega: Array, ends: Array
) -> Array:
    """The outcome of every amplitude of each stretch, `UNKNOWN` without a proof,
    (stretches,). omega, ends: as of `AmplitudeStretches`.
    """
    found = np.full(omega.size, UNKNOWN, dtype=np.uint8)
    kinds = np.searchsorted(list(_STEPS), omega, side="right")  # 0: no proof is tried
    for kind in np.unique(kinds[kinds > 0]).tolist():
        at = np.flatnonzero(kinds == kind)
        found[at] = AmplitudeStretches(
            system, motion, omega[at], ends[:, at]
        ).outcomes()
    return found


def proved_outcomes(
    prove: Callable[[Array, Array], Array], row: Array, amplitude: Array
) -> tuple[Array, Array]:
    """(the outcome of each point, `UNKNOWN` without a proof; the first point of the
    stretch that proves it). row, amplitude: points in the order of rows and amplitudes,
    (points,); prove: function from rows and the ends of stretches to their outcomes.
    """
    label = np.full(row.size, UNKNOWN, dtype=np.uint8)
    first_of = np.arange(row.size)
    begins = np.flatnonzero(np.append(True, row[1:] != row[:-1]))
    ends = np.append(begins[1:], row.size)
    # Stretches of the widest kind; those without a proof are halved.
    begin = np.concatenate(
        [np.arange(a, b, _WIDEST) for a, b in zip(begins, ends, strict=True)]
    )
    last = np.repeat(ends, -(-(ends - begins) // _WIDEST))
    width = _WIDEST
    while width >= _NARROWEST and begin.size:
        end = np.minimum(begin + width, last)
        found = prove(row[begin], np.array([amplitude[begin], amplitude[end - 1]]))
        proved = found != UNKNOWN
        counts = (end - begin)[proved]
        points = np.repeat(begin[proved], counts)
        points = (
            points
            + np.arange(counts.sum())
            - np.repeat(np.cumsum(counts) - counts, counts)
        )
        label[points] = np.repeat(found[proved], counts)
        first_of[points] = np.repeat(begin[proved], counts)
        width //= 2
        begin, last = (
            np.append(begin[~proved], begin[~proved] + width),
            np.append(end[~proved], end[~proved]),
        )
        inside = begin < last
        begin, last = begin[inside], last[inside]
    return label, first_of
