"""Every check of random bodies, by this package and by an older one: which outcomes
and which capacities differ, and in which digit.

`PYTHONPATH=tests python tests/bench/compare_checks.py --base DIR` takes turns with the
package in DIR. The bodies are blocks, rigid bodies with unequal sides, frames,
one-sided walls, damped walls, spires, arches, tied walls and blocks that slide; the
motions are two records, the record of `configs/motions` and pulses, some of several
cycles, with a vertical component, in both directions, or over a range of frequencies;
under records some of the bodies are damped.
`--cases` is their number, `--seed` the first of them, `--only` a pattern that the call
must contain, such as `f-g [0-9.]+:` or `--motion`; `--kept FILE` is a file for the
answers of the base, which a second comparison then reads.
"""

import argparse
import contextlib
import io
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from support.synthetic_records import at2_file, far_shock, near_shock

HERE = Path(__file__).resolve().parents[2]
NUMBERS = (
    "first_overturning_a",
    "safe_to",
    "uplift_a",
    "theta_ratio",
    "worst_f_g",
    "falls_nearby",
)
WORDS = ("outcome", "outcome_linear", "worst_f_g_end")
# part of the lines on standard error that carries a verdict
OPPOSITE = "the opposite direction"
SAME = 15  # digits of equal numbers
PULSES = ("sine", "cosine", "ricker-symmetric", "half-sine")
# answers each line of standard input, a document and the words of a call
SERVER = "import compare_checks; compare_checks.serve()"


class Case(NamedTuple):
    """A call of `rocking check`."""

    document: str  # the structure, as YAML
    words: tuple[str, ...]  # the demand


def body_of(kind: str, draw: np.random.Generator) -> tuple[str, float]:
    """Return a random body of a kind as YAML, and about its least uplift over g."""
    height = draw.uniform(1.0, 4.0)
    slender = draw.uniform(0.15, 0.4)
    width = slender * height
    block = f"kind: block\nwidth: {width:.4f}\nheight: {height:.4f}\n"
    facade = f"kind: wall\nthickness: {width:.4f}\nheight: {height:.4f}\n"
    if kind == "block":
        return block, slender
    if kind == "slider":
        return f"{block}friction: {draw.uniform(0.8, 1.3) * slender:.4f}\n", slender
    if kind == "rigid":
        left, right = (draw.uniform(0.7, 1.3) * 0.5 * width for _ in range(2))
        mass_centre, gyration = 0.5 * height, draw.uniform(0.5, 0.7) * height
        return (
            f"kind: rigid\nleft: {left:.4f}\nright: {right:.4f}\n"
            f"height: {mass_centre:.4f}\ngyration: {gyration:.4f}\n"
        ), slender
    if kind == "frame":
        cap = draw.uniform(0.2, 1.5)
        return (
            f"kind: frame\ncolumns: 4\nwidth: {width:.4f}\nheight: {height:.4f}\n"
            f"cap_ratio: {cap:.4f}\n"
        ), slender
    if kind == "damped":
        zeta = draw.uniform(0.005, 0.05)
        return f"{facade}one_sided: true\ndamping: {zeta:.4f}\n", slender
    if kind == "one-sided":
        return f"{facade}one_sided: true\n", slender
    if kind == "spire":
        radius = 0.4 * width
        return (
            f"kind: spire\nbase_radius: {radius:.4f}\nheight: {height:.4f}\n",
            slender,
        )
    if kind == "arch":
        thickness = draw.uniform(1.3, 1.7)
        return (
            "kind: arch\nradius: 10\nangle: 157.5 deg\nvoussoirs: 7\n"
            f"thickness: {thickness:.4f}\n"
        ), 0.35
    weight, held = 9810.0 * width * height, draw.uniform(0.02, 0.2)
    return (
        f"{facade}one_sided: true\nmass: {weight / 9.81:.1f}\nties:\n"
        f"  - {{height: {0.9 * height:.4f}, stiffness: {3e6 * width:.1f},"
        f" yield: {held * weight:.1f}, ultimate: 0.3, side: right}}\n"
    ), slender * (1.0 + held)


