"""What a body stands on, at the shell: sliding, a toe that crushes, a floor."""

import h5py
import pytest

SYNTHETIC = "configs/motions/synthetic.at2"
SLIDER = "block:0.5x2,friction=0.2"
RECORD = ("--motion", SYNTHETIC)
UP = ("--vertical", SYNTHETIC, "--vertical-scale", "0.5")
CARRIED = "block:0.5x2,name=K,building=[{T: 0.4, xi: 0.05, gamma_psi: 1.3}]"
RANGE = ("--a-g", "1", "--f-g", "1:2")
FLOOR = ("--building", "T=0.4,xi=0.05,gamma_psi=1.3")


def test_a_body_that_slides_does_not_overturn(rocking):
    """The base of this body slides before it could rock; the same body on a base that
    does not slide overturns.
    """
    done = rocking("check", SLIDER, *RECORD, *UP, "--json", "--verdict-only")
    row = done.record
    assert (row["outcome"], row["stuck_outcome"]) == ("slid", "overturned_after_impact")
    assert row["slide_max"] == pytest.approx(0.081199683, rel=2e-8)
    assert row["slide_residual"] == pytest.approx(0.081199683, rel=2e-8)
    assert (row["slide_a"], row["theta_ratio"]) == (pytest.approx(1.962), 0.0)
    empty = ("uplift_a", "first_overturning_a", "capacity_demand", "safe_to")
    assert [row[key] for key in empty] == [None] * 4
    said = (
        "slides from 0.2 g on, before it could rock (lambda 0.25): 81.2 mm at most,"
        " 81.2 mm to the right at the end. It cannot overturn while its friction stays"
        " below 0.25. With more friction it rocks: it overturns after an impact"
    )
    assert said in done.stderr
    assert "0 of 1 overturn" in done.stderr


@pytest.mark.parametrize(("limit", "code"), [("8 cm", 0), ("70mm", 5)])
def test_a_slide_beyond_its_limit_fails(rocking, limit, code):
    call = ("check", SLIDER, *RECORD, "--verdict-only", "--fail-on", f"slide={limit}")
    assert rocking(*call).returncode == code


def test_a_slide_that_is_not_followed_fails(rocking):
    call = ("check", "block:0.5x2,friction=0.26", *RECORD, "--verdict-only")
    done = rocking(*call, "--fail-on", "slide=1m")
    assert done.returncode == 5
    assert "slides while it rocks: this motion is not followed" in done.stderr
    assert rocking(*call, "--fail-on", "overturning").returncode == 0


@pytest.mark.parametrize(
    ("friction", "start"),
    [(0.26, "slides"), (0.3, "may slide"), (0.5, "may slide"), (0.51, None)],
)
def test_what_is_known_of_sliding_while_rocking_is_one_line(rocking, friction, start):
    """lambda is 0.25; the motion needs a friction of 0.2618."""
    body = f"block:0.5x2,friction={friction}"
    call = ("check", body, "--a-g", "0.3g", "--f-g", "1", "--verdict-only")
    said = [line for line in rocking(*call).stderr.splitlines() if "slide" in line]
    if start is None:
        assert said == []
        return
    (line,) = said
    assert f": {start} while it rocks: this motion is not followed" in line
    assert "unsafe for 1 to 5 % of the bodies" in line


def test_the_motion_of_an_unsymmetric_body_between_its_lambdas_is_not_covered(rocking):
    body = "rigid:left=0.2,right=0.3,height=1,gyration=0.6,friction=0.205"
    done = rocking("check", body, "--a-g", "0.6g", "--f-g", "1", "--verdict-only")
    assert "slides one way and rocks the other: this is not covered" in done.stderr


def test_rows_and_events_of_a_slide(rocking):
    call = ("response", SLIDER, *RECORD)
    *events, last = rocking(*call, "--events", "--json").records
    assert [e["event"] for e in events] == ["slide", "stop"] * 10
    assert events[0]["t"] == pytest.approx(4.3022393, rel=2e-8)
    assert events[-1]["slide"] == pytest.approx(-0.024262239, rel=2e-8)
    assert (last["event"], last["outcome"]) == ("summary", "slid")
    assert last["slide_max"] == pytest.approx(0.077609136, rel=2e-8)
    rows = rocking(*call, "--json", "--forces").records
    assert max(abs(r["slide"]) for r in rows) == pytest.approx(last["slide_max"])
    assert list(rows[0])[:3] == ["t", "slide", "slide_velocity"]
    assert max(abs(r["fx_ratio"]) for r in rows) <= 0.2 + 1e-12
    steps = rocking(*call, "--json", "--steps").records
    assert len(steps) == 21  # one slide begins where another one stops
    early = rocking(*call, "--json", "--duration", "5", "--row-step", "0.5").records
    assert [r["t"] for r in early] == pytest.approx([0.5 * i for i in range(11)])


