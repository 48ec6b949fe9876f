"""From a document to a structure: the kinds, those that installed packages add, and
which failures are the document's.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import partial

import pytest
from support.documents import RIGID, built
from support.packages import installed

from rocking_cli import DocumentError, StructureError, build_structure, parse_documents
from rocking_cli.structures import KINDS, read_documents
from rocking_cli.structures.kinds import GROUP, sketch_of
from rocking_cli.structures.schema import schema_text


@pytest.mark.parametrize(
    ("error", "raised", "words"),
    [
        *(
            (bug("bug"), bug, "bug")
            for bug in (ZeroDivisionError, ValueError, OverflowError, KeyError)
        ),
        (
            StructureError("never stands"),
            DocumentError,
            r"tower.yaml:1:1: block: never stands",
        ),
    ],
)
def test_a_bug_in_a_builder_is_not_the_documents_fault_and_a_geometry_is(
    monkeypatch, error, raised, words
):
    def body(document):
        raise error

    monkeypatch.setattr("rocking_cli.structures.kinds.block.body", body)
    with pytest.raises(raised, match=words):
        build_structure(parse_documents("kind: block", "tower.yaml")[0])


SIMILAR = [
    "kind: block\nwidth: {a}\nheight: {b}",
    "kind: drum\nbase_radius: {a}\ntop_radius: {c}\nheight: {b}",
    "kind: prism\ncorners: [[0, 0], [{a}, 0], [{c}, {b}]]",
    "kind: spire\nbase_radius: {a}\nheight: {b}\nthickness: {c}\ncrack: diagonal",
    "kind: arch\nradius: {b}\nthickness: {a}\nangle: 157.5 deg\nvoussoirs: 7",
]


@pytest.mark.parametrize("document", SIMILAR, ids=lambda text: text.split()[1])
def test_the_smallest_and_the_largest_lengths_are_similar_to_those_of_a_building(
    document,
):
    small, usual, large = (
        built(document.format(a=size, b=6 * size, c=0.4 * size))
        for size in (1e-8, 1.0, 1e8)
    )
    for size, found in ((1e-8, small), (1e8, large)):
        assert (found.alpha, found.eta, found.uplift) == pytest.approx(
            (usual.alpha, usual.eta, usual.uplift), rel=1e-9, abs=0
        )
        assert found.p * math.sqrt(size) == pytest.approx(usual.p, rel=1e-9, abs=0)


TOWER = """
from rocking_cli import RockingParameters

REPORTS = ("storeys",)


def build(document, name):
    storeys = document.integer("storeys", 1, 99)
    return RockingParameters(
        name=name, structure="tower", p=2.0, alpha=0.2, eta=0.9, uplift=0.25,
        a_scale=0.8, details={"storeys": storeys}
    )
