"""Sweeps on a real dask.distributed cluster of two worker processes, one of which is killed on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest
from watching import PATIENCE, PROGRAM, grows

CLUSTER = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        print(cluster.scheduler_address, *(w.pid for w in cluster.workers.values()), flush=True)
        sys.stdin.read()
"""


@pytest.fixture
def cluster(tmp_path):
    (tmp_path / "cluster.py").write_text(CLUSTER)
    process = subprocess.Popen(
        [sys.executable, "cluster.py"], cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    address, *workers = process.stdout.readline().split()
    yield address, [int(w) for w in workers]
    process.stdin.close()
    process.wait(timeout=PATIENCE)
    process.stdout.close()


def test_a_cluster_computes_the_same_file_though_a_worker_dies(rocking, cluster, tmp_path):
    address, workers = cluster
    call = ["spectrum", "--eta", "0.9", "--grid", "A=0.5:12:800,Omega=0.5:12:800", "--chunk", "10000", "-q"]
    assert rocking(*call, "-o", "here.h5").returncode == 0
    command = [*PROGRAM, *call, "-o", "there.h5", "--scheduler", address]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    grows(tmp_path / "there.h5.part", 50_000, process)
    os.kill(workers[0], signal.SIGKILL)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, said
    with h5py.File(tmp_path / "here.h5") as a, h5py.File(tmp_path / "there.h5") as b:
        assert np.array_equal(a["theta_ratio"][...], b["theta_ratio"][...], equal_nan=True)
        assert np.array_equal(a["outcome"][...], b["outcome"][...])


IMPATIENT = """
import sys
import distributed
from rocking_cli.commands import main
client = distributed.Client
distributed.Client = lambda address, **options: client(address, **{**options, "timeout": "0.2s"})
main(sys.argv[1:])
"""


def test_no_scheduler_is_a_sentence(tmp_path):
    call = ["spectrum", "--eta", "0.9", "--grid", "A=1:2:3,Omega=1:2:3", "-o", str(tmp_path / "s.h5"), "--scheduler", "tcp://127.0.0.1:9"]
    done = subprocess.run([sys.executable, "-c", IMPATIENT, *call], capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 1
    assert "no dask scheduler answers at tcp://127.0.0.1:9" in done.stderr
    assert "Traceback" not in done.stderr
