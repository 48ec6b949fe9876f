"""Tables of verdicts: structures under motions, streamed chunk by chunk into a file as
sweeps are, of which shards are joined and an interrupted run goes on.
"""

import hashlib
import json
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.method import has_direction
from ..dynamics.outcome import Outcome, Work
from ..envelopes.amplitudes import LONGEST_FINE, Limit
from ..motions import Motion
from ..motions.grid import Grid
from ..motions.recording import Recording
from ..processes import available_cpus
from ..responses.check import verdicts
from ..responses.verdict import Verdict
from ..structures.parameters import RockingParameters
from .dimensions import LABEL, VERDICTS, Frame, Values, structure_lists, varied_units
from .file.layout import FileLayout, packed_block
from .scene import Unit, cut_into_units, stated_motion
from .sweep import crew, in_turn, kept, units_to_do
from .sweep_options import SweepOptions
from .work.jobs import Report
from .work.machine import version

CHUNK = 512  # structures of a unit of work
LONG_CHUNK = 32  # of one in which long records are searched, about a minute of work
SIGNS = ("stated", "opposite")
MODEL = "governing"  # the equation: of each structure its own


@dataclass(frozen=True, eq=False)
class VerdictScene:
    """What a table of verdicts is computed from. Its dimensions are (motion, structure,
    sign); of the second sign only bodies whose sides differ have a verdict.
    """

    structures: tuple[RockingParameters, ...]  # with distinct names
    # motions and demands by direction, one of SIGNS
    shakes: Mapping[str, Sequence[tuple[Motion, Grid]]]
    recordings: tuple[Recording, ...] = ()  # of the motions, none for a pulse
    a_max: Limit | None = None  # largest amplitude of the search, None without one
    forces: bool = False  # as of `verdicts`

    @property
    def shape(self) -> tuple[int, int, int]:
        """The number of places on each of the three dimensions."""
        return len(self.motions), len(self.structures), len(self.shakes)

    @property
    def motions(self) -> Sequence[tuple[Motion, Grid]]:
        """The motions with their demands, in the first direction."""
        return next(iter(self.shakes.values()))

    @property
    def together(self) -> int:
        """The number of structures of a unit of work."""
        longest = max(len(motion.segments) for motion, _ in self.motions)
        searched_long = self.a_max is not None and longest > LONGEST_FINE
        return LONG_CHUNK if searched_long else CHUNK

    def sharing(self) -> list[tuple[int, ...]]:
        """The motions one by one: no unit shares the result of another."""
        return [(i,) for i in range(len(self.motions))]

    def frame(self) -> Frame:
        """Return the values at all places, as the file has them."""
        names = [s.name for s in self.structures]
        motions = [motion.name for motion, _ in self.motions]
        signs: Values = list(self.shakes)
        labels: dict[str, tuple[str, Values]] = {
            f"{LABEL}{key.replace('/', '_')}": (
                "structure",
                [str(s.labels.get(key, "")) for s in self.structures],
            )
            for key in dict.fromkeys(key for s in self.structures for key in s.labels)
        }
        return Frame(
            {"motion": motions, "structure": names, "sign": signs},
            structure_lists(self.structures) | labels,
            varied_units(self.structures),
        )

    def identity(self) -> dict[str, Any]:
        """Return the input of the result by name, as JSON values; of the structures
        their number and the SHA-256 of their parameters.
        """
        rows = hashlib.sha256()
        for s in self.structures:
            rows.update(json.dumps(s.row()).encode() + b"\n")
        stated = {
            "version": version(),
            "model": MODEL,
            "structures_sha256": [len(self.structures), rows.hexdigest()],
            "motions": [
                [axis.name, axis.stated()]
                for _, grid in self.motions
                for axis in (grid.amplitude, grid.frequency)
            ],
            "records": [r.identity() for r in self.recordings],
            "pulses": [
                stated_motion(motion)
                for motion, _ in self.motions
                if not self.recordings
            ],
            "varied_units": varied_units(self.structures),
            "signs": list(self.shakes),
            "a_max": None if self.a_max is None else list(self.a_max),
            "forces": self.forces,
        }
        return dict(json.loads(json.dumps(stated)))


