"""Where the time of a scene goes: `python tests/bench/trace.py [SCENE...]`, or `make trace SCENE="linear arch"`; all without a name.

Each stage's own time, without the stages that it calls, in processor seconds of this process; how often it was entered, and with how
many lanes or cells in all. The stages are the engine's functions, wrapped from outside; entering one costs about a microsecond.
"""

from __future__ import annotations

import functools
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest import mock

import numpy as np
from scenes import SCENES

from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.equations.flow import LinearFlow
from rocking_cli.dynamics.equations.linear import LinearEquation
from rocking_cli.dynamics.equations.mechanism import MechanismEquation
from rocking_cli.dynamics.equations.rigid_body import RigidBodyEquation
from rocking_cli.dynamics.equations.summed_flow import SummedFlow
from rocking_cli.dynamics.equations.taylor import TaylorSeries
from rocking_cli.dynamics.lanes import Lanes
from rocking_cli.dynamics.march import advance, engine
from rocking_cli.envelopes import boundaries
from rocking_cli.spectra import sweep, verification
from rocking_cli.spectra.file import writer as store
from rocking_cli.spectra.work import jobs

STAGES: dict[str, list[tuple[Any, str]]] = {
    "windows": [(advance, "next_step")],
    "arcs": [
        *((x, "flow") for x in (LinearEquation, RigidBodyEquation, MechanismEquation)),
        *((x, "take") for x in (LinearFlow, SummedFlow, TaylorSeries)),
    ],
    "flow": [(x, name) for x in (LinearFlow, SummedFlow, TaylorSeries) for name in ("at", "at_ground")],
    "roots": [(advance, "impact_root"), (advance, "hidden_turn")],
    "turning_points": [(advance, "turning_point"), (engine, "turning_points")],
    "contact": [(Symmetric, name) for name in ("uplift", "strike", "turn", "sequence_ends", "free_motion")],
    "lanes": [(Lanes, "take"), (Lanes, "join"), (engine.Run, "finish")],
    "rounds": [(engine.Run, "round")],
    "boundaries": [(boundaries.Search, "rows")],
    "check": [(verification, "checked_cells"), (jobs, "reference")],
    "writing": [(sweep, "_packed"), (store.SpectraWriter, "write"), (store.SpectraWriter, "finish")],
}


class Stopwatch:
    """Time of the innermost stage that runs."""

    def __init__(self) -> None:
        self.seconds, self.calls, self.lanes = Counter[str](), Counter[str](), Counter[str]()
        self.running, self.since = ["elsewhere"], time.process_time()

    def charge(self) -> None:
        """What has passed belongs to the stage that runs."""
        now = time.process_time()
        self.seconds[self.running[-1]] += now - self.since
        self.since = now

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time spent inside belongs to it, but for other stages."""
        self.charge()
        self.running.append(name)
        try:
            yield
        finally:
            self.charge()
            self.running.pop()

    def wrapped(self, name: str, action: Callable[..., Any]) -> Callable[..., Any]:
        """The function as a stage."""

        @functools.wraps(action)
        def run(*arguments: Any, **options: Any) -> Any:
            self.calls[name] += 1
            self.lanes[name] += next((_size(x) for x in reversed(arguments) if _size(x)), 0)
            with self.stage(name):
                return action(*arguments, **options)

        return run


def _size(argument: Any) -> int:
    return argument.size if isinstance(argument, np.ndarray) else argument.cell.size if isinstance(argument, Lanes) else 0


def trace(scene: str) -> None:
    """Print the table of a scene."""
    watch = Stopwatch()
    with ExitStack() as patches:
        for name, places in STAGES.items():
            for owner, attribute in places:
                patches.enter_context(mock.patch.object(owner, attribute, watch.wrapped(name, getattr(owner, attribute))))
        cells = SCENES[scene]()
        watch.charge()
    total = watch.seconds.total()
    print(f"{scene}: {cells} cells, {total:.3f} s, {1e6 * total / cells:.2f} us each")
    print(f"  {'stage':<12}{'s':>8}{'share':>7}{'calls':>9}{'lanes':>12}{'us a call':>11}{'ns a lane':>11}")
    for name, seconds in watch.seconds.most_common():
        calls, lanes = watch.calls[name], watch.lanes[name]
        each = (f"{1e6 * seconds / calls:11.1f}" if calls else "") + (f"{1e9 * seconds / lanes:11.1f}" if lanes else "")
        print(f"  {name:<12}{seconds:8.3f}{seconds / total:7.0%}{calls:9d}{lanes:12d}{each}")


if __name__ == "__main__":
    for chosen in sys.argv[1:] or SCENES:
        if chosen not in SCENES:
            sys.exit(f"no scene {chosen!r}; expected {', '.join(SCENES)}")
        trace(chosen)
