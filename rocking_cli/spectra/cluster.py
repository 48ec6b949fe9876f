"""Units of work on a running dask.distributed cluster: workers return arrays, the one writer stays here."""

from __future__ import annotations

import logging
import re
import socket
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from ..errors import OutputError, UsageError
from .scene import Unit
from .trust.verification import Answer, Place, Verification
from .units import Job, Report

# The job travels with every batch: data scattered before could be lost with the worker that holds them.
_AHEAD = 3  # batches in flight for each of the cluster's threads
_TO_ANSWER = 4.0  # s that a scheduler may take to accept a connection, and to begin to speak
_LONGEST_GREETING = 1 << 32  # bytes
_TO_GREET = 15.0  # s that it may take until it knows its client
_PATIENCE = 4.0  # s without a worker after which that is said, again and again


def cluster_reports(
    job: Job, units: Sequence[Unit], address: str, verification: Verification, tell: Callable[[str], None] | None = None
) -> Iterator[tuple[Unit, Report]]:
    """The reports of the units, in order, from the cluster whose scheduler is at `address`; a lost worker's batches run anew. With the
    last of them the verification has its answers.

    Where the cluster has no worker, that is told, and waited for. Raises UsageError for an address that is none, OutputError without
    the extra `distributed`, without a scheduler there, or when a batch fails for good.
    """
    host, port = _host_and_port(address)
    try:
        from distributed import Client
    except ImportError:
        raise OutputError("`scheduler` needs dask.distributed: pip install 'rocking[distributed]'") from None
    with _silent_library():
        try:
            with socket.create_connection((host, port), timeout=_TO_ANSWER) as connection:
                if not address.startswith("tls:"):  # a scheduler speaks first; the client would wait for ever
                    _demand_greeting(connection)
            client = Client(address, timeout=_TO_GREET, set_as_default=False)
        except (OSError, ValueError) as error:
            raise OutputError(f"`scheduler`: no dask scheduler answers at {address}: {str(error) or type(error).__name__}") from None
        with client:
            threads = _wait(lambda: sum(dict(client.ncores()).values()), _saying(tell, address))
            size = max(1, min(job.together, -(-len(units) // threads)))
            batches = [list(units[i : i + size]) for i in range(0, len(units), size)]
            waiting: deque[tuple[list[Unit], Any]] = deque()
            for batch in batches:
                waiting.append((batch, _submit(client, job, batch, batch)))
                if len(waiting) > _AHEAD * threads:
                    yield from _reports(client, *waiting.popleft(), _saying(tell, address))
            asked = {place: _submit(client, job, place, [Unit(place[:1], *place[1:])]) for place in verification.places()}
            while waiting:
                yield from _reports(client, *waiting.popleft(), _saying(tell, address))
            verification.answers |= {place: _result(client, future, _saying(tell, address)) for place, future in asked.items()}


def _host_and_port(address: str) -> tuple[str, int]:
    found = re.fullmatch(r"(?:(?:tcp|tls)://)?(?:\[([0-9A-Fa-f:.]+)\]|([^\s:/\[\]]+)):(\d{1,5})", address)
    if found is None or not 0 < int(found[3]) < 65536:
        raise UsageError(f"`scheduler`: found {address!r}; accepted is HOST:PORT or tcp://HOST:PORT, such as tcp://localhost:8786")
    return found[1] or found[2], int(found[3])


def _demand_greeting(connection: socket.socket) -> None:
    """Raise ConnectionError unless a message of dask begins, by the number of its bytes or parts in eight bytes; a text is no such one."""
    begun = b""
    while len(begun) < 8:
        more = connection.recv(8 - len(begun))
        if not more:
            raise ConnectionError(f"it says {begun!r} and closes the connection" if begun else "the connection was closed")
        begun += more
    if int.from_bytes(begun, "little") > _LONGEST_GREETING:
        raise ConnectionError(f"it begins with {begun!r}, which is no message of a scheduler")


@contextmanager
def _silent_library() -> Iterator[None]:
    """What the library logs is told here in one sentence, or is its own matter, as when it connects anew."""
    names = [n for n in logging.root.manager.loggerDict if n.partition(".")[0] in ("distributed", "tornado", "asyncio")]
    before = {name: logging.getLogger(name).level for name in {"distributed", "tornado", "asyncio", *names}}
    for name in before:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in before.items():
            logging.getLogger(name).setLevel(level)


def _saying(tell: Callable[[str], None] | None, address: str) -> Callable[[float], None]:
    def say(seconds: float) -> None:
        if tell is not None:
            tell(f"`scheduler`: the cluster at {address} has no worker; waiting for one since {seconds:.0f} s")

    return say


def _wait(threads: Callable[[], int], say: Callable[[float], None]) -> int:
    """The cluster's threads as soon as it has any; says how long that has been waited for."""
    began = said = time.monotonic()
    while not (found := threads()):
        time.sleep(0.1)
        if time.monotonic() - said > _PATIENCE:
            said = time.monotonic()
            say(said - began)
    return found


def _submit(client: Any, job: Job, item: list[Unit] | Place, units: Sequence[Unit]) -> Any:
    """Ask for some units, or for the reference of a cell in one of them; what else the scene holds does not travel."""
    return client.submit(_answer, replace(job, scene=job.scene.only(units)), item, pure=False, retries=3)


def _answer(job: Job, item: list[Unit] | Place) -> list[Report] | Answer:
    return job.answer(item)


def _reports(client: Any, units: Sequence[Unit], future: Any, say: Callable[[float], None]) -> Iterator[tuple[Unit, Report]]:
    yield from zip(units, _result(client, future, say), strict=True)


def _result(client: Any, future: Any, say: Callable[[float], None]) -> Any:
    try:
        while True:
            try:
                return future.result(timeout=_PATIENCE)
            except TimeoutError:
                if future.done():  # the task's own
                    raise
                _wait(lambda: sum(dict(client.ncores()).values()), say)
    except KeyboardInterrupt:
        raise
    except Exception as error:  # whatever a cluster may fail with, what was done stays
        raise OutputError(f"the cluster gave up a unit of work ({type(error).__name__}: {error}); what was done is kept") from None
