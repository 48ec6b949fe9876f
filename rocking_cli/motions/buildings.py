"""Floors of linear buildings: the motion of a floor in place of that of the ground.

    a = x_g'' + sum_k gamma_psi_k u_k'',   u'' + 2 xi w u' + w^2 u = -x_g''

The rest 1 - sum gamma_psi moves with the ground (missing mass). With
z = u' - conj(s) u, s = w (-xi + i sqrt(1 - xi^2)), it is z' = s z - x_g'', which has an
exact recurrence under straight lines (response_spectra.py) and under sinusoids.

Inside a step of a straight line u'' is a free vibration e^(-xi w t) (C cos w_d t + S
sin w_d t), because the forced part of u is linear: C = u'' at its start, S = (u''' + xi
w C)/w_d. So a straight line between the values at the ends of a step misses at most
h^2/8 sum |gamma_psi| w^2 max sqrt(C^2 + S^2); a sinusoid adds its own share. The steps
are cut until that is 1e-3 of the largest acceleration of the floor. After the motion
the building vibrates freely, until 1e-3 of that acceleration is left. The vertical
motion of the ground is not filtered.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import UsageError
from ..structures.building_modes import ONE_EACH, FloorMode, parse_mode, repeated
from .blocks import largest
from .given import AnyMotion, motion_from
from .motion import Floor, Motion, Piece, upwards
from .polyline import Polyline
from .response_spectra import gain, rise

if TYPE_CHECKING:
    from .records.record import Record


CHORD = 1e-3  # of the largest acceleration of the floor
TAIL = 1e-3  # of it, that the free vibration has at the end
CYCLE = 400  # steps in a cycle of a pulse
MOST = 10_000_000  # steps of a floor's motion


@dataclass(frozen=True)
class Building:
    """A floor of a linear building: the modes that move it.

    `floor_of` returns its motion.

    Attributes
    ----------
    modes: period [s], damping ratio [-] and gamma_psi [-] of each

    Examples
    --------
    >>> building = parse_building(["T=0.4,xi=0.05,gamma_psi=1.3"])
    >>> building.name
    'floor of T 0.4 s'
    """

    modes: tuple[FloorMode, ...]

    @property
    def name(self) -> str:
        """The floor in a few words."""
        periods = " and ".join(f"{mode.period:g}" for mode in self.modes)
        return f"floor of T {periods} s"

    def identity(self) -> list[list[float]]:
        """Return the numbers on which a result depends."""
        return [list(mode) for mode in self.modes]

    def moved_by(self, ground: Motion) -> Motion:
        """Return the motion of the floor, with the name of that of the ground.

        Parameters
        ----------
        ground
            a motion in its own time

        Returns
        -------
        Motion
        """
        return floor_of(ground, self, name=ground.name)


def parse_building(texts: Sequence[str]) -> Building | None:
    """Return the building that texts of its modes state, None without one.

    Parameters
    ----------
    texts
        a mode each, such as `T=0.4,xi=0.05,gamma_psi=1.3`: period [s], damping ratio
        [-] and participation times shape at the floor [-], 1 if it is not stated

    Returns
    -------
    Building or None

    Raises
    ------
    UsageError
        for other keys, a period outside 0.001 to 1000 s, a damping ratio outside 0 to
        1, a gamma_psi of zero or beyond 1000, and two modes of one period

    Examples
    --------
    >>> parse_building(["T=0.4,xi=0.05"]).modes
    (FloorMode(period=0.4, damping=0.05, gamma_psi=1.0),)
    """
    modes = tuple(parse_mode(text) for text in texts)
    if twice := repeated(modes):
        raise UsageError(f"`building`: found {twice}; expected {ONE_EACH}")
    return Building(modes) if modes else None


class _LinearSteps(NamedTuple):
    """The ground acceleration over steps, a straight line and sinusoids in each; it may
    jump between steps.
    """

    length: Array  # of each step [s], (n,)
    line: Array  # the line at its start and its end, (2, n)
    size: Array  # of each sinusoid, (H, n)
    rate: Array  # circular frequency of each sinusoid [rad/s], (H, n)
    angle: Array  # argument of each sinusoid at the start [rad], (H, n)

    @classmethod
    def of(cls, motion: Motion, omega: float, per_cycle: int) -> "_LinearSteps":
        """Return the steps of a motion of this frequency [rad/s]: its straight pieces,
        and so many steps in a cycle of its fastest sinusoid.
        """
        if isinstance(motion, Polyline):
            length = (motion.stop - motion.start) / omega
            last = motion.constant + motion.slope * (motion.stop - motion.start)
            none = np.zeros((0, length.size))
            return cls(length, np.stack([motion.constant, last]), none, none, none)
        most = max(len(piece.harmonics) for piece in motion.pieces)
        columns: list[list[Array]] = [[], [], [], [], []]
        for piece, other in _pairs(motion):
            phase = _marks_of(piece, other, per_cycle)
            line = piece.constant + piece.slope * (phase - piece.start)
            own = np.zeros((3, most, phase.size - 1))
            own[1] = 1.0
            for j, h in enumerate(piece.harmonics):
                own[0, j], own[1, j] = h.amplitude, h.frequency * omega
                own[2, j] = h.frequency * phase[:-1] + h.phase
            values = np.diff(phase) / omega, np.stack([line[:-1], line[1:]]), *own
            for column, value in zip(columns, values, strict=True):
                column.append(value)
        return cls(*(np.concatenate(column, axis=-1) for column in columns))

    def cut(self, parts: int) -> "_LinearSteps":
        """Return the same motion with each step cut into equal parts."""
        if parts == 1:
            return self
        share = np.arange(parts + 1) / parts
        rise = (self.line[1] - self.line[0])[:, None]
        line = self.line[0][:, None] + rise * share
        line[:, -1] = self.line[1]
        angle = self.angle[..., None] + (self.rate * self.length)[..., None] * share
        count = parts * self.length.size
        return _LinearSteps(
            np.repeat(self.length / parts, parts),
            np.stack([line[:, :-1].ravel(), line[:, 1:].ravel()]),
            np.repeat(self.size, parts, axis=1),
            np.repeat(self.rate, parts, axis=1),
            angle[..., :-1].reshape(-1, count),
        )

    @property
    def first(self) -> Array:
        """The acceleration at the start of each step, (n,)."""
        return self.line[0] + (self.size * np.sin(self.angle)).sum(axis=0)

    @property
    def last(self) -> Array:
        """The acceleration at the end of each step, (n,)."""
        angle = self.angle + self.rate * self.length
        return self.line[1] + (self.size * np.sin(angle)).sum(axis=0)

    @property
    def rise(self) -> Array:
        """The slope of the line in each step, (n,)."""
        return np.asarray((self.line[1] - self.line[0]) / self.length)

    def forced(self, s: complex) -> tuple[Array, Array]:
        """Return (E = exp(s h), the integral of -exp(s (h - t)) x_g'' over the step),
        (n,) each.
        """
        h = self.length
        grows = np.exp(s * h)
        force = -self.line[0] * gain(s, h) - (self.line[1] - self.line[0]) * rise(s, h)
        for sign in (1.0, -1.0):  # sin x = (e^ix - e^-ix)/2i
            turn = sign * 1j * self.rate
            share = (np.exp(turn * h) - grows) / (turn - s)
            start = sign * self.size * np.exp(sign * 1j * self.angle) / 2j
            force = force - (start * share).sum(axis=0)
        return grows, force


def _pairs(motion: Motion) -> Iterator[tuple[Piece, Piece]]:
    """Yield each piece of a motion with that of its vertical motion, or itself."""
    up = motion if motion.vertical is None else motion.vertical
    yield from zip(motion.pieces, up.pieces, strict=True)


def _marks_of(piece: Piece, other: Piece, per_cycle: int) -> Array:
    """Return the phases [rad] at the ends of the steps of two pieces."""
    waves = (*piece.harmonics, *other.harmonics)
    fastest = max((h.frequency for h in waves), default=0.0)
    length = piece.stop - piece.start
    cycles = length * fastest / math.tau
    count = max(1, math.ceil(cycles * per_cycle * (1.0 - 1e-12)))
    return np.linspace(piece.start, piece.stop, count + 1)


class _Vibration(NamedTuple):
    """The vibration of one mode under the steps."""

    start: Array  # u'' at the start of each step, after a jump, (n,)
    end: Array  # u'' at the end of each step, before a jump, (n,)
    bend: Array  # bound of the second derivative of u'' inside each step, (n,)
    left: complex  # z after the last step, the ground at rest


def _answer(steps: _LinearSteps, mode: FloorMode) -> _Vibration:
    """Return the vibration of a mode from rest."""
    w, xi = 2.0 * math.pi / mode.period, mode.damping
    w_d = w * math.sqrt(1.0 - xi * xi)
    states = _states(*steps.forced(complex(-xi * w, w_d)))
    u = states.imag / w_d
    rate = states.real - xi * w * u  # u' = Re z + Re(s) u
    pull = -2.0 * xi * w * rate - w * w * u
    start, end = pull[:-1] - steps.first, pull[1:] - steps.last

    # u'' without the part that the sinusoids force vibrates freely in a step
    square, turn = steps.rate**2, np.exp(1j * steps.angle)
    forces = steps.size * square / (w * w - square + 2j * xi * w * steps.rate)
    free = start - (forces * turn).imag.sum(axis=0)
    quick = (1j * steps.rate * forces * turn).imag.sum(axis=0)
    slope = steps.rise + (steps.size * steps.rate * np.cos(steps.angle)).sum(axis=0)
    jerk = -slope - 2.0 * xi * w * start - w * w * rate[:-1]
    swing = np.hypot(free, (jerk - quick + xi * w * free) / w_d)
    bend = w * w * swing + (square * np.abs(forces)).sum(axis=0)
    return _Vibration(start, end, bend, complex(states[-1]))


def _states(grows: Array, forced: Array) -> Array:
    """Return z at the ends of all steps, from rest, (n + 1,)."""
    z, states = 0.0j, [0.0j]
    for grow, force in zip(grows.tolist(), forced.tolist(), strict=True):
        z = grow * z + force
        states.append(z)
    return np.array(states)


def floor_of(
    ground: AnyMotion,
    building: Building | str,
    a_g: float | None = None,
    omega: float = 1.0,
    name: str = "",
    per_cycle: int = CYCLE,
) -> Motion:
    """Return the motion of a floor of a building, in its own time: absolute
    acceleration over the a_g of the ground, as straight lines between exact values.

    Parameters
    ----------
    ground
        a record, or a pulse of one amplitude and frequency, with its vertical motion,
        which is not filtered: an object, the name of a pulse, or a path
    building
        the modes that move the floor, or a text such as "T=0.4,xi=0.05"
    a_g
        amplitude of the ground [m/s2], None for that of a record
    omega
        frequency of the ground [rad/s], 1 of a record
    name
        by default that of the ground with the periods
    per_cycle
        steps in a cycle of a pulse, at least

    Returns
    -------
    Motion
        its `floor` says what the straight lines miss at most [-]

    Raises
    ------
    UsageError
        if it needs more than 10 million steps

    Examples
    --------
    >>> ground = 'configs/motions/synthetic.at2'
    >>> floor = floor_of(ground, 'T=0.4,xi=0.05,gamma_psi=1.3')
    >>> round(floor.largest * floor.acceleration, 3), floor.floor.chord < 1e-3
    (8.463, True)
    """
    ground = motion_from(ground)
    if isinstance(building, str):
        building = Building((parse_mode(building),))
    whole = _LinearSteps.of(ground, omega, per_cycle)
    parts = 1
    while True:
        if parts * whole.length.size > MOST:
            shortest = min(mode.period for mode in building.modes)
            raise UsageError(
                f"`building`: the floor of T = {shortest:g} s needs more than {MOST}"
                " steps; expected a longer period, or a mode less"
            )
        steps = whole.cut(parts)
        answers = [_answer(steps, mode) for mode in building.modes]
        first, last = _absolute(building, steps, answers)
        peak = max(largest(first), largest(last))
        chord = _chord(building, steps, answers) / peak
        if chord <= CHORD:
            break
        parts = max(parts + 1, math.floor(parts * math.sqrt(chord / CHORD)))
    tail = _tail_of(building, answers, float(steps.length[-1]), peak)
    if steps.length.size + tail.size > MOST:
        raise UsageError(
            f"`building`: the floor vibrates on for more than {MOST} steps; expected"
            " more damping"
        )
    marks = _marks(ground, steps, tail.size, omega)
    if tail.size:
        first = np.concatenate([first, last[-1:], tail[:-1]])
        last = np.append(last, tail)
    acceleration = ground.acceleration if a_g is None else a_g
    vertical = _unfiltered(ground.vertical, marks, omega, acceleration)
    own = ground.name.removesuffix(upwards(ground.vertical))
    return Polyline(
        (name or f"{own} on {building.name}") + upwards(ground.vertical),
        marks[:-1],
        marks[1:],
        first,
        (last - first) / np.diff(marks),
        acceleration,
        vertical,
        Floor(chord, ground, omega),
    )


def floor_record(record: "Record", building: Building) -> "tuple[Record, float]":
    """Return (the absolute acceleration of a floor under a record, as a record; what
    straight lines between its samples miss at most, over its peak). Raises as
    `floor_of`.
    """
    found = floor_of(record.motion, building)
    samples = found.samples
    assert samples is not None  # those of the record are equal
    moved = replace(
        record,
        name=f"{record.name} on {building.name}",
        dt=samples.step,
        acceleration=largest(record.acceleration) * samples.values,
        header_pga=None,
        unit="m/s2",
        remarks=(),
    )
    assert found.floor is not None
    return moved, found.floor.chord


def _absolute(
    building: Building, steps: _LinearSteps, answers: Sequence[_Vibration]
) -> tuple[Array, Array]:
    """Return the absolute acceleration of the floor at the starts and ends of steps."""
    first, last = steps.first, steps.last
    for mode, answer in zip(building.modes, answers, strict=True):
        first = first + mode.gamma_psi * answer.start
        last = last + mode.gamma_psi * answer.end
    return first, last


def _chord(
    building: Building, steps: _LinearSteps, answers: Sequence[_Vibration]
) -> float:
    """Return the bound of what straight lines over the steps and the tail miss."""
    bend, free = (np.abs(steps.size) * steps.rate**2).sum(axis=0), 0.0
    for mode, answer in zip(building.modes, answers, strict=True):
        bend = bend + abs(mode.gamma_psi) * answer.bend
        swing = _free(mode, answer.left, np.zeros(1))[1]
        free += abs(mode.gamma_psi) * (2.0 * math.pi / mode.period) ** 2 * swing
    most = max(float((steps.length**2 * bend).max()), steps.length[-1] ** 2 * free)
    return float(most) / 8.0


def _free(mode: FloorMode, z: complex, times: Array) -> tuple[Array, float]:
    """Return (u'' of free vibration at times [s], its amplitude at time 0)."""
    w, xi = 2.0 * math.pi / mode.period, mode.damping
    w_d = w * math.sqrt(1.0 - xi * xi)
    s = complex(-xi * w, w_d)
    states = s * s * z * np.exp(s * times)  # u'' = Im(s^2 z)/w_d
    return states.imag / w_d, abs(s * s * z) / w_d


def _tail_of(
    building: Building, answers: Sequence[_Vibration], step: float, peak: float
) -> Array:
    """Return the floor's free vibration at each step after the motion, until the sum of
    the amplitudes of its modes is down to TAIL of the peak.
    """
    rates, sizes = [], []
    for mode, answer in zip(building.modes, answers, strict=True):
        rates.append(2.0 * math.pi / mode.period * mode.damping)
        amplitude = _free(mode, answer.left, np.zeros(1))[1]
        sizes.append(abs(mode.gamma_psi) * amplitude / peak)
    high = max(
        math.log(max(1.0, len(sizes) * size / TAIL)) / rate
        for size, rate in zip(sizes, rates, strict=True)
    )  # each mode is down to its share of TAIL
    low = 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        left = sum(
            size * math.exp(-rate * middle)
            for size, rate in zip(sizes, rates, strict=True)
        )
        low, high = (middle, high) if left > TAIL else (low, middle)
    times = step * np.arange(1, min(math.ceil(high / step), MOST) + 1)
    found = np.zeros(times.size)
    for mode, answer in zip(building.modes, answers, strict=True):
        found += mode.gamma_psi * _free(mode, answer.left, times)[0]
    return found


def _marks(ground: Motion, steps: _LinearSteps, tail: int, omega: float) -> Array:
    """Return the times of the floor's motion [s], with so many steps of a tail."""
    ends = np.append(0.0, np.cumsum(steps.length))
    if np.ptp(steps.length) > 1e-12 * ends[-1]:
        after = float(steps.length[-1]) * np.arange(1, tail + 1)
        return np.append(ends, ends[-1] + after)
    # equal steps without a rounding that adds up
    end = ground.duration / omega
    count = steps.length.size
    return np.asarray(end / count * np.arange(count + tail + 1))


def _unfiltered(
    up: Motion | None, marks: Array, omega: float, acceleration: float | None
) -> Polyline | None:
    """Return a vertical motion as straight lines between times [s]."""
    if up is None:
        return None
    begins, ends = marks[:-1] * omega, marks[1:] * omega
    moves = begins < up.duration * (1.0 - 1e-12)
    first = np.where(moves, up.value(begins), 0.0)
    before = ends - 1e-9 * (ends - begins)  # at a jump the value before it
    last = np.where(moves, up.value(before), 0.0)
    slope = (last - first) / np.diff(marks)
    return Polyline(up.name, marks[:-1], marks[1:], first, slope, acceleration)
