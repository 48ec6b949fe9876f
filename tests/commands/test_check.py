"""`rocking check` at the shell."""

import math

import numpy as np
import pytest
from support.record_layouts import at2, of_a_station, wave
from support.soak import quick
from support.synthetic_records import noise

from rocking_cli import load_structures, nonlinear_response, sine
from rocking_cli.envelopes.capacity import Capacity

# which the linear equation governs, which is quicker
STATED = "parameters:p=2.1,alpha=0.2,eta=0.8,lambda=0.2,name=stated"
THREE = (
    "block:0.4x2,name=Slender",
    "block:1x2,name=Stocky,friction=0.3",
    STATED.replace("lambda=0.2", "lambda=0.25"),
)
SHAKING = ("--a-g", "0.35g", "--f-g", "1.2")


def test_a_row_a_structure_the_weakest_first(rocking):
    done = rocking("check", *THREE, *SHAKING, "--json", "--sort", "capacity")
    rows = done.records
    assert [(r["structure"], r["model"], r["outcome"]) for r in rows] == [
        ("Slender", "nonlinear", "overturned_after_impact"),
        ("stated", "linear", "rocked"),
        ("Stocky", "nonlinear", "slid"),
    ]
    assert [r["capacity_demand"] < 1.0 for r in rows[:2]] == [True, False]
    for r in rows:
        if r["outcome"] != "slid":
            assert r["capacity_demand"] == pytest.approx(
                r["first_overturning_a"] / (0.35 * 9.81), rel=1e-12, abs=0
            )
        assert not {"friction", "name"} & r.keys()
        assert (
            (r["friction_needed"] is None)
            == (r["fz_min"] is None)
            == (r["structure"] == "stated")
        )
    falls, stays = rows[0], rows[2]
    assert 0.2 < falls["friction_needed"] < 0.5
    assert (stays["friction_needed"], stays["fz_min"]) == (
        pytest.approx(0.35, rel=1e-12),
        1.0,
    )
    assert "1 of 3 overturn: Slender" in done.stderr.splitlines()
    assert (stays["capacity_demand"], stays["stuck_outcome"]) == (None, "no_uplift")
    assert stays["stuck_first_overturning_a"] > 5.0
    assert 0.0 < stays["slide_max"] < 0.01
    assert (
        "Stocky: slides from 0.3 g on, before it could rock (lambda 0.5)" in done.stderr
    )


def test_the_verdict_alone(rocking):
    searched, alone = (
        rocking("check", *THREE, *SHAKING, "--json", *more).records
        for more in ((), ("--verdict-only",))
    )
    found_by_search = dict.fromkeys(
        ("first_overturning_a", "capacity_demand", "safe_to", "searched_to")
    )
    for row in searched:
        if row["outcome"] == "slid":
            row["stuck_first_overturning_a"] = None
    assert alone == [row | found_by_search for row in searched]


def test_a_fall_during_which_the_ground_would_have_to_pull_is_told(rocking):
    stocky = "block:radius=2.8376,alpha=0.756,restitution=0.933,damping=0.02"
    done = rocking(
        "check",
        stocky,
        "--a-g",
        "2.1447g",
        "--omega-g",
        "4.83072",
        "--cycles",
        "4.5",
        "--verdict-only",
        "--json",
    )
    assert (done.record["outcome"], done.record["fz_min"] < 0.0) == (
        "overturned_after_impact",
        True,
    )
    assert "lose contact with the ground during their fall" in done.stderr


def test_the_table_speaks_the_unit_of_the_request(rocking):
    in_g, in_si = (
        rocking(
            "check", STATED, "--a-g", a, "--f-g", "1.2", "--columns", "uplift_a"
        ).stdout
        for a in ("0.35g", "3.4335")
    )
    assert (in_g, in_si) == (
        "uplift_a [g]\n         0.2\n",
        "uplift_a [m/s2]\n          1.962\n",
    )
    assert (
        rocking("check", STATED, *SHAKING, "--csv").stdout.splitlines()[0]
        == "structure,motion,model,outcome,capacity_demand,first_overturning_a [m/s2]"
        ",uplift_a [m/s2],top_displacement [m],theta_ratio,demand_a [m/s2],safe_to"
        " [m/s2],searched_to [m/s2],outcome_linear,friction_needed,fz_min,omega_g"
        " [rad/s]"
    )


def test_the_demand_is_a_column_and_both_readings_of_a_bare_number_are_told(rocking):
    record = ("--motion", "configs/motions/synthetic.at2", "--scale-to", "PGA=0.4")
    call = ("check", "configs/block.yaml", *record, "--verdict-only", "--json")
    done = rocking(*call, "--notes")
    assert done.stderr.splitlines()[:2] == [
        "demand: PGA 0.4 m/s2 = 0.0408 g",
        "PGA=0.4: 0.4 without a unit is 0.4 m/s2 = 0.0408 g; 0.4 g would be 3.924 m/s2",
    ]
    assert done.record["demand_a"] == pytest.approx(0.4, rel=1e-12)
    done = rocking(
        "response",
        "configs/block.yaml",
        "--a-g",
        "0.35g",
        "--f-g",
        "1.5",
        "--events",
        *("--json", "--notes"),
    )
    assert done.stderr.splitlines()[0] == "demand: a_g 3.4335 m/s2 = 0.35 g, f_g 1.5 Hz"
    assert "without a unit" not in done.stderr
    assert done.records[-1]["demand_a"] == pytest.approx(0.35 * 9.81, rel=1e-12)


