"""The same cells by general-purpose integrators: heyoka (Taylor, compiled) and SciPy,
one process a core.

Each integrates through the pulse with the impact as a terminal event and closes the
motion after it by the paper's Eq. 2.7 or by energy; nothing of the engine is used.
"""

import math
import time
from multiprocessing import get_context

import numpy as np

TURN = 2.0 * math.pi


class Cell:
    """Contact rules and the fate after the pulse, for one cell under one sine cycle."""

    def __init__(self, amplitude, omega, eta, alpha):
        self.a, self.w, self.eta, self.alpha = amplitude, omega, eta, alpha
        self.lift = 1.0 if alpha is None else math.tan(alpha) / alpha  # A at uplift
        self.peak, self.bounced = 0.0, False

    def uplift(self, time):
        """(time, side) of the next uplift at or after `time`, None if there is none."""
        if self.a <= self.lift:
            return None
        psi = math.asin(self.lift / self.a)
        for start, stop, side in (
            (psi, math.pi - psi, -1.0),
            (math.pi + psi, TURN - psi, 1.0),
        ):
            if time * self.w < stop:
                return max(time, start / self.w), side
        return None

    def end(self, y, v):
        """(outcome, theta/alpha): 2 rocked, 3 and 4 overturned; y in units of alpha."""
        falls = 4 if self.bounced else 3
        if self.alpha is None:
            if y - 1.0 + v > 0.0:
                return falls, math.nan
            level, barrier = v * v - (1.0 - y) ** 2 + 1.0, 1.0

            def crest(k):
                return 1.0 - math.sqrt(max(0.0, 1.0 - k))

        else:
            rest = math.cos(self.alpha)
            level, barrier = (
                0.5 * (v * self.alpha) ** 2 + math.cos(self.alpha * (1.0 - y)) - rest,
                1.0 - rest,
            )
            if (y > 1.0 and (v >= 0.0 or level < barrier)) or (
                y <= 1.0 and v > 0.0 and level > barrier
            ):
                return falls, math.nan

            def crest(k):
                return 1.0 - math.acos(min(1.0, rest + k)) / self.alpha

        rebound = self.eta**2 * level
        if rebound > barrier:
            return 4, math.nan
        return 2, max(self.peak, crest(rebound), crest(level) if v > 0.0 else y)


def heyoka_cells(cells, eta, alpha, tol):
    """(outcome, theta ratio) of each (A, Omega), in one process."""
    import heyoka as hy

    y, v = hy.make_vars("y", "v")
    side, a, w = hy.par[0], hy.par[1], hy.par[2]
    push = side * a * hy.sin(w * hy.time)
    if alpha is None:
        force = y - 1.0 - push
    else:
        z = alpha * (1.0 - y)
        force = (-hy.sin(z) - alpha * push * hy.cos(z)) / alpha
    now = [None]

    def impact(ta, d_sgn):
        cell = now[0]
        cell.bounced = True
        speed = -cell.eta * ta.state[1]
        drive = abs(cell.a * math.sin(cell.w * ta.time)) / cell.lift
        ta.pars[0] *= -1.0
        ta.state[0], ta.state[1] = 0.0, speed
        return not (speed < 1e-9 and drive < 1.0)

    def crest(ta, time, d_sgn):
        ta.update_d_output(time)
        now[0].peak = max(now[0].peak, ta.d_output[0])

    down = hy.event_direction.negative
    limit = 1e3 if alpha is None else 0.5 * math.pi / alpha  # on its side
    ta = hy.taylor_adaptive(
        [(y, v), (v, force)],
        [0.0, 0.0],
        tol=tol,
        pars=[1.0, 1.0, 1.0],
        t_events=[
            hy.t_event(y, direction=down, callback=impact),
            hy.t_event(y - limit, direction=hy.event_direction.positive),
        ],
        nt_events=[hy.nt_event(v, callback=crest, direction=down)],
    )
    found = np.empty((len(cells), 2))
    for i, (amplitude, omega) in enumerate(cells):
        cell = now[0] = Cell(amplitude, omega, eta, alpha)
        start = cell.uplift(0.0)
        found[i] = (1, 0.0) if start is None else (2, cell.peak)
        while start is not None:
            begin, ta.pars[0] = start
            # At uplift y has a triple root, which event detection takes for an impact:
            # begin a little later, on its series.
            late = 1e-4 / (1.0 + omega)
            rate = (
                omega * math.sqrt(max(0.0, (amplitude / cell.lift) ** 2 - 1.0))
                if abs(math.sin(omega * begin)) * amplitude < cell.lift * (1 + 1e-9)
                else 0.0
            )
            jump = amplitude / cell.lift * abs(math.sin(omega * begin)) - 1.0
            unit = 1.0 if alpha is None else math.sin(alpha) / alpha
            ta.state[0] = unit * (0.5 * jump * late**2 + rate * late**3 / 6.0)
            ta.state[1] = unit * (jump * late + 0.5 * rate * late**2)
            ta.time, ta.pars[1], ta.pars[2] = begin + late, amplitude, omega
            ta.reset_cooldowns()
            outcome = ta.propagate_until(TURN / omega)[0]
            if outcome == hy.taylor_outcome.time_limit:
                found[i] = cell.end(ta.state[0], ta.state[1])
                break
            if ta.state[0] > 0.9 * limit:
                found[i] = (4 if cell.bounced else 3), math.nan
                break
            start = cell.uplift(ta.time)
            found[i] = 2, cell.peak
    return found


