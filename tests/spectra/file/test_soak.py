"""The attack on spectra files, seeded and bounded: `make soak` runs all of it and
prints how much was tried and what was bad.
"""

from __future__ import annotations

import collections
import random
import signal
import subprocess
import time
from pathlib import Path
from typing import NamedTuple

import pytest
from support.watched_processes import PROGRAM

from rocking_cli import (
    Interrupted,
    RockingError,
    SpectraFile,
    dimensionless_oscillator,
    parse_grid,
    sine,
    write_spectrum,
)

SWEEP = [*PROGRAM, "spectrum", "--eta", "0.9", "--workers", "1", "-q"]
MERGE = [*PROGRAM, "merge", "1.h5", "2.h5", "-q"]
SCENE = ["--grid", "A=0.5:12:100,Omega=0.5:12:100", "--chunk", "1500"]


@pytest.fixture
def table(capsys):
    """Print a row of the table: what was tried how often, and how it ended."""

    def row(what: str, counts: collections.Counter) -> None:
        with capsys.disabled():
            ends = ", ".join(
                f"{n} {end}" for end, n in sorted(counts.items()) if end != "BAD"
            )
            print(
                f"\n{what:<40} {counts.total():>5} tried {counts['BAD']:>3} bad:"
                f" {ends}",
                end="",
                flush=True,
            )
        assert not counts["BAD"], counts

    return row


class Numbers(NamedTuple):
    """All that is read from a spectra file: what it says of itself, its closing
    attributes, and the cells of each chunk.
    """

    itself: tuple
    closing: dict
    chunks: dict[int, dict[str, bytes]]


def numbers(path: Path) -> Numbers:
    """Read a file to its last cell. Raises RockingError."""
    with SpectraFile(path) as f:
        blocks = {
            int(i): f.block(f.chunk_grid.offset(i)[0], *f.chunk_grid.extent(i)[1:])
            for i in f.done.nonzero()[0]
        }
        chunks = {
            i: {name: x.tobytes() for name, x in block.items()}
            for i, block in blocks.items()
        }
        return Numbers(
            (
                f.scene,
                f.structures,
                *(a.values.tobytes() for a in (f.grid.frequency, f.grid.amplitude)),
            ),
            f.attributes,
            chunks,
        )


def judged(path: Path, before: Numbers, sealed: bool) -> str:
    """How reading a damaged copy ended; of a part a chunk may be missing, which is
    computed again.
    """
    try:
        now = numbers(path)
    except RockingError:
        return "refused"
    if now.itself != before.itself or any(
        now.chunks[i] != before.chunks[i] for i in now.chunks
    ):
        return "BAD"
    if sealed:
        return "the same read" if now == before else "BAD"
    return "the same read" if len(now.chunks) == len(before.chunks) else "less is there"


def sweep(path: Path, **options):
    structures = [dimensionless_oscillator(eta=0.9), dimensionless_oscillator(eta=0.7)]
    grid = parse_grid("A=0.5:12:100,Omega=0.5:12:100")
    return write_spectrum(
        structures,
        sine(),
        grid,
        path,
        workers=1,
        chunk_cells=1500,
        impacts=True,
        **options,
    )


@pytest.fixture
def finished(tmp_path):
    sweep(tmp_path / "whole.h5")
    return tmp_path / "whole.h5"


@pytest.fixture
def left(tmp_path):
    """The part that a sweep of 14 chunks leaves after ten."""

    def stop(done, total):
        if done == 10:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        sweep(tmp_path / "cut.h5", progress=stop)
    return tmp_path / "cut.h5.part"


def flipped(data: bytearray, i: int, chance: random.Random) -> bytearray:
    """A bit is another one; of every second copy one in the first 25 kB, where layout
    and index are.
    """
    data[chance.randrange(len(data) if i % 2 else min(len(data), 25_000))] ^= (
        1 << chance.randrange(8)
    )
    return data


