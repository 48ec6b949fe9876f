"""The JSON Schema of structure documents accepts what the readers accept, and refuses
what they refuse.
"""

import json
import re

import pytest
import yaml
from support.json_schema import CHECKS, faults

from rocking_cli import DocumentError, build_structure
from rocking_cli import parse_documents as documents
from rocking_cli.documents.asking import AskedDocument, Questions, plain_of
from rocking_cli.structures.kinds import KINDS
from rocking_cli.structures.schema import made_text, schema_text


@pytest.fixture(scope="module")
def schema():
    return json.loads(schema_text())


@pytest.mark.soak
def test_the_schema_that_is_shipped_is_that_of_the_readers(pytestconfig):
    shipped = pytestconfig.rootpath / "rocking_cli/structures/schema.json"
    made = made_text()
    assert shipped.read_text(encoding="utf-8") == made, "make schema writes it again"


AGAIN = "make schema writes the schema again"


def parts_of(schema, root):
    """A schema and those that it refers to for the same value."""
    yield schema
    inner = [*schema.get("allOf", ()), *schema.get("anyOf", ())]
    inner += [schema[key] for key in ("then", "else") if key in schema]
    if "$ref" in schema:
        inner.append(root["definitions"][schema["$ref"].rpartition("/")[2]])
    for one in inner:
        yield from parts_of(one, root)


def schemas_at(schema, root, path):
    """The schemas of the values at a path such as `pieces.*.width`."""
    found = list(parts_of(schema, root))
    for name in path.split("."):
        if name == "*":
            inside = [one.get(key) for one in found for key in EVERY]
        else:
            inside = [one.get("properties", {}).get(name) for one in found]
        found = [x for one in inside if one for x in parts_of(one, root)]
    return found


EVERY = ("items", "additionalProperties")  # the schema of each value in a list, a map
LIMITS = (("inimum", "least", "open_low"), ("aximum", "most", "open_high"))


def test_what_the_readers_ask_of_a_document_stands_in_the_schema(schema, pytestconfig):
    """Keys, forms, words and limits, of the shipped documents and those below."""
    texts = [x.read_text(encoding="utf-8") for x in shipped_files(pytestconfig)]
    asked: dict[str, Questions] = {}
    for document in (x for text in (*texts, GOOD, MECHANISM) for x in documents(text)):
        plain = {key: plain_of(value) for key, value in document.values.items()}
        log = asked.setdefault(plain["kind"], Questions())
        build_structure(AskedDocument.of(plain, log))
    assert asked.keys() == {*KINDS}
    for kind, log in asked.items():
        for path in log.known.keys() - {"kind"}:
            found = schemas_at(schema["definitions"][kind], schema, path)
            assert found or asks_nothing(schema, kind, path), (kind, path, AGAIN)
            questions = log.asked.get(path, [])
            whole = [one for one in questions if one.form == "integer"]
            for question in whole or questions:
                assert tells(found, question, schema), (kind, path, question, AGAIN)


def asks_nothing(schema, kind, path):
    """True if a key may stand there, whatever its value."""
    inside, _, key = path.rpartition(".")
    at = schema["definitions"][kind]
    outer = schemas_at(at, schema, inside) if inside else parts_of(at, schema)
    mappings = [one for one in outer if "object" in one.get("type", ())]
    return any(
        key in one.get("properties", {}) or one.get("additionalProperties", True)
        for one in mappings
    )


