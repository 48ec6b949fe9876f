"""Motion documents: the motion that they state, and refusals."""

import math

import numpy as np
import pytest
from support.documents import TWO_PULSES, built_motion
from support.refusals import refuses

from rocking_cli import DocumentError


def test_own_pieces_are_what_they_say():
    motion = built_motion(TWO_PULSES)
    cycle = np.array([0.25, 0.6, 0.8, 1.0, 1.2, 1.45])
    third = 2 * math.pi * 1.45
    last = 0.5 * math.cos(third) + 0.2 * math.sin(3 * third)
    start = 0.5 * math.cos(2 * math.pi * 1.2) + 0.2 * math.sin(6 * math.pi * 1.2)
    assert motion.value(2 * math.pi * cycle) == pytest.approx(
        [1.0, 0.0, -0.6, -0.3, start, last], abs=1e-12
    )


REFUSED = [
    ("pieces: []", "pieces: found 0 entries"),
    ("pieces: 3", "a list of pieces"),
    ("name: x", "neither pieces nor points"),
    (
        "points: [[0, 1], [1, 1]]\npieces: [{from: 0, to: 1, constant: 1}]",
        "both pieces and points",
    ),
    (
        "pieces: [{from: 0, to: 1, constant: 1}, {from: 0.5, to: 2, constant: 1}]",
        ":1:.*overlaps the one before; expected 1",
    ),
    (
        "pieces: [{from: 0, to: 1, constant: 1}, {from: 1.5, to: 2, constant: 1}]",
        "leaves a gap",
    ),
    ("pieces: [{from: 0, to: 0, constant: 1}]", "a time in periods after 0"),
    ("pieces: [{from: 0, to: 1}]", "without constant, slope or sines"),
    ("pieces: [{from: 0, to: 1, constant: 0}]", "zero throughout"),
    ("pieces: [{from: 0, to: 1, constnat: 1}]", "constant|constnat"),
    (
        "pieces: [{from: 0, to: 1, sines: [{amplitude: 1, frequency: 0}]}]",
        "a positive multiple",
    ),
    (
        "pieces: [{from: 0, to: 1, sines: [{amplitude: nan}]}]",
        "a number without a unit",
    ),
    ("points: [[0, 1]]", "two or more points"),
    ("points: [[1, 1], [2, 2]]", "begins at 0"),
    ("points: [[0, 1], [1, x]]", "not a pair of numbers"),
    ("points: [[0, 1], [1, 1]]\nunits: g", "unknown key 'units'"),
    (
        "pieces: [{from: 0, to: 1, sines: [{amplitude: 1, frequency: 1e300}]}]",
        "frequency: found 1e300",
    ),
    (
        "pieces: [{from: 0, to: 1, sines: [{amplitude: 1, phase: 1e20}]}]",
        "phase: found 1e20",
    ),
    (
        "pieces: [{from: 0, to: 1, constant: 1e308, slope: 1e308}]",
        "constant: found 1e308",
    ),
    ("points: [[0, 1], [1e-300, 2]]", "rising times"),
    ("points: [[0, 0], [1e300, 1]]", "up to 100000 cycles"),
    ("points: [[0, 0], [1, 1e300]]", "acceleration"),
]
test_faulty_motion_documents_name_the_fault = refuses(
    built_motion, DocumentError, REFUSED
)