def test_a_row_a_structure_and_record(rocking, tmp_path):
    for n, peak in enumerate((2.0, 4.0)):
        (tmp_path / f"r{n}.csv").write_text(
            "".join(
                f"{0.3 * i:.1f},{peak * x}\n"
                for i, x in enumerate((0, 1, 1, 0, -1, -1, 0))
            )
        )
    call = ("check", STATED, "--motion", "r0.csv", "r1.csv", "--unit", "m/s2", "--json")
    done = rocking(*call, "--a-max", "2.1")
    rows = done.records
    assert [r["motion"] for r in rows] == ["r0", "r1"]
    assert rows[0]["first_overturning_a"] == pytest.approx(
        rows[1]["first_overturning_a"], rel=1e-12
    )
    assert rows[0]["capacity_demand"] == pytest.approx(
        2.0 * rows[1]["capacity_demand"], rel=1e-12
    )
    assert [r["capacity_demand"] < 1.0 for r in rows] == [False, True]
    assert "1 of 2 overturn: stated under r1" in done.stderr.splitlines()
    first, second = rocking(*call, "--a-g", "2.2", "--verdict-only").records
    assert first["outcome"] == second["outcome"]
    assert first["theta_ratio"] == pytest.approx(second["theta_ratio"], rel=1e-12)


def test_a_body_that_leaves_the_ground_does_not_pass_and_linear_is_wrong_of_it(rocking):
    call = (
        "check",
        "block:1.6x2,restitution=0.6",
        "--a-g",
        "1.85g",
        "--f-g",
        "1.144",
        "--a-max",
        "1",
    )
    done = rocking(*call, "--fail-on", "overturning", "--json")
    assert (done.returncode, done.record["outcome"], done.record["outcome_linear"]) == (
        5,
        "lost_contact",
        "rocked",
    )
    assert (
        "0 of 1 overturn, 1 loses contact\nlose contact with the ground" in done.stderr
    )
    assert "stand by the linear equation, which is wrong: block" in done.stderr


def test_a_negative_amplitude_turns_records_over_too(rocking, tmp_path):
    (tmp_path / "a.txt").write_text("0\n4\n-3\n1\n0\n")
    call = (
        "check",
        "wall:1.2x8,one_sided=true",
        "--motion",
        "a.txt",
        "--unit",
        "m/s2",
        "--dt",
        "0.3",
        "--verdict-only",
        "--json",
    )
    turned, scaled = (
        rocking(*call, "--a-g=-0.3g"),
        rocking(*call, "--a-g", "0.3g", "--scale", "-1"),
    )
    assert turned.returncode == scaled.returncode == 0, turned.stderr + scaled.stderr
    assert turned.stdout == scaled.stdout != rocking(*call, "--a-g", "0.3g").stdout


def test_a_record_of_a_set_goes_with_the_vertical_one(rocking, refused, tmp_path):
    """A row is the response to the record and the vertical one."""
    for name, peak in (("n", 0.28), ("up", 0.14)):
        (tmp_path / f"{name}.at2").write_text(
            at2([peak * x for x in (0, 1, 1, 0, -1, -1, 0)], 0.2)
        )
    with_up = (
        "block:0.5x2",
        "--motion",
        "n.at2",
        "--vertical",
        "up.at2",
        "--vertical-scale",
        "0.4",
        "--json",
    )
    row = rocking("check", *with_up, "--verdict-only").record
    assert row["motion"].startswith("n with up")
    (tmp_path / "up.txt").write_text(
        "".join(f"{9.81 * 0.14 * x:.6f}\n" for x in (0, 1, 1, 0, -1, -1, 0))
    )  # the same, in m/s2
    in_columns = (
        "block:0.5x2",
        "--motion",
        "n.at2",
        "--vertical-scale",
        "0.4",
        "--json",
        "--verdict-only",
        "--vertical",
    )
    assert "give it as `--vertical FILE,unit=`" in refused(
        3, "check", *in_columns, "up.txt"
    )
    stated = "up.txt,unit=m/s2,dt=0.2 s"
    plain = rocking("check", *in_columns, stated).record
    assert (plain["outcome"], plain["fz_min"]) == (
        row["outcome"],
        pytest.approx(row["fz_min"], rel=1e-5),
    )
    last = rocking(
        "response", *with_up, "--model", "nonlinear", "--forces", "--events"
    ).records[-1]
    assert row["outcome"] == last["outcome"]
    assert (row["friction_needed"], row["fz_min"]) == pytest.approx(
        (last["friction_needed"], last["fz_min"]), rel=1e-9
    )
    # the push downwards lifts it, as far as the weight is less there: a = lambda (g -
    # a/5)
    assert row["uplift_a"] == pytest.approx(0.25 * 9.81 / (1.0 + 0.25 * 0.2), rel=1e-12)
    assert "two records, or none" in refused(
        2, "check", "block:0.5x2", "--motion", "n.at2", "--vertical", "sine"
    )


