"""What is offered for a word that is unknown."""

import pytest

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
