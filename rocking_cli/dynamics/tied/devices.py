"""Ties and a tendon in the units of an equation: elongation, force, and the rotations
at which a branch of their force law ends.

A tie at the height h and the distance x behind the pivot has the elongation e = x (1 -
cos theta) + h sin theta and the lever h cos theta + x sin theta; a tendon at the
distance b has e = 2 b sin(theta/2) and the lever b cos(theta/2). (Some sources let a
tendon break at b sin theta, which contradicts this lever.) In the linear equation e = h
theta or b theta, with the levers h and b. The force is

    F = 0 (slack, broken),  P0 + K (e - e_p) (elastic),  F_y (yielding),
    e_p the permanent elongation

A device acts on one side; a tie that acts on both sides is two devices. A tendon acts
on both sides and breaks on both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from ...arrays import Array
from ...structures.parameters import RockingParameters
from ...structures.restraints import SIDES, Restraints, Tie
from ..body import Body
from ..equations.equation import Equation
from .pulls import Pull, elongation

SLACK, ELASTIC, YIELDING, BROKEN = range(4)
ROWS = ("right", "left")  # sides as rows of arrays
TENDON = "tendon"  # the name of the tendon among the devices


class Branch(NamedTuple):
    """The present branch of the force law of each device, for lanes on their sides."""

    low: Array  # y at which each branch ends inwards, (devices, lanes)
    high: Array  # y at which each branch ends outwards, (devices, lanes)
    fixed: Array  # force at e = 0 [N], (devices, lanes)
    rate: Array  # growth of the force with e [N/m], (devices, lanes)
    yields: Array  # True for lanes with a yielding device, (lanes,)

    def take(self, at: Array | slice) -> Branch:
        """Return the branches of these lanes."""
        return Branch(*(x[..., at] for x in self))


@dataclass(frozen=True, eq=False)
class Devices:
    """The restraints of a body on its sides, or of several bodies. A row is a side of a
    body: the right side comes first, and the sides of a body follow each other. Arrays
    are (rows, devices) unless their comment names another shape.
    """

    # fields that may differ from cell to cell in one march
    cellwise: ClassVar[tuple[str, ...]] = (
        "stiffness",
        "prestress",
        "force",
        "ultimate",
        "height",
        "behind",
        "unit",
        "moment",
        "weight",
    )

    stiffness: Array  # growth of the force with the elongation [N/m]
    prestress: Array  # P0, the force at elongation 0 [N]
    force: Array  # F_y, the yield force [N]
    ultimate: Array  # u_ult, elongation at which the device breaks [m]
    height: Array  # h, of a tendon b [m]
    behind: Array  # x, of a tendon 0 [m]
    unit: Array  # rotation of y = 1 [rad], (rows, 1)
    moment: Array  # m g R times the unit [N m], (rows, 1)
    tendon: Array  # True for the tendon, (devices,)
    names: tuple[str, ...]  # name of each device, (devices,)
    linear: bool  # True for the linear equation
    # gives the ground forces of the free body, None if they are not known
    body: Body | None
    # m g [N], infinite if the ground forces are not known, float or (rows,)
    weight: Any
    sides: int  # number of sides of a body
    # index of the body of each cell, (cells,); None for one body
    which: Array | None = None

    @classmethod
    def of(
        cls,
        structure: RockingParameters,
        equation: Equation,
        *,
        linear: bool,
        body: Body | None,
    ) -> Self | None:
        """Build the devices of a structure with restraints under the equation of its
        free body; None if no restraint ever pulls.
        """
        restraints = structure.restraints
        assert restraints is not None
        stands = dict(zip(SIDES["both"], restraints.stands, strict=True))
        rows = ROWS[:1] if structure.one_sided else ROWS
        columns = _columns(restraints, rows)
        if not columns:
            return None
        numbers = np.array(list(columns.values())).transpose(2, 1, 0)

        # The rotation of y = 1, and the moment that gives y'' the unit 1.
        sides = np.array([1.0, -1.0])
        rotation = equation.on(sides).rotation(np.ones(2)) * structure.alpha_on(sides)
        unit = np.broadcast_to(rotation, 2)[: len(rows), None]
        moment = unit * np.array([[stands[row].moment] for row in rows])

        arm = structure.edges[0].arm
        weight = np.inf
        if body is not None and arm is not None:
            weight = restraints.stands[0].moment / arm
        return cls(
            **dict(zip(cls.cellwise[:6], numbers, strict=True)),
            unit=unit,
            moment=moment,
            tendon=np.array([name == TENDON for name in columns]),
            names=tuple(columns),
            linear=linear,
            body=body,
            weight=weight,
            sides=len(rows),
        )

    def of_each_cell(self, devices: Sequence[Self], counts: Sequence[int]) -> Self:
        """Return the devices of so many cells of each of these bodies, the first of
        which is this one; they differ in `cellwise` fields only.
        """
        numbers: dict[str, Any] = {
            name: np.concatenate([np.atleast_1d(getattr(one, name)) for one in devices])
            for name in self.cellwise
            if name != "weight"
        }
        return replace(
            self,
            **numbers,
            body=None
            if self.body is None
            else Body.of_each_cell([one.body for one in devices if one.body], counts),
            weight=np.repeat([one.weight for one in devices], self.sides),
            which=np.repeat(np.arange(len(devices)), counts),
        )

    def row(self, side: Array, cell: Array | None = None) -> Array:
        """Return the row of each side, +1 or -1, in the arrays of this class; cell: the
        cells of the lanes, if each has a body of its own.
        """
        on_side = (side < 0.0).astype(np.int64) * (self.sides - 1)
        if self.which is None or cell is None:
            return on_side
        return np.asarray(on_side + self.sides * self.which[cell])

    def place(self, row: Array, at: Array | None = None) -> tuple[Array, slice, Array]:
        """Return the place of the devices of these rows in arrays (sides, devices,
        lanes); at: indices of the lanes, None: all of them.
        """
        at = np.arange(row.size) if at is None else at
        return row % self.sides, slice(None), at

    def lever_ends(self) -> Array:
        """The y at which a tie has lost its lever, (rows,): the body counts as
        overturned from there on.
        """
        if self.linear:
            return np.full(len(self.unit), np.inf)
        turned = np.arctan2(self.height, -np.minimum(self.behind, 0.0)).min(axis=1)
        return np.asarray(turned / self.unit[:, 0])

    def on(self, numbers: Array, row: Array) -> Array:
        """The numbers of the devices on these sides, (devices, lanes); (devices, 1) if
        both sides have the same devices.
        """
        return numbers[:1].T if self.alike else numbers[row].T

    def elongation(self, row: Array, y: Array) -> Array:
        """The elongation e [m] of each device at y, (devices, lanes)."""
        theta = self.unit[row, 0] * y
        numbers = self.on(self.height, row), self.on(self.behind, row), self._kinds
        return np.array([elongation(*one, theta) for one in zip(*numbers, strict=True)])

    def level(self, row: Array, e: Array) -> Array:
        """The y at which each device has the elongation e [m], (devices, lanes);
        infinite where no rotation reaches e.
        """
        h = self.on(self.height, row)
        x = self.on(self.behind, row)
        unit = self.unit[row, 0]
        if self.linear:
            return e / h / unit
        with np.errstate(invalid="ignore"):
            turned = np.arctan2(x, h) - np.arcsin((x - e) / np.hypot(x, h))
            if self.tendon.any():
                turned = np.where(
                    self.tendon[:, None], 2.0 * np.arcsin(0.5 * e / h), turned
                )
        # e = 0 is the ground, whatever rounding makes of it
        turned = np.where(e > 0.0, turned, np.minimum(turned, 0.0))
        return (
            np.where(np.isnan(turned), np.where(e > 0.0, np.inf, -np.inf), turned)
            / unit
        )

    def thresholds(self, row: Array, plastic: Array | float) -> tuple[Array, Array]:
        """(e from which a device pulls, e at which it yields) with these permanent
        elongations [m]; infinite without stiffness.
        """
        stiffness = self.on(self.stiffness, row)
        prestress = self.on(self.prestress, row)
        with np.errstate(divide="ignore", invalid="ignore"):
            pulls = plastic - prestress / stiffness
            yields = plastic + (self.on(self.force, row) - prestress) / stiffness
        return np.where(stiffness > 0.0, pulls, -np.inf), np.where(
            stiffness > 0.0, yields, np.inf
        )

    def stretched(self, row: Array, elongation: Array) -> Array:
        """The permanent elongation [m] of a device that yields up to this elongation
        and then unloads.
        """
        _, yields = self.thresholds(row, 0.0)
        return np.maximum(0.0, np.where(np.isfinite(yields), elongation - yields, 0.0))

    def branch(self, row: Array, branch: Array, plastic: Array) -> Branch:
        """The limits in y and the force law of devices on these branches."""
        pulls, yields = self.thresholds(row, plastic)
        ultimate, stiffness = self.on(self.ultimate, row), self.on(self.stiffness, row)
        elastic, yielding = branch == ELASTIC, branch == YIELDING
        # The branch ends upwards where a slack device begins to pull, an elastic one
        # yields or breaks, and a yielding one breaks.
        high = np.where(
            branch == SLACK,
            pulls,
            np.where(
                elastic,
                np.minimum(yields, ultimate),
                np.where(yielding, ultimate, np.inf),
            ),
        )
        # Downwards only an elastic device ends its branch: it becomes slack.
        low = np.where(elastic, pulls, -np.inf)
        fixed = np.where(
            elastic, self.on(self.prestress, row) - stiffness * plastic, 0.0
        )
        fixed = np.where(yielding, self.on(self.force, row), fixed)
        return Branch(
            self.level(row, low),
            self.level(row, high),
            fixed,
            np.where(elastic, stiffness, 0.0),
            yielding.any(axis=0),
        )

    def at_ground(self, row: Array, branch: Array, plastic: Array) -> Array:
        """The branch of each device when a body leaves the ground onto these sides."""
        pulls, _ = self.thresholds(row, plastic)
        return np.where(
            branch == BROKEN, BROKEN, np.where(pulls <= 0.0, ELASTIC, SLACK)
        )

    def force_at_ground(self, row: Array, branch: Array, plastic: Array) -> Array:
        """The force [N] of each device on bodies at the ground, (devices, lanes)."""
        force = np.clip(
            self.on(self.prestress, row) - self.on(self.stiffness, row) * plastic,
            0.0,
            None,
        )
        return np.where(branch == BROKEN, 0.0, force)

    def pull(self, row: Array, branch: Array, plastic: Array) -> Array:
        """The restoring acceleration -y'' that the devices add to bodies at the ground,
        (lanes,).
        """
        return (
            _added(
                self.force_at_ground(row, branch, plastic) * self.on(self.height, row)
            )
            / self.moment[row, 0]
        )

    def press(self, row: Array, branch: Array, plastic: Array) -> Array:
        """The vertical force of a tendon on bodies at the ground, over
        m g, (lanes,).
        """
        return _added(
            np.where(
                self.tendon[:, None],
                self.force_at_ground(row, branch, plastic),
                0.0,
            )
        ) / self._weight_on(row)

    def _weight_on(self, row: Array) -> Any:
        return self.weight if self.which is None else self.weight[row]

    def largest_pull(
        self, row: Array, branch: Array, plastic: Array, y: Array
    ) -> Array:
        """An upper bound of the restoring acceleration -y'' that the devices add up to
        y, if none yields before, (lanes,).
        """
        stiffness, height, behind = (
            self.on(x, row) for x in (self.stiffness, self.height, self.behind)
        )
        # The force grows with the elongation, and the lever of a tie behind the pivot
        # (x > 0) with the rotation: both have their largest values at y.
        stretched = self.elongation(row, y) - plastic
        force = np.clip(
            self.on(self.prestress, row) + stiffness * np.maximum(stretched, -plastic),
            0.0,
            None,
        )
        lever = (
            height
            if self.linear
            else height
            + np.maximum(behind, 0.0)
            * np.sin(np.minimum(self.unit[row, 0] * y, 0.5 * np.pi))
        )
        return (
            _added(np.where(branch == BROKEN, 0.0, force) * lever) / self.moment[row, 0]
        )

    @cached_property
    def _kinds(self) -> tuple[str, ...]:
        """The geometry of each device: "linear", "tendon" or "tie"."""
        if self.linear:
            return ("linear",) * len(self.names)
        return tuple("tendon" if x else "tie" for x in self.tendon.tolist())

    @cached_property
    def alike(self) -> bool:
        """True if the sides have the same devices."""
        numbers = (getattr(self, name) for name in self.cellwise if name != "weight")
        return all(bool(np.all(x == x[0])) for x in numbers)

    def held_at_first(self) -> Array:
        """The drive at which the restrained body leaves the ground onto each side, over
        that of the free body, before any yield, (rows, 1).
        """
        rows = np.arange(len(self.stiffness))
        none = np.zeros((len(self.names), len(self.stiffness)))
        return np.asarray(1.0 + self.pull(rows, none, none)[:, None])

    def downwards(self, row: Array, now: Branch, y: Array) -> Array:
        """The vertical force of a tendon on the body, over m g, (lanes,)."""
        force = np.where(
            self.tendon[:, None], now.fixed + now.rate * self.elongation(row, y), 0.0
        )
        return (
            _added(force) * np.cos(0.5 * self.unit[row, 0] * y) / self._weight_on(row)
        )

    def tendon_bounds(
        self, row: Array, now: Branch, turned: Array
    ) -> tuple[Array, Array]:
        """(largest force of a tendon up to this rotation [rad], its stiffness times its
        lever), each over m g, (lanes,).
        """
        stiffness = now.rate * self.on(self.height, row)
        force = np.abs(now.fixed) + stiffness * turned
        of_tendon = self.tendon[:, None]
        largest, steepest = (
            _added(np.where(of_tendon, x, 0.0)) for x in (force, stiffness)
        )
        weight = self._weight_on(row)
        return largest / weight, steepest / weight

    def pull_on(self, row: Array, now: Branch) -> Pull:
        """The pull of the devices on lanes on these branches."""
        height, behind = (
            tuple(np.broadcast_to(self.on(x, row), now.fixed.shape))
            for x in (self.height, self.behind)
        )
        return Pull(
            tuple(now.fixed),
            tuple(now.rate),
            height,
            behind,
            self._kinds,
            self.unit[row, 0],
            self.moment[row, 0],
        )

    def linear_terms(self, row: Array, now: Branch) -> tuple[Array, Array]:
        """(constant, stiffness) that the devices add to -y'' = constant + stiffness y
        in the linear equation, each (lanes,).
        """
        h, moment = self.on(self.height, row), self.moment[row, 0]
        return (
            _added(now.fixed * h) / moment,
            _added(now.rate * h * h) * self.unit[row, 0] / moment,
        )

    def circular_terms(self, row: Array, now: Branch) -> Array:
        """Coefficients of cos theta, sin theta, cos 2 theta, sin 2 theta and, with a
        tendon, cos(theta/2), sin(theta/2), in y'', (4 or 6, lanes).
        """
        h = self.on(self.height, row)
        x = self.on(self.behind, row)
        tie = ~self.tendon[:, None]
        fixed, rate = now.fixed + now.rate * x, np.where(tie, now.rate, 0.0)
        rows = [
            _added(np.where(tie, fixed * h, 0.0)),
            _added(np.where(tie, fixed * x, now.rate * h * h)),
            _added(-rate * x * h),
            _added(0.5 * rate * (h * h - x * x)),
        ]
        if self.tendon.any():
            rows += [_added(np.where(tie, 0.0, now.fixed * h)), np.zeros(row.size)]
        return np.asarray(-np.array(rows) / self.moment[row, 0])


def _columns(
    restraints: Restraints, rows: Sequence[str]
) -> dict[str, list[tuple[float, ...]]]:
    """The numbers of each restraint that can pull, by its name: a row a side, (sides,
    6).
    """
    stands = dict(zip(SIDES["both"], restraints.stands, strict=True))
    columns = {}
    for i, tie in enumerate(restraints.ties):
        if tie.stiffness or tie.prestress:
            columns[f"tie {i + 1}"] = [_of_tie(tie, row) for row in rows]
    held = restraints.tendon
    if held and (held.stiffness or held.prestress):
        columns[TENDON] = [_of_tie(held.at(stands[row].lever), row) for row in rows]
    return columns


def _of_tie(tie: Tie, row: str) -> tuple[float, ...]:
    """Return the numbers of a tie on one side of the body; zero stiffness if the tie
    does not act there.
    """
    if row not in SIDES[tie.side]:
        return 0.0, 0.0, np.inf, np.inf, tie.height, tie.behind
    return (
        tie.stiffness,
        tie.prestress,
        tie.yield_force,
        tie.ultimate,
        tie.height,
        tie.behind,
    )


def _added(rows: Array) -> Array:
    """The sum over the devices, in their order, so that no digit depends on a lane's
    neighbours.
    """
    total = rows[0].copy()
    for row in rows[1:]:
        total += row
    return total
