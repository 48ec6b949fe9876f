"""Arguments of the public functions: whatever is wrong is told in one sentence that
names the argument.
"""

import inspect
import io
import pickle
from pathlib import Path

import numpy as np
import pytest

import rocking_cli
from rocking_cli import (
    RockingError,
    UsageError,
    load_structures,
    parse_grid,
    parse_variation,
    pulse,
    read_documents,
    read_record,
    sine,
)

FUNCTIONS = sorted(
    name for name in dir(rocking_cli) if inspect.isfunction(getattr(rocking_cli, name))
)
BLOCK = load_structures("configs/block.yaml")[0]
STATED = load_structures("configs/parameters.yaml")[0]  # whose equation is quick
# What an argument of this name may be; the others are optional.
RIGHT = {
    "structure": STATED,
    "structures": [STATED],
    "motion": pulse("rectangular"),  # the searches under which are short
    "shaking": parse_grid("a_g=0.3g,f_g=1"),
    "grid": parse_grid("a_g=1,f_g=1"),
    "system": None,
    "document": read_documents("configs/block.yaml")[0],
    "documents": read_documents("configs/block.yaml"),
    "record": read_record("configs/motions/synthetic.at2"),
    "records": [],
    "periods": [0.5],
    "omegas": [1.0],
    "levels": [1.0, 2.0],
    "x": np.array([1.0, 2.0]),
    "n": np.array([9, 9]),
    "z": np.array([1, 5]),
    "r": np.array([1.0, 2.0]),
    "theta_ratio": np.array([0.1, 0.5]),
    "limit": 0.5,
    "median": 1.0,
    "beta": 0.4,
    "eta": 0.9,
    "alpha": 0.2,
    "amplitude": 1.0,
    "omega": 1.0,
    "duration": 1.0,
    "paths": "configs/block.yaml",
    "path": "configs/block.yaml",
    "text": "kind: block",
    "kind": "block",
    "name": "sine",
    "codes": [1],
    "source": "none.h5",
    "target": "none.svg",
    "output": "none.h5",
    "curves": [],
    "checks": [],
    "verdicts": [],
    "spectrum": "none.h5",
    "varied": parse_variation("width=0.4:0.8:2"),
    "variations": ["width=0.4:0.8:2"],
    "shakes": [(sine(), parse_grid("a_g=1,f_g=1"))],
}
WRONG = [
    "nonsense",
    "",
    Path("nowhere"),
    {},
    {"a": 1},
    None,
    BLOCK,
    [BLOCK],
    ["nonsense"],
    [],
    0.3,
    -1,
    True,
    np.nan,
    object(),
    np.array([1, 2]),
    np.array(1),
    np.array([1.0, 2.0, 3.0]),
    np.ones((2, 2)),
    {1},
    10**400,
    -(10**400),
    [10**400],
    "a\0b",
    "\ud800",
    "x" * 5000,
    [io.StringIO("x")],
]


def wrong_values():
    """Fresh ones, since a generator can be gone through only once."""
    return [*WRONG, (x for x in ()), (x for x in [1]), [iter([1])]]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_wrong_argument_is_told_in_one_sentence(
    name, tmp_path, monkeypatch, pytestconfig
):
    (tmp_path / "configs").symlink_to(pytestconfig.rootpath / "configs")
    monkeypatch.chdir(tmp_path)
    function = getattr(rocking_cli, name)
    parameters = inspect.signature(function).parameters.values()
    needed = {
        p.name
        for p in parameters
        if p.default is p.empty and p.kind is not p.VAR_KEYWORD
    }
    for one in parameters:
        if one.kind in (one.VAR_KEYWORD, one.VAR_POSITIONAL):
            continue
        told = [
            str(error)
            for wrong in wrong_values()
            if (error := raised(function, RIGHT, needed, {one.name: wrong})) is not None
        ]
        assert told, one.name
        assert not [text for text in told if "\n" in text], one.name


