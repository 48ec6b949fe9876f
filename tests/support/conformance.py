"""The table of systems and motions for which `test_conformance.py` states what must
hold, with the answer of an integration that shares no code.

A new equation, contact or device gets its tests by one row of SYSTEMS. Its answers by
the integration are computed each time until `PYTHONPATH=tests python
tests/test_conformance.py` has stored them; the soak computes all of them again.
"""

import json
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from oracles.collocation import Body, Edge, Shaking, Step, integrate
from oracles.ground_forces import asked
from oracles.tied_body import Device, TiedBody
from scipy.optimize import brentq
from support.bodies import shaking
from support.documents import built

from rocking_cli import (
    Grid,
    Motion,
    Outcome,
    RockingParameters,
    parse_grid,
    pulse,
    sine,
    spectrum,
)
from rocking_cli.dynamics.method import governing_method
from rocking_cli.dynamics.outcome import falls
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline

Document = dict[str, Any]  # all numbers in SI units, without a unit
Answer = tuple[str, float]  # flag of the outcome, largest |theta|/alpha; NaN: none

# a low restitution, so that the bounces of a tied body end soon
TIED = {"kind": "block", "width": 0.9, "height": 3, "mass": 2000, "restitution": 0.6}
STOCKY = {"kind": "block", "width": 1.3, "height": 2, "mass": 500}
WIDE = {"kind": "block", "width": 1.9, "height": 2}  # it may leave the ground
SYSTEMS: dict[str, Document] = {
    "symmetric": {"kind": "block", "width": 0.5, "height": 2, "restitution": 0.9},
    "unequal edges": {
        "kind": "rigid",
        "left": 0.42,
        "right": 0.31,
        "height": 1.15,
        "gyration": 0.68,
    },
    "one-sided": {"kind": "wall", "thickness": 0.6, "height": 6, "one_sided": True},
    "damped": {
        "kind": "block",
        "width": 0.5,
        "height": 2,
        "restitution": 0.7,
        "damping": 0.05,
    },
    "stocky": {**WIDE, "restitution": 0.6},
    "stocky, damped": {**WIDE, "restitution": 0.6, "damping": 0.1},
    "stocky, unequal edges": {
        "kind": "rigid",
        "left": 0.8,
        "right": 0.7,
        "height": 1,
        "gyration": 0.5,
        "restitution": 0.5,
    },
    "stocky, one-sided": {**WIDE, "one_sided": True, "restitution": -0.4},
    "arch": {
        "kind": "arch",
        "radius": 10,
        "angle": 2.748893571891069,
        "thickness": 1.5,
        "voussoirs": 7,
    },
    "frame": {
        "kind": "frame",
        "columns": 6,
        "width": 0.9,
        "height": 6.5,
        "cap_ratio": 1.2,
    },
    "point mass": {"kind": "point_mass", "width": 1.2, "height": 4},
    "parameters": {
        "kind": "parameters",
        "p": 1.84,
        "alpha": 0.0690626785,
        "eta": 0.9,
        "lambda": 0.37,
    },
    "tied on one side": {
        **TIED,
        "ties": [{"height": 2.8, "stiffness": 1e6, "side": "right"}],
    },
    "tied on two sides": {
        **TIED,
        "ties": [
            {"height": 2.8, "stiffness": 1e5, "side": "both"},
            {"height": 1, "stiffness": 1e6, "side": "left"},
        ],
    },
    "tied, one-sided": {
        "kind": "wall",
        "thickness": 0.6,
        "height": 6,
        "one_sided": True,
        "mass": 7200,
        "ties": [
            {
                "height": 5.5,
                "stiffness": 2e6,
                "prestress": 5e3,
                "yield": 20e3,
                "ultimate": 0.2,
            }
        ],
    },
    "tied, damped": {
        **TIED,
        "damping": 0.05,
        "ties": [{"height": 2.8, "stiffness": 1e5, "side": "both"}],
    },
    "rupturing tie": {
        **TIED,
        "ties": [
            {
                "height": 2.8,
                "stiffness": 1e5,
                "prestress": 1e3,
                "ultimate": 0.02,
                "side": "both",
            }
        ],
    },
    "yielding tie": {
        **TIED,
        "ties": [
            {
                "height": 2.8,
                "stiffness": 1e6,
                "prestress": 1e3,
                "yield": 4e3,
                "side": "both",
            }
        ],
    },
    "tendon": {
        **TIED,
        "tendon": {"stiffness": 1e5, "prestress": 6e3, "rupture": 30e3},
    },
    "dampers": {**TIED, "dampers": {"coefficient": 500}},
    "stocky, tied on one side": {
        **STOCKY,
        "ties": [{"height": 2, "stiffness": 2e6, "side": "right"}],
    },
    "stocky, tied on two sides": {
        **STOCKY,
        "ties": [{"height": 2, "stiffness": 1e5, "side": "both"}],
    },
    "stocky, tied, damped": {
        **STOCKY,
        "damping": 0.1,
        "ties": [{"height": 2, "stiffness": 2e6, "side": "right"}],
    },
    "stocky, prestressed": {
        **STOCKY,
        "ties": [{"height": 2, "stiffness": 2e5, "prestress": 1e3, "side": "both"}],
    },
    "stocky, tendon": {
        **STOCKY,
        "tendon": {"stiffness": 1e5, "prestress": 4e3, "rupture": 12e3},
    },
}
SLOW = ("arch",)  # its spectrum takes seconds: in the soak


