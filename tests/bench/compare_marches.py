"""The march on floats against the march on arrays, or the march on arrays against that
of an older package, on random cells of which many lie near a change of the outcome.

`PYTHONPATH=tests python tests/bench/compare_marches.py --cells 100000 --seed 1` draws
scenes, each a body under a motion: every kind of edge, both equations, arches,
mechanisms, damping, vertical motion, pulses and records. In a scene it follows rows of
amplitudes, and narrows every change of the outcome to 1e-6 of the amplitude by
sections. Every cell that is computed on the way is compared. Cells whose outcomes
differ are computed again with tolerance 1e-13 by both marches, at five amplitudes
within 2e-12, and listed. So are cells whose rotations differ by more than 1e-8 (a few
of each scene): they count as `conditioned` if the march on floats is within 1e-9 times
1 + d theta/d ln A of the finer one. `--only` is a pattern of kinds and motions, such as
`arch` or `plain.*record`. `--stocky` draws free bodies of alpha from 0.4 to 1.1, which
may lose contact with the ground. `--tied` draws bodies with ties and a tendon; what a
package without vertical motion under them knows is `--only "tied (?!.*vertical)"`. With
`--base DIR` the package in DIR takes the place of the march on floats, in a process of
its own; its systems must hold their restitution.
"""

import argparse
import os
import pickle
import re
import subprocess
import sys
import time
from collections import Counter
from typing import NamedTuple

import numpy as np
from support.bodies import ARCH, random_body
from support.synthetic_records import motion_of_samples
from support.tied_bodies import random_tied

from rocking_cli import Method, Motion, System, pulse, response, sine
from rocking_cli.dynamics.outcome import Outcome, safe
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical

GRID, PARTS, ROUNDS = 20, 6, 7
NEAR = np.array([-1e-2, -3e-3, -1e-3, -1e-4, 1e-4, 1e-3, 3e-3, 1e-2])
APART, LOOKED_AT = (
    1e-8,
    2,
)  # rotations that differ by more are looked at, so many a scene
OUTCOMES = 12  # outcomes that differ and are looked at, so many a scene
# rows of Omega and eta of a scene; more of them make a scene of more cells
ROWS = int(os.environ.get("COMPARED_ROWS", "12"))
# scenes of tied bodies, and of stocky ones, have numbers from here on
TIED, STOCKY = 10**9, 2 * 10**9
EDGES = (
    "plain",
    "unequal",
    "one-sided",
    "plain damped",
    "unequal damped",
    "one-sided damped",
)
PULSES = (
    "sine",
    "cosine",
    "half-sine",
    "rectangular",
    "rectangular-impulse",
    "ricker-symmetric",
    "ricker-antisymmetric",
    "mavroeidis-papageorgiou",
)


Found = tuple[int, float]  # code of the outcome, theta_ratio


class Scene(NamedTuple):
    """A body under a motion, at rows of Omega and eta."""

    name: str
    model: str
    body: object
    motion: Motion
    omega: np.ndarray  # (rows,)
    eta: np.ndarray  # (rows,)

    def system(self, tolerance: float) -> System:
        return Method(self.model, tolerance).system_of(self.body)


