"""`rocking params` at the shell."""

import math
import re
import sys
import weakref

import pytest

from rocking_cli.documents.document import Document


def test_json_lines_are_documents_again(rocking):
    first = rocking("params", "configs/block.yaml", "configs/spire.yaml", "--json")
    records = first.records
    assert [(r["name"], r["kind"], r["structure_kind"]) for r in records] == [
        ("Column", "parameters", "block"),
        ("Spire", "parameters", "spire"),
    ]
    assert not any(
        "structure" in r for r in records
    )  # which is a name, in every other output
    assert records[0]["p"] == pytest.approx(2.6716705, abs=1e-6)
    assert rocking("params", "-", "--json", stdin=first.stdout).stdout == first.stdout


def test_every_shipped_config_has_parameters(rocking, pytestconfig):
    configs = sorted(
        f"configs/{p.name}" for p in (pytestconfig.rootpath / "configs").glob("*.yaml")
    )
    done = rocking("params", *configs, "--csv")
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 1 + len(configs)


LEANING = (
    "{kind: rigid, name: Statue, left: 0.2, right: 0.3, height: 1.2, gyration: 0.7}"
)


def test_a_table_has_a_row_for_each_side(rocking):
    lines = rocking(
        *("params", "configs/block.yaml", "-", "--details"), stdin=LEANING
    ).stdout.splitlines()
    rows = {line[:16].strip(): line[16:].split() for line in lines}
    assert [row for row in rows if row.startswith("name")] == ["name"]
    assert rows["name"] == ["Column", "Statue", "left", "edge", "right", "edge"]
    # the parameters of the edge that lifts first
    assert rows["lambda"] == ["0.25", "0.1667", "0.1667", "0.25"]
    few = rocking("params", "configs/block.yaml", "-", stdin=LEANING).stdout
    assert len(few.splitlines()) == 3


def test_csv_has_columns_for_both_sides(rocking):
    rows = rocking("params", "configs/block.yaml", "-", "--csv", stdin=LEANING).rows
    record = rocking("params", "-", "--json", stdin=LEANING).record
    assert rows[0]["left_p"] == ""
    for side in record["sides"]:
        for key in ("p", "alpha", "lambda", "a_scale", "eta"):
            assert float(rows[1][f"{side['side']}_{key}"]) == side[key]
    assert "sides" not in rows[1]


def test_a_family_has_both_sides_even_if_its_first_member_is_symmetric(rocking):
    done = rocking(
        "params",
        "-",
        "--vary",
        "left=0.3:0.2:2",
        "--vary",
        "damping=0:0.05:2",
        "--csv",
        stdin=LEANING,
    )
    rows = done.rows
    assert [row["left_lambda"] for row in rows] == ["", "", *2 * [repr(0.2 / 1.2)]]
    assert [row["right_lambda"] for row in rows] == ["", "", *2 * [repr(0.3 / 1.2)]]
    assert [row["direction"] for row in rows] == ["", "", *2 * ["over the left edge"]]
    assert [float(row["damping"]) for row in rows] == [0.0, 0.05, 0.0, 0.05]


def test_a_family_has_the_columns_of_its_later_members(rocking):
    rows = rocking(
        "params",
        "configs/block.yaml",
        "configs/wall_tied.yaml",
        "--vary",
        "height=6:7:2",
        "--csv",
    ).rows
    assert [row["ties_1_yield"] for row in rows] == ["", "", "20000.0", "20000.0"]
    assert rocking(
        "params", "block:0.5x2", "--vary", "damping=0:0.1:2"
    ).stdout.splitlines()[1].split()[:2] == ["name", "varied"]


def test_members_without_a_solution_are_reported_and_the_rest_kept(rocking):
    done = rocking("params", "configs/block.yaml", "--vary", "width=1:5:5", "--json")
    assert done.returncode == 4
    assert len(done.stdout.splitlines()) == 2
    assert done.stderr.count("no solution") == 3
    assert "Traceback" not in done.stderr


def test_a_family_in_json_is_a_stream_of_documents(rocking):
    family = rocking(
        "params", "configs/arch.yaml", "--vary", "thickness=1.6:1.8:2", "--json"
    )
    records = family.records
    assert [r["name"] for r in records] == [
        "Oppenheim thickness=1.6m",
        "Oppenheim thickness=1.8m",
    ]
    assert records[0]["varied"] == {"thickness": 1.6}
    assert rocking("params", "-", "--json", stdin=family.stdout).stdout == family.stdout


