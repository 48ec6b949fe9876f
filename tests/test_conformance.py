"""What must hold for every system under every motion, as a table of systems, motions
and claims.

The claim here: `check`, `response`, `spectrum`, `envelope` and `solve` of one body at
one amplitude are one answer.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.documents import built

from rocking_cli import (
    Grid,
    Motion,
    Outcome,
    RockingParameters,
    boundaries,
    check,
    parse_documents,
    parse_grid,
    pulse,
    sine,
    spectrum,
    time_history,
    trace_envelope,
)
from rocking_cli.dynamics.method import governing_method
from rocking_cli.dynamics.outcome import falls
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline
from rocking_cli.structures.family import Variation

CONFIGS = Path(__file__).parent.parent / "configs"
# so that its bounces end soon
BLOCK = "kind: block\nwidth: 0.9 m\nheight: 3 m\nmass: 2 t\nrestitution: 0.6\n"
STOCKY = "kind: block\nwidth: 1.3 m\nheight: 2 m\nmass: 500 kg\n"
SYSTEMS = {
    "symmetric": "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.9\n",
    "unequal edges": (
        "kind: rigid\nleft: 0.42 m\nright: 0.31 m\nheight: 1.15 m\ngyration: 0.68 m\n"
    ),
    "one-sided": "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\n",
    "damped": (
        "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.7\ndamping: 0.05\n"
    ),
    "stocky": "kind: block\nwidth: 1.9 m\nheight: 2 m\nrestitution: 0.6\n",
    "stocky, damped": (
        "kind: block\nwidth: 1.9 m\nheight: 2 m\nrestitution: 0.6\ndamping: 0.1\n"
    ),
    "stocky, unequal edges": (
        "kind: rigid\nleft: 0.8 m\nright: 0.7 m\nheight: 1 m\ngyration: 0.5"
        " m\nrestitution: 0.5\n"
    ),
    "stocky, one-sided": (
        "kind: block\nwidth: 1.9 m\nheight: 2 m\none_sided: true\nrestitution: -0.4\n"
    ),
    "arch": (CONFIGS / "arch.yaml").read_text(),
    "mechanism": (CONFIGS / "mechanism.yaml").read_text(),
    "mechanism of unequal sides": (CONFIGS / "mechanism_portal.yaml").read_text(),
    "frame": (CONFIGS / "frame.yaml").read_text(),
    "point mass": (CONFIGS / "point_mass.yaml").read_text(),
    "parameters": (CONFIGS / "parameters.yaml").read_text(),
    "tied on one side": (
        BLOCK + "ties: [{height: 2.8 m, stiffness: 1e6, side: right}]\n"
    ),
    "tied on two sides": (
        BLOCK
        + "ties: [{height: 2.8 m, stiffness: 1e5, side: both}, {height: 1 m, stiffness:"
        " 1e6, side: left}]\n"
    ),
    "tied, one-sided": (
        "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\nmass: 7200"
        " kg\nties: [{height: 5.5 m, stiffness: 2e6 N/m, prestress: 5 kN, yield: 20 kN,"
        " ultimate: 0.2 m}]\n"
    ),
    "tied, damped": (
        BLOCK + "damping: 0.05\nties: [{height: 2.8 m, stiffness: 1e5, side: both}]\n"
    ),
    "rupturing tie": (
        BLOCK
        + "ties: [{height: 2.8 m, stiffness: 1e5, prestress: 1 kN, ultimate: 2 cm,"
        " side: both}]\n"
    ),
    "yielding tie": (
        BLOCK
        + "ties: [{height: 2.8 m, stiffness: 1e6, prestress: 1 kN, yield: 4 kN, side:"
        " both}]\n"
    ),
    "tendon": BLOCK + "tendon: {stiffness: 1e5 N/m, prestress: 6 kN, rupture: 30 kN}\n",
    "dampers": BLOCK + "dampers: {coefficient: 0.5 kN s/m}\n",
    "stocky, tied on one side": (
        STOCKY + "ties: [{height: 2 m, stiffness: 2e6, side: right}]\n"
    ),
    "stocky, tied on two sides": (
        STOCKY + "ties: [{height: 2 m, stiffness: 1e5, side: both}]\n"
    ),
    "stocky, tied, damped": (
        STOCKY + "damping: 0.1\nties: [{height: 2 m, stiffness: 2e6, side: right}]\n"
    ),
    "stocky, prestressed": (
        STOCKY + "ties: [{height: 2 m, stiffness: 2e5, prestress: 1 kN, side: both}]\n"
    ),
    "stocky, tendon": (
        STOCKY + "tendon: {stiffness: 1e5 N/m, prestress: 4 kN, rupture: 12 kN}\n"
    ),
}
# their spectra take seconds
SLOW = ("arch", "mechanism", "mechanism of unequal sides")
FEW = (
    "one-sided",
    "stocky, one-sided",
    "stocky, tied on one side",
)  # their envelopes are traced outside the soak
NO_VERTICAL = (
    "tied",
    "tie",
    "tendon",
    "prestressed",
    "parameters",
    "dampers",
    "arch",
    "frame",
)


def short_record() -> Motion:
    """Straight lines of 0.1 s between 24 samples, in their own time, with a
    peak of 1.
    """
    t = 0.1 * np.arange(25)
    s = np.sin(9.0 * t) * np.exp(-1.2 * t) * np.sin(0.4 + 1.3 * t)
    s[0] = s[-1] = 0.0
    s /= np.abs(s).max()
    return Polyline("short record", t[:-1], t[1:], s[:-1], np.diff(s) / 0.1, 1.0)


MOTIONS = {
    "one sine": lambda: sine(),
    "one sine, reversed": lambda: sine().scaled(-1.0),
    "half sine": (
        lambda: pulse("half-sine").scaled(-1.0)
    ),  # to the right: a one-sided body lifts off
    "ricker": lambda: pulse("ricker-symmetric"),
    "short record": short_record,
    "pulse with a vertical one": lambda: with_vertical(sine(), sine(1.5), 0.4),
}


PULSE, OMEGA = (
    ("one sine", "one sine, reversed"),
    2.0 * math.pi * 1.5,
)  # the motions for which every command is asked; omega_g [rad/s]
AMPLITUDES = 12  # of a sweep, from just above uplift to eight times that
TOLERANCE = 1e-8  # of theta/alpha: 1e-9 times the condition of a cell that stands


@dataclass(frozen=True)
class Sweep:
    """The outcomes of a system along the amplitude of a motion."""

    structure: RockingParameters
    motion: Motion
    a_g: np.ndarray  # amplitudes [m/s2], (amplitudes,)
    omega: float | None  # omega_g [rad/s]; None for a record in its own time
    outcome: np.ndarray  # codes of `Outcome` by `spectrum`, (amplitudes,)
    theta_ratio: np.ndarray  # by `spectrum`, (amplitudes,)

    def demand(self, i: int) -> Grid:
        """The amplitude of this index, as a grid of one cell."""
        return _grid(f"{float(self.a_g[i])!r}", self.omega)

    def picked(self, whole: bool) -> list[int]:
        """Indices of the last amplitude below the first fall and of the first fall; or
        of all.
        """
        first = min(self.first_fall, self.a_g.size - 1)
        return (
            list(range(self.a_g.size)) if whole else sorted({max(0, first - 1), first})
        )

    @property
    def first_fall(self) -> int:
        """The index of the first amplitude that falls; the number of amplitudes if none
        does.
        """
        return int(np.argmax(np.append(falls(self.outcome), True)))


def _grid(amplitudes: str, omega: float | None) -> Grid:
    return parse_grid(
        f"a_g={amplitudes}" + ("" if omega is None else f",omega_g={omega!r}"),
        own_time=omega is None,
    )


@cache
def sweep(system: str, motion: str) -> Sweep:
    """The sweep of a system under a motion, by `spectrum`."""
    structure, shaken = built(SYSTEMS[system]), MOTIONS[motion]()
    omega = None if motion == "short record" else OMEGA
    uplift = float(
        structure.ground_acceleration(
            governing_method(structure).system_of(structure).least_uplift(shaken)
        )
    )
    grid = _grid(f"{1.02 * uplift!r}:{8.0 * uplift!r}:{AMPLITUDES}:log", omega)
    found = spectrum([structure], shaken, grid, workers=1, check=0)
    return Sweep(
        structure,
        shaken,
        grid.amplitude.values,
        omega,
        found.outcome.ravel(),
        found.theta_ratio.ravel(),
    )


def pairs() -> Iterator[Any]:
    """(system, motion, True for the whole sweep): every system under a sine near its
    first fall, in the soak under all motions.
    """
    for system in SYSTEMS:
        if system not in SLOW:
            yield system, PULSE[0], False
        for motion in MOTIONS:
            if "vertical" not in motion or not any(
                word in system for word in NO_VERTICAL
            ):
                yield pytest.param(system, motion, True, marks=pytest.mark.soak)


def searched(few: tuple[str, ...]) -> Iterator[Any]:
    """Every system along whose amplitude a search takes less than minutes; `few`
    outside the soak.
    """
    for system in SYSTEMS:
        if system not in SLOW:
            yield pytest.param(system, marks=[pytest.mark.soak] * (system not in few))


@pytest.mark.parametrize(("system", "motion", "whole"), list(pairs()))
def test_check_and_response_find_the_outcome_of_the_spectrum(system, motion, whole):
    """The events of `response` too: the last one says how the body ends."""
    swept = sweep(system, motion)
    for i in swept.picked(whole):
        outcome, ratio, demand = (
            Outcome(int(swept.outcome[i])),
            swept.theta_ratio[i],
            swept.demand(i),
        )
        verdict = check(swept.structure, swept.motion, demand, a_max=None)
        history = time_history(swept.structure, swept.motion, demand)
        (summary,) = history.summaries()
        events = [row["event"] for row in history.events()]
        assert (verdict.outcome.flag, summary["outcome"]) == (
            outcome.flag,
            outcome.flag,
        ), (i, events[-3:])
        assert ("lost contact" in events) == (outcome == Outcome.LOST_CONTACT)
        assert ("overturning" in events) == outcome.overturned
        assert ("impact" in events) or outcome != Outcome.OVERTURNED_AFTER_IMPACT
        assert (
            (verdict.theta_ratio is None)
            == (summary["theta_ratio"] is None)
            == math.isnan(ratio)
        )
        for other in (
            () if math.isnan(ratio) else (verdict.theta_ratio, summary["theta_ratio"])
        ):
            assert other == pytest.approx(ratio, abs=TOLERANCE)


@pytest.mark.parametrize("system", list(searched(FEW)))
def test_the_intervals_of_an_envelope_hold_the_amplitudes_of_the_spectrum_that_fall(
    system,
):
    """An amplitude near the end of an interval may lie on either side of it, by the
    width of the narrowest one that is looked for.
    """
    swept = sweep(system, PULSE[0])
    structure, method = swept.structure, governing_method(swept.structure)
    amplitude = structure.dimensionless_amplitude(swept.a_g[: swept.first_fall + 2])
    limit = 1.001 * float(amplitude[-1])
    found = trace_envelope(
        structure,
        swept.motion,
        [OMEGA / structure.p],
        method=method,
        a_max=limit,
        sign="+",
        workers=1,
    )
    for a, code in zip(amplitude, swept.outcome, strict=False):
        modes = {
            x.mode
            for x in found
            if x.a_from <= a <= (math.inf if x.a_to is None else x.a_to)
        }
        assert modes == ({Outcome(int(code)).mode} if falls(code) else set()), a


@pytest.mark.parametrize("system", list(searched(FEW[:2])))
def test_solve_says_nowhere_from_the_first_amplitude_that_falls(system):
    """A range of one value: the document itself."""
    swept = sweep(system, PULSE[0])
    (document,) = parse_documents(SYSTEMS[system], "f.yaml")
    first = swept.first_fall
    for i, says in (
        ((first - 1, "stands everywhere"), (first, "stands nowhere"))
        if first < AMPLITUDES
        else ()
    ):
        (row,), _ = boundaries(
            document,
            Variation("gravity", (swept.structure.gravity,), None),
            [(swept.motion, swept.demand(i))],
            workers=1,
        )
        assert row.side == says
