"""The separatrix of free motion: the states from which a body just reaches its unstable
equilibrium.
"""

from collections.abc import Iterator

import numpy as np

from ..dynamics.equations.equation import Equation
from ..dynamics.method import Method
from ..structures.parameters import RockingParameters

# of y at the equilibrium: the distance from it at which the integration begins
_OFF = 1e-6
_POINTS = 101  # between the ground and the equilibrium, and beyond it


def separatrix(
    structure: RockingParameters, method: Method, reach: float
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield (theta/alpha, its derivative by p t) for each side, (points,), from theta =
    0 to |theta|/alpha = `reach`, on still ground.

    A body inside the curve comes back by itself, a body outside it falls. p belongs to
    the structure, alpha to the side. Raises UsageError as `Method.system_of`.

    >>> (column,) = load_structures('configs/block.yaml')
    >>> right, left = separatrix(column, Method('linear'), 1.2)
    >>> bool(abs(right[0] + right[1] - 1.0).max() < 1e-6)
    True
    """
    whole = method.system_of(structure).equation
    edges = dict(zip((-1.0, 1.0), structure.sides, strict=False))
    for side in (1.0,) if structure.one_sided else (1.0, -1.0):
        equation = whole.on(np.array([side]))
        top, far = (
            float(equation.displacement(np.array([x]))[0]) for x in (1.0, reach)
        )
        inside, beyond = _branch(equation, top, 0.0), _branch(equation, top, far)
        y, v = np.concatenate([inside[:, ::-1], beyond], axis=1)
        yield (
            side * equation.rotation(y),
            side
            * edges.get(side, structure).p
            / structure.p
            * equation.rotation_rate(y, v),
        )


def _branch(equation: Equation, top: float, end: float) -> np.ndarray:
    """Integrate dv/dy = y''/v from near the equilibrium y = `top` to y = `end`: (y, v),
    (2, points). An error at the start decays.
    """
    from scipy.integrate import solve_ivp

    def slope(y: float, v: np.ndarray) -> np.ndarray:
        return (
            np.asarray(equation.force(np.array([y]), np.zeros(1))) / v
            - 2.0 * equation.damping
        )

    off = _OFF * np.sign(end - top) * top
    at = np.linspace(top + off, end, _POINTS)
    found = solve_ivp(slope, (at[0], end), [-off], t_eval=at, rtol=1e-9, atol=1e-12)
    return np.stack([at, found.y[0]])
