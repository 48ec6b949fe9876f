"""Do the tests notice when a room is wrong?

`make mutants ROOM=dynamics`, or `python tests/bench/mutants.py dynamics [--count N]
[--seed S]`; files of the package may stand in place of the room.

Flips signs, comparisons and constants one at a time in a copy of the package, and runs
the tests that run the changed line, the fastest first, until one fails. A first run of
the whole suite finds which tests run which line; it is kept until a file changes.
Prints the changes that no test noticed, with file and line, and the seconds. Some of
those change nothing that can be seen (a bound that only spares work, a tolerance that
another one covers); each of the others is a test that is missing. The same seed draws
the same mutants as long as the files are the same. Exit code 0: it is a report.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "rocking_cli"
FOUND = ROOT / "out" / "mutants"  # what the first run finds
COUNT = {"dynamics": 200, "envelopes": 200, "responses": 200, "spectra": 200}
# s: a mutant that takes longer goes round in circles, which a person would notice
LONGEST = 600.0
OPPOSITES = (  # not < for <=: of floats that differ in nothing but a tie
    (ast.Lt, ast.GtE),
    (ast.LtE, ast.Gt),
    (ast.Eq, ast.NotEq),
    (ast.Add, ast.Sub),
    (ast.Mult, ast.Div),
    (ast.BitAnd, ast.BitOr),
    (ast.And, ast.Or),
)
OPERATORS = {one: other for pair in OPPOSITES for one, other in (pair, pair[::-1])}
Change = tuple[Path, int, int]  # file, place and alternative


@dataclass(frozen=True)
class Place:
    """A node of a tree by its parent (operators are one object each, wherever they
    stand), with the statement that holds it.
    """

    statement: ast.stmt
    parent: ast.AST
    field: str
    index: int | None

    @property
    def node(self) -> ast.AST:
        value = getattr(self.parent, self.field)
        return value if self.index is None else value[self.index]

    def put(self, node: ast.AST) -> None:
        if self.index is None:
            setattr(self.parent, self.field, node)
        else:
            getattr(self.parent, self.field)[self.index] = node


def places(parent: ast.AST, statement: ast.stmt | None = None) -> Iterator[Place]:
    """The nodes that compute, in a fixed order: no docstrings, annotations, decorators
    or sentences of errors.
    """
    for field, value in ast.iter_fields(parent):
        if field in ("annotation", "returns", "decorator_list", "bases") or isinstance(
            parent, ast.Raise | ast.JoinedStr
        ):
            continue
        for index, node in (
            enumerate(value) if isinstance(value, list) else [(None, value)]
        ):
            if isinstance(node, ast.AST):
                holder = node if isinstance(node, ast.stmt) else statement
                if holder is not None and not isinstance(node, ast.stmt):
                    yield Place(holder, parent, field, index)
                yield from places(node, holder)


def alternatives(node: ast.AST) -> list[ast.AST]:
    """What may stand in the place of a node: another operator, the other sign, another
    number; none for most nodes.
    """
    if type(node) in OPERATORS:
        return [OPERATORS[type(node)]()]
    if isinstance(node, ast.UnaryOp) and isinstance(
        node.op, ast.USub | ast.Invert | ast.Not
    ):
        return [node.operand]
    if isinstance(node, ast.Constant) and isinstance(node.value, bool):
        return [ast.Constant(not node.value)]
    if isinstance(node, ast.Constant) and isinstance(node.value, int):
        return [ast.Constant(node.value + 1)]
    if isinstance(node, ast.Constant) and isinstance(node.value, float):
        return [ast.Constant(node.value * (1.1 if node.value > 1e-6 else 1e3) or 0.1)]
    return []


def changes(paths: list[Path]) -> list[Change]:
    """Every change that can be made to these files."""
    return [
        (path, number, alternative)
        for path in paths
        for number, place in enumerate(
            places(ast.parse(path.read_text(encoding="utf-8")))
        )
        for alternative in range(len(alternatives(place.node)))
    ]


def lines_of(change: Change) -> range:
    """The lines of the statement that a change is in."""
    path, number, _ = change
    tree = ast.parse(path.read_text(encoding="utf-8"))
    one = next(p for i, p in enumerate(places(tree)) if i == number).statement
    body = getattr(one, "body", None)
    last = body[0].lineno - 1 if body else one.end_lineno or one.lineno
    return range(one.lineno, max(last, one.lineno) + 1)


def changed(change: Change) -> tuple[str, str]:
    """The text of the file with the change, and what was changed:
    line, before, after.
    """
    path, number, alternative = change
    tree = ast.parse(path.read_text(encoding="utf-8"))
    place = next(p for i, p in enumerate(places(tree)) if i == number)
    before = ast.unparse(place.statement).splitlines()
    place.put(alternatives(place.node)[alternative])
    after = ast.unparse(ast.fix_missing_locations(place.statement)).splitlines()
    lines = [
        (x.strip(), y.strip()) for x, y in zip(before, after, strict=True) if x != y
    ]
    report = "  ->  ".join(" ".join(side) for side in zip(*lines, strict=True))
    return (
        ast.unparse(tree),
        f"{path.relative_to(ROOT)}:{place.statement.lineno}: {report}",
    )


class Covering:
    """Which tests run which line, and how long each takes."""

    def __init__(self) -> None:
        data, times = FOUND / "coverage", FOUND / "times.xml"
        files = [*PACKAGE.rglob("*.py"), *(ROOT / "tests").rglob("*.py")]
        newest = max(path.stat().st_mtime for path in files)
        if not times.exists() or times.stat().st_mtime < newest:
            print(
                "a first run of all tests finds which line each runs", file=sys.stderr
            )
            FOUND.mkdir(parents=True, exist_ok=True)
            subprocess.run(
                [
                    *(sys.executable, "-m", "pytest", "-q", "-n", "2"),
                    *("--cov=rocking_cli", "--cov-context=test", "--cov-report="),
                    *("-o", "junit_family=legacy", f"--junitxml={times}"),
                ],
                cwd=ROOT,
                env={**os.environ, "COVERAGE_FILE": str(data)},
                stdout=subprocess.DEVNULL,
                check=False,
            )
        from coverage import CoverageData

        self.lines = CoverageData(str(data))
        self.lines.read()
        self.seconds = {
            f"{case.get('file')}::{case.get('name')}": float(case.get("time", 0.0))
            for case in ElementTree.parse(times).iter("testcase")
        }
        self._by_file: dict[Path, dict[int, list[str]]] = {}

    def of(self, path: Path, lines: range) -> list[str]:
        """The tests that run one of these lines of a file, the fastest first; those of
        its room if it runs when the package is imported.
        """
        if path not in self._by_file:
            self._by_file[path] = self.lines.contexts_by_lineno(str(path))
        every = {x for line in lines for x in self._by_file[path].get(line, ())}
        tests = {x.split("|")[0] for x in every if x}
        if not tests:
            own = ROOT / "tests" / path.parent.relative_to(PACKAGE)
            return [str(own.relative_to(ROOT))] if every and own.is_dir() else []
        return sorted(tests, key=lambda x: (self.seconds.get(x, 0.0), x))


def survives(change: Change, tests: list[str]) -> bool:
    """True if none of these tests fails with a change."""
    if not tests:
        return True
    text, _ = changed(change)
    with tempfile.TemporaryDirectory() as folder:
        copy, listed = Path(folder), Path(folder) / "tests.txt"
        left_out = shutil.ignore_patterns("__pycache__")
        shutil.copytree(PACKAGE, copy / "rocking_cli", ignore=left_out)
        (copy / change[0].relative_to(ROOT)).write_text(text, encoding="utf-8")
        (copy / "configs").symlink_to(ROOT / "configs")
        listed.write_text("\n".join(str(ROOT / test) for test in tests))
        # tests run here, so that what they start takes the changed package too
        call = [
            *(sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "--tb=no"),
            *("-p", "no:cacheprovider", "--rootdir", str(ROOT)),
            *("-c", str(ROOT / "pyproject.toml"), f"@{listed}"),
        ]
        try:
            done = subprocess.run(
                call,
                cwd=folder,
                env={**os.environ, "PYTHONPATH": folder},
                capture_output=True,
                timeout=LONGEST,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return False
    return done.returncode == 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, help="200 of a compute room, 40 of others")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("paths", nargs="*", default=["dynamics"], help="rooms or files")
    options = parser.parse_args()
    given = [p if p.exists() else PACKAGE / p for p in map(Path, options.paths)]
    paths = sorted(
        path
        for p in given
        for path in (p.resolve().rglob("*.py") if p.is_dir() else [p.resolve()])
    )
    every, covering = changes(paths), Covering()
    count = options.count or max(COUNT.get(p.name, 40) for p in given)
    sample = random.Random(options.seed).sample(every, min(count, len(every)))
    survivors, started = 0, time.monotonic()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        asked = {
            pool.submit(survives, change, covering.of(change[0], lines_of(change))): (
                change
            )
            for change in sample
        }
        for number, done in enumerate(as_completed(asked), start=1):
            if done.result():
                survivors += 1
                print(changed(asked[done])[1], flush=True)
            print(
                f"{number} of {len(sample)} run, {survivors} survived",
                file=sys.stderr,
                flush=True,
            )
    print(
        f"{' '.join(options.paths)}: {len(sample)} of {len(every)} possible mutants:"
        f" {len(sample) - survivors} killed, {survivors} survived,"
        f" {time.monotonic() - started:.0f} s"
    )


if __name__ == "__main__":
    main()
