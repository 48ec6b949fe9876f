"""Sweeps on a real dask.distributed cluster of two worker processes, one of which is
killed on the way.
"""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading

import h5py
import numpy as np
import pytest
from support.refusals import refuses
from support.watched_processes import PATIENCE, PROGRAM, grows

from rocking_cli import (
    UsageError,
    dimensionless_oscillator,
    parse_grid,
    sine,
    write_spectrum,
)
from rocking_cli.spectra.work import cluster as room

CLUSTER = """
import sys
import dask
from distributed import LocalCluster
dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"})
if __name__ == "__main__":
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        workers = cluster.workers.values()
        print(cluster.scheduler_address, *(w.pid for w in workers), flush=True)
        sys.stdin.read()
"""


@pytest.fixture
def cluster(tmp_path):
    (tmp_path / "cluster.py").write_text(CLUSTER)
    process = subprocess.Popen(
        [sys.executable, "cluster.py"],
        cwd=tmp_path,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    address, *workers = process.stdout.readline().split()
    yield address, [int(w) for w in workers]
    process.stdin.close()
    process.wait(timeout=PATIENCE)
    process.stdout.close()


@pytest.mark.soak
def test_a_cluster_computes_the_same_file_though_a_worker_dies(
    rocking, cluster, tmp_path
):
    address, workers = cluster
    call = [
        "spectrum",
        "--eta",
        "0.9",
        "--grid",
        "A=0.5:12:300,Omega=0.5:12:300",
        "--chunk",
        "2500",
        "-q",
    ]
    assert rocking(*call, "-o", "here.h5").returncode == 0
    command = [*PROGRAM, *call, "-o", "there.h5", "--scheduler", address]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    grows(tmp_path / "there.h5.part", 20_000, process)
    os.kill(workers[0], signal.SIGKILL)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, said
    with h5py.File(tmp_path / "here.h5") as a, h5py.File(tmp_path / "there.h5") as b:
        assert np.array_equal(
            a["theta_ratio"][...], b["theta_ratio"][...], equal_nan=True
        )
        assert np.array_equal(a["outcome"][...], b["outcome"][...])


SMALL = ["spectrum", "--eta", "0.9", "--grid", "A=1:2:3,Omega=1:2:3", "-q"]


NO_ADDRESS = "expected HOST:PORT or tcp://HOST:PORT"
BOGUS = (
    "bogus",
    "tcp://",
    "tcp://host",
    "tcp://host:99999",
    "host:0",
    "ftp://host:8786",
    "tcp://a b:1",
    "",
)
test_an_address_that_is_none_is_refused = refuses(
    room._host_and_port, UsageError, [(address, NO_ADDRESS) for address in BOGUS]
)


def test_addresses():
    assert room._host_and_port("tls://a.b-c.org:65535") == ("a.b-c.org", 65535)
    assert [
        room._host_and_port(address)[0]
        for address in ("localhost:8786", "tcp://[::1]:1")
    ] == ["localhost", "::1"]


def test_no_scheduler_is_a_sentence(refused, monkeypatch):
    monkeypatch.setattr(room, "_TO_ANSWER", 0.3)
    with socket.create_server(("127.0.0.1", 0)) as server:  # which never answers
        for address in ("tcp://127.0.0.1:9", f"127.0.0.1:{server.getsockname()[1]}"):
            assert f"no dask scheduler answers at {address}: " in refused(
                1, *SMALL, "-o", "s.h5", "--scheduler", address
            )


def test_a_text_is_no_scheduler(refused):
    """At once, and without the client, which would wait for it and
    leave a traceback.
    """
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"

        def speak():
            connection, _ = server.accept()
            with connection:
                connection.sendall(b"SSH-2.0-OpenSSH_9.2\r\n")

        speaker = threading.Thread(target=speak)
        speaker.start()
        said = refused(1, *SMALL, "-o", "s.h5", "--scheduler", address)
        speaker.join()
    assert (
        f"no dask scheduler answers at {address}: it begins with b'SSH-2.0-', which is"
        " not a message of a scheduler" in said
    )


def test_a_cluster_without_workers_is_told_and_waited_for(tmp_path, monkeypatch):
    from distributed import Future, LocalCluster

    said, late, result = list[str](), set[str](), Future.result

    def a_moment_late(future, timeout=None):
        """The result that comes between the timeout and the next look at it."""
        found = result(future, timeout)
        if future.key not in late:
            late.add(future.key)
            raise TimeoutError
        return found

    monkeypatch.setattr(room, "_PATIENCE", 0.2)
    monkeypatch.setattr(Future, "result", a_moment_late)
    with LocalCluster(
        n_workers=0,
        threads_per_worker=1,
        processes=False,
        protocol="tcp",
        dashboard_address=None,
    ) as cluster:

        def tell(line: str) -> None:
            said.append(line)
            if len(said) == 2:
                cluster.scale(1)

        address = cluster.scheduler_address
        summary = write_spectrum(
            [dimensionless_oscillator(eta=0.9)],
            sine(),
            parse_grid("A=1:2:3,Omega=1:2:3"),
            tmp_path / "s.h5",
            scheduler=address,
            tell=tell,
        )
    assert summary.cells == 9
    assert late
    assert len(said) >= 2
    assert all(
        re.fullmatch(
            rf"`scheduler`: the cluster at {address} has no worker; waiting for one"
            r" since \d+ s",
            line,
        )
        for line in said
    )
