"""The response in time of a body with ties or a tendon: the forces of these devices,
and a row for each of them.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..dynamics.one.lane import Lane
from ..dynamics.one.march import march
from ..dynamics.one.state import Ended, LawOfDevices
from ..dynamics.system import System
from ..dynamics.tied.devices import BROKEN, YIELDING, Devices
from ..dynamics.tied.tied_lanes import TiedLanes
from ..motions.motion import Motion
from .arcs import DeviceForces, History, HistoryArcs
from .march_writer import MarchWriter

STATES = ("elastic", "yielded", "broken")  # of ties and tendons


class TiedWriter(MarchWriter):
    """Writes down the march of one body with ties or a tendon."""

    ends_at_loss = True

    def __init__(self, system: System, motion: Motion, omega: float) -> None:
        super().__init__(system, motion, omega)
        assert system.devices is not None
        self.devices, force = system.devices, system.devices.prestress
        self.laws = [LawOfDevices(0.0, 0, force.max(axis=0), 0.0 * force[0], force)]

    def hold(self, law: LawOfDevices) -> None:
        self.laws.append(law)

    def _overturn(self, arcs: HistoryArcs, held: float = 0.0) -> None:
        last = max((e.tau for e in self.events if e.device), default=held)
        super()._overturn(arcs, last)

    def _history(self, ended: Ended, duration: float) -> History:
        assert ended.restraints is not None
        rows = tuple(device_rows(self.devices, ended.restraints))
        columns = (np.array(x) for x in zip(*self.laws, strict=True))
        start, row, fixed, rate, held = columns
        forces = DeviceForces(
            self.devices, start, row, fixed.T, rate.T, np.moveaxis(held, 0, -1)
        )
        found = super()._history(ended, duration)
        return replace(found, devices=rows, device_forces=forces)


def device_rows(devices: Devices, found: TiedLanes) -> list[dict[str, Any]]:
    """Return a row for each tie and the tendon of the first lane. device: its name;
    force: its largest force [N]; tie_force: force over its yield, without one over its
    force at rupture [-], None without both; limit: which of these, "yield" or
    "rupture"; tie_elongation, permanent: its largest and its permanent elongation [m];
    state: elastic, yielded or broken; endless: True if it has yielded and no elongation
    breaks it. A tie of both sides acts as two; its row has the larger numbers and the
    worse state.
    """
    rows = np.arange(len(devices.stiffness))
    force = np.minimum(
        devices.prestress + devices.stiffness * found.farthest[:, :, 0], devices.force
    )
    table = []
    for i, name in enumerate(devices.names):
        on = [
            row
            for row in rows
            if devices.stiffness[row, i] or devices.prestress[row, i]
        ]
        at = on[0], i
        largest = float(max(force[row, i] for row in on))
        limit = float(devices.force[at])
        word = "yield"
        if np.isinf(limit) and devices.stiffness[at]:
            limit = float(
                devices.prestress[at] + devices.stiffness[at] * devices.ultimate[at]
            )
            word = "rupture"
        row: dict[str, Any] = {
            "device": name,
            "force": largest,
            "tie_force": largest / limit if np.isfinite(limit) else None,
            "limit": word,
            "tie_elongation": float(max(found.farthest[row, i, 0] for row in on)),
            "permanent": float(max(found.plastic[row, i, 0] for row in on)),
            "state": STATES[
                max(
                    _rank(int(found.branch[row, i, 0]), float(found.plastic[row, i, 0]))
                    for row in on
                )
            ],
        }
        never_breaks = bool(np.isinf(devices.ultimate[at]))
        row["endless"] = row["state"] == "yielded" and never_breaks
        table.append(row)
    return table


def with_capacity(
    rows: tuple[dict[str, Any], ...],
    system: System,
    motion: Motion,
    amplitude: float,
    omega: float,
) -> tuple[dict[str, Any], ...]:
    """Return rows of `device_rows` with `endless` also for the devices that have
    yielded under the first overturning amplitude.
    """
    devices = system.devices
    assert devices is not None
    if not (np.isfinite(devices.force) & np.isinf(devices.ultimate)).any():
        return rows
    lane = Lane(system, motion.coarsest, omega)
    with np.errstate(all="ignore"):
        found = march(lane, amplitude, peaks=False).restraints
    assert found is not None
    return tuple(
        {**row, "endless": row["endless"] or at_capacity["endless"]}
        for row, at_capacity in zip(rows, device_rows(devices, found), strict=True)
    )


def _rank(branch: int, plastic: float) -> int:
    """Return the index in STATES of a device on this branch with this permanent
    elongation [m].
    """
    return 2 if branch == BROKEN else int(branch == YIELDING or plastic > 0.0)


def columns_of(devices: tuple[dict[str, Any], ...]) -> dict[str, Any]:
    """Return the columns of `rocking check` from the rows of `device_rows`: the largest
    of each number, and the worst state.
    """
    keys = ("tie_force", "tie_elongation", "permanent")
    most = {
        key: max((x for one in devices if (x := one[key]) is not None), default=None)
        for key in keys
    }
    return {
        **most,
        "tie_state": max((one["state"] for one in devices), key=STATES.index),
    }
