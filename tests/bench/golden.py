"""The golden set: results of many small scenes as hashes, so that a change of the program can be told from a change of its results.

`make golden BASE=<commit>` writes the results of that commit on this machine and compares those of the working tree with them. By hand:
`PYTHONPATH=$PWD python tests/bench/golden.py compare FILE.json` after `write FILE.json` with the older package on PYTHONPATH.

Every array must have the same bits, but friction and fz_min, which may differ by 1e-6 (over the larger of 1 and the value). Digits
depend on the C library and on the processor's kernels: a file of another machine says nothing. Every choice is stated, since defaults
may change.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

import rocking_cli as rk
from rocking_cli.motions.biaxial import with_vertical

FORCES, TOLERANCE = ("friction", "fz_min"), 1e-6
VERDICTS = ("outcome", "outcome_linear", "mode", "event", "impacts", "difference")
COUNTERS = ("run_time", "time_per_cell")
MODELS = (("linear", rk.Method("linear")), ("nonlinear", rk.Method("nonlinear", 1e-9)))

STRUCTURES = {
    "block": "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.9\ngravity: 9.81",
    "stocky": "kind: block\nwidth: 1.5 m\nheight: 2 m\nrestitution: 0.6\ngravity: 9.81",
    "damped": "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.9\ngravity: 9.81\ndamping: 0.05",
    "lossless": "kind: block\nwidth: 0.4 m\nheight: 2 m\nrestitution: 1\ngravity: 9.81",
    "one-sided": "kind: wall\nthickness: 1.2 m\nheight: 8 m\none_sided: true\nrestitution: -0.4\ngravity: 9.81",
    "one-sided damped": "kind: wall\nthickness: 1.2 m\nheight: 8 m\none_sided: true\nrestitution: -0.4\ngravity: 9.81\ndamping: 0.02",
    "unequal": "kind: rigid\nleft: 0.42 m\nright: 0.31 m\nheight: 1.15 m\ngyration: 0.68 m\ngravity: 9.81",
    "arch": "kind: arch\nradius: 10 m\nangle: 157.5 deg\nthickness: 1.5 m\nvoussoirs: 7\nrestitution: 0.8\ngravity: 9.81",
    "spire": "kind: spire\nbase_radius: 1.5 m\nheight: 12 m\nrestitution: 0.83\ngravity: 9.81",
    "frame": "kind: frame\ncolumns: 6\nwidth: 0.9 m\nheight: 6.5 m\ncap_ratio: 1.2\nrestitution: 0.96\ngravity: 9.81",
    "scaled": "kind: parameters\np: 1.84\nalpha: 3.957 deg\neta: 0.9\nlambda: 0.37\na_scale: 0.1867\ngravity: 9.81",
}
MOTION = """name: Two pulses
pieces:
  - {from: 0, to: 0.5, sines: [{amplitude: 1}]}
  - {from: 0.5, to: 0.8, constant: 0}
  - {from: 0.8, to: 1.2, constant: -0.6, slope: 1.5}
  - {from: 1.2, to: 2.2, sines: [{amplitude: 0.5, phase: 90 deg}, {amplitude: 0.2, frequency: 3}]}
