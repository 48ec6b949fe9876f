"""`rocking solve` at the shell: what it finds is right by itself."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from rocking_cli import Outcome

SHAKING = ("--a-g", "0.4g", "--f-g", "1")


def test_the_value_found_is_that_from_which_the_check_finds_the_margin(rocking, tmp_path):
    (tmp_path / "b.yaml").write_text("{kind: block, name: Pier, width: 50 cm, height: 2}")
    call = ("solve", "b.yaml", "--vary", "width=50:100:3", "--margin", "1.2", *SHAKING)
    found = rocking(*call, "--json").record
    assert (found["structure"], found["key"], found["side"]) == ("Pier", "width", "stands above")
    assert found["value"] == float(f"{found['value']:.6g}")
    stands = rocking("check", f"block:{found['value']}x2", *SHAKING, "--json").record
    falls = rocking("check", f"block:{found['value'] - 1e-6}x2", *SHAKING, "--json").record
    assert falls["capacity_demand"] < 1.2 <= stands["capacity_demand"] == pytest.approx(found["capacity_demand"], rel=1e-12)
    table = dict(line.split("  ", 1) for line in rocking(*call).stdout.splitlines())
    assert float(table["width [cm]"]) == pytest.approx(100.0 * found["value"], rel=1e-12)


def test_every_boundary_of_the_range_and_a_range_without_one(rocking, monkeypatch):
    """Where the capacity is 1 + 0.1 (h - 2)(5 - h) of a height h, the body stands between 2 m and 5 m."""

    def judged(demands, **_):
        ((structure, _, _),) = demands
        h = structure.details["varied"]["height"]
        return [SimpleNamespace(outcome=Outcome.ROCKED, falls=False, capacity_demand=1.0 + 0.1 * (h - 2.0) * (5.0 - h))]

    monkeypatch.setattr("rocking_cli.responses.solving.verdicts", judged)
    call = ("solve", "block:0.6x1", *SHAKING, "--json", "--vary")
    low, high = rocking(*call, "height=1.3:6:5").records
    assert (low["side"], high["side"]) == ("stands above", "stands below")
    assert 2.0 <= low["value"] < 2.00002
    assert 4.99998 < high["value"] <= 5.0
    assert low["capacity_demand"] == pytest.approx(1.0 + 0.1 * (low["value"] - 2.0) * (5.0 - low["value"]), rel=1e-12)
    for span, said in (("height=3:4", "stands with this margin"), ("height=6:7", "does not stand with this margin")):
        none = rocking(*call, span)
        assert (none.returncode, none.stdout) == (0, "")
        assert f"{said} at any value of the range" in none.stderr


def test_a_share_of_the_records(rocking, tmp_path):
    for n, peak in enumerate((2.0, 3.0)):
        (tmp_path / f"r{n}.csv").write_text("".join(f"{0.3 * i:.1f},{peak * x}\n" for i, x in enumerate((0, 1, 1, 0, -1, -1, 0))))
    records = ("--motion", "r0.csv", "r1.csv", "--unit", "m/s2", "--vary", "width=0.3:1.1:3", "--json")
    every, half = (rocking("solve", "block:0.6x3", *records, *share).record for share in ((), ("--share", "0.5")))
    for found, peak in ((every, 3.0), (half, 2.0)):
        alone = ("check", f"block:{found['value']}x3", *records[:5], "--json")
        capacities = sorted(row["capacity_demand"] for row in rocking(*alone).records)
        assert capacities[peak == 2.0] == pytest.approx(1.0, abs=2e-6)
        assert capacities[peak == 2.0] >= 1.0
    assert half["value"] < every["value"]
