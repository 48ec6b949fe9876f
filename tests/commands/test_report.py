"""`rocking report`: a page that stands alone, holds what `rocking check` prints, and trusts no name."""

from __future__ import annotations

import base64
import json
import math
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest

from rocking_cli import Outcome, Verdict, build_structure, parse_documents
from rocking_cli.motions.recording import read_motions
from rocking_cli.reports.page import Subject, page

HOSTILE = """<script>document.title = "taken"</script>'"&amp; $x$ {{ 7 * 7 }}"""
STATED = "kind: parameters\nname: {name}\np: 1.84\nalpha: 0.069\neta: 0.9\nlambda: 0.37\n"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


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
        self.sources += [value for key, value in attrs if key in ("src", "href", "data", "action", "srcset", "poster")]
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


@pytest.fixture
def documents(tmp_path) -> list[str]:
    """A structure with a hostile name and text, and a block."""
    (tmp_path / "stated.yaml").write_text("# </pre><script>1</script>\n" + STATED.format(name=json.dumps(HOSTILE)))
    (tmp_path / "block.yaml").write_text("kind: block\nname: Column\nwidth: 0.5\nheight: 2\nrestitution: 0.9\n")
    return ["stated.yaml", "block.yaml"]


def test_the_page_holds_the_verdicts_and_trusts_no_name(rocking, tmp_path, documents):
    shaking = ("--a-g", "0.6g", "--f-g", "1.2")
    done = rocking("report", *documents, *shaking, "-o", "r.html", "--workers", "1")
    assert done.returncode == 0, done.stderr
    assert "r.html: 2 verdicts, 1 overturn" in done.stderr
    assert not list(tmp_path.glob("*.part"))
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    found = Page(text)
    assert not {"script", "link", "iframe", "object", "form"} & set(found.tags)
    assert all(source.startswith("data:image/svg+xml;base64,") for source in found.sources)
    assert len(found.sources) == 4  # capacities, the block's drawing, two maps
    assert not re.search(r"https?://", text)
    for source in found.sources:
        assert base64.b64decode(source.partition(",")[2]).lstrip().startswith(b"<?xml")
    verdicts = [json.loads(line) for line in rocking("check", *documents, *shaking, "--json").stdout.splitlines()]
    for row, verdict in zip(found.rows[1:3], verdicts, strict=True):
        assert row[0].strip() == verdict["name"]
        assert row[2].strip() == verdict["model"]
        assert float(row[8]) == pytest.approx(verdict["capacity_demand"], rel=1e-3)
    assert found.rows[1][0].strip() == HOSTILE
    relations = {row[0].strip(): row[4].strip() for row in found.rows if len(row) == 5}
    assert relations["p"] == "p² = 3 g/(4 R)"
    assert relations["η"] == "θ̇ after = η θ̇ before an impact"  # given, and not from momentum
    assert "rocking report stated.yaml" in text
    assert re.search(r"\d+ of the 10000 cells of the map end otherwise", text)


def test_fragility_where_records_are_given(tmp_path):
    for i in range(5):  # a sine in g, each record faster than the one before
        samples = "\n".join(f"{0.6 * math.sin((0.06 + 0.03 * i) * k):.6f}" for k in range(100))
        (tmp_path / f"{i}.txt").write_text(samples)
    recordings = read_motions([str(tmp_path / f"{i}.txt") for i in range(5)], unit="g", dt=0.02)
    (document,) = parse_documents(STATED.format(name="Arch"))
    subject = Subject(document, build_structure(document))
    stands = Verdict("Arch", "0", "linear", Outcome.ROCKED, 0.5, 4.0, 3.6, None, None, Outcome.ROCKED)
    found = Page(page([subject], [stands], recordings=recordings, command="rocking report", made="now", workers=1))
    assert [(row[0].strip(), row[1].strip()) for row in found.rows[-5:]] == [(r.label, r.record.sha256) for r in recordings]
    fitted = [row for row in found.rows if row[0].strip() == "overturning"]
    assert len(fitted) == 1
    assert len(found.sources) == 2  # capacities and curves
    few = page([subject], [stands], recordings=recordings[:2], command="rocking report", made="now")
    assert "2 records; a fit needs" in few


def test_pages_that_cannot_be_written(refused, tmp_path, documents):
    shaking = ("--a-g", "0.6g", "--f-g", "1.2")
    (tmp_path / "there.html").write_text("")
    assert "exists; --overwrite replaces it" in refused(2, "report", *documents, *shaking, "-o", "there.html")
    assert "ends in .html" in refused(2, "report", *documents, *shaking, "-o", "r.pdf")
    assert "does not exist" in refused(2, "report", *documents, *shaking, "-o", "none/r.html")
    assert "no shaking" in refused(2, "report", *documents, "-o", "r.html")
    assert "no structure" in refused(2, "report", *shaking, "-o", "r.html")


def test_without_jinja2_one_sentence_says_so(refused, documents, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "jinja2", None)
    said = refused(1, "report", "stated.yaml", "--a-g", "0.6g", "--f-g", "1.2", "-o", "r.html", "-q")
    assert "pip install 'rocking[report]'" in said


def browsed(page: Path, profile: Path) -> tuple[str, str, set[str]]:
    """What a browser makes of a page: the document, what it says of it, and the addresses that the page asks a network for."""
    log = profile.with_suffix(".json")
    call = [
        str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", f"--user-data-dir={profile}",
        f"--log-net-log={log}", "--enable-logging=stderr", "--dump-dom", page.as_uri(),
    ]  # fmt: skip
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    asked = re.findall(r'"initiator":"(?:file|null).*?"url":"(https?://[^"]*)"', log.read_text())  # the browser itself asks for updates
    return done.stdout, done.stderr, set(asked)


ABSENT = "no Chromium on this machine"


@pytest.mark.skipif(CHROMIUM is None, reason=ABSENT)
def test_a_browser_asks_nothing_of_a_network_and_finds_no_fault(rocking, tmp_path, documents):
    assert rocking("report", "stated.yaml", "--a-g", "0.6g", "--f-g", "1.2", "-o", "r.html", "--workers", "1").returncode == 0
    shown, said, asked = browsed(tmp_path / "r.html", tmp_path / "profile")
    assert "CONSOLE" not in said
    assert asked == set()
    assert "<title>taken</title>" not in shown
    assert "What stands and what falls" in shown


@pytest.mark.soak
@pytest.mark.skipif(CHROMIUM is None, reason=ABSENT)
def test_a_page_that_asks_and_fails_is_noticed(tmp_path):
    (tmp_path / "bad.html").write_text("<img src='http://127.0.0.1:8089/x.png'><script>console.error('fault')</script>")
    _, said, asked = browsed(tmp_path / "bad.html", tmp_path / "profile")
    assert "CONSOLE" in said
    assert asked == {"http://127.0.0.1:8089/x.png"}
