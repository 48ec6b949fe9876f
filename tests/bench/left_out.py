"""What leaving things out saves: each shortcut of the engine taken away from a scene,
one at a time, in the same run.

The engine has no switch for this; its parts are replaced from outside. Prints the table
of `rocking help accuracy`.
"""

import time
from contextlib import nullcontext
from functools import partial
from unittest import mock

import numpy as np
import scenes

from rocking_cli import (
    Motion,
    dimensionless_oscillator,
    linear_response,
    parse_grid,
    sine,
    spectrum,
)
from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.equations.linear import LinearEquation
from rocking_cli.dynamics.march import engine
from rocking_cli.motions import Piece

AXIS, GRID = scenes.axis(300), parse_grid("A=0.5:12:200,Omega=0.5:12:200")
PULSE = sine().pieces
MARCHED = Motion(
    "sine and five periods of rest",
    (*PULSE, Piece(PULSE[-1].stop, PULSE[-1].stop + 10.0 * np.pi)),
)


def scene(motion=None, amplitude=AXIS, omega=AXIS, peaks=True):
    return partial(
        linear_response,
        motion or sine(),
        amplitude[None, :],
        omega[:, None],
        scenes.ETA,
        peaks=peaks,
    )


def structures(apart):
    """A spectrum of ten structures whose restitutions are so far apart."""
    return partial(
        spectrum,
        [dimensionless_oscillator(eta=scenes.ETA - apart * i) for i in range(10)],
        sine(),
        GRID,
        workers=1,
    )


def ratio(name, kept, plain=None, patch=None):
    """Print the processor time without the shortcut over the time with it, the least of
    two; patch: what takes the shortcut away.
    """
    times = np.full((2, 2), np.inf)
    for pair in times:
        for i, action in enumerate((kept, plain or kept)):
            with mock.patch.object(*patch) if patch and i else nullcontext():
                start = time.process_time()
                action()
                pair[i] = time.process_time() - start
    least = times.min(axis=0)
    print(
        f"{name:<58}{least[1] / least[0]:7.2f} times  ({1e3 * least[0]:.0f} ms)",
        flush=True,
    )


if __name__ == "__main__":
    never = (
        LinearEquation,
        "certainly_overturns",
        lambda self, y, v, inward, steady=True: y > 1e6,
    )
    unsummed = (
        engine,
        "sequence_ends",
        lambda segments, lanes, *_: np.zeros(lanes.y.size, dtype=bool),
    )
    ratio(
        "free motion after the shaking, 5 periods marched instead",
        scene(),
        scene(MARCHED),
    )
    ratio(
        "certain overturning, 5 cycles",
        scene(sine(5), omega=scenes.axis(100)),
        patch=never,
    )
    ratio(
        "end of a sequence, A up to 1.1",
        scene(amplitude=np.linspace(1.001, 1.1, 100), omega=scenes.axis(15)),
        patch=unsummed,
    )
    ratio("end of a sequence, the whole grid", scene(), patch=unsummed)
    ratio("peaks, where only the outcome is asked for", scene(peaks=False), scene())
    ratio(
        "envelope: amplitudes that bounds decide",
        partial(scenes.envelope, sine(), 30, 1),
        patch=(Symmetric, "alike", False),
    )
    ratio("ten structures of equal restitution", structures(0.0), structures(1e-6))