def short_record(step: float = 0.1) -> Motion:
    """Straight lines between 24 samples so many seconds apart, with a peak of 1."""
    t = np.arange(25)
    s = np.sin(0.9 * t) * np.exp(-0.12 * t) * np.sin(0.4 + 0.13 * t)
    s[0] = s[-1] = 0.0
    s /= np.abs(s).max()
    t = step * t
    return Polyline("short record", t[:-1], t[1:], s[:-1], np.diff(s) / step, 1.0)


# by name, functions of how many times as long a second lasts, for those in own time
MOTIONS: dict[str, Callable[[float], Motion]] = {
    "one sine": lambda _: sine(),
    "one sine, reversed": lambda _: sine().scaled(-1.0),
    # to the right: a one-sided body lifts off
    "half sine": lambda _: pulse("half-sine").scaled(-1.0),
    "ricker": lambda _: pulse("ricker-symmetric"),
    "rectangular impulse": lambda _: pulse("rectangular-impulse"),
    "short record": lambda longer: short_record(0.1 * longer),
    "pulse with a vertical one": lambda _: with_vertical(sine(), sine(1.5), 0.4),
}
IN_OWN_TIME = ("short record",)
OMEGA = 2.0 * math.pi * 1.5  # omega_g of a pulse [rad/s]
AMPLITUDES = 12  # of a sweep, from just above uplift to eight times that


def takes_a_vertical_motion(system: str) -> bool:
    """False for bodies with ties or a tendon, and without the mass of a rigid body."""
    document = SYSTEMS[system]
    kept = document["kind"] not in ("parameters", "arch", "frame")
    return kept and not document.keys() & {"ties", "tendon", "dampers"}


# Of a body four times as long, twice as heavy: times are twice as long, forces twice as
# large. By key; a key that is not listed has no unit.
LONGER, HEAVIER, SLOWER = 4.0, 2.0, 2.0
SCALED = {
    **dict.fromkeys(
        ("width", "height", "thickness", "left", "right", "gyration", "radius"), LONGER
    ),
    **dict.fromkeys(("ultimate", "behind"), LONGER),
    **dict.fromkeys(("mass", "prestress", "yield", "rupture"), HEAVIER),
    "stiffness": HEAVIER / LONGER,
    "coefficient": HEAVIER / (LONGER / SLOWER),
    "p": 1.0 / SLOWER,
}
OTHER_SIDE = {"left": "right", "right": "left"}
SIDES = {"right": (1,), "left": (-1,), "both": (1, -1)}  # of ties, as theta has signs


def scaled(document: Any) -> Any:
    """The document of the larger and heavier body."""
    if isinstance(document, dict):
        return {
            key: SCALED[key] * value if key in SCALED else scaled(value)
            for key, value in document.items()
        }
    return [scaled(x) for x in document] if isinstance(document, list) else document