def tells(found, asked, root):
    """True if the schemas of a value say what a reader asks of it, and limit it as the
    reader does.
    """
    if asked.form == "choice":
        return any({*asked.words} <= {*one.get("enum", ())} for one in found)
    if asked.form == "flag":
        return any("boolean" in one.get("type", ()) for one in found)
    if asked.form in ("part", "named"):
        return any("object" in one.get("type", ()) for one in found)
    if asked.form in ("parts", "pair", "pairs", "names"):
        return any("array" in one.get("type", ()) for one in found)
    if asked.form == "integer":
        return any(one.get("minimum") == asked.least for one in found)
    if asked.form != "quantity":
        return True  # a word, or the name of a part: any text
    pattern = root["definitions"][asked.dimension]["pattern"].removeprefix("^(")
    for word, end, open_end in LIMITS:
        for key, is_open in ((f"m{word}", False), (f"exclusiveM{word}", True)):
            limits = {one[key] for one in found if key in one}
            if limits - {getattr(asked, end)} or (
                limits and is_open != getattr(asked, open_end)
            ):
                return False
    return any(one.get("pattern", "").endswith(pattern) for one in found)


def test_the_descriptions_are_the_comments_of_the_shipped_documents(
    schema, pytestconfig
):
    for kind in KINDS:
        text = (pytestconfig.rootpath / f"configs/{kind}.yaml").read_text("utf-8")
        commented = dict(re.findall(r"^([a-z_]+):[^#\n]*# *(.+?)[ ,]*$", text, re.M))
        keys = schema["definitions"][kind]["properties"]
        for key in commented.keys() & keys.keys() - {"kind"}:
            assert keys[key].get("description") == commented[key], (kind, key, AGAIN)


def shipped_files(pytestconfig):
    """The shipped documents."""
    return sorted((pytestconfig.rootpath / "configs").glob("*.yaml"))


def test_every_shipped_document_is_valid_and_so_is_what_params_prints(
    schema, pytestconfig
):
    files = shipped_files(pytestconfig)
    assert len(files) >= len(KINDS)
    for file in files:
        text = file.read_text(encoding="utf-8")
        for plain in yaml.safe_load_all(text):
            assert list(faults(schema, plain)) == [], file.name
        for document in documents(text):
            row = json.loads(json.dumps(build_structure(document).row()))
            assert list(faults(schema, row)) == [], file.name


GOOD = """
{kind: block, width: 0.5 m +- 10 mm, height: 2 .. 2.1 m, labels: {room: 2 b}}
---
{kind: block, radius: 1.03, alpha: 14 deg, restitution: auto, name: 3}
---
{kind: block, width: 0.5 ± 2 %, height: 2, restitution: 0.85..0.95}
---
{kind: wall, thickness: 0.6, height: 6, one_sided: true, restitution: -0.4, mass: 7 t,
 ties: [{height: 5.5, stiffness: 2e6 N/m, ultimate: 0.5 m},
        {height: 3, length: 1, area: 1 cm2, modulus: 200 GPa, side: right}],
 tendon: {stiffness: 1e6}, dampers: {coefficient: 100 N s/m}}
---
{kind: arch, span: 19.6, rise: 8, thickness: 1.5, voussoirs: 7}
---
{kind: arch, radius: 10, angle: 157.5 deg, thickness: 1.5, voussoirs: 7,
 hinges: [0 deg, 67.5 deg, 112.5 deg, 157.5 deg]}
---
{kind: drum, radius: 0.5, height: 3}
---
{kind: spire, base_radius: 1.5, height: 12, thickness: 15 cm, tip_height: 10}
---
{kind: parameters, sides: [{side: left, p: 2, alpha: 0.2, eta: 0.9, lambda: 0.2},
                           {side: right, p: 2, alpha: 0.3, eta: 0.9, lambda: 0.3}]}
---
{kind: rigid, left: 0.3, right: 0.4, height: 1, inertia: 3 t m2, mass: 4 t, inset: 1 cm}
---
{kind: block, width: 0.5, height: 2, mass: 2 t, strength: 2 MPa, depth: 1,
 friction: {static: 0.35, kinetic: 0.3},
 loads: [{bearing: centre, weight: 2 kN, inertia: both},
         {at: [0, 2 m], mirrored: false, mass: 0.3 t, inertia: vertical}]}
---
{kind: wall, thickness: 0.3, height: 3, density: 1800, length: 1, top: held,
 crack_height: 2 m, loads: []}
---
kind: mechanism
bodies: {one: {corners: [[0, 0], [0.5, 0], [0.5, 2], [0, 2]], density: 1800}}
joints: [{hinge: [ground, one], at: [0.5, 0]}]
one_sided: true
restitution: -0.4
---
kind: mechanism
friction: 0.9 +- 0.02
bodies:
  1: {mass: 972 kg +- 2 %, centre: [0.15 m, 1], gyration: 0.6,
      corners: [[0, 0], [0.3, 0], [0.3, 2], [0, 2]]}
  upper: {corners: [[0, 2], [0.3, 2], [0.3, 3], [0, 3]], density: 1800, length: 2 m}
  cap: {corners: [[0, 3], [0.3, 3], [0.3, 3.1], [0, 3.1]], density: 2400 kg/m3}
joints:
- {rigid: [upper, cap]}
- {hinge: [ground, 1], at: [0.3, 0]}
- {hinge: [1, upper], at: [0, 2]}
- {slide: upper, at: [0.15, 3]}
loads: [{body: cap, at: [0.1, 3.1], mass: 1 t, inertia: none, mirrored: true}]
other_side: mirrored
rotation_of: 1
axis: 0.15
"""


