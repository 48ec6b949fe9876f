"""What leaving things out saves: each shortcut of the engine taken away from a scene, one at a time, in the same run.

The engine has no switch for this; here its parts are replaced from outside. Prints the table of `rocking help accuracy`.
"""

from __future__ import annotations

import time
from contextlib import nullcontext
from unittest import mock

import numpy as np

from rocking_cli import Motion, dimensionless_oscillator, linear_response, parse_grid, sine, spectrum, trace_envelope
from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.equations.linear import LinearEquation
from rocking_cli.dynamics.march import engine
from rocking_cli.motions import Piece

ETA = 0.9
AXIS = np.linspace(0.5, 12.0, 300)
LONG = 2.0  # s, of which what disturbs a run is a small part
NEAR = np.linspace(1.001, 1.1, 100)


def scene(motion=None, amplitude=AXIS, omega=AXIS, peaks=True):
    return lambda: linear_response(motion or sine(), amplitude[None, :], omega[:, None], ETA, peaks=peaks)


def followed_by_rest(cycles):
    """A sine cycle and then still ground, which counts as shaking: the free motion is marched through."""
    pulse = sine().pieces
    return Motion("sine and rest", (*pulse, Piece(pulse[-1].stop, pulse[-1].stop + 2.0 * np.pi * cycles)))


def no_lanes(*arguments):
    """None of the lanes, whichever argument holds them."""
    size = next(x.size if isinstance(x, np.ndarray) else x.y.size for x in reversed(arguments) if isinstance(x, np.ndarray | engine.Lanes))
    return np.zeros(size, dtype=bool)


def envelope():
    return trace_envelope(dimensionless_oscillator(ETA), sine(), np.linspace(0.5, 12.0, 30), workers=1)


def structures(count):
    """As many restitutions as one, or as many structures of one restitution."""
    grid = parse_grid("A=0.5:12:200,Omega=0.5:12:200")
    same, other = [dimensionless_oscillator(ETA)] * count, [dimensionless_oscillator(ETA - 1e-6 * i) for i in range(count)]
    return (lambda: spectrum(same, sine(), grid, workers=1)), (lambda: spectrum(other, sine(), grid, workers=1))


def ratio(name, kept, plain, patch=None):
    """Print the time of a processor without the shortcut over the time with it, the least of two pairs; what takes long is run once."""
    times = np.full((2, 2), np.inf)
    for pair in times:
        for i, action in enumerate((kept, plain)):
            if LONG < times[0, i] < np.inf:
                continue
            with mock.patch.object(*patch) if patch and i else nullcontext():
                start = time.process_time()
                action()
                pair[i] = time.process_time() - start
    least = times.min(axis=0)
    print(f"{name:<58}{least[1] / least[0]:7.2f} times  ({1e3 * least[0]:.0f} ms)", flush=True)


def main() -> None:
    ratio("free motion after the shaking, 5 periods marched instead", scene(), scene(followed_by_rest(5)))
    long = scene(sine(5), omega=AXIS[::3])
    never = (LinearEquation, "certainly_overturns", lambda self, y, v, inward, steady=True: y > 1e6)
    ratio("certain overturning, 5 cycles", long, long, never)
    near = scene(amplitude=NEAR, omega=AXIS[::20])
    ratio("end of a chatter, A up to 1.1", near, near, (Symmetric, "sequence_ends", no_lanes))
    ratio("end of a chatter, the whole grid", scene(), scene(), (Symmetric, "sequence_ends", no_lanes))
    ratio("peaks, where only the outcome is asked for", scene(peaks=False), scene())
    ratio("envelope: amplitudes that bounds decide", envelope, envelope, (Symmetric, "alike", False))
    ratio("ten structures of equal restitution", *structures(10))


if __name__ == "__main__":
    main()