def raised(function, right, needed, given):
    """The RockingError of a call, None if it has a result; any other exception fails
    the test.
    """
    try:
        found = function(
            **({key: value for key, value in right.items() if key in needed} | given)
        )
        list(found) if inspect.isgenerator(found) else found
    except RockingError as error:
        return error
    except Exception as error:
        error.add_note(f"{function.__name__} with {given}")
        raise
    return None


GRID = parse_grid("a_g=0.3g,f_g=1")
SENTENCES = [
    (
        lambda: rocking_cli.check("column.yaml", sine(), GRID),
        "column.yaml: cannot be read",
    ),
    (
        lambda: rocking_cli.check([BLOCK], sine(), GRID),
        "`structure`: found a list of RockingParameters; expected",
    ),
    (
        lambda: rocking_cli.spectrum(0.5, sine(), GRID),
        "`structures`: found 0.5; expected .* or a list, each item",
    ),
    (
        lambda: rocking_cli.spectrum([BLOCK, None], sine(), GRID),
        "found a list of RockingParameters, NoneType; expected",
    ),
    (
        lambda: rocking_cli.check(BLOCK, sine(), 0.3),
        "`shaking`: found 0.3; expected a Grid .see parse_grid. or a text",
    ),
    (lambda: rocking_cli.check(BLOCK), "check: missing a required argument: 'motion'"),
    (
        lambda: rocking_cli.read_motion("configs/motions/synthetic.at2", units="g"),
        "an argument 'units' .did you mean 'unit'",
    ),
    (
        lambda: rocking_cli.spectrum([BLOCK], sine(), GRID, worker=2),
        "an argument 'worker' .did you mean 'workers'",
    ),
    (
        lambda: rocking_cli.pulse("sine", cycles="2"),
        "pulse: `cycles`: found '2'; expected a number",
    ),
    (
        lambda: rocking_cli.load_structures({"kind": "block"}),
        "`paths`: found a dict; expected a text or Path or a list, each item a text",
    ),
    (
        lambda: rocking_cli.closed_form_curves([1.0], 0.9, "nope"),
        "found pulse 'nope'; expected one of sine",
    ),
    (
        lambda: rocking_cli.time_history(BLOCK, sine(), GRID, 3.0),
        "`methods`: found 3.0; expected Method or a text or a list",
    ),
    (
        lambda: rocking_cli.export_fragility([], "f.xml"),
        "`curves`: found an empty list",
    ),
    (
        lambda: rocking_cli.HazardCurve("a", [1.0, 0.1]),
        "HazardCurve: `x`: found 'a'; expected an array of numbers",
    ),
    (
        lambda: rocking_cli.Resampling("many"),
        "Resampling: `samples`: found 'many'; expected a whole number",
    ),
    (
        lambda: rocking_cli.sine(cycles=10**400),
        "sine: `cycles`: found a number beyond double precision; expected a number",
    ),
    (
        lambda: rocking_cli.draws("a\0b", 3),
        "draws: `document`: found 'a.x00b'; expected",
    ),
    (
        lambda: rocking_cli.spectrum(iter([None]), sine(), GRID),
        "spectrum: `structures`: found a list of NoneType",
    ),
    (
        lambda: rocking_cli.merge(iter([]), "m.h5"),
        "merge: `paths`: found an empty list",
    ),
    (
        lambda: rocking_cli.Grid(1.0, 2.0),
        "Grid: `amplitude`: found 1.0; expected Axis",
    ),
]


@pytest.mark.parametrize(("call", "words"), SENTENCES)
def test_the_sentence_names_the_argument_what_was_found_and_what_is_expected(
    call, words
):
    with pytest.raises(UsageError, match=words):
        call()


def test_a_function_that_checks_is_pickled_by_its_public_name():
    assert pickle.loads(pickle.dumps(rocking_cli.check)) is rocking_cli.check