def test_documents_that_state_other_keys_are_valid(schema):
    for plain in yaml.safe_load_all(GOOD):
        assert list(faults(schema, plain)) == []
    for document in documents(GOOD):
        build_structure(document)


UNKNOWN = "additionalProperties"


def loads(text):
    return f"{{kind: block, width: 1, height: 4, mass: 9 t, loads: [{{{text}}}]}}"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{kind: block, widht: 0.5, height: 2}", (".widht", "additionalProperties")),
        ("{kind: block, width: 0.5 kg, height: 2}", (".width", "pattern")),
        ("{kind: block, width: 0.5 +- 1 kg, height: 2}", (".width", "pattern")),
        ("{kind: block, width: 0.5}", ("", "anyOf")),
        ("{kind: blok, width: 0.5, height: 2}", (".kind", "enum")),
        ("{width: 0.5, height: 2}", ("", "required")),
        ("{kind: block, width: -1, height: 2}", (".width", "minimum")),
        (
            "{kind: block, width: 1, height: 4, one_sided: maybe}",
            (".one_sided", "type"),
        ),
        (
            "{kind: spire, base_radius: 1.5, height: 12, crack: across}",
            (".crack", "enum"),
        ),
        (
            "{kind: stack, pieces: [{width: 1, heigth: 4}]}",
            (".pieces.0.heigth", "additionalProperties"),
        ),
        (
            "{kind: prism, corners: [[0, 0], [1, 0, 3], [1, 4]]}",
            (".corners.1", "maxItems"),
        ),
        (
            "{kind: frame, columns: 2.5, width: 1, height: 5, cap_ratio: 1}",
            (".columns", "multipleOf"),
        ),
        (
            "{kind: wall, thickness: 1, height: 3, mass: 3, ties: [{stiffness: 1}]}",
            (".ties.0", "anyOf"),
        ),
        (
            "{kind: arch, radius: 10, angle: 3, thickness: 1, mass: 2}",
            (".mass", "additionalProperties"),
        ),
        (
            "{kind: block, width: 1, height: 4, friction: {static: 0, kinetic: 0.3}}",
            (".friction.static", "exclusiveMinimum"),
        ),
        (
            "{kind: block, width: 1, height: 4, friction: {static: 0.3 m, kinetic: 1}}",
            (".friction.static", "pattern"),
        ),
        (
            "{kind: block, width: 1, height: 4, friction: {static: 1}}",
            (".friction", "required"),
        ),
        (
            "{kind: block, width: 1, height: 4, friction: -0.3}",
            (".friction", "exclusiveMinimum"),
        ),
        (
            "{kind: block, width: 1, height: 4, mass: 9 t, strength: 2 kN, depth: 1}",
            (".strength", "pattern"),
        ),
        ("{kind: drum, radius: 1, height: 4, top: held}", (".top", UNKNOWN)),
        ("{kind: wall, thickness: 1, height: 4, top: hold}", (".top", "enum")),
        (
            "{kind: wall, thickness: 1, height: 4, top: held, crack_height: -1}",
            (".crack_height", "exclusiveMinimum"),
        ),
        (
            loads("weight: 2 kN, bearing: left, inertia: both"),
            (".loads.0.bearing", "enum"),
        ),
        (loads("weight: 2 kN, bearing: far"), (".loads.0", "anyOf")),
        (loads("bearing: far, inertia: none"), (".loads.0", "anyOf")),
        (loads("mass: 2, at: [0], inertia: none"), (".loads.0.at", "minItems")),
    ],
)
def test_a_bad_document_is_refused_by_both(schema, text, fault):
    assert fault in list(faults(schema, yaml.safe_load(text)))
    with pytest.raises(DocumentError):
        build_structure(documents(text)[0])