def overwritten(data: bytearray, i: int, chance: random.Random) -> bytearray:
    """Runs of foreign bytes; every tenth copy is cut there."""
    for _ in range(chance.randint(1, 4)):
        at, other, length = (
            chance.randrange(len(data)),
            chance.randrange(len(data)),
            chance.choice((1, 2, 4, 8, 64, 512)),
        )
        foreign = (
            chance.randbytes(length),
            bytes(length),
            b"\xff" * length,
            data[other : other + length],
        )
        data[at : at + length] = chance.choice(foreign)
    return data[:at] if i % 10 == 9 else data


@pytest.mark.parametrize("which", ["finished", "left"])
@pytest.mark.parametrize("damage", [flipped, overwritten])
@pytest.mark.parametrize("tries", [12, pytest.param(600, marks=pytest.mark.soak)])
def test_damaged_files_are_refused_and_never_give_another_number(
    which, damage, tries, request, table
):
    path = request.getfixturevalue(which)
    raw, before, counts, chance = (
        path.read_bytes(),
        numbers(path),
        collections.Counter(),
        random.Random(12),
    )
    for i in range(tries):
        path.write_bytes(damage(bytearray(raw), i, chance))
        counts[judged(path, before, which == "finished")] += 1
    assert counts["refused"] > 0.8 * tries
    table(f"{damage.__name__}, {which}", counts)


def raced(
    folder: Path, calls: list[list[str]], delays: list[float], wholes: list[Numbers]
) -> str:
    """How calls ended that were begun one after the other, each after a delay [s]; each
    would make the file of the same place in wholes.

    Every refusal must be one sentence with the code of one, and nothing but the whole
    file of one that went well may be left.
    """
    processes, output = [], folder / "z.h5"
    for call, delay in zip(calls, delays, strict=True):
        time.sleep(delay)
        processes.append(
            subprocess.Popen(
                [*call, "-o", "z.h5"], cwd=folder, stderr=subprocess.PIPE, text=True
            )
        )
    ends = [
        (p.returncode, said)
        for p in processes
        for said in [p.communicate(timeout=300)[1]]
    ]
    expected_ends = all(
        code in (0, 1, 2) and len(said.splitlines()) == (code != 0)
        for code, said in ends
    )
    winners = [i for i, (code, _) in enumerate(ends) if code == 0]
    good = (
        expected_ends and winners and [p.name for p in folder.glob("z.h5*")] == ["z.h5"]
    )
    good = good and numbers(output).chunks in [wholes[i].chunks for i in winners]
    for path in folder.glob("z.h5*"):
        path.unlink()
    return f"whole by {len(winners)} of {len(calls)}" if good else "BAD"


def swept(folder: Path, name: str, *call: str) -> Numbers:
    subprocess.run([*SWEEP, *call, "-o", name], cwd=folder, check=True)
    return numbers(folder / name)


OTHER = ["--grid", "A=0.5:12:200,Omega=0.5:12:100", "--chunk", "1500"]
RACES = {  # what runs at once on one output, and how the calls are drawn
    "four sweeps --overwrite": lambda chance: [[*SWEEP, *SCENE, "--overwrite"]] * 4,
    "four sweeps --resume": lambda chance: [[*SWEEP, *SCENE, "--resume"]] * 4,
    "four sweeps": lambda chance: [[*SWEEP, *SCENE]] * 4,
    "another scene with --overwrite": lambda chance: [
        [*SWEEP, *scene, "--overwrite"] for scene in (OTHER, SCENE)
    ],
    "merges and sweeps": lambda chance: [
        *(
            [
                *chance.choice((MERGE, [*SWEEP, *SCENE])),
                *chance.choice(([], ["--overwrite"])),
            ]
            for _ in range(3)
        ),
        [*SWEEP, *SCENE, "--resume"],
    ],
}


