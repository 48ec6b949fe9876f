"""`rocking response`: the time history of one structure under one motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

from ..errors import UsageError
from . import equations, ground, options
from .command import argument, command, flag, group, option, partly, refuse
from .parameter_types import NUMBER, InputPath, quantity
from .printing import emit, form, note, printed

if TYPE_CHECKING:
    from ..responses.sliding import SlideHistory


@dataclass(frozen=True)
class OneMotion(ground.Directed):
    """The demand, with --row-step for the rows."""

    motion_dt: float | None = option("--motion-dt", ground.DT, type=quantity("time"))


@command(
    "rocking response configs/arch.yaml --pulse rectangular-impulse --a-g 0.9g --T-g"
    " 0.4 --model both --events",
    printed,
)
def response(
    file: str = argument(type=InputPath()),
    asked: OneMotion = group(OneMotion),
    model: equations.Models = group(equations.Models),
    release: float = option(
        "--release",
        "Release from theta/alpha = RATIO; without a motion: free rocking.",
        type=NUMBER,
        default=0.0,
        metavar="RATIO",
    ),
    duration: float | None = option(
        "--duration",
        "Duration of the rows (default: the shaking and 30/p after it).",
        type=quantity("time"),
    ),
    dt: float | None = option(
        "--row-step",
        "Time between two rows (default: the samples of a record, 500 rows of a"
        " pulse).",
        type=quantity("time"),
    ),
    steps: bool = flag("--steps", "Print a row at each step of the solver instead."),
    events: bool = flag(
        "--events", "Print uplifts, impacts, peaks, rest and overturning instead."
    ),
    forces: bool = flag(
        "--forces",
        "Also print the forces on the ground, or on the joints of an arch, over m g.",
    ),
    dimensionless: bool = flag(
        "--dimensionless", "Print theta/alpha over p t; --row-step is in p t too."
    ),
) -> None:
    """Time history of one structure: t [s], theta [rad], theta_dot [rad/s],
    ground_acceleration [m/s2].

    FILE holds one structure. An overturning body is followed to 3 alpha, or until it
    lies on its side or its linkage has collapsed. The speed of an impact in the events
    is the speed before it. With --json the last row of each model is a summary. A body
    whose friction is below lambda slides and never rocks: its rows are t, slide [m],
    slide_velocity [m/s] and ground_acceleration, its events slide and stop.
    """
    from ..responses.time_history import EVENT_KEYS, IMPULSES, KEYS, NAMED, time_history

    azimuths = asked.azimuths()
    if azimuths is None:
        shaken = asked.of(asked.one())
    else:
        from ..responses.azimuth import at_azimuth

        if azimuths.size > 1:
            raise UsageError(
                f"--azimuth: found {asked.azimuth}; expected one angle (rocking check"
                " takes a span)"
            )
        recordings = asked.several(())[1].recordings
        shaken = asked.of(
            ground.Ground(at_azimuth(recordings, float(azimuths[0])).motion)
        )
    structures, _ = options.structures_of((file,))
    if len(structures) != 1:
        raise UsageError(
            f"{file} holds {len(structures)} structures; expected one (rocking compare"
            " takes several)"
        )
    if shaken.grid is None and (asked.pulse or asked.motion or not release):
        raise ground.no_shaking(
            "--A and --Omega", "--release without a motion for free rocking"
        )
    if dt is not None:
        refuse("does not go with --row-step", "steps")
    if dt is not None and not dt > 0.0:
        raise UsageError(f"--row-step: found {dt:g} s; expected a positive time")
    bare = shaken.grid is not None and shaken.grid.dimensionless
    if shaken.grid is not None and not release:
        from ..responses.sliding import slide_history

        slid = slide_history(structures[0], *shaken.shakes[0])
        if slid is not None:
            refuse(
                f"does not go with {structures[0].name}, which slides", "dimensionless"
            )
            more = {"dt": dt, "steps": steps, "duration": duration, "forces": forces}
            _print_sliding(slid, events, more)
            ground.note_demand(shaken.shakes)
            note(f"{structures[0].name}: {slid.words}")
            return
    methods = model.methods(structures, bare)
    found = time_history(
        structures[0],
        shaken.motion if shaken.grid else None,
        shaken.grid,
        methods,
        release=release,
        duration=duration,
    )
    shown = {"dimensionless": dimensionless, "forces": forces}
    rows = found.events(**shown) if events else found.rows(dt=dt, steps=steps, **shown)
    closing = found.summaries(**shown) if events and form() == "json" else ()
    dimensions = dict.fromkeys(IMPULSES) if dimensionless else None
    if events:
        emit(
            chain(rows, closing),
            ("model", "event"),
            keys=EVENT_KEYS,
            dimensions=dimensions,
        )
    else:
        emit(rows, keys=KEYS, unseen=NAMED)
    if shaken.grid is not None:
        ground.note_demand(shaken.shakes)
    note(*model.in_words(methods, structures, bare), *found.summary(forces=forces))
    if release:
        from ..responses.sliding import stuck_in_words

        note(*stuck_in_words(structures))
    partly(found.failed)


def _print_sliding(slid: SlideHistory, events: bool, more: Mapping[str, Any]) -> None:
    """Print the rows or the events of a body that slides; more: the arguments of
    `SlideHistory.rows`.
    """
    from ..responses.time_history import EVENT_KEYS, KEYS, NAMED

    if not events:
        emit(slid.rows(**more), keys=KEYS, unseen=NAMED)
        return
    closing: Iterable[dict[str, Any]] = [slid.summary()] if form() == "json" else ()
    emit(chain(slid.events(), closing), ("model", "event"), keys=EVENT_KEYS)
