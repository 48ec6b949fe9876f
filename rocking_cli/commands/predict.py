"""`rocking predict`: the response of a structure under the motion of a dimensionless
spectrum.
"""

from ..errors import counted
from . import demand, ground, options
from .command import argument, command, flag, group, partly
from .parameter_types import InputPath
from .printing import detail, emit, note, printed

_SPECTRUM = (
    "rocking params configs/block.yaml --json | rocking spectrum - --grid"
    " A=0.5:6:50,Omega=1:10:50 -o block.h5"
)


@command(
    f"{_SPECTRUM} && rocking predict block.h5 configs/block.yaml --a-g 0.35g --f-g 1.5",
    printed,
)
def predict(
    spectrum: str = argument(type=InputPath()),
    files: tuple[str, ...] = options.files(),
    shaking: demand.Shaking = group(demand.Shaking),
    exact: bool = flag(
        "--beyond-range",
        "Also compute structures beyond the range and restitutions of the spectrum;"
        " nothing is interpolated.",
    ),
) -> None:
    """Predict theta_max, outcome and margin of structures under the motion of a
    spectrum of equal restitution.

    SPECTRUM holds a linear spectrum on axes A and Omega. theta_max [rad] and the
    outcome are computed. capacity_demand is the lowest overturning amplitude over the
    demand; margin is the relative distance in A to the nearest boundary between
    standing and overturning, and margin_side the side of the demand on which it lies.
    They are empty if no amplitude up to A = 20 and twice the demand overturns;
    intervals narrower than 1e-3 in A may be missed. theta_ratio_interpolated is the
    value in the spectrum, empty next to cells that overturn; interpolation_error is its
    distance from the computed value.
    """
    from ..dynamics.method import has_direction
    from ..dynamics.outcome import Outcome
    from ..reports.remarks import direction_in_words, stuck_in_words
    from ..spectra.file.reader import SpectraFile
    from ..spectra.prediction import check_linear, predict_exactly
    from ..spectra.prediction import predict as read_off

    structures = options.structures_of(files, each=True)
    with SpectraFile(spectrum) as file:
        check_linear(file)
        motion = file.motion()
        shaken = shaking.of(ground.Ground(motion))
        if shaken.motion is None or shaken.grid is None:
            raise ground.no_shaking("--A and --Omega")
        # The cells of a spectrum hold for the motion in its own direction only.
        held = not exact and shaken.motion is motion
        rows = [
            (
                read_off(s, file, shaken.grid)
                if held or not (exact or has_direction(s))
                else predict_exactly(s, shaken.motion, shaken.grid)
            )
            for s in structures
        ]
    emit(rows)
    detail("model: linear, as the spectrum's")
    note(
        *direction_in_words(*structures, opposite="the other sign of `a_g`"),
        *stuck_in_words(structures),
    )
    if failed := sum(r["outcome"] == Outcome.FAILED.flag for r in rows):
        note(f"{counted(failed, 'structure')} could not be decided (outcome failed)")
        partly()