"""


@pytest.fixture
def install(tmp_path, monkeypatch):
    """A function that installs a package with the kind of a name and the source of its
    module.
    """
    return partial(installed, monkeypatch, tmp_path, GROUP)


def test_an_installed_package_adds_a_kind(install):
    install("tower", TOWER)
    tower = built("kind: tower\nstoreys: 7\ndamping: 0.02\nname: T")
    assert (tower.p, tower.damping, tower.details) == (2.0, 0.02, {"storeys": 7})
    assert built(json.dumps(tower.row())) == tower
    with pytest.raises(
        DocumentError,
        match=r"f.yaml:2:1: unknown key 'storys' \(did you mean 'storeys'",
    ):
        built("kind: tower\nstorys: 7")
    with pytest.raises(
        DocumentError,
        match=r"expected one of block, .*parameters, tower .did you mean 'tower'",
    ):
        built("kind: towr\nstoreys: 7")
    with pytest.raises(
        DocumentError,
        match=r"f.yaml:2:10: storeys: found 100; expected a whole number from 1 to 99",
    ):
        built(
            "kind: tower\nstoreys: 100"
        )  # what the package finds wrong is told as it is


def test_an_installed_kind_may_declare_its_keys(install):
    keys = "Keys({'storeys': Key('whole', 'their number', least=1, most=99)})"
    source = TOWER.replace(
        'document.integer("storeys", 1, 99)', "document.integer('storeys')"
    )
    assert source != TOWER
    imported = "from rocking_cli.documents.keys import Key, Keys\n"
    install("tower", f"{imported}{source}\nKEYS = {keys}\n")
    assert built("kind: tower\nstoreys: 7").details == {"storeys": 7}
    with pytest.raises(DocumentError, match="found 100; expected a whole number from"):
        built("kind: tower\nstoreys: 100")
    with pytest.raises(DocumentError, match=r"f.yaml:2:1: unknown key 'width'; known"):
        built("kind: tower\nwidth: 7")
    found = json.loads(schema_text())["definitions"]["tower"]["properties"]
    assert found["storeys"]["maximum"] == 99
    assert found["storeys"]["description"] == "their number"


def test_shared_keys_are_read_for_an_installed_kind_that_does_not_read_them(install):
    install("tower", TOWER)
    plain, moon = (
        built(f"kind: tower\nstoreys: 7\nname: T{more}")
        for more in ("", "\ngravity: 1.62")
    )
    assert moon == replace(plain, gravity=1.62, p=2.0 * math.sqrt(1.62 / 9.81))
    given = built("kind: tower\nstoreys: 7\nname: T\nrestitution: 0.5\nfriction: 0.4")
    assert given == replace(plain, eta=0.5, eta_source="given", friction=0.4)
    assert built("kind: tower\nstoreys: 7\nname: T\nrestitution: auto") == plain
    with pytest.raises(
        DocumentError,
        match=(
            r"f.yaml:3:14: restitution: found 1.5; expected a number from 0 to 1, or"
            r" auto"
        ),
    ):
        built("kind: tower\nstoreys: 7\nrestitution: 1.5")


def test_shared_keys_are_refused_where_more_than_p_and_eta_may_depend_on_them(install):
    sides = (
        "Side('left', 2.0, 0.2, 0.2, 1.0, 0.9), Side('right', 2.0, 0.3, 0.3, 1.0, 0.9)"
    )
    source = "from rocking_cli.structures import RockingParameters, Side\n" + BUILDS
    install(
        "leaning",
        source.format(f"return RockingParameters.of_sides(name, 'leaning', {sides})"),
    )
    with pytest.raises(DocumentError, match=r"f.yaml:2:10: gravity: found gravity of"):
        built("kind: leaning\ngravity: 1.62")


def test_details_are_carried_along_only_for_the_kind_that_reports_them(install):
    record = {
        "kind": "parameters",
        "structure_kind": "tower",
        "p": 1,
        "alpha": 0.2,
        "eta": 0.9,
        "lambda": 0.2,
        "storeys": 7,
    }
    with pytest.raises(DocumentError, match="unknown key 'storeys'"):
        built(json.dumps(record))
    install("tower", TOWER)
    assert built(json.dumps(record)).details == {"storeys": 7}
    with pytest.raises(DocumentError, match="unknown key 'storeys'"):
        built(json.dumps({**record, "structure_kind": "arch"}))


@pytest.mark.parametrize(
    ("source", "words"),
    [
        (
            "import nowhere_to_be_found",
            "ModuleNotFoundError: No module named 'nowhere_to_be_found'",
        ),
        ("REPORTS = ()", "AttributeError: module 'rocking_broken' has no attribute"),
        (
            "def body(document):\n    return [1.0]",
            "AttributeError: 'list' object has no attribute 'parameters'",
        ),
        ("raise SystemExit('goodbye')", "SystemExit: goodbye"),
    ],
)
def test_a_package_that_cannot_be_used_is_named(install, source, words):
    install("broken", source)
    with pytest.raises(
        DocumentError,
        match=(
            "kind: found broken, which the package of-broken adds and which cannot be"
            f" used: .*{words}"
        ),
    ):
        built("kind: broken")


def test_sizes_of_an_installed_kind_are_read_and_never_left_out(install):
    install("tower", TOWER)
    with pytest.raises(
        DocumentError, match=r"^tower:7: found '7'; expected tower:KEY="
    ):
        read_documents("tower:7")
    install("minaret", f"{TOWER}SIZES = ('storeys',)")
    (document,) = read_documents("minaret:7")
    assert build_structure(document).details == {"storeys": 7}


BUILDS = "REPORTS = ()\ndef build(document, name):\n    {}\n"


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("return 1 / 0", "ZeroDivisionError: division by zero"),
        (
            "return None",
            "TypeError: found a NoneType; expected a RockingParameters",
        ),
        ("raise SystemExit(0)", "SystemExit: 0"),
        ("raise ValueError('\\x1b[31mred\\x07')", r"ValueError: \x1b[31mred\x07"),
        (
            "return ('F', 2.0)",
            "TypeError: found a tuple; expected a RockingParameters",
        ),
        (
            "from rocking_cli import RockingParameters as P\n"
            "    return P(name=name, structure='failing', p=2, alpha=0.2, eta=0.9,"
            " uplift=0.2, a_scale=1, details={'a': {1}})",
            "TypeError: Object of type set is not JSON serializable",
        ),
    ],
)
def test_a_package_whose_build_fails_is_named(install, rocking, tmp_path, body, words):
    install("failing", BUILDS.format(body))
    (tmp_path / "f.yaml").write_text("name: F\nkind: failing\n")
    done = rocking("params", "f.yaml")
    message = (
        "rocking: f.yaml:2:7: kind: found failing, which the package of-failing adds"
        " and which cannot be used: "
    )
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.startswith(f"{message}{words}; expected a package that works"), (
        done.stderr
    )


def test_known_kinds_never_look_for_packages(monkeypatch):
    def looked(**_):
        raise AssertionError("installed packages were searched")

    monkeypatch.setattr("importlib.metadata.entry_points", looked)
    block = built("kind: block\nwidth: 1\nheight: 5")
    assert built(json.dumps(block.row())) == block
    with pytest.raises(AssertionError, match="searched"):
        built("kind: tower")


@pytest.fixture
def plain(pytestconfig):
    """The structure of a shipped document with other values of some keys, and without
    what it says of damping and of sides.
    """

    def build(name, **values):
        (document,) = read_documents(pytestconfig.rootpath / "configs" / f"{name}.yaml")
        unset = document.keys.keys() & {"damping", "one_sided"}
        for key, value in (dict.fromkeys(unset, "null") | values).items():
            document = document.with_value(key, value, "f.yaml")
        return build_structure(document)

    return build


# a load of a mechanism has a weight, not a mass
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "mechanism"])
def test_every_kind_takes_damping_and_gravity(kind, plain):
    here, damped, moon = (
        plain(kind),
        plain(kind, damping="0.05"),
        plain(kind, gravity="1.62"),
    )
    assert (here.damping, damped.damping, moon.gravity) == (0.0, 0.05, 1.62)
    assert (damped.p, damped.alpha, damped.eta) == (here.p, here.alpha, here.eta)
    with pytest.raises(
        DocumentError,
        match=r"damping: found -0.1; expected a number from 0 to below 1",
    ):
        plain(kind, damping="-0.1")
    if kind != "parameters":  # which states p itself
        assert moon.p == pytest.approx(
            here.p * (1.62 / here.gravity) ** 0.5, rel=1e-12, abs=0
        )
    assert moon.alpha == here.alpha


@pytest.mark.parametrize("name", [*RIGID, "spire_cracked"])
def test_every_rigid_kind_takes_a_mass_alone_and_may_stand_against_a_backing(
    name, plain
):
    free, heavy, wall = (
        plain(name),
        plain(name, mass="1.5 t"),
        plain(name, one_sided="true", restitution="-0.3"),
    )
    assert heavy.details["mass"] == 1500.0
    assert replace(heavy, details=free.details) == free
    assert built(json.dumps(heavy.row())) == heavy
    with pytest.raises(DocumentError, match="mass: found -1; expected a positive mass"):
        plain(name, mass="-1")
    right = free.sides[1] if free.sides else free
    assert (wall.one_sided, wall.sides, wall.eta, wall.eta_source) == (
        True,
        (),
        -0.3,
        "given",
    )
    assert (wall.p, wall.alpha, wall.uplift) == (right.p, right.alpha, right.uplift)
    assert plain(name, one_sided="false") == free


def test_a_sketch_of_a_package_that_is_none_is_told(install):
    install("tower", TOWER + "def sketch(document, built):\n    return [(0.0, 1.0)]\n")
    (document,) = parse_documents("kind: tower\nstoreys: 7", "f.yaml")
    with pytest.raises(
        DocumentError, match=r"f.yaml:1:7: kind: found tower, which the package of-tow"
    ) as told:
        sketch_of(document, build_structure(document))
    assert "TypeError: found a list; expected a Sketch" in str(told.value)
