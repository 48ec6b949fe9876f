"""The JSON Schema says of each kind what its table of keys says."""

import json
import re

import pytest

from rocking_cli.documents.quantities import UNITS
from rocking_cli.structures.kinds import KINDS, keys_of
from rocking_cli.structures.schema import schema_text


@pytest.fixture(scope="module")
def definitions():
    return json.loads(schema_text())["definitions"]


def test_a_kind_has_its_keys_and_a_way_to_say_each_thing(definitions):
    for kind in KINDS:
        keys, found = keys_of(kind), definitions[kind]
        assert keys.all.keys() <= found["properties"].keys()
        assert found["required"] == [*keys.required]
        assert found["additionalProperties"] is False
        assert len(found["allOf"]) == len(keys.ways)
    ways = [one["required"] for one in definitions["block"]["allOf"][0]["anyOf"]]
    assert ways == [["width", "height"], ["radius", "alpha"]]


def test_the_values_of_a_key_have_its_limits_and_words(definitions):
    wall, arch = (definitions[kind]["properties"] for kind in ("wall", "arch"))
    width = {"allOf": [{"$ref": "#/definitions/length"}], "minimum": 1e-9}
    assert wall["length"].items() >= width.items()
    assert wall["density"]["exclusiveMinimum"] == 0.0
    assert wall["top"]["enum"] == ["held", "free", None]
    assert wall["crack_height"]["if"] == {"enum": ["auto"]}
    assert wall["friction"]["then"]["required"] == ["static", "kinetic"]
    ties = wall["ties"]["items"]["properties"]
    assert ties["side"]["enum"] == ["left", "right", "both", None]
    assert (arch["voussoirs"]["minimum"], arch["voussoirs"]["maximum"]) == (4, 200)
    eta = definitions["parameters"]["properties"]["eta"]
    assert eta.keys() & {"minimum", "maximum", "exclusiveMinimum"} == {
        "exclusiveMinimum"
    }
    assert wall["length"]["description"] == keys_of("wall").all["length"].doc


@pytest.mark.parametrize("dimension", UNITS)
def test_a_quantity_is_a_number_with_a_unit_of_its_dimension(definitions, dimension):
    pattern = re.compile(definitions[dimension]["pattern"])
    for unit in ("", *UNITS[dimension]):
        assert pattern.search(f"1.5e3 {unit}")
        assert pattern.search(f"2 {unit} +- 5 %")
        assert pattern.search(f"1 {unit} .. 2 {unit}")
    assert not pattern.search("2 parsec")
    assert not pattern.search("two")
