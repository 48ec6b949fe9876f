"""Bodies that differ in one number are answered together as each alone: every field of
every structure, edge, tie, tendon, contact, equation and body is varied.
"""

import inspect
from dataclasses import fields, is_dataclass, replace
from functools import cached_property

import numpy as np
import pytest
from support.bodies import SYSTEMS
from support.soak import quick

from rocking_cli import (
    LinearEquation,
    Method,
    RigidBodyEquation,
    RockingParameters,
    load_structures,
    parse_grid,
    pulse,
    response,
    sine,
    spectrum,
)
from rocking_cli.dynamics.contacts.contact import Contact, Symmetric
from rocking_cli.dynamics.equations.mechanism import MechanismEquation
from rocking_cli.dynamics.response import response_with_speed
from rocking_cli.dynamics.shared_march import SharedMarch
from rocking_cli.dynamics.system import System
from rocking_cli.responses.check import standings
from rocking_cli.structures.parameters import Side
from rocking_cli.structures.restraints import Restraints, Stand, Tendon, Tie

LINEAR, NONLINEAR = Method("linear"), Method("nonlinear")
(BLOCK,) = load_structures("block:0.5x2")
(UNEQUAL,) = load_structures("rigid:left=0.42,right=0.31,height=1.15,gyration=0.68")
(ARCH,) = load_structures("configs/arch.yaml")
STAND = Stand("left", BLOCK.alpha, 1000.0 * 9.81 * BLOCK.arm, 0.25)
TIED = replace(
    BLOCK,
    restraints=Restraints(
        (Tie(1.8, 2e5, 300.0, 900.0, 0.02, 0.1, "left"),),
        Tendon(1e5, 200.0, 900.0),
        (STAND, STAND._replace(side="right")),
    ),
)
# fields that no motion depends on
TEXTS = {
    *("name", "structure", "eta_source", "details"),
    *("labels", "remarks", "document", "top"),
}
# other values than 1.03 times that of the body
CHANGES = {
    "damping": {"damping": 0.05},
    "one_sided": {"one_sided": True, "eta": -0.6},
    "friction": {"friction": 0.1},
    "kinetic_friction": {"friction": 0.1, "kinetic_friction": 0.05},
    "mechanism": {"mechanism": ARCH.mechanism},
    "sides": {
        name: getattr(UNEQUAL, name)
        for name in ("sides", "p", "alpha", "eta", "uplift", "a_scale", "arm")
    },
    "restraints": {"restraints": TIED.restraints},
}
SIDES = {"left": "both", "right": "both", "both": "left"}


def other(x):
    """A value that differs a little from x."""
    if isinstance(x, bool):
        return not x
    if isinstance(x, str):
        return SIDES[x]
    if isinstance(x, tuple):
        return tuple(map(other, x))
    return x * 1.03


def varied():
    """Bodies that differ from a body in one field each, by label."""
    found = {"block": BLOCK, "block, no arm": replace(BLOCK, arm=None)}
    for field in fields(RockingParameters):
        name = field.name
        if name not in TEXTS:
            change = CHANGES.get(name) or {name: other(getattr(BLOCK, name))}
            found[f"block, {name}"] = replace(BLOCK, **change)
    found["unequal"] = UNEQUAL
    strong, weak = UNEQUAL.sides
    if strong.uplift == UNEQUAL.uplift:
        strong, weak = weak, strong
    for field in fields(Side):
        if field.name not in ("side", "mechanism"):
            value = getattr(strong, field.name)
            one = replace(strong, **{field.name: other(value)})
            sides = sorted((one, weak), key=lambda side: side.side)
            found[f"edge, {field.name}"] = replace(UNEQUAL, sides=tuple(sides))
    for label, body in (("block", BLOCK), ("edge", UNEQUAL)):
        for zeta in (0.02, 0.08):
            found[f"{label}, damping {zeta}"] = replace(body, damping=zeta)
    found["tied"] = TIED
    held = TIED.restraints
    for part, kind in (("ties", Tie), ("tendon", Tendon)):
        of = held.ties[0] if part == "ties" else held.tendon
        for field in fields(kind):
            new = replace(of, **{field.name: other(getattr(of, field.name))})
            new = (new,) if part == "ties" else new
            found[f"{part}, {field.name}"] = replace(
                TIED, restraints=replace(held, **{part: new})
            )
    for name in ("alpha", "moment", "lever"):
        stand = STAND._replace(**{name: other(getattr(STAND, name))})
        stands = stand, stand._replace(side="right")
        found[f"stand, {name}"] = replace(TIED, restraints=replace(held, stands=stands))
    for name in ("alpha", "p", "gravity", "arm", "damping"):
        change = CHANGES.get(name) or {name: other(getattr(TIED, name))}
        found[f"tied, {name}"] = replace(TIED, **change)
    return found


