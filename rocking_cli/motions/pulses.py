"""The pulses of the literature by name, over phi = omega_g t; for a pulse with a
duration, omega_g = 2 pi / duration.

A new pulse is one function that returns its motion from its parameters, with max |s| =
1, and one line in PULSES. A parameter needs its default, and an option of its name in
`Source` of `commands/ground.py`.

An installed package adds a pulse by an entry point, which names such a function; the
command line has the parameters `cycles`, `gamma` and `phase`. Entry points are read
only for a name that is not in PULSES.

    [project.entry-points."rocking.pulses"]
    gabor = "my_package:gabor"
"""

import math
from collections.abc import Callable
from inspect import signature

import numpy as np

from ..errors import MotionError, did_you_mean
from ..plugins import blamed, installed
from .motion import Harmonic, Motion, Piece

GROUP = "rocking.pulses"
_UNIT = 1e-6  # of max |s|, which must be 1
MOST_CYCLES = 100_000
TURN = 2.0 * np.pi
# a Ricker wavelet and its spectrum are below 1e-13 beyond this distance, in units of x
_TAIL = 8.5


def sine(cycles: float = 1.0) -> Motion:
    """Return the pulse sin(phi) (section 2 of the paper).

    Parameters
    ----------
    cycles
        number of cycles, a positive multiple of 0.5 up to 100000

    Returns
    -------
    Motion

    Raises
    ------
    MotionError
        for another number of cycles

    Examples
    --------
    >>> motion = sine(cycles=1.5)
    >>> motion.name, round(motion.duration, 6)
    ('sine 1.5 cycles', 9.424778)
    """
    return _trigonometric("sine", cycles, 0.0)


def cosine(cycles: float = 1.0) -> Motion:
    """Return the pulse cos(phi), which begins with a jump (section 2 of the paper).

    Parameters
    ----------
    cycles
        number of cycles, a positive multiple of 0.5 up to 100000

    Returns
    -------
    Motion

    Raises
    ------
    MotionError
        for another number of cycles

    Examples
    --------
    >>> motion = cosine()
    >>> motion.name, motion.value([0.0, 3.0]).round(6).tolist()
    ('cosine 1 cycle', [1.0, -0.989992])
    """
    return _trigonometric("cosine", cycles, np.pi / 2)


def ricker(antisymmetric: bool = False) -> Motion:
    """Return the symmetric Ricker wavelet (1 - x^2) exp(-x^2/2), x = (phi -
    phi_0)/sqrt(2), or its derivative x (x^2 - 3) exp(-x^2/2), x = (phi -
    phi_0)/sqrt(3), over its largest value, as 23 sinusoids (to 1e-13). omega_g is the
    predominant frequency.
    """
    unit = math.sqrt(3.0 if antisymmetric else 2.0)
    x2 = 3.0 - math.sqrt(6.0)
    harmonics = []
    largest = math.sqrt(x2) * (3.0 - x2) * math.exp(-0.5 * x2)
    # the Fourier series on |x| <= _TAIL
    for n in range(1, int(_TAIL * _TAIL / np.pi) + 1):
        k = n * np.pi / _TAIL
        factor, quarter = (-k / largest, 0.0) if antisymmetric else (1.0, 0.5 * np.pi)
        amplitude = math.sqrt(TURN) / _TAIL * k * k * math.exp(-0.5 * k * k) * factor
        harmonics.append(Harmonic(amplitude, k / unit, quarter - (n % 2) * np.pi))
    name = "antisymmetric Ricker" if antisymmetric else "symmetric Ricker"
    return Motion(name, (Piece(0.0, 2.0 * _TAIL * unit, tuple(harmonics)),))


def mavroeidis_papageorgiou(gamma: float = 2.0, phase: float = 0.0) -> Motion:
    """Return the near-fault pulse of Mavroeidis and Papageorgiou (2003), scaled to a
    largest acceleration of 1. Its velocity is cos(phi' + phase) (1 +
    cos(phi'/gamma))/2, phi' = phi - pi gamma; gamma >= 1, duration over period; phase
    [rad]. Raises MotionError.
    """
    if not 1.0 <= gamma <= MOST_CYCLES:
        raise MotionError(
            f"mavroeidis-papageorgiou pulse: gamma is {gamma:g}; expected a number from"
            f" 1 to {MOST_CYCLES}"
        )
    if not math.isfinite(phase):
        raise MotionError(
            f"mavroeidis-papageorgiou pulse: phase is {phase:g}; expected an angle"
            " in rad"
        )
    parts = [
        (0.5, 1.0),
        (0.25 * (1.0 + 1.0 / gamma), 1.0 + 1.0 / gamma),
        (0.25 * (1.0 - 1.0 / gamma), 1.0 - 1.0 / gamma),
    ]

    def pieces(largest: float) -> tuple[Piece, ...]:
        turned = [
            Harmonic(-c / largest, w, math.remainder(phase - w * np.pi * gamma, TURN))
            for c, w in parts
            if c > 0.0
        ]
        return (Piece(0.0, TURN * gamma, tuple(turned)),)

    name = f"Mavroeidis-Papageorgiou, gamma {gamma:g}, phase {phase:g}"
    return Motion(name, pieces(Motion(name, pieces(1.0)).largest))


