"""What is offered for a word that is unknown."""

import pytest

from rocking_cli import RockingError, time_history
from rocking_cli.errors import did_you_mean

OPTIONS = ["--a-g", "--f-g", "--T-g", "--grid", "--motion", "--Omega"]


@pytest.mark.parametrize(
    ("word", "known", "meant", "said"),
    [
        ("--a_g", OPTIONS, None, "'--a-g'"),
        ("--omega", OPTIONS, None, "'--Omega'"),
        ("--gird", OPTIONS, None, "'--grid'"),
        ("--pga", OPTIONS, {"--pga": "--a-g"}, "'--a-g'"),
        (
            "--pga",
            ["--b"],
            {"--pga": "--a-g"},
            None,
        ),  # what is meant is not to be had here
        (
            "Ricker",
            ["sine", "ricker-symmetric", "ricker-antisymmetric"],
            None,
            "'ricker-symmetric' or 'ricker-antisymmetric'",
        ),
        ("omega", ["A", "Omega", "omega_g"], None, "'Omega' or 'omega_g'"),
        ("b", ["block", "beam"], None, None),  # a letter begins too much
        ("zzz", OPTIONS, None, None),
        ("", OPTIONS, None, None),
    ],
)
def test_the_word_that_was_meant(word, known, meant, said):
    assert did_you_mean(word, known, meant) == (
        "" if said is None else f" (did you mean {said}?)"
    )


@pytest.mark.parametrize(
    "below",
    [
        "dynamics.equations.rigid_body._numbers",
        "dynamics.method.System",
        "responses.time_history.history",
    ],
)
def test_a_fault_of_the_package_is_not_told_as_one_of_the_user(below, monkeypatch):
    def mistyped(*_, **__):
        return float("0.5.2")

    monkeypatch.setattr(f"rocking_cli.{below}", mistyped)
    with pytest.raises(ValueError, match="could not convert") as told:
        time_history("block:0.51x2", "sine", "a_g=0.3g,f_g=1", "nonlinear")
    assert not isinstance(told.value, RockingError)