def test_a_directory_gives_both_horizontal_components_and_the_station_its_vertical(
    rocking, tmp_path
):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "a.txt").write_text(
        of_a_station(wave(60, 900.0), wave(60, 200.0), wave(60, 90.0), dt=0.1)
    )
    call = ("check", "block:0.5x2", "--verdict-only", "--json", "--motion")
    rows = rocking(*call, "set", "--vertical", "station").records
    assert [r["motion"].split(" with")[0] for r in rows] == ["a N-S", "a E-W"]
    named = (
        "--component",
        "N-S",
        "--vertical",
        "set/a.txt,component=U-D",
    )
    assert rocking(*call, "set/a.txt", *named).record == rows[0]

    (tmp_path / "set" / "b.csv").write_text("0 0\n0.1 1\n0.2 0\n")
    done = rocking("check", STATED, "--motion", "set", "--verdict-only", "-q", "--csv")
    assert (
        done.returncode,
        len(done.stdout.splitlines()),
        done.stderr.count("\n"),
    ) == (4, 3, 1)
    assert (
        rocking(
            "check",
            STATED,
            "--motion",
            "set",
            "--scale",
            "9",
            "--verdict-only",
            "--fail-on",
            "overturning",
        ).returncode
        == 5
    )


def test_the_limit_of_the_search_is_written_as_for_an_envelope(rocking):
    """0.3 g is A = 1.5 of a body that lifts at 0.2 g; neither reaches its first
    overturning.
    """
    call = ("check", STATED, "--a-g", "0.1g", "--f-g", "1.2", "--a-max")
    both = [rocking(*call, most, "--json").record for most in ("0.3g", "1.5")]
    for row in both:
        assert row.pop("searched_to") == pytest.approx(0.3 * 9.81, rel=1e-12)
    assert both[0] == both[1]
    assert both[0]["first_overturning_a"] is None


def test_a_body_that_nothing_overturns_has_a_capacity_above_the_limit_of_the_search(
    rocking,
):
    """The search goes up to A = 1.5, which is 0.3 g, and to twice a larger demand."""
    call = (
        "check",
        STATED,
        "--f-g",
        "1.2",
        "--a-max",
        "1.5",
        "--columns",
        "capacity_demand,searched_to",
    )
    for a_g, shown, to in (
        ("0.1g", "> 3", "0.3"),
        ("0.09g", "> 3.333", "0.3"),
        ("0.16g", "> 2", "0.32"),
    ):
        _, line = rocking(*call, "--a-g", a_g).stdout.splitlines()
        assert line.split() == [*shown.split(), to]
    row = rocking(*call[:-2], "--a-g", "0.1g", "--json").record
    assert (row["capacity_demand"], row["searched_to"]) == (
        None,
        pytest.approx(0.3 * 9.81, rel=1e-12),
    )
    assert "> " not in rocking(*call[:-2], "--a-g", "0.1g", "--verdict-only").stdout
    assert (
        rocking(*call[:-2], "--a-g", "0.1g", "--csv").rows[0]["capacity_demand"] == ""
    )


def test_a_varied_value_is_a_column_and_members_without_a_solution_are_left_out(
    rocking,
):
    call = ("check", "block:0.5x2,name=B", *SHAKING, "--verdict-only", "--vary", "")
    done = rocking(*call[:-1], "width=40cm:300cm:2", "--json")
    (row,), (message, *_) = done.records, done.stderr.splitlines()
    assert (row["varied_width"], row["structure"], done.returncode) == (
        0.4,
        "B width=40cm",
        4,
    )
    assert message.startswith("no solution for width [cm] = 300: block:0.5x2,name=B: ")
    alone = rocking(*call[:1], "block:0.4x2,name=B", *call[2:-2], "--json").records
    assert [{**row, "structure": "B"}] == [
        {"varied_width": 0.4, **one} for one in alone
    ]
    header = rocking(
        *call[:-1], "width=40cm:60cm:2", "--vary", "damping=0:0.1:2", "--csv"
    ).stdout.splitlines()
    assert (header[0].split(",")[:3], len(header)) == (
        ["varied_width [m]", "varied_damping", "structure"],
        5,
    )


@pytest.mark.slow
def test_a_stack_has_a_row_for_each_interface_and_one_that_falls_fails_the_check(
    rocking, tmp_path
):
    """Two rigid bodies that open at both interfaces, integrated by another program: the
    statue falls at 1.5 to 4 g. The stack as one body on its base, where it lifts first,
    stands up to 4.1 g.
    """
    stack = tmp_path / "statue.yaml"
    stack.write_text(
        "kind: stack\npieces: [{width: 1, height: 4}, {width: 0.1, height: 0.38}]"
    )
    motion = ("--a-g", "1.5g", "--f-g", "2.5", "--json", "--fail-on", "overturning")
    done = rocking("check", str(stack), *motion)
    assert done.returncode == 5
    rows = {row.pop("structure"): row for row in done.records}
    (alone,) = rocking("check", "block:0.1x0.38", *motion).records
    assert (rows["statue"]["outcome"], rows["statue"]["capacity_demand"] > 2.0) == (
        "rocked",
        True,
    )
    for key in ("uplift_a", "first_overturning_a", "friction_needed", "fz_min"):
        assert rows["statue on piece 1 from below"][key] == pytest.approx(
            alone[key], rel=1e-9
        ), key
    assert "1 of 2 overturn: statue on piece 1 from below" in done.stderr

    wider = rocking(
        "check",
        str(stack),
        *motion,
        "--vary",
        "pieces.0.width=0.5:1.2:2",
        "--verdict-only",
    ).records
    assert [row["structure"].partition(" pieces")[0] for row in wider] == [
        "statue",
        "statue on piece 1 from below",
        "statue",
        "statue on its base",
    ]
    squat = "kind: stack\npieces: [{width: 3, height: 0.5}, {width: 0.4, height: 2}]"
    rows = rocking("check", "-", *motion, "--verdict-only", stdin=squat).records
    assert len(rows) == 1