def mirrored(document: Any) -> Any:
    """The document of the body turned round."""
    if isinstance(document, dict):
        return {
            OTHER_SIDE.get(key, key): (
                OTHER_SIDE.get(value, value) if key == "side" else mirrored(value)
            )
            for key, value in document.items()
        }
    return [mirrored(x) for x in document] if isinstance(document, list) else document


@dataclass(frozen=True)
class Sweep:
    """The outcomes of a system along the amplitude of a motion."""

    document: Document  # of the structure
    structure: RockingParameters
    motion: Motion
    a_g: np.ndarray  # amplitudes [m/s2], (amplitudes,)
    omega: float | None  # omega_g [rad/s]; None for a record in its own time
    outcome: np.ndarray  # codes of `Outcome` by `spectrum`, (amplitudes,)
    theta_ratio: np.ndarray  # by `spectrum` [-], (amplitudes,)

    def demand(self, i: int) -> Grid:
        """The amplitude of this index, as a grid of one cell."""
        return _grid(f"{float(self.a_g[i])!r}", self.omega)

    def grid(self) -> Grid:
        """All amplitudes, as a grid of one frequency."""
        ends = f"{float(self.a_g[0])!r}:{float(self.a_g[-1])!r}"
        return _grid(f"{ends}:{self.a_g.size}:log", self.omega)

    def cells(self) -> tuple[np.ndarray, float, float]:
        """A, Omega and eta, as `response` takes them."""
        pace = 1.0 if self.omega is None else self.omega
        amplitude = self.structure.dimensionless_amplitude(self.a_g)
        return amplitude, pace / self.structure.p, self.structure.eta

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


def structure_of(document: Document) -> RockingParameters:
    """The structure of a document."""
    return built(yaml.safe_dump(document))


@cache
def sweep(system: str, motion: str) -> Sweep:
    """The sweep of a system under a motion."""
    structure, ground = structure_of(SYSTEMS[system]), MOTIONS[motion](1.0)
    omega = None if motion in IN_OWN_TIME else OMEGA
    uplift = float(
        structure.ground_acceleration(
            governing_method(structure).system_of(structure).least_uplift(ground)
        )
    )
    grid = _grid(f"{1.02 * uplift!r}:{8.0 * uplift!r}:{AMPLITUDES}:log", omega)
    return swept(SYSTEMS[system], ground, grid)


def swept(document: Document, motion: Motion, grid: Grid) -> Sweep:
    """The sweep of a document over the amplitudes of a grid of one frequency."""
    structure = structure_of(document)
    found = spectrum([structure], motion, grid, workers=1, check=0)
    return Sweep(
        document,
        structure,
        motion,
        grid.amplitude.values,
        None if motion.acceleration else float(grid.frequency.values[0]),
        found.outcome.ravel(),
        found.theta_ratio.ravel(),
    )


def devices(document: Document) -> list[Device]:
    """The ties and the tendon of a block as the integration takes them."""
    found = [
        Device(
            side,
            tie["stiffness"],
            tie.get("prestress", 0.0),
            tie.get("yield", math.inf),
            tie.get("ultimate", math.inf),
            tie["height"],
            tie.get("behind", 0.0),
        )
        for tie in document.get("ties", ())
        for side in SIDES[tie.get("side", "right")]
    ]
    if tendon := document.get("tendon"):
        stiffness, prestress = tendon["stiffness"], tendon["prestress"]
        longest = (tendon["rupture"] - prestress) / stiffness
        lever = 0.5 * document["width"]
        found += [
            Device(s, stiffness, prestress, math.inf, longest, lever, tendon=True)
            for s in (1, -1)
        ]
    return found


def body_of(swept: Sweep) -> Body:
    """The body of a sweep as the integration takes it; of the package, only p, alpha,
    eta and zeta are taken.
    """
    s, tied = swept.structure, devices(swept.document)
    if tied:
        mass = float(swept.document["mass"])
        inertia = mass * s.gravity * s.arm / s.p**2
        return TiedBody(mass, s.arm, s.alpha, inertia, s.eta, tied, s.damping)
    linear = governing_method(s).model == "linear"
    if s.sides:
        left, right = (Edge(e.p, e.alpha, e.eta, e.a_scale) for e in s.sides)
    else:
        left = right = Edge(s.p, s.alpha, s.eta, s.a_scale)
    return Body(right, None if s.one_sided else left, s.damping, not linear, s.gravity)


