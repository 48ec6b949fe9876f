"""The arch: reference values, families, invariances and refusals."""

import contextlib
import math

import numpy as np
import pytest
from oracles.thrust_line import largest_tilt
from support.documents import built

from rocking_cli import DocumentError, parse_documents
from rocking_cli.structures.kinds import keys_of
from rocking_cli.structures.kinds.arch import ring_of

OPPENHEIM = "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\n"


@pytest.mark.requirement(
    "An arch rocks as the mechanism of the least lambda",
    "structures/mechanics/hinges.py",
    "Oppenheim's arch of seven voussoirs",
    "The same arch, hinges anywhere",
)
def test_oppenheims_seven_voussoirs_have_the_reference_values():
    # lambda and hinges as published by Oppenheim (1992); the others evaluated
    # independently, to the digits given.
    a = built(OPPENHEIM + "voussoirs: 7")
    assert a.uplift == pytest.approx(0.370010, abs=1e-6)
    assert a.p == pytest.approx(1.84211, abs=1e-5)
    assert a.alpha == pytest.approx(0.0690647, abs=1e-7)
    assert a.a_scale == pytest.approx(0.186656, abs=1e-6)
    assert a.details["a_scale_3_7"] == pytest.approx(0.280405, abs=1e-6)
    assert a.eta == pytest.approx(0.644960, abs=1e-6)
    assert [math.degrees(h["angle"]) for h in a.details["hinges"]] == pytest.approx(
        [0, 67.5, 112.5, 157.5], abs=1e-12
    )
    assert [h["face"] for h in a.details["hinges"]] == [
        "intrados",
        "extrados",
        "intrados",
        "extrados",
    ]
    for hinge, (rho, degrees) in zip(
        a.details["hinges"],
        [(9.25, 168.75), (10.75, 101.25), (9.25, 56.25), (10.75, 11.25)],
        strict=True,
    ):
        polar = math.radians(degrees)
        assert (hinge["x"], hinge["z"]) == pytest.approx(
            (rho * math.cos(polar), rho * math.sin(polar)), rel=1e-13, abs=0
        )

    at = a.mechanism.coefficients(np.array([0.01, 0.03, 0.05]))
    assert at.lift / at.push == pytest.approx([0.28776, 0.16554, 0.07310], abs=1e-5)


def test_continuous_arch_hinged_at_its_springing():
    # An independent evaluation that kept hinge A on the springing found these;
    # test_..._leaves_the_springing has the minimum.
    a = built(OPPENHEIM + "hinges: [0, 59.297 deg, 117.063 deg, 157.5 deg]")
    values = (a.uplift, a.p, a.alpha, a.a_scale, a.eta)
    assert values == pytest.approx(
        (0.353498, 1.759029, 0.0904157, 0.255774, 0.733335), abs=1e-5
    )
    assert a.uplift == pytest.approx(0.353498, abs=1e-6)


@pytest.mark.parametrize(
    ("beta", "thickness", "count", "p"),
    [(250, 0.80, 11, 3.0564), (200, 0.50, 5, 3.5709), (195, 0.40, 5, 3.8673)],
)
def test_stiffness_next_to_a_locking_position(beta, thickness, count, p):
    # p from central differences of an independent V', stable to 5 digits over steps
    # from 1e-4 to 1e-6.
    a = built(
        f"kind: arch\nradius: 1\nthickness: {thickness}\nangle: {beta} deg\nvoussoirs:"
        f" {count}"
    )
    assert a.p == pytest.approx(p, abs=1e-4)


def test_given_hinges_say_what_governs():
    a = built(OPPENHEIM + "hinges: [0, 20 deg, 110 deg, 157.5 deg]\nrestitution: 0.6")
    assert a.uplift > 0.55
    assert a.details["lambda_governing"] == pytest.approx(0.353384, abs=1e-6)


@pytest.mark.requirement(
    "An arch that cannot carry itself is refused",
    "structures/kinds/arch.py",
    "Semicircular arch that just stands",
    "Semicircular arch that does not",
)
@pytest.mark.parametrize(
    ("beta", "eta"),
    [(300, ""), (180, "restitution: 0.5"), (149.336, "restitution: 0.5")],
)
def test_very_thick_arches_are_solved_or_refused(beta, eta):
    for thickness in (0.85, 0.88, 0.9, 0.95):
        with contextlib.suppress(DocumentError):
            a = built(
                f"kind: arch\nradius: 1\nthickness: {thickness}\nangle: {beta}"
                f" deg\n{eta}"
            )
            assert (
                a.uplift <= largest_tilt(1.0, thickness, math.radians(beta), 90) + 1e-6
            )


def test_scale_moves_only_p_and_the_mirror_image_moves_nothing():
    small, large = (
        built(f"kind: arch\nradius: {size}\nthickness: {0.15 * size}\nangle: 160 deg")
        for size in (1, 25)
    )
    assert large.p * 5 == pytest.approx(small.p, rel=1e-11, abs=0)
    for name in ("alpha", "uplift", "a_scale", "eta"):
        assert getattr(large, name) == pytest.approx(
            getattr(small, name), rel=1e-10, abs=0
        )
    given = OPPENHEIM + "voussoirs: 7\nhinges: "
    right = built(given + "[0, 67.5 deg, 112.5 deg, 157.5 deg]")
    faces = ["extrados", "intrados"] * 2
    left = built(
        given
        + str(
            [
                {"angle": f"{s} deg", "face": f}
                for s, f in zip((0, 45, 90, 157.5), faces, strict=True)
            ]
        )
    )
    for name in ("p", "alpha", "uplift", "a_scale", "eta"):
        assert getattr(left, name) == pytest.approx(
            getattr(right, name), rel=1e-12, abs=0
        )


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.12, pytest.param(0.2, marks=pytest.mark.soak)])
def test_family_over_the_papers_range_is_smooth(ratio):
    """Fig. 6: beta 150-180 deg, t/r 0.12-0.20. Between neighbours 3 deg apart each
    parameter moves by some percent of its range at the most; slopes may change where an
    end hinge leaves the springing, values do not jump.
    """
    family = [
        built(f"kind: arch\nradius: 10\nthickness: {10 * ratio}\nangle: {beta} deg")
        for beta in range(150, 181, 3)
    ]
    for name in ("p", "alpha", "uplift", "a_scale", "eta"):
        values = np.array([getattr(a, name) for a in family])
        assert np.abs(np.diff(values)).max() < 0.3 * np.ptp(values), name


@pytest.mark.parametrize(
    ("line", "outward"), [("centre-line", 0.0), ("intrados", 0.5), ("extrados", -0.5)]
)
@pytest.mark.parametrize("angle", [100.0, 157.5, 180.0, 200.0])
def test_span_and_rise_are_radius_and_angle_of_the_face_they_are_measured_on(
    line, outward, angle
):
    thickness, half = 1.5, math.radians(0.5 * angle)
    measured = (
        10.0 - outward * thickness
    )  # radius of that face, of a centre line of 10 m
    span, rise = 2.0 * measured * math.sin(half), measured * (1.0 - math.cos(half))
    for pair in (
        f"span: {span!r}\nrise: {rise!r}",
        f"radius: {measured!r}\nangle: {angle} deg",
    ):
        (document,) = parse_documents(
            f"kind: arch\nmeasured: {line}\nthickness: {thickness}\n{pair}"
        )
        document.declare(keys_of("arch"))
        assert ring_of(document) == pytest.approx(
            (10.0, thickness, 2.0 * half), rel=1e-14, abs=0
        )
