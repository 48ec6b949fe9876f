"""The verdict on a structure under one motion, as a record and as a row."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from ..digits import rounded_down
from ..dynamics.outcome import Outcome
from ..showing import Shown

CHECK_KEYS = ("structure", "motion")  # the columns that say which row it is
CHECK_COLUMNS = (
    "structure",
    "motion",
    "model",
    "outcome",
    "capacity_demand",
    "first_overturning_a",
    "uplift_a",
    "top_displacement",
    "theta_ratio",
    "demand_a",
    "safe_to",
    "searched_to",
    "outcome_linear",
    "friction_needed",
    "fz_min",
    "omega_g",
)
DECISIVE = (*CHECK_KEYS, *CHECK_COLUMNS[3:8], "demand_a")  # those of every table
TIED_COLUMNS = (
    "first_overturning_a_free",
    "tie_force",
    "tie_elongation",
    "permanent",
    "tie_state",
)
SLIDE_COLUMNS = (
    "slide_a",
    "slide_max",
    "slide_residual",
    "slide_speed",
    "stuck_outcome",
    "stuck_first_overturning_a",
)
FLOOR_COLUMNS = ("floor_pga", "floor_chord")
KNOWN = 4  # significant digits of a capacity where many narrow intervals overturn


@dataclass(frozen=True)
class SlideVerdict:
    """What a verdict on a body that slides adds; its rocking answer is that of the same
    body on a base that does not slide.
    """

    slide_a: float  # mu_s g, the ground acceleration from which it slides [m/s2]
    slide_max: float  # largest displacement over the ground [m]
    slide_residual: float  # displacement at the end [m], positive with +x_g
    slide_speed: float  # largest speed over the ground [m/s]
    stuck_outcome: Outcome  # of the base that does not slide
    # lowest a_g that overturns the body on that base [m/s2], None if none does
    stuck_first_overturning_a: float | None
    words: str  # what the body does, in words

    def row(self) -> dict[str, Any]:
        """Return the columns SLIDE_COLUMNS."""
        own = asdict(self) | {"stuck_outcome": self.stuck_outcome.flag}
        return {key: own[key] for key in SLIDE_COLUMNS}


@dataclass(frozen=True, repr=False)
class Verdict(Shown):
    """The verdict on a structure under a motion, as `check` returns it.

    It is that of the governing equation; accelerations are amplitudes a_g of the
    motion. `capacity_demand` is the lowest overturning amplitude over the demand,
    `falls` and `sentence` state the outcome, `row` is what `rocking check --json`
    prints: if many narrow intervals overturn the body, its amplitudes and
    capacity_demand have four digits, or as many as show on which side of the demand
    they lie.

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
        body whose mass centre is known, and of a mechanism that states a friction; None
        if it loses contact
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
    opens: True if a further hinge opens in an arch, or a hinge of another mechanism
        lifts off, so that another mechanism follows; None for another structure
    lost_in_fall: True if a body that overturns loses contact with the ground during its
        fall, which is therefore not proved
    searched_to: largest a_g of the search [m/s2]; None without a search
    omega_g: circular frequency of a pulse [rad/s], None under a record
    capacity_demand: first_overturning_a over demand_a [-], None if nothing overturns
        the body
    coupling: what is known, in words, of a body that slides, or may slide, while it
        rocks
    slide: the sliding of a body that slides and never rocks; None for another one
    floor_pga: of a body on a floor of a building: largest acceleration of the floor
        [m/s2]
    floor_chord: what its straight lines miss at most, over floor_pga [-]
    ranged: columns of a range of frequencies [Hz] or azimuths [rad]: where the capacity
        is least (worst_f_g, azimuth), and where theta_ratio and top_displacement are
        largest (largest_f_g, largest_azimuth); the other numbers are those of the first

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
    # centre is known, and of a mechanism that states a friction; None if it loses
    # contact
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
    # True if a further hinge opens in an arch, or a hinge of another mechanism lifts
    # off, so that another mechanism follows; None for another structure
    opens: bool | None = None
    # True if a body that overturns loses contact with the ground during its fall
    lost_in_fall: bool = False
    # largest a_g of the search [m/s2]; None without a search
    searched_to: float | None = None
    # circular frequency of a pulse [rad/s], None under a record
    omega_g: float | None = None
    # what is known, in words, of a body that slides, or may slide, while it rocks
    coupling: str = ""
    # the sliding of a body that slides and never rocks; None for another one
    slide: SlideVerdict | None = None
    # of a body on a floor of a building: largest acceleration of the floor [m/s2]
    floor_pga: float | None = None
    # what its straight lines miss at most, over floor_pga [-]
    floor_chord: float | None = None
    # columns of a range of frequencies [Hz] or azimuths [rad]: where the capacity is
    # least, and where the rotation is largest
    ranged: Mapping[str, float | str | None] = field(default_factory=dict)

    # lowest overturning amplitude over the demand [-]; None if nothing overturns it
    capacity_demand: float | None = field(init=False)

    def __post_init__(self) -> None:
        first = self.first_overturning_a
        capacity = None if first is None else first / self.demand_a
        object.__setattr__(self, "capacity_demand", capacity)

    @property
    def sentence(self) -> str:
        """The outcome in words."""
        if self.slide is not None and self.outcome == Outcome.SLID:
            return f"slides {1e3 * self.slide.slide_max:.3g} mm and never rocks"
        return (
            self.outcome.sentence
            + ", on the last digits" * self.unsettled
            + ", though its base would slide" * self.slides
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

    def _shown(self) -> dict[str, Any]:
        found = self.row()
        del found["omega_g"]  # of the demand
        if self.capacity_demand is not None:  # a limit that was not needed
            del found["searched_to"]
        return found

    def _rows(self) -> list[dict[str, Any]]:
        return [self.row()]

    def row(self) -> dict[str, Any]:
        """Return the verdict as `rocking check --json` prints it."""
        own = {
            **vars(self),
            "outcome": self.outcome.flag,
            "outcome_linear": self.outcome_linear.flag,
        }
        found = {key: own[key] for key in CHECK_COLUMNS} | dict(self.ranged)
        if self.opens is not None:
            found["opens"] = self.opens
        if self.lost_in_fall:
            found["lost_in_fall"] = True
        if self.share_of_falls:
            found |= {
                key: None if own[key] is None else rounded_down(own[key], KNOWN, limit)
                for key, limit in (
                    ("first_overturning_a", self.demand_a),
                    ("safe_to", self.demand_a),
                    ("capacity_demand", 1.0),
                )
            }
            found["falls_nearby"] = self.share_of_falls
        if self.slide is not None:
            found |= self.slide.row()
        if self.floor_chord is not None:
            found |= {key: getattr(self, key) for key in FLOOR_COLUMNS}
        if not self.devices:
            return found
        from .tied_history import columns_of

        return (
            found
            | {"first_overturning_a_free": self.first_overturning_a_free}
            | columns_of(self.devices)
        )