BODIES = varied()


# (A, omega_g/p) that tells apart all bodies that a motion tells apart
ONE = np.array([[2.3], [4.5]])
MANY = np.random.default_rng(5).uniform((1.0, 0.7), (4.0, 6.0), (100, 2)).T


# Some bodies, and fields that stand beside the system: outside the soak.
TOLD = ("block", "unequal", "edge, alpha", "tied", "ties, stiffness")
TOLD += ("block, damping 0.02", "block, damping 0.08")
FIELDS = ("eta", "gravity", "friction", "kinetic_friction", "one_sided", "damping")


def some(every):
    """The bodies; outside the soak those of the labels and fields above."""
    return {
        label: s
        for label, s in BODIES.items()
        if every or label in TOLD or label.split(", ")[-1] in FIELDS
    }


@pytest.mark.parametrize("every", quick((False, True), False))
@pytest.mark.parametrize("peaks", quick((True, False), True))
@pytest.mark.parametrize("cells", [ONE, pytest.param(MANY, marks=pytest.mark.soak)])
@pytest.mark.parametrize("method", quick((LINEAR, NONLINEAR), NONLINEAR))
def test_a_shared_march_answers_each_body_as_alone(method, cells, peaks, every):
    bodies = {
        label: s
        for label, s in some(every).items()
        if method.serves(s) and "friction" not in label
    }
    march = SharedMarch(sine(2), list(bodies.values()), [method] * len(bodies))
    group = dict(zip(bodies, march.group.tolist(), strict=True))
    assert group["tied"] == group["ties, stiffness"]
    assert group["unequal"] == group["edge, alpha"]
    assert group["block, damping 0.02"] == group["block, damping 0.08"]
    which = np.repeat(np.arange(len(bodies)), cells.shape[1])
    together = march.response(which, *np.tile(cells, len(bodies)), peaks)
    for i, (label, s) in enumerate(bodies.items()):
        own = which == i
        alone = response(method.system_of(s), sine(2), *cells, peaks=peaks)
        # without peaks sequences may be closed in one step, which are not counted
        for found, one in list(zip(together, alone, strict=False))[: 2 + peaks]:
            np.testing.assert_array_equal(found[own], one, label)


@pytest.mark.parametrize("every", quick((False, True), False))
@pytest.mark.parametrize("method", quick((LINEAR, NONLINEAR), NONLINEAR))
def test_a_spectrum_has_each_body_as_alone(method, every):
    bodies = {label: s for label, s in some(every).items() if method.serves(s)}

    def of(*structures):
        grid = parse_grid("a_g=0.5g:0.9g:2,f_g=2")
        return spectrum(structures, sine(), grid, method=method, workers=1, check=0)

    together = of(*bodies.values())
    for i, (label, s) in enumerate(bodies.items()):
        alone = of(s)
        for name in ("outcome", "theta_ratio"):
            np.testing.assert_array_equal(
                getattr(together, name)[i], getattr(alone, name)[0], label
            )


# A body falls under the one pulse before its first impact.
@pytest.mark.parametrize("every", quick((False, True), False))
@pytest.mark.parametrize(
    "motion", [pulse("rectangular"), pytest.param(sine(), marks=pytest.mark.soak)]
)
def test_a_check_of_many_bodies_gives_the_verdict_on_each_alone(motion, every):
    """Of outcome, and of capacity to its 1e-9; the shared march has the bodies with
    restraints.
    """
    shaking = parse_grid("a_g=0.35g,f_g=2")
    bodies = {label: s for label, s in some(every).items() if s.restraints is None}
    asked = [(s, motion, shaking) for s in bodies.values()]
    together = standings(asked, a_max=1.6, workers=1)
    for one, demand, label in zip(together, asked, bodies, strict=True):
        (alone,) = standings([demand], a_max=1.6, workers=1)
        assert (one.outcome, one.narrow) == (alone.outcome, alone.narrow), label
        capacities = [x.capacity_demand or np.inf for x in (one, alone)]
        assert capacities[0] == pytest.approx(capacities[1], rel=1e-9), label


