"""`rocking check -o FILE.h5`: verdicts go into a file instead of rows on standard
output.
"""

import csv
import json

import pytest

TABLE = "kind,name,width,height,room\n" + "".join(
    f"block,B{i},{0.3 + 0.1 * i:.1f},2,hall {i}\n" for i in range(3)
)
CALL = ("check", "t.csv", "--a-g", "0.35g", "--f-g", "1.5")


@pytest.fixture(autouse=True)
def table(tmp_path):
    (tmp_path / "t.csv").write_text(TABLE)


def test_the_file_holds_the_rows_that_check_prints(rocking, tmp_path):
    done = rocking(*CALL, "-o", "v.h5", "--json", "--fail-on", "overturning")
    assert done.returncode == 5
    assert done.stderr == "v.h5: 3 verdicts, 2 of them falls\n"
    counts = json.loads(done.stdout)
    assert (counts["cells"], counts["cells_overturned_after_impact"]) == (3, 2)
    printed = list(csv.DictReader(rocking(*CALL, "--csv").stdout.splitlines()))
    held = list(csv.DictReader(rocking("convert", "v.h5").stdout.splitlines()))
    assert [row["label_room"] for row in held] == [row["room"] for row in printed]
    for one, other in zip(held, printed, strict=True):
        same = {key for key in one.keys() & other.keys() if one[key] == other[key]}
        assert same >= {
            *("structure", "motion", "outcome", "outcome_linear", "capacity_demand"),
            *("theta_ratio", "uplift_a [m/s2]", "top_displacement [m]", "fz_min"),
        }
    info = rocking("info", "v.h5", "--json", "--verify")
    assert json.loads(info.stdout)["complete"] == "yes"


def test_the_file_of_a_family_holds_the_varied_values(rocking):
    family = ("block:0.5x2", "--vary", "height=2:3:2", "--verdict-only")
    rocking("check", *family, *CALL[2:], "-o", "v.h5")
    held = csv.DictReader(rocking("convert", "v.h5").stdout.splitlines())
    assert [row["varied_height"] for row in held] == ["2.0", "3.0"]


REFUSED = [
    (("-o", "v.h5", "--sort", "capacity"), "--sort does not go with -o FILE.h5"),
    (("-o", "v.h5", "--where", "theta_ratio < 1"), "--where does not go with"),
    (("-o", "v.h5", "--fail-on", "slide=1mm"), "--fail-on overturning alone"),
    (("-o", "v.h5", "--f-g", "1:2"), "does not go with a range of frequencies"),
    (("--resume",), "--resume goes with -o FILE.h5"),
    (("--shard", "1/2"), "--shard goes with -o FILE.h5"),
    (("-o", "v.h5", "--shard", "3/2"), "--shard: found '3/2'"),
]


@pytest.mark.parametrize(("more", "words"), REFUSED)
def test_what_a_table_of_verdicts_does_not_hold_is_refused(
    rocking, tmp_path, more, words
):
    call = CALL[:4] if "--f-g" in more else CALL
    done = rocking(*call, *more)
    assert done.returncode == 2
    assert words in done.stderr
    assert not list(tmp_path.glob("v.h5*"))


def test_a_table_that_exists_is_not_replaced(rocking, tmp_path):
    (tmp_path / "v.h5").write_text("mine")
    done = rocking(*CALL, "-o", "v.h5")
    assert done.returncode == 2
    assert "v.h5: exists; use --overwrite" in done.stderr
    assert (tmp_path / "v.h5").read_text() == "mine"
