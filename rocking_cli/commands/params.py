"""`rocking params`: structure documents to rocking parameters."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import click

from . import options


@click.command(epilog="Example: rocking params configs/block.yaml --json | jq .p")
@options.files
@click.option("--vary", "vary", multiple=True, metavar="KEY=START:STOP:N", help="A family over this key; repeatable, all combinations.")
@options.output_form
@options.quiet
@click.pass_context
def params(context: click.Context, files: tuple[str, ...], vary: tuple[str, ...], form: str | None, quiet: bool) -> None:
    """Derive p, alpha, eta, lambda and a_scale of each structure.

    FILE is a YAML or JSON structure document, - for standard input. Bounds of --vary without a unit take the unit that
    the document uses for that key. Members of a family without a solution are reported and the rest kept (exit code 4).
    """
    from ..structures import build_structure, read_documents, with_distinct_names
    from ..structures.family import family, members, parse_variation

    if not files:
        raise click.UsageError("no structure: give FILE, or - for standard input")
    variations = [parse_variation(text) for text in vary]
    total = members(variations)
    documents = [document for path in files for document in read_documents(path)]
    faults: list[str] = []

    def records() -> Iterator[dict[str, Any]]:
        if not variations:
            plain = [built.record() for built in with_distinct_names([build_structure(document) for document in documents])]
            every = dict.fromkeys(key for record in plain for key in record)
            yield from plain if form != "csv" else ({key: record.get(key) for key in every} for record in plain)
            return
        # Rows that appear on the terminal one by one are progress enough.
        progress = options.ProgressLine("params", quiet or (form is not None and sys.stdout.isatty()))
        for i, document in enumerate(documents):
            for j, member in enumerate(family(document, variations), 1):
                progress(i * total + j, len(documents) * total)
                if member.parameters is None:
                    faults.append(str(member.fault))
                    varied = ", ".join(f"{key}={value:g}" for key, value in member.varied.items())
                    options.note(f"no solution for {varied}: {member.fault}", quiet)
                else:
                    record = member.parameters.record()
                    yield record if form == "json" else {**_columns(record.pop("varied"), record), **record}

    options.emit(records(), form)
    if faults:
        context.exit(4)


def _columns(varied: dict[str, float], record: dict[str, Any]) -> dict[str, float]:
    """The varied values as columns of their own; one that is also a parameter, as alpha of a block, says so."""
    return {f"{key}_varied" if key in record else key: value for key, value in varied.items()}
