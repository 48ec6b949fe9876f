"""Where an arch hinges: the admissible four-hinge mechanism of least uplift acceleration (the kinematic theorem).

With n voussoirs every choice of four of the n + 1 joints is tried. A continuous arch starts from the best of a coarse set
of joints and is refined until the gradient vanishes along every hinge that is free to move.
"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np

from .fourbar import FACES, Rates, Ring, rates

Hinges = tuple[float, float, float, float]

_COARSE = 36  # joints from which the refinement starts; a basin is several of them wide
_LATTICE = np.array(list(product((-1.0, -0.5, 0.0, 0.5, 1.0), repeat=4)))
_STEP = 1e-30  # of the complex-step derivative, which is exact: nothing is subtracted


def search_joints(ring: Ring, joints: np.ndarray) -> tuple[Hinges, float] | None:
    """Best mechanism with hinges on these joints [rad]: (hinges, lambda), or None if none is admissible.

    Exhaustive: for each pair (A, B) all pairs (C, D) at once. lambda <= 0 means that the arch does not stand. Two hinges on
    one joint are a joint that opens over its whole depth, which is no four-bar linkage but may govern short thick arches.
    """
    count = joints.size
    inner, outer = np.array(ring.point(joints, FACES[0])), np.array(ring.point(joints, FACES[1]))
    upto = ring.sector(0.0, joints)
    best: tuple[float, tuple[int, int, int, int]] | None = None
    for a in range(count):
        for b in range(a, count):
            c, d = np.arange(b, count)[:, None], np.arange(b, count)[None, :]
            links = [(upto.mass[j] - upto.mass[i], upto.x[j] - upto.x[i], upto.z[j] - upto.z[i]) for i, j in ((a, b), (b, c), (c, d))]
            with np.errstate(all="ignore"):
                found = rates((inner[:, a], outer[:, b], inner[:, c], outer[:, d]), links)
                uplift = np.where((d >= c) & found.admissible & (found.push > 0.0), found.lift / found.push, np.inf)
            at = int(np.argmin(uplift))
            least = float(uplift.flat[at])
            if np.isfinite(least) and (best is None or least < best[0]):
                i, j = divmod(at, uplift.shape[1])
                best = least, (a, b, b + i, b + j)
    if best is None:
        return None
    s = joints[list(best[1])]
    return (float(s[0]), float(s[1]), float(s[2]), float(s[3])), best[0]


def search_continuous(ring: Ring) -> tuple[Hinges, float] | None:
    """Best mechanism of a continuous arch, hinge angles to 1e-10 rad: (hinges, lambda), or None if none is admissible.

    Short thick arches have no least mechanism: the hinges run together, and that counts as none.
    """
    start = search_joints(ring, np.linspace(0.0, ring.angle, _COARSE + 1))
    if start is None:
        return None
    s, least = np.array(start[0]), start[1]
    width = ring.angle / _COARSE
    while width > 1e-7 * ring.angle:  # pattern search on a lattice that follows its best point and shrinks around it
        tried = np.clip(s + width * _LATTICE, 0.0, ring.angle)
        values = _uplifts(ring, tried)
        at = int(np.argmin(values))
        if values[at] < least:
            s, least = tried[at], float(values[at])
        else:
            width *= 0.5
    if np.min(np.diff(s)) < 1e-3 * ring.angle:
        return None
    rough = s
    for _ in range(30):
        slope = _gradient(ring, s)
        free = ~(((s <= 0.0) & (slope > 0.0)) | ((s >= ring.angle) & (slope < 0.0)))
        move = np.zeros(4)
        move[free] = -np.linalg.lstsq(_curvature(ring, s)[np.ix_(free, free)], slope[free], rcond=None)[0]
        if np.max(np.abs(move)) > 1e-3 * ring.angle:  # no minimum inside: it lies on the edge of what is admissible
            break
        following = np.clip(s + move, 0.0, ring.angle)
        done = float(np.max(np.abs(following - s))) < 1e-12
        s = following
        if done:
            break
    polished = float(_uplifts(ring, s[None, :])[0])
    if polished <= least + 1e-15:
        return (float(s[0]), float(s[1]), float(s[2]), float(s[3])), polished
    return (float(rough[0]), float(rough[1]), float(rough[2]), float(rough[3])), least


def _uplifts(ring: Ring, s: np.ndarray) -> np.ndarray:
    """lambda of many mechanisms, (count, 4) angles; infinite where not admissible."""
    ordered = np.all(np.diff(s, axis=1) > 0.0, axis=1)
    with np.errstate(all="ignore"):
        found = _rates(ring, s.T)
        return np.where(ordered & found.admissible & (found.push > 0.0), found.lift / found.push, np.inf)


def _rates(ring: Ring, s: np.ndarray) -> Rates:
    links = [ring.sector(a, b) for a, b in pairwise(s)]
    points = [ring.point(x, face) for x, face in zip(s, FACES, strict=True)]
    return rates(points, [m[:3] for m in links])


def uplift_at(ring: Ring, s: np.ndarray) -> complex:
    """lambda of the mechanism with hinges at (complex) angles s, without a look at whether it is admissible."""
    found = _rates(ring, s)
    return complex(found.lift / found.push)


def _gradient(ring: Ring, s: np.ndarray) -> np.ndarray:
    return np.array([uplift_at(ring, s + 1j * _STEP * unit).imag / _STEP for unit in np.eye(4)])


def _curvature(ring: Ring, s: np.ndarray, step: float = 1e-5) -> np.ndarray:
    rows = [(_gradient(ring, s + step * unit) - _gradient(ring, s - step * unit)) / (2.0 * step) for unit in np.eye(4)]
    return 0.5 * (np.array(rows) + np.array(rows).T)
