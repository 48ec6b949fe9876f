"""Lists of structures as CSV."""

import csv
import io
import json
import time
from dataclasses import replace

import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.documents.table import rows_of_structures
from rocking_cli.documents.texts import Text

HEAD = [
    "name",
    " kind ",
    "width [cm]",
    "height (m)",
    "one_sided",
    "pieces_1_width [mm]",
    "pieces_1_height",
    "pieces_2_radius",
    "pieces_2_height",
    "corners",
]
ROWS = [
    HEAD,
    ["A", "block", "50", "2"],
    ['B, the "second"', "block", "0.4 m", "3", "TRUE"],
    [],
    ["C", "stack", "", "", "", "1200", "0.9", "0.3", "2", ""],
    ["D", "prism", *[""] * 7, "[[0, 0], [1, 0], [0.5, 3]]"],
]
AS_YAML = [
    "name: A\nkind: block\nwidth: 0.5\nheight: 2",
    "name: 'B, the \"second\"'\nkind: block\nwidth: 0.4\nheight: 3\none_sided: true",
    (
        "name: C\nkind: stack\npieces: [{width: 1.2, height: 0.9}, {radius: 0.3,"
        " height: 2}]"
    ),
    "name: D\nkind: prism\ncorners: [[0, 0], [1, 0], [0.5, 3]]",
]


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("line", ["\n", "\r\n"])
def test_a_row_is_the_document_that_it_states(delimiter, line):
    text = io.StringIO()
    csv.writer(text, delimiter=delimiter, lineterminator=line).writerows(ROWS)
    found = [build_structure(d) for d in parse_documents(text.getvalue(), "f.csv")]
    assert found == [built(text) for text in AS_YAML]


def test_names_are_by_file_and_row_where_there_are_none():
    documents = parse_documents(
        "kind,width,height\nblock,1,5\nblock,1,6\n", "towers.csv"
    )
    assert [build_structure(d).name for d in documents] == ["towers", "towers-2"]


def test_the_csv_of_parameters_is_a_list_of_structures(rocking, tmp_path):
    kinds = ["arch", "block", "stack", "spire_cracked", "wall", "parameters"]
    first = rocking(
        "params", *(f"configs/{kind}.yaml" for kind in kinds), "--csv", "--units", "deg"
    ).stdout
    (tmp_path / "p.csv").write_text(first)
    again = rocking("params", "p.csv", "--json")
    assert again.returncode == 0, again.stderr
    whole = rocking(
        "params", *(f"configs/{kind}.yaml" for kind in kinds), "--csv"
    ).stdout
    direct = rocking(
        "params", *(f"configs/{kind}.yaml" for kind in kinds), "--json"
    ).stdout
    assert rocking("params", "-", "--json", stdin=whole).stdout == direct
    assert '"alpha": 0.0690646' in again.stdout.splitlines()[0]


REFUSED = [
    ("kind,width\nblock,1,2", "f.csv:2:3: found 3 cells; expected 2"),
    (
        "kind,width [furlong]\nblock,1",
        (
            "f.csv:2:2: width: found the unit 'furlong' in the heading; expected one of"
            " m, mm"
        ),
    ),
    ("kind,width [kg]\nblock,1", "f.csv:2:2: width: found 1 kg; expected a length"),
    ("kind,width,width\nblock,1,2", "f.csv:1:3: duplicate column 'width'"),
    ("kind,\nblock,1", "f.csv:1:2: a column without a name"),
    (
        "kind,width [cm],height\n\nblock,x,2",
        "f.csv:3:2: width: found x; expected a length",
    ),
    ('kind,width\n"block,1', "f.csv:2:1: not valid CSV"),
    ("kind,name\n", "f.csv:1:1: empty"),
    (
        "kind,pieces_2_width\nstack,1",
        (
            "f.csv:2:2: pieces_2_width: found item 2; expected items in order, from"
            " pieces_1"
        ),
    ),
    (
        "kind,pieces,pieces_1_width\nstack,[[3]],1",
        "f.csv:2:3: pieces_1_width: found together with pieces",
    ),
    (
        "kind,pieces,pieces_1_width\nstack,3,1",
        "f.csv:2:3: pieces_1_width: found item 1",
    ),
    ("kind,corners\nprism,[[0", "f.csv:2:2: corners: found ..0; expected a list"),
]
test_refusals = refuses(
    lambda text: [build_structure(d) for d in parse_documents(text, "f.csv")],
    DocumentError,
    REFUSED,
)
OTHERS = [
    "kind: block\nwidth: 1\nheight: 5",
    '{"kind": "block", "width": 1}',
    "t;a",
    "kind\nblock",
    "# kind, width",
]


