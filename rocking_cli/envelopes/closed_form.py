"""Overturning curves of a linear block under a sine pulse, in closed form (Fig. 2 left,
curves i-iv).

Scalar, with SciPy's root finder. It shares no code with the engine, which traces the
same boundaries from its outcomes. With psi = arcsin(1/A) and T = (2 pi - psi)/Omega the
state at the end of one cycle without an impact is

    x_e = 1 - W cosh T + S sinh T,   v_e = -W sinh T + S cosh T - A Omega/(1 + Omega^2)
    W = Omega^2/(1 + Omega^2),       S = Omega sqrt(A^2 - 1)/(1 + Omega^2)
"""

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..errors import ArgumentError
from ..showing import html_table

# amplitudes at which the margin's sign is computed, between initiation and the
# no-impact curve
_SCAN = 600


class CurvePoint(NamedTuple):
    """One point of a curve of Fig. 2 (left), as `closed_form_curves` returns it.

    Attributes
    ----------
    curve: name of the curve
    omega: Omega [-]
    amplitude: A [-]

    Examples
    --------
    >>> point = closed_form_curves([3.0], 0.9)[1]
    >>> point.curve, f"{float(point.amplitude):.5f}"
    ('no_impact', '3.63115')
    """

    curve: str  # name of the curve
    omega: float  # Omega [-]
    amplitude: float  # A [-]

    def _repr_html_(self) -> str:
        return html_table("CurvePoint", self._asdict())


# one cycle, half a cycle, and a constant for t_d = 2 pi/omega_g
PULSES = (
    "sine",
    "half-sine",
    "rectangular",
)


def no_impact_amplitude(omega: float, pulse: str = "sine") -> float:
    """A from which a body overturns without impact under one of PULSES.

    sine: sqrt(A^2-1) - Omega - A exp(-T) = 0; half-sine: sqrt(A^2-1) - Omega + A
    exp(-(pi-psi)/Omega) = 0; rectangular: A = 1/(1 - exp(-p t_d)). Raises ArgumentError
    for another pulse.
    """
    if pulse not in PULSES:
        raise ArgumentError(
            f"found pulse {pulse!r}; expected one of {', '.join(PULSES)}"
        )
    if pulse == "rectangular":
        return -1.0 / math.expm1(-2.0 * math.pi / omega)
    sign, end = (-1.0, 2.0 * math.pi) if pulse == "sine" else (1.0, math.pi)

    def margin(a: float) -> float:
        decay = math.exp(-(end - math.asin(1.0 / a)) / omega)
        return math.sqrt((a - 1.0) * (a + 1.0)) - omega + sign * a * decay

    # Enlarge the bracket until the margin is positive: then A overturns.
    high = 2.0 + omega
    while margin(high) <= 0.0:
        high *= 2.0
    return (
        float(brentq(margin, 1.0, high, xtol=1e-15, rtol=8.9e-16, maxiter=500))
        if margin(1.0) < 0.0
        else 1.0
    )


