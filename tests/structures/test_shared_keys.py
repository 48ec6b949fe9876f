"""Keys of every kind."""

from __future__ import annotations

import pytest

from rocking_cli import DocumentError, build_structure
from rocking_cli.structures import KINDS, read_documents


@pytest.fixture
def plain(pytestconfig):
    """The shipped document of a kind, without what it says of damping and of sides."""

    def read(kind):
        (document,) = read_documents(pytestconfig.rootpath / "configs" / f"{kind}.yaml")
        return document.with_value("damping", "null", "f.yaml").with_value("one_sided", "null", "f.yaml")

    return read


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_takes_damping_and_gravity(kind, plain):
    document = plain(kind)
    here = build_structure(document)
    assert here.damping == 0.0
    damped = build_structure(document.with_value("damping", "0.05", "f.yaml"))
    assert damped.damping == 0.05
    assert (damped.p, damped.alpha, damped.eta) == (here.p, here.alpha, here.eta)
    with pytest.raises(DocumentError, match=r"damping: found -0.1; expected a number from 0 to below 1 .zeta."):
        build_structure(document.with_value("damping", "-0.1", "f.yaml"))
    moon = build_structure(document.with_value("gravity", "1.62", "f.yaml"))
    assert moon.gravity == 1.62
    if kind != "parameters":  # which states p itself
        assert moon.p == pytest.approx(here.p * (1.62 / here.gravity) ** 0.5, rel=1e-12, abs=0)
    assert moon.alpha == here.alpha


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("arch", "parameters")])
def test_every_rigid_kind_may_stand_against_a_backing(kind, plain):
    document = plain(kind)
    wall = build_structure(document.with_value("one_sided", "true", "f.yaml").with_value("restitution", "-0.3", "f.yaml"))
    free = build_structure(document)
    right = free.sides[1] if free.sides else free
    assert (wall.one_sided, wall.sides, wall.eta, wall.eta_source) == (True, (), -0.3, "given")
    assert (wall.p, wall.alpha, wall.uplift) == (right.p, right.alpha, right.uplift)
    assert build_structure(document.with_value("one_sided", "false", "f.yaml")) == free
