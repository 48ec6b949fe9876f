"""Do the tests notice when dynamics/ is wrong? `python tests/bench/mutants.py [--count N] [--seed S] [--tests TEST]... [PATH...]`, or
`make mutants`; with paths, other files of the package too.

Flips signs, comparisons and constants one at a time in a copy of the package, runs those tests that call the changed function, the
quick ones first, until one fails, and prints the changes that none of them noticed. Some of those change nothing that can be seen (a
bound that only spares work, a tolerance that another one covers); each of the others is a test that is missing. Which test calls what
is found first, by one run of all. Exit code 0: it is a report.
"""

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROOM = ROOT / "rocking_cli"
TESTS = ["tests/dynamics", "tests/responses/test_history.py", "tests/envelopes/test_closed_form.py", "tests/envelopes/test_boundaries.py"]
SLOWER = 6.0  # times what its tests take, and a minute: a mutant that takes longer goes round in circles, which a person would notice
CALLS = "CALLS"  # the variable that names the file of which test calls what
OPPOSITES = (  # not < for <=: of floats that differ in nothing but a tie
    (ast.Lt, ast.GtE), (ast.LtE, ast.Gt), (ast.Eq, ast.NotEq), (ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.BitAnd, ast.BitOr),
    (ast.And, ast.Or),
)  # fmt: skip
OPERATORS = {one: other for pair in OPPOSITES for one, other in (pair, pair[::-1])}
Change = tuple[Path, int, int]  # file, place and alternative


@dataclass(frozen=True)
class Place:
    """A node of a tree by its parent (operators are one object each, wherever they stand), with the statement and the function that
    hold it."""

    function: str
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


def places(parent: ast.AST, statement: ast.stmt | None = None, scope: tuple[str, ...] = (), inside: bool = False) -> Iterator[Place]:
    """The nodes that compute, in a fixed order: no docstrings, annotations, decorators or sentences of errors."""
    if isinstance(parent, ast.FunctionDef | ast.ClassDef) and not inside:
        scope, inside = (*scope, parent.name), isinstance(parent, ast.FunctionDef)
    for field, value in ast.iter_fields(parent):
        if field in ("annotation", "returns", "decorator_list", "bases") or isinstance(parent, ast.Raise | ast.JoinedStr):
            continue
        for index, node in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(node, ast.AST):
                holder = node if isinstance(node, ast.stmt) else statement
                if holder is not None and not isinstance(node, ast.stmt):
                    yield Place(".".join(scope) if inside else "", holder, parent, field, index)
                yield from places(node, holder, scope, inside)


def alternatives(node: ast.AST) -> list[ast.AST]:
    """What may stand in the place of a node: another operator, the other sign, another number; none for most nodes."""
    if type(node) in OPERATORS:
        return [OPERATORS[type(node)]()]
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


def changed(change: Change) -> tuple[str, str, str]:
    """The text of the file with the change, the function it is in, and what was changed: line, before, after."""
    path, number, alternative = change
    tree = ast.parse(path.read_text(encoding="utf-8"))
    place = next(p for i, p in enumerate(places(tree)) if i == number)
    before = ast.unparse(place.statement).splitlines()
    place.put(alternatives(place.node)[alternative])
    after = ast.unparse(ast.fix_missing_locations(place.statement)).splitlines()
    lines = [(x.strip(), y.strip()) for x, y in zip(before, after, strict=True) if x != y]
    told = "  ->  ".join(" ".join(side) for side in zip(*lines, strict=True))
    return ast.unparse(tree), place.function, f"{path.relative_to(ROOT)}:{place.statement.lineno}: {told}"


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """This file is the plugin, too, that writes down which functions a test calls, and how long it takes."""
    seen: set[tuple[str, str]] = set()

    def called(frame: FrameType, event: str, _: object) -> None:
        _, within, path = frame.f_code.co_filename.partition("/rocking_cli/")
        if within and event == "call":
            seen.add((path, frame.f_code.co_qualname.partition(".<locals>")[0]))

    begun = time.perf_counter()
    sys.setprofile(called)
    yield
    sys.setprofile(None)
    with open(os.environ[CALLS], "a", encoding="utf-8") as file:
        file.write(json.dumps([time.perf_counter() - begun, item.nodeid, sorted(seen)]) + "\n")


@dataclass
class Suite:
    """The tests of the dynamics, the quick ones first, by the function that they call, and by its file."""

    tests: dict[tuple[str, str], list[tuple[float, str]]]

    @classmethod
    def watched(cls, which: list[str]) -> "Suite":
        with tempfile.TemporaryDirectory() as folder:
            calls = Path(folder) / "calls"
            environment = {**os.environ, CALLS: str(calls), "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests")))}
            call = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", "-p", "bench.mutants", *which]
            if subprocess.run(call, cwd=ROOT, env=environment, check=False).returncode:
                sys.exit("the tests fail without any change")
            rows = sorted(json.loads(line) for line in calls.read_text(encoding="utf-8").splitlines())
        tests: dict[tuple[str, str], list[tuple[float, str]]] = defaultdict(list)
        for seconds, name, seen in rows:
            for path, function in [*seen, *{(path, "") for path, _ in seen}]:
                tests[path, function].append((seconds, name))
        return cls(tests)

    def passes(self, path: Path, function: str, text: str) -> bool:
        """Whether the tests that call a function pass with this text in the place of its file."""
        wanted = self.tests.get((path.relative_to(ROOM).as_posix(), function), [])
        if not wanted:
            return True
        most = 60.0 + SLOWER * sum(seconds for seconds, _ in wanted)
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(ROOT / "rocking_cli", Path(folder) / "rocking_cli", ignore=shutil.ignore_patterns("__pycache__"))
            (Path(folder) / path.relative_to(ROOT)).write_text(text, encoding="utf-8")
            options = ["-x", "-q", "-n", "0", "--tb=no", "-p", "no:cacheprovider"]
            call = [sys.executable, "-P", "-m", "pytest", *options, *(name for _, name in wanted)]
            environment = {**os.environ, "PYTHONPATH": folder}
            try:
                done = subprocess.run(call, cwd=ROOT, env=environment, capture_output=True, timeout=most, check=False)
            except subprocess.TimeoutExpired:
                return False
        return done.returncode == 0

    def lets_through(self, change: Change) -> str | None:
        """What was changed, if no test fails with it."""
        text, function, told = changed(change)
        return told if self.passes(change[0], function, text) else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tests", action="append", help="of these tests alone")
    parser.add_argument("paths", nargs="*", type=Path)
    options = parser.parse_args()
    given = [p.resolve() for p in options.paths or [ROOM / "dynamics"]]
    paths = sorted(path for p in given for path in (p.rglob("*.py") if p.is_dir() else [p]))
    every = changes(paths)
    sample = random.Random(options.seed).sample(every, min(options.count, len(every)))
    suite, survivors = Suite.watched(options.tests or TESTS), 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for number, done in enumerate(as_completed([pool.submit(suite.lets_through, change) for change in sample]), start=1):
            told = done.result()
            survivors += told is not None
            if told is not None:
                print(told, flush=True)
            print(f"{number} of {len(sample)} run, {survivors} survived", file=sys.stderr, flush=True)
    print(f"{len(sample)} of {len(every)} possible mutants: {len(sample) - survivors} killed, {survivors} survived")


if __name__ == "__main__":
    main()