def _trigonometric(name: str, cycles: float, phase: float) -> Motion:
    """Return a pulse of a whole number of half cycles from this phase [rad] on. Raises
    MotionError.
    """
    halves = 2.0 * cycles
    if not (1.0 <= halves <= 2.0 * MOST_CYCLES and halves == np.rint(halves)):
        raise MotionError(
            f"{name} pulse: cycles is {cycles:g}; expected a positive multiple of 0.5"
            f" up to {MOST_CYCLES}"
        )
    return Motion(
        f"{name} {cycles:g} cycle{'' if cycles == 1 else 's'}",
        (Piece(0.0, halves * np.pi, (Harmonic(1.0, 1.0, phase),)),),
    )


# the motion of each pulse, from its parameters
PULSES: dict[str, Callable[..., Motion]] = {
    "sine": sine,
    "cosine": cosine,
    "half-sine": lambda: Motion("half sine", (Piece(0.0, np.pi, (Harmonic(1.0),)),)),
    "rectangular": lambda: Motion("rectangular", (Piece(0.0, TURN, constant=1.0),)),
    # For t_p, then for 2 t_p: the impulse of Fig. 7c, which leaves no ground velocity.
    "rectangular-impulse": lambda: Motion(
        "rectangular impulse",
        (Piece(0.0, TURN, (), 1.0), Piece(TURN, 3.0 * TURN, (), -0.5)),
    ),
    "ricker-symmetric": lambda: ricker(),
    "ricker-antisymmetric": lambda: ricker(antisymmetric=True),
    "mavroeidis-papageorgiou": mavroeidis_papageorgiou,
}


def pulse(name: str, **parameters: float) -> Motion:
    """Return the pulse of a name.

    Parameters
    ----------
    name
        such as "sine", one of `rocking help motions`, or a pulse of an installed
        package
    parameters
        those of the pulse, such as `cycles` of a sine or cosine, or `gamma` (duration
        over period, from 1) and `phase` [rad] of "mavroeidis-papageorgiou"

    Returns
    -------
    Motion

    Raises
    ------
    MotionError
        for another name or parameter, or a parameter out of range

    Examples
    --------
    >>> pulse("mavroeidis-papageorgiou", gamma=2.0, phase=0.5).name
    'Mavroeidis-Papageorgiou, gamma 2, phase 0.5'
    >>> pulse("half-sine").value([1.0, 4.0]).round(6).tolist()
    [0.841471, 0.0]
    """
    if name in PULSES:
        make = PULSES[name]
        _require_known(name, make, parameters)
        return make(**parameters)
    found = installed(GROUP)
    if name not in found:
        words = (*PULSES, *found)
        raise MotionError(
            f"unknown pulse {name!r}; expected"
            f" {', '.join(words)}{did_you_mean(name, words)}"
        )
    with blamed(found[name], lambda said: MotionError(f"pulse {said}")):
        make = found[name].load()
        _require_known(name, make, parameters)
        motion = make(**parameters)
        if not isinstance(motion, Motion):
            raise TypeError(f"it returns a {type(motion).__name__}, which is no Motion")
        if not abs(motion.largest - 1.0) <= _UNIT:
            raise ValueError(f"its largest value is {motion.largest:g}, which is not 1")
    return motion


def is_pulse(name: str) -> bool:
    """True if a word names a pulse, of this package or of an installed one."""
    return name in PULSES or name in installed(GROUP)


def _require_known(
    name: str, make: Callable[..., Motion], parameters: dict[str, float]
) -> None:
    """Raise MotionError for a parameter that a pulse does not take."""
    known = signature(make).parameters
    if any(one.kind is one.VAR_KEYWORD for one in known.values()):
        return
    for key in parameters:
        if key not in known:
            raise MotionError(
                f"{name} pulse: takes no {key}"
                + (f"; expected {' and '.join(known)}" if known else "")
            )
