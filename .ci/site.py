"""Write the documentation site: the README as its first page, the public names of the
package from their docstrings, every page of `rocking help` as it stands, five tutorials
of the examples that these docstrings hold, and a gallery of the figures that the help
pages draw. Nothing is written for the site alone; the tests run what it shows.

Usage: python .ci/site.py FOLDER
"""

import inspect
import re
import shutil
import sys
import tempfile
import textwrap
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import click

import rocking_cli
from rocking_cli.commands import COMMANDS, cli
from rocking_cli.commands.help import TOPICS, page

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
from support.shown_commands import README, in_folder, shell  # noqa: E402

PUBLIC = [name for name in dir(rocking_cli) if not name.startswith("_")]
PAGES = TOPICS | COMMANDS  # with their summaries
# commands whose functions make a tutorial, in the order of reading
TUTORIALS = ("params", "check", "response", "spectrum", "fragility")
ROW = r"^  rocking {}(?= ) *(.*(?:\n {{20}}.*)*)"  # of a command in help python
STYLE = """<style>
img { max-width: 100% }
@page { size: A4; margin: 15mm }
@media print {
  nav { display: none }
  pre { white-space: pre-wrap !important }
  h2, .pdoc-code { break-after: avoid }
}
</style>"""
FIGURE = re.compile(r"-o (\S+\.(?:png|svg))$")


def help_of(name: str) -> str:
    """Return what `rocking help NAME` prints."""
    group = click.Context(cli, info_name="rocking")
    command = cli.get_command(group, name)
    if command is None:
        return page(name)
    context = click.Context(command, parent=group, info_name=name)
    return f"{command.get_help(context)}\n\n{page(name)}"


def module_of(name: str, text: str) -> ModuleType:
    """Return a module without names, whose docstring is a page in Markdown."""
    module = ModuleType(name)
    module.__doc__ = text
    return module


def public_module() -> ModuleType:
    """Return a module that holds every public name: the package imports them late."""
    module = module_of("rocking", rocking_cli.__doc__ or "")
    vars(module).update({name: getattr(rocking_cli, name) for name in PUBLIC})
    vars(module)["__all__"] = PUBLIC
    return module


def help_page(name: str) -> str:
    """Return a page of help, as preformatted text."""
    return f"{PAGES[name]}\n\n```text\n{help_of(name).rstrip()}\n```\n"


def tutorial(name: str) -> str:
    """Return the examples of the functions that `rocking help python` lists for a
    command.
    """
    row = re.search(ROW.format(name), page("python"), re.MULTILINE)
    assert row is not None
    text = f"{PAGES[name]}\n\n"
    for function in dict.fromkeys(re.findall(r"\w+", row[1])):
        doc = inspect.getdoc(getattr(rocking_cli, function, None)) or ""
        told, _, example = doc.partition("\nExamples\n--------\n")
        if function in PUBLIC and example:
            used = sorted(set(PUBLIC) & set(re.findall(r"\w+(?=\()", example)))
            imported = f">>> from rocking import {', '.join(used)}"
            summary = " ".join(told.partition("\n\n")[0].split())
            text += f"## {function}\n\n{summary}\n\n"
            text += f"```python\n{imported}\n{example.rstrip()}\n```\n\n"
    return text


def figures() -> Iterator[tuple[str, list[str], str]]:
    """Yield (page of help, commands, the file that the last one draws)."""
    for name in PAGES:
        command = cli.get_command(click.Context(cli), name)
        shown = [(command.epilog or "").removeprefix("Example: ")] if command else []
        shown += re.findall(r"^    (rocking .*)$", page(name), re.MULTILINE)
        for i, line in enumerate(shown):
            if drawn := FIGURE.search(line):
                needed = [line]
                for before in reversed(shown[:i]):  # those whose files it reads
                    made = re.search(r"(?:> |-o )(\S+)$", before)
                    if made and any(made[1] in later.split() for later in needed):
                        needed.insert(0, before)
                yield name, needed, drawn[1]


def folded(line: str) -> str:
    """Return a command in lines of up to 72 columns."""
    parts = textwrap.wrap(line, 66, break_long_words=False, break_on_hyphens=False)
    return " \\\n    ".join(parts)


def gallery(folder: Path) -> str:
    """Return a page of the figures that pages of help draw, each below its commands,
    after it has drawn them into a folder.
    """
    text = "Figures of the help pages, each below the commands that draw it.\n\n"
    for name, commands, drawn in figures():
        with tempfile.TemporaryDirectory() as made:
            for line in commands:
                shell(in_folder(Path(made)), line, Path(made))
            shutil.copy(Path(made) / drawn, folder / f"{name}_{drawn}")
        shown = "\n".join(map(folded, commands))
        text += f"## {Path(drawn).stem}\n\n```sh\n{shown}\n```\n\n"
        text += (
            f"![{drawn}]({name}_{drawn})\n\nSee [help {name}](help_{name}.html).\n\n"
        )
    return text


def first_page(pages: dict[str, str]) -> str:
    """Return the README, with links to the pages; pages: their summaries by name."""
    title, rest = README.read_text(encoding="utf-8").split("\n", 1)
    links = {name: f"[{name}]({name}.html)" for name in pages}
    first = [link for name, link in links.items() if not name.startswith("help_")]
    listed = "\n".join(f"- {links[name]}: {told}" for name, told in pages.items())
    return f"{title}\n\n{' · '.join(first)}\n{rest}\n## All pages\n\n{listed}\n"


def main(folder: Path) -> None:
    """Write a file of HTML for the package and for each page, and an index."""
    import pdoc.doc
    import pdoc.render

    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        **{f"tutorial_{name}": tutorial(name) for name in TUTORIALS},
        "gallery": gallery(folder),
        **{f"help_{name}": help_page(name) for name in PAGES},
    }
    told = {name: text.partition("\n")[0] for name, text in texts.items()}
    told = {"rocking": "The Python functions and classes.", **told}
    modules = [
        module_of("index", first_page(told)),
        public_module(),
        *(module_of(name, text) for name, text in texts.items()),
    ]
    documented = {one.__name__: pdoc.doc.Module(one) for one in modules}
    pdoc.render.configure(
        docformat="numpy",
        footer_text=f"rocking {rocking_cli.__version__}",
        show_source=False,
    )
    # an annotation may name Document without importing it
    warnings.filterwarnings("ignore", message="Error parsing type annotation")
    for name, module in documented.items():
        html = pdoc.render.html_module(module, documented)
        html = html.replace("</head>", f"{STYLE}</head>")
        (folder / f"{name}.html").write_text(html, encoding="utf-8")
    search = pdoc.render.search_index(documented)
    (folder / "search.js").write_text(search, encoding="utf-8")
    print(f"{folder}: {len(documented)} pages")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
