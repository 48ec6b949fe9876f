"""One rule for the equation in every command: of motion itself for a known geometry in
units, else the linear one; each run says which.
"""

import pytest
from support.soak import quick

UNITS, BARE = ("--a-g", "0.3g", "--f-g", "2"), ("--A", "2", "--Omega", "3")
COMMANDS = {
    "response": ((*UNITS, "--csv"), (*BARE, "--csv")),
    "compare": (UNITS, BARE),
    "check": (UNITS, BARE),
    "envelope": (
        ("--grid", "f_g=2", "--first", "--a-max", "2"),
        ("--grid", "Omega=3", "--first", "--a-max", "2"),
    ),
    "spectrum": (
        ("--grid", "a_g=0.2g:0.3g:2,f_g=2", "-o", "s.h5"),
        ("--grid", "A=2,Omega=3", "-o", "s.h5"),
    ),
    "accuracy": (
        ("--grid", "a_g=0.5g:0.6g:2,f_g=1", "--sample", "1", "--scipy", "0"),
        ("--grid", "A=2,Omega=3", "--sample", "1", "--scipy", "0"),
    ),
}
WITH_MODEL = ("response", "compare", "envelope", "spectrum", "accuracy")
LINEAR, NONLINEAR = (
    "model: linear, on dimensionless axes (A, Omega)",
    "model: nonlinear",
)


@pytest.fixture
def noted(rocking):
    """`rocking` with every line on standard error."""
    return lambda *words, **more: rocking(*words, "--notes", **more)


def said(done) -> list[str]:
    assert done.returncode == 0, done.stderr
    return [line for line in done.stderr.splitlines() if line.startswith("model:")]


@pytest.mark.slow
@pytest.mark.parametrize("command", quick(COMMANDS, *COMMANDS.keys() - {"accuracy"}))
def test_the_axes_and_the_geometry_decide(noted, command):
    units, bare = COMMANDS[command]
    again = ("--overwrite",) if command == "spectrum" else ()
    assert said(noted(command, "configs/block.yaml", *units)) == [NONLINEAR]
    assert said(noted(command, "configs/block.yaml", *bare, *again)) == [LINEAR]
    stated = "model: linear, since the geometry of Measured arch is not known"
    assert said(noted(command, "configs/parameters.yaml", *units, *again)) == [stated]
    if command in WITH_MODEL:
        assert said(
            noted(command, "configs/block.yaml", *units, *again, "--model", "linear")
        ) == ["model: linear"]
        assert said(
            noted(command, "configs/block.yaml", *bare, *again, "--model", "nonlinear")
        ) == [NONLINEAR]


@pytest.mark.parametrize("command", [*COMMANDS, "fragility"])
def test_help_states_the_rule(noted, command):
    text = " ".join(noted(command, "--help").stdout.split()).casefold()
    assert "nonlinear for a known geometry in units" in text
    assert "linear on dimensionless axes" in text


def test_free_rocking_and_records_have_units(noted):
    record = ("--motion", "configs/motions/synthetic.at2")
    assert said(
        noted("response", "configs/block.yaml", "--release", "0.5", "--csv")
    ) == [NONLINEAR]
    assert said(
        noted("response", "configs/block.yaml", *record, "--A", "1.5", "--csv")
    ) == [NONLINEAR]
    assert said(
        noted(
            "check",
            "configs/block.yaml",
            "configs/parameters.yaml",
            *record,
            "--verdict-only",
        )
    ) == [NONLINEAR, "model: linear, since the geometry of Measured arch is not known"]
