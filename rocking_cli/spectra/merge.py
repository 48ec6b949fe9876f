"""The parts of a sweep that was computed in shards, put together: bytes are copied, nothing is computed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..dynamics.outcome import Outcome
from ..errors import OutputError, UsageError
from .reader import SpectraFile
from .store import SpectraWriter, difference, part_of, stored_outcomes


def merge(paths: Sequence[str | Path], output: str | Path, *, overwrite: bool = False) -> tuple[int, int]:
    """Write the spectrum that these shards hold together; (chunks there, chunks of the whole).

    Raises UsageError when they are not of one scene, OutputError when one is damaged or the output cannot be written.
    """
    kept_part = part_of(Path(output)).exists()
    files = [SpectraFile(path) for path in paths]
    try:
        first = files[0]
        for other in files[1:]:
            key = difference(first.scene, other.scene)
            if key is not None:
                raise UsageError(f"{other.path}: is of another scene than {first.path}: its {key} differs")
        kept = {k: v for k, v in first.attributes.items() if k in ("history", "documents", "motion", "model", "tolerance")}
        chunk = (int(first.chunk[1]), int(first.chunk[2]))
        with SpectraWriter(
            Path(output), first.structures, first.grid, chunk, impacts="impacts" in first.names, overwrite=overwrite, resume=False,
            scene=first.scene, attributes=kept,
        ) as writer:  # fmt: skip
            outcomes, there = np.zeros(len(Outcome), dtype=np.int64), 0
            for index in range(writer.chunks):
                holders = [f for f in files if f.done[index]]
                if not holders:
                    continue
                packed = next((f for f in holders if f.intact(index)), holders[0]).packed(index)
                outcomes += stored_outcomes(packed, first.offset(index), chunk, first.grid.shape)
                writer.write(*first.offset(index), packed)
                there += 1
            run_time = sum(float(f.attributes.get("run_time", 0.0)) for f in files)
            checked = sum(int(f.attributes.get("checked_cells", 0)) for f in files)
            worst = max(float(f.attributes.get("estimated_error", 0.0)) for f in files)
            counts = {f"cells_{o.flag}": int(outcomes[o]) for o in Outcome}
            cells = len(first.structures) * int(np.prod(first.grid.shape))
            counts["cells_not_computed"] = cells - int(outcomes.sum())
            writer.finish({"cells": cells, "run_time": run_time, "checked_cells": checked, "estimated_error": worst, **counts})
            return there, writer.chunks
    except (OutputError, UsageError):
        if not kept_part:
            part_of(Path(output)).unlink(missing_ok=True)  # it can be made again from the shards
        raise
    finally:
        for file in files:
            file.file.close()
