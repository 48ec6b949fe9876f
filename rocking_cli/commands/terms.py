"""Translation of the library's terms to the options of a command: `a_g` becomes --a-g."""

from __future__ import annotations

import re

import click

from ..errors import did_you_mean

MEANT = {"--pga": "--a-g", "--amplitude": "--a-g", "--frequency": "--f-g", "--period": "--T-g", "--record": "--motion"}


def in_options(text: str, command: click.Command) -> str:
    """A sentence of the library in which the command's options replace arguments in backticks; other words in backticks stay."""
    options: dict[str, str] = {}
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            long = parameter.opts[-1]
            options |= {str(parameter.name): long, long.lstrip("-").replace("-", "_"): long}
    return re.sub(r"`(\w+)`", lambda found: options.get(found[1], found[0]), text)


def no_such_option(error: click.NoSuchOption, arguments: list[str]) -> str:
    """The sentence for an unknown option, with the long option that is probably meant."""
    name = error.option_name
    if not name.startswith("--"):  # of -pulse click sees -p
        name = next((a.partition("=")[0] for a in arguments if a.startswith(name) and not a.startswith("--")), name)
    long = [o for p in error.ctx.command.params for o in p.opts if o.startswith("--")] if error.ctx is not None else []
    return f"No such option {name}{did_you_mean('--' + name.lstrip('-'), [*long, '--help'], MEANT)}"
