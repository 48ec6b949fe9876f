"""Output of a call, by three functions, and its options: `emit` prints rows on standard
output, `note` a line that changes a decision on standard error, `detail` any other.

The library speaks of arguments in backticks; `in_options` makes them options: `a_g`
becomes --a-g.
"""

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from . import streams
from .command import F

if TYPE_CHECKING:
    from ..reports.conditions import Condition
    from ..reports.units import Units
    from ..structures import RockingParameters


def _keep(context: click.Context, parameter: click.Parameter, value: Any) -> None:
    if value is not None:
        context.meta[f"{__name__}.{parameter.name}"] = value


def _kept(name: str) -> Any:
    context = click.get_current_context(silent=True)
    return None if context is None else context.meta.get(f"{__name__}.{name}")


def _keep_quiet(
    context: click.Context, parameter: click.Parameter, value: bool
) -> None:
    streams.silent = value  # the thread that shows the progress knows no context
    _keep(context, parameter, value)


def _keep_units(
    context: click.Context, parameter: click.Parameter, text: str | None
) -> None:
    if text is not None:
        from ..reports.units import parse_units

        _keep(context, parameter, parse_units(text))


def _keep_form(
    context: click.Context, parameter: click.Parameter, style: str | None
) -> None:
    """Keep the style of the rows, and the form that it is of: none of a table."""
    if style is None:
        return
    stated = context.meta.setdefault(f"{__name__}.style_by", parameter.name)
    if stated != parameter.name:
        raise click.UsageError("--format does not go with --json or --csv", context)
    form = style.partition("-")[0]
    context.meta[f"{__name__}.style"] = style
    context.meta[f"{__name__}.form"] = form if form in ("json", "csv") else None


def _of_call(*flags: str, callback: Any = _keep, **settings: Any) -> Callable[[F], F]:
    return click.option(
        *flags, expose_value=False, is_eager=True, callback=callback, **settings
    )


_quiet = _of_call(
    "-q",
    "--quiet",
    is_flag=True,
    callback=_keep_quiet,
    help="No line on standard error but that of a failure.",
)
_notes = _of_call(
    "--notes",
    is_flag=True,
    help="Every line on standard error: the equation, the demand, limits.",
)
units = _of_call(
    "--units",
    metavar="UNIT,…",
    callback=_keep_units,
    help=(
        "Units of tables, CSV and figures, such as g,Hz,deg or cm (JSON and HDF5 are in"
        " SI)."
    ),
)
_json = _of_call(
    "--json",
    "form",
    flag_value="json",
    callback=_keep_form,
    help="JSON Lines on standard output.",
)
_csv = _of_call(
    "--csv",
    "form",
    flag_value="csv",
    callback=_keep_form,
    help="CSV on standard output.",
)
_format = _of_call(
    "--format",
    "style",
    type=click.Choice(["json", "csv", "csv-semicolon", "markdown", "latex"]),
    callback=_keep_form,
    help="Form of the rows; csv-semicolon has decimal commas.",
)
_columns = _of_call(
    "--columns",
    metavar="all|NAME,…",
    help="Columns to print, or all (default: JSON and CSV all, a table what decides).",
)
_where = _of_call(
    "--where",
    multiple=True,
    metavar="CONDITION",
    help="Print these rows only, such as 'capacity_demand < 1.5'; repeatable.",
)
_digits = _of_call(
    "--digits",
    type=click.IntRange(1, 17),
    help="Significant digits of a table (default: 4).",
)


def quiet(command: F) -> F:
    """Decorator: the options of the lines on standard error."""
    return _quiet(_notes(command))


def printed(command: F) -> F:
    """Decorator: the options of rows on standard output, and of the lines."""
    return _json(_csv(_format(_columns(_where(_digits(units(quiet(command))))))))


def is_quiet() -> bool:
    """True if the call has --quiet."""
    return bool(_kept("quiet"))


def wants_details() -> bool:
    """True if the call has --notes, and not --quiet."""
    return bool(_kept("notes")) and not is_quiet()


def units_of() -> "Units | None":
    """Return the units that --units states, None without it."""
    return _kept("units")


def form() -> str | None:
    """Return the form of the output: `json`, `csv`, or None for a table."""
    return _kept("form")


