"""The motion of tied bodies while every restraint stays on one branch of its force law:
its Taylor series and its first turn.

With y = theta/sin(alpha) on the present side (the linear equation has no devices but
springs, which add a constant and a stiffness),

    y'' = -w l(y) + a m(y) - M(theta)/(m g R sin(alpha))

where l and m are those of the free body, w is the weight over m g and M the moment of
the devices.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Self

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..batch import cannot_return, inward_to_come
from ..condition import STEP
from ..drive import drive_change
from ..equations import taylor
from ..equations.equation import Equation
from ..equations.recurrence import Series, product_term, product_terms
from ..equations.rigid_body import RigidBodyEquation
from ..equations.straight_lines import growth_rate, line_flow
from ..equations.taylor import Instant, TaylorSeries
from ..lanes import Lanes
from ..march.one_turn import error_of, one_turn_step
from ..march.roots import fall_guess, only_root
from .devices import Branch, Devices
from .pulls import Pull

NewSeries = Callable[[], Series]  # returns an empty series


class Step(NamedTuple):
    """A step with at most one turn. Every array is (lanes,)."""

    arc: TaylorSeries  # the motion from its start
    h: Array  # length of the step [tau]
    end: Instant  # the state at its end
    # direction of the motion at its start: 1 outwards, -1 inwards, 0 for bodies that do
    # not move
    outward: Array
    turn: Array  # time from the start at which y' = 0 [tau], NaN without a turn
    fastest: Array  # bound of |y'| in the step
    largest_acceleration: Array  # bound of |y''| in the step
    error: Array  # bound of the error of y' that the step adds


class Law:
    """The equation of motion of tied bodies; of_lines: True if series shall go along
    the straight lines of a record.
    """

    def __init__(
        self, equation: Equation, devices: Devices, of_lines: bool = False
    ) -> None:
        self.equation, self.devices, self.of_lines = equation, devices, of_lines
        self.tolerance = equation.tolerance  # tolerance of y
        self.order = taylor.order_for(equation.tolerance)

    def force(
        self,
        lanes: Lanes,
        row: Array,
        now: Branch,
        a: Array,
        weight: Array | float,
    ) -> Array:
        """y'' of lanes under the outward drive a and the weight over m g, without
        damping, (lanes,).
        """
        free = self.equation.on(lanes.side, lanes.cell).force(lanes.y, a, weight)
        return free - self.devices.pull_on(row, now).at(lanes.y)

    def force_now(
        self, segments: Segments, lanes: Lanes, row: Array, now: Branch
    ) -> Array:
        """`force` of lanes at their present position."""
        side, k, u = lanes.side, lanes.segment, lanes.phase
        s = segments.s_start[k] + drive_change(segments, k, u)
        weight = segments.weight(side, lanes.amplitude, k, u)
        drive = -side * lanes.amplitude * s
        return self.force(lanes, row, now, drive, weight)

    def cannot_return(
        self, segments: Segments, lanes: Lanes, row: Array, now: Branch
    ) -> Array:
        """True for lanes that no later drive can turn back while their devices keep
        their branches `now`, the last ones (Lemma 6).
        """
        if not self.devices.linear:
            # the lemma of the free body, if no device pulls any more
            free = ~(now.fixed.any(axis=0) | now.rate.any(axis=0))
            return free & cannot_return(segments, self.equation, lanes)
        # The devices are too soft for y'' to fall as y grows. It is positive under the
        # strongest inward drive and the least weight.
        side, weight = lanes.side, np.ones(lanes.side.size)
        if segments.weighed is not None:
            k = np.minimum(lanes.segment, len(segments) - 1)
            weight = segments.weighed.least_weight(side, lanes.amplitude, k)
        soft = self.devices.linear_terms(row, now)[1] <= weight
        drive = -inward_to_come(segments, lanes) * weight
        force = self.force(lanes, row, now, drive, weight)
        return soft & (force > 0.0)

    def flow(
        self, segments: Segments, lanes: Lanes, row: Array, now: Branch, exact: Array
    ) -> TaylorSeries:
        """The series of lanes from their present state; exact: True where y'' is
        exactly 0 now.
        """
        equation = self.equation.on(lanes.side, lanes.cell)
        held = HeldBody.of(equation, self.devices, row, now)
        lanes = Lanes.joined([lanes])
        force = self.force_now(segments, lanes, row, now)
        lanes.force = np.where(exact, 0.0, force)
        stiffness = self.devices.linear_terms(row, now)[1]
        if self.of_lines:
            return line_flow(held, segments, lanes, growth_rate(stiffness))
        rate = 1.0 + np.sqrt(stiffness)
        terms, fastest = taylor.series_flow(held, segments, lanes, self.order, rate)
        step = taylor.longest(terms, fastest, self.tolerance)
        return TaylorSeries(terms, 1.0 / fastest, step, equation.damping)


class LinearMoment(NamedTuple):
    """What restraints on their branches take from y'' in the linear equation: constant
    + stiffness y. Floats or arrays, (lanes,).
    """

    constant: Any  # [-]
    stiffness: Any  # [-]

    def along(
        self, y: Series, _free: Series, _push: Series | None, _new: NewSeries
    ) -> Callable[[int], Any]:
        """Return a function that returns term n of what is taken along a motion.

        y: terms of the motion; _free, _push: of l and m; _new: returns an empty series.
        The function is called for n = 0, 1 ..., in this order.
        """
        constant, stiffness = self
        return lambda n: stiffness * y[n] if n else constant + stiffness * y[0]

    def at(self, y: Any) -> Any:
        """What is taken from y'' at y."""
        return self.constant + self.stiffness * y

    def slope(self, y: Any) -> Any:
        """Its derivative by y."""
        return self.stiffness


class CircularMoment(NamedTuple):
    """What restraints on their branches take from y'' of a rigid body. Floats or
    arrays, (lanes,).

    It is a sum of cos theta, sin theta, cos 2 theta, sin 2 theta, cos(theta/2): those
    of theta follow from l and m of the free body, the second harmonics are rho cos(2
    theta - 2 phi) = rho (2 u^2 - 1) with u = cos(theta - phi). Under stiff devices
    this is a difference of large numbers: its term 0 is the pull itself.
    """

    pull: Pull  # of the devices
    by_free: Any  # coefficient of l
    by_push: Any  # coefficient of m
    rho: Any  # size of the second harmonics
    u_by_free: Any  # u = u_by_free l + u_by_push m
    u_by_push: Any
    # sin(alpha), coefficients of cos(theta/2) and sin(theta/2); None without a tendon
    half: tuple[Any, Any, Any] | None

    @classmethod
    def of(cls, equation: Equation, devices: Devices, row: Array, now: Branch) -> Self:
        """Return the moment of devices on these branches."""
        assert isinstance(equation, RigidBodyEquation)
        of_cos, of_sin, of_cos2, of_sin2, *of_half = -devices.circular_terms(row, now)
        sin, cos = equation.sin, equation.cos
        rho, phi = np.hypot(of_cos2, of_sin2), 0.5 * np.arctan2(of_sin2, of_cos2)

        def by_free_and_push(by_cos: Array, by_sin: Array) -> tuple[Array, Array]:
            # cos theta = sin^2 l + cos^2 m, sin theta = sin cos (m - l), with sin and
            # cos of alpha
            return (
                sin * (sin * by_cos - cos * by_sin),
                cos * (cos * by_cos + sin * by_sin),
            )

        return cls(
            devices.pull_on(row, now),
            *by_free_and_push(of_cos, of_sin),
            rho,
            *by_free_and_push(np.cos(phi), np.sin(phi)),
            (sin + 0.0 * rho, *of_half) if of_half else None,
        )

    def along(
        self, y: Series, free: Series, push: Series | None, new: NewSeries
    ) -> Callable[[int], Any]:
        """As `LinearMoment.along`."""
        assert push is not None
        _, by_free, by_push, rho, u_by_free, u_by_push, _ = self
        stretched, turned, twice = np.any(rho), new(), 2.0 * rho
        half = None if self.half is None else self._half_angle(y, new)

        def pulled(n: int) -> Any:
            if stretched:
                turned.append(u_by_free * free[n] + u_by_push * push[n])
            by_cos, by_sin = (0.0, 0.0) if half is None else half(n)
            if not n:
                return self.pull.at(y[0])
            own = by_free * free[n] + by_push * push[n]
            if stretched:
                own = own + twice * product_term(turned, turned)
            if half is not None:
                own = own + by_cos + by_sin
            return own

        return pulled

    def at(self, y: Any) -> Any:
        """As `LinearMoment.at`."""
        return self.pull.at(y)

    def slope(self, y: Any) -> Any:
        """As `LinearMoment.slope`."""
        return (self.pull.at(y + STEP) - self.pull.at(y)) / STEP

    def _half_angle(
        self, y: Series, new: NewSeries
    ) -> Callable[[int], tuple[Any, Any]]:
        """Return a function of n that returns terms n of of_cos cos(theta/2) and of_sin
        sin(theta/2), called for n = 0, 1 ... in this order.
        """
        assert self.half is not None
        sin, of_cos, of_sin = self.half
        half_cos, half_sin, rate = new(), new(), new()
        functions = math if isinstance(y[0], float) else np
        half_cos.append(functions.cos(0.5 * sin * y[0]))
        half_sin.append(functions.sin(0.5 * sin * y[0]))

        def terms(n: int) -> tuple[Any, Any]:
            if n:
                # The derivatives of cos and sin of theta/2, by its rate.
                rate.append(0.5 * n * sin * y[n])
                by_sin, by_cos = product_terms(rate, half_sin, half_cos)
                half_cos.append(by_sin / -n)
                half_sin.append(by_cos / n)
            return of_cos * half_cos[n], of_sin * half_sin[n]

        return terms


class HeldBody:
    """The equation of lanes, or of one body on floats, while their restraints keep
    their branches: that of the free body, and the moment of its devices.
    """

    composed = None  # as of `Equation`

    def __init__(
        self, equation: Equation, moment: LinearMoment | CircularMoment
    ) -> None:
        self.equation = equation
        self.moment = moment  # of the devices
        self.damping, self.damped = equation.damping, equation.damped
        self.tolerance = equation.tolerance
        self.error_unit = equation.error_unit
        self.gain = equation.gain

    def slope(self, y: Any, force: Any) -> Any:
        """df/dy at displacement y, under the drive that gives this force f."""
        return self.equation.slope(y, force + self.moment.at(y)) - self.moment.slope(y)

    @classmethod
    def of(cls, equation: Equation, devices: Devices, row: Array, now: Branch) -> Self:
        """Return the equation of lanes; row: row of the devices of each lane, (lanes,);
        now: branch of each device of each lane.
        """
        if devices.linear:
            return cls(equation, LinearMoment(*devices.linear_terms(row, now)))
        return cls(equation, CircularMoment.of(equation, devices, row, now))

    def part(self, lanes: slice) -> HeldBody:
        """Return the equation of some of the lanes."""
        moment = changed(self.moment, lambda x: x[lanes])
        return HeldBody(self.equation.part(lanes), moment)

    def of_first(self, equation: Equation) -> HeldBody:
        """Return the equation of the first lane on floats; equation: that of its free
        body on floats.
        """
        return HeldBody(equation, changed(self.moment, lambda x: float(x[0])))

    def along(
        self, y: Series, new: NewSeries
    ) -> tuple[Series, Series | None, Callable[[int], None]]:
        """As `Equation.along`."""
        return self.equation.along(y, new)

    def held(
        self, y: Series, lift: Series, push: Series | None, new: NewSeries
    ) -> Callable[[int], Any]:
        """As of `Recurrence`."""
        return self.moment.along(y, lift, push, new)


def changed(numbers: Any, change: Callable[[Array], Any]) -> Any:
    """Return numbers, a tuple of tuples, with each array in them changed."""
    if isinstance(numbers, np.ndarray):
        return change(numbers)
    if not isinstance(numbers, tuple):
        return numbers
    parts = [changed(x, change) for x in numbers]
    return type(numbers)(*parts) if hasattr(numbers, "_fields") else tuple(parts)


def one_turn(arc: TaylorSeries, left: Array) -> Step:
    """The longest step of lanes, at most `left` [tau], that ends before the second turn
    of their series.
    """
    h, terms, turns = one_turn_step(arc, left)
    outward = np.where(turns.outward, 1.0, -1.0)
    outward[turns.fastest == 0.0] = 0.0
    turn, at = np.full(h.size, np.nan), np.flatnonzero(turns.turns)
    if at.size:
        # the turn is the root of the series of y', with the sign that makes it fall
        own = terms.take(at, axis=1) * outward[at]
        turn[at] = h[at] * only_root(own, turns.guess[at], speed=True)[0]
    return Step(
        arc,
        h,
        arc.point(terms, h),
        outward,
        turn,
        turns.fastest / h,
        turns.largest_acceleration / (h * h),
        error_of(arc, terms, h),
    )


def falls(arc: TaylorSeries, low: Array, high: Array) -> tuple[Array, Array]:
    """(h, y' at h) where series fall through zero; there is one such h between `low`
    and `high`.
    """
    terms = arc.over(high)
    s, _, speed, _ = only_root(terms, *fall_guess(terms, low / high), speed=False)
    return s * high, np.minimum(0.0, speed / high)