"""
POINTS = "name: Points\npoints: [[0, 0], [0.25, 1], [0.75, -1], [1, 0.2], [1.5, 0.2], [1.8, -0.5], [2, 0]]\n"
VERTICAL = "name: Upwards\npieces:\n  - {from: 0, to: 1, sines: [{amplitude: 1, frequency: 2.3, phase: 20 deg}]}\n"

Arrays = dict[str, np.ndarray]
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
    colour = f * f / ((0.3 + f * f) * np.sqrt((1.0 - (f / 2.5) ** 2) ** 2 + (f / 2.5) ** 2) * (1.0 + (f / 12.0) ** 4))
    t = np.arange(count) / count
    made = np.fft.irfft(np.fft.rfft(random.standard_normal(count)) * colour, count) * t * np.exp(-6.0 * t)
    return 0.5 * made / np.abs(made).max()


def record_file(count: int, dt: float, seed: int) -> str:
    """The path of a record: time [s] and acceleration [g] in columns."""
    rows = "".join(f"{i * dt:.6f} {a:.9e}\n" for i, a in enumerate(noise(count, dt, seed)))
    return written(f"noise{seed}.txt", rows)


def record(count: int, dt: float, seed: int) -> rk.Motion:
    """That record as a motion."""
    return rk.read_motion(record_file(count, dt, seed), unit="g")


def axes(values: int, a: tuple[float, float] = (0.8, 12.0), omega: tuple[float, float] = (0.3, 12.0)) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes in a row, frequencies in a column."""
    return np.linspace(*a, values)[None, :], np.geomspace(*omega, values)[:, None]


def answered(found: rk.Response) -> Arrays:
    """The arrays of a response."""
    return {"theta_ratio": found.theta_ratio, "outcome": found.outcome, "impacts": found.impacts}


def cells(
    name: str, method: rk.Method, motion: rk.Motion, values: int = 40, peaks: bool = True,
    a: tuple[float, float] = (0.8, 12.0), omega: tuple[float, float] = (0.3, 12.0),
) -> Arrays:  # fmt: skip
    """A structure under a motion over a grid."""
    one = structure(name)
    return answered(rk.response(method.system_of(one), motion, *axes(values, a, omega), one.eta, peaks=peaks))


def under_record(name: str, method: rk.Method, motion: rk.Motion, values: int = 12, peaks: bool = True) -> Arrays:
    """A structure of several sizes and scales under a record."""
    one = structure(name)
    a, size = np.linspace(0.8, 8.0, values)[None, :], np.geomspace(0.5, 12.0, values)[:, None] / (2.0 * np.pi)
    return answered(rk.response(method.system_of(one), motion, a, size, one.eta, peaks=peaks))


def swept(names: list[str], method: rk.Method, motion: rk.Motion, grid: str, quantities: tuple[str, ...], workers: int = 1) -> Arrays:
    """A spectrum in memory."""
    found = rk.spectrum(
        [structure(n) for n in names], motion, rk.parse_grid(grid), method=method, workers=workers, check=3, quantities=quantities
    )
    return answered(found) | dict(found.beside) | {"estimated_error": np.array(found.summary.estimated_error)}


def traced(one: rk.RockingParameters, motion: rk.Motion, omegas: np.ndarray, **given: object) -> Arrays:
    """The intervals of an envelope."""
    found = rk.trace_envelope(one, motion, omegas, workers=1, **given)
    ends = {"omega": [i.omega for i in found], "a_from": [i.a_from for i in found]}
    ends["a_to"] = [np.nan if i.a_to is None else i.a_to for i in found]
    return {key: np.array(x) for key, x in ends.items()} | {"mode": np.array([i.mode for i in found], dtype="S")}


def judged(name: str, motion: rk.Motion, grid: str) -> Arrays:
    """A verdict with its capacity."""
    return columns([rk.check(structure(name), motion, rk.parse_grid(grid), a_max=6.0).record()])


def followed(name: str, method: rk.Method, motion: rk.Motion, amplitude: float, omega: float, release: float = 0.0) -> Arrays:
    """A time history and its events."""
    one = structure(name)
    found = rk.history(method.system_of(one), motion, amplitude, omega, one.eta, release=release, duration=15.0)
    rotation, rate = found.at(np.linspace(0.0, found.end, 500))
    events = columns([{"event": e.event, "tau": e.tau} for e in found.events])
    return {"rotation": rotation, "rate": rate, "end": np.array(found.end), "outcome": np.array(int(found.outcome))} | events


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