@pytest.mark.parametrize(
    "more",
    [
        "other_interfaces: null",
        "other_interfaces: []",
        "structure_kind: stack\ninterfaces: [{on: its base}]",
    ],
)
def test_stated_parameters_without_other_interfaces_are_one_structure(rocking, more):
    stated = f"kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\nlambda: 0.2\n{more}"
    assert (
        rocking(
            "check",
            "-",
            "--a-g",
            "0.5g",
            "--f-g",
            "1",
            "--verdict-only",
            "--json",
            stdin=stated,
        )
        .record["outcome"]
        .startswith("over")
    )


@pytest.mark.slow
def test_commands_over_many_motions_follow_each_interface_of_a_stack(rocking, tmp_path):
    (tmp_path / "statue.yaml").write_text(
        "kind: stack\npieces: [{width: 1, height: 4}, {width: 0.1, height: 0.38}]"
    )
    stack, first, again = (
        str(tmp_path / file) for file in ("statue.yaml", "first.h5", "again.h5")
    )
    names, axes = (
        ("statue", "statue on piece 1 from below"),
        ("--grid", "a_g=0.2g:0.8g:3,f_g=2.5"),
    )
    traced = rocking("envelope", stack, "--grid", "f_g=2.5", "--a-max", "1g", "--json")
    assert {row["structure"] for row in traced.records} == {*names}
    assert "followed on one interface, as if no other opened" in traced.stderr
    assert tuple(structure.name for structure in load_structures(stack)) == names
    stated = rocking("params", stack, "--json")
    assert rocking("params", "-", "--json", stdin=stated.stdout).record == stated.record
    motion = ("--a-g", "1.5g", "--f-g", "2.5", "--json", "--verdict-only")
    piped = rocking(
        "check", "-", *motion, "--vary", "eta=0.9:0.9:1", stdin=stated.stdout
    ).records
    assert [(row["structure"], row["outcome"]) for row in piped] == [
        *zip(
            (f"{name} eta=0.9" for name in names),
            ("rocked", "overturned_no_impact"),
            strict=True,
        )
    ]
    rocking("spectrum", stack, *axes, "-o", first)
    rocking(
        "spectrum",
        "-",
        *axes,
        "-o",
        again,
        stdin=rocking("info", first, "--documents").stdout,
    )
    cells = rocking("convert", first).rows
    assert cells == rocking("convert", again).rows
    assert [(row["structure"], row["outcome"]) for row in cells] == [
        *[("statue", outcome) for outcome in ("no_uplift", "rocked", "rocked")],
        *[
            ("statue on piece 1 from below", outcome)
            for outcome in ("no_uplift", "overturned_after_impact", "rocked")
        ],
    ]
    pulses = ("--pulses", "configs/motions/site_pulses.csv", "--levels", "0.5g,0.6g")
    cells = rocking("fragility", stack, *pulses, "--cells", "--json").records
    assert list(dict.fromkeys(row["structure"] for row in cells)) == [*names]


def test_a_tie_of_a_body_at_rest_is_said_to_be_not_stretched(rocking):
    done = rocking(
        *("check", "configs/wall_tied.yaml", "--a-g", "0.02g", "--f-g", "1"),
        *("--verdict-only", "--notes"),
    )
    assert "tie 1 elastic, not stretched, at its prestress of 5000 N" in done.stderr


def test_csv_has_the_columns_of_ties_that_the_first_structure_lacks(rocking):
    call = (
        "check",
        "configs/block.yaml",
        "configs/wall_tied.yaml",
        "--vary",
        "height=6:6:1",
        *SHAKING,
        "--verdict-only",
    )
    (free, tied), records = (
        rocking(*call, "--csv").rows,
        rocking(*call, "--json").records,
    )
    assert (free["tie_state"], tied["tie_state"], tied["tie_force"]) == (
        "",
        "elastic",
        str(records[1]["tie_force"]),
    )
    assert set(records[1]) <= {heading.partition(" [")[0] for heading in tied}


@pytest.mark.slow
def test_the_effect_of_an_inset_on_the_least_capacity_is_told(rocking):
    bodies = ("block:0.5x2,name=B", "block:0.5x2,name=B,inset=25mm")
    plain, worn = (
        rocking("check", text, *SHAKING, "--inset-effect", "--json", "--notes")
        for text in bodies
    )
    least = [done.records[0]["first_overturning_a"] for done in (plain, worn)]
    taken = f"{100 - 100 * least[1] / least[0]:.2g} %"
    message = (
        "B: pivots 25 mm inside the edges (5 % of the width: rounding, wear) would"
        f" take {taken} of the capacity"
    )
    assert message in plain.stderr.splitlines()
    assert "inside the edges" not in worn.stderr
    assert "--inset-effect: no body has a capacity that worn edges lower" in worn.stderr
    hint = "worn or rounded edges lower the capacity: --inset-effect shows by how much"
    stands = rocking("check", "block:0.5x2", "--a-g", "0.3g", "--f-g", "2", "--notes")
    assert hint in stands.stderr
    assert hint not in rocking("check", bodies[0], *SHAKING).stderr  # it falls


