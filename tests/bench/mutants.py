"""Do the tests notice when dynamics/ is wrong?

`python tests/bench/mutants.py [--count N] [--seed S] [--tests TEST]... [PATH...]`, or
`make mutants`; with paths, other files of the package too.

Flips signs, comparisons and constants one at a time in a copy of the package, runs the
tests of its room and then the others until one fails, and prints the changes that none
of them noticed. Some of those change nothing that can be seen (a bound that only spares
work, a tolerance that another one covers); each of the others is a test that is
missing. Exit code 0: it is a report.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOM = ROOT / "rocking_cli"
TESTS = [
    "tests/dynamics",
    "tests/responses/test_history.py",
    "tests/envelopes/test_closed_form.py",
    "tests/envelopes/test_boundaries.py",
]
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


def lets_through(change: Change, tests: list[str]) -> str | None:
    """What was changed, if no test fails with it; the tests of the file's own room come
    first.
    """
    text, report = changed(change)
    own = ROOT / "tests" / change[0].parent.relative_to(ROOM)
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(
            ROOM,
            Path(folder) / "rocking_cli",
            ignore=shutil.ignore_patterns("__pycache__"),
        )
        (Path(folder) / change[0].relative_to(ROOT)).write_text(text, encoding="utf-8")
        (Path(folder) / "configs").symlink_to(
            ROOT / "configs"
        )  # tests run here, so that what they start takes the changed package too
        call = [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "-n",
            "0",
            "--tb=no",
            "-p",
            "no:cacheprovider",
        ]
        call += ["--rootdir", str(ROOT), "-c", str(ROOT / "pyproject.toml")]
        call += [
            *([str(own)] if own.is_dir() else []),
            *(str(ROOT / test) for test in tests),
        ]
        environment = {**os.environ, "PYTHONPATH": folder}
        try:
            done = subprocess.run(
                call,
                cwd=folder,
                env=environment,
                capture_output=True,
                timeout=LONGEST,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
    return None if done.returncode else report


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tests", action="append", help="of these tests alone")
    parser.add_argument("paths", nargs="*", type=Path)
    options = parser.parse_args()
    given = [p.resolve() for p in options.paths or [ROOM / "dynamics"]]
    paths = sorted(
        path for p in given for path in (p.rglob("*.py") if p.is_dir() else [p])
    )
    every = changes(paths)
    sample = random.Random(options.seed).sample(every, min(options.count, len(every)))
    survivors, tests = 0, options.tests or TESTS
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for number, done in enumerate(
            as_completed(
                [pool.submit(lets_through, change, tests) for change in sample]
            ),
            start=1,
        ):
            report = done.result()
            survivors += report is not None
            if report is not None:
                print(report, flush=True)
            print(
                f"{number} of {len(sample)} run, {survivors} survived",
                file=sys.stderr,
                flush=True,
            )
    print(
        f"{len(sample)} of {len(every)} possible mutants: {len(sample) - survivors}"
        f" killed, {survivors} survived"
    )


if __name__ == "__main__":
    main()
