"""Lists of structures as CSV."""

import csv
import io
import time
from dataclasses import replace

import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.documents.table import rows_of_structures

HEAD = ["name", " kind ", "width [cm]", "height (m)", "one_sided", "pieces_1_width [mm]", "pieces_1_height", "pieces_2_radius",
        "pieces_2_height", "corners"]  # fmt: skip
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
    "name: C\nkind: stack\npieces: [{width: 1.2, height: 0.9}, {radius: 0.3, height: 2}]",
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
    documents = parse_documents("kind,width,height\nblock,1,5\nblock,1,6\n", "towers.csv")
    assert [build_structure(d).name for d in documents] == ["towers", "towers-2"]


def test_the_csv_of_parameters_is_a_list_of_structures(rocking, tmp_path):
    kinds = ["arch", "block", "stack", "spire_cracked", "wall", "parameters"]
    first = rocking("params", *(f"configs/{kind}.yaml" for kind in kinds), "--csv", "--units", "deg").stdout
    (tmp_path / "p.csv").write_text(first)
    again = rocking("params", "p.csv", "--json")
    assert again.returncode == 0, again.stderr
    whole = rocking("params", *(f"configs/{kind}.yaml" for kind in kinds), "--csv").stdout
    direct = rocking("params", *(f"configs/{kind}.yaml" for kind in kinds), "--json").stdout
    assert rocking("params", "-", "--json", stdin=whole).stdout == direct
    assert '"alpha": 0.0690646' in again.stdout.splitlines()[0]


REFUSED = [
    ("kind,width\nblock,1,2", "f.csv:2:3: found 3 cells; expected 2"),
    ("kind,width [furlong]\nblock,1", "f.csv:2:2: width: found the unit 'furlong' in the heading; expected one of m, mm"),
    ("kind,width [kg]\nblock,1", "f.csv:2:2: width: found 1 kg; expected a length"),
    ("kind,width,width\nblock,1,2", "f.csv:1:3: duplicate column 'width'"),
    ("kind,\nblock,1", "f.csv:1:2: a column without a name"),
    ("kind,width [cm],height\n\nblock,x,2", "f.csv:3:2: width: found x; expected a length"),
    ('kind,width\n"block,1', "f.csv:2:1: not valid CSV"),
    ("kind,name\n", "f.csv:1:1: empty"),
    ("kind,pieces_2_width\nstack,1", "f.csv:2:2: pieces_2_width: found item 2; expected items in order, from pieces_1"),
    ("kind,pieces,pieces_1_width\nstack,[[3]],1", "f.csv:2:3: pieces_1_width: found together with pieces"),
    ("kind,pieces,pieces_1_width\nstack,3,1", "f.csv:2:3: pieces_1_width: found item 1"),
    ("kind,corners\nprism,[[0", "f.csv:2:2: corners: found ..0; expected a list"),
]
test_refusals = refuses(lambda text: [build_structure(d) for d in parse_documents(text, "f.csv")], DocumentError, REFUSED)
OTHERS = ["kind: block\nwidth: 1\nheight: 5", '{"kind": "block", "width": 1}', "t;a", "kind\nblock", "# kind, width"]


@pytest.mark.parametrize("text", OTHERS)
def test_other_texts_are_no_tables(text):
    assert rows_of_structures(text, "f.csv") is None


def test_items_may_come_in_any_order_of_columns():
    one, two = (
        parse_documents(f"kind,{columns}\nstack,{cells}", "f.csv")[0]
        for columns, cells in (
            ("pieces_1_width,pieces_2_width,pieces_1_height,pieces_2_height", "1,0.4,0.5,2"),
            ("pieces_1_width,pieces_1_height,pieces_2_width,pieces_2_height", "1,0.5,0.4,2"),
        )
    )
    assert build_structure(one) == build_structure(two)


def test_lengths_of_two_rows_do_not_mix():
    one, two = parse_documents("kind,width [cm],height\nblock,50,2\nblock,0.5 m,2", "f.csv")
    assert replace(build_structure(one), name="x") == replace(build_structure(two), name="x")


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
        DocumentError, match=rf"f.csv:1:1: CSV without a column 'kind'; found {found}; expected a heading such as kind,name,width"
    ):
        parse_documents(text, "f.csv")


@pytest.mark.parametrize(
    "text", ["kind: arch\nhinges: [1, 2,\n 3, 4]", "# a, b\n# c, d\nkind: block", "{kind: block,\nwidth: 1, height: 2}"]
)
def test_yaml_with_commas_is_no_list(text):
    assert parse_documents(text)[0].values["kind"].content in ("arch", "block")


def test_a_list_of_many_columns_is_read_once():
    began = time.process_time()
    (document,) = parse_documents("kind," + ",".join(f"c{i}" for i in range(200_000)) + "\nblock\n")
    assert list(document.values) == ["kind"]
    assert time.process_time() - began < 20.0  # 0.5 s; a minute where each column is held against all before