@pytest.mark.slow
def test_the_worst_azimuth_of_two_components(rocking, refused, tmp_path):
    (tmp_path / "a.txt").write_text(
        of_a_station(wave(20, 300.0), wave(20, 200.0), wave(20, 90.0), dt=0.1)
    )
    call = (
        "check",
        "block:0.5x2,name=A",
        "block:0.5x2,name=B,one_sided=true",
        "--motion",
        "a.txt",
        "--verdict-only",
    )
    done = rocking(*call, "--azimuth", "0:180:7", "--json", "--notes")
    first, second = done.records
    assert first["azimuth"] == pytest.approx(math.radians(30.0))  # tan 33.7 deg = 2/3
    assert second["azimuth"] % math.pi == pytest.approx(first["azimuth"])
    assert "both signs of each azimuth, because the sides differ: B" in done.stderr
    alone = rocking(
        "response",
        "block:0.5x2",
        "--motion",
        "a.txt",
        "--azimuth",
        "30deg",
        "--events",
        "--json",
    ).records[-1]
    assert alone["theta_ratio"] == pytest.approx(first["theta_ratio"], rel=1e-9)
    assert (
        "worst at an end of the azimuths" not in done.stderr
    )  # 0 to 180 deg are all directions
    part = rocking(*call, "--azimuth", "60:90:2")
    assert "worst at an end of the azimuths, 60 deg: A" in part.stderr
    assert "--a-g does not go with --azimuth" in refused(
        2, *call, "--azimuth", "0:180:7", "--a-g", "1"
    )
    assert "found 1 horizontal component" in refused(
        2, *call, "--azimuth", "0:180:7", "--component", "N-S"
    )


@pytest.mark.slow
def test_the_worst_frequency_of_a_range_is_exact(rocking):
    """The row is that of the check at the worst frequency."""
    motion = ("--pulse", "cosine", "--a-max", "4")
    done = rocking(
        "check",
        STATED,
        "--a-g",
        "0.1g",
        "--T-g",
        "1.2:1.4",
        *motion,
        "--json",
        "--notes",
    )
    row = done.record
    there = rocking(
        "check",
        STATED,
        "--a-g",
        "0.1g",
        "--f-g",
        repr(row["worst_f_g"]),
        *motion,
        "--json",
    ).record
    of_range = ("worst_f_g", "worst_f_g_end", "largest_f_g")
    apart = (*of_range, "theta_ratio", "top_displacement")
    assert {k: x for k, x in row.items() if k not in apart} == {
        k: x for k, x in there.items() if k not in apart
    }
    assert row["worst_f_g_end"] == "lower"
    assert "demand: a_g 0.981 m/s2 = 0.1 g, f_g 0.71429 to 0.83333 Hz" in done.stderr
    assert (
        "worst_f_g 0.7329 Hz"
        in rocking(
            "check", STATED, "--a-g", "0.26g", "--f-g", "0.7:0.75", "--verdict-only"
        ).stdout
    )


@pytest.mark.parametrize(
    "more",
    quick([(), ("--verdict-only",)], ("--verdict-only",)),
    ids=["searched", "alone"],
)
def test_rotation_and_displacement_are_the_largest_of_the_range(rocking, more):
    """The least amplitude is that of 0.5 Hz, where the body rocks to 0.168 of alpha.
    No frequency of a raster of 2 % rocks it further than that of the row.
    """
    body = ("block:0.4x1.8", "--a-g", "0.25g")
    row = rocking("check", *body, "--f-g", "0.5:5", *more, "--json").record
    there = rocking(
        "check", *body, "--f-g", repr(row["largest_f_g"]), "--verdict-only", "--json"
    ).record
    for key in ("theta_ratio", "top_displacement"):
        assert row[key] == pytest.approx(there[key], rel=1e-9)
    (structure,) = load_structures(body[0])
    omegas = math.tau * np.geomspace(0.5, 5.0, 116) / structure.p
    amplitude = np.full(116, structure.dimensionless_amplitude(0.25 * 9.81))
    raster = nonlinear_response(
        sine(), amplitude, omegas, structure.eta, structure.alpha
    )
    most = float(raster.theta_ratio.max())
    assert most * (1.0 - 1e-9) <= row["theta_ratio"] <= most * (1.0 + 1e-3)
    if not more:
        assert (row["worst_f_g"], row["worst_f_g_end"]) == (0.5, "lower")


@pytest.mark.soak
def test_the_threshold_of_slow_motions_is_that_of_the_body_not_of_the_range(rocking):
    found = [
        rocking(
            "check", "block:0.4x1.8", "--a-g", "0.25g", "--f-g", f, "--a-max", "1.3"
        )
        for f in ("0.45:1", "0.5:1.5")
    ]
    said = {done.stderr.partition("worse (")[2].partition(" Hz")[0] for done in found}
    assert said == {"0.419"}
    stands, falls = (
        rocking(*("check", "block:0.4x1.8", "--a-g", "0.25g", "--json"), *more).record
        for more in (("--verdict-only", "--f-g", f) for f in ("0.42", "0.419"))
    )
    assert stands["outcome"] == "rocked"
    assert falls["outcome"].startswith("overturned")