def command(*words: str) -> str:
    """The standard output of a command."""
    run = subprocess.run([sys.executable, "-m", "rocking_cli", *words], capture_output=True, text=True, check=False)
    if run.returncode not in (0, 4):  # 4: some cells failed
        raise RuntimeError(f"{' '.join(words)}: {run.stderr}")
    return run.stdout


def printed(*words: str) -> Arrays:
    """The rows that a command prints."""
    return columns([json.loads(line) for line in command(*words, "--json", "-q").splitlines()])


def filed(*words: str) -> Arrays:
    """The arrays of the file that `rocking spectrum` writes; axes and names are left out."""
    path, found = FOLDER / "spectrum.h5", {}
    command("spectrum", *words, "--workers", "1", "--check", "2", "--impacts", "--overwrite", "-q", "-o", str(path))
    with h5py.File(path) as file:
        for key, data in file.items():
            if isinstance(data, h5py.Dataset) and data.ndim == 3:
                found[key] = data[()]
    return found


def documents(*names: str) -> list[str]:
    """The paths of documents of these structures."""
    return [written(f"{name.replace(' ', '_')}.yaml", STRUCTURES[name]) for name in names]


def words(text: str) -> list[str]:
    """The words of a command."""
    return text.split()


def chosen(model: str) -> list[str]:
    """The options of an equation."""
    return ["--model", model, "--tolerance", "1e-9"]


