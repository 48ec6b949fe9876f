"""Documents: YAML and JSON, several in a file, and every refusal with its place."""

import itertools
import math
from contextlib import suppress

import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import (
    DocumentError,
    RockingParameters,
    build_structure,
    parse_documents,
)


def all_built(text: str) -> list[RockingParameters]:
    return [build_structure(document) for document in parse_documents(text, "f.yaml")]


def test_yaml_surprises_are_closed():
    assert built(
        "kind: block\nradius: 010\nalpha: 1e-1\nrestitution: .9"
    ).alpha == pytest.approx(0.1, rel=1e-14)
    b = built("kind: block\nradius: 010\nalpha: 1e-1\nrestitution: 9e-1\nname: no")
    assert b.p == pytest.approx(math.sqrt(3 * 9.81 / 40))
    assert (b.name, b.eta) == ("no", 0.9)


def test_several_documents_json_and_yaml():
    assert (
        built(
            '{"kind": "block", "width": 1, "height": 5, "name": "\\ud83d\\uddfc"}'
        ).name
        == "\U0001f5fc"
    )
    assert [
        d.index for d in parse_documents("---\nkind: block\n---\nkind: spire\n")
    ] == [0, 1]
    lines = (
        '{"kind":"block","width":1,"height":5}\n\n {"kind": "spire",\n'
        ' "base_radius":1,"height":"9 m"}\n'
    )
    assert [build_structure(d).structure for d in parse_documents(lines)] == [
        "block",
        "spire",
    ]
    assert built("{kind: block, width: 1, height: 5}").structure == "block"


LEVELS = [
    f"{b}: &{b} [{', '.join(['*' + a] * 10)}]"
    for a, b in itertools.pairwise("abcdefghij")
]
BOMB = "\n".join(["a: &a [1, 1, 1, 1, 1]", *LEVELS])  # 5e9 values in ten lines
REFUSED = [
    ("a: [", "f.yaml:1:5: not valid YAML"),
    ("? [1]\n: 2", "f.yaml:1:3: a key must be a word"),
    ("- 1\n- 2", "f.yaml:1:1: found a list; expected a mapping"),
    ("just words", "f.yaml:1:1: found just words"),
    ("width: 1", "no key 'kind'; expected kind: one of block, point_mass"),
    (
        "kind: blok",
        "f.yaml:1:7: kind: found blok; expected one of .*did you mean 'block'",
    ),
    (
        "kind: block\nwidth: 2\nheigth: 1",
        "f.yaml:3:1: unknown key 'heigth' .did you mean 'height'",
    ),
    (
        "kind: block\nwidth: 1\nheight: 5\ncolour: red",
        "f.yaml:4:1: unknown key 'colour'; known keys of this kind:",
    ),
    (
        "kind: block\nwidth: 1\nwidth: 2\nheight: 5",
        "f.yaml:3:1: duplicate key 'width', first given at line 2",
    ),
    (
        "kind: block\nwidth: 2 kg\nheight: 5",
        "f.yaml:2:8: width: found 2 kg; expected a length.*m, mm, cm",
    ),
    (
        "kind: block\nwidth: -1\nheight: 5",
        "f.yaml:2:8: width: found -1; expected a positive length",
    ),
    (
        "kind: block\nwidth: 1e999\nheight: 5",
        "found 1e999; .*range of double precision",
    ),
    ("kind: block\nwidth: no\nheight: 5", "found no; expected a length"),
    ("kind: block\nwidth: 1:30\nheight: 5", "found 1:30; expected a length"),
    ("kind: block\nwidth: [1]\nheight: 5", "found a list; expected a length"),
    ("kind: block\nwidth:\nheight: 5", "no key 'width'"),
    (
        "kind: block\nwidth: 3\nheight: 2",
        (
            "width 3 m and height 2 m, wider than high .did you swap width and"
            " height.*alpha up to 54.7 deg"
        ),
    ),
    (
        "kind: point_mass\nradius: 1\nalpha: 46 deg",
        "restitution .* alpha up to 45 deg",
    ),
    (
        "kind: block\nradius: 1\nalpha: 90 deg",
        "found 90 deg; expected an angle between 0 and 90 deg",
    ),
    (
        "kind: block\nradius: 1\nwidth: 1",
        "width and height, or radius and alpha, not both",
    ),
    (
        "kind: block\nwidth: 1\nheight: 5\nrestitution: 1.01",
        "f.yaml:4:14: restitution: found 1.01; expected a number from 0 to 1",
    ),
    (
        "kind: block\nwidth: 1\nheight: 5\nrestitution: -0.1",
        "found -0.1; expected a number from 0 to 1",
    ),
    (
        "kind: block\nwidth: 1\nheight: 5\ngravity: 0",
        "found 0; expected an acceleration from 0.01 to 10000 m/s2",
    ),
    (
        "kind: block\nwidth: 1\nheight: 5\ngravity: 1e-9",
        "f.yaml:4:10: gravity: found 1e-9; expected an acceleration from 0.01",
    ),
    (
        'kind: block\nwidth: 1\nheight: 5\nname: "a\\0b"',
        "name: found .* expected a text of printable characters",
    ),
    (
        '{"kind": "block", "width": 1, "height": 5, "name": "\\ud83d"}',
        "f.yaml:1:52: holds half a character",
    ),
    ("kind: block\n<<: {width: 1}\nheight: 5", "f.yaml:2:1: merge keys"),
    (BOMB, "too many values"),
    ("kind: parameters\np: 2\nalpha: 0.2\neta: 0.9", "neither lambda nor a_scale"),
    (
        (
            "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\nlambda:"
            " 0.2\nother_interfaces: 5"
        ),
        "other_interfaces: found 5; expected a list",
    ),
    (
        "kind: parameters\np: 2\nalpha: 0.2\neta: 1.9\nlambda: 1",
        "eta: found 1.9; expected a number from 0 to 1",
    ),
    (
        (
            '{"kind":"block","width":1,"height":5}\n{"kind":"block","width":"2'
            ' kg","height":5}'
        ),
        'f.yaml:2:25: width: found "2 kg"',
    ),
]
test_refusals_name_place_key_found_and_accepted = refuses(
    all_built, DocumentError, REFUSED
)


