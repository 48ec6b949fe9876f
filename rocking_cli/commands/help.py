"""`rocking help`: the reference of a command or a topic, from the pages in `pages/`."""

from importlib.resources import files

import click

from ..errors import did_you_mean
from . import COMMANDS, streams
from .command import Command, argument, command, option
from .parameter_types import Registered

TOPICS = {
    "documents": "Structure documents: every kind and every key.",
    "base": "Sliding, crushing toes, floors of buildings: keys, limits, figures.",
    "isolation": "Base isolation: a floor with one mode.",
    "spreads": "Numbers with a spread, draws, shares and their intervals.",
    "ties": "Ties, tendons and dampers of rigid bodies: keys, forces, columns.",
    "motions": "Pulses, motion documents and records as motions.",
    "files": "Spectra files: contents, checksums, partial files.",
    "output": "Streams, tables, JSON and CSV, exit codes, completion.",
    "python": "The Python functions of each command.",
    "code": "A check by the Italian code: columns, formulas, demand, limits.",
    "defects": "Wrong verdicts and numbers of earlier commits, and when they ended.",
    "words": "The words of commands, columns and files, each with one meaning.",
}

_LISTS = "KEYS OF EACH KIND"  # the place of the lists that the tables of keys give
_NAMES = Registered("commands.help.TOPICS", *COMMANDS)


@command("rocking help documents")
def help(
    name: str | None = argument(required=False, type=_NAMES, metavar="[COMMAND|TOPIC]"),
    search: str | None = option(
        "--search",
        "Print the lines of all pages that hold these words.",
        metavar="WORD",
    ),
) -> None:
    """Print the reference of a command, its options and examples, or of a topic.

    Without a name, list the commands and the topics.
    """
    if search is not None:
        if name is not None:
            raise click.UsageError(f"--search looks in all pages: leave out {name}")
        streams.put(*_found(search))
        return
    if name is not None and name not in COMMANDS | TOPICS:
        names = dict.fromkeys(["words", *TOPICS, *COMMANDS])  # the glossary first
        pages = [
            f"`rocking help {topic}`"
            for topic in names
            if name.lower() in page(topic).lower().split()
        ]
        begins = any(known.startswith(name.lower()) for known in names)
        # A word that some page has is not a misspelt command.
        meant = did_you_mean(name, names) if begins or not pages else ""
        raise click.UsageError(
            f"No such command or topic {name!r}{meant}"
            + (f"; it stands in {', '.join(pages[:3])}" if pages else "")
        )
    group = click.get_current_context().find_root()
    if name is None:
        formatter = group.make_formatter()
        with formatter.section("Topics"):
            formatter.write_dl(
                [
                    (topic.ljust(max(map(len, COMMANDS))), summary)
                    for topic, summary in TOPICS.items()
                ]
            )
        text = f"{group.get_help()}\n\n{formatter.getvalue()}"
    else:
        text = page(name)
        assert isinstance(group.command, click.Group)
        if command := group.command.get_command(group, name):
            assert isinstance(command, Command)
            context = click.Context(command, parent=group, info_name=name)
            text = f"{command.whole_help(context)}\n\n{text}"
    streams.put(*text.rstrip().splitlines())


def _found(words: str) -> list[str]:
    """Return the lines of all pages, and the options of all commands, that hold these
    words, each after the name of its page. Raises click.UsageError for no line.
    """
    wanted = words.casefold().split()
    group = click.get_current_context().find_root()
    assert isinstance(group.command, click.Group)
    found: dict[str, None] = {}
    for name in (*TOPICS, *COMMANDS):
        lines = page(name).splitlines()
        if command := group.command.get_command(group, name):
            context = click.Context(command, info_name=name)
            options = [one for one in command.params if isinstance(one, click.Option)]
            records = [one.get_help_record(context) for one in options]
            lines += ["  ".join(record) for record in records if record is not None]
        for line in lines:
            if all(word in line.casefold() for word in wanted):
                found[f"{name:11} {' '.join(line.split())}"] = None
    if not wanted or not found:
        raise click.UsageError(f"--search: found no line with {words!r} in any page")
    return list(found)


def page(name: str) -> str:
    """Return the page of a command or a topic; empty for a command that has only its
    --help.
    """
    found = files(__package__) / "pages" / f"{name}.txt"
    text = found.read_text(encoding="utf-8") if found.is_file() else ""
    if _LISTS not in text:
        return text
    from ..structures.templates import key_lists

    return text.replace(_LISTS, key_lists())
