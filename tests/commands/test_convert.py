"""`rocking convert` at the shell."""

import math

import h5py

from rocking_cli import Outcome


def test_every_cell_is_a_line_in_the_order_of_the_file(rocking, tmp_path):
    rocking(
        "spectrum",
        "--eta",
        "0.9",
        "--eta",
        "0.7",
        "--grid",
        "A=0.5:12:20,Omega=0.5:12:15",
        "-o",
        "s.h5",
        "-q",
    )
    with h5py.File(tmp_path / "s.h5") as file:
        theta, outcome = file["theta_ratio"][...], file["outcome"][...]
    lines = rocking("convert", "s.h5").stdout.splitlines()
    assert lines[0] == "structure,Omega,A,outcome,theta_ratio"
    assert len(lines) == 1 + 2 * 15 * 20
    assert [line.split(",")[3] for line in lines[1:]] == [
        Outcome(o).flag for o in outcome.flat
    ]
    records = rocking("convert", "s.h5", "--json").records
    assert [r["theta_ratio"] for r in records] == [
        None if math.isnan(x) else x for x in theta.flat
    ]
    assert records[299] == {
        "structure": "eta=0.9",
        "Omega": 12.0,
        "A": 12.0,
        "outcome": "rocked",
        "theta_ratio": theta[0, -1, -1],
    }


def test_a_file_with_nothing_computed_says_so(rocking):
    """The second shard of a sweep that is one chunk."""
    rocking(
        "spectrum",
        "--eta",
        "0.9",
        "--grid",
        "A=1:2:3,Omega=1:2:3",
        "--shard",
        "2/2",
        "-o",
        "s.h5",
        "-q",
    )
    done = rocking("convert", "s.h5")
    assert (done.returncode, done.stdout) == (
        0,
        "structure,Omega,A,outcome,theta_ratio\n",
    )
    assert done.stderr == "s.h5: none of its cells is computed yet\n"
