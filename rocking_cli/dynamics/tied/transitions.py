"""Restraints from branch to branch of their force laws: engagement, yield, unloading,
slack and rupture.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from .devices import BROKEN, ELASTIC, SLACK, YIELDING, Devices
from .tied_lanes import TiedLanes


def release(devices: Devices, lanes: TiedLanes) -> None:
    """Stretch the devices of lanes that are released at their y on the right."""
    row = devices.row(lanes.side, lanes.cell)
    e = devices.elongation(row, lanes.y)
    lanes.plastic[0], lanes.farthest[0] = devices.stretched(row, e), e
    pulls, _ = devices.thresholds(row, lanes.plastic[0])
    broken = e >= devices.on(devices.ultimate, row)
    unbroken = np.where(e > pulls, ELASTIC, SLACK)
    lanes.branch[0] = np.where(broken, BROKEN, unbroken)


def leave(devices: Devices, lanes: TiedLanes, at: Array) -> None:
    """Set the devices of lanes that leave the ground to the branches in which they
    begin.
    """
    row = devices.row(lanes.side[at], lanes.cell[at])
    here = devices.place(row, at)
    branch, plastic = lanes.branch[here].T, lanes.plastic[here].T
    lanes.branch[here] = devices.at_ground(row, branch, plastic).T


def stretch(
    devices: Devices, lanes: TiedLanes, at: Array, row: Array, top: Array
) -> None:
    """Note the elongation of unbroken devices at y = `top` where it is their
    largest so far.
    """
    e, row = devices.elongation(row[at], top[at]), row[at]
    here = devices.place(row, at)
    whole, before = lanes.branch[here].T != BROKEN, lanes.farthest[here].T
    lanes.farthest[here] = np.where(whole, np.maximum(before, e), before).T


def pass_end(
    devices: Devices,
    lanes: TiedLanes,
    at: Array,
    row: Array,
    limits: Array,
    sign: float,
) -> Array:
    """Move devices of the lanes `at` that are at an upper (sign = 1) or lower (sign
    = -1) end of their branch to the next branch; returns the lanes in which one
    breaks.
    """
    row = row[at]
    reached = sign * (lanes.y[at] - limits[:, at]) >= 0.0
    here = devices.place(row, at)
    branch, plastic = lanes.branch[here].T, lanes.plastic[here].T
    ultimate = devices.on(devices.ultimate, row)

    # Outwards a slack device engages, an elastic one yields or breaks, and a
    # yielding one breaks; inwards an elastic one becomes slack.
    if sign > 0.0:
        _, yields = devices.thresholds(row, plastic)
        begins_to_yield = (branch == ELASTIC) & (yields < ultimate)
        stretched = np.where(begins_to_yield, YIELDING, BROKEN)
        following = np.where(branch == SLACK, ELASTIC, stretched)
    else:
        following = np.full(branch.shape, SLACK)
    following = np.where(reached, following, branch)
    breaks = reached & (following == BROKEN)
    kept = np.where(breaks, devices.stretched(row, ultimate), plastic)
    lanes.branch[here], lanes.plastic[here] = following.T, kept.T

    # A tendon breaks on both sides. Without it Fz is not what it was on the way
    # back from a peak: the peaks count anew.
    for device in np.flatnonzero(devices.tendon):
        lanes.branch[:, device, at[breaks[device]]] = BROKEN
        lanes.turned[at[breaks[device]]] = 0
    return at[breaks.any(axis=0)]


def unload(devices: Devices, lanes: TiedLanes, at: Array, row: Array) -> None:
    """Unload the lanes `at`, whose velocity has changed sign: yielding devices
    become elastic and keep their permanent elongation.
    """
    if not at.size:
        return
    row = row[at]
    here = devices.place(row, at)
    branch = lanes.branch[here].T
    keep_yield(devices, lanes, at, row)
    lanes.branch[here] = np.where(branch == YIELDING, ELASTIC, branch).T


def keep_yield(devices: Devices, lanes: TiedLanes, at: Array, row: Array) -> None:
    """Store the permanent elongation of the yielding devices of the lanes `at`;
    row: of these lanes.
    """
    here = devices.place(row, at)
    branch, plastic = lanes.branch[here].T, lanes.plastic[here].T
    left = devices.stretched(row, devices.elongation(row, lanes.y[at]))
    lanes.plastic[here] = np.where(
        branch == YIELDING, np.maximum(left, plastic), plastic
    ).T
