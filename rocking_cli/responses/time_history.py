"""Responses in time as rows, with units or as theta/alpha over p t, by the linear and
the nonlinear equation.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..dynamics.method import Method, governing_method, methods_of
from ..dynamics.outcome import LOST, Outcome
from ..errors import ArgumentError, StructureError, UsageError
from ..motions import Motion, Piece
from ..motions.floors import on_floors
from ..motions.given import AnyMotion, demand_of
from ..motions.grid import Grid
from ..showing import Shown
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters
from .arcs import LATE, Event, History
from .force_history import ForceHistory
from .ground_history import GroundMotion
from .history import history
from .structure_forces import forces_of

# tau for which a response is followed after the shaking, unless the user says
FREE = 30.0
POINTS = 500  # times of a history over its whole length, unless the user says
MOST_POINTS = 10_000_000
# columns that are the same in every row
NAMED = (
    "structure",
    "motion",
    "model",
    *("outcome", "outcome_linear", "outcome_nonlinear"),
    *("a_g", "omega_g", "demand_A", "Omega", "friction"),
)
IMPULSES = ("impulse_x", "impulse_z")  # over m g [s], over m g p if dimensionless
_BEFORE = 2.0 - LATE**4  # of the time of an impact: just before it
STILL = Motion("free rocking", (Piece(0.0, 1.0),))


@dataclass(frozen=True, eq=False, repr=False)
class TimeHistory(Shown):
    """The response of one structure to one motion, by one or two equations.

    `time_history` and `compare` return it. `rows` and `events` yield what `rocking
    response` prints, `summaries` and `outcome` the outcome, `forces` the forces on the
    ground, `histories` each response itself.

    Attributes
    ----------
    structure: the one that rocks
    motion: the ground motion
    amplitude: A [-]
    omega: Omega [-]
    histories: by equation of motion, at least to the end of the shaking
    shown: time up to which rows, events and figures go [tau]

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> found = time_history(column, sine(), parse_grid("a_g=0.35g,f_g=1.5"))
    >>> found.outcome("nonlinear").flag
    'rocked'
    >>> first = next(found.events())
    >>> first["event"], f"{first['t']:.5f} s"
    ('uplift', '0.08442 s')
    """

    structure: RockingParameters  # the one that rocks
    motion: Motion  # the ground motion
    amplitude: float  # A [-]
    omega: float  # Omega [-]
    # by equation of motion, at least to the end of the shaking
    histories: dict[str, History]
    shown: float  # time up to which rows, events and figures go [tau]

    def _shown(self) -> dict[str, Any]:
        row: dict[str, Any] = {
            "structure": self.structure.name,
            "motion": self.motion.name,
            "duration": self.end / self.structure.p,
        }
        if self.amplitude:
            row["demand_a"] = float(self.structure.ground_acceleration(self.amplitude))
        for one in self.summaries():
            end = f"_{one['model']}" if len(self.histories) > 1 else ""
            found = {**one, "events": sum(1 for _ in self._events(one["model"]))}
            keys = ("outcome", "theta_ratio", "top_displacement", "events")
            row |= {f"{key}{end}": found[key] for key in keys}
        return row

    def _rows(self) -> Iterator[dict[str, Any]]:
        return self.rows()

    @property
    def end(self) -> float:
        """The time [tau] at which the longest history ends, or its body loses contact;
        at most `shown`.
        """
        return min(self.shown, max(map(self.end_of, self.histories)))

    def end_of(self, model: str) -> float:
        """Return the time up to which the motion by one equation is known: that of the
        history, or of the first loss of contact.

        Parameters
        ----------
        model
            the equation, "linear" or "nonlinear"

        Returns
        -------
        float
            [tau]
        """
        lost, end = self._lost(model), self.histories[model].end
        return end if lost is None else min(lost, end)

    @property
    def failed(self) -> bool:
        """True if a history has no outcome."""
        return any(h.outcome == Outcome.FAILED for h in self.histories.values())

    def times(self, dt: float | None, steps: bool) -> np.ndarray:
        """Return the times of the rows.

        Parameters
        ----------
        dt
            step [tau]; None: the samples of a record, or the ends of equal intervals
            for a pulse, with the impacts and peaks
        steps
            True: the times of `History.steps`

        Returns
        -------
        array
            [tau], (rows,)

        Raises
        ------
        UsageError
            for a step that is not positive or gives too many rows
        """
        if steps:
            marks = [h.steps() for h in self.histories.values()]
        elif dt is None:
            own_time = self.motion.acceleration is not None
            equal = [np.linspace(0.0, self.end, POINTS + 1)]
            marks = [*(self._samples() if own_time else equal), self._turns()]
        elif not (dt > 0.0 and self.end / dt <= MOST_POINTS):
            raise UsageError(
                f"`dt`: found {dt / self.structure.p:g} s; expected a positive time"
                f" that gives up to {MOST_POINTS} points"
            )
        else:
            return dt * np.arange(math.floor(self.end / dt * (1.0 + 1e-12)) + 1)
        times = np.unique(np.concatenate(marks))
        return np.append(times[times < self.end], self.end)

    def _samples(self) -> list[np.ndarray]:
        """Return tau at the samples of a record, and at the same mean step after its
        end. Raises UsageError.
        """
        stops = GroundMotion(self.motion, self.amplitude, self.omega).stops
        last, step = float(stops[-1]), float(stops[-1]) / stops.size
        if self.end / step > MOST_POINTS:
            raise UsageError(
                f"the record gives more than {MOST_POINTS} rows; `dt` sets their step"
            )
        after = last + step * np.arange(1, max(1, math.ceil((self.end - last) / step)))
        return [np.zeros(1), stops, after]

    def _turns(self) -> np.ndarray:
        """Return tau at peaks, just before impacts, and at impacts, where the velocity
        jumps.
        """
        turns = []
        for found in self.histories.values():
            for event in found.events:
                if event.event == "impact":
                    turns.append(event.tau * _BEFORE)
                if event.event in ("impact", "peak"):
                    turns.append(event.tau)
        return np.array(turns)

    @cached_property
    def forces(self) -> dict[str, ForceHistory]:
        """The forces for each equation of motion: between a rigid body and the ground,
        or at the joints of a mechanism. Raises UsageError.
        """
        s = self.structure
        amplitude = float(s.ground_acceleration(self.amplitude)) / s.gravity
        ground = GroundMotion(self.motion, amplitude, self.omega)
        return {
            model: forces_of(s, model, ground, found)
            for model, found in self.histories.items()
        }

    def top_displacement(self, model: str) -> float | None:
        """Return the largest displacement of the top from its rest position.

        Parameters
        ----------
        model
            the equation, "linear" or "nonlinear"

        Returns
        -------
        float or None
            [m]; None without a geometry, and if the body falls
        """
        s, found = self.structure, self.histories[model]
        if not s.top or found.theta_ratio is None or self.outcome(model).falls:
            return None
        largest = [
            (abs(e.theta_ratio), e.side)
            for e in found.events
            if e.event in ("release", "peak")
        ]
        # at the end, or after it
        if found.theta_ratio > max((ratio for ratio, _ in largest), default=0.0) * (
            1.0 + 1e-9
        ):
            largest.append(
                (found.theta_ratio, float(found.sides(np.array([found.end]))[0]))
            )
        turned = [
            (s.top[side > 0.0], ratio * float(s.alpha_on(side)))
            for ratio, side in largest
        ]
        return max(
            (2.0 * arm * math.sin(0.5 * angle) for arm, angle in turned), default=0.0
        )

    def outcome(self, model: str) -> Outcome:
        """Return the outcome by one equation.

        Parameters
        ----------
        model
            the equation, "linear" or "nonlinear"

        Returns
        -------
        Outcome
        """
        return self.histories[model].outcome

    def _lost(self, model: str) -> float | None:
        """Return the first instant tau with Fz <= 0 of a body that does not overturn;
        None without one, and for a body with ties, whose history ends there.
        """
        found = self.histories[model]
        loses = found.outcome == Outcome.LOST_CONTACT
        return found.lost if loses and not found.devices else None

    def _events(self, model: str) -> Iterator[Event]:
        """Yield the events up to tau = `shown`, or up to the loss of contact."""
        found, lost = self.histories[model], self._lost(model)
        stop = self.shown if lost is None else min(lost, self.shown)
        yield from (
            m
            for m in found.events
            if m.tau <= stop and (lost is None or m.event != LOST)
        )
        if lost is not None and lost <= self.shown:
            at = np.array([lost])
            ratio, rate = found.at(at)
            yield Event(
                lost, LOST, float(ratio[0]), float(rate[0]), float(found.sides(at)[0])
            )

    def rows(
        self,
        *,
        dt: float | None = None,
        steps: bool = False,
        dimensionless: bool = False,
        forces: bool = False,
    ) -> Iterator[dict[str, Any]]:
        """Yield the response, a row for each time up to a loss of contact.

        Columns with units come first, among them the force of each tie and tendon [N],
        then tau, theta/alpha and the displacement of the top, last those of `NAMED`.
        Columns have the name of the model if there are two.

        Parameters
        ----------
        dt
            step [s], in tau with `dimensionless`; None as in `times`
        steps
            True: a row at each end of an arc and each event
        dimensionless
            True: tau, theta/alpha and A, without the columns that have units
        forces
            True: with the forces over m g

        Yields
        ------
        dict
            values by column

        Raises
        ------
        UsageError
            for a bad step, or forces that are not known
        """
        s = self.structure
        time = 1.0 if dimensionless else 1.0 / s.p
        tau = self.times(None if dt is None else dt / time, steps)
        columns = {"tau" if dimensionless else "t": tau * time}
        last = {} if dimensionless else {"tau": tau}
        for model in self.histories:
            suffix = f"_{model}" if len(self.histories) > 1 else ""
            state = self._state(model, tau)
            own = self._columns(model, tau, state, dimensionless, forces)
            columns |= {name + suffix: values for name, values in own.items()}
            if dimensionless:
                continue
            last[f"theta_ratio{suffix}"] = state[0]
            if s.top:
                theta = own["theta"]
                arm = np.where(theta > 0.0, s.top[1], s.top[0])
                last[f"top_displacement{suffix}"] = 2.0 * arm * np.sin(0.5 * theta)
        shaking = self.amplitude * self.motion.value(tau * self.omega)
        columns |= (
            {"A": shaking}
            if dimensionless
            else {"ground_acceleration": s.ground_acceleration(shaking)}
        )
        named = self._named(dimensionless)
        for row in _rows_of(columns | last):
            yield row | named

    def _state(self, model: str, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return theta/alpha and its derivative by tau at times tau, NaN where the
        motion by one equation is not known.
        """
        ratio, rate = self.histories[model].at(tau)
        unknown = tau > self.end_of(model)
        ratio[unknown] = rate[unknown] = np.nan
        return ratio, rate

    def _named(self, dimensionless: bool) -> dict[str, str | float | None]:
        """Return the columns of `NAMED`: that of the outcome has the name of the model
        if there are two; the demand is None without shaking, the frequency also under a
        record.
        """
        s, models = self.structure, list(self.histories)
        named: dict[str, str | float | None] = {
            "structure": s.name,
            "motion": self.motion.name,
            "model": " and ".join(models),
        }
        for model in models:
            suffix = f"_{model}" if len(models) > 1 else ""
            named[f"outcome{suffix}"] = self.outcome(model).flag
        shaken = self.amplitude > 0.0
        periodic = shaken and self.motion.acceleration is None
        if dimensionless:
            demand = {"demand_A": self.amplitude, "Omega": self.omega}
        else:
            amplitude = float(s.ground_acceleration(self.amplitude))
            demand = {"a_g": amplitude, "omega_g": self.omega * s.p}
        known = zip(demand.items(), (shaken, periodic), strict=True)
        return named | {key: x if is_known else None for (key, x), is_known in known}

    def _columns(
        self,
        model: str,
        tau: np.ndarray,
        state: tuple[np.ndarray, np.ndarray],
        dimensionless: bool,
        forces: bool,
    ) -> dict[str, np.ndarray]:
        """Return the rotation, its speed, and the forces by one equation; state: theta
        over alpha and its derivative by tau.
        """
        s, found = self.structure, self.histories[model]
        more = self.forces[model].columns(tau) if forces else {}
        for column in more.values():
            column[tau > self.end_of(model)] = np.nan
        ratio, rate = state
        if dimensionless:
            return {"theta_ratio": ratio, "theta_ratio_rate": rate, **more}
        alpha = s.alpha_on(found.sides(tau))
        theta = ratio * alpha
        if found.device_forces:
            more = found.device_forces.columns(tau, theta)
        return {"theta": theta, "theta_dot": rate * alpha / (1.0 / s.p), **more}

    def events(
        self, *, dimensionless: bool = False, forces: bool = False
    ) -> Iterator[dict[str, Any]]:
        """Yield a row for each event; a loss of contact is the last one.

        The rate at an impact is the rate before it.

        Parameters
        ----------
        dimensionless
            True: without the columns that have units
        forces
            True: with the forces over m g before and after the event, and the impulses
            of an impact over m g [s]

        Yields
        ------
        dict
            values by column

        Raises
        ------
        UsageError
            for forces that are not known
        """
        s = self.structure
        for model, found in self.histories.items():
            for m in self._events(model):
                if dimensionless:
                    row = {
                        "tau": m.tau,
                        "theta_ratio": m.theta_ratio,
                        "theta_ratio_rate": m.rate,
                    }
                else:
                    alpha = float(s.alpha_on(m.side))
                    row = {
                        "t": m.tau / s.p,
                        "theta": alpha * m.theta_ratio,
                        "theta_dot": alpha * s.p * m.rate,
                    }
                time = 1.0 if dimensionless else 1.0 / s.p
                force_columns = self.forces[model].event(m, time) if forces else {}
                yield {
                    "model": model,
                    "event": m.event,
                    **row,
                    **({"device": m.device or None} if found.devices else {}),
                    **force_columns,
                }

    def summaries(
        self, *, dimensionless: bool = False, forces: bool = False
    ) -> Iterator[dict[str, Any]]:
        """Yield a row for each model with its largest rotation and outcome.

        Parameters
        ----------
        dimensionless
            True: without the columns that have units
        forces
            True: with the required friction and its time, the friction that impacts
            need, the least Fz over m g and its time; if the document states a friction,
            also when the base slides (None if it does not)

        Yields
        ------
        dict
            values by column; theta_ratio is None if the structure overturned or lost
            contact

        Raises
        ------
        UsageError
            for forces that are not known
        """
        s = self.structure
        when = "tau" if dimensionless else "t"
        time = 1.0 if dimensionless else 1.0 / self.structure.p
        for model, found in self.histories.items():
            summary = self.forces[model].summary(when, time) if forces else {}
            if self.amplitude and not dimensionless:
                summary["demand_a"] = float(s.ground_acceleration(self.amplitude))
            if not dimensionless:
                summary["top_displacement"] = self.top_displacement(model)
            if found.devices:
                summary["devices"] = [
                    {
                        key: x
                        for key, x in one.items()
                        if key not in ("limit", "endless")
                    }
                    for one in found.devices
                ]
            outcome = self.outcome(model)
            # The motion after a loss of contact is not known, nor is its largest
            # rotation.
            ratio = None if outcome == Outcome.LOST_CONTACT else found.theta_ratio
            yield {
                "model": model,
                "event": "summary",
                **summary,
                "theta_ratio": ratio,
                "outcome": outcome.flag,
            }


