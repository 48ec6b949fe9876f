"""The command line. Each command is a module of its own, imported when it is called."""

import atexit
import errno
import gc
import os
import re
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import click

from .. import __version__
from ..errors import RockingError, did_you_mean
from ..interruption import listen
from . import progress, streams
from .printing import in_options

SECTIONS = {
    "Structures": {
        "init": "Print a commented document to begin with.",
        "params": "Derive p, alpha, eta, lambda and a_scale of each structure.",
        "draw": "Draw structures to scale, with pivots, hinges and cracks.",
    },
    "Ground motions": {
        "records": "Show what recorded ground motions hold, and measure them."
    },
    "One structure, one motion": {
        "check": "Check which structures stand, and by what margin.",
        "response": "Time history of one structure under one motion.",
        "identify": "Fit inset, p and eta to measured free rocking.",
        "solve": "Find the values of a key from which a structure stands.",
        "compare": "Compare structures at equal A and Omega, or the two equations.",
    },
    "All amplitudes and frequencies": {
        "envelope": "Trace every interval of amplitude that overturns.",
        "spectrum": "Sweep structures over a grid and write their rocking spectrum.",
        "fragility": "Fit the probability of falling under a set of motions.",
        "predict": "Predict the response of structures from a spectrum.",
    },
    "Results": {
        "report": "Write a page of verdicts, drawings and maps.",
        "plot": "Draw spectra, envelopes, responses, families.",
        "info": "Show what a spectra file holds, and verify it.",
        "convert": "Stream the cells of a spectra file.",
        "merge": "Put together the shards of a sweep.",
    },
    "How far to trust it": {
        "accuracy": "Error against run time for a scene.",
        "verify": "Run the shipped cases and compare with their sources.",
        "help": "The reference of a command or a topic, with examples.",
    },
}
# objects between two garbage collections; the default of 700 collects many times during
# the imports
_COLLECTED = 100_000
_MEANT = {
    "--amplitude": "--a-g",
    "--freq": "--f-g",
    "--frequency": "--f-g",
    "--period": "--T-g",
    "--phase": "--phase-portrait",
    "--check": "--verify-cells",
    "--record": "--motion",
    "--xlsx": "--csv",
    "--excel": "--csv",
}
_NUMBER = re.compile(r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?")
COMMANDS = {
    name: summary for section in SECTIONS.values() for name, summary in section.items()
}


class _Commands(click.Group):
    """Commands by name, imported only when one is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(
            import_module(f"{__name__}.{cmd_name}"), cmd_name
        )
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if (
            args[0] not in COMMANDS
            and not args[0].startswith("-")
            and not ctx.resilient_parsing
        ):
            meant = did_you_mean(args[0], COMMANDS)
            if not meant and (os.path.exists(args[0]) or ":" in args[0]):
                meant = f"; expected one before it: rocking check {args[0]}"
            raise click.UsageError(f"No such command {args[0]!r}{meant}", ctx)
        name, command, rest = super().resolve_command(ctx, args)
        _refuse_apart(rest)
        if command is not None and not ctx.resilient_parsing:
            _refuse_repetitions(click.Context(command, ctx, name), rest)
        return name, command, rest

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except RockingError as error:
            command = self.get_command(ctx, ctx.invoked_subcommand or "")
            if command is not None:
                error.args = (in_options(str(error), command),)
            raise

    def format_commands(
        self, ctx: click.Context, formatter: click.HelpFormatter
    ) -> None:
        widest = max(map(len, COMMANDS))
        for title, commands in SECTIONS.items():
            with formatter.section(title):
                formatter.write_dl(
                    [
                        (name.ljust(widest), summary)
                        for name, summary in commands.items()
                    ]
                )


def _refuse_apart(arguments: Sequence[str]) -> None:
    """Raise click.UsageError for a number and its unit in two words, as `--a-g 0.3 g`:
    click would take the unit for a file.
    """
    for flag, number, unit in zip(
        arguments, arguments[1:], arguments[2:], strict=False
    ):
        if not (flag.startswith("--") and _NUMBER.fullmatch(number)):
            continue
        from ..documents.quantities import FACTORS

        if unit in FACTORS and not os.path.exists(unit):
            raise click.UsageError(
                f"{flag} {number} {unit}: found a number and its unit in two words;"
                f" expected one, {flag} {number}{unit} or {flag} '{number} {unit}'"
            )


def _refuse_repetitions(context: click.Context, arguments: list[str]) -> None:
    """Raise click.UsageError if an option that takes one value is given twice; click
    would keep the last one silently.
    """
    _, _, order = context.command.make_parser(context).parse_args(list(arguments))
    given: dict[str | None, click.Option] = {}
    for option in order:
        if not isinstance(option, click.Option) or option.multiple:
            continue
        if option.name not in given:
            given[option.name] = option
        elif given[option.name] is not option:
            raise click.UsageError(
                f"{given[option.name].opts[-1]} does not go with {option.opts[-1]}",
                context,
            )
        elif not option.is_flag:
            raise click.UsageError(
                f"{option.opts[-1]} is given twice; expected one value", context
            )


def _no_such_option(error: click.NoSuchOption, arguments: list[str]) -> str:
    """Return the sentence for an unknown option, with the long option that is probably
    meant.
    """
    name = error.option_name
    if not name.startswith("--"):  # of -pulse click sees -p
        name = next(
            (
                a.partition("=")[0]
                for a in arguments
                if a.startswith(name) and not a.startswith("--")
            ),
            name,
        )
    long = (
        [o for p in error.ctx.command.params for o in p.opts if o.startswith("--")]
        if error.ctx is not None
        else []
    )
    said, word = f"No such option {name}", "--" + name.lstrip("-")
    if len(name.lstrip("-")) == 1:
        return said
    others = [o for o in COMMANDS if word in _options_of(o)]
    if others and not {word, _MEANT.get(word)}.intersection(long):
        return f"{said}; commands with it: {', '.join(others)}"
    return said + did_you_mean(word, [*long, "--help"], _MEANT)


def _options_of(command: str) -> list[str]:
    """Return the options of a command."""
    module = import_module(f"{__name__}.{command}")
    return [o for p in getattr(module, command).params for o in p.opts]


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: rocking params configs/block.yaml",
)
@click.version_option(__version__, prog_name="rocking")
def cli() -> None:
    """Rocking parameters and rocking spectra of masonry structures.

    Exit codes: 0 done, 1 failed, 2 usage, 3 invalid document, 4 finished with some
    cells failed, 5 check --fail-on, 130 interrupted.
    """


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line. A failure prints one sentence on standard error and ends
    with its documented exit code.
    """
    # More threads of OpenBLAS would wait at full speed for work that never comes.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(_COLLECTED)
    # The last collection of the interpreter would visit every object of every module,
    # which takes a tenth of a small sweep; the system takes the memory back at once.
    atexit.register(gc.freeze)
    listen()
    with streams.guarded(), progress.reporting():
        try:
            return sys.exit(
                cli.main(arguments, prog_name="rocking", standalone_mode=False) or 0
            )
        except click.exceptions.NoArgsIsHelpError as error:
            for line in error.format_message().splitlines():
                streams.say(line)
            sys.exit(2)
        except click.ClickException as error:
            if isinstance(error, click.UsageError) and error.ctx is not None:
                said = error.format_message()
                if isinstance(error, click.NoSuchOption):
                    said = _no_such_option(
                        error, sys.argv if arguments is None else arguments
                    )
                if "unexpected extra argument" in said and error.ctx.params.get(
                    "motion"
                ):
                    said = f"{said.rstrip('.')}; expected one FILE after each --motion"
                # click puts the choices of the parameter into lines of their own
                if isinstance(error, click.MissingParameter):
                    said = " ".join(said.split())
                streams.say(f"{error.ctx.command_path}: {said} (see --help)")
            else:
                streams.say(f"rocking: {error.format_message()}")
            sys.exit(2 if isinstance(error, click.UsageError) else error.exit_code)
        except RockingError as error:
            streams.say(f"rocking: {error}")
            sys.exit(error.exit_code)
        except (KeyboardInterrupt, click.Abort):
            streams.say("rocking: interrupted")
            sys.exit(130)
        except MemoryError:
            streams.say(
                "rocking: out of memory; a smaller --chunk or fewer --workers need less"
            )
            sys.exit(1)
        except (
            OSError
        ) as error:  # a name that the file system refuses, a disk that fails
            streams.say(
                "rocking:"
                f" {f'{error.filename}: ' if error.filename else ''}"
                f"{error.strerror or error}"
            )
            sys.exit(2 if error.errno == errno.ENAMETOOLONG else 1)