def scenes() -> dict[str, Callable[[], Arrays]]:
    """Every scene by name."""
    found: dict[str, Callable[[], Arrays]] = {}
    pulses = [*(rk.pulse(name) for name in ("sine", "cosine", "half-sine", "rectangular", "rectangular-impulse")),
              rk.pulse("ricker-symmetric"), rk.pulse("ricker-antisymmetric"), rk.pulse("mavroeidis-papageorgiou", gamma=2.0, phase=0.4),
              rk.sine(5), rk.cosine(2.5)]  # fmt: skip
    for motion in pulses:
        for model, method in MODELS:
            found[f"block, {model}, {motion.name}"] = lambda motion=motion, method=method: cells("block", method, motion)
    two = rk.read_motion(written("two.yaml", MOTION))
    points = rk.read_motion(written("points.yaml", POINTS))
    for motion in (rk.sine(), rk.sine(3), two, points):
        for model, method in MODELS:
            for name in ("damped", "one-sided", "one-sided damped", "unequal", "arch"):
                if motion in (two, points) and name in ("damped", "one-sided damped"):
                    continue
                if name == "unequal" and model == "linear" and motion is points:
                    continue
                values = 20 if model == "nonlinear" else 30
                found[f"{name}, {model}, {motion.name}"] = lambda n=name, m=method, g=motion, v=values: cells(n, m, g, v)
    for model, method in MODELS:
        for name in ("stocky", "lossless", "spire", "frame", "scaled"):
            if (name, model) not in (("scaled", "nonlinear"), ("frame", "nonlinear")):
                found[f"{name}, {model}"] = lambda n=name, m=method: cells(n, m, rk.sine(2), 20, omega=(1.0, 12.0))
        found[f"outcome only, {model}"] = lambda m=method: cells("block", m, rk.sine(3), 30, peaks=False)
        found[f"near uplift, {model}"] = lambda m=method: cells("block", m, rk.sine(), 25, a=(0.999, 1.2))
        found[f"hard and slow, {model}"] = lambda m=method: cells("block", m, rk.sine(), 15, a=(1.0, 1e3), omega=(1e-2, 1e3))
    found["arch, tolerance 1e-12"] = lambda: cells("arch", rk.Method("nonlinear", 1e-12), rk.sine(), 12)
    found["block, tolerance 1e-12"] = lambda: cells("block", rk.Method("nonlinear", 1e-12), rk.sine(), 20)

    shaken = record(400, 0.03, 1)
    for model, method in MODELS:
        for name in ("block", "one-sided", "unequal", "damped", "arch", "stocky"):
            values = 6 if name in ("damped", "arch", "stocky", "unequal") else 8
            found[f"{name}, {model}, record"] = lambda n=name, m=method, v=values: under_record(n, m, shaken, v)
        found[f"outcome only, {model}, record"] = lambda m=method: under_record("block", m, shaken, 12, peaks=False)
        found[f"fine record, {model}"] = lambda m=method: under_record("block", m, record(2500, 0.005, 2), 6)
        found[f"long record, {model}"] = lambda m=method: under_record("block", m, record(15_000, 0.01, 3), 2)
        both = with_vertical(shaken, record(300, 0.04, 7), 0.7)
        for name in ("block", "unequal"):
            found[f"{name}, {model}, record with a vertical one"] = lambda n=name, m=method, g=both: under_record(n, m, g, 8)
        found[f"record over, {model}"] = lambda m=method: under_record("unequal", m, shaken.scaled(-1.0), 8)

    grid = "A=0.8:8:16,Omega=0.5:10:16"
    found["spectrum, several restitutions"] = lambda: swept(["block", "stocky", "scaled"], MODELS[0][1], rk.sine(), grid, ("condition",))
    found["spectrum, linear beside nonlinear"] = lambda: swept(["block", "stocky"], MODELS[1][1], rk.sine(2), grid, ("linear",))
    for motion in (rk.sine(2), two, points, rk.pulse("ricker-symmetric")):
        found[f"forces, {motion.name}"] = lambda g=motion: swept(["block"], MODELS[1][1], g, grid, FORCES)
    found["forces of unequal edges"] = lambda: swept(["unequal"], MODELS[1][1], rk.sine(), "A=0.8:8:10,Omega=0.5:10:10", FORCES)
    found["forces of a stocky block"] = lambda: swept(["stocky"], MODELS[1][1], rk.cosine(), "A=0.8:8:12,Omega=0.5:10:12", FORCES)
    found["forces on one side"] = lambda: swept(["one-sided"], MODELS[1][1], rk.sine(2), "A=0.8:8:12,Omega=0.5:10:12", FORCES)

    body, pushes = rk.dimensionless_oscillator(0.9), np.linspace(0.6, 9.0, 12)
    for motion in (rk.sine(), rk.sine(2), rk.pulse("half-sine"), rk.pulse("rectangular")):
        found[f"envelope, {motion.name}"] = lambda g=motion: traced(body, g, pushes, method=MODELS[0][1], a_max=12.0)
    linear, nonlinear = MODELS[0][1], MODELS[1][1]
    for name, eta, omegas, a_max in (("fine", 0.8, np.linspace(0.4, 8.0, 60), 20.0), ("lossless", 1.0, np.linspace(0.5, 8.0, 20), 10.0)):
        of = rk.dimensionless_oscillator(eta)
        found[f"envelope, {name}"] = lambda o=of, w=omegas, a=a_max: traced(o, rk.sine(), w, a_max=a, method=linear)
    for name, of, omegas, more in (
        ("nonlinear", "block", [2.0, 4.0, 7.0], {"method": nonlinear, "a_max": 10.0}),
        ("unequal", "unequal", [3.0, 6.0], {"method": linear, "a_max": 8.0, "sign": "worse"}),
        ("one side", "one-sided", [3.0, 6.0], {"method": linear, "a_max": 8.0, "sign": "-"}),
    ):
        found[f"envelope, {name}"] = lambda o=of, w=omegas, m=more: traced(structure(o), rk.sine(), np.array(w), **m)
    found["closed form"] = lambda: columns([c._asdict() for c in rk.closed_form_curves(pushes, 0.9, "sine")])

    for name in ("block", "stocky", "unequal", "one-sided", "damped", "arch"):
        found[f"check, {name}"] = lambda n=name: judged(n, rk.sine(), "a_g=0.4g,f_g=1.2")
    short = record(100, 0.06, 4)
    found["check, block, record"] = lambda: judged("block", short, "a_g=0.45g,omega_g=1")
    for model, method in MODELS:
        for name in ("block", "unequal", "one-sided", "arch"):
            found[f"history, {name}, {model}"] = lambda n=name, m=method: followed(n, m, rk.sine(2), 2.0, 6.0)
        found[f"history, released, {model}"] = lambda m=method: followed("block", m, rk.sine(), 0.0, 1.0, 0.7)
        found[f"history, record, {model}"] = lambda m=method: followed("block", m, shaken, 2.5, 1.0 / 2.7)
        found[f"history, falls, {model}"] = lambda m=method: followed("block", m, rk.sine(), 8.0, 3.0)

    block, unequal = documents("block")[0], documents("unequal")[0]
    up = written("up.yaml", VERTICAL)
    path, other = record_file(400, 0.03, 1), record_file(400, 0.02, 5)
    sized = ["--grid", "A=0.8:8:14,Omega=0.6:10:14"]
    recorded, brief = ["--motion", path, "--unit", "g"], ["--motion", record_file(100, 0.06, 4), "--unit", "g"]
    for model, _ in MODELS:
        equation = chosen(model)
        upwards = ["--vertical", up, "--vertical-scale", "0.6", *equation, "--no-validity"]
        found[f"vertical, {model}"] = lambda o=upwards: filed(block, unequal, *sized, "--pulse", "sine", "--cycles", "2", *o)
        angles = words("--alpha 10,15,20deg --eta 0.9 --grid T=0.5:6:10 --quantity condition,velocity_ratio --no-validity")
        found[f"spectra of records, {model}"] = lambda o=equation, a=angles: filed(*recorded, "--motion", other, *a, *o)
        traces = words("--alpha 15deg --eta 0.9 --grid T=1:4:2 --a-max 4 --sign worse --workers 1")
        found[f"intervals of records, {model}"] = lambda o=equation, t=traces: printed("envelope", *brief, *t, *o)
        found[f"first intervals, {model}"] = lambda o=equation, t=traces: printed("envelope", *brief, *t, "--lowest", *o)
    forces = ["--quantity", "friction,fz_min", *chosen("nonlinear")]
    found["forces under records"] = lambda: filed(block, unequal, *recorded, "--motion", other, "--grid", "scale=0.5:4:8", *forces)
    upwards, shaking = ["--vertical", up, "--vertical-scale", "0.6"], ["--pulse", "sine", "--a-g", "0.4g", "--f-g", "1.2"]
    found["forces, vertical"] = lambda: filed(block, *sized, "--pulse", "sine", "--vertical", up, "--vertical-scale", "0.6", *forces)
    found["check, vertical"] = lambda: printed("check", block, *shaking, *upwards, "--a-max", "4", "--workers", "1")
    sampled = ["--duration", "8", "--forces", *chosen("nonlinear")]
    found["response of a record"] = lambda: printed("response", block, *recorded, *sampled)
    pulsed = words("--pulse sine --a-g 0.6g --T-g 0.8")
    found["response of an arch"] = lambda: printed("response", documents("arch")[0], *pulsed, *sampled)
    found["measures"] = lambda: printed("records", path, other, "--unit", "g")
    stripes = words("--levels 0.1g:1g:6 --im PGA --limit 0.1,0.5,1,overturning --method stripes,first,cloud --workers 1")
    sites = written("sites.csv", "a_g,T_g\n" + "".join(f"{0.2 + 0.1 * i:.2f}g,{0.4 + 0.13 * i:.2f}s\n" for i in range(8)))
    found["fragility"] = lambda: printed("fragility", block, "--pulses", sites, *stripes)
    return found


