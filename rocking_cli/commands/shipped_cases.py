"""The shipped cases: inputs, commands, and what others say must come out.

Each case runs its command in a process of its own on the texts of `cases.yaml`, as
a user would, and compares the numbers that it prints.
"""

import hashlib
import json
import os
import platform
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import date
from html import escape
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from .. import __version__
from ..processes import available_cpus

_PACKAGES = ("numpy", "scipy", "click", "pyyaml", "h5py")
_ROOT = Path(__file__).resolve().parents[1]  # of the package


class Number(NamedTuple):
    """A number that a command prints, and what it must be."""

    key: str  # its column
    expected: float  # its value by the source
    within: float  # largest difference
    row: int = 0  # index of its row
    times: float = 1.0  # factor of the printed number, to the unit of `expected`


@dataclass(frozen=True)
class Case:
    """A command on given inputs, and the numbers that must come out."""

    name: str
    source: str  # who says so
    equation: str  # what is computed
    command: str  # arguments of `rocking`
    files: dict[str, str]  # texts of the inputs by name
    numbers: tuple[Number, ...]  # none if only the exit code counts
    code: int = 0  # its exit code

    def run(self, folder: Path) -> Iterator["Comparison"]:
        """Write the inputs to a folder, run the command there, and yield how each
        number compares; if the command fails, how its exit code does.
        """
        folder.mkdir(parents=True)
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        arguments = shlex.split(self.command) + ["--json"] * bool(self.numbers)
        line = f"rocking {shlex.join(arguments)}\n"
        (folder / "command.txt").write_text(line, encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-m", "rocking_cli", *arguments, "--quiet"],
            cwd=folder,
            capture_output=True,
            encoding="utf-8",
            check=False,
            env=os.environ | {"PYTHONPATH": str(_ROOT.parent)},
        )
        if done.returncode != self.code or not self.numbers:
            yield Comparison(self, "exit code", float(self.code), 0.0, done.returncode)
            return
        rows = [json.loads(text) for text in done.stdout.splitlines()]
        for one in self.numbers:
            row: dict[str, Any] = rows[one.row] if one.row < len(rows) else {}
            found = row.get(one.key)
            computed = None if found is None else one.times * float(found)
            yield Comparison(self, one.key, one.expected, one.within, computed)


class Comparison(NamedTuple):
    """A number of a case as it came out."""

    case: Case
    key: str
    expected: float  # by the source
    within: float  # largest difference that the source is good for
    computed: float | None  # None if the command printed no such number

    @property
    def passed(self) -> bool:
        """True if the number is as near to the source as it must be."""
        return (
            self.computed is not None
            and abs(self.computed - self.expected) <= self.within
        )

    def row(self) -> dict[str, Any]:
        """Return the columns of `rocking verify`."""
        case = self.case
        return {
            "case": case.name,
            "key": self.key,
            "expected": self.expected,
            "within": self.within,
            "computed": self.computed,
            "passed": "yes" if self.passed else "NO",
            "equation": case.equation,
            "source": case.source,
            "command": f"rocking {case.command}",
        }


def shipped_cases() -> list[Case]:
    """Return the cases that the package ships."""
    import yaml

    text = Path(__file__).with_name("cases.yaml").read_text(encoding="utf-8")
    return [
        Case(
            one["name"],
            one["source"],
            one["equation"],
            one["command"],
            one["files"],
            tuple(Number(**number) for number in one["values"]),
            one["exit"],
        )
        for one in yaml.safe_load(text)
    ]


def compared(cases: Sequence[Case], folder: Path) -> Iterator[Comparison]:
    """Run cases, each in a folder of its own inside `folder`, and yield how their
    numbers compare, in the order of the cases.
    """

    def of(numbered: tuple[int, Case]) -> list[Comparison]:
        number, case = numbered
        words = re.sub(r"[^a-z0-9]+", "-", case.name.lower()).strip("-")
        return list(case.run(folder / f"{number:02}-{words}"))

    with ThreadPoolExecutor(available_cpus()) as run:
        for found in run.map(of, enumerate(cases, 1)):
            yield from found


