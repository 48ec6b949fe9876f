"""Tables of keys: limits in words, ways to say one thing, values that people mean."""

import math

import pytest

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.documents.keys import Key, Keys, length, positive

WORDS = [
    (positive("mass"), "a positive mass"),
    (positive("mass", most=9.0), "a mass above 0 and up to 9 kg"),
    (Key("force", least=0.0), "a force from 0 N"),
    (Key("length", least=2.0), "a length from 2 m"),
    (Key("angle", above=0.0, below=0.5 * math.pi), "an angle between 0 and 90 deg"),
    (Key("number", least=0.0, below=1.0), "a number from 0 to below 1"),
    (Key("number", above=-1.0, most=0.0), "a number above -1 and up to 0"),
    (Key("acceleration", most=3.0), "an acceleration up to 3 m/s2"),
    (Key("number", words=("auto",)), "a number without a unit, or auto"),
]


@pytest.mark.parametrize(("key", "words"), WORDS)
def test_limits_in_words(key, words):
    assert key.range() == words


def test_one_thing_is_said_in_one_way():
    ways = (
        Keys({"a": length()}, {"d": length()}),
        Keys({"b": length(), "h": length()}),
        Keys({"c": length(), "h": length()}),
    )
    keys = Keys({"x": length()}, ways=(ways,))
    stated = ["", "x", "h", "ad", "bh", "ch", "ab", "bc", "dh"]
    assert [keys.way(one) for one in stated] == [0, 0, 1, 0, 1, 2, -1, -1, -1]
    assert keys.in_words() == "x, a (or b and h, or c and h)"
    (document,) = parse_documents("{x: 1, c: 2, h: 1, b: 1}", "f.yaml")
    with pytest.raises(
        DocumentError,
        match=r"f.yaml:1:11: c: found c together with b; expected a, or b and h, or c",
    ):
        document.declare(keys)


BLOCK = "{kind: block, width: 0.6, height: 2.1, mass: 2 t, %s}"
LOAD = "loads: [{at: [0, 2.1], inertia: none, weight: %s}]"
UNUSUAL = [
    ("friction: 60", "f.yaml:1:61: friction: 60; usual is 0 to 2; did you mean 60 % ="),
    ("friction: 35", "35 deg (its tangent) = 0.70021?"),
    ("friction: {static: 0.4, kinetic: 0.3}", ""),
    ("friction: {static: 40, kinetic: 0.3}", "friction.static: 40; usual is"),
    ("friction: 2", ""),
    ("gravity: 32.2", "usual is 1.5 to 24.9; did you mean 32.2 ft/s2 = 9.8146 m/s2?"),
    ("gravity: 386.4", "did you mean 386.4 in/s2 = 9.8146 m/s2 or"),
    ("gravity: 981", "did you mean 981 cm/s2 = 9.81 m/s2?"),
    ("gravity: 1", "did you mean 1 g = 9.81 m/s2?"),
    ("gravity: 1.62", ""),
    ("gravity: 50 g", ""),
    ("gravity: 9.81", ""),
    (LOAD % 15, "loads.0.weight: 15 without a unit is 15 N; usual is 100 or more; did"),
    (LOAD % 15, "did you mean 15 kN = 15000 N?"),
    (LOAD % "15 +- 2", "loads.0.weight: 15 without a unit"),
    (LOAD % "15 N", ""),
    (LOAD % 150, ""),
]
DENSE = "{kind: wall, thickness: 0.6, height: 3, length: 1, density: %s}"
DENSITIES = [
    ("18", "did you mean 18 kN/m3 = 1834.9 kg/m3?"),
    ("2.4", "did you mean 2.4 t/m3 = 2400 kg/m3 or"),
    ("18 kg/m3", ""),
    ("1800", ""),
    ("11340", ""),
]


@pytest.mark.parametrize(
    ("text", "words"),
    [(BLOCK % text, words) for text, words in UNUSUAL]
    + [(DENSE % text, words) for text, words in DENSITIES],
)
def test_a_number_that_was_probably_meant_in_another_unit_is_told(text, words):
    (document,) = parse_documents(text, "f.yaml")
    remarks = build_structure(document).remarks
    assert [remark for remark in remarks if words not in remark] == []
    assert len(remarks) == bool(words)
