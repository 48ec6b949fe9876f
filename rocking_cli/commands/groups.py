"""Groups of options: a frozen dataclass whose fields are the options, which a command receives as one argument."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, fields
from functools import wraps
from typing import Any

import click

F = Callable[..., Any]


def option(*flags: str, **settings: Any) -> Any:
    """A field of a group: an option with the flags and attributes of `click.option`; its value is stored under the name of the field."""
    return field(metadata={"option": lambda name: click.option(*flags, name, **settings)})


def takes(**groups: type) -> Callable[[F], F]:
    """A decorator with the options of these groups, in this order; the command receives each group as the argument of that name.

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

        for one in reversed([one for group in groups.values() for one in fields(group)]):
            with_groups = one.metadata["option"](one.name)(with_groups)
        return with_groups

    return decorate