@pytest.mark.parametrize("text", OTHERS)
def test_other_texts_are_no_tables(text):
    assert rows_of_structures(Text.of(text, "f.csv")) is None


def test_items_may_come_in_any_order_of_columns():
    one, two = (
        parse_documents(f"kind,{columns}\nstack,{cells}", "f.csv")[0]
        for columns, cells in (
            (
                "pieces_1_width,pieces_2_width,pieces_1_height,pieces_2_height",
                "1,0.4,0.5,2",
            ),
            (
                "pieces_1_width,pieces_1_height,pieces_2_width,pieces_2_height",
                "1,0.5,0.4,2",
            ),
        )
    )
    assert build_structure(one) == build_structure(two)


def test_lengths_of_two_rows_do_not_mix():
    one, two = parse_documents(
        "kind,width [cm],height\nblock,50,2\nblock,0.5 m,2", "f.csv"
    )
    assert replace(build_structure(one), name="x") == replace(
        build_structure(two), name="x"
    )


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("name,width,height\nA,0.5,2\n", "name, width, height"),
        ("name;width [cm];height\nA;50;2\n", "name, width, height"),
        ("\nwidth\theight\n0.5\t2\n", "width, height"),
    ],
)
def test_a_list_without_kinds_is_answered_as_csv(text, found):
    with pytest.raises(
        DocumentError,
        match=(
            rf"f.csv:1:1: CSV without a column 'kind'; found {found}; expected a"
            r" heading such as kind,name,width"
        ),
    ):
        parse_documents(text, "f.csv")


TITLES = [
    (
        "Collection of room 7,,,\nname,kind,width [cm],height [cm]\nA,block,42,170\n",
        "f.csv:1:1: CSV: line 1 is no heading; line 2 looks like one: delete the lines",
    ),
    (
        "# from the museum\nRoom 7: large\n\nKind;width;height\nblock;0,5;2\n",
        "f.csv:2:1: CSV: line 2 is no heading; line 4 looks like one: delete the lines",
    ),
    (
        "Name,Kind,Width [cm],Height [cm]\nA,block,42,170\n",
        "f.csv:1:1: CSV without a column 'kind'; found Name, Kind, Width, Height"
        " (did you mean 'kind'?); expected a heading such as kind,name,width",
    ),
]
test_a_title_and_a_heading_in_capitals_are_answered_as_csv = refuses(
    lambda text: parse_documents(text, "f.csv"), DocumentError, TITLES, literal=True
)


@pytest.mark.parametrize(
    "text",
    [
        "kind: block\nname: 'old,\nkind, grey'",
        "kind: arch\nhinges: [1, 2,\n 3, 4]",
        "# a, b\n# c, d\nkind: block",
        "{kind: block,\nwidth: 1, height: 2}",
    ],
)
def test_yaml_with_commas_is_no_list(text):
    assert parse_documents(text)[0].values["kind"].content in ("arch", "block")


@pytest.mark.soak
def test_a_list_of_many_columns_is_read_once():
    began = time.process_time()
    (document,) = parse_documents(
        "kind," + ",".join(f"c{i}" for i in range(200_000)) + "\nblock\n"
    )
    assert list(document.values) == ["kind"]
    assert (
        time.process_time() - began < 20.0
    )  # 0.5 s; a minute where each column is held against all before


# Forms in which spreadsheets and programs write one table: heading and rows A 0.45 m x
# 2 m, B 0.5 m x 2 m.
FORMS = {
    "semicolons": "kind;name;width;height\nblock;A;0,45;2\nblock;B;0,5;2,0\n",
    "tabs": "kind\tname\twidth\theight\nblock\tA\t0,45\t2\nblock\tB\t0,5\t2\n",
    "blanks": "kind  name  width  height\nblock A   0,45  2\nblock B   0,5   2\n",
    "separator stated": (
        "sep=;\r\nkind;name;width;height\r\nblock;A;0,45;2\r\nblock;B;0.5;2\r\n"
    ),
    "quoted": (
        '"kind", "name", "width [cm]", "height"\n"block", "A", "45", "2"\n"block", "B",'
        ' "50", "2"\n'
    ),
    "comments": (
        "# of the museum\n\n#"
        " 1998\nkind,name,width,height\nblock,A,0.45,2\nblock,B,0.5,2\n"
    ),
    "empty columns": (
        "kind;name;width;height;;\nblock;A;0,45;2;;\nblock;B;0,5;2;;\n;;;;;\n"
    ),
    "unit in cells": "kind;name;width;height\nblock;A;0,45 m;2\nblock;B;50 cm;2\n",
    "lines of old Macs": "kind;name;width;height\rblock;A;0,45;2\rblock;B;0,5;2\r",
}


