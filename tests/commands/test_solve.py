"""`rocking solve` at the shell: what it finds is right by itself."""

from itertools import cycle

import pytest

from rocking_cli import Outcome, load_structures, parse_grid, sine
from rocking_cli.envelopes.amplitudes import Limit
from rocking_cli.envelopes.withstanding import withstand
from rocking_cli.errors import UsageError
from rocking_cli.responses.check import Standing, standings
from rocking_cli.responses.shaken import capacity_search

SHAKING = ("--a-g", "0.4g", "--f-g", "1")


@pytest.mark.slow
def test_the_value_found_is_that_from_which_the_check_finds_the_margin(rocking):
    shaking = ("--pulse", "rectangular", "--a-g", "0.35g", "--T-g", "0.5")
    call = (
        "solve",
        "block:50cmx2m,name=Pier",
        "--vary",
        "width=55:65:2",
        "--margin",
        "1.2",
        *shaking,
    )
    found = rocking(*call, "--json").record
    assert (found["structure"], found["key"], found["side"]) == (
        "Pier",
        "width",
        "stands above",
    )
    assert found["value"] == float(f"{found['value']:.6g}")
    widths = found["value"] - 1e-6, found["value"]
    falls, stands = (
        rocking("check", f"block:{width}x2", *shaking, "--json").record[
            "capacity_demand"
        ]
        for width in widths
    )
    assert (
        falls < 1.2 <= stands == pytest.approx(found["capacity_demand"], rel=1e-8)
    )  # the tolerance is 1e-9


@pytest.fixture
def judged(monkeypatch):
    """A function that makes the capacity under each motion a function of the varied
    value, mostly the height.
    """

    def by(*capacities):
        def standings(demands, **_):
            heights = [
                next(iter(structure.details["varied"].values()))
                for structure, _, _ in demands
            ]
            found = [
                capacity(h)
                for capacity, h in zip(cycle(capacities), heights, strict=False)
            ]
            return [Standing(Outcome.ROCKED, c, 0.0) for c in found]

        def withstand(searches, margin, **_):
            demands = [(one.structure, one.motion, None) for one in searches]
            return [one.capacity_demand >= margin for one in standings(demands)]

        solving = "rocking_cli.responses.solving"
        monkeypatch.setattr(f"{solving}.standings", standings)
        monkeypatch.setattr(f"{solving}.withstand", withstand)

    return by


def test_every_boundary_of_the_range_and_a_range_without_one(rocking, judged):
    def capacity(h: float) -> float:
        return 1.0 + 0.1 * (h - 2.0) * (5.0 - h)

    judged(capacity)
    call = ("solve", "block:0.6x1", *SHAKING, "--json", "--vary")
    low, high = rocking(*call, "height=1.3:6:5").records
    assert rocking(*call, "height=6:1.3:5").records == [low, high]
    assert (low["side"], high["side"]) == ("stands above", "stands below")
    assert 2.0 <= low["value"] < 2.00002
    assert 4.99998 < high["value"] <= 5.0
    assert low["capacity_demand"] == pytest.approx(capacity(low["value"]), rel=1e-12)
    in_cm = rocking(*call[:-2], "--vary", "height=130cm:600cm:5").stdout.splitlines()
    assert [line.split()[1] for line in in_cm] == ["height", "200", "500"]
    descending = rocking(*call, "height=6:1.3:5").records
    assert [(row["value"], row["side"]) for row in descending] == [
        (row["value"], row["side"]) for row in (low, high)
    ]
    for span, side, said in (
        ("height=3:4", "everywhere", "stands"),
        ("height=6:6.5", "nowhere", "does not stand"),
    ):
        none = rocking(*call, span, "--notes")
        assert none.returncode == 0
        assert [
            (row["value"], row["side"], row["capacity_demand"]) for row in none.records
        ] == [(None, f"stands {side}", None)]
        assert f"{said} with this margin at any value of the scan" in none.stderr
        assert (
            "the scan has 17 values; two boundaries between neighbours of them may be"
            " missed" in none.stderr
        )


def test_a_share_of_the_records(rocking, judged):
    judged(lambda h: h, lambda h: 0.5 * h, lambda h: 0.25 * h)
    record = "configs/motions/synthetic.at2"
    call = (
        "solve",
        "block:0.6x9",
        "--motion",
        record,
        record,
        record,
        "--vary",
        "height=0.8:9:7",
        "--margin",
        "1.5",
        "--json",
        "--notes",
    )
    for share, value in (("1", 6.0), ("0.9", 6.0), ("0.66", 3.0), ("0.3", 1.5)):
        done = rocking(*call, "--share", share)
        assert done.record["value"] == pytest.approx(value, rel=5e-6)
        # the line of check
        assert "intervals narrower than 0.1 % of the amplitude (0.01" in done.stderr