MECHANISM = """
kind: mechanism
bodies: {one: {corners: [[0, 0], [1, 0], [1, 4], [0, 4]], density: 1800}}
joints: [{hinge: [ground, one], at: [1, 0]}]
loads: [{body: one, at: [0.5, 4], weight: 2 kN, inertia: vertical}]
other_side: mirrored
"""


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("density: 1800", "density: 1800, colour: 2", (".bodies.one.colour", UNKNOWN)),
        ("density: 1800", "density: 1800 m", (".bodies.one.density", "pattern")),
        (", density: 1800", "", (".bodies.one", "anyOf")),
        ("[[0, 0], [1, 0]", "[[0, 0], [1]", (".bodies.one.corners.1", "minItems")),
        ("{one: {", "[{", (".bodies", "type")),
        (", at: [1, 0]", "", (".joints.0", "anyOf")),
        ("hinge: [ground, one]", "hing: [ground, one]", (".joints.0.hing", UNKNOWN)),
        ("hinge: [ground, one]", "slide: [one]", (".joints.0.slide", "type")),
        ("hinge: [ground, one]", "hinge: one", (".joints.0.hinge", "type")),
        ("joints: [", "joints: [] # [", (".joints", "minItems")),
        ("body: one, ", "", (".loads.0", "anyOf")),
        ("inertia: vertical", "inertia: sideways", (".loads.0.inertia", "enum")),
        ("weight: 2 kN", "weight: 0", (".loads.0.weight", "exclusiveMinimum")),
        ("mirrored", "mirorred", (".other_side", "enum")),
        ("other_side: mirrored", "crack_height: 2", (".crack_height", UNKNOWN)),
    ],
)
def test_a_bad_mechanism_is_refused_by_both(schema, old, new, fault):
    assert list(faults(schema, yaml.safe_load(MECHANISM))) == []
    build_structure(documents(MECHANISM)[0])
    assert old in MECHANISM
    text = MECHANISM.replace(old, new)
    if new == "[{":
        text = text.replace("1800}}", "1800}]")
    assert fault in list(faults(schema, yaml.safe_load(text)))
    with pytest.raises(DocumentError):
        build_structure(documents(text)[0])


def test_it_uses_only_keywords_that_the_check_knows(schema):
    known = {*CHECKS, "$ref", "allOf", "anyOf", "if", "then", "else", "items"}
    known |= {
        "properties",
        "additionalProperties",
        "description",
        "patternErrorMessage",
    }
    known |= {"$schema", "title", "definitions"}

    def keywords(one):
        yield from one
        for key in ("properties", "definitions"):
            for inner in one.get(key, {}).values():
                yield from keywords(inner)
        inner = [one[key] for key in ("items", "if", "then", "else") if key in one]
        for other in (*inner, *one.get("allOf", ()), *one.get("anyOf", ())):
            yield from keywords(other)

    assert set(keywords(schema)) <= known
    block = schema["definitions"]["block"]["properties"]
    assert block["width"]["description"] == "full width at the base"