def test_a_table_has_the_interfaces_of_a_stack_and_hinges_in_degrees(rocking):
    stack = rocking(
        *("params", "configs/stack.yaml", "--details", "--columns", "name,p")
    ).stdout.splitlines()
    assert [re.split("  +", line.strip())[0] for line in stack[1:]] == [
        "Statue on a plinth",
        "on its base",
        "on piece 1 from below",
        "on piece 2 from below",
    ]
    arch = rocking("params", "configs/arch.yaml", "--details").stdout
    assert "hinges [deg]    0, 67.5, 112.5, 157.5\n" in arch


def test_csv_tells_the_units_asked_for_and_json_stays_in_si(rocking):
    plain, shown = (
        rocking("params", "configs/block.yaml", "--csv", *more).stdout.splitlines()
        for more in ((), ("--units", "deg"))
    )
    assert plain[0].split(",")[3:5] == ["p [rad/s]", "alpha [rad]"]
    assert shown[0].split(",")[3:5] == ["p [rad/s]", "alpha [deg]"]
    assert float(shown[1].split(",")[4]) == pytest.approx(
        math.degrees(math.atan(0.25)), rel=1e-14, abs=0
    )
    both = [
        rocking("params", "configs/block.yaml", "--json", *more).stdout
        for more in ((), ("--units", "deg"))
    ]
    assert both[0] == both[1]


def test_what_linear_means_at_uplift_is_said_and_chosen(rocking):
    said = rocking("params", "configs/block.yaml", "--notes")
    assert (
        said.stderr
        == "Column: the linear equation lifts it at alpha/a_scale = 0.245 g, the body"
        " at lambda = 0.25 g\n"
    )
    lifted = rocking(
        "params", "configs/block.yaml", "--linear-uplift", "lambda", "--json"
    )
    assert lifted.record["a_scale"] == pytest.approx(0.24497866 / 0.25, rel=1e-7)
    wanted = rocking(
        "envelope", "-", "--grid", "Omega=4", "--json", stdin=lifted.stdout
    )
    found = rocking(
        "envelope",
        "configs/block.yaml",
        "--linear-uplift",
        "lambda",
        "--grid",
        "Omega=4",
        "--json",
    )
    assert found.stdout == wanted.stdout


def test_default_names_hold_no_commas(rocking, tmp_path):
    (tmp_path / "a, b.yaml").write_text(
        "kind: block\nwidth: 1\nheight: 5\n---\nkind: block\nwidth: 1\nheight: 6\n"
    )
    lines = rocking(
        "params", "a, b.yaml", "block:1x7,restitution=0.9", "--csv", "-q"
    ).stdout.splitlines()
    assert [line.split(",")[0] for line in lines[1:]] == [
        "a  b",
        "a  b-2",
        "block:1x7 restitution=0.9",
    ]


MUSEUM = (
    "sep=;\r\nroom;kind;name;width [cm];height;outcome\r\n2"
    " b;block;A;45;1,9;seen\r\n;block;B;50;2,0;\r\n"
)


@pytest.mark.parametrize(
    "command", [("params",), ("check", "--a-g", "0.1g", "--f-g", "1", "--verdict-only")]
)
def test_labels_of_a_table_are_named_and_kept(rocking, tmp_path, command):
    (tmp_path / "m.csv").write_text(MUSEUM)
    name = "name" if command[0] == "params" else "structure"
    call = (command[0], "m.csv", *command[1:], "--notes")
    done = rocking(*call, "--columns", f"{name},room")
    shown = [[name, "room"], ["A", "2 b"], ["B", "-"]]
    assert [line.split(maxsplit=1) for line in done.stdout.splitlines()] == shown
    heads = rocking(*call).stdout.splitlines()[-3].split()
    assert heads[:2] == [name, "room"]
    assert "labels, not used: room, outcome (--columns shows them)" in done.stderr
    first, second = rocking(command[0], "m.csv", *command[1:], "--json").records
    assert (first["labels"], "labels" in second) == (
        {"room": "2 b", "outcome": "seen"},
        False,
    )
    rows = rocking(command[0], "m.csv", *command[1:], "--csv").rows
    own = (
        "outcome" if command[0] == "params" else "label_outcome"
    )  # check has a column of this name
    assert [(row["room"], row[own]) for row in rows] == [("2 b", "seen"), ("", "")]