def test_values_without_a_structure_are_named_and_nothing_is_claimed_of_them(
    rocking, judged
):
    """A height is no negative one, and the capacity is known of positive ones only."""
    judged(lambda h: 0.8 * h)
    done = rocking(
        "solve", "block:0.6x1", *SHAKING, "--vary", "height=-1:2:4", "--json"
    )
    assert (done.returncode, done.record["value"]) == (4, pytest.approx(1.25, rel=1e-5))
    assert done.stderr.count("no solution for height = ") == 2
    none = rocking(
        "solve", "block:0.6x1", *SHAKING, "--vary", "height=-2:-1:2", "--json"
    )
    assert (none.returncode, none.stdout, "at any value" in none.stderr) == (
        4,
        "",
        False,
    )


@pytest.mark.parametrize(
    ("capacity", "value", "side"),
    [
        (lambda h: h / 0.75, 0.75, "stands above"),
        (lambda h: 0.75 / h, 0.75, "stands below"),
        (lambda _: 2.0, None, "stands at 2 of 4 values"),
        (lambda _: 0.5, None, "falls at 2 of 4 values"),
    ],
)
def test_the_search_goes_on_to_the_first_value_that_has_a_structure(
    rocking, judged, capacity, value, side
):
    """The least height of a block is 0.6 m/sqrt(2) = 0.424264 m, the first one with a
    structure of the scan 1 m.
    """
    judged(capacity)
    call = ("solve", "block:0.6x1", *SHAKING, "--vary", "height=-1:2:4", "--json")
    done = rocking(*call)
    assert (done.returncode, done.record["side"]) == (4, side)
    assert done.record["value"] == (value and pytest.approx(value, rel=2e-6))
    assert "there is a structure from height = 0.42426" in done.stderr
    assert "any value" not in done.stderr


def test_the_search_goes_on_to_the_first_value_that_has_a_verdict(rocking, judged):
    """As near the thinnest arch, where no equation holds."""

    def capacity(h: float) -> float:
        if h < 0.6:
            raise UsageError("no equation holds")
        return h / limit

    judged(capacity)
    call = ("solve", "block:0.6x1", *SHAKING, "--vary", "height=0:2:3", "--json")
    limit = 0.75
    assert rocking(*call).record["value"] == pytest.approx(0.75, rel=2e-6)
    limit = 0.5
    done = rocking(*call)
    assert done.record["side"] == "stands at 2 of 3 values"
    assert (
        "there is a structure from height = 0.424265, and a verdict from height ="
        " 0.6, where it stands" in done.stderr
    )


@pytest.mark.soak
def test_an_arch_too_thin_for_its_weight_never_counts_as_standing(rocking, judged):
    """0.55 m carries no weight, whatever the capacity of what carries it."""
    judged(lambda thickness: thickness / 0.7)
    call = ("solve", "arch:10x1.5x157.5deg,voussoirs=4", "--a-g", "0.3g", "--f-g", "2")
    row = rocking(*call, "--json", "--vary", "thickness=0.55:0.8:2").record
    assert (row["side"], row["value"]) == ("stands above", 0.7)


@pytest.mark.soak
def test_a_continuous_arch_too_thin_for_its_weight_never_counts_as_standing(rocking):
    """0.6375 m carries no weight, 0.70 m overturns, 0.80625 m stands; the value is that
    of thickness=0.65:0.9:2, whose ends both exist.
    """
    call = ("solve", "arch:10x1.5x157.5deg", "--a-g", "0.3g", "--f-g", "2", "--json")
    row = rocking(*call, "--vary", "thickness=0.6375:0.80625:2").record
    assert (row["side"], row["value"]) == ("stands above", 0.728096)


def test_both_directions_are_those_of_the_weaker_one(rocking, judged, monkeypatch):
    """Of a body whose right edge is nearer; check has a row for each of its directions,
    and one for a body that is alike.
    """
    statue, asked = (
        "rigid:left=0.6,right=0.4,height=2,gyration=0.9",
        ("--a-g", "0.35g", "--f-g", "1", "--json"),
    )
    found = {}
    for sign, capacities in (
        ("+", [lambda h: h]),
        ("both", [lambda h: h, lambda h: 0.5 * h]),
    ):
        judged(*capacities)
        found[sign] = rocking(
            "solve", statue, "--vary", "height=0.5:4:7", "--sign", sign, *asked
        )
    assert [done.record["value"] for done in found.values()] == pytest.approx(
        [1.0, 2.0], rel=1.1e-5
    )
    monkeypatch.undo()
    assert "one direction of the motion only" in found["+"].stderr
    assert "the other --sign gives the opposite one" in found["+"].stderr
    assert "one direction" not in found["both"].stderr
    rows = {
        sign: rocking(
            "check", statue, "block:0.5x2", "--sign", sign, "--verdict-only", *asked
        )
        for sign in ("+", "-", "both")
    }
    assert rows["both"].records == [*rows["+"].records, rows["-"].records[0]]
    assert [row["motion"] for row in rows["-"].records] == ["sine 1 cycle times -1"] * 2
    assert "opposite direction" not in rows["both"].stderr


