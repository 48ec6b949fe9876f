"""Outputs that cannot be written: every command says so before it computes anything."""

import errno
import os
import subprocess
import sys
from importlib import import_module
from unittest.mock import Mock

import pytest

from rocking_cli import parse_grid, publishing, read_documents, report, sine
from rocking_cli.errors import UsageError
from rocking_cli.reports.figures.drawing import draw_structures

SHAKEN = "--a-g 0.35g --f-g 1.5"
FIGURE, PAGE, CLUSTER = "figures need", "a report needs", "--scheduler needs"
ON_A_CLUSTER = "--scheduler localhost:8786"
NEEDING = [
    (
        f"check block:0.5x2 {SHAKEN} -o OUT.png",
        ("matplotlib",),
        f"{FIGURE} matplotlib: pip install matplotlib",
    ),
    (
        f"check block:0.5x2 {SHAKEN} --code ntc2018 -o OUT.png",
        ("matplotlib",),
        f"{FIGURE} matplotlib: pip install matplotlib",
    ),
    (
        "draw block:0.5x2 -o OUT.svg",
        ("matplotlib",),
        f"{FIGURE} matplotlib: pip install matplotlib",
    ),
    (
        "plot - -o OUT.pdf",
        ("matplotlib",),
        f"{FIGURE} matplotlib: pip install matplotlib",
    ),
    (
        "plot - --animate OUT.gif",
        ("matplotlib",),
        f"{FIGURE} matplotlib: pip install matplotlib",
    ),
    (
        f"report block:0.5x2 {SHAKEN} -o OUT.html",
        ("jinja2",),
        f"{PAGE} jinja2: pip install jinja2",
    ),
    (
        f"report block:0.5x2 {SHAKEN} -o OUT.html",
        ("matplotlib",),
        f"{PAGE} matplotlib: pip install matplotlib",
    ),
    (
        f"report block:0.5x2 {SHAKEN} -o OUT.html",
        ("jinja2", "matplotlib"),
        f"{PAGE} jinja2 and matplotlib: pip install jinja2 matplotlib",
    ),
    (
        f"spectrum block:0.5x2 --grid a_g=0.1g:1g:3,f_g=1:3:3 -o OUT.h5 {ON_A_CLUSTER}",
        ("distributed",),
        f"{CLUSTER} distributed: pip install distributed",
    ),
    (
        (
            "fragility block:0.5x2 --pulses configs/motions/site_pulses.csv --levels"
            f" 0.2g:0.7g:4 -o OUT.h5 {ON_A_CLUSTER}"
        ),
        ("distributed",),
        f"{CLUSTER} distributed: pip install distributed",
    ),
]

WRITING = [
    (f"check block:0.5x2 {SHAKEN} -o", ".png"),
    ("draw block:0.5x2 -o", ".svg"),
    (f"response block:0.5x2 {SHAKEN} -o", ".svg"),
    (f"compare block:0.5x2 {SHAKEN} -o", ".svg"),
    ("plot - -o", ".pdf"),
    ("plot - --animate", ".gif"),
    (f"report block:0.5x2 {SHAKEN} -o", ".html"),
    ("spectrum block:0.5x2 --grid a_g=0.1g:1g:3,f_g=1:3:3 -o", ".h5"),
    (
        (
            "fragility block:0.5x2 --pulses configs/motions/site_pulses.csv --levels"
            " 0.2g:0.7g:4 -o"
        ),
        ".h5",
    ),
    (
        (
            "fragility block:0.5x2 --pulses configs/motions/site_pulses.csv --levels"
            " 0.2g:0.7g:4 --export openquake -o"
        ),
        ".xml",
    ),
]

