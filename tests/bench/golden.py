"""The golden set: results of many small scenes, so that a change of the program can be
told from a change of its results.

`make golden BASE=<commit>` writes the results of that commit on this machine and
compares those of the working tree with them. By hand: `PYTHONPATH=$PWD python
tests/bench/golden.py compare FILE.npz` after `write FILE.npz` with the older package on
PYTHONPATH.

Every array must have the same bits. Digits depend on the C library and on the
processor's kernels: a file of another machine says nothing. Every choice is stated,
since defaults may change.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

import h5py
import numpy as np

import rocking_cli as rk
from rocking_cli.motions.biaxial import with_vertical

VERDICTS = (
    "outcome",
    "outcome_linear",
    "mode",
    "event",
    "impacts_at_least",
    "difference",
)
COUNTERS = ("run_time", "time_per_cell")
LINEAR, NONLINEAR = rk.Method("linear"), rk.Method("nonlinear", 1e-9)
MODELS = {"linear": LINEAR, "nonlinear": NONLINEAR}

STRUCTURES = {
    "block": "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.9\ngravity: 9.81",
    "stocky": "kind: block\nwidth: 1.5 m\nheight: 2 m\nrestitution: 0.6\ngravity: 9.81",
    "damped": (
        "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.9\ngravity:"
        " 9.81\ndamping: 0.05"
    ),
    "lossless": "kind: block\nwidth: 0.4 m\nheight: 2 m\nrestitution: 1\ngravity: 9.81",
    "one-sided": (
        "kind: wall\nthickness: 1.2 m\nheight: 8 m\none_sided: true\nrestitution:"
        " -0.4\ngravity: 9.81"
    ),
    "one-sided damped": (
        "kind: wall\nthickness: 1.2 m\nheight: 8 m\none_sided: true\nrestitution:"
        " -0.4\ngravity: 9.81\ndamping: 0.02"
    ),
    "unequal": (
        "kind: rigid\nleft: 0.42 m\nright: 0.31 m\nheight: 1.15 m\ngyration: 0.68"
        " m\ngravity: 9.81"
    ),
    "arch": (
        "kind: arch\nradius: 10 m\nangle: 157.5 deg\nthickness: 1.5 m\nvoussoirs:"
        " 7\nrestitution: 0.8\ngravity: 9.81"
    ),
    "spire": (
        "kind: spire\nbase_radius: 1.5 m\nheight: 12 m\nrestitution: 0.83\ngravity:"
        " 9.81"
    ),
    "frame": (
        "kind: frame\ncolumns: 6\nwidth: 0.9 m\nheight: 6.5 m\ncap_ratio:"
        " 1.2\nrestitution: 0.96\ngravity: 9.81"
    ),
    "scaled": (
        "kind: parameters\np: 1.84\nalpha: 3.957 deg\neta: 0.9\nlambda: 0.37\na_scale:"
        " 0.1867\ngravity: 9.81"
    ),
}
MOTION = """name: Two pulses
pieces:
  - {from: 0, to: 0.5, sines: [{amplitude: 1}]}
  - {from: 0.5, to: 0.8, constant: 0}
  - {from: 0.8, to: 1.2, constant: -0.6, slope: 1.5}
  - {from: 1.2, to: 2.2,
     sines: [{amplitude: 0.5, phase: 90 deg}, {amplitude: 0.2, frequency: 3}]}