@pytest.mark.soak
@pytest.mark.parametrize("race", RACES)
def test_races_on_one_output(tmp_path, table, race):
    chance, counts = random.Random(15), collections.Counter()
    whole, other = (
        swept(tmp_path, "whole.h5", *SCENE),
        swept(tmp_path, "other.h5", *OTHER),
    )
    for i in (1, 2):
        swept(tmp_path, f"{i}.h5", *SCENE, "--shard", f"{i}/2")
    for _ in range(20):
        calls = RACES[race](chance)
        delays = [0.0, *(chance.choice((0.0, 0.02, 0.3, 0.6)) for _ in calls[1:])]
        counts[
            raced(
                tmp_path,
                calls,
                delays,
                [other if OTHER[1] in call else whole for call in calls],
            )
        ] += 1
    table(f"races of {race}", counts)


@pytest.mark.soak
def test_kills_and_resumes(tmp_path, table):
    chance, counts = random.Random(17), collections.Counter()
    call = [
        *SWEEP,
        "--grid",
        "A=0.5:12:800,Omega=0.5:12:800",
        "--chunk",
        "5000",
        "--resume",
    ]
    began = time.perf_counter()
    subprocess.run([*call, "-o", "whole.h5"], cwd=tmp_path, check=True)
    usual, whole = time.perf_counter() - began, numbers(tmp_path / "whole.h5")
    for _ in range(50):
        process = subprocess.Popen(
            [*call, "-o", "cut.h5"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
        )
        time.sleep(chance.uniform(0.1, 1.0) * usual)
        process.send_signal(signal.SIGKILL)
        said = process.communicate()[1]
        if (tmp_path / "cut.h5").exists():
            counts[
                (
                    "finished, the same"
                    if numbers(tmp_path / "cut.h5").chunks == whole.chunks
                    else "BAD"
                )
            ] += 1
            for name in ("cut.h5", "cut.h5.part"):
                (tmp_path / name).unlink(missing_ok=True)
        else:
            counts[
                (
                    "killed"
                    if process.returncode == -signal.SIGKILL and not said
                    else "BAD"
                )
            ] += 1
    table("kills and resumes", counts)


@pytest.mark.soak
def test_full_disks(tmp_path, table):
    """A limit on the length of files, at every place: in the layout nothing is left,
    behind it the part goes on to the same.
    """
    counts = collections.Counter()
    subprocess.run([*SWEEP, *SCENE, "-o", "whole.h5"], cwd=tmp_path, check=True)
    whole, size = (
        numbers(tmp_path / "whole.h5"),
        (tmp_path / "whole.h5").stat().st_size // 1024,
    )
    part, output = tmp_path / "cut.h5.part", tmp_path / "cut.h5"
    for limit in [*range(1, 30, 5), *range(30, size + 150, 12)]:
        call = [
            "bash",
            "-c",
            f'ulimit -f {limit}; PYTHONDONTWRITEBYTECODE=1 exec "$@"',
            "-",
            *SWEEP,
            *SCENE,
            "-o",
            "cut.h5",
        ]
        done = subprocess.run(
            call, cwd=tmp_path, capture_output=True, text=True, check=False
        )
        full = (
            done.returncode == 1
            and len(done.stderr.splitlines()) == 1
            and "cannot be written: " in done.stderr  # HDF5 has words of its own
        )
        if full and not part.exists():
            counts["nothing left"] += 1
            continue
        if full:
            subprocess.run(
                [*SWEEP, *SCENE, "-o", "cut.h5", "--resume"], cwd=tmp_path, check=False
            )
        same = (
            (full or done.returncode == 0)
            and output.exists()
            and numbers(output).chunks == whole.chunks
        )
        counts[
            "BAD" if not same else "kept and went on to the same" if full else "fits"
        ] += 1
        output.unlink(missing_ok=True)
        part.unlink(missing_ok=True)
    table("full disks", counts)