def chosen_columns() -> list[str]:
    """Return the columns that --columns names, empty without it and for `all`."""
    stated = (_kept("columns") or "").split(",")
    names = [name.strip() for name in stated if name.strip()]
    return [] if names == ["all"] else names


def asks_columns() -> bool:
    """True if the call has --columns."""
    return bool(_kept("columns"))


def units_shown(table_units: str | None = None) -> "Units":
    """Return the units of the rows: --units, for a table else
    `table_units`, else SI.
    """
    from ..reports.units import Units, parse_units

    if (asked := units_of()) is not None:
        return asked
    tabular = form() is None and table_units is not None
    return parse_units(str(table_units)) if tabular else Units()


def keep_labels(
    structures: "Iterable[RockingParameters]", in_rows: bool = False
) -> None:
    """Keep the labels of structures by name: `emit` adds them to the rows of each.
    in_rows: True if each row has them itself, in a column `labels`.
    """
    meta = click.get_current_context().meta
    kept = meta.setdefault(f"{__name__}.labels", {})
    names = meta.setdefault(f"{__name__}.label_names", {})
    for structure in structures:
        if structure.labels:
            if not in_rows:
                kept[structure.name] = dict(structure.labels)
            names |= dict.fromkeys(structure.labels)


def _labels_of(row: Mapping[str, Any]) -> Mapping[str, str]:
    """Return the labels of the structure of a row."""
    kept: Mapping[str, Mapping[str, str]] = _kept("labels") or {}
    own: Mapping[str, str] | None = row.get("labels")
    return own or kept.get(str(row.get("structure", row.get("name"))), {})


def _labelled(
    rows: Iterable[Mapping[str, Any]], form: str | None, chosen: Sequence[str]
) -> Iterator[Mapping[str, Any]]:
    """Yield rows with the labels of their structures: for JSON as one mapping, for CSV
    as columns at the end, for a table behind the name. A label with the name of another
    column of the row is called label_NAME.
    """
    for row in rows:
        mine = _labels_of(row)
        if form == "json" and not chosen:
            yield {**row, "labels": mine} if mine else row
            continue
        if "labels" in row:
            row = {key: x for key, x in row.items() if key != "labels"}
        named = {
            f"label_{name}" if name in row else name: mine.get(name)
            for name in _kept("label_names") or ()
        }
        if form is None:
            name = next((key for key in ("structure", "name") if key in row), None)
            first = {} if name is None else {name: row[name]}
            yield {**first, **named, **row}
        else:
            yield {**row, **named}


def require_columns(known: Iterable[str], sort: str | None = None) -> None:
    """Refuse, before anything is computed, a name of --columns, --where or --sort that
    is no column; one that the rows lack is empty in them. sort: a column, or capacity;
    known: the columns that the call may print,
    labels apart. Raises UsageError.
    """
    from ..reports.tables import unknown_column

    meta = click.get_current_context().meta
    names = dict.fromkeys([*known, *(_kept("label_names") or ())])
    meta[f"{__name__}.known_columns"] = names
    for name in chosen_columns():
        if name not in names:
            raise unknown_column(name, names)
    for one in _conditions():
        if one.column not in names:
            raise unknown_column(one.column, names, "where")
    if sort is not None and sort not in (words := ["capacity", *names]):
        raise unknown_column(sort, words, "sort")


def _conditions() -> "list[Condition]":
    """Return the conditions of --where. Raises UsageError."""
    if not (stated := _kept("where")):
        return []
    from ..reports.conditions import parse_condition

    return [parse_condition(text) for text in stated]


def _asked(
    rows: Iterable[Mapping[str, Any]], sort: str | None
) -> Iterable[Mapping[str, Any]]:
    """Return the rows of --where, in the order of the column `sort`; labels count as
    columns. Raises UsageError for a name that neither the first row nor
    `require_columns` has.
    """
    from ..reports.tables import unknown_column

    conditions = _conditions()
    if not conditions and sort is None:
        return rows

    def cell(row: Mapping[str, Any], name: str) -> Any:
        for key in row:
            if key.partition(" [")[0] == name:
                return row[key]
        return _labels_of(row).get(name.removeprefix("label_"))

    def kept() -> Iterator[Mapping[str, Any]]:
        for i, row in enumerate(rows):
            if i == 0:
                known = {key.partition(" [")[0]: None for key in row}
                known |= _kept("known_columns") or {}
                known |= dict.fromkeys(_kept("label_names") or ())
                named = [("where", one.column) for one in conditions]
                for option, name in [*named, ("sort", sort or "")]:
                    if name and name not in known:
                        raise unknown_column(name, known, option)
            if all(one.holds(cell(row, one.column)) for one in conditions):
                yield row

    if sort is None:
        return kept()
    from ..reports.conditions import in_order

    return in_order(kept(), lambda row: cell(row, sort))


