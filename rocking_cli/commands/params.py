"""`rocking params`: rocking parameters of structure documents."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from . import equations, options
from .command import command, flag, group, option, refuse
from .draws import Draws, require_spreads
from .printing import (
    asks_columns,
    detail,
    emit,
    form,
    keep_labels,
    printed,
    wants_details,
)
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..documents.document import Document
    from ..structures.family import Variation

# columns of a table without --details; the last two are those of a held wall
SHOWN = (
    *("name", "p", "alpha", "eta", "lambda", "a_scale"),
    *("crack_height", "top_reaction"),
)
# keys that only some members of a family have, with the value for the others
SHARED = {
    "one_sided": False,
    "damping": 0.0,
    "friction": None,
    "arm": None,
}


@command("rocking params configs/block.yaml --json | jq .p", printed)
def params(
    files: tuple[str, ...] = options.files(),
    vary: tuple[str, ...] = options.vary(),
    skip_faulty: bool = options.skip_faulty(),
    linear_uplift: str = equations.linear_uplift(),
    details: bool = flag(
        "--details",
        "In a table all columns, and rows for sides, interfaces, hinges and ties.",
    ),
    over: str | None = options.over(),
    sort: str | None = option(
        "--sort", "Print the rows in the order of a column.", metavar="COLUMN"
    ),
    drawn: Draws = group(Draws),
    figure: options.FigureFile = group(options.FigureFile),
) -> None:
    """Derive p, alpha, eta, lambda and a_scale of each structure.

    FILE is a YAML or JSON structure document, - for standard input. Bounds of --vary
    without a unit have the unit of that key in the document. With --draws a row for
    each quantity: its mean, standard deviation and quantiles. A body with unequal sides
    has the parameters of the edge that lifts first, and those of each edge. A stack has
    those of each interface: as rows below it, with --json and --csv as
    `other_interfaces`. Members of a family without a solution are reported and left out
    (exit code 4).
    """
    from ..structures.family import parse_variation

    figure.check()
    if not vary:
        refuse("goes with --vary, whose family it draws", "output")
    else:
        refuse("does not go with --vary", "skip_faulty")
    if figure.output is None:
        refuse("goes with -o FIGURE", "over")
    if drawn.draws:
        refuse("does not go with --draws", "vary", "linear_uplift")
        structures = options.structures_of(files)
        require_spreads(drawn.draws, structures)
        emit(list(drawn.rows(structures)))
        return
    variations = [parse_variation(text) for text in vary]
    if not variations:
        early: list[str] = []
        rows = _structure_rows(files, linear_uplift, early, details)
        _print(rows, sort)
        detail(*early)
        return
    documents = options.documents_of(files)
    variations += _unvaried(over, variations, documents)
    members: list[dict[str, Any]] = []  # as the CSV has them
    rows = _family_rows(documents, variations, linear_uplift, members, details)
    _print(rows, sort)
    figure.draw(members, over)


def _unvaried(
    over: str | None, variations: Sequence[Variation], documents: Sequence[Document]
) -> list[Variation]:
    """Return the keys of --over that are not varied, each with its value in the
    document. Raises UsageError if documents differ in it.
    """
    from ..errors import UsageError
    from ..structures.family import parse_variation

    known = {variation.key for variation in variations}
    found = []
    for key in (over or "").split("/"):
        if not key or key in known:
            continue
        stated = {
            str(document.values[key].content) if key in document.values else None
            for document in documents
        }
        (value, *others) = stated
        if value is None or others:
            raise UsageError(
                f"--over {over}: found no single value of {key} in the documents;"
                f" expected keys of --vary, or give --vary {key}=START:STOP:N"
            )
        found.append(parse_variation(f"{key}={value}:{value}:1"))
    return found


def _structure_rows(
    files: tuple[str, ...], uplift: str, early: list[str], details: bool
) -> Iterator[dict[str, Any]]:
    """Yield the rows of the structures of files; those of JSON and CSV hold the other
    interfaces of a stack. A structure goes before the next one is read. uplift: see
    --linear-uplift; early: gets a sentence on each structure of a table that the linear
    equation lifts more than 1 % below lambda g.
    """
    from ..structures import build_structure, on_each_interface, with_distinct_names
    from ..structures.parameters import OTHERS

    shown = form()
    documents = options.each_document(files)
    built = with_distinct_names(options.sound(build_structure, documents))
    lifting = (equations.lifted(structure, uplift) for structure in built)
    for s in options.introduced(lifting, in_rows=True):
        row = s.row()
        if shown is None:
            if (
                wants_details()
                and s.restraints is None
                and s.uplift > 1.01 * s.linear_uplift
            ):
                early.append(
                    f"{s.name}: the linear equation lifts it at alpha/a_scale ="
                    f" {s.linear_uplift:.4g} g, the body at lambda = {s.uplift:.4g} g"
                )
        elif s.document is not None:
            interfaces = on_each_interface(s.document)[1:]
            if others := [build_structure(interface) for interface in interfaces]:
                row[OTHERS] = [equations.lifted(o, uplift).row() for o in others]
        yield from _rows(row, shown, details)


def _family_rows(
    documents: Sequence[Document],
    variations: Sequence[Variation],
    uplift: str,
    members_seen: list[dict[str, Any]],
    details: bool,
) -> Iterator[dict[str, Any]]:
    """Yield the rows of the members of families; those without a solution are reported;
    members_seen: gets the rows of a CSV.
    """
    from ..structures.family import family, members

    total = members(variations)
    progress = ProgressLine("params", "structures")
    for i, document in enumerate(documents):
        for j, member in enumerate(family(document, variations), 1):
            progress(i * total + j, len(documents) * total)
            if member.parameters is None:
                options.note_no_solution(member)
            else:
                structure = equations.lifted(member.parameters, uplift)
                keep_labels([structure])
                seen = _rows(structure.row(), "csv", details, member.shown)
                members_seen.extend(seen)
                yield from _rows(structure.row(), form(), details, member.shown)


def _print(rows: Iterable[dict[str, Any]], sort: str | None) -> None:
    """Print rows when all are known: a fault of the last document comes before the
    first row, and the header of a CSV has the columns of all rows.
    """
    from ..packed import Packed

    waiting = Packed[dict[str, Any]]()
    columns: dict[str, None] = {}
    for row in rows:
        known = _flat(row) if form() == "csv" else row
        columns |= dict.fromkeys(known)
        waiting.append(known)
    if form() == "csv":
        columns.pop("labels", None)
        emit((columns | row for row in waiting), sort=sort)
    else:
        emit(waiting, sort=sort)


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row of CSV with a column for each number; the labels stay together."""
    from ..reports.tables import flat

    labels = row.pop("labels", None)
    return flat(row) | ({"labels": labels} if labels else {})


