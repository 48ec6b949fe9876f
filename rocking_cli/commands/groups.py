"""Groups of options: a frozen dataclass whose fields are the options, which a command receives as one argument."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, fields
from functools import wraps
from typing import Any

import click

F = Callable[..., Any]


def option(*flags: str, **settings: Any) -> Any:
    """A field of a group: the option of these flags, as `click.option` takes them, under the name of the field."""
    return field(metadata={"options": (lambda name: click.option(*flags, name, **settings),)})


def choice(**flags: str) -> Any:
    """A field of a group that takes the name of the flag that is given, or None: `choice(json=help)` is --json."""
    made = [lambda name, flag=flag, text=text: click.option(f"--{flag}", name, flag_value=flag, help=text) for flag, text in flags.items()]
    return field(metadata={"options": tuple(made)})


def takes(**groups: type) -> Callable[[F], F]:
    """The options of these groups, in this order; the command receives each group as the argument of that name.

    >>> @dataclass(frozen=True)
    ... class Solver:
    ...     model: str | None = option("--model", help="Equation of motion.")
    >>> @click.command()
    ... @takes(solver=Solver)
    ... def command(solver: Solver) -> None: ...
    """

    def decorate(command: F) -> F:
        @wraps(command)
        def with_groups(*arguments: Any, **given: Any) -> Any:
            made = {name: group(**{one.name: given.pop(one.name) for one in fields(group)}) for name, group in groups.items()}
            return command(*arguments, **made, **given)

        every = [made(one.name) for group in groups.values() for one in fields(group) for made in one.metadata["options"]]
        for add in reversed(every):
            with_groups = add(with_groups)
        return with_groups

    return decorate
