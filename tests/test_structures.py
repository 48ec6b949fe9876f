"""Structures: parameters against closed forms and published values, invariances, and every refusal."""

from __future__ import annotations

import contextlib
import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rocking_cli import DocumentError, RockingParameters, build_structure, dimensionless_oscillator, parse_documents


def built(text: str) -> RockingParameters:
    (document,) = parse_documents(text, "f.yaml")
    return build_structure(document)


def all_built(text: str) -> list[RockingParameters]:
    return [build_structure(document) for document in parse_documents(text, "f.yaml")]


def test_block_has_housners_parameters():
    b = built("kind: block\nwidth: 0.5\nheight: 2 m")
    radius, alpha = math.hypot(0.25, 1.0), math.atan(0.25)
    assert b.p == pytest.approx(math.sqrt(3 * 9.81 / (4 * radius)), rel=1e-15)
    assert b.alpha == pytest.approx(alpha, rel=1e-15)
    assert b.eta == pytest.approx(1 - 1.5 * math.sin(alpha) ** 2, rel=1e-15)
    assert b.uplift == pytest.approx(0.25, rel=1e-15)
    assert (b.a_scale, b.eta_source, b.name) == (1.0, "momentum", "f")


def test_block_of_the_nonlinear_reference_case():
    # alpha = 0.25 and p = 2.14 rad/s belong to R = 3 g / (4 p^2) = 1.606581 m.
    b = built("kind: block\nradius: 1.60658 m\nalpha: 0.25\nrestitution: 0.9")
    assert b.p == pytest.approx(2.14, abs=1e-6)
    assert (b.eta, b.eta_source) == (0.9, "given")


def test_point_mass():
    m = built("kind: point_mass\nradius: 4 m\nalpha: 20 deg")
    assert m.p == pytest.approx(math.sqrt(9.81 / 4), rel=1e-15)
    assert m.eta == pytest.approx(1 - 2 * math.sin(math.radians(20)) ** 2, rel=1e-15)
    same = built(f"kind: point_mass\nwidth: {8 * math.sin(math.radians(20))!r}\nheight: {4 * math.cos(math.radians(20))!r}")
    assert same.p == pytest.approx(m.p, rel=1e-14)


def test_thin_spire_has_the_reference_values():
    # r_b = 1.5 m, H = 12 m: Eqs. 3.1-3.3 of the paper evaluated independently, to the digits given.
    s = built("kind: spire\nbase_radius: 1.5\nheight: 12")
    assert s.p == pytest.approx(1.250206, abs=1e-6)
    assert s.alpha == pytest.approx(0.358771, abs=1e-6)
    assert s.eta == pytest.approx(0.832168, abs=1e-6)
    kappa = 1.5 / 12
    assert s.p**2 == pytest.approx(9.81 / 12 * math.sqrt(1 / 9 + kappa**2) / (1.25 * kappa**2 + 1 / 6), rel=1e-14)


def test_parameters_give_lambda_and_a_scale_from_each_other():
    base = "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\n"
    assert built(base + "lambda: 0.4").a_scale == pytest.approx(0.5)
    assert built(base + "a_scale: 0.5").uplift == pytest.approx(0.4)
    both = built(base + "lambda: 0.3\na_scale: 1")
    assert (both.uplift, both.a_scale) == (0.3, 1.0)


@pytest.mark.parametrize("text", ["kind: block\nwidth: 0.5\nheight: 2", "kind: spire\nbase_radius: 1\nheight: 9\nname: Ö 'x'"])
def test_a_record_is_a_document_of_the_same_parameters(text):
    import json

    first = built(text)
    (document,) = parse_documents(json.dumps(first.record()), "<stdin>")
    assert build_structure(document) == first


@given(st.floats(0.01, 1.3), st.floats(0.01, 100), st.floats(0.1, 100))
def test_scale_moves_only_p(slenderness, height, factor):
    a = built(f"kind: block\nwidth: {slenderness * height!r}\nheight: {height!r}")
    b = built(f"kind: block\nwidth: {slenderness * height * factor!r}\nheight: {height * factor!r}")
    assert b.p * math.sqrt(factor) == pytest.approx(a.p, rel=1e-12)
    assert (b.alpha, b.eta, b.uplift) == pytest.approx((a.alpha, a.eta, a.uplift), rel=1e-12)
    assert 0 <= a.eta <= 1


@given(st.floats(0.05, 50))
def test_units_do_not_matter(width):
    height = 3 * width
    si = built(f"kind: block\nwidth: {width!r}\nheight: {height!r}")
    mm = built(f"kind: block\nwidth: {1000 * width!r} mm\nheight: {100 * height!r} cm")
    assert mm.p == pytest.approx(si.p, rel=1e-14)


def test_yaml_surprises_are_closed():
    assert built("kind: block\nradius: 010\nalpha: 1e-1\nrestitution: .9").alpha == 0.1
    b = built("kind: block\nradius: 010\nalpha: 1e-1\nrestitution: 9e-1\nname: no")
    assert b.p == pytest.approx(math.sqrt(3 * 9.81 / 40))
    assert (b.name, b.eta) == ("no", 0.9)


def test_json_escapes_of_one_character_are_put_together():
    assert built('{"kind": "block", "width": 1, "height": 5, "name": "\\ud83d\\uddfc"}').name == "\U0001f5fc"


def test_several_documents_json_and_yaml():
    assert [d.index for d in parse_documents("---\nkind: block\n---\nkind: spire\n")] == [0, 1]
    lines = '{"kind":"block","width":1,"height":5}\n\n {"kind": "spire",\n "base_radius":1,"height":"9 m"}\n'
    assert [build_structure(d).structure for d in parse_documents(lines)] == ["block", "spire"]
    assert built("{kind: block, width: 1, height: 5}").structure == "block"