def _rows(
    row: dict[str, Any],
    form: str | None,
    details: bool,
    varied: dict[str, float] | None = None,
) -> Iterator[dict[str, Any]]:
    """Yield the rows of a structure: for JSON and CSV one, for a table with details
    more, of each side or interface. varied: the values of the varied keys by heading.
    """
    from ..structures.parameters import VARIED

    if form == "json":
        yield row
        return
    # emit has the labels of a family
    for key in () if varied is None else ("labels", *VARIED):
        row.pop(key, None)
    sides = row.pop("sides", [])
    below: list[dict[str, Any]] = []
    if form == "csv":
        row = _csv_row(row, sides, bool(varied))
    else:
        row, below = _table_rows(row, sides)
        if not details:
            below = []
            if not asks_columns():
                row = {key: row[key] for key in (*SHOWN, "labels") if key in row}
    # alpha of a block is both a varied key and a parameter
    if varied:
        row = {_apart(heading, row): x for heading, x in varied.items()} | row
    yield row
    yield from below


def _csv_row(
    row: dict[str, Any], sides: Sequence[dict[str, Any]], of_a_family: bool
) -> dict[str, Any]:
    """Return the row with the columns of its sides, such as left_p."""
    from ..structures.parameters import OTHERS

    columns: dict[str, Any] = {}
    if of_a_family:
        columns = {key: row.get(key, absent) for key, absent in SHARED.items()}
    for side in sides:
        name = side["side"]
        columns |= {f"{name}_{key}": x for key, x in side.items() if key != "side"}
    if OTHERS in row:
        columns[OTHERS] = json.dumps(row[OTHERS])
    return row | columns


def _table_rows(
    row: dict[str, Any], sides: Sequence[dict[str, Any]]
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return (the row of a structure in a table, the rows below it)."""
    from ..structures.parameters import OTHERS

    below = [{"name": f"  {side.pop('side')} edge", **side} for side in sides]
    below += [
        {"name": f"  on {one.pop('on')}", **one} for one in row.pop("interfaces", [])
    ]
    below += [
        {"name": f"  restrained, {one['side']}", **one}
        for one in row.pop("restrained", [])
    ]
    below += _joint_rows(row.pop("joints", []), "")
    below += _joint_rows(row.pop("joints_other", []), "other side, ")
    hidden = ("ties", "tendon", "stands", OTHERS)
    row = {key: value for key, value in row.items() if key not in hidden}
    if "hinges" in row:
        angles = [math.degrees(hinge["angle"]) for hinge in row.pop("hinges")]
        row["hinges [deg]"] = ", ".join(f"{angle:.6g}" for angle in angles)
    return row, below


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
