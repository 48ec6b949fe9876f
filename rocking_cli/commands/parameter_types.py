"""Types of option values, with shell completion."""

import os
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from ..errors import ArgumentError, RockingError, UsageError

if TYPE_CHECKING:
    from ..envelopes.amplitudes import Limit


class OutputPath(click.Path):
    """The name of a file to write."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:
        if value == "":
            self.fail(
                "found an empty name; expected the name of a file to write", param, ctx
            )
        return super().convert(value, param, ctx)


class InputPath(click.Path):
    """The name of a file to read, or - for standard input; the library reports its
    faults. A name below `configs` that is not in this folder is that of a file which is
    shipped with the package.
    """

    def __init__(self) -> None:
        super().__init__(readable=False, allow_dash=True)
        self.name = "file"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:
        found = str(super().convert(value, param, ctx))
        if Path(found).parts[:1] == ("configs",) and not os.path.exists(found):
            from ..structures.templates import shipped

            return str(shipped(Path(found).relative_to("configs")) or found)
        return found


class Registered(click.ParamType):
    """The type of an option that takes a word of a registry, such as
    `motions.pulses.PULSES`, or a word of `more`. The registry is imported only to list
    or complete its words; the library refuses other words.
    """

    name = "choice"

    def __init__(self, registry: str, *more: str) -> None:
        self.registry, self.more = registry, more

    def words(self) -> list[str]:
        module, _, name = self.registry.rpartition(".")
        return [*getattr(import_module(f"rocking_cli.{module}"), name), *self.more]

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        return f"[{'|'.join(self.words())}]"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        return [
            CompletionItem(word) for word in self.words() if word.startswith(incomplete)
        ]


class VariedKey(click.ParamType):
    """The text KEY=START:STOP:N; the keys that are quantities of the given structures
    are completed, those of all kinds without one.
    """

    name = "text"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        from ..structures import build_structure, read_documents
        from ..structures.kinds import known_keys

        known: dict[str, None] = {}
        for path in _given_files(ctx):
            with suppress(RockingError):
                for document in read_documents(path):
                    build_structure(document)
                    quantities = [
                        k for k, key in document.table.items() if key.is_quantity
                    ]
                    known |= dict.fromkeys([*quantities, *document.dimensions])
        return [
            CompletionItem(f"{key}=")
            for key in known or sorted(known_keys())
            if key.startswith(incomplete)
        ]


class NameInFile(click.ParamType):
    """The name of a structure or record in the given spectra files, which are
    completed.
    """

    name = "text"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        from ..spectra.file.reader import SpectraFile

        names: dict[str, None] = {}
        for path in _given_files(ctx):
            with suppress(RockingError), SpectraFile(path) as file:
                places = next(iter(file.frame.dimensions.values()))
                names |= dict.fromkeys(map(str, places))
        return [CompletionItem(name) for name in names if name.startswith(incomplete)]


def _given_files(ctx: click.Context) -> list[str]:
    """Return the files that a call states so far."""
    given = [*(ctx.params.get(name) for name in ("files", "file")), *ctx.args]
    several = [one if isinstance(one, tuple) else (one,) for one in given if one]
    return [str(path) for paths in several for path in paths if str(path) != "-"]


class Parsed(click.ParamType):
    """A value that a function reads from its text; the function raises ArgumentError
    with the texts that it accepts.
    """

    def __init__(self, name: str, read: Callable[[str], Any]) -> None:
        self.name, self.read = name, read

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:
        try:
            return self.read(str(value))
        except ArgumentError as error:
            raise UsageError(
                f"{param.opts[-1] if param else self.name}: found {value!r}; expected"
                f" {error}"
            ) from None


def quantity(dimension: str) -> Parsed:
    """Return the type of an option that takes a number of this dimension, bare (in SI)
    or with a unit.
    """

    def read(text: str) -> float:
        from ..documents.quantities import parse_quantity

        return parse_quantity(text, dimension)

    return Parsed(dimension, read)


def restitution(text: str) -> float | None:
    """Return the restitution of a text: a number from 0 to 1, or None for `block`,
    which is 1 - 3/2 sin^2 alpha. Raises ArgumentError.
    """
    value = None if text == "block" else NUMBER.read(text)
    if value is not None and not 0.0 <= value <= 1.0:
        raise ArgumentError("a number from 0 to 1, or block")
    return value


NUMBER = quantity("number")


def limit(text: str) -> "Limit":
    """Return the amplitude of a text: `20` is A, `1g` and `5 m/s2` are accelerations.
    Raises ArgumentError.
    """
    from ..documents.quantities import parse_quantity
    from ..envelopes.amplitudes import Limit

    for dimension in ("number", "acceleration"):
        with suppress(ArgumentError):
            return Limit(parse_quantity(text, dimension), dimension == "acceleration")
    raise ArgumentError("a number A, or an acceleration with a unit, such as 1g")


STATION = "station"
PULSE = Registered("motions.pulses.PULSES")


class PulseOrPath(InputPath):
    """A pulse by name, `station` or the name of a file, with shell completion."""

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        words = Registered(PULSE.registry, STATION).shell_complete(
            ctx, param, incomplete
        )
        return [*words, *super().shell_complete(ctx, param, incomplete)]