def computed(words: list[str]) -> dict[str, Arrays]:
    """The arrays of every scene whose name holds all of the words; what fails is said and left out."""
    found: dict[str, Arrays] = {}
    for name, scene in scenes().items():
        if all(word in name for word in words):
            began = time.process_time() + sum(os.times()[2:4])
            try:
                found[name] = {key: np.asarray(x) for key, x in scene().items()}
            except Exception as error:
                raise RuntimeError(f"scene {name}: {error}") from error
            print(f"{time.process_time() + sum(os.times()[2:4]) - began:7.2f} s  {name}", file=sys.stderr)
    return found


def digest(arrays: Arrays) -> dict[str, str]:
    """The hash of each array with its shape and type."""
    return {
        key: hashlib.sha256(f"{x.dtype} {x.shape}".encode() + np.ascontiguousarray(x).tobytes()).hexdigest() for key, x in arrays.items()
    }


def difference(name: str, was: np.ndarray, now: np.ndarray) -> tuple[bool, str]:
    """(whether it is allowed, what differs) of two arrays whose bits differ."""
    if was.shape != now.shape or was.dtype.kind != now.dtype.kind:
        return False, f"{name}: {was.dtype}{was.shape} became {now.dtype}{now.shape}"
    if was.dtype.kind != "f":
        return False, f"{name}: {np.count_nonzero(was != now)} of {was.size} changed"
    gone = np.isnan(was) != np.isnan(now)
    with np.errstate(invalid="ignore"):
        apart = np.where(was == now, 0.0, np.abs(was - now) / np.maximum(1.0, np.abs(was)))
    largest = float(np.nanmax(apart, initial=0.0))
    changed = gone | (np.nan_to_num(apart) > 0.0)
    told = f"{name}: {np.count_nonzero(changed)} of {was.size} cells differ, largest difference {largest:.1e}"
    return name in FORCES and not gone.any() and largest <= TOLERANCE, told + f", {np.count_nonzero(gone)} became or were NaN" * bool(
        gone.any()
    )


