"""Files of the rooms that compute import each other in one direction only, and no room
imports from one below it.
"""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import rocking_cli

PACKAGE = Path(rocking_cli.__file__).parent
FIRST = ("documents", "structures", "motions")
ROOMS = ("dynamics", "envelopes", "responses", "spectra", "fragility", "reports")


@cache
def imports_of(file: Path) -> set[tuple[str, ...]]:
    """Modules and names that a file takes, also inside functions, but for annotations
    alone not.
    """
    package = file.relative_to(PACKAGE).parts[:-1]
    return set(imported(ast.parse(file.read_text("utf-8")), package))


def imported(tree: ast.AST, package: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """The same of a statement."""
    if isinstance(tree, ast.If) and ast.unparse(tree.test) == "TYPE_CHECKING":
        return
    if isinstance(tree, ast.ImportFrom) and tree.level:
        base = package[: len(package) - tree.level + 1]
        base += tuple((tree.module or "").split(".")) if tree.module else ()
        yield base
        yield from ((*base, name.name) for name in tree.names)
    for child in ast.iter_child_nodes(tree):
        if not isinstance(child, ast.expr):
            yield from imported(child, package)


def test_no_file_imports_itself_by_way_of_others():
    files = {
        file.relative_to(PACKAGE).with_suffix("").parts: file
        for room in ROOMS
        for file in (PACKAGE / room).rglob("*.py")
    }
    takes = {name: imports_of(file) & files.keys() for name, file in files.items()}
    # Files that import nothing that is left go, until those of circles are left.
    while free := [name for name, of in takes.items() if not of & takes.keys()]:
        for name in free:
            del takes[name]
    assert {".".join(name) for name in takes} == set()


def test_no_room_imports_from_a_room_below_it():
    """In the order of `.github/CONTRIBUTING.md`; single files import from no room."""
    order = (*FIRST, *ROOMS, "commands")
    upwards = [
        (file.relative_to(PACKAGE).as_posix(), ".".join(module))
        for file in PACKAGE.rglob("*.py")
        if (name := file.relative_to(PACKAGE).parts)[0] not in ("__main__.py", "_alias")
        for module in imports_of(file)
        if module
        and module[0] in order[order.index(name[0]) + 1 if name[0] in order else 0 :]
    ]
    assert upwards == []