class _FirstSide:
    """The motion of the block on the side of the first uplift; tau = 0 at uplift, q sin
    is the particular solution. It takes a float with `math`, or an array of amplitudes
    with `numpy`.
    """

    def __init__(self, amplitude: Any, omega: float, library: Any = math) -> None:
        a, w, self.library = amplitude, omega, library
        self.amplitude, self.omega = a, w
        self.psi: Any = math.asin(1.0 / a) if library is math else np.arcsin(1.0 / a)
        self.duration: Any = (2.0 * math.pi - self.psi) / w
        # time from which the drive is below 1, so that the body cannot rise again
        self.below: Any = (math.pi - 2.0 * self.psi) / w
        self.big = w**2 / (1.0 + w**2)
        self.s = w * library.sqrt((a - 1.0) * (a + 1.0)) / (1.0 + w**2)
        self.q = a / (1.0 + w**2)

    def place(self, t: Any) -> Any:
        """The rotation x at tau = t."""
        m = self.library
        return (
            1.0
            - self.big * m.cosh(t)
            + self.s * m.sinh(t)
            - self.q * m.sin(self.psi + self.omega * t)
        )

    def speed(self, t: Any) -> Any:
        """x' at tau = t."""
        m = self.library
        return (
            -self.big * m.sinh(t)
            + self.s * m.cosh(t)
            - self.q * self.omega * m.cos(self.psi + self.omega * t)
        )

    def impact(self) -> float | None:
        """Time of the impact inside the pulse, None if there is none; NaN if the motion
        is below rounding.
        """
        # Where the drive is below 1, y'' < 0 below the ground: the body comes down
        # once at most.
        if self.place(self.duration) > 0.0:
            return None
        if self.place(self.below) <= 0.0:
            return math.nan
        return float(
            brentq(
                self.place,
                self.below,
                self.duration,
                xtol=1e-15,
                rtol=8.9e-16,
                maxiter=500,
            )
        )

    def energy_left(self) -> Any:
        """The energy 1 + v_e^2 - (1 - x_e)^2 at the end of the pulse."""
        return (
            1.0
            + self.speed(self.duration) ** 2
            - (1.0 - self.place(self.duration)) ** 2
        )

    def margin_inside(self, at: Any, eta: float) -> Any:
        """The unstable mode x - 1 + v at the end of the pulse after an impact at time
        `at`: x'' = x - 1 - A sin(phase + Omega t).
        """
        m, w = self.library, self.omega
        rest, phase = self.duration - at, self.psi + w * at
        drive = (
            self.amplitude
            * (w * m.cos(phase) + m.sin(phase) - w * m.exp(-rest))
            / (1.0 + w**2)
        )
        return m.exp(rest) * (-eta * self.speed(at) - 1.0 - drive)


def after_impact_margin(amplitude: float, omega: float, eta: float) -> float:
    """The unstable mode after one impact under a one-cycle sine; positive if the body
    overturns.

    Impact after the pulse: eta sqrt(1 + v_e^2 - (1 - x_e)^2) - 1, on still ground;
    inside the pulse: x - 1 + v at its end.
    """
    first = _FirstSide(amplitude, omega)
    at = first.impact()
    if at is None:
        return eta * math.sqrt(max(0.0, first.energy_left())) - 1.0
    # so close to A = 1 the body does not overturn
    return -1.0 if math.isnan(at) else float(first.margin_inside(at, eta))


def _overturns(amplitude: np.ndarray, omega: float, eta: float) -> np.ndarray:
    """True where `after_impact_margin` is positive, (amplitudes,); impact times are
    bisected.
    """
    first = _FirstSide(amplitude, omega, np)
    low, high = first.below, first.duration
    for _ in range(50):
        middle = 0.5 * (low + high)
        above = first.place(middle) > 0.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    inside = (first.place(first.below) > 0.0) & (first.margin_inside(high, eta) > 0.0)
    return np.where(
        first.place(first.duration) > 0.0, eta**2 * first.energy_left() > 1.0, inside
    )


def peak_after_impact(amplitude: float, omega: float, eta: float) -> float:
    """theta_max/alpha after the first impact of a linear block under a one-cycle sine
    (Eq. 2.7); NaN if it overturns then.

    Exact if the impact follows the pulse: D0* = (1 - x_e)^2 - v_e^2 is the energy at
    the end of the pulse.
    """
    first = _FirstSide(amplitude, omega)
    left = 1.0 - eta**2 * first.energy_left()
    return 1.0 - math.sqrt(left) if 0.0 <= left <= 1.0 else math.nan


