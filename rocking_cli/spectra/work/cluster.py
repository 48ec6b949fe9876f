"""Units of work on a running dask.distributed cluster: workers return arrays, and this
process alone writes the file.
"""

import logging
import re
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from ...errors import OutputError, UsageError
from ...plugins import require
from ...processes import Runner, in_order
from ..scene import Unit
from .jobs import Item, Job

if TYPE_CHECKING:
    from ..verdicts import VerdictJob

_AHEAD = 3  # batches under way for each of the cluster's threads
# s for a scheduler to accept a connection, and to send its first bytes
_TO_ANSWER = 4.0
_LONGEST_GREETING = 1 << 32  # bytes
_TO_GREET = 15.0  # s for a scheduler to register its client
_PATIENCE = 4.0  # s between messages about a missing worker


@contextmanager
def cluster(
    job: "Job | VerdictJob", address: str, tell: Callable[[str], None] | None = None
) -> Iterator[tuple[Runner, int]]:
    """Context of (a function from items to job(item) of each, in their order,
    the number of threads of the cluster at `address`). Items of a lost worker run
    again. Without a worker the function reports this and waits. Raises as
    `check_scheduler`, and OutputError without a scheduler at the address, or if an item
    fails for good.
    """
    check_scheduler(address)
    host, port = _host_and_port(address)
    from distributed import Client

    def threads() -> int:
        """Return the number of threads of the cluster, once it has one."""
        began = said = time.monotonic()
        while not (found := sum(dict(client.ncores()).values())):
            time.sleep(0.1)
            if tell is not None and time.monotonic() - said > _PATIENCE:
                said = time.monotonic()
                tell(
                    f"`scheduler`: the cluster at {address} has no worker; waiting for"
                    f" one since {said - began:.0f} s"
                )
        return int(found)

    def submit(
        item: Item,
        # the job travels with each item: data sent before could be lost with the worker
        # that holds them
    ) -> Any:
        units = item if isinstance(item, list) else [Unit(item[:1], *item[1:])]
        return client.submit(
            type(job).__call__,
            job.only(units),
            item,
            pure=False,
            retries=3,
        )

    def result(future: Any) -> Any:
        try:
            while True:
                try:
                    return future.result(timeout=_PATIENCE)
                except TimeoutError:
                    # An error of the task itself, not of this waiting.
                    if future.status == "error":
                        raise
                    threads()
        except Exception as error:  # any failure of a cluster keeps the finished chunks
            raise OutputError(
                f"the cluster gave up a unit of work ({type(error).__name__}: {error});"
                " finished chunks are kept"
            ) from None

    with _silent_library():
        try:
            with socket.create_connection(
                (host, port), timeout=_TO_ANSWER
            ) as connection:
                # a scheduler sends the first bytes; without this test the client would
                # wait for ever
                if not address.startswith("tls:"):
                    _require_greeting(connection)
            client = Client(address, timeout=_TO_GREET, set_as_default=False)
        except (OSError, ValueError) as error:
            raise OutputError(
                f"`scheduler`: no dask scheduler answers at {address}:"
                f" {str(error) or type(error).__name__}"
            ) from None
        with client:
            ahead = _AHEAD * (count := threads())
            yield lambda items: in_order(submit, result, items, ahead), count


def check_scheduler(address: str) -> None:
    """Check, before any work is done, what a cluster needs. Raises UsageError for an
    invalid address, OutputError without the package.
    """
    _host_and_port(address)
    require("`scheduler` needs", "distributed")


def _host_and_port(address: str) -> tuple[str, int]:
    """Return host and port of a scheduler's address. Raises UsageError."""
    found = re.fullmatch(
        r"(?:(?:tcp|tls)://)?(?:\[([0-9A-Fa-f:.]+)\]|([^\s:/\[\]]+)):(\d{1,5})", address
    )
    if found is None or not 0 < int(found[3]) < 65536:
        raise UsageError(
            f"`scheduler`: found {address!r}; expected HOST:PORT or tcp://HOST:PORT,"
            " such as tcp://localhost:8786"
        )
    return found[1] or found[2], int(found[3])


def _require_greeting(connection: socket.socket) -> None:
    """Raise ConnectionError unless a message of dask begins: the number of its bytes or
    parts, in eight bytes.
    """
    with connection.makefile("rb") as stream:
        begun = stream.read(8)
    if len(begun) < 8:
        raise ConnectionError(
            f"it says {begun!r} and closes the connection"
            if begun
            else "the connection was closed"
        )
    if int.from_bytes(begun, "little") > _LONGEST_GREETING:
        raise ConnectionError(
            f"it begins with {begun!r}, which is not a message of a scheduler"
        )


@contextmanager
def _silent_library() -> Iterator[None]:
    """Context without the log messages of the library, which reconnects by itself; this
    module reports failures.
    """
    names = [
        name
        for name in logging.root.manager.loggerDict
        if name.partition(".")[0] in ("distributed", "tornado", "asyncio")
    ]
    before = {logger: logger.level for logger in map(logging.getLogger, names)}
    for logger in before:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in before.items():
            logger.setLevel(level)