"""
POINTS = (
    "name: Points\npoints: [[0, 0], [0.25, 1], [0.75, -1], [1, 0.2], [1.5, 0.2], [1.8,"
    " -0.5], [2, 0]]\n"
)
VERTICAL = (
    "name: Upwards\npieces:\n  - {from: 0, to: 1, sines: [{amplitude: 1, frequency:"
    " 2.3, phase: 20 deg}]}\n"
)

Arrays = dict[str, np.ndarray]
Scenes = dict[str, Callable[[], Arrays]]
FOLDER = Path(tempfile.mkdtemp(prefix="golden"))


def structure(name: str) -> rk.RockingParameters:
    """One of STRUCTURES."""
    return rk.build_structure(rk.parse_documents(STRUCTURES[name])[0])


def written(name: str, text: str) -> str:
    """The path of a file of this text."""
    (FOLDER / name).write_text(text)
    return str(FOLDER / name)


def noise(count: int, dt: float, seed: int) -> np.ndarray:
    """Acceleration [g] about 2.5 Hz that swells and fades."""
    random, f = np.random.default_rng(seed), np.fft.rfftfreq(count, dt)
    colour = (
        f
        * f
        / (
            (0.3 + f * f)
            * np.sqrt((1.0 - (f / 2.5) ** 2) ** 2 + (f / 2.5) ** 2)
            * (1.0 + (f / 12.0) ** 4)
        )
    )
    t = np.arange(count) / count
    made = (
        np.fft.irfft(np.fft.rfft(random.standard_normal(count)) * colour, count)
        * t
        * np.exp(-6.0 * t)
    )
    return 0.5 * made / np.abs(made).max()


def record_file(count: int, dt: float, seed: int) -> str:
    """The path of a record: time [s] and acceleration [g] in columns."""
    rows = "".join(
        f"{i * dt:.6f} {a:.9e}\n" for i, a in enumerate(noise(count, dt, seed))
    )
    return written(f"noise{seed}.txt", rows)


def record(count: int, dt: float, seed: int) -> rk.Motion:
    """That record as a motion."""
    return rk.read_motion(record_file(count, dt, seed), unit="g")


def answered(found: rk.Response | rk.Spectrum) -> Arrays:
    """The arrays of a response or a spectrum."""
    names = ("theta_ratio", "outcome", "impacts_at_least")
    return {name: getattr(found, name) for name in names}


def over(
    axes: tuple[np.ndarray, np.ndarray],
    name: str,
    method: rk.Method,
    motion: rk.Motion,
    peaks: bool,
) -> Arrays:
    """A structure at every amplitude of the first axis and every frequency of the
    second.
    """
    one, (amplitude, omega) = structure(name), axes
    return answered(
        rk.response(
            method.system_of(one),
            motion,
            amplitude[None, :],
            omega[:, None],
            one.eta,
            peaks=peaks,
        )
    )


def cells(
    name: str,
    method: rk.Method,
    motion: rk.Motion,
    values: int = 40,
    peaks: bool = True,
    a: tuple[float, float] = (0.8, 12.0),
    omega: tuple[float, float] = (0.3, 12.0),
) -> Arrays:
    """A structure under a motion over a grid."""
    return over(
        (np.linspace(*a, values), np.geomspace(*omega, values)),
        name,
        method,
        motion,
        peaks,
    )


def under_record(
    name: str, method: rk.Method, motion: rk.Motion, values: int, peaks: bool = True
) -> Arrays:
    """A structure of several sizes and scales under a record."""
    return over(
        (
            np.linspace(0.8, 8.0, values),
            np.geomspace(0.5, 12.0, values) / (2.0 * np.pi),
        ),
        name,
        method,
        motion,
        peaks,
    )


def swept(
    names: list[str],
    method: rk.Method,
    motion: rk.Motion,
    grid: str,
    quantities: tuple[str, ...],
) -> Arrays:
    """A spectrum in memory."""
    found = rk.spectrum(
        [structure(n) for n in names],
        motion,
        rk.parse_grid(grid),
        method=method,
        workers=1,
        check=3,
        quantities=quantities,
    )
    return (
        answered(found)
        | dict(found.quantities)
        | {"largest_difference": np.array(found.summary.largest_difference)}
    )


def traced(
    one: rk.RockingParameters, motion: rk.Motion, omegas: np.ndarray, **given: object
) -> Arrays:
    """The intervals of an envelope."""
    found = rk.trace_envelope(one, motion, omegas, workers=1, **given)
    ends = {"omega": [i.omega for i in found], "a_from": [i.a_from for i in found]}
    ends["a_to"] = [np.nan if i.a_to is None else i.a_to for i in found]
    return {key: np.array(x) for key, x in ends.items()} | {
        "mode": np.array([i.mode for i in found], dtype="S")
    }


def judged(name: str, motion: rk.Motion, grid: str) -> Arrays:
    """A verdict with its capacity."""
    return columns(
        [rk.check(structure(name), motion, rk.parse_grid(grid), a_max=6.0).row()]
    )


def followed(
    name: str,
    method: rk.Method,
    motion: rk.Motion,
    amplitude: float,
    omega: float,
    release: float = 0.0,
) -> Arrays:
    """A time history and its events."""
    one = structure(name)
    found = rk.history(
        method.system_of(one),
        motion,
        amplitude,
        omega,
        one.eta,
        release=release,
        duration=15.0,
    )
    rotation, rate = found.at(np.linspace(0.0, found.end, 500))
    events = columns([{"event": e.event, "tau": e.tau} for e in found.events])
    return {
        "rotation": rotation,
        "rate": rate,
        "end": np.array(found.end),
        "outcome": np.array(int(found.outcome)),
    } | events


def columns(rows: list[dict[str, object]]) -> Arrays:
    """Rows as arrays by name, None as NaN, words as bytes."""
    found: Arrays = {}
    for key in dict.fromkeys(key for row in rows for key in row):
        values = [row.get(key) for row in rows]
        if key in COUNTERS or any(isinstance(x, (list, dict)) for x in values):
            continue
        if any(isinstance(x, str) for x in values):
            found[key] = np.array([str(x) for x in values], dtype="S")
        else:
            found[key] = np.array([np.nan if x is None else float(x) for x in values])
    return found


def command(text: str) -> str:
    """The standard output of a command."""
    run = subprocess.run(
        [sys.executable, "-m", "rocking_cli", *text.split()],
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode not in (0, 4):  # 4: some cells failed
        raise RuntimeError(f"{text}: {run.stderr}")
    return run.stdout


def printed(text: str) -> Arrays:
    """The rows that a command prints."""
    return columns(
        [json.loads(line) for line in command(f"{text} --json -q").splitlines()]
    )


def filed(text: str) -> Arrays:
    """The arrays of the file that `rocking spectrum` writes; axes and names are left
    out.
    """
    path = FOLDER / "spectrum.h5"
    command(
        f"spectrum {text} --workers 1 --verify-cells 2 --impacts --overwrite -q -o"
        f" {path}"
    )
    with h5py.File(path) as file:
        return {
            key: data[()]
            for key, data in file.items()
            if isinstance(data, h5py.Dataset) and data.ndim == 3
        }


@cache
def documented() -> tuple[rk.Motion, rk.Motion]:
    """Two motions that documents state."""
    two, points = (
        rk.read_motion(written(name, text))
        for name, text in (("two.yaml", MOTION), ("points.yaml", POINTS))
    )
    return two, points


def scenes() -> Scenes:
    """Every scene by name."""
    return {
        **under_pulses(),
        **under_records(),
        **of_many(),
        **of_one(),
        **of_commands(),
    }


def under_pulses() -> Scenes:
    """Structures under pulses over a grid."""
    found: Scenes = {}
    pulses = [
        *(
            rk.pulse(name)
            for name in (
                "sine",
                "cosine",
                "half-sine",
                "rectangular",
                "rectangular-impulse",
            )
        ),
        rk.pulse("ricker-symmetric"),
        rk.pulse("ricker-antisymmetric"),
        rk.pulse("mavroeidis-papageorgiou", gamma=2.0, phase=0.4),
        rk.sine(5),
        rk.cosine(2.5),
    ]
    for motion in pulses:
        for model, method in MODELS.items():
            found[f"block, {model}, {motion.name}"] = partial(
                cells, "block", method, motion
            )
    two, points = documented()
    for motion in (rk.sine(), rk.sine(3), two, points):
        for model, method in MODELS.items():
            for name in ("damped", "one-sided", "one-sided damped", "unequal", "arch"):
                if motion in (two, points) and name in ("damped", "one-sided damped"):
                    continue
                if name == "unequal" and model == "linear" and motion is points:
                    continue
                found[f"{name}, {model}, {motion.name}"] = partial(
                    cells, name, method, motion, 20 if model == "nonlinear" else 30
                )
    for model, method in MODELS.items():
        for name in ("stocky", "lossless", "spire", "frame", "scaled"):
            if (name, model) not in (("scaled", "nonlinear"), ("frame", "nonlinear")):
                found[f"{name}, {model}"] = partial(
                    cells, name, method, rk.sine(2), 20, omega=(1.0, 12.0)
                )
        found[f"outcome only, {model}"] = partial(
            cells, "block", method, rk.sine(3), 30, peaks=False
        )
        found[f"near uplift, {model}"] = partial(
            cells, "block", method, rk.sine(), 25, a=(0.999, 1.2)
        )
        found[f"hard and slow, {model}"] = partial(
            cells, "block", method, rk.sine(), 15, a=(1.0, 1e3), omega=(1e-2, 1e3)
        )
    for name, values in (("arch", 12), ("block", 20)):
        found[f"{name}, tolerance 1e-12"] = partial(
            cells, name, rk.Method("nonlinear", 1e-12), rk.sine(), values
        )
    return found


def under_records() -> Scenes:
    """Structures of several sizes and scales under records."""
    found: Scenes = {}
    shaken = record(400, 0.03, 1)
    both = with_vertical(shaken, record(300, 0.04, 7), 0.7)
    for model, method in MODELS.items():
        for name in ("block", "one-sided", "unequal", "damped", "arch", "stocky"):
            values = 6 if name in ("damped", "arch", "stocky", "unequal") else 8
            found[f"{name}, {model}, record"] = partial(
                under_record, name, method, shaken, values
            )
        found[f"outcome only, {model}, record"] = partial(
            under_record, "block", method, shaken, 12, peaks=False
        )
        found[f"fine record, {model}"] = partial(
            under_record, "block", method, record(2500, 0.005, 2), 6
        )
        found[f"long record, {model}"] = partial(
            under_record, "block", method, record(15_000, 0.01, 3), 2
        )
        for name in ("block", "unequal"):
            found[f"{name}, {model}, record with a vertical one"] = partial(
                under_record, name, method, both, 8
            )
        found[f"record over, {model}"] = partial(
            under_record, "unequal", method, shaken.scaled(-1.0), 8
        )
    return found


def of_many() -> Scenes:
    """Spectra in memory and envelopes."""
    grid = "A=0.8:8:16,Omega=0.5:10:16"
    found: Scenes = {
        "spectrum, several restitutions": partial(
            swept,
            ["block", "stocky", "scaled"],
            LINEAR,
            rk.sine(),
            grid,
            ("condition",),
        ),
        "spectrum, linear beside nonlinear": partial(
            swept, ["block", "stocky"], NONLINEAR, rk.sine(2), grid, ("linear",)
        ),
    }
    for motion in (rk.sine(2), *documented(), rk.pulse("ricker-symmetric")):
        found[f"spectrum, {motion.name}"] = partial(
            swept, ["block"], NONLINEAR, motion, grid, ()
        )
    found["spectrum, a stocky block"] = partial(
        swept, ["stocky"], NONLINEAR, rk.cosine(), grid, ()
    )

    body, pushes = rk.dimensionless_oscillator, np.linspace(0.6, 9.0, 12)
    for motion in (
        rk.sine(),
        rk.sine(2),
        rk.pulse("half-sine"),
        rk.pulse("rectangular"),
    ):
        found[f"envelope, {motion.name}"] = partial(
            traced, body(eta=0.9), motion, pushes, method=LINEAR, a_max=12.0
        )
    for name, eta, omegas, a_max in (
        ("fine", 0.8, np.linspace(0.4, 8.0, 60), 20.0),
        ("lossless", 1.0, np.linspace(0.5, 8.0, 20), 10.0),
    ):
        found[f"envelope, {name}"] = partial(
            traced, body(eta=eta), rk.sine(), omegas, a_max=a_max, method=LINEAR
        )
    for name, of, places, more in (
        ("nonlinear", "block", [2.0, 4.0, 7.0], {"method": NONLINEAR, "a_max": 10.0}),
        (
            "unequal",
            "unequal",
            [3.0, 6.0],
            {"method": LINEAR, "a_max": 8.0, "sign": "worse"},
        ),
        (
            "one side",
            "one-sided",
            [3.0, 6.0],
            {"method": LINEAR, "a_max": 8.0, "sign": "-"},
        ),
    ):
        found[f"envelope, {name}"] = partial(
            traced, structure(of), rk.sine(), np.array(places), **more
        )
    found["closed form"] = lambda: columns(
        [c._asdict() for c in rk.closed_form_curves(pushes, 0.9, "sine")]
    )
    return found


def of_one() -> Scenes:
    """One structure under one motion: verdicts and histories."""
    found: Scenes = {}
    for name in ("block", "stocky", "unequal", "one-sided", "damped", "arch"):
        found[f"check, {name}"] = partial(judged, name, rk.sine(), "a_g=0.4g,f_g=1.2")
    found["check, block, record"] = partial(
        judged, "block", record(100, 0.06, 4), "a_g=0.45g,omega_g=1"
    )
    for model, method in MODELS.items():
        for name in ("block", "unequal", "one-sided", "arch"):
            found[f"history, {name}, {model}"] = partial(
                followed, name, method, rk.sine(2), 2.0, 6.0
            )
        found[f"history, released, {model}"] = partial(
            followed, "block", method, rk.sine(), 0.0, 1.0, 0.7
        )
        found[f"history, record, {model}"] = partial(
            followed, "block", method, record(400, 0.03, 1), 2.5, 1.0 / 2.7
        )
        found[f"history, falls, {model}"] = partial(
            followed, "block", method, rk.sine(), 8.0, 3.0
        )
    return found


def of_commands() -> Scenes:
    """What commands print and write."""
    found: Scenes = {}
    block, unequal, arch = (
        written(f"{name}.yaml", STRUCTURES[name])
        for name in ("block", "unequal", "arch")
    )
    sites = written(
        "sites.csv",
        "a_g,T_g\n"
        + "".join(f"{0.2 + 0.1 * i:.2f}g,{0.4 + 0.13 * i:.2f}s\n" for i in range(8)),
    )
    path, other, short = (
        record_file(400, 0.03, 1),
        record_file(400, 0.02, 5),
        record_file(100, 0.06, 4),
    )
    recorded, upwards = (
        f"--motion {path} --unit g",
        f"--vertical {written('up.yaml', VERTICAL)} --vertical-scale 0.6",
    )
    pulsed = "--grid A=0.8:8:14,Omega=0.6:10:14 --pulse sine"
    angles = (
        "--alpha 10,15,20deg --eta 0.9 --grid T=0.5:6:10 --quantity"
        " condition,velocity_ratio --no-validity"
    )
    traces = (
        f"envelope --motion {short} --unit g --alpha 15deg --eta 0.9 --grid T=1:4:2"
        " --a-max 4 --sign worse --workers 1"
    )
    for model in MODELS:
        exactly = f"--model {model} --tolerance 1e-9"
        found[f"vertical, {model}"] = partial(
            filed,
            f"{block} {unequal} {pulsed} --cycles 2 {upwards} {exactly} --no-validity",
        )
        found[f"spectra of records, {model}"] = partial(
            filed, f"{recorded} --motion {other} {angles} {exactly}"
        )
        found[f"intervals of records, {model}"] = partial(
            printed, f"{traces} {exactly}"
        )
        found[f"first intervals, {model}"] = partial(
            printed, f"{traces} --lowest {exactly}"
        )
    found["scaled records"] = partial(
        filed,
        f"{block} {unequal} {recorded} --motion {other} --grid scale=0.5:4:8 {exactly}",
    )
    found["check, vertical"] = partial(
        printed,
        f"check {block} --pulse sine --a-g 0.4g --f-g 1.2 {upwards} --a-max 4"
        " --workers 1",
    )
    sampled = f"--duration 8 --forces {exactly}"
    found["response of a record"] = partial(
        printed, f"response {block} {recorded} {sampled}"
    )
    found["response of an arch"] = partial(
        printed, f"response {arch} --pulse sine --a-g 0.6g --T-g 0.8 {sampled}"
    )
    found["measures"] = partial(printed, f"records {path} {other} --unit g")
    methods = (
        "--levels 0.1g:1g:6 --im PGA --limit 0.1,0.5,1,overturning --method"
        " stripes,first,cloud --workers 1"
    )
    found["fragility"] = partial(
        printed, f"fragility {block} --pulses {sites} {methods}"
    )
    return found


def computed(words: list[str]) -> dict[str, Arrays]:
    """The arrays of every scene whose name holds all of the words."""
    found: dict[str, Arrays] = {}
    for name, scene in scenes().items():
        if all(word in name for word in words):
            began = sum(os.times()[:4])
            try:
                found[name] = {key: np.asarray(x) for key, x in scene().items()}
            except Exception as error:
                error.add_note(f"in the scene {name}")
                raise
            print(f"{sum(os.times()[:4]) - began:7.2f} s  {name}", file=sys.stderr)
    return found


def difference(
    key: str, was: np.ndarray | None, now: np.ndarray | None
) -> tuple[bool, str]:
    """(True if it is allowed, what differs: nothing for equal bits) of an array of a
    scene, None where the scene does not have it.
    """
    if was is None or now is None:
        return was is None, f"{key}: {'new' if was is None else 'gone'}"
    if was.shape != now.shape or was.dtype != now.dtype:
        return False, f"{key}: {was.dtype}{was.shape} became {now.dtype}{now.shape}"
    if was.tobytes() == now.tobytes():
        return True, ""
    if was.dtype.kind != "f":
        return False, f"{key}: {np.count_nonzero(was != now)} of {was.size} changed"
    gone = np.count_nonzero(np.isnan(was) != np.isnan(now))
    apart = np.where(was == now, 0.0, np.abs(was - now) / np.maximum(1.0, np.abs(was)))
    largest, changed = (
        float(np.nanmax(apart, initial=0.0)),
        np.count_nonzero(np.nan_to_num(apart)) + gone,
    )
    report = (
        f"{key}: {changed} of {was.size} cells differ, largest difference {largest:.1e}"
    )
    return False, report + (f", {gone} became or were NaN" if gone else "")


def compare(path: Path, words: list[str]) -> int:
    """Print what differs from a file that `write` made; the number of scenes that
    differ by more than is allowed.
    """
    was: dict[str, Arrays] = {}
    for name, array in np.load(path).items():
        scene, _, key = name.partition("|")
        was.setdefault(scene, {})[key] = array
    now, bad = computed(words), 0
    for scene in [name for name in {**was, **now} if name in now or not words]:
        before, after = was.get(scene, {}), now.get(scene, {})
        found = {
            key: difference(key, before.get(key), after.get(key))
            for key in {**before, **after}
        }
        report = [words for _, words in found.values() if words]
        if report:
            allowed = all(fine for fine, _ in found.values())
            bad += not allowed
            verdicts = (
                ", a verdict changed"
                if any(found[key][1] for key in VERDICTS if key in found)
                else ""
            )
            print(
                f"{'' if allowed else 'DIFFERS  '}{scene}:"
                f" {'; '.join(report)}{verdicts}"
            )
    print(f"{len(now)} scenes, {bad} differ by more than is allowed")
    return bad


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("action", choices=("write", "compare"))
    options.add_argument("file", type=Path, help="FILE.npz of the arrays")
    options.add_argument(
        "words", nargs="*", help="only scenes whose names hold these words"
    )
    given = options.parse_args()
    path = given.file.with_suffix(".npz")
    print(f"package: {Path(rk.__file__).parent}", file=sys.stderr)
    if given.action == "compare":
        sys.exit(1 if compare(path, given.words) else 0)
    path.parent.mkdir(parents=True, exist_ok=True)
    found = computed(given.words)
    np.savez_compressed(
        path,
        **{f"{name}|{key}": x for name, own in found.items() for key, x in own.items()},
    )
    print(f"{len(found)} scenes in {path}")


if __name__ == "__main__":
    main()