def table(rows: int) -> str:
    """A table of blocks of one name, with a label."""
    body = "".join(f"block,A,0.5,{2 + i / rows},x{i}\n" for i in range(rows))
    return f"kind,name,width,height,room\n{body}"


@pytest.mark.parametrize("form", ["--csv", "--json"])
def test_a_row_of_a_table_goes_before_the_next_one_is_read(rocking, monkeypatch, form):
    met, most = [], []
    finish = Document.finish

    def counted(document, *given):
        met.append(weakref.ref(document))
        most.append(sum(one() is not None for one in met))
        finish(document, *given)

    monkeypatch.setattr(Document, "finish", counted)
    done = rocking("params", "-", form, "-q", stdin=table(30))
    assert (len(met), len(done.stdout.splitlines())) == (30, 30 + (form == "--csv"))
    assert max(most) <= 3  # the one that is read, and those that loops still name


def test_a_fault_of_the_last_row_comes_before_the_first_one(rocking):
    for form in ("--csv", "--json"):
        done = rocking("params", "-", form, stdin=table(3) + "block,A,0.5,x,\n")
        assert (done.returncode, done.stdout) == (3, "")
        assert "<stdin>:5:4: height: found x; expected" in done.stderr


@pytest.mark.soak
def test_the_work_on_a_table_grows_with_its_rows(rocking):
    """Counted in lines of Python: a search through all rows for each row shows."""

    def lines(rows: int) -> int:
        count = 0

        def trace(frame, event, argument):
            nonlocal count
            count += event == "line"
            return trace

        before = sys.gettrace()
        sys.settrace(trace)
        try:
            rocking("params", "-", "--csv", "-q", stdin=table(rows))
        finally:
            sys.settrace(before)
        return count

    lines(2)  # imports
    few, more, most = (lines(rows) for rows in (50, 150, 350))
    assert most - more == pytest.approx(2 * (more - few), rel=0.02)


@pytest.mark.parametrize("command", ["params", "check"])
def test_rows_with_faults_are_told_and_left_out_and_some_rows_are_printed(
    rocking, tmp_path, command
):
    table = tmp_path / "table.csv"
    table.write_text(
        "kind,name,room,width,height\nblock,A,1,0.5,2\nblock,B,2,x,2\nblock,C,2,1,2\n"
        "block,D,2,1,2,3\nblok,E,2,1,2\nblock,F,3,0.4,2\n"
    )
    demand = ["--a-g", "0.3g", "--f-g", "2", "--verdict-only"] * (command == "check")
    call = [command, str(table), *demand, "--json"]
    stopped = rocking(*call)
    assert (stopped.returncode, stopped.stdout) == (3, "")
    found = rocking(*call, "--skip-faulty")
    name = "structure" if command == "check" else "name"
    assert found.returncode == 4
    assert [row[name] for row in found.records] == ["A", "C", "F"]
    told = [line for line in found.stderr.splitlines() if "left out: " in line]
    places = [line.partition("table.csv:")[2].partition(":")[0] for line in told]
    assert sorted(places) == ["3", "5", "6"]
    some = rocking(*call, "--skip-faulty", "--where", "room != 2", "--sort", name)
    assert [row[name] for row in some.records] == ["A", "F"]
    refused = rocking(*call, "--skip-faulty", "--where", "rom = 2")
    assert refused.returncode == 2
    assert "--where: found 'rom'" in refused.stderr


CHECK = ("check", "--a-g", "0.35g", "--f-g", "1.5", "--verdict-only")


@pytest.mark.parametrize(
    "call", [("params", "--csv"), ("params", "--json"), (*CHECK, "--sign", "both")]
)
def test_what_waits_on_the_disk_is_the_same(rocking, monkeypatch, call):
    call = (*call, "configs/block.yaml", "configs/prism.yaml")
    held = rocking(*call)
    monkeypatch.setattr("rocking_cli.packed._HELD", 1)
    monkeypatch.setattr("rocking_cli.packed._TOGETHER", 1)
    packed = rocking(*call)
    assert packed.stdout == held.stdout != ""
    assert packed.stderr == held.stderr
