"""Write the documentation site: the public names of the package from their docstrings,
and every page of `rocking help` as it stands. Nothing is written for the site alone.

Usage: python .ci/site.py FOLDER
"""

import sys
import warnings
from pathlib import Path
from types import ModuleType

import click
import pdoc.doc
import pdoc.render

import rocking_cli
from rocking_cli.commands import COMMANDS, cli
from rocking_cli.commands.help import TOPICS, page


def help_of(name: str) -> str:
    """Return what `rocking help NAME` prints."""
    group = click.Context(cli, info_name="rocking")
    command = cli.get_command(group, name)
    if command is None:
        return page(name)
    context = click.Context(command, parent=group, info_name=name)
    return f"{command.get_help(context)}\n\n{page(name)}"


def public_module() -> ModuleType:
    """Return a module that holds every public name: the package imports them late."""
    module = ModuleType("rocking")
    names = [name for name in dir(rocking_cli) if not name.startswith("_")]
    vars(module).update({name: getattr(rocking_cli, name) for name in names})
    module.__doc__, vars(module)["__all__"] = rocking_cli.__doc__, names
    return module


def page_module(name: str) -> ModuleType:
    """Return a module whose docstring is a page of help, as preformatted text."""
    module = ModuleType(f"help_{name}")
    summary = (COMMANDS | TOPICS)[name]
    module.__doc__ = f"{summary}\n\n```text\n{help_of(name).rstrip()}\n```\n"
    return module


def main(folder: Path) -> None:
    """Write a file of HTML for the package and for each page, and an index."""
    modules = [public_module(), *map(page_module, (*TOPICS, *COMMANDS))]
    documented = {one.__name__: pdoc.doc.Module(one) for one in modules}
    pdoc.render.configure(
        docformat="numpy",
        footer_text=f"rocking {rocking_cli.__version__}",
        show_source=False,
    )
    # an annotation may name Document without importing it
    warnings.filterwarnings("ignore", message="Error parsing type annotation")
    folder.mkdir(parents=True, exist_ok=True)
    for name, module in documented.items():
        html = pdoc.render.html_module(module, documented)
        (folder / f"{name}.html").write_text(html, encoding="utf-8")
    index = pdoc.render.html_index(documented)
    (folder / "index.html").write_text(index, encoding="utf-8")
    search = pdoc.render.search_index(documented)
    (folder / "search.js").write_text(search, encoding="utf-8")
    print(f"{folder}: {len(documented)} pages")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