def test_a_body_that_slides_leaves_a_range_to_the_others(rocking):
    """It slides furthest at the lowest frequency, by 1/f2."""
    slider, other = "block:0.6x1.5,friction=0.2", "block:0.4x1.8"
    shaking = ("--a-g", "0.25g", "--verdict-only", "--json")
    done = rocking("check", other, slider, *shaking, "--f-g", "0.5:5")
    alone = rocking("check", other, *shaking, "--f-g", "0.5:5").record
    at_the_end, twice = (
        rocking("check", slider, *shaking, "--f-g", f).record for f in ("0.5", "1")
    )
    rocks, slides = done.records
    assert rocks == alone
    assert (slides["outcome"], slides["worst_f_g"]) == ("slid", 0.5)
    assert slides["slide_max"] == at_the_end["slide_max"]
    assert slides["slide_max"] == pytest.approx(4.0 * twice["slide_max"], rel=1e-12)
    assert f"further under slower motions (by 1/f2): {slider[:13]}" in done.stderr


@pytest.mark.slow
def test_a_demand_that_overturns_at_some_frequency_is_not_called_safe(rocking):
    """At the frequency of the least overturning amplitude, 0.9 Hz, the block stands in
    its safe window under this amplitude.
    """
    alone, ranged = (
        rocking(
            "check",
            "block:0.5x2,restitution=0.7",
            "--a-g",
            "0.6g",
            "--f-g",
            f,
            "--json",
        ).record
        for f in ("0.9", "0.9:1.6")
    )
    assert (alone["outcome"], alone["capacity_demand"] < 1.0) == ("rocked", True)
    assert ranged["outcome"].startswith("overturned")
    assert ranged["worst_f_g"] > 0.9


@pytest.mark.parametrize(
    "more",
    quick([("--a-max", "2"), ("--verdict-only",)], ("--verdict-only",)),
    ids=["searched", "outcomes"],
)
def test_the_worst_frequency_at_an_end_of_the_range_is_told(rocking, more):
    """What is said of slower motions is what the same call finds at that frequency."""
    call = ("check", STATED, "--a-g", "0.26g", *more)
    done = rocking(*call, "--f-g", "0.8:1.2", "--json")
    assert (done.record["worst_f_g"], done.record["worst_f_g_end"]) == (
        pytest.approx(0.8),
        "lower",
    )
    line = next(line for line in done.stderr.splitlines() if "worst at" in line)
    assert line.startswith(
        "stated: worst at the lower end of the range, 0.8 Hz; slower motions are"
        " worse ("
    )
    assert line.endswith(" Hz overturns it)")
    slower = line.partition("worse (")[2].partition(" Hz")[0]
    assert (
        rocking(*call, "--f-g", slower, "--json")
        .record["outcome"]
        .startswith("overturned")
    )
    other = STATED.replace("p=2.1", "p=2.15").replace("stated", "other")
    both = rocking("check", STATED, other, *call[2:], "--f-g", "0.8:1.2").stderr
    line = next(line for line in both.splitlines() if "worst at" in line)
    where = "worst at the lower end of the range, 0.8 Hz: 2 of 2 structures"
    assert line.startswith(
        f"{where}; slower motions are worse: they overturn stated at "
    )
    assert line.endswith(" Hz, which stands in this range")
    inside = rocking(
        "check", STATED, "--a-g", "0.5g", "--f-g", "0.2:1.8", "--verdict-only", "--json"
    )
    assert (inside.record["outcome"][:10], inside.record["worst_f_g_end"]) == (
        "overturned",
        None,
    )
    assert "worst at" not in inside.stderr


NOTED = ("--json", "--notes")


@pytest.mark.parametrize(
    "more", [("--a-max", "1.2"), ("--verdict-only",)], ids=["searched", "outcomes"]
)
def test_under_a_demand_below_uplift_no_frequency_is_the_worst(rocking, more):
    """Nothing overturns up to --a-max, so that the frequencies differ in nothing."""
    done = rocking("check", STATED, "--a-g", "0.19g", "--f-g", "2:3", *more, *NOTED)
    row = done.record
    assert (row["outcome"], row["worst_f_g"], row["worst_f_g_end"]) == (
        "no_uplift",
        None,
        None,
    )
    assert (
        "no worst frequency, because the demand lifts them at none: stated"
        in done.stderr
    )
    assert "worst at" not in done.stderr


def test_a_body_below_uplift_has_the_worst_frequency_of_its_capacity(rocking):
    done = rocking("check", STATED, "--a-g", "0.19g", "--f-g", "1:1.2", "--json")
    row = done.record
    assert (row["outcome"], row["worst_f_g"], row["worst_f_g_end"]) == (
        "no_uplift",
        1.0,
        "lower",
    )
    assert (
        "stated: worst at the lower end of the range, 1 Hz; the demand lifts it at no"
        " frequency, and slower" in done.stderr
    )


