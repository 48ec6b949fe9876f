"""The response of one body in time: every arc as a series, and the events.

`history` records the march of one body on floats. Only the last, invisible part of a
sequence of impacts is summed; all else is followed in time. After the motion the ground
is at rest.
"""

import math

from ..dynamics.system import System
from ..errors import ArgumentError
from ..motions.given import AnyMotion, motion_from
from ..motions.motion import Motion, Piece
from .arcs import History
from .march_writer import MarchWriter

LONGEST = 1e9  # tau: beyond, doubles do not tell the times of an arc apart


def history(
    system: System,
    motion: AnyMotion,
    amplitude: float,
    omega: float,
    eta: float | None = None,
    *,
    release: float = 0.0,
    duration: float,
) -> History:
    """Return the response in time of one body, in dimensionless form (Eqs. 2.3, 2.4,
    3.4).

    The body begins at rest, or released at theta/alpha = release to its right side. The
    history goes up to tau = p t = duration or to the end of the shaking, whichever is
    later. `time_history` does the same for a structure in SI units.

    Parameters
    ----------
    system
        the equation of motion on its contact, such as `Method().system_of(structure)`
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    amplitude
        A = a_scale a_g / (alpha g) [-], finite, not negative; 0 is free rocking
    omega
        Omega = omega_g / p [-], finite, positive
    eta
        restitution [-] in place of that of the system
    release
        theta/alpha at the start [-], from 0 to below 1
    duration
        tau = p t up to which the history goes [-], positive

    Returns
    -------
    History
        arcs and events, and the outcome of the whole motion

    Raises
    ------
    ArgumentError
        for a number out of range, or if neither `eta` nor the system has a restitution

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> system = Method().system_of(column)
    >>> found = history(system, sine(), 2.0, 6.0, duration=40.0)
    >>> [event.event for event in found.events][:3]
    ['uplift', 'peak', 'impact']
    """
    motion = motion_from(motion)
    system = system if eta is None else system.with_restitution(eta)
    numbers = {
        "amplitude": amplitude,
        "omega": omega,
        "release": release,
        "duration": duration,
    }
    for name, x in numbers.items():
        if not (math.isfinite(x) and x >= 0.0):
            raise ArgumentError(
                f"{name}: found {x:g}; expected a finite number that is not negative"
            )
    if not (omega > 0.0 and duration > 0.0 and release < 1.0):
        raise ArgumentError("omega and duration must be positive and release below 1")
    if motion.duration / omega > LONGEST:
        raise ArgumentError(
            f"omega: found {omega:g}; expected a larger one, so that the shaking ends"
            f" before tau = {LONGEST:g}"
        )
    duration = max(motion.duration / omega, duration)
    shaking = motion.coarsest.still_until(1.001 * duration * omega)
    kind: type[MarchWriter] = MarchWriter
    if system.devices is not None:
        from .tied_history import TiedWriter

        kind = TiedWriter
    return kind(system, shaking, omega).record(amplitude, release, duration)


def quarter_period(system: System, release: float) -> float:
    """Return the time tau [-] from the release at theta/alpha = release to the first
    impact, on still ground. Raises ArgumentError.
    """
    reach = 4.0 * math.acosh(1.0 / (1.0 - release)) + 10.0
    free = history(
        system,
        Motion("still", (Piece(0.0, reach),)),
        0.0,
        1.0,
        0.0,
        release=release,
        duration=reach,
    )
    return next((e.tau for e in free.events if e.event == "impact"), math.inf)