LEVELS = [f"{b}: &{b} [{', '.join(['*' + a] * 10)}]" for a, b in itertools.pairwise("abcdefghij")]
BOMB = "\n".join(["a: &a [1, 1, 1, 1, 1]", *LEVELS])  # 5e9 values in ten lines

REFUSED = [
    ("", "f.yaml: empty"),
    ("# only a comment\n", "f.yaml: empty"),
    ("a: [", "f.yaml:1:5: not valid YAML"),
    ("- 1\n- 2", "f.yaml:1:1: found a list; accepted is a mapping"),
    ("just words", "f.yaml:1:1: found just words"),
    ("width: 1", "no key 'kind'; accepted is kind: one of block, point_mass"),
    ("kind: blok", "f.yaml:1:7: kind: found blok; accepted is one of .*did you mean 'block'"),
    ("kind: block\nwidth: 2\nheigth: 1", "f.yaml:3:1: unknown key 'heigth' .did you mean 'height'"),
    ("kind: block\nwidth: 1\nheight: 5\ncolour: red", "f.yaml:4:1: unknown key 'colour'; accepted for this kind are"),
    ("kind: block\nwidth: 1\nwidth: 2\nheight: 5", "f.yaml:3:1: duplicate key 'width', first given at line 2"),
    ("kind: block\nwidth: 2 kg\nheight: 5", "f.yaml:2:8: width: found 2 kg; accepted is a length.*m, mm, cm"),
    ("kind: block\nwidth: -1\nheight: 5", "f.yaml:2:8: width: found -1; accepted is a positive length"),
    ("kind: block\nwidth: 0\nheight: 5", "found 0; accepted is a positive length"),
    ("kind: block\nwidth: .inf\nheight: 5", "found .inf; accepted is a length"),
    ("kind: block\nwidth: nan\nheight: 5", "found nan; accepted is a length"),
    ("kind: block\nwidth: 1e999\nheight: 5", "found 1e999; .*range of double precision"),
    ("kind: block\nwidth: no\nheight: 5", "found no; accepted is a length"),
    ("kind: block\nwidth: 1:30\nheight: 5", "found 1:30; accepted is a length"),
    ("kind: block\nwidth: [1]\nheight: 5", "found a list; accepted is a length"),
    ("kind: block\nwidth:\nheight: 5", "no key 'width'"),
    ("kind: block\nwidth: 3\nheight: 2", "restitution of .* alpha up to 54.7 deg"),
    ("kind: point_mass\nradius: 1\nalpha: 46 deg", "restitution of .* alpha up to 45 deg"),
    ("kind: block\nradius: 1\nalpha: 90 deg", "found 90 deg; accepted is an angle between 0 and 90 deg"),
    ("kind: block\nradius: 1\nwidth: 1", "width and height, or radius and alpha, not both"),
    ("kind: block\nwidth: 1\nheight: 5\nrestitution: 1.01", "f.yaml:4:14: restitution: found 1.01; accepted is a number from 0 to 1"),
    ("kind: block\nwidth: 1\nheight: 5\nrestitution: -0.1", "found -0.1; accepted is a number from 0 to 1"),
    ("kind: block\nwidth: 1\nheight: 5\ngravity: 0", "found 0; accepted is a positive acceleration"),
    ("kind: block\nwidth: 1\nheight: 5\nname: \"a\\0b\"", "name: found .* accepted is a text of printable characters"),
    ('{"kind": "block", "width": 1, "height": 5, "name": "\\ud83d"}', "f.yaml:1:52: holds half a character"),
    ("kind: block\n<<: {width: 1}\nheight: 5", "f.yaml:2:1: merge keys"),
    (BOMB, "too many values"),
    ("kind: parameters\np: 2\nalpha: 0.2\neta: 0.9", "neither lambda nor a_scale"),
    ("kind: parameters\np: 2\nalpha: 0.2\neta: 1.9\nlambda: 1", "eta: found 1.9; accepted is a number from 0 to 1"),
    ('{"kind": "block", "width": 1,}\n{', "not valid"),
    ('{"kind": "block"}\n{"kind" "block"}', "f.yaml:2:9: not valid JSON"),
    ('{"kind":"block","width":1,"height":5}\n{"kind":"block","width":"2 kg","height":5}', "f.yaml:2:25: width: found \"2 kg\""),
]  # fmt: skip


@pytest.mark.parametrize(("text", "words"), REFUSED, ids=range(len(REFUSED)))
def test_refusals_name_place_key_found_and_accepted(text, words):
    with pytest.raises(DocumentError, match=words) as error:
        all_built(text)
    assert "\n" not in str(error.value)


def test_eta_given_lifts_the_limit_on_alpha():
    assert built("kind: block\nwidth: 3\nheight: 2\nrestitution: 0.5").eta == 0.5


@pytest.mark.parametrize("bad", [{"p": 0.0}, {"alpha": math.nan}, {"eta": 1.2}, {"uplift": -1.0}, {"a_scale": math.inf}])
def test_parameters_validate_themselves(bad):
    good = {"name": "x", "structure": "block", "p": 1.0, "alpha": 0.2, "eta": 0.9, "uplift": 0.2, "a_scale": 1.0}
    with pytest.raises(ValueError, match="accepted is"):
        RockingParameters(**{**good, **bad})


def test_dimensionless_oscillator_scales_nothing():
    o = dimensionless_oscillator(0.9)
    assert o.dimensionless_amplitude(3.0) == 3.0
    assert (o.p, o.name) == (1.0, "eta=0.9")


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused(text):
    with contextlib.suppress(DocumentError):
        all_built(text)