def compare(path: Path, words: list[str]) -> int:
    """Print what differs from a file that `write` made; the number of scenes that differ by more than is allowed."""
    was, arrays, bad = json.loads(path.read_text()), np.load(path.with_suffix(".npz")), 0
    now = computed(words)
    for name in {*was} - {*now} if not words else ():
        print(f"{name}: left out")
        bad += 1
    for name, found in now.items():
        told, allowed, verdicts = [], True, 0
        if name not in was:
            print(f"{name}: new")
            continue
        for key in {**was[name], **found}:
            if (key in was[name]) != (key in found):
                allowed = allowed and key not in was[name]
                told.append(f"{key}: {'new' if key in found else 'gone'}")
            elif was[name][key] != digest(found)[key]:
                ok, words_of = difference(key, arrays[f"{name}|{key}"], found[key])
                before = arrays[f"{name}|{key}"]
                if key in VERDICTS:
                    verdicts += int(np.count_nonzero(before != found[key])) if before.shape == found[key].shape else before.size
                if words_of:
                    told.append(words_of)
                allowed = allowed and ok
        if told:
            bad += not allowed
            print(f"{'' if allowed else 'DIFFERS  '}{name}: {'; '.join(told)}; verdicts changed: {verdicts}")
    print(f"{len(now)} scenes, {bad} differ by more than is allowed")
    return bad


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("action", choices=("write", "compare"))
    options.add_argument("file", type=Path, help="JSON of the hashes; the arrays lie beside it as .npz")
    options.add_argument("words", nargs="*", help="only scenes whose names hold these words")
    given = options.parse_args()
    print(f"package: {Path(rk.__file__).parent}", file=sys.stderr)
    if given.action == "compare":
        sys.exit(1 if compare(given.file, given.words) else 0)
    found = computed(given.words)
    given.file.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(given.file.with_suffix(".npz"), **{f"{name}|{key}": x for name, own in found.items() for key, x in own.items()})
    given.file.write_text(json.dumps({name: digest(own) for name, own in found.items()}, indent=1))
    print(f"{len(found)} scenes in {given.file}, {time.process_time() + sum(os.times()[2:4]):.0f} s")


if __name__ == "__main__":
    main()