KINDS = (
    "block",
    "rigid",
    "frame",
    "one-sided",
    "damped",
    "spire",
    "arch",
    "tied",
    "slider",
)


def pulse_of(
    kind: str, a_g: str, frequency: float, draw: np.random.Generator
) -> tuple[str, ...]:
    """Return the words of a random pulse."""
    name = PULSES[draw.integers(len(PULSES))]
    ranged = draw.uniform() < 0.4 and kind != "slider"
    last = f":{frequency * draw.uniform(1.2, 3.0):.3f}" if ranged else ""
    words = ["--a-g", a_g, "--f-g", f"{frequency:.3f}{last}", "--pulse", name]
    if draw.uniform() < (0.5 if ranged else 0.1):
        words.append("--verdict-only")
    if name in ("sine", "cosine") and draw.uniform() < 0.3:
        words += ["--cycles", str(draw.integers(2, 5))]
    if draw.uniform() < 0.15 and kind not in ("arch", "slider", "tied"):
        factor = f"{draw.uniform(0.2, 0.7):.3f}"
        words += ["--vertical", "sine", "--vertical-scale", factor]
    if draw.uniform() < 0.3:
        words += ["--sign", "both"]
    return tuple(words)


def record_of(
    document: str, a_g: str, draw: np.random.Generator
) -> tuple[str, tuple[str, ...]]:
    """Return (the document, damped by chance, the words of a random record)."""
    records = ("near.at2", "far.at2", "synthetic.at2")
    record, up = (records[i] for i in draw.integers(len(records), size=2))
    words: tuple[str, ...] = ("--motion", record, "--scale-to", f"PGA={a_g}")
    kind = document.split()[1]
    if draw.uniform() < 0.4 and not re.search("arch|friction|ties", document):
        factor = f"{draw.uniform(-0.7, 0.7):.3f}"
        words += ("--vertical", up, f"--vertical-scale={factor}")
    if draw.uniform() < 0.4 and kind in ("block", "rigid", "frame"):
        document += f"damping: {draw.uniform(0.005, 0.1):.4f}\n"
    return document, words


def cases(count: int, seed: int) -> list[Case]:
    """Return so many random cases, each from a seed of its own."""
    found = []
    for number in range(seed, seed + count):
        draw = np.random.default_rng(number)
        kind = KINDS[number % len(KINDS)]
        document, lifts = body_of(kind, draw)
        a_g = f"{draw.uniform(0.9, 3.0) * lifts:.4f}g"
        frequency = draw.uniform(0.5, 2.0)
        shaking: tuple[str, ...]
        if draw.uniform() < 0.3:
            document, shaking = record_of(document, a_g, draw)
        else:
            shaking = pulse_of(kind, a_g, frequency, draw)
        found.append(Case(document, shaking))
    return found


def serve() -> None:
    """Answer each line of standard input, (a document, the words of a call), by a line
    of the exit code, standard output and standard error.
    """
    from rocking_cli.commands import main as rocking

    lines, replies = sys.stdin, sys.stdout
    for line in lines:
        document, words = json.loads(line)
        sys.argv = ["rocking", "check", "-", *words, "--json"]
        sys.stdin = io.TextIOWrapper(io.BytesIO(document.encode()))
        out, err, code = io.StringIO(), io.StringIO(), 0
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                rocking()
            except SystemExit as end:
                code = end.code if isinstance(end.code, int) else 0
        print(json.dumps([code, out.getvalue(), err.getvalue()]), file=replies)
        replies.flush()


