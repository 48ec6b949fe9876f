"""The public names: one list, examples that run, exceptions that can be caught, types that a checker sees."""

from __future__ import annotations

import ast
import builtins
import doctest
import inspect
import re
import sys

import numpy as np
import pytest
import xarray

import rocking_cli
from rocking_cli import UsageError, build_structure, dimensionless_oscillator, load_structures, parse_documents, parse_grid, sine, spectrum

PUBLIC = {name: getattr(rocking_cli, name) for name in dir(rocking_cli)}
FUNCTIONS = sorted(name for name, thing in PUBLIC.items() if inspect.isfunction(thing))


def test_every_name_is_there_and_no_other():
    everything: dict[str, object] = {}
    exec("from rocking_cli import *", everything)
    assert everything.keys() - {"__builtins__"} == PUBLIC.keys()
    assert {"check", "predict", "family", "draw", "spectrum", "UsageError"} <= PUBLIC.keys()
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = rocking_cli.nothing


def test_types_are_shipped(pytestconfig):
    assert (pytestconfig.rootpath / "rocking_cli" / "py.typed").is_file()
    stub = ast.parse((pytestconfig.rootpath / "rocking_cli" / "__init__.pyi").read_text())
    listed = [alias.name for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names]
    assert sorted([*listed, "__version__"]) == dir(rocking_cli)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_examples_of_a_function_run(name, tmp_path, monkeypatch, pytestconfig):
    (tmp_path / "configs").symlink_to(pytestconfig.rootpath / "configs")
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestFinder(recurse=False).find(PUBLIC[name], name, globs=dict(PUBLIC))
    assert examples[0].examples, "has none"
    said: list[str] = []
    result = doctest.DocTestRunner().run(examples[0], out=said.append)
    assert not result.failed, "".join(said)


@pytest.mark.parametrize("name", sorted(set(PUBLIC) - {"__version__"}))
def test_exceptions_that_a_docstring_names_are_public(name):
    told = re.findall(r"\b[A-Z]\w*Error\b|\bInterrupted\b", inspect.getdoc(PUBLIC[name]) or "")
    assert [error for error in told if error not in PUBLIC and not hasattr(builtins, error)] == []


def test_structures_motion_and_grid_stand_in_this_order():
    order = ("structure", "structures", "spectrum", "motion", "grid", "shaking", "omegas")
    for name in FUNCTIONS:
        given = [p for p in inspect.signature(PUBLIC[name]).parameters if p in order]
        assert given == sorted(given, key=order.index), name


def test_a_path_may_be_a_text_or_one_of_many(tmp_path, pytestconfig):
    block = pytestconfig.rootpath / "configs" / "block.yaml"
    assert load_structures(block) == load_structures(str(block)) == load_structures([block]) == load_structures([str(block)])


def test_a_spectrum_becomes_the_dataset_that_its_file_holds(tmp_path):
    bodies = [
        build_structure(d) for d in parse_documents("{kind: block, width: 1, height: 4}\n---\n{name: b, kind: block, width: 1, height: 6}")
    ]
    grid = parse_grid("a_g=1:8:5,f_g=1:3:4")
    rocking_cli.write_spectrum(bodies, sine(), grid, str(tmp_path / "s.h5"), impacts=True, workers=1)
    ours = spectrum(bodies, sine(), grid, workers=1).to_xarray()
    with xarray.open_dataset(tmp_path / "s.h5", engine="h5netcdf") as file:
        assert set(ours.variables) == {name for name in file.variables if not name.startswith("chunk")}
        for name in ours.variables:
            assert ours[name].dims == file[name].dims
            assert (name in ours.coords) == (name in file.coords)
            np.testing.assert_array_equal(ours[name], file[name])
            for key, value in ours[name].attrs.items():
                np.testing.assert_array_equal(file[name].attrs[key], value)
    assert float(ours.theta_ratio.sel(structure="b").isel(a_g=0).max()) >= 0.0


def test_without_xarray_one_sentence_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    found = spectrum([dimensionless_oscillator(0.9)], sine(), parse_grid("A=2,Omega=5"), workers=1)
    with pytest.raises(rocking_cli.OutputError, match="to_xarray needs xarray"):
        found.to_xarray()
    with pytest.raises(UsageError):
        parse_grid("A=2")
