"""How often each method of the Italian code accepts an amplitude that overturns a body:
`make code-study`.

Columns and walls under the shipped motion, scaled to peaks from 0.01 g to 1.5 g; the
outcome is that of the equation of motion.
"""

import numpy as np

from rocking_cli import code_check, load_records, load_structures
from rocking_cli.documents.quantities import DEFAULT_GRAVITY
from rocking_cli.dynamics.method import governing_method
from rocking_cli.dynamics.outcome import falls
from rocking_cli.dynamics.response import response
from rocking_cli.motions.grid import as_recorded
from rocking_cli.responses.code_check import METHODS

MOTION = "configs/motions/synthetic.at2"
PEAKS = 0.01 * np.arange(1, 151)  # g
BODIES = {
    "columns": [
        f"block:{slenderness * height:g}x{height:g}"
        for height in (1, 2, 3, 5)
        for slenderness in (0.12, 0.18, 0.25, 0.35)
    ],
    "walls": [
        f"wall:{thickness:g}x{height:g}"
        for height in (3, 4, 6, 8)
        for thickness in (0.3, 0.45, 0.6, 0.9)
    ],
}


def outcomes(body: str) -> tuple[np.ndarray, dict[str, float]]:
    """(True at each of PEAKS that overturns a body or lifts it off, the amplitude [g]
    that each method accepts).
    """
    (structure,), (recording,) = load_structures(body), load_records(MOTION)
    motion = recording.motion
    grid = as_recorded(recording.acceleration)
    amplitude = structure.dimensionless_amplitude(PEAKS * DEFAULT_GRAVITY)
    omega = np.asarray(float(grid.scaled(structure)[1][0]))
    found = response(
        governing_method(structure).system_of(structure),
        motion,
        amplitude,
        omega,
        structure.eta,
        peaks=False,
    )
    accepted = code_check(structure, motion, grid).accepted()
    return falls(found.outcome), {
        METHODS[key]: a / DEFAULT_GRAVITY for key, a in accepted.items()
    }


def table() -> str:
    """The lines of the table: shares in per cent, of bodies and of amplitudes."""
    lines = [
        "                     bodies  amplitudes that overturn  amplitudes that do not",
        "                     unsafe  and are accepted, %       and are refused, %",
    ]
    for kind, bodies in BODIES.items():
        found = [outcomes(body) for body in bodies]
        down = np.array([fallen for fallen, _ in found])
        for method in METHODS.values():
            accepts = (
                np.array([[accepted[method]] for _, accepted in found]) * (1.0 + 1e-9)
                >= PEAKS
            )
            unsafe = down & accepts
            share, alarms = (
                100.0 * unsafe.sum() / down.sum(),
                100.0 * (~down & ~accepts).sum() / (~down).sum(),
            )
            lines.append(
                f"  {kind:8} {method:8} {unsafe.any(axis=1).sum():3} of {len(bodies):2}"
                f" {share:12.1f} {alarms:24.1f}"
            )
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