@pytest.mark.parametrize("a_g", quick(["0.24g", "0.26g", "0.3g", "0.5g"], "0.26g"))
def test_outcomes_alone_over_a_range_are_those_of_the_search(rocking, a_g):
    call = ("check", STATED, "--a-g", a_g, "--f-g", "0.8:1.2", "--json")
    searched, alone = (
        rocking(*call, *more).record
        for more in (("--a-max", "2.6"), ("--verdict-only",))
    )
    assert searched["outcome"][:6] == alone["outcome"][:6]
    assert alone["first_overturning_a"] is None


@pytest.mark.slow
def test_a_search_that_takes_minutes_is_announced(rocking, tmp_path, monkeypatch):
    from rocking_cli.commands import check_demands

    monkeypatch.setattr(check_demands, "_LONG", 50)
    monkeypatch.setattr(
        "rocking_cli.responses.check.capacities",
        lambda *_: [Capacity(None, None, 1.0)],
    )
    (tmp_path / "r.at2").write_text(at2([0.0, *noise(60, 0.05, 1)], 0.05))
    call = ("check", STATED, "--motion", "r.at2", "--a-max", "1.5")
    line = (
        "a record of 60 samples: the search takes 0.0005 min or more for each structure"
        " and record; --verdict-only does without it"
    )
    assert rocking(*call).stderr.splitlines()[0] == line
    for more in (("-q",), ("--verdict-only",)):
        assert line not in rocking(*call, *more).stderr


@pytest.mark.soak
def test_falls_in_narrow_intervals_are_a_column_and_one_line(rocking, tmp_path):
    for n, seed in enumerate((1, 2)):
        rows = "".join(
            f"{0.06 * i:.2f},{x:.6f}\n" for i, x in enumerate(noise(240, 0.06, seed))
        )
        (tmp_path / f"r{n}.csv").write_text(rows)
    call = (
        "check",
        "block:0.4x2.4",
        "--motion",
        "r0.csv",
        "r1.csv",
        "--unit",
        "m/s2",
        "--a-max",
        "3",
    )
    done = rocking(*call, "--csv")
    shares = [row["falls_nearby"] for row in done.rows]
    assert any(share and 0.0 < float(share) < 1.0 for share in shares)
    assert (
        sum("falls_nearby: this share" in line for line in done.stderr.splitlines())
        == 1
    )


@pytest.mark.soak
def test_a_narrow_fall_just_above_the_demand_stays_above_it(rocking):
    """Nothing falls at or below the demand of 3.5571 m/s2; the first fall is at
    3.557199 m/s2.
    """
    call = ("check", "block:0.6x2.4", "--motion", "configs/motions/synthetic.at2")
    found = rocking(*call, "--scale-to", "PGA=3.5571m/s2", "--a-max", "0.38g", "--json")
    row = found.record
    assert (row["outcome"], row["capacity_demand"]) == ("rocked", 1.00003)
    assert row["first_overturning_a"] == row["safe_to"] == 3.5572
    assert row["falls_nearby"] > 0.0
    assert "safe window" not in found.stderr


@pytest.mark.slow
def test_the_opposite_direction_of_a_body_with_one_side_is_told(rocking):
    """The row is that of the stated sign; the line tells what the same call with
    --scale -1 prints as its outcome.
    """
    call = (
        "check",
        "block:0.5x2,one_sided=true",
        "--a-g",
        "0.6g",
        "--f-g",
        "1",
        "--verdict-only",
    )
    there, opposite = (
        rocking(*call, *more, "--json") for more in ((), ("--scale", "-1"))
    )
    outcomes = [
        done.record["outcome"].startswith("overturned") for done in (there, opposite)
    ]
    assert sorted(outcomes) == [False, True]
    for more in ((), ("--scale", "-1")):
        assert rocking(*call, *more, "--fail-on", "overturning").returncode == 5
    for done, falls in zip((there, opposite), reversed(outcomes), strict=True):
        assert (
            f"unequal sides: {'overturns' if falls else 'does not overturn'}"
            " block:0.5x2" in done.stderr
        )
    assert "opposite" not in rocking("check", "block:0.5x2", *call[2:]).stderr
    tied = (
        "block:0.5x2,name=T,mass=2000,ties=[{height: 1.8, stiffness: 2e5, ultimate: 30"
        " mm, yield: 2 kN, side: right}]"
    )
    done = rocking(
        "check",
        tied,
        "--a-g=-0.42g",
        "--f-g",
        "1.5",
        "--verdict-only",
        "--fail-on",
        "overturning",
        "--json",
    )
    assert (
        done.returncode,
        done.record["outcome"],
        "unequal sides: overturns T" in done.stderr,
    ) == (5, "rocked", True)


@pytest.mark.soak
def test_in_a_range_the_capacity_is_that_of_the_worse_direction(rocking):
    """It is the lesser one of both directions at the worst frequency."""
    body = ("check", "rigid:left=0.42,right=0.31,height=1.15,gyration=0.68")
    ranged = (*body, "--a-g", "0.4g", "--f-g", "1.2:1.22")
    found = [
        rocking(*ranged, *more, "--json").record
        for more in (("--scale", "-1"), ("--sign", "both"))
    ]
    capacities = [one["capacity_demand"] for one in found]
    assert capacities[1] == pytest.approx(capacities[0], rel=1e-9)
    there = (*body, "--a-g", "0.4g", "--f-g", repr(found[0]["worst_f_g"]))
    both = rocking(*there, "--sign", "both", "--json").records
    least = min(one["capacity_demand"] for one in both)
    assert capacities[0] == pytest.approx(least, rel=1e-9)


