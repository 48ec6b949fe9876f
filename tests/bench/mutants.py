"""Do the tests notice when dynamics/ is wrong? `python tests/bench/mutants.py [--count N] [--seed S] [PATH...]`, or `make mutants`.

Flips signs, comparisons and constants one at a time in a copy of the package, runs the tests of the dynamics against it until the
first fails, and prints the changes that none of them noticed. Some of those change nothing that can be seen (a bound that only
spares work, a tolerance that another one covers); each of the others is a test that is missing. Minutes to hours: 200 mutants
take about an hour on two cores. Exit code 0: it is a report.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOM = ROOT / "rocking_cli" / "dynamics"
TESTS = ["tests/dynamics", "tests/responses/test_history.py", "tests/spectra/test_closed_form.py", "tests/spectra/test_boundaries.py"]
SECONDS = 900  # a mutant that takes longer goes round in circles, which a person would notice
OPERATORS = {
    ast.Lt: (ast.GtE, ast.LtE),
    ast.LtE: (ast.Gt, ast.Lt),
    ast.Gt: (ast.LtE, ast.GtE),
    ast.GtE: (ast.Lt, ast.Gt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div,),
    ast.Div: (ast.Mult,),
    ast.BitAnd: (ast.BitOr,),
    ast.BitOr: (ast.BitAnd,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
}
Change = tuple[Path, int, int]  # file, place and alternative


@dataclass(frozen=True)
class Place:
    """A node of a tree by its parent (operators are one object each, wherever they stand), and the statement that holds it."""

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
    """The nodes that compute, in a fixed order: no docstrings, annotations, decorators or sentences of errors."""
    for field, value in ast.iter_fields(parent):
        if field in ("annotation", "returns", "decorator_list", "bases") or isinstance(parent, ast.Raise | ast.JoinedStr):
            continue
        for index, node in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(node, ast.AST):
                holder = node if isinstance(node, ast.stmt) else statement
                if holder is not None and not isinstance(node, ast.stmt):
                    yield Place(holder, parent, field, index)
                yield from places(node, holder)


def alternatives(node: ast.AST) -> list[ast.AST]:
    """What may stand in the place of a node: another operator, the other sign, another number; none for most nodes."""
    if type(node) in OPERATORS:
        return [other() for other in OPERATORS[type(node)]]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Invert | ast.Not):
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
        for number, place in enumerate(places(ast.parse(path.read_text(encoding="utf-8"))))
        for alternative in range(len(alternatives(place.node)))
    ]


def changed(change: Change) -> tuple[str, str]:
    """The text of the file with the change, and what was changed: line, before, after."""
    path, number, alternative = change
    tree = ast.parse(path.read_text(encoding="utf-8"))
    place = next(p for i, p in enumerate(places(tree)) if i == number)
    before = ast.unparse(place.statement).splitlines()
    place.put(alternatives(place.node)[alternative])
    after = ast.unparse(ast.fix_missing_locations(place.statement)).splitlines()
    lines = [(x.strip(), y.strip()) for x, y in zip(before, after, strict=True) if x != y]
    told = "  ->  ".join(" ".join(side) for side in zip(*lines, strict=True))
    return ast.unparse(tree), f"{path.relative_to(ROOT)}:{place.statement.lineno}: {told}"


def passes(path: Path, text: str) -> bool:
    """Whether the tests pass with this text in the place of a file: those of its module first, since they notice soonest."""
    mirror = ROOT / "tests" / path.relative_to(ROOT / "rocking_cli").with_name(f"test_{path.name}")
    first = [str(mirror.relative_to(ROOT))] if mirror.exists() else []
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(ROOT / "rocking_cli", Path(folder) / "rocking_cli", ignore=shutil.ignore_patterns("__pycache__"))
        (Path(folder) / path.relative_to(ROOT)).write_text(text, encoding="utf-8")
        call = [sys.executable, "-P", "-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", *first, *TESTS]
        environment = {**os.environ, "PYTHONPATH": folder}
        try:
            done = subprocess.run(call, cwd=ROOT, env=environment, capture_output=True, timeout=SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return False
    return done.returncode == 0


def survives(change: Change) -> str | None:
    """What was changed, if no test fails with it."""
    text, told = changed(change)
    return told if passes(change[0], text) else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("paths", nargs="*", type=Path)
    options = parser.parse_args()
    given = [p.resolve() for p in options.paths or [ROOM]]
    paths = sorted(path for p in given for path in (p.rglob("*.py") if p.is_dir() else [p]))
    if not passes(paths[0], paths[0].read_text(encoding="utf-8")):
        sys.exit("the tests fail without any change")
    every = changes(paths)
    sample = random.Random(options.seed).sample(every, min(options.count, len(every)))
    survivors = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for number, told in enumerate(pool.map(survives, sample), start=1):
            survivors += told is not None
            if told is not None:
                print(told, flush=True)
            print(f"{number} of {len(sample)} run, {survivors} survived", file=sys.stderr, flush=True)
    print(f"{len(sample)} of {len(every)} possible mutants: {len(sample) - survivors} killed, {survivors} survived")


if __name__ == "__main__":
    main()