def record(random: np.random.Generator, dt: float, count: int) -> Motion:
    """A record of several frequencies, with quiet parts, late shocks or jumps."""
    t = np.arange(count) * dt
    s = np.zeros(count)
    for _ in range(random.integers(1, 6)):
        middle, width = random.uniform(0.0, t[-1]), random.uniform(0.05, 0.5) * t[-1]
        f = random.uniform(0.4, 0.2 / dt)
        wave = np.sin(2.0 * np.pi * f * t + random.uniform(0.0, 6.3))
        s += random.uniform(0.2, 1.0) * wave * np.exp(-(((t - middle) / width) ** 2))
    s += 0.2 * random.standard_normal(count)
    if random.random() < 0.4:
        first = random.integers(count)
        s[first : first + random.integers(1, count)] = 0.0
    if random.random() < 0.4:
        s[-count // 3 :] *= random.uniform(2.0, 6.0)
    if random.random() < 0.3:
        s[random.integers(count) :] += random.choice([-1.0, 1.0])
    s[-1] = 0.0 if random.random() < 0.7 else s[-1]
    if not np.any(s):
        s[count // 2] = 1.0
    return motion_of_samples(s, dt)


def motion_of(random: np.random.Generator, vertical: bool) -> Motion:
    kind = random.choice(
        ["pulse", "cycles", "pieces", "record"], p=[0.5, 0.15, 0.1, 0.25]
    )
    if kind == "record":
        dt = float(random.choice([0.0008, 0.004, 0.01, 0.02, 0.05]))
        count = int(random.integers(60, 1200 if random.random() < 0.2 else 300))
        made = record(random, dt, count)
        if vertical:
            up = record(random, dt, count)
            made = with_vertical(made, up, float(random.uniform(0.1, 0.8)))
        return made
    if kind == "pulse":
        made = pulse(str(random.choice(PULSES)))
    elif kind == "cycles":
        made = sine(float(random.choice([1.5, 2.0, 3.0, 5.0])))
    else:
        made = pieces(random)
    if random.random() < 0.3:
        made = made.scaled(-1)
    if vertical:
        up = pulse(str(random.choice(PULSES[:5])))
        made = with_vertical(made, up, float(random.uniform(0.1, 0.8)))
    return made


def pieces(random: np.random.Generator) -> Motion:
    """Pieces of two sinusoids with jumps between them, and a quiet one."""
    found, start = [], 0.0
    for i in range(random.integers(2, 5)):
        stop = start + random.uniform(0.5, 6.0)
        waves = tuple(
            Harmonic(
                random.uniform(0.2, 1.0),
                random.uniform(0.3, 4.0),
                random.uniform(0.0, 6.3),
            )
            for _ in range(0 if i == 1 else random.integers(1, 3))
        )
        found.append(Piece(start, stop, waves))
        start = stop
    made = Motion("pieces", tuple(found))
    return made.scaled(1.0 / made.largest)


def scene(seed: int) -> Scene:
    """The scene of this number."""
    random = np.random.default_rng(seed)
    if TIED <= seed < STOCKY:
        return tied_scene(random)
    edges = EDGES[seed % len(EDGES)]
    model = ("linear", "nonlinear")[seed // len(EDGES) % 2]
    vertical = random.random() < 0.2
    motion = motion_of(random, vertical)
    eta = random.uniform(0.0, 1.0, ROWS)
    eta[0] = random.choice([0.0, 0.5, 0.95, 0.99])
    if random.random() < 0.08:
        edges, model, body = "arch", "nonlinear", ARCH
    else:
        low = 10.0 ** random.uniform(-2.0, 0.0)
        alpha = (low, min(1.2, 1.1 * low)) if seed < STOCKY else (0.4, 1.1)
        body, _, _ = random_body(f"{edges} {model}", random, alpha, (0.3, 0.99), 0.3)
        if "one-sided" in edges:
            eta = -np.minimum(eta, 0.98)
    of_record = motion.samples is not None
    omega = (
        1.0 / random.uniform(0.7, 7.0, ROWS)
        if of_record
        else 10.0 ** random.uniform(-0.5, 1.3, ROWS)
    )
    shaking = "record" if of_record else motion.name
    name = f"{model} {edges}{' vertical' * vertical} under {shaking}"
    return Scene(name, model, body, motion, omega, eta)


def tied_scene(random: np.random.Generator) -> Scene:
    """A body with ties and a tendon, slender or stocky."""
    vertical = random.random() < 0.2
    motion, model = motion_of(random, vertical), random.choice(["linear", "nonlinear"])
    body = random_tied(random, (0.05, 0.95))
    eta = random.uniform(0.3, 0.99, ROWS)
    eta = -eta if body.one_sided else eta
    of_record = motion.samples is not None
    omega = 10.0 ** random.uniform(-0.5, 1.3, ROWS)
    if of_record:
        omega = 1.0 / random.uniform(0.7, 7.0, ROWS)
    shaking = "record" if of_record else motion.name
    kind = "one-sided" if body.one_sided else "plain"
    name = f"{model} tied {kind}{' damped' * bool(body.damping)}"
    name += f"{' vertical' * vertical} under {shaking}"
    return Scene(name, str(model), body, motion, omega, eta)


def cells_of(
    one: Scene, system: System
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(A, row, outcome, rotation, True within 1 % of a change) of the cells of a scene,
    by the march on arrays.
    """
    random = np.random.default_rng(len(one.name))
    uplift = system.least_uplift(one.motion)
    if not np.isfinite(uplift):
        return tuple(np.zeros(0) for _ in range(5))

    def outcomes(a: np.ndarray, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = response(system, one.motion, a, one.omega[row], one.eta[row])
        return found.outcome, found.theta_ratio

    a = (
        uplift
        * np.geomspace(0.98, 12.0, GRID)
        * np.exp(0.1 * random.uniform(0.0, 1.0, (ROWS, 1)))
    )
    row = np.repeat(np.arange(ROWS), GRID)
    a = a.ravel()
    code, ratio = outcomes(a, row)
    every = [(a, row, code, ratio)]
    # Changes between neighbours, narrowed by sections.
    changed = np.flatnonzero((row[1:] == row[:-1]) & (code[1:] != code[:-1]))
    low, high, own = a[changed], a[changed + 1], row[changed]
    first, last = code[changed], code[changed + 1]
    share = np.arange(1, PARTS)[:, None] / PARTS
    for _ in range(ROUNDS if low.size else 0):
        inner = low + (high - low) * share
        rows = np.broadcast_to(own, inner.shape)
        code, ratio = outcomes(inner.ravel(), rows.ravel())
        every.append((inner.ravel(), rows.ravel(), code, ratio))
        marks = np.concatenate([low[None], inner, high[None]])
        codes = np.concatenate([first[None], code.reshape(inner.shape), last[None]])
        at, lane = np.argmax(codes[1:] != codes[:-1], axis=0), np.arange(low.size)
        low, high = marks[at, lane], marks[at + 1, lane]
        first, last = codes[at, lane], codes[at + 1, lane]
    if low.size:
        near = (high * (1.0 + NEAR[:, None])).ravel()
        rows = np.tile(own, NEAR.size)
        every.append((near, rows, *outcomes(near, rows)))
    a, row, code, ratio = (np.concatenate(x) for x in zip(*every, strict=True))
    close = np.zeros(a.size, dtype=bool)
    for edge, k in zip(high, own, strict=True):
        close |= (row == k) & (np.abs(a - edge) <= 0.01 * edge)
    return a, row, code, ratio, close


class Other:
    """Answers of the march on floats of this package or, with a folder, of the march on
    arrays of the package there.
    """

    def __init__(self, folder: str) -> None:
        self.name, self.seconds, self._process = "floats", 0.0, None
        if folder:
            self.name = "base"
            paths = [folder, *sys.path[:1], *os.environ["PYTHONPATH"].split(":")]
            self._process = subprocess.Popen(
                [sys.executable, __file__, "--serve"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, "PYTHONPATH": ":".join(paths)},
            )

    def answers(
        self, number: int, tolerance: float, a: np.ndarray, row: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(outcomes, rotations) of cells of the scene of this number."""
        begun = time.process_time()
        if self._process is None:
            one = scene(number)
            found = response(
                one.system(tolerance),
                one.motion,
                a,
                one.omega[row],
                one.eta[row],
                how="floats",
            )
            self.seconds += time.process_time() - begun
            return found.outcome, found.theta_ratio
        pickle.dump((number, tolerance, a, row), self._process.stdin)
        self._process.stdin.flush()
        code, ratio, seconds = pickle.load(self._process.stdout)
        self.seconds += seconds
        return code, ratio


def serve() -> None:
    """Answer each question of `Other` that comes on standard input."""
    while True:
        try:
            number, tolerance, a, row = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        one, begun = scene(number), time.process_time()
        system = one.system(tolerance)
        try:
            found = response(system, one.motion, a, one.omega[row], one.eta[row])
            codes, ratios = found.outcome, found.theta_ratio
        except Exception as error:  # of an older package, which is said
            print(f"{number}: {error!r}", file=sys.stderr)
            codes, ratios = np.full(a.size, Outcome.FAILED), np.full(a.size, np.nan)
        seconds = time.process_time() - begun
        pickle.dump((codes, ratios, seconds), sys.stdout.buffer)
        sys.stdout.buffer.flush()


def differing(
    one: np.ndarray, other: np.ndarray, x: np.ndarray, y: np.ndarray
) -> np.ndarray:
    """True where outcomes differ, or rotations of standing bodies."""
    both = safe(one) & safe(other)
    with np.errstate(invalid="ignore"):
        return (one != other) | (both & (np.abs(x - y) > APART))


def explained(
    number: int, a: float, row: int, found: Found, arrays: Found, other: Other
) -> tuple[str, str]:
    """(a word for a difference, what both marches find with tolerance 1e-13)."""
    one = scene(number)
    system = one.system(1e-13)
    around = a * (1.0 + 1e-12 * np.arange(-2, 3))
    cells = one.motion, around, one.omega[row], one.eta[row]
    mine = response(system, *cells, how="arrays")
    codes, _ = other.answers(number, 1e-13, around, np.full(5, row))
    told = (
        f"{one.name}: A {a!r} Omega {float(one.omega[row])!r} eta"
        f" {float(one.eta[row])!r}: {other.name} {found}, arrays {arrays}; at 1e-13"
        f" {other.name} {codes.tolist()}, arrays {mine.outcome.tolist()}"
    )
    if found[0] != arrays[0]:
        every = {*codes.tolist(), *mine.outcome.tolist()}
        if len(every) > 1:
            return "outcome nobody knows", told
        wrong = "arrays" if found[0] in every else other.name.upper()
        return f"outcome {wrong} wrong", told
    at, width = mine.theta_ratio[2], 1e-9
    near = np.array([1.0 - width, 1.0 + width])
    beside = response(system, one.motion, a * near, *cells[2:]).theta_ratio
    condition = float(np.nanmax(np.abs(beside - at)) / width)
    errors = [abs(x[1] - at) for x in (found, arrays)]
    nearer = other.name if errors[0] < errors[1] else "arrays"
    told += (
        f" {at:.12g} condition {condition:.2g} errors {errors[0]:.1e} {errors[1]:.1e}"
    )
    # The march on floats is on trial, or that on arrays against an older one.
    if errors[other.name == "base"] <= 1e-9 * (1.0 + condition):
        return f"rotation conditioned, {nearer} nearer", told
    return f"rotation, {nearer} nearer", told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--cells", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="")
    parser.add_argument("--base", default="")
    parser.add_argument("--tied", action="store_true")
    parser.add_argument("--stocky", action="store_true")
    parser.add_argument("--serve", action="store_true")
    asked = parser.parse_args()
    if asked.serve:
        serve()
        return
    counts, near, listed = Counter(), 0, Counter()
    other, spent = Other(asked.base), 0.0
    number = asked.seed * 1_000_000 + TIED * asked.tied + STOCKY * asked.stocky
    while counts.total() < asked.cells:
        one, number = scene(number), number + 1
        if not re.search(asked.only, one.name):
            continue
        system = one.system(1e-9)
        begun = time.process_time()
        a, row, code, ratio, close = cells_of(one, system)
        spent += time.process_time() - begun
        if not a.size:
            continue
        codes, ratios = other.answers(number - 1, 1e-9, a, row)
        if np.all(codes == Outcome.FAILED) and not np.all(code == Outcome.FAILED):
            listed[f"scenes that {other.name} refuses"] += 1
            continue
        counts[
            re.sub(" under .*", "", one.name)
            + " "
            + ("record" if one.motion.samples else "pulse")
        ] += a.size
        near += int(close.sum())
        print(f"\r{counts.total():,} cells", end="", file=sys.stderr, flush=True)
        same = codes == code
        apart = differing(codes, code, ratios, ratio)
        some = np.flatnonzero(apart & same)
        others = np.flatnonzero(apart & ~same)
        listed["outcome, not looked at"] += max(0, others.size - OUTCOMES)
        for i in [*others[:OUTCOMES], *some[:LOOKED_AT]]:
            found = int(codes[i]), float(ratios[i])
            arrays = int(code[i]), float(ratio[i])
            word, told = explained(
                number - 1, float(a[i]), int(row[i]), found, arrays, other
            )
            listed[word] += 1
            if "conditioned" not in word:
                print(f"{number - 1} {word}: {told}", flush=True)
        listed["rotation, not looked at"] += max(0, some.size - LOOKED_AT)
    for kind, n in sorted(counts.items()):
        print(f"{n:9,} {kind}")
    print(f"{counts.total():,} cells, {near:,} within 1 % of a change of the outcome")
    print("differences:", dict(listed) or "none")
    print(f"processor seconds: {other.name} {other.seconds:.1f}, arrays {spent:.1f}")


if __name__ == "__main__":
    main()