def test_in_a_range_the_worse_direction_of_unequal_sides_counts(rocking):
    """A body that the stated direction does not overturn falls; where neither does, the
    larger rotation counts.
    """
    ranged = ("check", "block:0.5x2,one_sided=true", "--a-g", "0.6g", "--f-g", "1:2")
    for scale in ("1", "-1"):
        more = ("--verdict-only", "--scale", scale, "--fail-on", "overturning")
        done = rocking(*ranged, *more, "--json", "--notes")
        assert done.returncode == 5
        assert done.record["outcome"].startswith("overturned")
        assert "worse of both directions" in done.stderr

    wall = ("check", "wall:0.4x2.2,one_sided=true", "--pulse", "ricker-symmetric")
    more = ("--a-g", "0.36g", "--f-g", "1.6:1.7", "--json", "--verdict-only")
    row = rocking(*wall, *more).record
    assert row["motion"] == "symmetric Ricker times -1"
    assert row["outcome"] == "rocked"


def test_a_further_hinge_of_an_arch_is_named(rocking):
    call = (
        "check",
        "configs/block.yaml",
        "configs/arch.yaml",
        "--a-g",
        "0.4g",
        "--f-g",
        "1",
        "--verdict-only",
    )
    done = rocking(*call, "--csv")
    assert [line.rpartition(",")[2] for line in done.stdout.splitlines()] == [
        "opens",
        "",
        "True",
    ]
    assert (
        "open a further hinge (see response --forces), so that another mechanism"
        " follows: Oppenheim" in done.stderr
    )


def test_columns_are_checked_before_anything_is_computed_and_choose_those_of_csv(
    rocking, refused, monkeypatch
):
    call = ("check", "block:0.5x2", "--a-g", "0.3g", "--f-g", "1.5", "--verdict-only")
    family = (*call, "--vary", "width=0.4:0.5:2", "--columns")
    done = rocking(*family, "varied_width,outcome,safe_to", "--csv")
    assert done.stdout.splitlines()[0] == "varied_width [m],outcome,safe_to [m/s2]"
    assert [row[1:] for row in map(tuple, (r.values() for r in done.rows))] == [
        ("rocked", ""),
        ("rocked", ""),
    ]
    record = rocking(*call, "--columns", "theta_ratio,outcome", "--json").record
    assert list(record) == ["theta_ratio", "outcome"]

    def never(*_, **__):
        raise AssertionError("computed")

    monkeypatch.setattr("rocking_cli.responses.check.verdicts", never)
    said = refused(2, *family, "width")
    assert "--columns: found 'width' (did you mean 'varied_width'?)" in said
    # known, though these rows do not have it: no row is slid
    assert "found 'slide_max'" in refused(2, *family, "slide_max", "--csv")


def test_of_many_bodies_that_fall_the_first_are_named(rocking, tmp_path):
    rows = [f"block,b{i},0.4,2.4" for i in range(14)]
    (tmp_path / "many.csv").write_text("\n".join(["kind,name,width,height", *rows]))
    done = rocking(
        "check", "many.csv", "--a-g", "0.35g", "--f-g", "1.5", "--verdict-only"
    )
    names = ", ".join(f"b{i}" for i in range(10))
    assert f"14 of 14 overturn: {names} and 4 more\n" in done.stderr


STATUES = "\n".join(
    [
        "name,kind,width [m],height [m],room,inventory number",
        *(f"Statue {i},block,{0.3 + i / 20:g},2.1,hall,A {i}" for i in range(3)),
    ]
)


def test_people_see_one_block_of_80_columns_and_a_line_of_verdict(rocking, tmp_path):
    (tmp_path / "m.csv").write_text(STATUES)
    demand = ("--pulse", "rectangular", "--a-g", "0.2g", "--f-g", "1:2")
    few, every = (
        rocking("check", "m.csv", *demand, *more)
        for more in (
            ("--a-max", "1.3"),
            ("--a-max", "1.1", "--notes", "--columns", "all"),
        )
    )
    above, blank, *table = few.stdout.splitlines()
    assert above.startswith("room hall; motion rectangular; demand_a 0.2 g")
    assert (blank, max(map(len, table)) <= 80) == ("", True)
    words = (
        "structure outcome capacity_ demand first_ overturning_ uplift_ displacement"
    )
    assert set(words.split()) <= set(" ".join(table[:-3]).split())
    assert [line.split()[1] for line in table[-3:]] == ["0", "1", "2"]
    verdict, *others = few.stderr.splitlines()
    assert verdict == "2 of 3 overturn: Statue 0, Statue 1"
    assert all(line.startswith("worst at the ") for line in others)
    assert len(others) <= 1
    assert "outcome_linear" in every.stdout
    assert "model: nonlinear" in every.stderr
    assert "intervals narrower than" in every.stderr
    header = rocking(
        *("check", "m.csv", *demand, "--verdict-only", "-q", "--csv"), "--columns=all"
    ).stdout
    assert "outcome_linear" in header.splitlines()[0]
