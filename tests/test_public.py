"""The public names: one list, examples that run, exceptions that can be caught, types
that a checker sees.
"""

import ast
import builtins
import doctest
import inspect
import re
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray

import rocking_cli
from rocking_cli import (
    RockingError,
    UsageError,
    build_structure,
    dimensionless_oscillator,
    load_structures,
    parse_documents,
    parse_grid,
    sine,
    spectrum,
)
from rocking_cli.commands import COMMANDS
from rocking_cli.commands.help import page

PUBLIC = {name: getattr(rocking_cli, name) for name in dir(rocking_cli)}
ELSEWHERE = {
    "AnyMotion",
    "Shake",
    "Any",
    "Array",
    "Axes",
    "Callable",
    "ForwardRef",
    "Iterable",
    "Iterator",
    "Mapping",
    "NoneType",
    "Path",
    "Sequence",
    "Structure",
    "Union",
    "Unpack",
    "ndarray",
    "progress",
}
FUNCTIONS = sorted(name for name, thing in PUBLIC.items() if inspect.isfunction(thing))
CLASSES = sorted(name for name, thing in PUBLIC.items() if inspect.isclass(thing))


def test_every_name_is_there_and_no_other():
    everything: dict[str, object] = {}
    exec("from rocking_cli import *", everything)
    assert everything.keys() - {"__builtins__"} == PUBLIC.keys()
    assert {
        "check",
        "predict",
        "family",
        "draw",
        "spectrum",
        "UsageError",
    } <= PUBLIC.keys()
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = rocking_cli.nothing


def test_types_are_shipped(pytestconfig):
    assert (pytestconfig.rootpath / "rocking_cli" / "py.typed").is_file()
    stub = ast.parse(
        (pytestconfig.rootpath / "rocking_cli" / "__init__.pyi").read_text()
    )
    listed = [
        alias.name
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    assert sorted([*listed, "__version__"]) == dir(rocking_cli)


def test_the_page_of_help_lists_every_name():
    named = set(re.findall(r"\w+", page("python")))
    assert sorted(PUBLIC.keys() - named - {"__version__"}) == []
    assert (
        sorted(
            COMMANDS.keys()
            - set(re.findall(r"rocking (\w+) +\w", page("python")))
            - {"help"}
        )
        == []
    )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_types_in_signatures_are_public(name):
    """Annotations are texts, or types where a module does not import those of
    `__future__`.
    """
    types = [
        one if isinstance(one, str) else inspect.formatannotation(one)
        for one in inspect.get_annotations(PUBLIC[name]).values()
    ]
    named = {
        word
        for one in types
        for word in re.findall(
            r"(?<!\w)[A-Za-z]\w*(?![\w.])", one.replace("<class ", "")
        )
    }
    assert sorted(named - PUBLIC.keys() - set(dir(builtins)) - ELSEWHERE) == []


def test_a_function_stands_before_the_subpackage_of_its_name():
    from rocking_cli.fragility import fits

    assert (rocking_cli.fragility, rocking_cli.fit_stripes) == (
        PUBLIC["fragility"],
        PUBLIC["fit_stripes"],
    )
    assert rocking_cli.fit_stripes.__wrapped__ is fits.fit_stripes


def test_a_drawing_goes_into_axes_of_the_caller(tmp_path):
    figure = pytest.importorskip("matplotlib.figure").Figure()
    bodies = [dimensionless_oscillator(eta=0.9), dimensionless_oscillator(eta=0.8)]
    rocking_cli.write_spectrum(
        bodies, sine(), parse_grid("A=1:8:9,Omega=4:5:2"), tmp_path / "d.h5", workers=1
    )
    one, other = figure.subplots(1, 2)
    size = tuple(figure.get_size_inches())
    assert rocking_cli.draw(tmp_path / "d.h5", other, cut="Omega=5") is other
    assert other.lines
    assert not one.lines
    assert (len(figure.axes), tuple(figure.get_size_inches())) == (2, size)
    with pytest.raises(UsageError, match=r"a drawing of \d panels; expected one"):
        rocking_cli.draw(tmp_path / "d.h5", one, every=True)


def test_a_record_needs_no_grid():
    block = load_structures("configs/block.yaml")[0]
    (recording,) = rocking_cli.load_records("configs/motions/synthetic.at2", scale=0.7)
    found = rocking_cli.check(block, recording, a_max=None)
    assert found.demand_a == pytest.approx(recording.acceleration, rel=1e-12)
    (history,) = rocking_cli.compare([block], recording)
    assert history.histories["nonlinear"].theta_ratio == pytest.approx(
        found.theta_ratio, rel=1e-9
    )
    assert float(
        spectrum([block], recording.record, workers=1).scene.grid.amplitude.values[0]
    ) == pytest.approx(recording.acceleration / 0.7)
    with pytest.raises(UsageError, match="no grid; expected one"):
        rocking_cli.check(block, sine())
    with pytest.raises(
        UsageError,
        match=r"a record runs in its own time; expected Omega = 1/p = 0\.3\d+ alone",
    ):
        rocking_cli.trace_envelope(block, recording, [6.28])
    with pytest.raises(UsageError, match="expected no axis"):
        rocking_cli.envelope(block, recording, "f_g=1")


TWO_PULSES = "configs/motions/two_pulses.yaml"
TEXT = Path(TWO_PULSES).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "given",
    [
        TWO_PULSES,
        Path(TWO_PULSES),
        TEXT,
        parse_documents(TEXT)[0],
    ],
    ids=["path", "Path", "text", "document"],
)
def test_a_motion_may_be_a_path_a_text_or_a_document(given):
    demand = "a_g=0.35g,f_g=1.5"
    wanted = rocking_cli.check(
        "block:0.5x2", rocking_cli.read_motion(TWO_PULSES), demand, a_max=None
    )
    found = rocking_cli.check("block:0.5x2", given, demand, a_max=None)
    assert found.theta_ratio == wanted.theta_ratio


