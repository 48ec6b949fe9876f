"""Tables that are wider than the terminal: every block says which row it is."""

import pytest

from rocking_cli.reports import tables

BLOCKS = [f"block:{width}x2" for width in (0.4, 0.5, 0.6, 0.7)]
SHAKEN = ("--a-g", "0.35g", "--f-g", "1.5")
# by the linear equation, which is quicker
STATED = "parameters:name=Stated,p=2.67,alpha=0.245,eta=0.9,lambda=0.25"
FRAGILITY = (
    "fragility",
    STATED,
    *("--pulses", "configs/motions/site_pulses.csv", "--levels", "0.2g:0.45g:4"),
    *("--bootstrap", "0", "--hazard", "configs/hazard.csv"),
)
CALLS = [
    (("check", *BLOCKS, *SHAKEN, "--verdict-only"), ["structure", "motion"]),
    (
        (
            "check",
            "block:0.5x2",
            "--vary",
            "width=0.4:0.7:4",
            *SHAKEN,
            "--verdict-only",
        ),
        ["structure", "motion"],
    ),
    (
        ("check", *BLOCKS, *SHAKEN, "--verdict-only", "--code", "ntc2018"),
        ["structure", "motion"],
    ),
    (("params", *BLOCKS), ["name"]),
    (("params", "block:0.5x2", "--vary", "width=0.4:0.7:4"), ["name"]),
    (("records", "a.csv", "b.csv", "c.csv", "d.csv", "--unit", "g"), ["name"]),
    (("envelope", STATED, "--grid", "f_g=1:1.5:3"), ["structure", "Omega", "A_from"]),
    (FRAGILITY, ["structure", "limit_state", "method"]),
    (
        (*FRAGILITY[:-2], "--curve", "--limit", "overturning"),
        ["structure", "limit_state", "method", "x [g]"],
    ),
    (("response", "block:0.5x2", *SHAKEN, "--forces", "--dt", "0.2"), ["t [s]"]),
    (
        ("response", "block:0.5x2", *SHAKEN, "--forces", "--events"),
        ["model", "event", "t [s]"],
    ),
    (
        ("compare", *BLOCKS[:2], "--A", "2", "--Omega", "4", "--curves"),
        ["structure", "model", "t [s]"],
    ),
]


@pytest.mark.parametrize(("call", "keys"), CALLS, ids=lambda x: " ".join(x)[:40])
def test_every_block_begins_with_the_key_columns_of_the_command(
    rocking, tmp_path, monkeypatch, call, keys
):
    monkeypatch.setattr(tables, "WIDTH", 60)
    for name in "abcd":
        (tmp_path / f"{name}.csv").write_text(
            "t [s],a [g]\n0,0\n0.1,0.1\n0.2,-0.1\n0.3,0\n"
        )
    done = rocking(*call, "-q")
    assert done.returncode == 0, done.stderr
    blocks = [block.splitlines() for block in done.stdout.split("\n\n")]
    assert len(blocks) > 1
    assert max(len(line) for block in blocks for line in block) <= 60
    assert len({len(block) for block in blocks}) == 1
    columns = {tuple(line.split("  ")[0] for line in block) for block in blocks}
    assert len(columns) == 1  # the first key stands in every line
    for heading, *_ in blocks:
        assert "".join(heading.split()).startswith("".join("".join(keys).split()))