def test_lost_contact_ends_a_slide(rocking):
    call = ("response", SLIDER, "--a-g", "1.5g", "--f-g", "1", "--vertical", "sine")
    *events, last = rocking(*call, "--events", "--json").records
    assert (events[-1]["event"], last["outcome"]) == ("lost contact", "lost_contact")
    done = rocking("check", SLIDER, *call[2:], "--verdict-only", "--json")
    assert done.record["outcome"] == "lost_contact"
    assert (
        "the ground falls away at 0.62 s; what follows is not followed" in done.stderr
    )


def test_a_spectrum_of_a_body_that_slides(rocking, tmp_path):
    call = ("spectrum", SLIDER, "block:0.5x2", "--pulse", "sine")
    rocking(*call, "--grid", "a_g=0.1g:0.4g:4,f_g=1:2:2", "-o", "s.h5")
    with h5py.File(tmp_path / "s.h5") as file:
        assert file["outcome"][0].tolist() == [[1, 1, 8, 8]] * 2
        slide = file["slide_max"][...]
        assert slide[0, 0, 3] == pytest.approx(0.12581174, rel=5e-8)
        assert slide[0, 1] == pytest.approx(slide[0, 0] / 4.0, rel=1e-12)
        assert (slide[1] != slide[1]).all()
        assert set(file["outcome"][1].ravel().tolist()) & {2, 4}


def test_solve_says_that_a_sliding_body_counts_as_standing(rocking):
    call = ("solve", SLIDER, "--a-g", "0.4g", "--f-g", "1", "--json")
    done = rocking(*call, "--vary", "friction=0.2:0.24:2")
    assert done.record["side"] == "stands everywhere"
    assert "counts as standing however far it slides" in done.stderr
    done = rocking(*call, "--vary", "friction=0.3:0.4:2")
    assert "slides" not in done.stderr


def test_a_limit_state_of_a_slide(rocking):
    call = ("fragility", "--pulses", "configs/motions/site_pulses.csv", "--json")
    levels = ("--levels", "0.1g:2g:10", "--limit", "slide=50mm", "--bootstrap", "0")
    row = rocking(*call, SLIDER, *levels).record
    assert row["limit_state"] == "slide=50mm"
    assert 0.2 * 9.81 < row["median"] < 9.81
    done = rocking(*call, "block:0.5x2", *levels)
    assert done.returncode == 2
    assert "a body that rocks; expected one whose friction is below" in done.stderr


def test_what_takes_the_base_not_to_slide_says_so(rocking):
    for call in (
        ("envelope", SLIDER, "--grid", "f_g=1", "--a-max", "0.4g"),
        ("compare", SLIDER, "--a-g", "0.3g", "--f-g", "1"),
    ):
        assert "the base is taken not to slide" in rocking(*call).stderr


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (("check", SLIDER, *RECORD, "--fail-on", "slide=50"), "with its unit"),
        (("check", SLIDER, *RECORD, "--fail-on", "slid=50mm"), "slide=LENGTH"),
        (("check", SLIDER, *RECORD, "--fail-on", "slide=-1mm"), "positive length"),
        (("check", "block:0.5x2", *RECORD, "--fail-on", "slide=1mm"), "not known"),
        (("response", SLIDER, *RECORD, "--dimensionless"), "which slides"),
        (("check", "block:1x4", *RECORD, "--building", "xi=0.05"), "no key 'T'"),
        (("check", "block:1x4", *RECORD, *FLOOR, *FLOOR), "two modes of T = 0.4 s"),
        (("check", "block:1x4", "--A", "2", "--Omega", "3", *FLOOR), "have units"),
        (
            ("solve", "block:1x4", "--vary", "width=1:2", *RANGE, *FLOOR),
            "range of frequencies here",
        ),
        (("check", CARRIED, *RECORD, *FLOOR), "has the key building: K"),
        (("check", CARRIED, "--A", "2", "--Omega", "3"), "have units"),
        (
            ("check", CARRIED, *RECORD, "--code", "ntc2018", "--floor", FLOOR[1]),
            "--floor does not go with",
        ),
        (
            ("spectrum", CARRIED, "--grid", "a_g=1:2:2,f_g=1:2:2", "-o", "x.h5"),
            "not known here",
        ),
        (("envelope", "block:1x4", "--grid", "f_g=1:2:2", *FLOOR), "with records here"),
    ],
)
def test_refusals(rocking, call, said):
    done = rocking(*call)
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("friction", "said"),
    [
        ("{static: 0.25, kinetic: 0.3}", "up to the static friction, 0.25"),
        ("{static: 0.25}", "no key 'kinetic'"),
        ("{static: 0.25, kinetic: 0}", "up to the static friction"),
        ("{statik: 0.25, kinetic: 0.2}", "did you mean 'static'"),
        ("-0.2", "expected a positive number"),
        ("[0.2]", "found a list"),
    ],
)
def test_bad_frictions(rocking, tmp_path, friction, said):
    (tmp_path / "b.yaml").write_text(
        f"kind: block\nwidth: 0.5\nheight: 2\nfriction: {friction}\n"
    )
    done = rocking("params", "b.yaml")
    assert done.returncode == 3
    assert said in done.stderr
    assert "b.yaml:4" in done.stderr or "b.yaml" in done.stderr