WRITTEN = [
    (
        '{\n  // a column\n  "kind": "block", "width": 0.5, "height": 2}',
        "f.yaml:2:3: found a comment that begins with //; expected no comment in J",
    ),
    (
        '{"kind": "block", /* wide */ "width": 0.5, "height": 2}',
        "f.yaml:1:19: found a comment that begins with /.",
    ),
    (
        "// a column\n{kind: block, width: 0.5, height: 2}",
        "f.yaml:1:1: found a comment that begins with //",
    ),
    (
        "{kind:block,width:0.5,height:2}",
        (
            "f.yaml:1:2: found 'kind:block'; expected a blank after the colon: `kind:"
            " block`"
        ),
    ),
    (
        "kind: block\nwidth:0.5\nheight: 2",
        (
            "f.yaml:3:1: not valid YAML: found 'width:0.5'; expected a blank after the"
            " colon: `width: 0.5`"
        ),
    ),
    ("kind:block\nwidth:0.5", "f.yaml:1:1: found 'kind:block'; expected a blank"),
    (
        "kind: block\nwidth: 0,45 m\nheight: 2",
        (
            "f.yaml:2:8: width: found 0,45 m; expected a length: .*; write 0.45 m with"
            " a decimal point"
        ),
    ),
    (
        '{"kind": "block", "width": 0,45, "height": 2}',
        "f.yaml:1:30: width: found 0,45; expected a number; write 0.45 with",
    ),
    (
        "{kind: block, width: 1,5 m, height: 2}",
        "f.yaml:1:24: width: found 1,5 m; expected a number; write 1.5 m",
    ),
    (
        "kind: block\nwidth: 1\nheight: 5\none_sided: yes",
        "f.yaml:4:12: one_sided: found yes; expected true or false",
    ),
]
test_what_is_written_in_another_language_is_told = refuses(
    all_built, DocumentError, WRITTEN
)


@pytest.mark.parametrize("word", ["true", "True", "TRUE"])
def test_true_is_a_word_in_any_case_in_documents_and_tables(word):
    (table,) = all_built(f"kind,name,thickness,height,one_sided\nwall,W,0.3,3,{word}\n")
    assert (
        built(f"kind: wall\nname: W\nthickness: 0.3\nheight: 3\none_sided: {word}")
        == table
    )
    assert table.one_sided


def test_a_slash_in_a_text_is_no_comment():
    assert (
        built(
            '{"kind": "block", "name": "http://a.b/*c # d", "width": 1, "height": 5}'
        ).name
        == "http://a.b/*c # d"
    )


# Patterns take the square of such a text, or a stack the depth of it, unless they are
# bounded.
@pytest.mark.parametrize("mark", " \t\n([{\"'1a.,;:=-_*#\\", ids=repr)
@pytest.mark.parametrize(
    "text",
    [
        '{{"kind": "block", "labels": {}}}',
        '{{"kind": "block", {}\\"',
        "kind,width,height,{}x\nblock,0.5,2,1\n",
        "kind  width {} x\nblock 0.5 2\n",
        "kind: block\nwidth: 0.5{}x\n",
        "{}kind:block",
    ],
)
def test_a_mark_that_goes_on_and_on_is_read_or_refused(text, mark):
    with suppress(DocumentError):
        parse_documents(text.format(20_000 * mark))


def test_a_document_of_any_depth_is_refused_in_its_place():
    text = '{"kind": "block", "labels": %s}' % ("[" * 100_000 + "]" * 100_000)
    with pytest.raises(DocumentError, match="<text>:1:48: nested too deeply"):
        parse_documents(text)


def test_a_document_that_was_read_keeps_its_own_keys_only():
    (document,) = parse_documents("{kind: block, name: A, width: 1, height: 5}")
    build_structure(document)
    assert document.asked == {*document.keys, "labels"}