def test_a_motion_may_be_the_name_of_a_pulse_and_a_record_its_path():
    record, demand = "configs/motions/synthetic.at2", "a_g=0.4g,f_g=1"
    block = "configs/block.yaml"
    of_name, of_object = (
        rocking_cli.time_history(block, motion, demand).outcome("nonlinear")
        for motion in ("sine", sine())
    )
    assert of_name == of_object
    (recording,) = rocking_cli.load_records(record)
    assert rocking_cli.intensity(record) == recording.intensity
    named, given = (
        rocking_cli.check(block, motion, a_max=None).theta_ratio
        for motion in (record, recording)
    )
    assert named == given
    of_texts = rocking_cli.boundaries(block, "width=0.5:0.6:2", "sine", demand)
    assert of_texts == rocking_cli.boundaries(
        rocking_cli.read_documents(block)[0],
        rocking_cli.parse_variation("width=0.5:0.6:2"),
        [(sine(), parse_grid(demand))],
    )


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        (
            "sien",
            "unknown pulse 'sien'; .*did you mean 'sine'.*or the path of a motion",
        ),
        ("site.at2", "site.at2: cannot be read: No such file"),
        ("{points: [[0, 1]]}", "<text>:1:10: points: found 1 entries"),
        ("configs/block.yaml", "found a structure, of kind block"),
        (3.0, "found 3.0; expected a Motion"),
    ],
)
def test_a_wrong_motion_is_told_in_one_sentence(motion, said):
    with pytest.raises(RockingError, match=said):
        rocking_cli.check("block:0.5x2", motion, "a_g=0.35g,f_g=1.5")


def test_an_equation_may_be_its_name_and_an_outcome_its_word():
    column, demand = "{kind: block, width: 0.5, height: 2}", "a_g=0.35g,f_g=1.5"
    found = rocking_cli.time_history(column, "sine", demand, "linear")
    wanted = rocking_cli.time_history(
        load_structures("block:0.5x2")[0], sine(), demand, [rocking_cli.Method()]
    )
    assert [row["theta"] for row in found.rows()] == [
        row["theta"] for row in wanted.rows()
    ]
    outcome = found.outcome("linear")
    assert outcome == "rocked"
    assert outcome != "overturned_no_impact"
    assert {outcome: 1}[2] == 1
    with pytest.raises(UsageError, match=r"unknown model 'liner'.*did you mean"):
        rocking_cli.time_history(column, "sine", demand, "liner")


def test_a_hazard_curve_may_be_the_path_of_its_file():
    path = "configs/hazard.csv"
    wanted = rocking_cli.annual_rate(1.5, 0.3, rocking_cli.read_hazard(path))
    assert rocking_cli.annual_rate(1.5, 0.3, path) == wanted


def sections(thing):
    """Return the sections of a docstring by title: the names that each lists, which
    begin its lines without indentation.
    """
    lines = inspect.getdoc(thing).splitlines()
    titles = [i for i, line in enumerate(lines) if line and not line.strip("-")]
    found = {}
    for start, stop in zip(titles, [*titles[1:], len(lines) + 1], strict=True):
        listed = [x for x in lines[start + 1 : stop - 1] if x and x[0] != " "]
        found[lines[start - 1]] = [
            name for line in listed for name in line.partition(":")[0].split(", ")
        ]
    return found


