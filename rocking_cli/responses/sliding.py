"""A body that slides and never rocks under a motion: its history, and its verdict
beside that of the same body on a base that does not slide.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..digits import digits_apart
from ..dynamics.outcome import LOST, Outcome
from ..dynamics.sliding import Base, Sliding, Slip
from ..errors import ArgumentError, UsageError
from ..motions import Motion
from ..motions.floors import on_floors
from ..motions.given import AnyMotion, demand_of
from ..motions.grid import Grid
from ..showing import Shown
from ..structures.friction import (
    Friction,
    covers_sliding,
    friction_that_slides,
    least_lambda,
)
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters
from .verdict import SLIDE_COLUMNS, SlideVerdict, Verdict

POINTS = 500  # times of a history over its whole length, unless the user says
MOST_POINTS = 10_000_000
COUPLED = (
    "slide{} while it rocks: this motion is not followed; the verdict is that of a base"
    " that does not slide"
)
NEAR = 2.0  # friction over lambda up to which sliding is known to change verdicts
CHANGED = (
    ", which with a friction up to 2 lambda was unsafe for 1 to 5 % of the bodies that"
    " stood in computations under records (rocking help base)"
)
ONE_WAY = (
    "slides one way and rocks the other: this is not covered; the verdict is that of a"
    " base that does not slide"
)


@dataclass(frozen=True, eq=False, repr=False)
class SlideHistory(Shown):
    """The sliding of one structure under one motion.

    Attributes
    ----------
    structure: the one that slides
    motion: the ground motion
    demand_a: a_g [m/s2]
    omega: omega_g [rad/s]
    friction: static and kinetic coefficient of its base [-]
    sliding: its slides, in phases

    Examples
    --------
    >>> (block,) = load_structures("block:0.5x2,friction=0.2")
    >>> found = slide_history(block, sine(), parse_grid("a_g=0.4g,f_g=1"))
    >>> found.outcome.flag, f"{found.slide_speed:.3f} m/s"
    ('slid', '0.428 m/s')
    """

    structure: RockingParameters  # the one that slides
    motion: Motion  # the ground motion
    demand_a: float  # a_g [m/s2]
    omega: float  # omega_g [rad/s]
    friction: Friction  # of its base
    sliding: Sliding  # its slides, in phases

    def _shown(self) -> dict[str, Any]:
        return {
            "structure": self.structure.name,
            "motion": self.motion.name,
            "demand_a": self.demand_a,
            "outcome": self.outcome.flag,
            "friction": self.friction.static,
            "slide_a": self.slide_a,
            "slide_max": self.slide_max,
            "slide_residual": self.slide_residual,
            "slide_speed": self.slide_speed,
        }

    def _rows(self) -> Iterable[Mapping[str, Any]]:
        return self.rows()

    @property
    def outcome(self) -> Outcome:
        """Slid, no uplift for a body that sticks, or lost contact."""
        return self.sliding.outcome

    @property
    def slide_a(self) -> float:
        """mu_s g, the ground acceleration from which it slides [m/s2]."""
        return self.friction.static * self.structure.gravity

    @property
    def slide_max(self) -> float:
        """Largest displacement over the ground [m]."""
        return self.sliding.largest * self._length

    @property
    def slide_residual(self) -> float:
        """Displacement over the ground at the end [m], positive with +x_g."""
        return self.sliding.residual * self._length

    @property
    def slide_speed(self) -> float:
        """Largest speed over the ground [m/s]."""
        return self.sliding.speed * self.demand_a / self.omega

    @property
    def lost_at(self) -> float | None:
        """The time at which the ground falls away [s], None if it never does."""
        lost = self.sliding.lost
        return lost / self.omega if math.isfinite(lost) else None

    @property
    def _length(self) -> float:
        return self.demand_a / self.omega**2

    @cached_property
    def end(self) -> float:
        """The time [s] at which the motion is over and the body rests, or at which the
        ground falls away.
        """
        if self.lost_at is not None:
            return self.lost_at
        stops = [one.stop for one in self.sliding.slides[-1:]]
        return (
            max(self.motion.duration, *stops) / self.omega
            if stops
            else (self.motion.duration / self.omega)
        )

    def times(
        self, dt: float | None, steps: bool, duration: float | None
    ) -> np.ndarray:
        """Return the times of the rows [s].

        Parameters
        ----------
        dt
            time between two rows [s]; None for the samples of a record with the starts
            and stops, or the ends of POINTS equal intervals for a pulse
        steps
            True for the starts and stops of the slides alone
        duration
            the time that is shown [s], None for the motion and the last slide

        Returns
        -------
        ndarray
            (n,)

        Raises
        ------
        UsageError
            for too many rows
        """
        end = self.end if duration is None or self.lost_at is not None else duration
        if duration is not None:
            end = min(end, duration)
        if dt is not None:
            if not end / dt <= MOST_POINTS:
                raise UsageError(
                    f"`dt`: found {dt:g} s; expected a time that gives up to"
                    f" {MOST_POINTS} points"
                )
            return dt * np.arange(math.floor(end / dt * (1.0 + 1e-12)) + 1)
        slides = self.sliding.slides
        marks = np.array([x for s in slides for x in (s.start, s.stop)]) / self.omega
        if self.motion.acceleration is not None and not steps:
            marks = np.concatenate([marks, self.motion.marks / self.omega])
        elif not steps:
            return np.linspace(0.0, end, POINTS + 1)
        times = np.unique(np.concatenate([[0.0], marks]))
        return np.append(times[times < end], end)

    def rows(
        self,
        *,
        dt: float | None = None,
        steps: bool = False,
        duration: float | None = None,
        forces: bool = False,
    ) -> Iterator[dict[str, Any]]:
        """Yield a row for each time: t [s], slide [m], slide_velocity [m/s],
        ground_acceleration [m/s2], and what is the same in all rows: names, outcome,
        a_g [m/s2], omega_g [rad/s] of a pulse, friction [-].

        Parameters
        ----------
        dt
            as of `times`
        steps
            as of `times`
        duration
            as of `times`
        forces
            True for those on the ground over m g as well

        Yields
        ------
        dict
        """
        times = self.times(dt, steps, duration)
        phase = times * self.omega
        u, v = self.sliding.course(phase)
        ground = self.demand_a * self.motion.value(phase)
        weight = np.ones(times.shape)
        if self.motion.vertical is not None:
            up = self.demand_a * self.motion.vertical.value(phase)
            weight += up / self.structure.gravity
        kinetic = -np.sign(v) * self.friction.kinetic * weight
        most = self.friction.static * weight  # also in the instant of a start
        held = np.clip(ground / self.structure.gravity, -most, most)
        across = np.where(v == 0.0, held, kinetic)
        pulse = self.motion.acceleration is None
        named = {
            "structure": self.structure.name,
            "motion": self.motion.name,
            "model": "sliding",
            "outcome": self.outcome.flag,
            "a_g": self.demand_a,
            "omega_g": self.omega if pulse else None,
            "friction": self.friction.static,
        }
        columns = [times, u * self._length, v * self.demand_a / self.omega, ground]
        for t, slide, speed, a, fx, fz in zip(*columns, across, weight, strict=True):
            yield {
                "t": float(t),
                "slide": float(slide),
                "slide_velocity": float(speed) + 0.0,  # no negative zero
                **({"fx_ratio": float(fx), "fz_ratio": float(fz)} if forces else {}),
                "ground_acceleration": float(a),
                **named,
            }

    def events(self) -> Iterator[dict[str, Any]]:
        """Yield a row for each start and stop of a slide, and for the loss of contact:
        t [s], slide [m].
        """
        for one in self.sliding.slides:
            yield self._event("slide", one.start, one.begins, one)
            if one.stop < self.sliding.lost:
                yield self._event("stop", one.stop, one.ends, one)
        if self.lost_at is not None:
            yield self._event(LOST, self.sliding.lost, self.sliding.residual, None)

    def _event(
        self, word: str, phase: float, u: float, one: Slip | None
    ) -> dict[str, Any]:
        speed = None if one is None else one.side * self.sliding.speed_of(one)
        return {
            "model": "sliding",
            "event": word,
            "t": phase / self.omega,
            "slide": u * self._length,
            "slide_velocity_max": (
                None if speed is None else speed * self.demand_a / self.omega
            ),
        }

    def summary(self) -> dict[str, Any]:
        """Return the last row of the events: the largest values and the outcome."""
        return {
            "model": "sliding",
            "event": "summary",
            "demand_a": self.demand_a,
            **{key: getattr(self, key) for key in SLIDE_COLUMNS[:4]},
            "fz_min": self.sliding.least_weight,
            "theta_ratio": None if self.lost_at is not None else 0.0,
            "outcome": self.outcome.flag,
        }

    @property
    def words(self) -> str:
        """What it does, and why it does not overturn, in words."""
        least = least_lambda(self.structure)
        digits = digits_apart(self.friction.static, least, 4)
        start = (
            f"from {self.friction.static:.{digits}g} g on, before it could rock (lambda"
            f" {least:.{digits}g})"
        )
        if self.slide_max > 0.0:
            said = f"slides {start}: {1e3 * self.slide_max:.3g} mm at most"
            said += f", {_at_the_end(self.slide_residual)}"
        else:
            said = f"sticks under this motion; it slides {start}"
        if self.lost_at is not None:
            return (
                f"{said}; the ground falls away at {self.lost_at:.2f} s; what follows"
                " is not followed"
            )
        return (
            f"{said}. It cannot overturn while its friction stays below"
            f" {least:.{digits}g}"
        )


def _at_the_end(residual: float) -> str:
    """Return where a body stands at the end of its slides, in words."""
    if abs(residual) < 5e-7:
        return "back in its place at the end"
    side = "left" if residual < 0.0 else "right"
    return f"{1e3 * abs(residual):.3g} mm to the {side} at the end"


def slide_history(
    structure: Structure,
    motion: AnyMotion,
    shaking: Grid | str | None = None,
) -> SlideHistory | None:
    """Return the sliding of a structure whose friction keeps it from rocking, None for
    another structure.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2,friction=0.2", of
        a rigid body on two edges; it slides and never rocks if its static friction is
        below lambda of each edge, of a stack of each interface
    motion
        the motion of the ground with its vertical one: an object, the name of a pulse,
        or a path
    shaking
        a grid of one cell or its text; a record does not need it

    Returns
    -------
    SlideHistory or None
        displacements [m], speeds [m/s] and the outcome; its rows and events

    Raises
    ------
    UsageError
        without a demand of one cell, and for an amplitude of zero

    Examples
    --------
    >>> (block,) = load_structures('block:0.5x2,friction=0.2')
    >>> found = slide_history(block, sine(), parse_grid('a_g=0.4g,f_g=1'))
    >>> round(found.slide_max, 6), round(found.slide_residual, 6)
    (0.125812, 0.006298)
    """
    body = structure_from(structure)
    ((structure, moved, grid),) = on_floors([(body, *demand_of(motion, shaking))])
    friction = friction_that_slides(structure)
    if friction is None:
        return None
    amplitude, omega = grid.cell(structure)
    a_g = float(structure.ground_acceleration(amplitude))
    if not a_g > 0.0:
        raise UsageError("the amplitude is 0; expected a positive one")
    sliding = Base(moved, friction).under(structure.gravity / a_g)
    pace = omega * structure.p
    return SlideHistory(structure, moved, a_g, pace, friction, sliding)


def with_sliding(
    verdict: Verdict,
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
) -> Verdict:
    """Return the verdict on a body whose friction its document states. A body that
    slides and never rocks gets its sliding, and `verdict` stands beside it.
    """
    found = slide_history(structure, motion, shaking)
    if found is None:
        rocks = verdict.outcome != Outcome.NO_UPLIFT
        said = coupling_of(structure, verdict.slides) if rocks else ""
        return replace(verdict, coupling=said)
    first = verdict.first_overturning_a
    stuck = f"rocks: it {verdict.outcome.sentence}"
    if verdict.outcome == Outcome.NO_UPLIFT:
        stuck = "does not lift under this motion"
    if first is not None:
        stuck += f" (first_overturning_a {first / structure.gravity:.3g} g)"
    own = SlideVerdict(
        found.slide_a,
        found.slide_max,
        found.slide_residual,
        found.slide_speed,
        verdict.outcome,
        first,
        f"{found.words}. With more friction it {stuck}",
    )
    lost = found.lost_at is not None
    return replace(
        verdict,
        outcome=found.outcome,
        outcome_linear=found.outcome,
        theta_ratio=None if lost else 0.0,
        top_displacement=None if lost else found.slide_max,
        uplift_a=None,
        first_overturning_a=None,
        safe_to=None,
        searched_to=None,
        fz_min=found.sliding.least_weight,
        unsettled=False,
        share_of_falls=0.0,
        slides=False,
        slide=own,
    )


def coupling_of(structure: RockingParameters, slides: bool) -> str:
    """Return the words on a body that rocks and may slide meanwhile; slides: as of
    `Verdict`. Empty for one that does not, and for one whose sliding is not covered at
    all.
    """
    if structure.friction is None or not covers_sliding(structure):
        return ""
    uplift = max(side.uplift for side in structure.edges)
    if slides and structure.friction < uplift:
        return ONE_WAY
    near = structure.friction <= NEAR * uplift
    said = COUPLED.format("s") if slides else "may " + COUPLED.format("")
    return (said + CHANGED * near) * (slides or near)


def parse_slide(place: str, text: str, wanted: str) -> float:
    """Return the length of a text such as `slide=50mm` [m], positive; place, wanted:
    the option and what it takes, in words. Raises UsageError.
    """
    from ..documents.quantities import parse_quantity, split_quantity

    word, _, length = (part.strip() for part in text.partition("="))
    parts = split_quantity(length)
    try:
        value = parse_quantity(length, "length")
    except ArgumentError:
        value = 0.0
    if word != "slide" or not value > 0.0 or parts is None or not parts[1]:
        raise UsageError(
            f"{place}: found {text!r}; expected {wanted}, a positive length with its"
            " unit, such as slide=50mm"
        )
    return value