def _single_impact(amplitude: float, omega: float, eta: float) -> bool:
    """True if the body has no second impact until the pulse ends; otherwise the curve
    does not exist.
    """
    first = _FirstSide(amplitude, omega)
    at = first.impact()
    if at is None:
        return True
    # The motion on the other side from the impact on, with the restitution of Eq. 2.6:
    # the drive has changed its sign there.
    t = np.linspace(0.0, first.duration - at, 4001)[1:]
    phase = first.psi + omega * at
    q = amplitude / (1.0 + omega**2)
    speed = -eta * first.speed(at)
    sine, cosine = q * math.sin(phase), q * omega * math.cos(phase)
    x = (
        1.0
        + (-1.0 - sine) * np.cosh(t)
        + (speed - cosine) * np.sinh(t)
        + q * np.sin(phase + omega * t)
    )
    return bool(np.all(x > 0.0))


def after_impact_amplitudes(omega: float, eta: float) -> list[float]:
    """The amplitudes, rising, at which overturning after exactly one impact begins and
    ends below the no-impact curve.

    Roots at which the body comes down again before the pulse ends are left out. At low
    Omega overturning after two or more impacts begins below these curves; the traced
    envelope shows it.
    """
    top = no_impact_amplitude(omega)
    if top <= 1.0:
        return []
    span = 1.0 + (top - 1.0) * np.linspace(1e-9, 1.0, _SCAN)
    # The scalar functions compute the last one: without loss at impacts the margin is 0
    # there, and rounding decides.
    signs = np.append(
        _overturns(span[:-1], omega, eta),
        after_impact_margin(float(span[-1]), omega, eta) > 0.0,
    )
    roots = [
        float(
            brentq(
                after_impact_margin,
                a,
                b,
                args=(omega, eta),
                xtol=1e-15,
                rtol=8.9e-16,
                maxiter=500,
            )
        )
        for a, b, before, after in zip(
            span[:-1], span[1:], signs[:-1], signs[1:], strict=True
        )
        if before != after
    ]
    return [a for a in roots if _single_impact(a, omega, eta)]


def closed_form_curves(
    omegas: np.ndarray, eta: float, pulse: str = "sine"
) -> list[CurvePoint]:
    """Return the curves of Fig. 2 (left), from closed forms (Eq. 2.7).

    They are the amplitude of uplift, and those that bound overturning without and after
    an impact. Only the sine has more than the first two curves.

    Parameters
    ----------
    omegas
        Omega of the points [-], (points,)
    eta
        restitution [-], from 0 to 1
    pulse
        "sine" (one cycle), "half-sine", or "rectangular" (constant for 2 pi/omega_g)

    Returns
    -------
    list of CurvePoint
        sorted by curve; a curve has no point where it has no root

    Raises
    ------
    ArgumentError
        when there is no closed form for this pulse, or an omega is not positive

    Notes
    -----
    Undamped linear oscillators with two equal edges (Eq. 2.4). `trace_envelope` finds
    the same boundaries for every structure and motion.

    Examples
    --------
    >>> for point in closed_form_curves([3.0], 0.9):
    ...     print(point.curve, f"{float(point.amplitude):.5f}")
    initiation 1.00000
    no_impact 3.63115
    after_impact_lower 1.40357
    after_impact_upper 3.48466
    """
    if not 0.0 <= eta <= 1.0:
        raise ArgumentError(f"`eta`: found {eta:g}; expected a number from 0 to 1")
    frequencies = [float(omega) for omega in np.ravel(omegas)]
    if not all(0.0 < omega < math.inf for omega in frequencies):
        raise ArgumentError(
            "found omegas that are not positive and finite; expected positive numbers"
        )
    rows = [
        (
            omega,
            no_impact_amplitude(omega, pulse),
            after_impact_amplitudes(omega, eta) if pulse == "sine" else [],
        )
        for omega in frequencies
    ]
    return [
        *(CurvePoint("initiation", omega, 1.0) for omega, _, _ in rows),
        *(CurvePoint("no_impact", omega, a) for omega, a, _ in rows),
        *(
            CurvePoint("after_impact_lower", omega, roots[0])
            for omega, _, roots in rows
            if roots
        ),
        *(
            CurvePoint("after_impact_upper", omega, roots[1])
            for omega, _, roots in rows
            if len(roots) > 1
        ),
    ]