def installation() -> dict[str, str]:
    """Return what is verified, and where: version, digest of the installed files,
    Python, platform, packages, date.
    """
    digest = hashlib.sha256()
    for path in sorted(_ROOT.rglob("*")):
        if path.is_file() and path.suffix != ".pyc":
            digest.update(path.relative_to(_ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    return {
        "program": f"rocking {__version__}",
        "SHA-256 of the installed files": digest.hexdigest(),
        "Python": platform.python_version(),
        "platform": platform.platform(),
        "packages": ", ".join(f"{name} {version(name)}" for name in _PACKAGES),
        "date": date.today().isoformat(),
    }


# columns of a page whose texts may be those of several rows
_TEXTS = ("case", "equation", "source", "command", "requirement", "module")
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Verification of rocking</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
@page {{ size: A4 landscape; margin: 15mm }}
body {{ font: 11px/1.4 sans-serif; margin: 2em auto; max-width: 100em; padding: 0 1em }}
table {{ border-collapse: collapse; width: 100%; margin: 1em 0 }}
td, th {{ text-align: left; vertical-align: top; padding: .25em .6em;
  border-bottom: 1px solid #ccc }}
span {{ white-space: nowrap }}
.about td, .wide td:nth-child(9) {{ overflow-wrap: anywhere; min-width: 13em }}
.no {{ background: #fbb }}
.wide {{ overflow-x: auto }}
tr {{ break-inside: avoid }}
h2 {{ break-before: page }}
.sign {{ margin-top: 4em; border-top: 1px solid; width: 20em; padding-top: .3em }}
</style></head><body>
<h1>Verification of rocking</h1>
<p>{verdict}</p>
<table class="about">{about}</table>
<p>The program answers for rigid bodies, and mechanisms of them, that rock on a rigid
base in one plane. Each row below names the equation that is computed and the command
that computes it again, in the folder of its case. The help page `defects` lists what
was wrong in earlier versions.</p>
<div class="wide">{rows}</div>
<h2>Requirements</h2>
<p>Each requirement is held by a module, a test of the source and a case above.</p>
<div class="wide">{requirements}</div>
<p class="sign">date, signature</p>
</body></html>
"""


def page(
    found: Sequence[Comparison],
    about: dict[str, str],
    requirements: Sequence[dict[str, str]],
) -> str:
    """Return the page of a verification in HTML."""
    head = "".join(
        f"<tr><th>{escape(key)}</th><td>{escape(text)}</td></tr>"
        for key, text in about.items()
    )
    return _PAGE.format(
        verdict=escape(tally_of(found)),
        about=head,
        rows=_table([one.row() for one in found]),
        requirements=_table(requirements),
    )


def _table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows as a table in HTML; one that is not passed is marked. Of a case, or a
    requirement, a text that is the same in all its rows stands once.
    """
    columns = [*next(iter(rows), {})]
    heads = "".join(f"<th>{escape(key)}</th>" for key in columns)
    lines = [f"<thead><tr>{heads}</tr></thead>"]
    for _, together in groupby(rows, lambda row: row[columns[0]]):
        of_one = [*together]
        same = {key for key in _TEXTS if len({row.get(key) for row in of_one}) == 1}
        for i, row in enumerate(of_one):
            mark = ' class="no"' if row.get("passed") == "NO" else ""
            cells = [
                f'<td rowspan="{len(of_one) if key in same else 1}">{_shown(x)}</td>'
                for key, x in row.items()
                if i == 0 or key not in same
            ]
            lines.append(f"<tr{mark}>{''.join(cells)}</tr>")
    return "\n".join(["<table>", *lines, "</table>"])


def _shown(x: Any) -> str:
    """Return a value in HTML: a line breaks in a path, in no number and no option."""
    if isinstance(x, float | int):
        return f"<span>{x:.12g}</span>"
    text = escape(str(x or ""))
    if ".py" in text:
        return re.sub(r"([/_:])(?=\w)", r"\1<wbr>", text)
    return re.sub(r"(?<!\S)(--?\w\S*)", r"<span>\1</span>", text)


def tally_of(found: Sequence[Comparison]) -> str:
    """Return how many numbers are as the sources say."""
    wrong = [one for one in found if not one.passed]
    cases = len({one.case.name for one in found})
    text = f"{len(found) - len(wrong)} of {len(found)} numbers of {cases} cases are as"
    text += " the sources say"
    names = dict.fromkeys(one.case.name for one in wrong)
    return text + (f"; not so: {', '.join(names)}" if names else "")
