"""The response in time of a body with ties or a tendon: it listens to the march of one
such body (`dynamics.tied`).
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..dynamics.batch import Batch
from ..dynamics.equations.taylor import TaylorSeries
from ..dynamics.lanes import Lanes
from ..dynamics.outcome import LOST, Outcome
from ..dynamics.system import System
from ..dynamics.tied.devices import BROKEN, YIELDING, Branch
from ..dynamics.tied.tied_lanes import TiedLanes
from ..dynamics.tied.tied_march import TiedMarch
from ..motions.motion import Motion
from .arcs import INVISIBLE, DeviceForces, History, Writer

STATES = ("elastic", "yielded", "broken")  # of ties and tendons


class _TiedWriter(Writer):
    """Writes down the march of one body with ties or a tendon, up to the phase `until`
    [rad].
    """

    visible = INVISIBLE
    march: TiedMarch  # the one that it listens to

    def __init__(self, system: System, until: float, omega: float) -> None:
        super().__init__(system.equation, omega)
        assert system.devices is not None
        self.until, self.devices = until, system.devices
        prestress = system.devices.prestress
        self.laws = [
            (0.0, 0, prestress.max(axis=0), 0.0 * prestress[0], prestress.copy())
        ]

    def tau(self, lanes: Lanes) -> float:
        """Return the time of the first lane, as tau of the history."""
        segments = self.march.segments
        k = min(int(lanes.segment[0]), len(self.march.segments) - 1)
        return (float(segments.start[k]) + float(lanes.phase[0])) / self.omega

    def keep(
        self, lanes: TiedLanes, arc: TaylorSeries, reach: float, now: Branch
    ) -> None:
        """Keep an arc of the first lane that begins now and lasts `reach` [tau of the
        side], and the force law of the devices on it.
        """
        self.laws.append(
            (
                self.tau(lanes),
                int(self.devices.row(lanes.side)[0]),
                now.fixed[:, 0],
                now.rate[:, 0],
                self._held(lanes),
            )
        )
        pace = self.omega / float(lanes.omega[0])
        self.add_arc(
            self.tau(lanes),
            reach,
            float(lanes.side[0]),
            pace,
            float(arc.unit[0]),
            arc.terms[:, 0].tolist(),
        )

    def note(
        self,
        lanes: Lanes,
        event: str,
        y: float,
        v: float,
        device: str = "",
        later: float = 0.0,
    ) -> None:
        """Keep an event of the first lane, at the time of the lane
        plus `later` [tau].
        """
        self.add_event(
            self.tau(lanes) + later,
            event,
            float(lanes.side[0]),
            y,
            v,
            self.omega / float(lanes.omega[0]),
            device,
        )

    def rest(self, before: TiedLanes, after: TiedLanes, bounces: float) -> None:
        """Keep a rest, which begins after bounces of a duration `bounces` [tau of the
        side], and the uplift after the rest.
        """
        lasts = bounces * float(before.omega[0]) / self.omega
        held, begins = self._held(before), self.tau(before) + lasts
        begins = min(begins, self.tau(after))
        self.laws.append((begins, 0, held.max(axis=0), 0.0 * held[0], held))
        lifts = after.segment[0] < len(self.march.segments)
        if not lifts or self.tau(after) > self.tau(before) + lasts:
            self.note(before, "rest", 0.0, 0.0, later=lasts)
        if lifts:
            self.note(after, "uplift", 0.0, 0.0)

    def _held(self, lanes: TiedLanes) -> Array:
        """Return the forces [N] with which the devices would hold the first lane at the
        ground against each side, (sides, devices).
        """
        return np.array(
            [
                self.devices.force_at_ground(
                    np.array([row]), lanes.branch[row, :, :1], lanes.plastic[row, :, :1]
                )[:, 0]
                for row in range(len(self.devices.stiffness))
            ]
        )

    def pop_lost_contact(self) -> float | None:
        """Drop the loss of contact, which would end the history before the fall of a
        body that overturns; return its time [tau], None without one.
        """
        lost = min((e.tau for e in self.events if e.event == LOST), default=None)
        self.events = [e for e in self.events if e.event != LOST]
        return lost

    def forces(self) -> DeviceForces:
        """Return the forces of the devices over time."""
        columns = (np.array(x) for x in zip(*self.laws, strict=True))
        start, row, fixed, rate, held = columns
        return DeviceForces(
            self.devices, start, row, fixed.T, rate.T, np.moveaxis(held, 0, -1)
        )


def tied_history(
    system: System,
    motion: Motion,
    amplitude: float,
    omega: float,
    release: float,
    duration: float,
) -> History:
    """Return the history of a body with ties or a tendon; arguments as `history`."""
    recorder = _TiedWriter(system, duration * omega, omega)
    recorder.march = march = _march(system, motion, amplitude, omega, recorder)
    found = march.run(release)
    outcome, rows = Outcome(int(found.outcome[0])), tuple(device_rows(system, march))
    # A body that overturns has overturned whatever its Fz, as a body without ties.
    lost = None if outcome == Outcome.LOST_CONTACT else recorder.pop_lost_contact()
    history = recorder.history(
        recorder.arcs(), duration, outcome, float(found.theta_ratio[0])
    )
    forces = recorder.forces()
    return replace(history, devices=rows, device_forces=forces, lost=lost)


def _march(
    system: System,
    motion: Motion,
    amplitude: float,
    omega: float,
    recorder: _TiedWriter | None = None,
) -> TiedMarch:
    """Return the march of one body."""
    assert system.devices is not None
    a, w = np.array([amplitude]), np.array([omega])
    batch = Batch.of(system, system.segments(motion.coarsest), a, w)
    return TiedMarch(system.devices, batch, recorder)


def device_rows(system: System, march: TiedMarch) -> list[dict[str, Any]]:
    """Return a row for each tie and the tendon of the first cell. device: its name;
    force: its largest force [N]; tie_force: force over its yield, without one over its
    force at rupture [-], None without both; limit: which of these, "yield" or
    "rupture"; tie_elongation, permanent: its largest and its permanent elongation [m];
    state: elastic, yielded or broken; endless: True if it has yielded and no elongation
    breaks it. A tie of both sides acts as two; its row has the larger numbers and the
    worse state.
    """
    devices, found = system.devices, march.found
    assert devices is not None
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
    march = _march(system, motion, amplitude, omega)
    march.run()
    return tuple(
        {**row, "endless": row["endless"] or at_capacity["endless"]}
        for row, at_capacity in zip(rows, device_rows(system, march), strict=True)
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