def scipy_cells(cells, eta, alpha, tol, method="DOP853"):
    """The same by SciPy's solve_ivp with its own event detection."""
    from scipy.integrate import solve_ivp

    def ground(t, z, *args):
        return z[0]

    def turn(t, z, *args):
        return z[1]

    def fallen(t, z, *args):
        return z[0] - limit

    limit = 1e3 if alpha is None else 0.5 * math.pi / alpha
    ground.terminal, ground.direction, turn.direction, fallen.terminal = (
        True,
        -1,
        -1,
        True,
    )
    found = np.empty((len(cells), 2))
    for i, (amplitude, omega) in enumerate(cells):
        cell = Cell(amplitude, omega, eta, alpha)

        def rate(t, z, side, a=amplitude, w=omega):
            push = side * a * math.sin(w * t)
            if alpha is None:
                return z[1], z[0] - 1.0 - push
            angle = alpha * (1.0 - z[0])
            return z[1], (-math.sin(angle) - alpha * push * math.cos(angle)) / alpha

        start = cell.uplift(0.0)
        found[i] = (1, 0.0)
        while start is not None:
            now, side = start
            y, v, start = 0.0, 1e-15, None
            while True:
                path = solve_ivp(
                    rate,
                    (now, TURN / omega),
                    (y, v),
                    args=(side,),
                    method=method,
                    rtol=tol,
                    atol=tol,
                    events=(ground, turn, fallen),
                )
                tops = [
                    z[0]
                    for t, z in zip(path.t_events[1], path.y_events[1], strict=True)
                    if t > now
                ]
                cell.peak = max([cell.peak, *tops])
                if path.t_events[2].size:
                    found[i] = (4 if cell.bounced else 3), math.nan
                    break
                if path.status != 1 or path.t[-1] <= now:
                    found[i] = cell.end(path.y[0, -1], path.y[1, -1])
                    break
                now, side, y, v, cell.bounced = (
                    path.t[-1],
                    -side,
                    0.0,
                    -eta * path.y[1, -1],
                    True,
                )
                if v < 1e-9 and amplitude * abs(math.sin(omega * now)) < cell.lift:
                    found[i], start = (2, cell.peak), cell.uplift(now)
                    break
    return found


def on_all_cores(run, cells, *arguments, workers=2):
    """(seconds, results): the cells dealt out to processes, one a core, which have
    compiled what they need before the clock starts.
    """
    with get_context("fork").Pool(workers) as pool:
        parts = pool.starmap(
            _timed,
            [(run, cells[i::workers], *arguments) for i in range(workers)],
            chunksize=1,
        )
    found = np.empty((len(cells), 2))
    for i, (_, part) in enumerate(parts):
        found[i::workers] = part
    return max(seconds for seconds, _ in parts), found


def _timed(run, cells, *arguments):
    run(cells[:4], *arguments)
    start = time.perf_counter()
    found = run(cells, *arguments)
    return time.perf_counter() - start, found