def test_a_friction_of_two_numbers_round_trips(rocking, tmp_path):
    text = "block:0.5x2,friction.static=0.24,friction.kinetic=0.2"
    done = rocking("params", text, "--json")
    assert done.record["friction"] == {"static": 0.24, "kinetic": 0.2}
    (tmp_path / "p.json").write_text(done.stdout)
    call = ("check", "p.json", "--A", "2", "--Omega", "3", "--verdict-only", "--json")
    row = rocking(*call).record
    assert (row["outcome"], row["slide_a"]) == ("slid", pytest.approx(0.24 * 9.81))
    both = rocking("params", f"{text},friction=0.3")
    assert both.returncode == 3
    assert "friction is given twice" in both.stderr


def test_a_floor_is_the_record_that_is_written(rocking):
    wrote = rocking("records", SYNTHETIC, *FLOOR, "-o", "floor.at2", "--json")
    call = ("check", "block:0.5x2", "--verdict-only", "--json", "--motion")
    below = rocking(*call, SYNTHETIC, "--scale", "0.5", *FLOOR).record
    here = rocking(*call, "floor.at2", "--scale", "0.5").record
    assert below["theta_ratio"] == pytest.approx(here["theta_ratio"], rel=1e-6)
    assert below["demand_a"] == pytest.approx(0.5 * 3.924)
    assert below["floor_pga"] == pytest.approx(here["demand_a"], rel=1e-12)
    assert below["floor_chord"] == wrote.record["floor_chord"] < 1e-3
    assert below["motion"].startswith("synthetic on floor of T 0.4 s")
    again = rocking("records", SYNTHETIC, "-o", "floor.at2")
    assert again.returncode == 2


def test_the_code_and_the_dynamics_share_a_floor(rocking):
    call = ("check", "block:0.5x2", *RECORD, "--scale", "0.4", "--code", "ntc2018")
    call = (*call, "--verdict-only", "--json")
    floor = ("--floor", FLOOR[1])
    alone, both = rocking(*call, *floor), rocking(*call, *floor, *FLOOR, "--notes")
    for key in ("code_linear", "code_slv", "code_slc"):
        assert alone.record[key] == pytest.approx(both.record[key], rel=1e-12)
    assert "not of the floor" in alone.stderr
    assert "describe the same floor" in both.stderr
    other = ("--floor", "T=0.3,xi=0.05,gamma_psi=1.3")
    refused = rocking(*call, *other, *FLOOR)
    assert (refused.returncode, "state two floors" in refused.stderr) == (2, True)


@pytest.mark.usefixtures("undrawn")
def test_a_report_has_the_sentence_on_a_slide(rocking, tmp_path):
    pytest.importorskip("jinja2")
    call = ("report", SLIDER, "--a-g", "0.4g", "--f-g", "1", "-o", "r.html")
    done = rocking(*call, "--summary")
    page = (tmp_path / "r.html").read_text()
    assert "slides from 0.2 g on, before it could rock (lambda 0.25)" in page
    assert "0 of 1 overturn, 1 slides and never rocks" in done.stderr


def test_the_effect_of_a_toe_is_told(rocking):
    body = "wall:0.6x6,density=1800,strength=1MPa"
    done = rocking("check", body, "--a-g", "0.1g", "--T-g", "0.8", "--inset-effect")
    assert "take 11 % of the capacity on sharp edges" in done.stderr
    row = rocking("check", body, "--a-g", "0.1g", "--T-g", "0.8", "--json").record
    assert row["first_overturning_a"] / 9.81 == pytest.approx(0.20578997, abs=3e-6)


def test_draws_below_lambda_slide_and_stand(rocking):
    """Half of the draws of a friction around lambda slide, the others overturn."""
    body = "block:0.5x2,friction=0.25 +- 0.03"
    call = ("check", body, "--a-g", "0.45g", "--f-g", "1", "--verdict-only", "--json")
    assert rocking(*call, "--draws", "16").record["share_falls"] == 0.5
    call = ("fragility", body, "--pulses", "configs/motions/site_pulses.csv")
    done = rocking(*call, "--levels", "1g:2g:2", "--limit", "slide=1cm", "--draws", "4")
    assert done.returncode == 2
    assert "draws have no displacement" in done.stderr


def test_the_slide_of_a_body_is_drawn(rocking, tmp_path):
    done = rocking("response", SLIDER, *RECORD, "-o", "slide.svg", "-q")
    assert done.returncode == 0
    text = (tmp_path / "slide.svg").read_text(encoding="utf-8")
    assert "friction" in text


def test_the_code_takes_the_floor_of_the_document(rocking, tmp_path):
    (tmp_path / "site.csv").write_text("T [s],S_a [g]\n0,0.3\n0.5,0.7\n4,0.05\n")
    code = ("--code", "ntc2018", "--spectrum", "site.csv", "--json")
    keyed = rocking("check", CARRIED, *code).record
    stated = rocking("check", "block:0.5x2,name=K", *code, "--floor", FLOOR[1]).record
    ground = rocking("check", "block:0.5x2,name=K", *code).record
    assert keyed == stated
    assert keyed["code_slv"] < ground["code_slv"]