def _selected(
    rows: Iterable[Mapping[str, Any]], chosen: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """Yield the chosen columns of rows, in their order. Raises UsageError for a name
    that neither the first row nor `require_columns` has.
    """
    from ..reports.tables import unknown_column

    for i, row in enumerate(rows):
        headings = {key.partition(" [")[0]: key for key in row}
        if i == 0:
            known = {**headings, **(_kept("known_columns") or {})}
            for name in chosen:
                if name not in known:
                    raise unknown_column(name, known)
        yield {(key := headings.get(name, name)): row.get(key) for name in chosen}


def emit(
    rows: Iterable[Mapping[str, Any]],
    columns: Sequence[str] = (),
    *,
    form: str | None = None,
    table_units: str | None = None,
    dimensions: Mapping[str, str | None] | None = None,
    unseen: Sequence[str] = (),
    above: Sequence[str] = (),
    varied: Mapping[str, Mapping[str, Any]] | None = None,
    sort: str | None = None,
) -> None:
    """Print rows: JSON, CSV and long tables each as soon as it is computed, a table at
    the end.

    columns: the header of a CSV without rows; form: the form of the output if no option
    states one; table_units: the units of a table if --units is not given; dimensions:
    of columns that have another one here than elsewhere, None without a unit; unseen:
    columns that a table has only if --columns names them; above: columns that stand
    above a table if they are the same in all rows; varied: for each structure the
    columns of its varied values, which come first; sort: the column in whose order the
    rows are, None for that in which they come.
    """
    from ..reports.tables import lines

    units, form = units_shown(table_units), _kept("form") or form
    if dimensions:
        units = replace(units, dimensions=dimensions)
    chosen, every = chosen_columns(), asks_columns()
    if varied:
        rows = ({**varied.get(str(row.get("structure")), {}), **row} for row in rows)
    rows = _asked(rows, sort)
    if unseen and form is None and not every:
        hidden = set(unseen)
        rows = ({k: x for k, x in row.items() if k not in hidden} for row in rows)
    rows = _labelled(rows, form, chosen)
    if chosen and (form is not None or _kept("known_columns")):
        rows = _selected(rows, chosen)
    layout: dict[str, Any] = {}
    if form is None:
        layout = {"digits": _kept("digits") or 4, "width": _width(), "chosen": chosen}
        if not chosen:
            labels = [*(_kept("label_names") or ())]
            layout["above"] = [*above, *labels]
            layout["spare"] = [] if every else [*labels, "demand_a"]
    for line in lines(
        rows,
        _kept("style") or form or "table",
        columns,
        encoding=sys.stdout.encoding,
        units=units,
        **layout,
    ):
        streams.put(line)


def _width() -> int:
    """Return the width of a table in characters: that of the terminal, if it is one."""
    from shutil import get_terminal_size

    from ..reports.tables import WIDTH

    return get_terminal_size((WIDTH, 0)).columns if sys.stdout.isatty() else WIDTH


def in_options(text: str, command: click.Command) -> str:
    """Return a sentence of the library with the arguments in backticks replaced by the
    options of the command; other words stay.
    """
    options: dict[str, str] = {}
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            long = parameter.opts[-1]
            options |= {
                str(parameter.name): long,
                long.lstrip("-").replace("-", "_"): long,
            }
    return re.sub(r"`(\w+)`", lambda found: options.get(found[1], found[0]), text)


def note(*lines: str, even_quiet: bool = False) -> None:
    """Print lines that change a decision on standard error, unless --quiet; the
    library's terms in them are replaced by the options of the command. even_quiet: True
    for the reason of an exit code.
    """
    context = click.get_current_context(silent=True)
    for line in lines if even_quiet or not is_quiet() else ():
        streams.say(line if context is None else in_options(line, context.command))


def detail(*lines: str) -> None:
    """Print lines as `note` does, with --notes alone."""
    if wants_details():
        note(*lines)
