"""The response of arrays of cells, on request with the largest angular speed."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import ArgumentError, UsageError, counted, did_you_mean
from ..motions.given import AnyMotion, motion_from
from ..motions.motion import Motion
from ..motions.segments import Chain
from .batch import Batch
from .march.engine import Run
from .observers.observer import Observer
from .outcome import Outcome, Work, safe
from .system import System

if TYPE_CHECKING:
    from .observers.peak_speed import PeakSpeed
    from .one.one_by_one import OneByOne
    from .tied.tied_lanes import Found

CellInputs = tuple[Array, Array]  # A and Omega, of one shape


class Response(NamedTuple):
    """The result of `response` for each cell, in the shape of the input.

    Attributes
    ----------
    theta_ratio
        max over time of |theta|/alpha [-]; NaN where overturned, where contact is
        lost, or where failed
    outcome
        codes of `Outcome`, uint8
    impacts_at_least
        number of impacts that were computed, int32: a lower bound, since a proof may
        end the computation of a cell, or sum a sequence of impacts, at any time
    condition
        by how much theta_ratio takes over the errors of the steps, in units of the
        tolerance [-]: times the tolerance a bound, of first order, of its error; NaN
        where theta_ratio is NaN or 0
    work
        counters of the computation

    Examples
    --------
    >>> found = linear_response(sine(), [0.9, 1.5, 12.0], 6.0, 0.9)
    >>> [Outcome(int(code)).flag for code in found.outcome]
    ['no_uplift', 'rocked', 'overturned_no_impact']
    >>> f"{found.theta_ratio[1]:.6f}"
    '0.167098'
    """

    theta_ratio: Array  # [-], (cells,)
    outcome: Array  # codes of `Outcome`, (cells,)
    impacts_at_least: Array  # impacts that were computed, (cells,)
    condition: Array  # of theta_ratio [-], (cells,)
    work: Work  # counters of all cells

    def __repr__(self) -> str:
        codes, numbers = np.unique(self.outcome, return_counts=True)
        found = [
            f"{n} {Outcome(int(c)).flag}" for c, n in zip(codes, numbers, strict=True)
        ]
        return f"Response({counted(self.outcome.size, 'cell')}: {', '.join(found)})"

    @classmethod
    def joined(cls, parts: Sequence["Response"]) -> "Response":
        """Return the cells of all parts, one after the other.

        Parameters
        ----------
        parts
            results of one dimension

        Returns
        -------
        Response
        """
        theta_ratio, outcome, impacts, condition = (
            np.concatenate(x) for x in list(zip(*parts, strict=True))[:-1]
        )
        work = sum((part.work for part in parts), Work())
        return cls(theta_ratio, outcome, impacts, condition, work)


WAYS = ("arrays", "floats")
# Under a motion of more than LONG segments the march on arrays takes as long for a few
# cells as that on floats for FEW: 40 to 100 by Eqs. 2.3 and 2.4, 15 to 30 by Eq. 3.4,
# under records of 400, 1,559 and 7,999 samples; 50 to 60 of tied bodies (1,559).
LONG, _FEW, _FEW_COMPOSED, _FEW_TIED = 200, 60, 20, 30


def few(system: System, segments: int) -> int:
    """Return the number of cells of one system up to which `response` takes less time
    on floats than on arrays, under a motion of so many segments.
    """
    if segments <= LONG:
        return 0
    if system.devices is not None:
        return _FEW_TIED
    return _FEW_COMPOSED if system.equation.composed else _FEW


def cheaper(system: System, motion: Motion, cells: int) -> str:
    """Return how `response` computes so many cells of one structure under this motion
    in the least time.
    """
    return "floats" if cells <= few(system, len(motion.segments)) else "arrays"


def response(
    system: System,
    motion: AnyMotion,
    amplitude: Array | float,
    omega: Array | float,
    eta: Array | float | None = None,
    *,
    peaks: bool = True,
    how: str = "arrays",
    pool: int | None = None,
    kept_to: Array | float | None = None,
) -> Response:
    """Largest rotation and outcome of one system under one motion (Eqs. 2.3, 2.4, 2.6,
    3.4).

    `amplitude`, `omega` and `eta` are broadcast against each other. If the edges
    differ, A and Omega are those of the edge that lifts first.

    Parameters
    ----------
    system
        the equation of motion on its contact, such as `Method().system_of(structure)`
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    amplitude
        A = a_scale a_g / (alpha g) [-], finite, not negative
    omega
        Omega = omega_g / p [-], finite, positive
    eta
        restitution [-] in place of that of the system, within [0, 1], of a one-sided
        body within (-1, 0]; not used if the edges have restitutions of their own
    peaks
        False computes the outcome only; theta_ratio is then NaN
    how
        "arrays" advances all cells together, "floats" one cell after the other, for a
        system of one structure (see `cheaper`); both keep the tolerance, and their
        digits beyond it differ
    pool
        number of lanes advanced together, None for the default
    kept_to
        A up to which contact with the ground is proved [-], as
        `System.safe_amplitude` returns it; None computes it

    Returns
    -------
    Response
        theta_ratio [-], outcome and impacts, in the shape of the input

    Raises
    ------
    ArgumentError
        for a number out of range, or if neither `eta` nor the system has a restitution

    Notes
    -----
    The outcome also counts the motion after the shaking, by Eq. 2.7 or its like for the
    nonlinear equation.

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> system = Method("nonlinear").system_of(column)
    >>> found = response(system, sine(), 1.5, 6.0)
    >>> Outcome(int(found.outcome)).flag, round(float(found.theta_ratio), 6)
    ('rocked', 0.15645)
    """
    motion = motion_from(motion)
    system, shape, cells = _flat(system, amplitude, omega, eta)
    if not (np.all(np.isfinite(cells[0])) and np.all(cells[0] >= 0.0)):
        raise ArgumentError("amplitude must be finite and not negative")
    if not (np.all(np.isfinite(cells[1])) and np.all(cells[1] > 0.0)):
        raise ArgumentError("omega must be positive and finite")
    if pool is not None and pool < 1:
        raise ArgumentError(f"`pool`: found {pool}; expected a whole number from 1")
    if how not in WAYS:
        raise UsageError(
            f"`how`: found {how!r}; expected"
            f" {' or '.join(WAYS)}{did_you_mean(how, WAYS)}"
        )
    if how == "floats":
        from .one.one_by_one import OneByOne

        return _response(OneByOne(system, motion, cells, peaks), shape, peaks)
    batch = _batch(system, motion, cells, peaks)
    if system.devices is not None:
        from .tied.tied_march import TiedMarch

        return _response(TiedMarch(system.devices, batch).run(), shape, peaks)
    if kept_to is None:
        kept_to = system.safe_amplitude(motion)
    run = _marched(system, batch, cells[0] > kept_to, pool=pool)
    return _response(run, shape, peaks)


def _flat(
    system: System,
    amplitude: Array | float,
    omega: Array | float,
    eta: Array | float | None = None,
) -> tuple[System, tuple[int, ...], CellInputs]:
    """(system with this eta, shape, flat cells) of A, Omega and eta broadcast against
    each other. Raises ArgumentError for shapes that do not fit, and for an eta out of
    range.
    """
    given = amplitude, omega, *(() if eta is None else (eta,))
    arrays = [np.asarray(x, dtype=float) for x in given]
    try:
        amplitude, omega, *own = np.broadcast_arrays(*arrays)
    except ValueError:
        shapes = ", ".join(str(x.shape) for x in arrays)
        raise ArgumentError(
            f"`amplitude`, `omega`, `eta`: found the shapes {shapes}; expected shapes"
            " that NumPy broadcasts against each other"
        ) from None
    if own:
        single = arrays[-1].ndim == 0
        system = system.with_restitution(
            float(arrays[-1]) if single else own[0].ravel()
        )
    return system, amplitude.shape, (amplitude.ravel(), omega.ravel())


def _response(
    run: "Run | Found | OneByOne", shape: tuple[int, ...], peaks: bool = True
) -> Response:
    """Return the results of a run in the shape of the cells; peaks: False if no
    rotations are wanted.
    """
    theta_ratio = run.theta_ratio if peaks else np.full(run.outcome.size, np.nan)
    # NaN where no body rocks and stands
    condition = np.where(theta_ratio > 0.0, run.condition, np.nan)
    found = theta_ratio, run.outcome, run.impacts, condition
    return Response._make([*(x.reshape(shape) for x in found), run.work])


def _batch(system: System, motion: Motion, cells: CellInputs, peaks: bool) -> Batch:
    """A batch of flat cells under a motion."""
    return Batch.of(system, system.segments(motion.coarsest), *cells, peaks)


def _marched(
    system: System,
    batch: Batch,
    watched: Array,
    *observers: Observer,
    pool: int | None = None,
) -> Run:
    """Run a batch to the end; watched: True for cells for which Lemma 13 does not prove
    beforehand that they keep contact with the ground, (cells,).
    """
    body, equation, contact = system.body, batch.equation, batch.contact
    watches: list[Observer] = []
    if body is not None and watched.any():
        from .observers.contact_watch import ContactWatch

        watches = [ContactWatch(body, equation, contact, batch.segments, watched)]
    if observers or not watches:
        run = Run(batch, pool, [*observers, *watches])
        run.all()
        return run
    # What nothing observes takes exact flows, samples at once, and Lemma 9.
    run, at = Run(batch, pool), np.flatnonzero(watched)
    run.all(np.flatnonzero(~watched))
    more = Run(batch, pool, watches)
    more.all(at)
    for name in ("outcome", "theta_ratio", "impacts", "condition"):
        getattr(run, name)[at] = getattr(more, name)[at]
    run.work += more.work
    return run


def response_with_speed(
    system: System, motion: Motion, amplitude: Array, omega: Array
) -> tuple[Response, Array]:
    """(`response`, the largest |d theta/d tau|/alpha [-] under straight lines, tau = p
    t), the second NaN where theta_ratio is NaN. If the edges differ, alpha and p are
    those of A and Omega.
    """
    from .observers.peak_speed import PeakSpeed

    system, shape, cells = _flat(system, amplitude, omega)
    batch = _batch(system, motion, cells, peaks=True)
    speed = PeakSpeed(batch)
    run: Run | Found
    if system.devices is not None:
        from .tied.tied_march import TiedMarch

        run = TiedMarch(system.devices, batch, speed=speed).run()
    else:
        watched = cells[0] > system.safe_amplitude(motion)
        run = _marched(system, batch, watched, speed)
    return _with_speed(run, speed, shape)


def response_under_records(
    system: System,
    records: Sequence[Motion],
    which: Array,
    amplitude: Array,
    omega: Array,
) -> tuple[Response, Array]:
    """As `response_with_speed`, for each cell under the record whose index is in
    `which`, (cells,). `can_share_records` must be True for every record. The cells of
    all records share the pool.
    """
    from .observers.peak_speed import PeakSpeed

    chain = Chain.of([record.coarsest.segments for record in records])
    batch = Batch.of(system, chain, amplitude, omega, first=chain.first[which])
    speed = PeakSpeed(batch)
    largest = np.array([record.largest for record in records])[which]
    watched = amplitude > system.safe_amplitude(records[0], largest=largest)
    run = _marched(system, batch, watched, speed)
    return _with_speed(run, speed, amplitude.shape)


def _with_speed(
    run: "Run | Found", speed: "PeakSpeed", shape: tuple[int, ...]
) -> tuple[Response, Array]:
    """The results of a run, and its largest speeds."""
    largest = np.where(safe(run.outcome), speed.largest, np.nan)
    return _response(run, shape), largest.reshape(shape)


def can_share_records(system: System, motion: Motion) -> bool:
    """True for a record at equal steps without a vertical one, if cells of the undamped
    system may share a run with other records.
    """
    return (
        motion.vertical is None
        and motion.samples is not None
        and not system.equation.damped
        and system.devices is None
    )


def linear_response(
    motion: AnyMotion,
    amplitude: Array,
    omega: Array,
    eta: Array | float,
    *,
    peaks: bool = True,
    pool: int | None = None,
) -> Response:
    """Largest rotation and outcome of linear oscillators (Eqs. 2.4, 2.6, 3.6), exact.

    As `response` with two equal edges and no damping. `amplitude`, `omega` and `eta`
    are broadcast against each other.

    Parameters
    ----------
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    amplitude
        A = a_scale a_g / (alpha g) [-], finite, not negative
    omega
        Omega = omega_g / p [-], finite, positive
    eta
        restitution [-], from 0 to 1
    peaks
        False computes the outcome only; theta_ratio is then NaN
    pool
        number of lanes advanced together, None for the default

    Returns
    -------
    Response
        theta_ratio [-] and outcome, in the shape of the input

    Raises
    ------
    ArgumentError
        for a number out of range

    Notes
    -----
    Between events the flow is exact under one sinusoid, else a Taylor series to 1e-12.
    The linear equation holds for slender structures, and it is not safe: of a block
    that falls by Eq. 2.3 it may say that it stands.

    Examples
    --------
    >>> found = linear_response(sine(), [1.0, 1.5, 4.0], 6.0, 0.9)
    >>> found.theta_ratio.round(6).tolist()
    [0.0, 0.167098, 0.669456]
    """
    from .equations.linear import LinearEquation

    return response(
        System(LinearEquation()), motion, amplitude, omega, eta, peaks=peaks, pool=pool
    )


def nonlinear_response(
    motion: AnyMotion,
    amplitude: Array,
    omega: Array,
    eta: Array | float,
    alpha: float,
    *,
    tolerance: float = 1e-9,
    peaks: bool = True,
) -> Response:
    """Largest rotation and outcome of rigid bodies of one critical angle (Eqs. 2.3,
    2.6).

    As `response` with two equal edges and no damping. `amplitude`, `omega` and `eta`
    are broadcast against each other.

    Parameters
    ----------
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    amplitude
        A = a_g / (alpha g) [-], finite, not negative; the body lifts at
        A = tan(alpha)/alpha
    omega
        Omega = omega_g / p [-], finite, positive
    eta
        restitution [-], from 0 to 1
    alpha
        critical angle [rad], between 1e-30 and pi/2
    tolerance
        error of theta/alpha that the integration aims at [-], from 1e-13 to 1e-2
    peaks
        False computes the outcome only; theta_ratio is then NaN

    Returns
    -------
    Response
        theta_ratio [-] and outcome, in the shape of the input

    Raises
    ------
    ArgumentError
        for a number out of range

    Examples
    --------
    >>> found = nonlinear_response(sine(), [1.5, 4.0], 6.0, 0.9, alpha=0.25)
    >>> found.theta_ratio.round(6).tolist()
    [0.153431, 0.673775]
    """
    from .equations.rigid_body import RigidBodyEquation

    return response(
        System(RigidBodyEquation(alpha, tolerance)),
        motion,
        amplitude,
        omega,
        eta,
        peaks=peaks,
    )