def _rows_of(columns: dict[str, np.ndarray]) -> Iterator[dict[str, float | None]]:
    """Yield the columns row by row, with None for NaN."""
    for row in zip(*columns.values(), strict=True):
        yield {
            key: None if math.isnan(x) else float(x)
            for key, x in zip(columns, row, strict=True)
        }


def time_history(
    structure: Structure,
    motion: AnyMotion | None,
    shaking: Grid | str | None = None,
    methods: Method | str | Sequence[Method | str] = (),
    *,
    release: float = 0.0,
    duration: float | None = None,
) -> TimeHistory:
    """Return the response of one structure in time (Eqs. 2.3, 2.4, 3.4).

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"
    motion
        the motion of the ground: an object, the name of a pulse, or a path; None for
        free rocking from theta/alpha = release
    shaking
        amplitude and frequency, a grid of one cell or its text; a record does not need
        it
    methods
        the equations of motion or their names, such as "linear"; empty for the
        nonlinear one if the geometry is known and the motion has units, else the linear
        one
    release
        theta/alpha at the start [-], from 0 to below 1
    duration
        the time that is shown [s], None for the shaking and 30/p after it; the outcome
        holds for the whole motion

    Returns
    -------
    TimeHistory

    Raises
    ------
    UsageError
        for a demand of zero, a number out of range, or an equation that does not hold
        for the structure

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> found = time_history(column, sine(), parse_grid("a_g=0.35g,f_g=1.5"))
    >>> [event.event for event in found.histories["nonlinear"].events][:3]
    ['uplift', 'peak', 'impact']
    """
    body = structure_from(structure)
    moved: Motion = STILL
    if motion is None:
        structure, shaking = replace(body, building=()), None
    else:
        demand = (body, *demand_of(motion, shaking))
        ((structure, moved, shaking),) = on_floors([demand])
    several = methods_of(methods) or [
        governing_method(
            structure, dimensionless=shaking is not None and shaking.dimensionless
        )
    ]
    amplitude, omega = shaking.cell(structure) if shaking else (0.0, 1.0)
    if shaking and not amplitude > 0.0:
        raise UsageError(
            "the amplitude is 0; expected a positive one; free rocking is `release`"
            " without a motion"
        )
    if not (0.0 <= release < 1.0):
        raise UsageError(
            f"`release`: found {release:g}; expected theta/alpha from 0 to below 1"
        )
    tau = moved.duration / omega + FREE if duration is None else duration * structure.p
    if not (math.isfinite(tau) and tau > 0.0):
        raise UsageError(
            f"`duration`: found {duration if duration is not None else tau:g}; expected"
            " a positive time [s]"
        )
    try:
        histories = {
            m.model: history(
                m.system_of(structure),
                moved,
                amplitude,
                omega,
                release=release,
                duration=tau,
            )
            for m in several
        }
    except (ArgumentError, StructureError) as error:
        raise UsageError(f"{structure.name}: {error}") from None
    return TimeHistory(structure, moved, amplitude, omega, histories, tau)
