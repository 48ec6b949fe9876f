"""Forces at the hinges of an arch along its response, against the momenta of its links
as another hand places them.
"""

import numpy as np
import pytest
from oracles.arch_linkage import SECOND, Linkage, carried, links_of, places
from oracles.collocation import Edge, integrate
from support.bodies import shaking_of
from support.documents import built

from rocking_cli import (
    Method,
    check,
    cosine,
    load_structures,
    parse_grid,
    response,
    sine,
    time_history,
)
from rocking_cli.motions.biaxial import with_vertical

HINGE_COLUMNS = [f"hinge{n}_{axis}" for n in (1, 2, 3, 4) for axis in ("fx", "fz")]
(ARCH,) = load_structures(["configs/arch.yaml"])
EXACT = Method("nonlinear", 1e-13)


def history_of_arch(motion, amplitude=1.6, omega=5.0):
    return time_history(
        ARCH,
        motion,
        parse_grid(f"A={amplitude!r},Omega={omega!r}"),
        [EXACT],
        duration=1.2,
    )


@pytest.fixture(scope="module")
def swaying():
    return history_of_arch(with_vertical(sine(2), cosine(3), 0.4))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_each_link_moves_as_the_forces_at_its_hinges_say(swaying, side):
    """Newton and Euler of every link: its forces at both hinges and its weight, against
    second differences of its place.
    """
    history, forces = swaying.histories["nonlinear"], swaying.forces["nonlinear"]
    arcs = history.arcs
    arc = np.argmax(np.where(arcs.side == side, arcs.stop - arcs.start, 0.0))
    start, stop = arcs.start[arc], arcs.stop[arc]
    tau, h, p, g = 0.5 * (start + stop), 0.04 * (stop - start), ARCH.p, ARCH.gravity
    mirror = np.array([side, 1.0])
    weight = forces.statics[1.0].weight
    # from left to right, and back to the order of the mechanism
    at = (
        np.array(
            [float(forces.columns(np.array([tau]))[name][0]) for name in HINGE_COLUMNS]
        ).reshape(4, 2)
        * weight
    )
    hinges = at if side > 0.0 else -(at[::-1] * mirror) * np.array([1.0, 1.0])
    phis = {
        i: abs(float(history.at(np.array([tau + i * h]))[0][0])) * ARCH.alpha
        for i in range(-4, 5)
    }
    points, own = links_of(ARCH.mechanism)
    motion = {i: carried(points, own, phi) for i, phi in phis.items()}
    acceleration = (
        sum(w * (motion[i] + motion[-i] if i else motion[0]) for i, w in SECOND.items())
        / h**2
        * p
        * p
    )
    across, up = forces.ground.at(np.array([tau]))
    ground = np.array([side * float(across[0]), 1.0 + float(up[0])]) * g
    now = places(points, phis[0])
    for i, (m, x, z, polar) in enumerate(own):
        centre, turn = motion[0][i, :2], acceleration[i, 2]
        assert hinges[i] - hinges[i + 1] == pytest.approx(
            m * (acceleration[i, :2] + ground), abs=1e-6 * weight
        )
        (ax, az), (bx, bz) = now[i] - centre, now[i + 1] - centre
        moment = (
            az * hinges[i, 0]
            - ax * hinges[i, 1]
            - bz * hinges[i + 1, 0]
            + bx * hinges[i + 1, 1]
        )
        assert moment == pytest.approx(
            (polar - (x * x + z * z) / m) * turn,
            abs=1e-6 * weight * ARCH.mechanism.ring.radius,
        )


@pytest.mark.slow
def test_the_largest_force_at_a_hinge_is_an_extreme_of_the_history(swaying):
    forces = swaying.forces["nonlinear"]
    tau = np.linspace(0.0, swaying.end, 400)
    columns = forces.columns(tau)
    sizes = np.array(
        [
            np.hypot(columns[f"hinge{n}_fx"], columns[f"hinge{n}_fz"])
            for n in (1, 2, 3, 4)
        ]
    )
    worst = forces.extremes["hinge_force"]
    assert np.nanmax(sizes) <= worst.value * (1.0 + 1e-12)
    assert np.nanmax(sizes) == pytest.approx(worst.value, rel=2e-2)
    assert columns["hinge1_fx"] - columns["hinge4_fx"] == pytest.approx(
        columns["fx_ratio"], abs=1e-12, nan_ok=True
    )
    assert columns["hinge1_fz"] - columns["hinge4_fz"] == pytest.approx(
        columns["fz_ratio"], abs=1e-12, nan_ok=True
    )
    record = forces.summary("t", 1.0)
    assert (record["hinge_force"], record["hinge_force_hinge"]) == (
        worst.value,
        worst.place,
    )


def test_the_mirrored_motion_has_the_mirrored_forces():
    one, other = (
        history_of_arch(motion).forces["nonlinear"].columns(np.linspace(0.0, 3.0, 40))
        for motion in (sine(1), sine(1).scaled(-1))
    )
    for n in (1, 2, 3, 4):
        assert one[f"hinge{n}_fx"] == pytest.approx(
            other[f"hinge{5 - n}_fx"], abs=1e-12, nan_ok=True
        )
        assert one[f"hinge{n}_fz"] == pytest.approx(
            -other[f"hinge{5 - n}_fz"], abs=1e-12, nan_ok=True
        )


def against_the_linkage(cells, seed):
    """Largest difference of theta/alpha under horizontal and vertical motion; what
    overturns must overturn both ways.
    """
    (arch,) = load_structures("arch:10x1.5x157.5deg")
    edge = Edge(arch.p, arch.alpha, arch.eta)
    linkage = Linkage(*links_of(arch.mechanism), 2.5 * arch.alpha, arch.gravity, edge)
    random, worst, stood = np.random.default_rng(seed), 0.0, 0
    for _ in range(cells):
        motion = with_vertical(sine(1), cosine(2), float(random.uniform(-0.5, 0.5)))
        amplitude, omega = random.uniform(1.2, 2.5), random.uniform(2.0, 6.0)
        wanted = integrate(linkage, shaking_of(arch, motion, amplitude, omega)).rotation
        found = float(
            response(
                Method("nonlinear", 1e-12).system_of(arch),
                motion,
                amplitude,
                omega,
                arch.eta,
            ).theta_ratio
        )
        assert np.isnan(found) == np.isnan(wanted)
        if not np.isnan(found):
            worst, stood = max(worst, abs(found - wanted)), stood + 1
    assert stood > 0
    return worst


def test_an_arch_under_vertical_motion_sways_as_its_energies_say():
    assert against_the_linkage(1, 2) < 1e-9


@pytest.mark.soak
def test_arches_under_vertical_motion_sway_as_their_energies_say():
    assert against_the_linkage(40, 5) < 1e-7


@pytest.mark.parametrize(("friction", "slides"), [(0.05, True), (50.0, False)])
def test_a_check_compares_the_friction_of_an_arch_with_its_joints(friction, slides):
    arch = built(
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nvoussoirs: 7\n"
        f"friction: {friction}"
    )
    shaking = parse_grid("a_g=0.45g,f_g=1")
    found = check(arch, sine(), shaking, a_max=None)
    (row,) = time_history(arch, sine(), shaking).summaries(forces=True)
    assert found.friction_needed == row["friction_needed"]
    assert found.slides == row["slides"] == slides