def parts(x, path=()):
    """The records and objects with fields that a system consists of, with their
    places.
    """
    if hasattr(x, "_asdict"):
        own = x._asdict()
    elif is_dataclass(x) or isinstance(x, Contact):
        own = {name: getattr(x, name) for name in vars(x)}
    else:
        return
    for name, value in own.items():
        if isinstance(getattr(type(x), name, None), cached_property):
            continue
        yield (*path, name), value
        yield from parts(value, (*path, name))


def with_value(x, path, value):
    """The system x with another value at this place."""
    first, *rest = path
    new = with_value(getattr(x, first), rest, value) if rest else value
    return (
        x._replace(**{first: new})
        if hasattr(x, "_replace")
        else replace(x, **{first: new})
    )


def differing():
    """Pairs of systems that differ in one field, with its place."""
    whole = {
        "rigid": NONLINEAR.system_of(BLOCK),
        "unequal": NONLINEAR.system_of(UNEQUAL),
        "linear": LINEAR.system_of(UNEQUAL),
        "tied": NONLINEAR.system_of(TIED),
    }
    for label, system in whole.items():
        for path, value in parts(system):
            if value is None or hasattr(value, "__dict__") or hasattr(value, "_asdict"):
                continue
            if isinstance(value, tuple) and isinstance(value[0], str):
                new = tuple(f"{name} " for name in value)
            elif isinstance(value, np.ndarray) and value.dtype == bool:
                new = ~value
            elif path[-1] == "eta":
                pair = isinstance(value, tuple)
                new = (value[0] * 0.97, value[1]) if pair else value * 0.97
            else:
                new = 0.02 if isinstance(value, float) and not value else other(value)
            place = ".".join(path)
            yield f"{label}-{place}", system, with_value(system, path, new)
    for kind, given, changes in (
        (LinearEquation, {}, {"damping": 0.05}),
        (LinearEquation, {"damping": 0.02}, {"damping": 0.05}),
        (
            RigidBodyEquation,
            {"alpha": 0.25, "damping": 0.02},
            {"alpha": 0.26, "tolerance": 1e-8, "damping": 0.05},
        ),
        (
            RigidBodyEquation,
            {"alpha": (0.25, 0.2), "damping": 0.02},
            {"alpha": (0.25, 0.21), "tolerance": 1e-8, "damping": 0.05},
        ),
        (
            RigidBodyEquation,
            {"alpha": 0.25},
            {"alpha": 0.26, "tolerance": 1e-8, "damping": 0.05},
        ),
        (
            RigidBodyEquation,
            {"alpha": (0.25, 0.2)},
            {"alpha": (0.25, 0.21), "tolerance": 1e-8, "damping": 0.05},
        ),
        (
            MechanismEquation,
            {"mechanism": ARCH.mechanism},
            {"mechanism": None, "tolerance": 1e-8, "damping": 0.05},
        ),
    ):
        assert set(given | changes) == set(inspect.signature(kind).parameters)
        unlike = isinstance(given.get("alpha"), tuple)
        contact = (
            SYSTEMS["a damped body of unlike edges"][0].contact
            if unlike
            else Symmetric(0.9)
        )
        for name, value in changes.items():
            if value is not None:
                yield (
                    f"{kind.__name__}-{'-'.join(given)}-{name}",
                    System(kind(**given), contact),
                    System(kind(**given | {name: value}), contact),
                )


def answer(system, amplitude, omega):
    """Outcome, rotation, impacts and, of a body without ties, largest speed."""
    cells = system, sine(2), amplitude, omega
    found, *speed = (
        response_with_speed(*cells) if system.devices is None else (response(*cells),)
    )
    return found.outcome, found.theta_ratio, found.impacts_at_least, *speed


def test_systems_that_differ_in_one_field_are_not_the_same():
    """Where their cells may share a march, they have the bits of each alone, and so
    have the largest speeds of bodies without ties.
    """
    shared = {}
    for place, one, another in differing():
        assert one.key() != another.key(), place
        for system in (one, another):
            group = shared.setdefault(system.march_key(mixed=True), {})
            group.setdefault(system.key(), (place, system))
    assert max(map(len, shared.values())) > 15
    for group in (group for group in shared.values() if len(group) > 1):
        places, systems = zip(*group.values(), strict=True)
        many = len(systems)
        both = System.of_each_cell(systems, [1] * many)
        together = answer(both, *np.tile(ONE, many))
        for i, (place, system) in enumerate(zip(places, systems, strict=True)):
            for found, one in zip(together, answer(system, *ONE), strict=True):
                np.testing.assert_array_equal(found[i], one[0], place)