@pytest.mark.slow
def test_the_worst_frequency_of_a_range_counts(rocking):
    """The value has the capacity that check finds at the worst frequency; just below it
    the body does not stand.
    """
    body, at = (
        "parameters:p={},alpha=0.2,eta=0.8,lambda=0.2",
        ("--a-g", "0.5g", "--f-g", "0.7:0.72"),
    )
    call = ("solve", body.format(2), *at, "--vary", "p=1.09:1.1:2")
    done = rocking(*call, "--json", "--notes")
    row = done.record
    assert (row["side"], row["capacity_demand"]) == (
        "stands below",
        pytest.approx(1.0, abs=1e-4),
    )
    found = [
        rocking("check", body.format(row["value"] * x), *at, "--json").record
        for x in (1.0, 1.0 + 1e-4)
    ]
    assert found[0]["capacity_demand"] == pytest.approx(
        row["capacity_demand"], rel=1e-9
    )
    assert found[0]["capacity_demand"] >= 1.0 > found[1]["capacity_demand"]
    assert "f_g 0.7 to 0.72 Hz" in done.stderr
    end = (
        "the worst frequency at this boundary is the lower end of the range, 0.7 Hz;"
        " slower motions may overturn it"
    )
    assert (end in done.stderr) == (found[0]["worst_f_g_end"] == "lower")


@pytest.mark.slow
def test_a_stack_stands_if_it_stands_on_each_of_its_interfaces(rocking, tmp_path):
    """The piece on top is what falls: by itself it needs the same width."""
    stack = "kind: stack\npieces: [{width: 3, height: 4}, {width: 0.1, height: 0.38}]"
    motion = ("--a-g", "0.5g", "--f-g", "2.5", "--pulse", "rectangular", "--json")
    of_stack = rocking(
        "solve", "-", *motion, "--vary", "pieces.1.width=0.15:0.19:2", stdin=stack
    ).record
    alone = rocking(
        "solve", "block:0.1x0.38", *motion, "--vary", "width=0.15:0.19:2"
    ).record
    assert (of_stack["side"], of_stack["value"]) == ("stands above", alone["value"])


@pytest.mark.slow
def test_csv_states_the_unit_of_the_value(rocking, judged):
    judged(lambda width: width / 0.6)
    call = (
        "solve",
        "configs/block.yaml",
        "--vary",
        "width=50cm:80cm:3",
        "--a-g",
        "0.4g",
        "--f-g",
        "1",
        "-q",
    )
    heading, row = rocking(*call, "--csv").stdout.splitlines()
    assert heading == "structure,key,value [m],side,capacity_demand"
    assert float(row.split(",")[2]) == pytest.approx(0.6, rel=1e-5)
    assert float(row.split(",")[2]) == rocking(*call, "--json").record["value"]
    pure = rocking(
        "solve", *call[1:2], "--vary", "restitution=0.88:0.9:2", *call[4:], "--csv"
    )
    assert pure.stdout.splitlines()[0] == "structure,key,value,side,capacity_demand"


@pytest.mark.slow
def test_a_body_that_slides_has_no_capacity_and_no_range_of_frequencies(rocking):
    """Below lambda, 0.25, the block slides, and nothing overturns it."""
    call = ("solve", "block:0.5x2", "--vary", "friction=0.2499:0.2501:2")
    call += ("--a-g", "0.4g", "--pulse", "rectangular")
    done = rocking(*call, "--T-g", "0.5", "--json")
    row = done.record
    assert (row["side"], row["capacity_demand"]) == ("stands below", None)
    assert row["value"] == 0.249999
    assert "it slides, never rocks" in done.stderr
    refused = rocking(*call, "--f-g", "1:2")
    assert refused.returncode == 2
    assert (
        "a range of frequencies does not go with a body that slides" in refused.stderr
    )


@pytest.mark.soak
def test_what_stands_up_to_the_margin_is_what_has_the_capacity():
    """Outcomes up to the margin against the capacities of `check`, also of bodies with
    two sides, with one, and with a tie.
    """
    demands, shaking = [], parse_grid("a_g=0.4g,f_g=1")
    for body in (
        "block:0.5x2",
        "block:0.65x2",
        "block:0.5x1",
        "rigid:left=0.42,right=0.31,height=1.15,gyration=0.68",
        "rigid:left=0.62,right=0.61,height=1.15,gyration=0.68",
        "wall:thickness=0.6,height=4,one_sided=true",
        "configs/wall_tied.yaml",
    ):
        demands += [(one, sine(), shaking) for one in load_structures(body)]
    reach = Limit(8.0, acceleration=True)  # twice the demand, about
    capacities = [one.capacity_demand for one in standings(demands, a_max=reach)]
    for margin in (0.7, 1.0, 1.4):
        searches = [capacity_search(*demand, 0.0) for demand in demands]
        assert withstand(searches, margin) == [
            c is None or c >= margin for c in capacities
        ]


def test_a_remark_on_a_value_has_the_unit_of_the_range(rocking):
    call = ("solve", "block:0.6x1", *SHAKING, "--vary", "height=0cm:200cm:3", "--json")
    said = rocking(*call).stderr
    assert "no solution for height = 0 cm: " in said
    assert "there is a structure from height = 42.42" in said
