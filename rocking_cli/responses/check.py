"""The verdict on a structure under one motion: its outcome, the capacity it has left,
and the outcome by the linear equation.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, repeat
from typing import TYPE_CHECKING, Any

import numpy as np

from ..dynamics.method import LINEAR, Method, governing_method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import Response, response
from ..envelopes.amplitudes import LONGEST_FINE, Limit, limit_of
from ..envelopes.capacity import Capacity, CapacitySearch, fall_searches
from ..envelopes.intervals import A_MAX
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid, HasMotion, demand_of
from ..processes import available_cpus, part_reporter, processes
from ..structures.mechanics.fourbar import FourBar
from ..structures.parameters import RockingParameters
from .force_history import ForceHistory
from .time_history import time_history

if TYPE_CHECKING:
    from ..envelopes.lowest_fall import FallSearch

Demand = tuple[RockingParameters, Motion, Grid]
# Called with the number of finished stages, of which a part counts as a fraction, and
# of all.
Progress = Callable[[float, int], None]

_STAGES = 3  # of a verdict: responses, search, history
_SEARCHED = 0.95  # of a verdict whose search is long: about its share
_SHIFTS = np.array(
    [0.0, *(sign * 10.0**-n for n in (12, 9, 6) for sign in (-1.0, 1.0))]
)  # relative changes of a demand
_SAME = 0.01  # of theta/alpha: rotations under them that differ by less are one
_DIGITS = 4  # of a capacity where many narrow intervals overturn
_LAST = 0.01  # of a verdict, which counts when it has come from its process
_TOGETHER = 12  # demands that share a scan, at most
_WORTH = 3  # demands under pulses for each process that is started, at least
CHECK_KEYS = ("structure", "motion")  # the columns that say which row it is
CHECK_COLUMNS = (
    "structure",
    "motion",
    "model",
    "outcome",
    "theta_ratio",
    "top_displacement",
    "demand_a",
    "uplift_a",
    "first_overturning_a",
    "capacity_demand",
    "safe_to",
    "searched_to",
    "outcome_linear",
    "friction_needed",
    "fz_min",
    "omega_g",
)
TIED_COLUMNS = (
    "first_overturning_a_free",
    "tie_force",
    "tie_elongation",
    "permanent",
    "tie_state",
)


@dataclass(frozen=True)
class Verdict:
    """The verdict on a structure under a motion, as `check` returns it.

    It is that of the governing equation; accelerations are amplitudes a_g of the
    motion. `capacity_demand` is the lowest overturning amplitude over the demand,
    `falls` and `sentence` state the outcome, `row` is what `rocking check --json`
    prints.

    Attributes
    ----------
    theta_ratio: max |theta|/alpha [-], None if the body falls
    demand_a: the demand [m/s2]
    uplift_a: lowest a_g that lifts the body [m/s2], None if none does
    first_overturning_a: lowest a_g that overturns the body [m/s2], None if none does
    safe_to: upper end of the interval around the demand in which the body stands
        [m/s2], None if it falls or no larger a_g overturns it
    outcome_linear: by the linear equation
    friction_needed: friction that the motion needs, impacts apart [-]; only of a rigid
        body whose mass centre is known, None if it loses contact
    fz_min: least vertical force over the weight [-], of the same bodies
    unsettled: True if changes of the demand by 1e-12 to 1e-6 of it change the outcome,
        or theta_ratio by 0.01
    share_of_falls: if many narrow intervals overturn the body, the share of overturning
        amplitudes within 5 % above the first one [-]
    slides: True if friction_needed exceeds the friction of the document
    top_displacement: largest displacement of the top [m], None without a geometry or if
        the body falls
    first_overturning_a_free: first_overturning_a of the body without ties and tendon
        [m/s2]
    devices: a row for each tie and tendon, see `History.devices`
    opens: True if a further hinge opens in an arch, whose mechanism is then another
        one; None for another structure
    searched_to: largest a_g of the search [m/s2]; None without a search
    omega_g: circular frequency of a pulse [rad/s], None under a record

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> verdict = check(column, sine(), parse_grid("a_g=0.35g,f_g=1.5"))
    >>> verdict.outcome.flag, verdict.falls, f"{verdict.theta_ratio:.4f}"
    ('rocked', False, '0.4629')
    >>> f"{verdict.first_overturning_a:.4f} m/s2"
    '3.8278 m/s2'
    """

    structure: str  # name of the structure
    motion: str  # name of the motion
    model: str  # the governing equation
    outcome: Outcome  # by the governing equation
    theta_ratio: float | None  # max |theta|/alpha [-], None if the body falls
    demand_a: float  # the demand [m/s2]
    uplift_a: float | None  # lowest a_g that lifts the body [m/s2], None if none does
    # lowest a_g that overturns the body [m/s2], None if none does
    first_overturning_a: float | None
    # upper end of the interval around the demand in which the body stands [m/s2], None
    # if it falls or no larger a_g overturns it
    safe_to: float | None
    outcome_linear: Outcome  # by the linear equation
    # friction that the motion needs, impacts apart [-]; only of a rigid body whose mass
    # centre is known, None if it loses contact
    friction_needed: float | None = None
    # least vertical force over the weight [-], of the same bodies
    fz_min: float | None = None
    # True if changes of the demand by 1e-12 to 1e-6 of it change the outcome, or
    # theta_ratio by 0.01
    unsettled: bool = False
    # if many narrow intervals overturn the body, the share of overturning amplitudes
    # within 5 % above the first one [-]
    share_of_falls: float = 0.0
    slides: bool = False  # True if friction_needed exceeds the friction of the document
    # largest displacement of the top [m], None without a geometry or if the body falls
    top_displacement: float | None = None
    # first_overturning_a of the body without ties and tendon [m/s2]
    first_overturning_a_free: float | None = None
    # a row for each tie and tendon, see `History.devices`
    devices: tuple[dict[str, Any], ...] = ()
    # True if a further hinge opens in an arch, whose mechanism is then another one;
    # None for another structure
    opens: bool | None = None
    # largest a_g of the search [m/s2]; None without a search
    searched_to: float | None = None
    # circular frequency of a pulse [rad/s], None under a record
    omega_g: float | None = None

    @property
    def sentence(self) -> str:
        """The outcome in words."""
        return (
            self.outcome.sentence
            + ", on the last digits" * self.unsettled
            + ", though its base would slide" * self.slides
        )

    @property
    def capacity_demand(self) -> float | None:
        """The lowest overturning amplitude over the demand; None if nothing overturns
        the body.
        """
        return (
            None
            if self.first_overturning_a is None
            else self.first_overturning_a / self.demand_a
        )

    @property
    def capacity_above(self) -> float | None:
        """If the search found no overturning: the number that `capacity_demand`
        exceeds.
        """
        if self.first_overturning_a is not None or self.searched_to is None:
            return None
        return self.searched_to / self.demand_a

    @property
    def falls(self) -> bool:
        """True if the body overturned, lost contact or rests leaning."""
        return self.outcome.falls

    def row(self) -> dict[str, Any]:
        """Return the verdict as `rocking check --json` prints it."""
        own = {
            **vars(self),
            "capacity_demand": self.capacity_demand,
            "outcome": self.outcome.flag,
            "outcome_linear": self.outcome_linear.flag,
        }
        found = {key: own[key] for key in CHECK_COLUMNS}
        if self.opens is not None:
            found["opens"] = self.opens
        if self.share_of_falls:
            found["falls_nearby"] = self.share_of_falls
        if not self.devices:
            return found
        from .tied_history import columns_of

        return (
            found
            | {"first_overturning_a_free": self.first_overturning_a_free}
            | columns_of(self.devices)
        )


def check(
    structure: RockingParameters,
    motion: Motion | HasMotion,
    shaking: Grid | None = None,
    *,
    a_max: float | None = A_MAX,
    progress: Progress | None = None,
) -> Verdict:
    """Return whether a structure stands under a motion, and by which margin.

    The governing equation decides: the nonlinear one (Eqs. 2.3, 3.4) if the geometry is
    known and the motion has units, else the linear one (Eqs. 2.4, 3.6).

    Parameters
    ----------
    structure
        the structure
    motion
        the motion of the ground
    shaking
        the demand: amplitude and frequency, a grid of one cell; a record does not need
        it
    a_max
        A up to which overturning amplitudes are searched [-], or twice the demand if
        that is larger; None: no search
    progress
        called with the number of finished stages, of which a part counts as a fraction,
        and of all (responses, search, forces)

    Returns
    -------
    Verdict

    Raises
    ------
    UsageError
        for a demand of zero, for one above the limit of the search, and for a structure
        without units

    Notes
    -----
    The amplitudes that overturn a body are intervals: above the first one it may stand
    again. `capacity_demand` below 1 with the outcome "rocked" says so.

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> verdict = check(column, sine(), parse_grid("a_g=0.35g,f_g=1.5"))
    >>> verdict.outcome.flag, round(verdict.capacity_demand, 4)
    ('rocked', 1.1149)
    """
    told = _Shares(
        1, lambda done: progress(_STAGES * done, _STAGES) if progress else None
    )
    return _judged(structure, *demand_of(motion, shaking), a_max, None, told.of(0))


def outcome_alone(
    structure: RockingParameters, motion: Motion, shaking: Grid
) -> Outcome:
    """Return only the outcome of the verdict of `check`."""
    _, _, amplitude, omega, method, _ = _capacity_search(
        structure, motion, shaking, 0.0
    )
    return Outcome(
        int(
            _respond(method, structure, motion, np.array([amplitude]), omega).outcome[0]
        )
    )


def first_overturning(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    a_max: float,
    near: float,
) -> float | None:
    """Return the lowest amplitude that overturns a body [m/s2], None without one; near:
    a guess of it [m/s2], which saves time.
    """
    asked = _capacity_search(structure, motion, shaking, a_max)
    near = min(
        float(structure.dimensionless_amplitude(near)),
        max(asked.amplitude, 0.5 * a_max),
    )
    found = (
        asked._replace(amplitude=near, a_max=max(a_max, 2.0 * asked.amplitude))
        .capacity()
        .first
    )
    return None if found is None else float(structure.ground_acceleration(found))


def _capacity_search(
    structure: RockingParameters, motion: Motion, shaking: Grid, a_max: float
) -> CapacitySearch:
    """Return the search for the overturning amplitudes of a demand. Raises UsageError
    as `check` does.
    """
    if structure.dimensionless:
        raise UsageError("a restitution alone has no units: give a structure document")
    amplitude, omega = shaking.cell(structure)
    if not amplitude > 0.0:
        raise UsageError("the amplitude is 0; expected a positive one")
    return CapacitySearch(
        structure,
        motion,
        amplitude,
        omega,
        governing_method(structure, dimensionless=shaking.dimensionless),
        a_max,
    )


def _judged(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    a_max: float | None,
    fall_search: "FallSearch | None",
    done: Callable[[float], None],
) -> Verdict:
    """Return the verdict of `check`; fall_search: the search for overturning
    amplitudes, if one has begun; done: called with the share of the verdict that is
    known.
    """
    search = _capacity_search(structure, motion, shaking, a_max or 0.0)
    _, _, amplitude, omega, method, _ = search
    shifted = amplitude * (1.0 + _SHIFTS)
    governs = _respond(method, structure, motion, shifted, omega)
    outcome, rotation = Outcome(int(governs.outcome[0])), float(governs.theta_ratio[0])
    stands, falls = (
        safe(governs.outcome),
        ~safe(governs.outcome) & (governs.outcome != Outcome.FAILED),
    )
    linear = _respond(LINEAR, structure, motion, shifted[:1], omega)
    done(1 / _STAGES)
    if a_max is None:
        least = method.system_of(structure).least_uplift(motion)
        found = Capacity(None, None, least if math.isfinite(least) else None)
    else:
        found = search.capacity(fall_search, lambda share: done(_SEARCHED * share))
    free = None
    if structure.restraints and a_max is not None:
        free = (
            search._replace(structure=replace(structure, restraints=None))
            .capacity()
            .first
        )
    done(2 / _STAGES)
    asked = _of_history(method, structure, motion, shaking)
    done(1.0)
    near = shifted[falls] if stands[0] and a_max is not None else shifted[:0]

    acceleration = partial(_least_acceleration, structure)
    digits = _DIGITS if found.share_of_falls else None
    return Verdict(
        structure=structure.name,
        motion=motion.name,
        model=method.model,
        outcome=outcome,
        theta_ratio=rotation if np.isfinite(rotation) else None,
        demand_a=float(structure.ground_acceleration(amplitude)),
        uplift_a=acceleration(found.uplift),
        first_overturning_a=_rounded_down(acceleration(found.first, *near), digits),
        safe_to=_rounded_down(
            acceleration(found.safe_to, *near[near > amplitude]), digits
        ),
        outcome_linear=Outcome(int(linear.outcome[0])),
        unsettled=bool(
            stands.any()
            and (falls.any() or np.ptp(governs.theta_ratio[stands]) > _SAME)
        ),
        share_of_falls=found.share_of_falls,
        searched_to=None if a_max is None else acceleration(search.ends()[1]),
        first_overturning_a_free=acceleration(free),
        omega_g=None if motion.acceleration is not None else omega * structure.p,
        slides=structure.friction is not None
        and (asked.get("friction_needed") or 0.0) > structure.friction,
        **asked,
    )


def _least_acceleration(
    structure: RockingParameters, *amplitudes: float | None
) -> float | None:
    """Return the least of these amplitudes A as an acceleration [m/s2], None without
    one.
    """
    least = min((x for x in amplitudes if x is not None), default=None)
    return None if least is None else float(structure.ground_acceleration(least))


def _rounded_down(value: float | None, digits: int | None) -> float | None:
    """Return a positive number rounded down to so many digits; digits: None for all."""
    if value is None or digits is None:
        return value
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return math.floor(value / unit) * unit


def verdicts(
    demands: Sequence[Demand],
    *,
    a_max: float | Limit | None = A_MAX,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Iterator[Verdict]:
    """Yield the verdict on each demand (structure, motion, shaking), in their order, as
    soon as it is found.

    a_max: an A, or an acceleration for every structure, None for no search; workers:
    number of processes, None for all cores if that saves time; progress: called with
    the number of finished checks, of which a part counts as a fraction, and of all.
    Raises as `check` does, and OutputError when a worker process dies.
    """
    available, done = workers or available_cpus(), progress or _no_progress
    shared = (
        any(len(motion.segments) > LONGEST_FINE for _, motion, _ in demands)
        and a_max is not None
    )
    worth = 1 if workers or shared else _WORTH
    several = max(1, min(available, len(demands) // worth))
    size = 1
    if shared:  # groups of one size, as many for each process
        rounds = math.ceil(len(demands) / (several * _TOGETHER))
        size = math.ceil(len(demands) / (several * rounds))
    groups = [demands[i : i + size] for i in range(0, len(demands), size)]
    if several == 1:
        for i, group in enumerate(groups):
            yield from _each(
                a_max, group, partial(_after, done, i * size, len(demands))
            )
        return
    known = 0.0  # verdicts, of those under way the parts that are known

    def tell(reported: float) -> None:
        nonlocal known
        known = max(known, reported)
        done(known, len(demands))

    def parts(reported: float) -> None:
        tell(min(reported, len(demands) - _LAST))

    task, advice = partial(_all, a_max), "fewer `workers` need less"
    with processes(several, task, advice, parts) as run:
        for i, verdict in enumerate(chain.from_iterable(run(groups)), 1):
            tell(i)
            yield verdict


def tally(verdicts: Sequence[Verdict]) -> str:
    """Return a text with the number of structures that overturn, and, if there are any,
    of those that lose contact or lean.
    """
    lost, leans = (
        sum(v.outcome == outcome for v in verdicts)
        for outcome in (Outcome.LOST_CONTACT, Outcome.LEANING)
    )
    overturn = (
        f"{sum(v.outcome.overturned for v in verdicts)} of {len(verdicts)} overturn"
    )
    overturn += (
        f", {lost} lose{'s' if lost == 1 else ''} contact with the ground"
        if lost
        else ""
    )
    return overturn + (
        f", {leans} come{'s' if leans == 1 else ''} to rest leaning" if leans else ""
    )


def _no_progress(done: float, total: int) -> None:
    """Show no progress."""


def _after(progress: Progress, before: int, checks: int, done: float) -> None:
    """Call `progress` with the number of finished checks and of all; before: those
    before the present group, done: those in it.
    """
    progress(before + done, checks)


class _Shares:
    """The shares of several verdicts that are known; `tell` is called with their sum
    whenever it grows."""

    def __init__(self, count: int, tell: Callable[[float], None]) -> None:
        self._shares = [0.0] * count
        self._tell = tell

    def _grow(self, number: int, share: float) -> None:
        if share > self._shares[number]:
            self._shares[number] = share
            self._tell(sum(self._shares))

    def of(self, number: int) -> Callable[[float], None]:
        """Return a function that takes the share of one verdict."""
        return partial(self._grow, number)

    def all(self, share: float) -> None:
        """Take a share of all verdicts."""
        for number in range(len(self._shares)):
            self._grow(number, share)


def _each(
    a_max: float | Limit | None,
    demands: Sequence[Demand],
    tell: Callable[[float], None],
) -> Iterator[Verdict]:
    """Yield the verdicts on several demands; their searches share their scans. tell:
    called with the number of those that are known.
    """
    shares = _Shares(len(demands), tell)
    most = [
        None if a_max is None else limit_of(a_max, structure)
        for structure, _, _ in demands
    ]
    found = fall_searches(
        [
            _capacity_search(*demand, a)
            for demand, a in zip(demands, most, strict=True)
            if a is not None
        ],
        lambda share: shares.all(_SEARCHED * share),
    )
    for i, (demand, a, fall_search) in enumerate(
        zip(demands, most, found or repeat(None), strict=False)
    ):
        yield _judged(*demand, a, fall_search, shares.of(i))


def _all(a_max: float | Limit | None, demands: Sequence[Demand]) -> list[Verdict]:
    """Return the verdicts on several demands in a worker process."""
    return list(_each(a_max, demands, part_reporter()))


def _of_history(
    method: Method, structure: RockingParameters, motion: Motion, shaking: Grid
) -> dict[str, Any]:
    """Return friction_needed, fz_min, top_displacement and devices, or opens, from the
    history, which goes on to `FALLEN`.
    """
    arch = (
        isinstance(structure.mechanism, FourBar)
        and method.model == "nonlinear"
        and not structure.damping
    )
    if (
        structure.arm is None
        and not structure.top
        and not structure.restraints
        and not arch
    ):
        return {}
    found = time_history(structure, motion, shaking, [method])
    if arch:
        forces = found.forces[method.model]
        assert not isinstance(forces, ForceHistory)
        return {"opens": forces.opens()}
    devices = found.histories[method.model].devices
    top: dict[str, Any] = {
        "top_displacement": found.top_displacement(method.model),
        **({"devices": devices} if devices else {}),
    }
    if structure.arm is None or devices:
        return top
    asked = found.forces[method.model].summary("tau", 1.0)
    return top | {key: asked[key] for key in ("friction_needed", "fz_min")}


def _respond(
    method: Method,
    structure: RockingParameters,
    motion: Motion,
    amplitude: np.ndarray,
    omega: float,
) -> Response:
    return response(
        method.system_of(structure),
        motion,
        amplitude,
        omega,
        structure.eta,
        how="floats",
    )