# the answers of the integration by system, motion and amplitude [m/s2]
ANSWERS = Path(__file__).parents[1] / "oracles" / "answers.json"


@cache
def stored() -> dict[str, dict[str, dict[str, list[Any]]]]:
    """The answers that are stored, null for NaN."""
    return json.loads(ANSWERS.read_text(encoding="utf-8"))


def answer(system: str, motion: str, i: int) -> Answer:
    """The answer of the integration to an amplitude of a sweep: the one that is stored
    for this amplitude, to 12 digits, or a new one.
    """
    found = sweep(system, motion)
    kept = stored().get(system, {}).get(motion, {}).get(f"{found.a_g[i]:.12g}")
    if kept is None:
        return integrated(found, i)
    return kept[0], math.nan if kept[1] is None else kept[1]


def integrated(swept: Sweep, i: int) -> Answer:
    """(flag of the outcome, largest |theta|/alpha) of an amplitude by the integration;
    a body that does not overturn and whose Fz vanishes has lost contact.
    """
    s, motion, pace = swept.structure, swept.motion, swept.omega or 1.0
    body, a_g = body_of(swept), float(swept.a_g[i])
    if isinstance(body, TiedBody):
        still = motion.still_until(motion.duration + 12.0 * pace / s.p)
        return _tied(body, devices(swept.document), shaking(still, a_g, pace))
    ground = shaking(motion, a_g, pace)
    if s.arm is None:
        answer, least = integrate(body, ground), 1.0
    else:
        answer, _, least = asked(
            body, s.arm, ground, s.sides[0].arm if s.sides else None
        )
    lost = answer.outcome in ("rocked", "no_uplift") and least <= 0.0
    if motion.vertical is not None:
        lost |= _ground_falls_away(body, ground)
    flag = Outcome.LOST_CONTACT.flag if lost else answer.outcome
    return flag, math.nan if lost else answer.rotation


def _ground_falls_away(body: Body, ground: Shaking) -> bool:
    """True if g + zg <= 0 occurs before the body has turned by 3 alpha."""
    instant = _first_weightless(body.gravity, ground)
    if instant is None:
        return False
    turned: list[float] = []  # |theta|/alpha at the instant, or from rest after it

    def seen(side: int, step: Step) -> None:
        if step.t + step.h > instant:
            part = max(0.0, (instant - step.t) / step.h)
            turned.append(float(step.height(part)) / body.edge(side).alpha)

    answer = integrate(body, ground, seen=seen)
    return turned[0] < 3.0 if turned else not answer.outcome.startswith("overturned")


def _first_weightless(gravity: float, ground: Shaking) -> float | None:
    """The first instant with g + zg <= 0; None without one."""

    def weight(t: Any) -> Any:
        return gravity + ground.up(t)

    for start, stop in pairwise((0.0, *ground.marks)):
        inset = 1e-13 * (stop - start)
        times = np.linspace(start + inset, stop - inset, 65)
        below = weight(times) <= 0.0
        if below[0]:
            return start
        if below.any():
            i = int(np.argmax(below))
            return float(brentq(weight, times[i - 1], times[i]))
    return None


def _tied(body: TiedBody, fresh: list[Device], ground: Shaking) -> tuple[str, float]:
    """The same of a tied body, whose integration does not tell how it overturns."""
    largest, fell = body.run(ground)
    body.devices = fresh
    if not fell and body.lowest_fz(ground) <= 0.0:
        return Outcome.LOST_CONTACT.flag, math.nan
    return ("overturned", math.nan) if fell else ("rocked", largest)


def store(pairs: Iterable[tuple[str, str]]) -> None:
    """Store the answers of the integration to what the tests ask of these pairs."""
    found: dict[str, dict[str, dict[str, list[Any]]]] = {}
    for system, motion in pairs:
        along = sweep(system, motion)
        kept = found.setdefault(system, {}).setdefault(motion, {})
        for i in along.picked(False):
            flag, ratio = integrated(along, i)
            kept[f"{along.a_g[i]:.12g}"] = [flag, None if math.isnan(ratio) else ratio]
    text = json.dumps(found, indent=1)
    ANSWERS.write_text(text + "\n", encoding="utf-8")
