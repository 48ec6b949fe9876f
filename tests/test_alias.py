"""`import rocking` gives the package itself, and no module twice."""

import os
import subprocess
import sys
import tomllib
from importlib import import_module

import pytest
import rocking

import rocking_cli


def test_the_name_of_the_program_is_the_package():
    assert rocking is rocking_cli
    assert rocking.check is rocking_cli.check


@pytest.mark.parametrize(
    "name", ["motions", "motions.records", "structures.kinds.block"]
)
def test_a_module_below_it_is_the_same(name):
    found, own = (import_module(f"{one}.{name}") for one in ("rocking", "rocking_cli"))
    assert found is own
    assert own.__spec__.name == own.__name__ == f"rocking_cli.{name}"
    with pytest.raises(ModuleNotFoundError, match=r"rocking_cli\.nothing"):
        import_module("rocking.nothing")


def test_it_runs_as_a_program_and_is_shipped_beside_the_package(pytestconfig):
    root = pytestconfig.rootpath
    build = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["hatch"][
        "build"
    ]
    ((folder, name),) = (
        pair
        for pair in build["targets"]["wheel"]["force-include"].items()
        if pair[1] == "rocking"
    )
    home = root / folder
    assert str(home.parent.relative_to(root)) in build["dev-mode-dirs"]
    assert {"__init__.py", "__init__.pyi", "py.typed"} <= {
        x.name for x in home.iterdir()
    }
    path = os.pathsep.join([str(root), str(home.parent)])
    done = subprocess.run(
        [sys.executable, "-m", name, "--version"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert done.stdout == f"rocking, version {rocking_cli.__version__}\n"
