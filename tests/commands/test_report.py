"""`rocking report`: a page that stands alone, holds what `rocking check` prints, and
trusts no name.
"""

import base64
import hashlib
import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from rocking_cli import (
    Outcome,
    Recording,
    RockingParameters,
    Verdict,
    build_structure,
    check,
    cosine,
    parse_documents,
    parse_grid,
    pulse,
    sine,
    spectrum,
)
from rocking_cli.fragility.exposure import Exposure
from rocking_cli.fragility.measures import members_of, shaken_upwards
from rocking_cli.motions.biaxial import Upwards
from rocking_cli.motions.reading import read_motions
from rocking_cli.reports.page import _some, page
from rocking_cli.reports.page_parts import Asked
from rocking_cli.reports.wording import (
    OVERVIEW,
    demand_plainly,
    opposite_in_words,
    overview_row,
    verdict_plainly,
)
from rocking_cli.responses.code_verdict import code_verdicts

HOSTILE = """<script>document.title = "taken"</script>'"&amp; $x$ {{ 7 * 7 }}"""
DEMAND = parse_grid("a_g=0.6g,f_g=1.2")


class Page(HTMLParser):
    """The tags, attributes that name a source, rows of tables and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.sources: list[str] = []
        self.rows: list[list[str]] = []
        self.cell = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.sources += [
            value
            for key, value in attrs
            if key in ("src", "href", "data", "action", "srcset", "poster")
        ]
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.cell = True
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        self.cell = self.cell and tag not in ("td", "th")

    def handle_data(self, data):
        if self.cell:
            self.rows[-1][-1] += data


BLOCK = (
    "# </pre><script>1</script>\nkind: block\nwidth: 0.5\nheight: 2\nrestitution:"
    " 0.9\nname: " + json.dumps(HOSTILE)
)
# no closed form crosses its map
DAMPED = (
    "{{kind: parameters, name: S{}, p: 2, alpha: {}, eta: 0.9, a_scale: 1, damping:"
    " 0.01}}\n"
)
STATED = "{kind: parameters, name: Arch, p: 1.84, alpha: 0.069, eta: 0.9, lambda: 0.37}"


def structure(text: str) -> RockingParameters:
    """A structure as the page takes it."""
    (document,) = parse_documents(text)
    return build_structure(document)


@pytest.fixture(scope="module", autouse=True)
def coarse_maps():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rocking_cli.reports.page_sections.SIDE", 4)
        yield


@pytest.fixture(scope="module")
def verdict() -> Verdict:
    """On the block under a sine that overturns it."""
    return check(structure(BLOCK), sine(), DEMAND)


@pytest.fixture(scope="module")
def text(verdict) -> str:
    """The page of a block with a hostile name and document."""
    shown = structure(BLOCK)
    demands = [(shown, sine(), DEMAND)]
    return page(
        [shown],
        [verdict],
        Asked(f"rocking {HOSTILE}", "today", author=HOSTILE, code={}, demand="strong"),
        checks=list(code_verdicts([shown], demands, {})),
        demands=demands,
        workers=1,
    )


@pytest.mark.slow
def test_the_page_holds_the_verdict_and_trusts_no_name(text, verdict):
    found = Page(text)
    assert not {"script", "link", "iframe", "object", "form"} & set(found.tags)
    assert all(
        source.startswith("data:image/svg+xml;base64,") for source in found.sources
    )
    # capacities, the block's drawing, the map, the curve of the code
    assert len(found.sources) == 4
    assert not re.search(r"https?://", text)
    for source in found.sources:
        assert base64.b64decode(source.partition(",")[2]).lstrip().startswith(b"<?xml")
    of_code, by_code, heads, row = (
        [cell.strip() for cell in row] for row in found.rows[:4]
    )
    assert (of_code[:2], by_code[0]) == (["structure", "q = 2: verdict"], HOSTILE)
    shown = dict(zip(heads, row, strict=True))
    assert (shown["structure"], shown["model"], shown["outcome"]) == (
        HOSTILE,
        "nonlinear",
        verdict.outcome.sentence,
    )
    for head, value, least in (
        ("capacity over demand", verdict.capacity_demand, 0.01),
        ("overturns from [g]", verdict.first_overturning_a / 9.81, 0.001),
    ):
        assert value - least < float(shown[head]) <= value  # rounded to the safe side
    relations = {row[0].strip(): row[4].strip() for row in found.rows if len(row) == 5}
    assert relations["p"] == "p² = 3 g/(4 R)"
    assert (
        relations["η"] == "θ̇ after = η θ̇ before an impact"
    )  # given, and not from momentum
    assert re.search(
        r"In \d+ of \d+ cells of the map the linear equation ends otherwise", text
    )
    assert [found.rows[-1][0].strip(), len(found.rows[-1][1].strip())] == ["<text>", 64]


def recordings(folder: Path, count: int) -> tuple[Recording, ...]:
    """Two seconds of a sine in g, each record faster than the one before."""
    for i in range(count):
        (folder / f"{i}.txt").write_text(
            "\n".join(
                f"{0.6 * math.sin((0.06 + 0.03 * i) * k):.6f}" for k in range(100)
            )
        )
    return read_motions(
        [str(folder / f"{i}.txt") for i in range(count)], unit="g", dt=0.02
    )


@pytest.mark.soak
def test_processes_write_the_page_of_one():
    bodies = [structure(DAMPED.format(i, a)) for i, a in enumerate((0.4, 0.2, 0.3))]
    demands = [(one, sine(), DEMAND) for one in bodies]
    verdicts = [check(*demand) for demand in demands]
    pages = [
        page(bodies, verdicts, ASKED, demands=demands, workers=workers)
        for workers in (1, 2)
    ]
    images = [re.findall(r'src="data:[^"]+"', text) for text in pages]
    assert [len(found) for found in images] == [4, 4]
    assert len({re.sub(r'src="data:[^"]+"', "", text) for text in pages}) == 1


def test_the_title_names_a_few_structures():
    assert _some(["A"]) == "A"
    assert _some(list("ABCDE")) == "A, B, C, D, E"
    assert _some(list("ABCDEF")) == "A, B, C, D and 2 others"


STANDS = Verdict(
    "Arch", "0", "linear", Outcome.ROCKED, 0.5, 4.0, 3.6, None, None, Outcome.ROCKED
)
ASKED = Asked("rocking report", "today")


def test_a_capacity_above_the_limit_of_the_search_and_worn_edges_are_shown(tmp_path):
    above = replace(STANDS, searched_to=52.0)
    lines = ["Arch: pivots 25 mm inside the edges would take 10 % of the capacity"]
    asked = replace(ASKED, recordings=recordings(tmp_path, 2), remarks=lines)
    text = page([structure(STATED)], [above], asked)
    heads, row = ([cell.strip() for cell in row] for row in Page(text).rows[:2])
    assert dict(zip(heads, row, strict=True))["capacity over demand"] == "> 13.00"
    assert f"<p>{lines[0]}</p>" in text


def test_a_few_records_bear_no_curve(tmp_path):
    records = recordings(tmp_path, 2)
    asked = replace(ASKED, recordings=records)
    text = page([structure(STATED)], [STANDS], asked)
    assert "2 records; a fit needs at least 4" in text
    assert [(row[0].strip(), row[1].strip()) for row in Page(text).rows[-2:]] == [
        (r.record.source, r.record.sha256) for r in records
    ]


def test_each_edge_and_the_damping_are_stated_and_what_leaves_the_ground_is_not_agreed(
    tmp_path,
):
    statue = structure(
        "{kind: rigid, name: Arch, left: 0.42, right: 0.31, height: 1.15, gyration:"
        " 0.68, damping: 0.05}"
    )
    gone = replace(
        STANDS, model="nonlinear", outcome=Outcome.LOST_CONTACT, theta_ratio=None
    )
    falls = replace(gone, outcome=Outcome.OVERTURNED_NO_IMPACT)
    failed = replace(gone, outcome=Outcome.FAILED)
    asked = replace(ASKED, recordings=recordings(tmp_path, 2))
    text = page([statue], [gone, falls, failed], asked)
    rows = {
        (row[0].strip(), row[1].strip()): float(row[2])
        for row in Page(text).rows
        if len(row) == 5 and row[3].strip() in ("-", "rad")
    }
    for side in statue.sides:
        assert rows["α", f"critical angle, {side.side} edge"] == pytest.approx(
            side.alpha, rel=5e-4
        )
        assert rows[
            "η", f"coefficient of restitution, {side.side} edge"
        ] == pytest.approx(side.eta, rel=5e-4)
    assert rows["ζ", "viscous damping"] == 0.05
    assert (
        "In 2 of 2 motions the linear equation ends otherwise than the nonlinear one;"
        " in 2 of them" in text
    )
    assert "1 more is not compared" in text


def test_a_vertical_motion_is_in_every_verdict_and_in_the_curves(
    rocking, monkeypatch, tmp_path
):
    """The structures are checked under both together, and fragility is that of the
    command; its file is among the hashes.
    """
    records, demands, members = recordings(tmp_path, 5), [], []

    def noted(found, **_):
        demands.extend(found)
        return [STANDS]

    def half_of_them(structures, motions, sweep):
        members.extend(motions.members)
        down = (
            np.arange(len(motions.levels))
            >= np.arange(4, 4 + len(motions.members))[:, None]
        )
        return [
            Exposure(
                np.where(down, np.nan, 0.5),
                np.where(down, Outcome.OVERTURNED_NO_IMPACT, Outcome.ROCKED),
            )
        ]

    monkeypatch.setattr("rocking_cli.responses.check.verdicts", noted)
    monkeypatch.setattr("rocking_cli.reports.page_sections.exposures", half_of_them)
    call = (
        "report",
        "configs/parameters.yaml",
        "--unit",
        "g",
        "--dt",
        "0.02",
        "--motion",
        *(f"{i}.txt" for i in range(5)),
        "-o",
        "r.html",
    )
    assert (
        rocking(
            *call,
            "--vertical",
            "3.txt,unit=g,dt=0.02",
            "--vertical-scale",
            "0.5",
        ).returncode
        == 0
    )
    assert [motion.vertical is not None for _, motion, _ in demands] == [True] * 5
    wanted = shaken_upwards(members_of(records), Upwards(records[3].motion, 0.5))
    assert [m.recording.identity() for m in members] == [
        m.recording.identity() for m in wanted
    ]
    found = Page((tmp_path / "r.html").read_text(encoding="utf-8"))
    assert len([row for row in found.rows if row[0].strip() == "overturning"]) == 1
    rows = [[cell.strip() for cell in row] for row in found.rows]
    assert rows.count(["3.txt", records[3].record.sha256]) == 1


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_a_first_page_in_words_comes_before_the_details(rocking, tmp_path):
    """And an input has one hash."""
    text = "---\n".join(DAMPED.format(i, alpha) for i, alpha in enumerate((0.4, 0.2)))
    (tmp_path / "two.yaml").write_text(text)
    call = (
        "report",
        "two.yaml",
        "--a-g",
        "0.35g",
        "--f-g",
        "1",
        "--summary",
        "--title",
        "Sculpture hall",
        "--sort",
        "capacity",
        "--author",
        "A. Rossi",
        "--place",
        "Naples",
    )
    assert rocking(*call, "-o", "r.html").returncode == 0
    shown = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert '<h1>Sculpture hall</h1>\n<p id="place">Naples, A. Rossi</p>' in shown
    assert "under one cycle of a sine of 0.35 g at 1 Hz." in shown
    head, *rows = [[cell.strip() for cell in row] for row in Page(shown).rows]
    assert [row for row in rows if row[0] == "two.yaml"] == [
        ["two.yaml", hashlib.sha256(text.encode()).hexdigest()]
    ]
    assert head == [one for one in OVERVIEW if one != "worst motion"]
    assert [row[0] for row in rows[:2]] == ["S1", "S0"]
    assert [row[1].split(":")[0] for row in rows[:2]] == ["Falls", "Stands"]
    assert (
        re.findall(r'<a href="#s\d">(.*?)</a>', shown)
        == ["S1", "S0"]
        == re.findall(r'<h2 id="s\d">(.*?)</h2>', shown)
    )


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_the_page_takes_a_range_of_frequencies_and_the_code_as_check_does(
    rocking, tmp_path
):
    shaking = ("--pulse", "rectangular", "--a-g", "0.35g", "--f-g", "1:2")
    call = ("block:0.5x2", *shaking, "--code", "ntc2018")
    assert rocking("report", *call, "-o", "r.html", "--summary").returncode == 0
    shown = (tmp_path / "r.html").read_text(encoding="utf-8")
    found = json.loads(rocking("check", *call, "--json").stdout)
    assert " of 0.35 g at 1 to 2 Hz, at the worst for each structure." in shown
    rows = [[cell.strip() for cell in row] for row in Page(shown).rows]
    (heads,) = [row for row in rows if "least capacity at [Hz]" in row]
    details = dict(zip(heads, rows[rows.index(heads) + 1], strict=True))
    assert float(details["least capacity at [Hz]"]) == pytest.approx(
        found["worst_f_g"], rel=5e-3
    )
    ratio = found["code_slv_ratio"]
    assert ratio < 1.0
    assert rows[1][3:5] == ["not verified", f"{math.floor(100 * ratio) / 100:.2f}"]


@pytest.mark.usefixtures("undrawn")
def test_a_page_by_the_code_needs_no_motion_and_says_its_verdict_first(
    rocking, tmp_path
):
    """Each limit state has its spectrum; what fails is red; the files are hashed."""
    site = "T [s],S_a [g]\n0,0.3\n0.15,0.8\n0.5,0.8\n2,0.2\n6,0.02\n"
    (tmp_path / "v.csv").write_text(site)
    (tmp_path / "c.csv").write_text(site.replace("0.8", "0.9"))
    call = ("block:0.6x7,name=Thin", "block:2x3,name=Stout", "--code", "ntc2018")
    call += ("--spectrum", "slv=v.csv,slc=c.csv")
    done = rocking("report", *call, "-o", "r.html")
    assert done.returncode == 0, done.stderr
    assert "SLV: 1 of 2 not verified: Thin" in done.stderr
    shown = (tmp_path / "r.html").read_text(encoding="utf-8")
    page = Page(shown)
    assert page.rows[0][:3] == [
        "structure",
        "q = 2: verdict",
        "q = 2: accepted over demand",
    ]
    found = {row["structure"]: row for row in rocking("check", *call, "--json").records}
    for name, red in (("Thin", True), ("Stout", False)):
        (cells,) = [row for row in page.rows if row[0] == name]
        ratios = [found[name][f"code_{key}_ratio"] for key in ("slv", "slc")]
        assert cells[3::2] == [
            "verified" if r >= 1.0 else "not verified" for r in ratios
        ]
        assert cells[4::2] == [f"{math.floor(100 * r) / 100:.2f}" for r in ratios]
        assert (
            f'<tr class="falls">\n<td data-head="structure">{name}<' in shown
        ) == red
    assert "overturn" not in shown.partition("How this was made")[0]
    assert "not of the official print" in shown
    for source in ("v.csv", "c.csv"):
        digest = hashlib.sha256((tmp_path / source).read_bytes()).hexdigest()
        assert [source, digest] in page.rows


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_the_page_says_what_check_says_of_the_opposite_direction(rocking, tmp_path):
    other = "parameters:p=2,alpha=0.2,eta=0.9,lambda=0.2"
    call = ("block:0.5x2,one_sided=true", other, "--a-g=-0.6g", "--f-g", "1")
    assert rocking("report", *call, "-o", "r.html", "--summary").returncode == 0
    said = (
        "opposite direction (--scale -1), which may differ for unequal sides: overturns"
        " block:0.5x2 one_sided=true"
    )
    assert f"<p>The {said}.</p>" in (tmp_path / "r.html").read_text(encoding="utf-8")
    assert f"the {said}\n" in rocking("check", *call, "--verdict-only").stderr


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_the_page_of_a_tied_body_has_its_uplift_and_what_check_says_of_its_ties(
    rocking, tmp_path
):
    call = ("configs/wall_tied.yaml", "--a-g=-0.6g", "--T-g", "0.5")
    assert rocking("report", *call, "-o", "r.html").returncode == 0
    shown = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "under sine 1 cycle times -1: a_g 5.886 m/s2 = 0.6 g, f_g 2 Hz." in shown
    uplift = 0.1 + 5000 * 5.5 / (
        7200 * 9.81 * 3
    )  # tan alpha, and the moment of the prestress over m g h_G
    rows = {row[1]: row for row in Page(shown).rows if len(row) == 5}
    held = "static uplift acceleration over g with its ties and tendon (side: right)"
    assert rows[held][2:] == [f"{uplift:.4g}", "-", "it lifts at ẍg = λ g"]
    assert (
        rows["static uplift acceleration over g"][4]
        == "it lifts at ẍg = λ g, of the free body"
    )
    said = [
        line.partition(": ")[2]
        for line in rocking("check", *call, "--verdict-only").stderr.splitlines()
        if ": tie 1 " in line or ": its ties" in line
    ]
    assert len(said) == 1
    assert f"<li>sine 1 cycle times -1: {said[0]}</li>" in shown
    assert "<li>sine 1 cycle times -1: its ties" in shown


def test_the_worst_outcomes_in_the_opposite_direction_are_told():
    found = [
        ("A", Outcome.ROCKED),
        ("B", Outcome.FAILED),
        ("C", Outcome.LEANING),
        ("C", Outcome.OVERTURNED_NO_IMPACT),
    ]
    ends = [opposite_in_words(found[:n]).partition(" sides: ")[2] for n in (1, 2, 4)]
    assert ends == ["does not overturn A", "is not known for B", "overturns C"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, "Stands: it rocks to 50 % of its critical angle."),
        (
            {"model": "linear"},
            (
                "Stands: it rocks to 50 % of its critical angle. This is by the linear"
                " equation alone."
            ),
        ),
        (
            {"first_overturning_a": 3.924},
            (
                "Stands: it rocks to 50 % of its critical angle. Weaker shaking, from"
                " 0.4 g, overturns it."
            ),
        ),
        (
            {"outcome": Outcome.NO_UPLIFT, "unsettled": True},
            (
                "Stands: it does not lift. A change of the demand in its last digits"
                " changes this."
            ),
        ),
        (
            {"outcome": Outcome.LOST_CONTACT},
            (
                "Leaves the ground: its later motion is not known, so it counts as"
                " falling."
            ),
        ),
        ({"outcome": Outcome.FAILED}, "Not known: the computation failed."),
        (
            {"outcome": Outcome.OVERTURNED_NO_IMPACT, "slides": True},
            "Falls: it overturns without impact. Its base would slide.",
        ),
    ],
)
def test_a_verdict_in_a_sentence(changes, said):
    assert verdict_plainly(replace(STANDS, **{"model": "nonlinear", **changes})) == said


def test_the_worst_of_several_motions_speaks_for_a_structure():
    falls = replace(
        STANDS, model="nonlinear", motion="1", outcome=Outcome.OVERTURNED_NO_IMPACT
    )
    failed = replace(falls, motion="2", outcome=Outcome.FAILED)
    assert overview_row([STANDS, falls, STANDS])[1:3] == (
        "Falls: it overturns without impact. It falls under 1 of 3 motions.",
        "1",
    )
    assert overview_row([STANDS, falls, failed])[2] == "2"


@pytest.mark.parametrize(
    ("motion", "axes", "words"),
    [
        (sine(0.5), "a_g=0.3g,f_g=2", "half a cycle of a sine of 0.3 g at 2 Hz"),
        (
            pulse("ricker-antisymmetric"),
            "A=2,Omega=4",
            "an antisymmetric Ricker of A = 2 at Omega = 4",
        ),
        (
            cosine(2),
            "a_g=3,omega_g=5",
            (
                "2 cycles of a cosine of 0.306 g at 0.7958 Hz, with the vertical motion"
                " up.at2"
            ),
        ),
    ],
)
def test_a_demand_in_words(motion, axes, words):
    assert (
        demand_plainly(
            [(motion, parse_grid(axes))], "up.at2" if "up.at2" in words else None
        )
        == words
    )


@pytest.mark.usefixtures("undrawn")
def test_the_first_page_says_the_share_that_falls_and_the_key_as_check_does(
    rocking, tmp_path
):
    call = ("block:0.62+-0.01x2", "--a-g", "0.4g", "--f-g", "1", "--draws", "16")
    done = rocking("report", *call, "-o", "r.html", "--summary")
    assert done.returncode == 0, done.stderr
    shown = (tmp_path / "r.html").read_text(encoding="utf-8")
    said = [x for x in rocking("check", *call).stderr.splitlines() if "draws" in x]
    assert len(said) == 1
    assert "of 16 draws" in said[0]
    assert ") of the first overturning" in said[0]
    assert f"<p>{said[0]}.</p>" in shown.partition('id="overview"')[0]


@pytest.mark.usefixtures("undrawn")
def test_labels_stand_beside_the_names_and_the_map_covers_the_range(
    rocking, tmp_path, monkeypatch
):
    (tmp_path / "hall.csv").write_text(
        "kind,name,width,height,room\nblock,Athena,0.4 m,1.8 m,R-3\n"
    )
    grids = []

    def swept(structures, motion, grid, **more):
        grids.append(grid)
        return spectrum(structures, motion, grid, **more)

    monkeypatch.setattr("rocking_cli.reports.page_sections.spectrum", swept)
    call = ("hall.csv", "--a-g", "0.2g", "--f-g", "1:1.2", "-o", "r.html", "--summary")
    assert rocking("report", *call).returncode == 0
    page = Page((tmp_path / "r.html").read_text(encoding="utf-8"))
    for heads, row in (page.rows[:2], page.rows[2:4]):
        assert dict(zip(heads, row, strict=True))["room"] == "R-3"
    (grid,) = grids
    hertz = grid.frequency.values / math.tau
    assert (hertz[0], hertz[-1]) == pytest.approx((0.5, 2.4), rel=1e-9)
    said = " ".join(cell for row in page.rows for cell in row)
    assert "sine 1 cycle" not in said  # one motion, which stands above the table
