"""The pulses by name. A new pulse is one function that returns its pieces and one line in PULSES."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import MotionError
from .motion import Harmonic, Motion, Piece

MOST_CYCLES = 100_000


def sine(cycles: float = 1.0) -> Motion:
    """sin(phi) for `cycles` cycles, any number of half cycles (0.5, 1, 1.5, ...). Section 2 of the paper.

    Raises MotionError when `cycles` is not a positive multiple of one half.
    """
    return _trigonometric("sine", cycles, 0.0)


def cosine(cycles: float = 1.0) -> Motion:
    """cos(phi) for `cycles` cycles, any number of half cycles; it begins with a jump, so uplift is at t = 0+.

    Raises MotionError when `cycles` is not a positive multiple of one half.
    """
    return _trigonometric("cosine", cycles, np.pi / 2)


def _trigonometric(name: str, cycles: float, phase: float) -> Motion:
    halves = 2.0 * cycles
    if not (1.0 <= halves <= 2.0 * MOST_CYCLES and halves == np.rint(halves)):
        raise MotionError(f"{name} pulse: cycles is {cycles:g}, accepted is a positive multiple of 0.5 up to {MOST_CYCLES}")
    return Motion(f"{name}, {cycles:g} cycle{'' if cycles == 1 else 's'}", (Piece(0.0, halves * np.pi, (Harmonic(1.0, 1.0, phase),)),))


PULSES: dict[str, Callable[[float], Motion]] = {"sine": sine, "cosine": cosine}


def pulse(name: str, cycles: float = 1.0) -> Motion:
    """The pulse of that name. Raises MotionError when there is none or `cycles` does not fit it."""
    try:
        make = PULSES[name]
    except KeyError:
        raise MotionError(f"unknown pulse {name!r}, accepted are {', '.join(PULSES)}") from None
    return make(cycles)