def documented(function):
    """Return the sections of a function after a look at its parameters and result."""
    found, signature = sections(function), inspect.signature(function)
    parameters = [name for name in signature.parameters if name not in ("self", "cls")]
    assert found.get("Parameters", []) == parameters
    if signature.return_annotation not in (None, "None"):
        assert found.keys() & {"Returns", "Yields"}
    return found


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_docstring_names_parameters_result_and_errors(name):
    found = documented(PUBLIC[name])
    errors = [PUBLIC.get(error) for error in found["Raises"]]
    assert any(issubclass(error, RockingError) for error in errors)
    assert "Examples" in found


@pytest.mark.parametrize("name", CLASSES)
def test_a_docstring_names_fields_and_arguments_of_methods(name):
    kind = PUBLIC[name]
    found = sections(kind)
    assert "Examples" in found
    there = {*names_of(kind), *inspect.get_annotations(kind)}
    for method in filter(inspect.isfunction, vars(kind).values()):
        there |= {*method.__code__.co_names}  # a method may set further attributes
    assert set(found.get("Attributes", [])) <= there
    if "Parameters" in found:
        assert found["Parameters"] == list(inspect.signature(kind).parameters)
    for method, given in vars(kind).items():
        function = getattr(given, "__func__", given)
        inherited = any(hasattr(base, method) for base in kind.__bases__)
        if not (method[0] == "_" or inherited) and inspect.isfunction(function):
            assert function.__doc__, method
            if function.__code__.co_argcount + function.__code__.co_kwonlyargcount > 1:
                documented(function)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("name", ["rocking_cli", *FUNCTIONS, *CLASSES])
def test_the_examples_of_a_docstring_run(name, tmp_path, monkeypatch, pytestconfig):
    (tmp_path / "configs").symlink_to(pytestconfig.rootpath / "configs")
    monkeypatch.chdir(tmp_path)
    thing = PUBLIC.get(name, rocking_cli)
    examples = doctest.DocTestFinder(recurse=False).find(
        thing, name, globs=dict(PUBLIC)
    )
    assert examples[0].examples, "has none"
    said: list[str] = []
    # An output wider than a docstring is wrapped there.
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    result = runner.run(examples[0], out=said.append)
    assert not result.failed, "".join(said)


@pytest.mark.parametrize("name", sorted(set(PUBLIC) - {"__version__"}))
def test_exceptions_that_a_docstring_names_are_public(name):
    named = re.findall(
        r"\b[A-Z]\w*Error\b|\bInterrupted\b", inspect.getdoc(PUBLIC[name]) or ""
    )
    assert [
        error for error in named if error not in PUBLIC and not hasattr(builtins, error)
    ] == []


def test_structures_motion_and_grid_stand_in_this_order():
    order = (
        "structure",
        "structures",
        "spectrum",
        "motion",
        "grid",
        "shaking",
        "omegas",
    )
    for name in FUNCTIONS:
        given = [p for p in inspect.signature(PUBLIC[name]).parameters if p in order]
        assert given == sorted(given, key=order.index), name


def test_a_path_may_be_a_text_or_one_of_many(tmp_path, pytestconfig):
    block = pytestconfig.rootpath / "configs" / "block.yaml"
    assert (
        load_structures(block)
        == load_structures(str(block))
        == load_structures([block])
        == load_structures([str(block)])
    )


def test_a_spectrum_becomes_the_dataset_that_its_file_holds(tmp_path):
    bodies = [
        build_structure(d)
        for d in parse_documents(
            "{kind: block, width: 1, height: 4}\n---\n{name: b, kind: block, width: 1,"
            " height: 6}"
        )
    ]
    grid = parse_grid("a_g=1:8:5,f_g=1:3:4")
    rocking_cli.write_spectrum(
        bodies, sine(), grid, str(tmp_path / "s.h5"), impacts=True, workers=1
    )
    ours = spectrum(bodies, sine(), grid, workers=1).to_xarray()
    with xarray.open_dataset(tmp_path / "s.h5", engine="h5netcdf") as file:
        assert set(ours.variables) == {
            name for name in file.variables if not name.startswith("chunk")
        }
        for name in ours.variables:
            assert ours[name].dims == file[name].dims
            assert (name in ours.coords) == (name in file.coords)
            np.testing.assert_array_equal(ours[name], file[name])
            for key, value in ours[name].attrs.items():
                np.testing.assert_array_equal(file[name].attrs[key], value)
    assert float(ours.theta_ratio.sel(structure="b").isel(a_g=0).max()) >= 0.0


def test_without_xarray_one_sentence_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    found = spectrum(
        [dimensionless_oscillator(eta=0.9)],
        sine(),
        parse_grid("A=2,Omega=5"),
        workers=1,
    )
    with pytest.raises(rocking_cli.OutputError, match="to_xarray needs xarray"):
        found.to_xarray()
    with pytest.raises(UsageError):
        parse_grid("A=2")


def names_of(kind):
    """Return the attributes and fields of a class."""
    return {*dir(kind), *getattr(kind, "__dataclass_fields__", {})}
