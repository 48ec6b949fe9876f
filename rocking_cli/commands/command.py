"""A command is a function: its parameters are the arguments, options and groups of
options of the command line.
"""

from collections.abc import Callable
from dataclasses import Field, field, fields
from functools import wraps
from inspect import signature
from typing import Any

import click

F = Callable[..., Any]
_PARTLY, _ALL = f"{__name__}.partly", f"{__name__}.all"
# options that --help leaves to --help-all
_LATER = """
--omega-g --T-g --A --Omega --azimuth --sign --linear-uplift --tolerance --eta --alpha
--csv --format --notes --columns --digits --units --overwrite --quiet --workers --seed
--fc --spectrum --inset-effect --resume --shard --scheduler --chunk --verify-cells
--strict --no-validity --impacts --row-step --steps --dimensionless --duration --site
--standing --bootstrap --efficiency --cells --curve --pulses --counts --exact --dpi
--size --style --title --author --place --summary --xlim --ylim --align --body --log
--periods --damping --building --column --dt --over --floor --cycles --gamma --phase
--component --unit --motion-dt --skip --as-it-stands --scale --scale-to --vertical-scale
--a-max --verdict-only --fail-on --export --method --where --skip-faulty --by
""".split()  # noqa: SIM905


class Command(click.Command):
    """A command whose --help shows the options that it needs."""

    def format_options(
        self, ctx: click.Context, formatter: click.HelpFormatter
    ) -> None:
        """Write the options that a command needs, with --help-all every one."""
        rows = [
            one.get_help_record(ctx)
            for one in self.get_params(ctx)
            if isinstance(one, click.Option)
            and (_ALL in ctx.meta or one.opts[-1] not in _LATER)
        ]
        with formatter.section("Options"):
            formatter.write_dl([row for row in rows if row is not None])

    def whole_help(self, ctx: click.Context) -> str:
        """Return the help with every option."""
        ctx.meta[_ALL] = True
        return self.get_help(ctx)


def option(flags: str, help: str, **settings: Any) -> Any:
    """A parameter of a command, or a field of a group: an option with these flags and
    the attributes of `click.option`.
    """
    settings = {"show_default": "default" in settings, "help": help, **settings}
    return field(
        metadata={"click": lambda name: click.option(*flags.split(), name, **settings)}
    )


def flag(flags: str, help: str) -> Any:
    """An option without a value, True if it is given."""
    return option(flags, help, is_flag=True)


def argument(**settings: Any) -> Any:
    """A parameter of a command: an argument with the attributes of `click.argument`."""
    return field(metadata={"click": lambda name: click.argument(name, **settings)})


def group(of: type) -> Any:
    """A parameter of a command: an object of this frozen dataclass, whose fields are
    options.
    """
    return field(metadata={"group": of})


def given(*names: str) -> list[str]:
    """Return those of these parameters that the call states, as the user writes them;
    an argument is FILE.
    """
    context = click.get_current_context()
    found = []
    for parameter in context.command.params:
        name = parameter.name or ""
        stated = (
            context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE
        )
        if isinstance(parameter, click.Argument):
            # click 8.2 calls an argument given even where there is none
            stated = bool(context.params[name])
        if name in names and stated:
            found.append(
                parameter.opts[-1] if isinstance(parameter, click.Option) else "FILE"
            )
    return found


def refuse(why: str, *names: str) -> None:
    """Raise click.UsageError if the call states one of these parameters, which would
    have no effect; why: the reason in words.
    """
    for flag in given(*names):
        raise click.UsageError(f"{flag} {why}")


def refuse_together(*names: str) -> None:
    """Raise click.UsageError if the call states more than one of these parameters."""
    if len(flags := given(*names)) > 1:
        raise click.UsageError(f"{' and '.join(flags)} do not go together")


def partly(lacks: object = True) -> None:
    """If `lacks` is true, set the exit code 4 (a part of the work has no result),
    unless the command returns another one.
    """
    if lacks:
        click.get_current_context().meta[_PARTLY] = True


def _help_all(ctx: click.Context, _param: click.Parameter, wanted: bool) -> None:
    """Print the help with every option, and end the call."""
    if wanted:
        assert isinstance(ctx.command, Command)
        click.echo(ctx.command.whole_help(ctx), color=ctx.color)
        ctx.exit()


def command(example: str, *shared: Callable[[F], F]) -> Callable[[F], click.Command]:
    """Return a decorator that turns a function into a command. example: a call for its
    help; shared: further decorators, which add the options of the output.

    >>> @command("rocking greet Ada --loud", printed)
    ... def greet(
    ...     name: str = argument(),
    ...     loud: bool = flag("--loud", "Shout."),
    ...     model: Model = group(Model),
    ... ) -> None:
    ...     '''Its help.'''
    """

    def decorate(function: F) -> click.Command:
        declared: dict[str, Field[Any]] = {
            name: one.default for name, one in signature(function).parameters.items()
        }
        groups = {
            name: one.metadata["group"]
            for name, one in declared.items()
            if "group" in one.metadata
        }

        @wraps(function)
        def called(**given: Any) -> Any:
            made = {
                name: of(**{one.name: given.pop(one.name) for one in fields(of)})
                for name, of in groups.items()
            }
            code = function(**made, **given)
            return code or (4 if _PARTLY in click.get_current_context().meta else 0)

        options: dict[str, Field[Any]] = {}
        for name, one in declared.items():
            options |= (
                {inner.name: inner for inner in fields(groups[name])}
                if name in groups
                else {name: one}
            )
        for_all: Callable[[F], F] = click.option(
            "--help-all",
            is_flag=True,
            is_eager=True,
            expose_value=False,
            callback=_help_all,
            help="Show every option and exit.",
        )
        wanted: F = for_all(called)
        for decorator in (
            *shared,
            *(one.metadata["click"](name) for name, one in reversed(options.items())),
        ):
            wanted = decorator(wanted)
        return click.command(cls=Command, epilog=f"Example: {example}")(wanted)

    return decorate
