"""Units of work on a running dask.distributed cluster: workers return arrays, the one writer stays here."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any

from ..errors import OutputError
from .scene import Unit
from .units import Job, Report

# The job travels with every batch: data scattered before could be lost with the worker that holds them.
_AHEAD = 3  # batches in flight for each of the cluster's threads


def cluster_reports(job: Job, units: Sequence[Unit], address: str) -> Iterator[tuple[Unit, Report]]:
    """The reports of the units, in order, from the cluster whose scheduler is at `address`; a lost worker's batches run anew.

    Raises OutputError without the extra `distributed`, without a scheduler there, or when a batch fails for good.
    """
    try:
        from distributed import Client
    except ImportError:
        raise OutputError("--scheduler needs dask.distributed: pip install 'rocking[distributed]'") from None
    try:
        client = Client(address, timeout="15s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise OutputError(f"--scheduler: no dask scheduler answers at {address}: {error}") from None
    with client:
        threads = max(1, sum(dict(client.ncores()).values()))
        size = max(1, min(job.together, -(-len(units) // threads)))
        batches = [list(units[i : i + size]) for i in range(0, len(units), size)]
        waiting: deque[tuple[list[Unit], Any]] = deque()
        for batch in batches:
            waiting.append((batch, client.submit(_run, job, batch, pure=False, retries=3)))
            if len(waiting) > _AHEAD * threads:
                yield from _collect(*waiting.popleft())
        while waiting:
            yield from _collect(*waiting.popleft())


def _run(job: Job, units: Sequence[Unit]) -> list[Report]:
    return job.run(units)


def _collect(units: Sequence[Unit], future: Any) -> Iterator[tuple[Unit, Report]]:
    try:
        reports = future.result()
    except KeyboardInterrupt:
        raise
    except Exception as error:  # whatever a cluster may fail with, what was done stays
        raise OutputError(f"the cluster gave up a unit of work ({type(error).__name__}: {error}); what was done is kept") from None
    yield from zip(units, reports, strict=True)
