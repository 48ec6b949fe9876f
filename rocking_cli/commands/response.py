"""`rocking response`: the time history of one structure under one motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

from ..errors import UsageError
from . import demand, equations, ground, options
from .command import argument, command, flag, group, option, partly, refuse
from .parameter_types import NUMBER, InputPath, quantity
from .printing import detail, emit, form, note, printed

if TYPE_CHECKING:
    from ..responses.time_history import TimeHistory

if TYPE_CHECKING:
    from ..responses.sliding import SlideHistory


@dataclass(frozen=True)
class OneMotion(demand.Directed):
    """The demand, with --row-step for the rows."""

    motion_dt: float | None = option("--motion-dt", ground.DT, type=quantity("time"))


@dataclass(frozen=True)
class ResponseOptions:
    """The start of the body, and what to print of its motion."""

    release: float = option(
        "--release",
        "Release from theta/alpha = RATIO; without a motion: free rocking.",
        type=NUMBER,
        default=0.0,
        metavar="RATIO",
    )
    duration: float | None = option(
        "--duration",
        "Duration of the rows (default: the shaking and 30/p after it).",
        type=quantity("time"),
    )
    dt: float | None = option(
        "--row-step",
        "Time between two rows (default: the samples of a record, 500 rows of a"
        " pulse; with impacts and peaks).",
        type=quantity("time"),
    )
    steps: bool = flag("--steps", "Print a row at each step of the solver instead.")
    events: bool = flag(
        "--events", "Print uplifts, impacts, peaks, rest and overturning instead."
    )
    forces: bool = flag(
        "--forces",
        "Also print the forces on the ground, or on the joints of an arch, over m g.",
    )
    dimensionless: bool = flag(
        "--dimensionless", "Print theta/alpha over p t; --row-step is in p t too."
    )

    def check(self) -> None:
        """Raise UsageError for a step of the rows that is no step."""
        if self.dt is None:
            return
        refuse("does not go with --row-step", "steps")
        if not self.dt > 0.0:
            raise UsageError(
                f"--row-step: found {self.dt:g} s; expected a positive time"
            )


@command(
    "rocking response configs/arch.yaml --pulse rectangular-impulse --a-g 0.9g --T-g"
    " 0.4 --model both --events",
    printed,
)
def response(
    file: str = argument(type=InputPath()),
    asked: OneMotion = group(OneMotion),
    model: equations.Models = group(equations.Models),
    wanted: ResponseOptions = group(ResponseOptions),
    figure: options.FigureFile = group(options.FigureFile),
) -> None:
    """Time history of one structure: t [s], theta [rad], theta_dot [rad/s],
    ground_acceleration [m/s2]; -o draws it.

    FILE holds one structure. An overturning body is followed to 3 alpha, or until it
    lies on its side or its linkage has collapsed. The speed of an impact in the events
    is the speed before it. With --json the last row of each model is a summary. A body
    whose friction is below lambda slides and never rocks: its rows are t, slide [m],
    slide_velocity [m/s] and ground_acceleration, its events slide and stop.
    """
    from ..reports.response_words import response_in_words
    from ..responses.time_history import time_history

    figure.check()
    shaken = _shaken(asked)
    structures = options.structures_of((file,))
    if len(structures) != 1:
        raise UsageError(
            f"{file} holds {len(structures)} structures; expected one (rocking compare"
            " takes several)"
        )
    if shaken.grid is None and (asked.pulse or asked.motion or not wanted.release):
        raise ground.no_shaking(
            "--A and --Omega", "--release without a motion for free rocking"
        )
    wanted.check()
    bare = shaken.grid is not None and shaken.grid.dimensionless
    if shaken.grid is not None and not wanted.release:
        from ..responses.sliding import slide_history

        slid = slide_history(structures[0], *shaken.shakes[0])
        if slid is not None:
            _print_sliding(slid, wanted, figure)
            demand.note_demand(shaken.shakes)
            note(f"{structures[0].name}: {slid.words}")
            return
    methods = model.methods(structures, bare)
    found = time_history(
        structures[0],
        shaken.motion if shaken.grid else None,
        shaken.grid,
        methods,
        release=wanted.release,
        duration=wanted.duration,
    )
    _print(found, wanted)
    shown = {"dimensionless": wanted.dimensionless, "forces": wanted.forces}
    if figure.output is not None:
        figure.draw(list(found.rows(dt=wanted.dt, steps=wanted.steps, **shown)))
    if shaken.grid is not None:
        demand.note_demand(shaken.shakes)
    detail(*model.in_words(methods, structures, bare))
    note(*response_in_words(found, forces=wanted.forces))
    if wanted.release:
        from ..reports.remarks import stuck_in_words

        note(*stuck_in_words(structures))
    partly(found.failed)


def _shaken(asked: OneMotion) -> ground.Ground:
    """Return the motion and its demand; with --azimuth that of this direction."""
    azimuths = asked.azimuths()
    if azimuths is None:
        return asked.of(asked.one())
    from ..responses.azimuth import at_azimuth

    if azimuths.size > 1:
        raise UsageError(
            f"--azimuth: found {asked.azimuth}; expected one angle (rocking check"
            " takes a span)"
        )
    recordings = asked.several(())[1].recordings
    directed = at_azimuth(recordings, float(azimuths[0]))
    return asked.of(ground.Ground(directed.motion))


def _print_sliding(
    slid: SlideHistory, wanted: ResponseOptions, figure: options.FigureFile
) -> None:
    """Print the rows or the events of a body that slides, and draw the rows."""
    from ..responses.time_history import NAMED

    refuse(f"does not go with {slid.structure.name}, which slides", "dimensionless")
    rows = list(
        slid.rows(
            dt=wanted.dt,
            steps=wanted.steps,
            duration=wanted.duration,
            forces=wanted.forces,
        )
    )
    figure.draw(rows)
    if not wanted.events:
        emit(rows, unseen=NAMED)
        return
    closing: Iterable[dict[str, Any]] = [slid.summary()] if form() == "json" else ()
    emit(chain(slid.events(), closing), ("model", "event"))


def _print(found: TimeHistory, wanted: ResponseOptions) -> None:
    """Print the rows of a time history, or its events."""
    from ..responses.time_history import IMPULSES, NAMED

    shown = {"dimensionless": wanted.dimensionless, "forces": wanted.forces}
    if not wanted.events:
        rows = found.rows(dt=wanted.dt, steps=wanted.steps, **shown)
        emit(rows, unseen=NAMED)
        return
    closing = found.summaries(**shown) if form() == "json" else ()
    emit(
        chain(found.events(**shown), closing),
        ("model", "event"),
        dimensions=dict.fromkeys(IMPULSES) if wanted.dimensionless else None,
    )
