"""Tied bodies drawn at random, and what shakes them."""

import math
from contextlib import suppress

import numpy as np

from rocking_cli import DocumentError, Motion, RockingParameters, pulse, sine
from rocking_cli.motions.biaxial import with_vertical

from .bodies import Range
from .documents import built
from .synthetic_records import motion_of_samples

GRAVITY = 9.81
UP = ("sine", "cosine", "mavroeidis-papageorgiou", "rectangular-impulse")


def random_tied(random: np.random.Generator, widths: Range) -> RockingParameters:
    """A block with one to three ties, which may yield or break, often a tendon, often
    damping, on one or two sides; widths: range of width over height.
    """
    while True:
        with suppress(DocumentError):  # a tie that cannot break, or pull so much
            return built(_document(random, widths))


def _document(random: np.random.Generator, widths: Range) -> str:
    height = random.uniform(1, 6)
    width, mass = height * random.uniform(*widths), 10 ** random.uniform(2.5, 4)
    weight, one_sided = mass * GRAVITY, random.random() < 0.25
    ties = [
        _tie(random, height, width, weight, one_sided)
        for _ in range(random.integers(1, 4))
    ]
    text = f"kind: block\nwidth: {width}\nheight: {height}\nmass: {mass}\n"
    if one_sided:
        text += "one_sided: true\nrestitution: -0.4\n"
    elif random.random() < 0.4:
        prestress = random.uniform(0.05, 0.8) * weight
        stiffness, rupture = 10 ** random.uniform(5, 7), random.uniform(1.05, 3)
        text += (
            f"tendon: {{stiffness: {stiffness}, prestress: {prestress}, rupture:"
            f" {rupture * prestress}}}\n"
        )
        ties = ties[random.integers(2) :]
    if ties:
        text += f"ties: [{', '.join(ties)}]\n"
    if width / height > 1.4 and not one_sided:
        text += f"restitution: {random.uniform(0.2, 0.9)}\n"
    if random.random() < 0.3:
        text += f"damping: {random.choice([0.02, 0.1, 0.3])}\n"
    return text


def _tie(
    random: np.random.Generator,
    height: float,
    width: float,
    weight: float,
    one_sided: bool,
) -> str:
    stiffness = 10 ** random.uniform(4, 7)
    prestress = random.choice([0.0, random.uniform(0, 0.5) * weight])
    force = prestress + random.uniform(0.02, 1) * weight
    keys = {
        "height": height * random.uniform(0.3, 1),
        "stiffness": stiffness,
        "prestress": prestress,
        "behind": random.choice([0.0, random.uniform(0, width)]),
        "side": "right" if one_sided else random.choice(["left", "right", "both"]),
    }
    if random.random() < 0.5:
        keys["yield"] = force
    if random.random() < 0.4:
        keys["ultimate"] = (force - prestress) / stiffness * random.uniform(1.01, 20)
    return "{" + ", ".join(f"{key}: {x}" for key, x in keys.items()) + "}"


def random_motion(random: np.random.Generator, vertical: bool) -> Motion:
    """A pulse of either sign or a short record, with another one upwards."""
    if random.random() < 0.3:
        rows = np.pad(random.uniform(-1.0, 1.0, (2, 38)), ((0, 0), (1, 1)))
        across, up = (motion_of_samples(row, 0.05) for row in rows)
    else:
        across = sine(float(random.choice([0.5, 1, 2])))
        if random.random() < 0.3:
            across = pulse("mavroeidis-papageorgiou")
        across = across.scaled(float(random.choice([1.0, -1.0])))
        up = pulse(str(random.choice(UP)))
    share = random.uniform(0.2, 0.7)
    return with_vertical(across, up, share) if vertical else across


def random_push(
    random: np.random.Generator, body: RockingParameters, motion: Motion
) -> tuple[float, float]:
    """(A, Omega) at which the body may lift, with |zg''| < g."""
    omega = 2.0 * math.pi / random.uniform(0.2, 1.5) / body.p
    if motion.samples is not None:
        omega = 1.0 / body.p
    strongest = random.uniform(0.9, 5.0) * math.tan(body.alpha)
    if motion.vertical is not None:
        strongest = min(strongest, 0.9 / motion.vertical.largest)
    return float(body.dimensionless_amplitude(strongest * body.gravity)), omega
