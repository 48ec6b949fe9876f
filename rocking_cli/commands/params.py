"""`rocking params`: rocking parameters of structure documents."""

import json
import math
from collections.abc import Iterator
from itertools import chain
from typing import TYPE_CHECKING, Any

from . import equations, options
from .command import command
from .printing import emit, form, keep_labels, note, printed
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..structures import RockingParameters

KEYS = ("name",)  # the column that says which row it is
SHARED = {
    "one_sided": False,
    "damping": 0.0,
    "friction": None,
    "arm": None,
}  # keys that some members have, and what stands for none


@command("rocking params configs/block.yaml --json | jq .p", printed)
def params(
    files: tuple[str, ...] = options.files(),
    vary: tuple[str, ...] = options.vary(),
    linear_uplift: str = equations.linear_uplift(),
) -> None:
    """Derive p, alpha, eta, lambda and a_scale of each structure.

    FILE is a YAML or JSON structure document, - for standard input. Bounds of --vary
    without a unit have the unit of that key in the document. A body with unequal sides
    has the parameters of the edge that lifts first, and those of each edge. A stack has
    those of each interface: as rows below it, with --json and --csv as
    `other_interfaces`. Members of a family without a solution are reported and left out
    (exit code 4).
    """
    from ..reports.tables import flat
    from ..structures import build_structure, on_each_interface, with_distinct_names
    from ..structures.family import family, members, parse_variation
    from ..structures.parameters import OTHERS

    documents = options.documents_of(files)
    variations = [parse_variation(text) for text in vary]
    total = members(variations)
    shown = form()
    early: list[RockingParameters] = []

    def printed() -> Iterator[dict[str, Any]]:
        if not variations:
            built = equations.lifting(
                with_distinct_names(
                    [build_structure(document) for document in documents]
                ),
                linear_uplift,
            )
            options.introduce(built)
            early.extend(
                s
                for s in built
                if shown is None
                and s.restraints is None
                and s.uplift > 1.01 * s.linear_uplift
            )
            for document, structure in zip(documents, built, strict=True):
                others = (
                    [build_structure(one) for one in on_each_interface(document)[1:]]
                    if shown is not None
                    else []
                )
                more = (
                    {
                        OTHERS: [
                            other.row()
                            for other in equations.lifting(others, linear_uplift)
                        ]
                    }
                    if others
                    else {}
                )
                yield from _rows({**structure.row(), **more}, shown)
            return
        progress = ProgressLine("params", "structures")
        for i, document in enumerate(documents):
            for j, member in enumerate(family(document, variations), 1):
                progress(i * total + j, len(documents) * total)
                if member.parameters is None:
                    options.note_no_solution(member)
                else:
                    (structure,) = equations.lifting([member.parameters], linear_uplift)
                    keep_labels([structure])
                    yield from _rows(structure.row(), shown, member.shown)

    if shown == "csv":  # a later row may have more columns than the first
        rows = [flat(row) for row in printed()]
        every = dict.fromkeys(chain.from_iterable(rows))
        emit([every | row for row in rows], keys=KEYS)
    else:
        emit(printed(), keys=KEYS)
    for s in early:
        lifts = (
            f"lifts it at alpha/a_scale = {s.linear_uplift:.4g} g, the body at lambda ="
            f" {s.uplift:.4g} g"
        )
        note(f"{s.name}: the linear equation {lifts}")


def _rows(
    row: dict[str, Any], form: str | None, varied: dict[str, float] | None = None
) -> Iterator[dict[str, Any]]:
    """Yield the rows of a structure: for CSV one with the columns of its sides, for a
    table one for each side or interface.
    """
    from ..structures.parameters import OTHERS, VARIED

    if form == "json":
        yield row
        return
    row = {key: value for key, value in row.items() if key != "labels"}  # emit has them
    if varied is not None:
        row = {key: value for key, value in row.items() if key not in VARIED}
    sides = row.pop("sides", [])
    if form == "csv":
        columns = {
            f"{side['side']}_{key}": value
            for side in sides
            for key, value in side.items()
            if key != "side"
        }
        columns |= {OTHERS: json.dumps(row[OTHERS])} if OTHERS in row else {}
        row = {
            **row,
            **(
                {key: row.get(key, absent) for key, absent in SHARED.items()}
                if varied
                else {}
            ),
            **columns,
        }
    below = [{"name": f"  {side.pop('side')} edge", **side} for side in sides]
    if form is None:
        below += [
            {"name": f"  on {one.pop('on')}", **one}
            for one in row.pop("interfaces", [])
        ]
        below += [
            {"name": f"  restrained, {one['side']}", **one}
            for one in row.pop("restrained", [])
        ]
        row = {
            key: value
            for key, value in row.items()
            if key not in ("ties", "tendon", "stands", OTHERS)
        }
        below += _joint_rows(row.pop("joints", []), "")
        below += _joint_rows(row.pop("joints_other", []), "other side, ")
        if "hinges" in row:
            row["hinges [deg]"] = ", ".join(
                f"{math.degrees(hinge['angle']):.6g}" for hinge in row.pop("hinges")
            )
    # alpha of a block is both a varied key and a parameter
    yield {
        **{_apart(heading, row): value for heading, value in (varied or {}).items()},
        **row,
    }
    if form is None:
        yield from below


def _joint_rows(joints: list[dict[str, Any]], which: str) -> Iterator[dict[str, Any]]:
    """Yield a row of a table for each joint of a mechanism: its place and forces."""
    for joint in joints:
        kind = "hinge" if "hinge" in joint else "slide"
        bodies = joint[kind] if isinstance(joint[kind], str) else "-".join(joint[kind])
        x, z = joint["at"]
        forces = {
            key: value
            for key, value in joint.items()
            if key not in (kind, "at", "along")
        }
        yield {"name": f"  {which}{kind} {bodies} at [{x:.4g}, {z:.4g}] m", **forces}


def _apart(heading: str, row: dict[str, Any]) -> str:
    key, bracket, unit = heading.partition(" [")
    return f"{key}_varied{bracket}{unit}" if key in row or key in SHARED else heading