BLOCKER = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in MISSING:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocker())
from rocking_cli.commands import main
main(CALL)
"""


@pytest.fixture
def _nothing_is_computed(monkeypatch):
    """Every march, and every row of a file, is a failure of the test."""

    def computed(*_, **__):
        raise AssertionError("computed before the output was looked at")

    places = {
        "responses.check": ["verdicts"],
        "spectra.sweep": ["spectrum_of", "write_scene"],
        "fragility.study": ["studies"],
        "reports.page": ["verdicts"],
        "reports.rows": ["read_bytes"],
    }
    for module, names in places.items():
        for name in names:
            monkeypatch.setattr(import_module(f"rocking_cli.{module}"), name, computed)


@pytest.mark.parametrize(
    ("call", "packages", "said"),
    NEEDING,
    ids=lambda x: x[:30] if isinstance(x, str) else "+".join(x),
)
@pytest.mark.usefixtures("_nothing_is_computed")
def test_a_package_that_is_missing_is_named_before_anything_is_computed(
    rocking, monkeypatch, call, packages, said
):
    for package in packages:
        monkeypatch.setitem(sys.modules, package, None)
    done = rocking(*call.split())
    assert (done.returncode, done.stderr, done.stdout) == (1, f"rocking: {said}\n", "")


def test_an_installation_without_the_packages_says_so_itself(tmp_path):
    call = ["check", "block:0.5x2", *SHAKEN.split(), "-o", str(tmp_path / "x.png")]
    code = BLOCKER.replace("MISSING", "{'matplotlib'}").replace("CALL", repr(call))
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "rocking: figures need matplotlib: pip install matplotlib\n"


@pytest.mark.parametrize(("call", "suffix"), WRITING, ids=lambda x: x[:30])
@pytest.mark.parametrize("fault", ["ending", "exists", "folder", "closed"])
@pytest.mark.usefixtures("_nothing_is_computed")
def test_an_output_that_cannot_be_written_is_refused_before_anything_is_computed(
    rocking, tmp_path, monkeypatch, call, suffix, fault
):
    name = f"out{suffix}"
    if fault == "ending":
        name, said = "out.txt", ".txt"
    elif fault == "exists":
        (tmp_path / name).write_text("mine")
        said = f"{name}: exists"
    elif fault == "folder":
        name, said = f"none/out{suffix}", "the folder none does not exist"
    else:
        said = "Permission denied"
        refused = Mock(side_effect=PermissionError(errno.EACCES, said))
        # root may write everywhere
        monkeypatch.setattr(publishing, "open", refused, raising=False)
    done = rocking(*call.split(), name)
    assert done.returncode == 2
    assert said in done.stderr
    assert not done.stdout
    if fault == "exists":
        assert (tmp_path / name).read_text() == "mine"


@pytest.mark.usefixtures("_nothing_is_computed")
def test_python_refuses_a_taken_name_before_anything_is_computed(tmp_path):
    taken = tmp_path / "r.html"
    taken.write_text("mine")
    documents = read_documents("block:0.5x2")
    with pytest.raises(UsageError, match=r"r\.html: exists"):
        report(
            documents,
            sine(),
            taken,
            shaking=parse_grid("a_g=0.2g,f_g=2"),
            overwrite=False,
        )
    with pytest.raises(
        UsageError, match=r"x\.doc: expected a name that ends in .*\.png"
    ):
        draw_structures(documents, tmp_path / "x.doc")


@pytest.fixture
def other_name(tmp_path):
    """The name of a document that is no UTF-8, as on an old stick."""
    name = os.fsdecode(b"caf\xe9.yaml")
    try:
        (tmp_path / name).write_text("{kind: block, width: 0.5, height: 2}")
    except (OSError, ValueError):
        pytest.skip("a file system of UTF-8 alone")
    return name


@pytest.mark.parametrize(
    ("call", "output"),
    [
        ("draw NAME -o OUT", "d.svg"),
        (f"report NAME {SHAKEN} -o OUT", "r.html"),
        ("spectrum NAME --grid a_g=1:2:2,f_g=1:2:2 -o OUT", "s.h5"),
    ],
)
def test_a_name_that_is_no_utf_8_is_written_escaped(
    rocking, tmp_path, other_name, call, output
):
    words = [other_name if word == "NAME" else word for word in call.split()]
    done = rocking(*[output if word == "OUT" else word for word in words])
    assert done.returncode in (0, 4), done.stderr
    assert b"caf\\udce9" in (tmp_path / output).read_bytes()


def test_a_backend_that_does_not_exist_is_told(tmp_path):
    call = ["-m", "rocking_cli", "draw", "block:0.5x2", "-o", "d.svg"]
    done = subprocess.run(
        [sys.executable, *call],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "nosuch"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "matplotlib cannot start: " in done.stderr
    assert "'nosuch'" in done.stderr
    assert "MPLBACKEND" in done.stderr
    assert "Traceback" not in done.stderr


def test_rows_have_one_form(rocking):
    rows = rocking("params", "block:0.5x2", "--format", "markdown", "-q").stdout
    assert rows.startswith("| name | p [rad/s] | alpha [rad] |")
    for other in ("--json", "--csv"):
        done = rocking("params", "block:0.5x2", other, "--format", "latex")
        assert done.returncode == 2
        assert "--format does not go with --json or --csv" in done.stderr