@dataclass(frozen=True)
class VerdictJob:
    """The data that a worker needs; called with units it returns their reports."""

    scene: VerdictScene  # the whole table
    convert: Any  # turns a block into the data of a report

    def __call__(self, units: Sequence[Unit]) -> list[Report]:
        return list(map(self._report, units))

    def only(self, units: Sequence[Unit]) -> "VerdictJob":
        """Return the job with the data that these units need: all."""
        return self

    def _report(self, unit: Unit) -> Report:
        """Return the report of a unit, whose only place is a motion."""
        scene, (place,) = self.scene, unit.places
        block: dict[str, np.ndarray] = {
            name: np.full(unit.shape, kind.fill, kind.dtype)
            for name, kind in VERDICTS.items()
        }
        for column, shakes in enumerate(scene.shakes.values()):
            rows = [
                i
                for i, s in enumerate(scene.structures[unit.rows])
                if not column or has_direction(s)
            ]
            found = verdicts(
                [(scene.structures[unit.row + i], *shakes[place]) for i in rows],
                a_max=scene.a_max,
                workers=1,
                forces=scene.forces,
            )
            for row, verdict in zip(rows, found, strict=True):
                for name, x in _numbers(verdict).items():
                    block[name][row, column] = x
        counts = np.bincount(block["outcome"].ravel(), minlength=len(Outcome))
        return Report(Work(), counts, np.zeros(0), (self.convert(block),), ())


def _numbers(verdict: Verdict) -> dict[str, Any]:
    """Return the variables of a verdict; what it does not know is left out."""
    row = verdict.row()
    coded = {name: getattr(verdict, name) for name in ("outcome", "outcome_linear")}
    return {name: row[name] for name in VERDICTS if row.get(name) is not None} | coded


def write_verdicts(
    scene: VerdictScene, path: str | Path, options: SweepOptions
) -> dict[str, Any]:
    """Compute a table of verdicts and stream it, chunk by chunk, into an HDF5 file
    (layout: `rocking help files`). Return the counts of verdicts by outcome and the run
    time [s], as the attributes of the file have them. Raises as `write_scene` does.
    """
    began = time.perf_counter()
    chunk = min(scene.together, len(scene.structures)), len(scene.shakes)
    units = list(cut_into_units(scene, chunk))
    layout = _layout(scene, chunk, options)
    with kept(path, layout, options) as writer:
        todo, outcomes = units_to_do(units, options.shard, writer.found)
        workers = max(1, min(options.workers or available_cpus(), len(todo)))
        job = VerdictJob(scene, partial(packed_block, layout.names, chunk))
        with crew(job, options, workers) as (run, _):
            batches = [[unit] for unit in todo]
            for _, report in in_turn(
                run(batches), todo, writer, options.progress, len(units)
            ):
                outcomes += report.outcomes
        outcomes[Outcome.NOT_COMPUTED] = math.prod(scene.shape) - outcomes.sum()
        found = {
            "cells": math.prod(scene.shape),
            "run_time": time.perf_counter() - began,
            **{f"cells_{o.flag}": int(outcomes[o]) for o in Outcome},
        }
        writer.finish(found)
    return found


def _layout(
    scene: VerdictScene, chunk: tuple[int, int], options: SweepOptions
) -> FileLayout:
    """Return the layout of the file of a table of verdicts."""
    attributes = {
        "title": "Verdicts on rocking structures",
        "history": options.history,
        "documents": options.documents,
        "motion": ", ".join(dict.fromkeys(motion.name for motion, _ in scene.motions)),
        "model": MODEL,
        "shard": "{}/{}".format(*options.shard or (1, 1)),
    }
    identity = scene.identity() | {"chunk": list(chunk)}
    return FileLayout(scene.frame(), chunk, tuple(VERDICTS), identity, attributes)
