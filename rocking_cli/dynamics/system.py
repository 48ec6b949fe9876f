"""A rocking structure for the march: an equation of motion and a contact."""

import math
from collections.abc import Hashable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..errors import ArgumentError, UsageError
from ..motions.motion import Motion
from ..motions.segments import Segments
from .body import Body, safe_acceleration
from .contacts.contact import Contact, Symmetric
from .equations.equation import Equation

if TYPE_CHECKING:
    from .tied.devices import Devices


class System(NamedTuple):
    """An equation of motion on a contact, the first argument of `response`.

    `Method.system_of` makes the system of a structure. `least_uplift` is the amplitude
    at which it lifts off.

    Attributes
    ----------
    equation
        the equation of motion
    contact
        the contact with its restitution, `Symmetric` unless given
    scale
        alpha/a_scale, the ground acceleration over g of A = 1 [-]
    body
        gives the forces on the ground, None if they are not known
    devices
        ties and a tendon, None without them
    springs
        True if it carries weights without mass: a vertical motion is then refused

    Examples
    --------
    >>> system = System(LinearEquation())
    >>> found = response(system, sine(), 1.5, 6.0, 0.9)
    >>> f"{float(found.theta_ratio):.6f}", round(system.least_uplift(sine()), 6)
    ('0.167098', 1.0)
    """

    equation: Equation  # equation of motion
    contact: Contact = Symmetric()  # what happens at impacts and at uplift
    # ground acceleration over g of A = 1 [-], float or (cells,), None if there is none
    scale: Any = None
    body: Body | None = None  # forces on the ground
    devices: "Devices | None" = None  # ties and a tendon
    springs: bool = False  # True if it carries weights without mass

    @property
    def cellwise(self) -> tuple[str, ...]:
        """The fields that may differ from cell to cell in one march."""
        return ("scale",)

    @classmethod
    def of_each_cell(cls, systems: Sequence[Self], counts: Sequence[int]) -> Self:
        """Return one system for the cells of several systems.

        Parameters
        ----------
        systems
            whose `march_key` is the same
        counts
            number of cells of each system, (systems,)

        Returns
        -------
        System
        """
        first = systems[0]
        if len(systems) == 1:
            return first
        bodies = [one.body for one in systems if one.body is not None]
        scales = [one.scale for one in systems]
        return first._replace(
            equation=first.equation.of_each_cell(
                [one.equation for one in systems], counts
            ),
            contact=first.contact.of_each_cell(
                [one.contact for one in systems], counts
            ),
            body=Body.of_each_cell(bodies, counts) if bodies else None,
            devices=first.devices
            and first.devices.of_each_cell(
                [one.devices for one in systems if one.devices], counts
            ),
            scale=None if first.scale is None else np.repeat(scales, counts),
        )

    def with_restitution(self, eta: Any) -> Self:
        """Return the system with another restitution.

        Parameters
        ----------
        eta
            restitution [-], a number or (cells,), within [0, 1], of a one-sided body
            within (-1, 0]; not used if the edges have restitutions of their own

        Returns
        -------
        System

        Raises
        ------
        ArgumentError
            for a restitution out of range
        """
        return self._replace(contact=self.contact.with_restitution(eta))

    def key(self) -> Hashable:
        """Return a key that is made of all fields of the system and of its parts:
        systems of equal keys are the same system.

        Returns
        -------
        tuple
        """
        return _key(self, False)

    def march_key(self, mixed: bool) -> Hashable:
        """Return a key: cells of systems of equal keys may share a march
        (`of_each_cell`).

        Parameters
        ----------
        mixed
            True if they may differ in all numbers that the march has for each cell,
            which it has under a motion without a vertical part; False: in the
            restitution alone

        Returns
        -------
        tuple
        """
        return _key(self, True) if mixed else self.with_restitution(None).key()

    @property
    def alike(self) -> bool:
        """True if both sides are free and equal: a motion of the opposite sign then has
        the mirrored response.
        """
        return self.contact.alike and (self.devices is None or self.devices.alike)

    @property
    def bounded(self) -> bool:
        """True if an envelope may use Lemmas 9 and 10."""
        return self.equation.bounded and self.devices is None

    def segments(self, motion: Motion) -> Segments:
        """Return the segments of a motion, on each of which it is monotone.

        Parameters
        ----------
        motion
            the motion of the ground

        Returns
        -------
        Segments
            with the weight if the motion has a vertical part

        Raises
        ------
        ArgumentError
            for a motion with a vertical part if `scale` is None
        UsageError
            for such a motion of weights without mass, which do not follow it
        """
        if motion.vertical is None:
            return motion.segments
        if self.springs:
            raise UsageError(
                f"{motion.name}: found a vertical motion, and loads of inertia: none,"
                " whose weight it does not change; expected a motion without a vertical"
                " part, or loads of inertia both or vertical"
            )
        if self.scale is None:
            raise ArgumentError(
                "a vertical motion needs the scale of A: the ground acceleration over g"
                " of A = 1"
            )
        from .weighed_drive import weighed

        share = self.scale / self.contact.amplitudes(self.equation, np.ones(1))[:, 0]
        return weighed(motion, float(share[0]), float(share[-1]))

    def safe_amplitude(
        self, motion: Motion, low: bool = False, largest: Array | None = None
    ) -> Any:
        """Return the amplitude up to which contact with the ground is proved.

        Parameters
        ----------
        motion
            the motion of the ground
        low
            True for bodies whose energy stays below the barrier
        largest
            largest |s| of the motion of each cell, (cells,), of motions without
            vertical parts as `motion` is one; None: that of `motion`

        Returns
        -------
        float or numpy.ndarray
            A [-] up to which Fz > 0 for a body that does not overturn, (cells,) if each
            cell has a body of its own; infinite if the forces are not known
        """
        # Lemma 13. Without overturning the push bounds the rotation, and so Fz.
        strongest = motion.largest if largest is None else largest
        if self.body is None or self.scale is None or not np.any(strongest):
            return math.inf
        up = motion.vertical
        sway = 0.0 if up is None else up.largest / motion.largest
        scales = self.body.a_scale or (1.0,) * len(self.body.alpha)
        safe = [
            safe_acceleration(self.body, i, sway and sway / scale, low) / scale
            for i, scale in enumerate(scales)
        ]
        push = np.minimum.reduce(safe) / self.scale
        with np.errstate(divide="ignore"):
            return push / strongest

    def least_uplift(self, motion: Motion) -> float:
        """Return the least amplitude that lifts the body (Eqs. 2.2, 3.8).

        Parameters
        ----------
        motion
            the motion of the ground

        Returns
        -------
        float
            A [-] at which the body lifts off or the ground falls away; infinite if
            there is none
        """
        one = self.contact.amplitudes(self.equation, np.ones(1))
        segments, held = self.segments(motion), one
        if self.devices is not None:
            held = one / self.devices.held_at_first()
        strongest = float(self.contact.strongest(held, segments)[0])
        # w < 0 above 1/|w - 1| of A = 1, also where a wall holds the body
        if (weighed := segments.weighed) is not None:
            strongest = max(
                strongest,
                1.0
                - float(
                    weighed.least_weight(
                        np.ones(1), one[0], np.zeros(1, dtype=np.int64)
                    )[0]
                ),
            )
        return 1.0 / strongest if strongest > 0.0 else math.inf


def _key(x: Any, mixed: bool) -> Hashable:
    """A key of a value and of all of its fields; mixed: True for the form alone of the
    fields that are in its `cellwise`.
    """
    if isinstance(x, np.ndarray):
        return x.shape, x.tobytes()
    if isinstance(x, tuple) and hasattr(x, "_asdict"):
        fields = x._asdict()
    elif isinstance(x, tuple):
        return tuple(_key(one, mixed) for one in x)
    elif isinstance(x, dict):
        fields = x
    elif hasattr(x, "__dict__"):
        fields = {
            name: value
            for name, value in vars(x).items()
            if not isinstance(getattr(type(x), name, None), cached_property)
        }
    else:
        known: Hashable = x
        return known
    cellwise = getattr(x, "cellwise", ()) if mixed else ()
    return type(x), *(
        (name, _form(value) if name in cellwise else _key(value, mixed))
        for name, value in fields.items()
    )


def _form(x: Any) -> Hashable:
    """How many numbers a value has, and whether it has any."""
    if isinstance(x, dict):
        return tuple((name, _form(one)) for name, one in x.items())
    if isinstance(x, tuple):
        return tuple(map(_form, x))
    if isinstance(x, float):
        return ()
    return None if x is None else np.shape(x)