@pytest.mark.parametrize("text", FORMS.values(), ids=FORMS)
def test_one_table_in_many_forms(text):
    found = [build_structure(d) for d in parse_documents(text, "f.csv")]
    assert found == [
        built(f"kind: block\nname: {name}\nwidth: {width}\nheight: 2")
        for name, width in (("A", "0.45"), ("B", "0.5"))
    ]


DOUBTFUL = [
    (
        "kind;width;height\nblock;1,234;0.5",
        "f.csv:2:2: found 1,234 beside 0.5, so that 1,234 may be a thousand and some",
    ),
    (
        "kind;width;height\nblock;0,5;2\nblock;1.234;4",
        "f.csv:3:2: found 1.234 beside 0,5, so that 1.234 may be a thousand and some",
    ),
    (  # a width of 1.15 m or of 1.15 mm, in a column without commas
        "kind;width [mm];friction\nblock;1.150;0,6",
        "f.csv:2:2: found 1.150 beside 0,6, so that 1.150 may be a thousand and some",
    ),
    (
        'kind,width [mm],height\nblock,"1,950",2',
        (
            "f.csv:2:2: width: found 1,950; expected a length: .*; does the comma stand"
            " for thousands. write 1950, or 1.950 with a decimal point"
        ),
    ),
    (
        'kind,width,height\nblock,"0,45",2',
        (
            "f.csv:2:2: width: found 0,45; expected a length: .*; write 0.45 with a"
            " decimal point"
        ),
    ),
    (
        "kind,width,height\nblock,0,45,2",
        (
            "f.csv:2:4: found 4 cells; expected 3 .with commas in numbers, the columns"
            " need another"
        ),
    ),
    (
        "kind;width\nblock;\x01\x02",
        "f.csv:2:7: found binary data .the control character U.0001.",
    ),
]
test_numbers_of_two_meanings_are_refused = refuses(
    lambda text: [build_structure(d) for d in parse_documents(text, "f.csv")],
    DocumentError,
    DOUBTFUL,
)


def test_other_columns_are_labels_as_they_are_written():
    text = (
        "inventory;kind;width;height;room;notes (old)\n0,70;block;0,5;2;2 b;[broken:"
        " see\n;block;0,5;2;;\n"
    )
    one, two = [build_structure(d) for d in parse_documents(text, "f.csv")]
    assert one.labels == {
        "inventory": "0,70",
        "room": "2 b",
        "notes (old)": "[broken: see",
    }
    assert two.labels == {}
    assert replace(one, name="x") == replace(
        built("kind: block\nwidth: 0.5\nheight: 2"), name="x"
    )
    again = parse_documents(json.dumps(one.row()))[0]
    assert build_structure(again).labels == one.labels
    assert built("kind: block\nwidth: 1\nheight: 5\nlabels: {room: 2 b}").labels == {
        "room": "2 b"
    }


NEAR = [
    ("widht", "unknown key 'widht' .did you mean 'width'"),
    ("restitusion", "unknown key 'restitusion' .did you mean 'restitution'"),
    ("Restitution", "did you mean 'restitution'"),
    ("mass_kg", "did you mean 'mass'"),
    ("eta", "did you mean 'restitution'"),
    ("thickness", "unknown key 'thickness'"),
    ("inset [furlong]", "inset: found the unit 'furlong' in the heading"),
    ("mu", "unknown key 'mu' .did you mean 'friction'"),
    ("COF", "unknown key 'COF' .did you mean 'friction'"),
    ("COR", "unknown key 'COR' .did you mean 'restitution'"),
    ("mu static", "did you mean 'friction'"),
    ("zG", "unknown key 'zG': the place of a mass centre; expected kind rigid"),
    ("centroid height [m]", "'centroid height': the place of a mass centre"),
    ("t", "unknown key 't'; known keys of this kind: alpha"),
    ("elevation [m]", "unknown key 'elevation' with the unit m, which no label has;"),
]


@pytest.mark.parametrize(("column", "words"), NEAR)
def test_a_column_like_a_key_is_no_label(column, words):
    with pytest.raises(DocumentError, match=f"f.csv:2:4: .*{words}"):
        [
            build_structure(d)
            for d in parse_documents(
                f"kind,width,height,{column}\nblock,1,5,0.9\n", "f.csv"
            )
        ]


@pytest.mark.parametrize(
    "column",
    [
        "room",
        "location",
        "title",
        "date",
        "notes",
        "description",
        "plinth height",
        "notes (old)",
        "murals",
        "photo_1_file",
        "size",
    ],
)
def test_other_words_are_labels(column):
    (document,) = parse_documents(f"kind,width,height,{column}\nblock,1,5,x\n", "f.csv")
    assert build_structure(document).labels == {column: "x"}