@contextlib.contextmanager
def answers(package: Path, folder: Path) -> Iterator[Callable[[Case], dict[str, Any]]]:
    """Yield a function that returns the row of a case by the package that lies in a
    folder, or its error.
    """
    path = os.pathsep.join(map(str, (package, HERE / "tests/bench", HERE / "tests")))
    with subprocess.Popen(
        [sys.executable, "-c", SERVER],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as server:
        assert server.stdin is not None
        assert server.stdout is not None

        def answer(case: Case) -> dict[str, Any]:
            print(
                json.dumps([case.document, case.words]), file=server.stdin, flush=True
            )
            code, out, err = json.loads(server.stdout.readline())
            lines = err.strip().splitlines()
            if code:
                return {"error": lines[-1:]}
            row = json.loads(out.splitlines()[0])
            found = {key: row[key] for key in (*NUMBERS, *WORDS) if key in row}
            return {**found, "opposite": [line for line in lines if OPPOSITE in line]}

        yield answer
        server.stdin.close()


def equal_digits(one: float | None, other: float | None) -> int:
    """Return about the number of equal leading digits of two numbers."""
    if one is None or other is None:
        return SAME if one is other else 0
    if one == other:
        return SAME
    apart = abs(one - other) / max(abs(one), abs(other))
    return max(0, min(SAME, math.floor(-math.log10(apart))))


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--base", type=Path, required=True)
    options.add_argument("--cases", type=int, default=200)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", default="")
    options.add_argument("--kept", type=Path)
    chosen = options.parse_args()
    kept: dict[str, Any] = {}
    if chosen.kept is not None and chosen.kept.exists():
        kept = json.loads(chosen.kept.read_text())
    counts: dict[str, Counter[int]] = {key: Counter() for key in NUMBERS}
    words, lower, higher, done = Counter[str](), 0, 0, 0
    with contextlib.ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        at2_file(folder / "far.at2", *far_shock())
        at2_file(folder / "near.at2", *near_shock())
        shutil.copy(HERE / "configs/motions/synthetic.at2", folder)
        by_base, by_this = (
            opened.enter_context(answers(package, folder))
            for package in (chosen.base.resolve(), HERE)
        )
        for number, case in enumerate(cases(chosen.cases, chosen.seed), chosen.seed):
            if not re.search(chosen.only, f"{case.document} {' '.join(case.words)}"):
                continue
            key = json.dumps([case.document, *case.words])
            if key not in kept:
                kept[key] = by_base(case)
                if chosen.kept is not None:
                    chosen.kept.write_text(json.dumps(kept))
            base, here = kept[key], by_this(case)
            done += 1
            if "error" in base or "error" in here:
                words["error"] += ("error" in base) != ("error" in here)
                print(f"{number}: base {base}, here {here}", flush=True)
                continue
            both = base.keys() & here.keys()  # columns are younger than some packages
            apart = [
                k for k in (*WORDS, "opposite") if k in both and base[k] != here[k]
            ]
            words.update(apart)
            digits = {k: equal_digits(base[k], here[k]) for k in NUMBERS if k in both}
            for key, n in digits.items():
                counts[key][n] += 1
            was, now = (x.get("first_overturning_a") or math.inf for x in (base, here))
            lower += now < was * (1.0 - 1e-6)
            higher += now > was * (1.0 + 1e-6)
            if apart or min(digits.values()) < 6:
                kind = " ".join(case.document.split())
                print(f"{number}: {kind} {' '.join(case.words)}", flush=True)
                for key in (*apart, *(k for k, n in digits.items() if n < 6)):
                    print(f"    {key}: base {base[key]}, here {here[key]}", flush=True)
    print(f"{done} cases; words that differ: {dict(words) or 'none'}")
    for key, found in counts.items():
        shown = ", ".join(f"{n} in {found[n]}" for n in sorted(found, reverse=True))
        print(f"{key}: equal digits: {shown} (15: all)")
    print(f"capacities that are lower here: {lower}, higher here: {higher}")


if __name__ == "__main__":
    main()
