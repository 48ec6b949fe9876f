"""Motions from a YAML or JSON document, as exact pieces or as points joined by straight
lines. Times are in periods T_g = 2 pi / omega_g and accelerations in a_g; with T_g = 1
s and a_g = 1 m/s2 they are in s and m/s2.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..documents.composition import Value
from ..documents.document import Document
from ..documents.files import named_after
from ..errors import DocumentError, MotionError
from .motion import Harmonic, Motion, Piece
from .polyline import Polyline
from .pulses import MOST_CYCLES, TURN

LARGEST = 1e6  # largest acceleration over a_g, and largest phase
SHORTEST = 1e-9  # periods
_PIECES = "a list of pieces, each with from, to, and constant, slope or sines"
_POINTS = "a list of two or more points [t/T_g, acceleration/a_g], in order of time"


def motion_of(documents: Sequence[Document]) -> Motion:
    """Return the motion of the one document of a text. Raises DocumentError."""
    first, *others = documents
    if others:
        raise DocumentError(
            f"{others[0].place}: a second document; a motion has one document"
        )
    return build_motion(first)


def build_motion(document: Document) -> Motion:
    """Return the motion of a document with `pieces` or `points`, and `name`. Raises
    DocumentError.
    """
    stem = "motion" if document.source.startswith("<") else named_after(document.source)
    name = document.word("name", stem)
    if document.has("pieces") == document.has("points"):
        found = (
            "both pieces and points"
            if document.has("pieces")
            else "neither pieces nor points"
        )
        wanted = "one of them"
        if "kind" in document.values:
            found = f"a structure, of kind {document.values['kind']}"
            wanted = "a motion, with pieces or points"
        raise document.fault(None, found, wanted)
    try:
        motion = (
            Motion(name, _pieces(document))
            if document.has("pieces")
            else _lines(document, name)
        )
    except MotionError as error:
        raise DocumentError(f"{document.place}: {error}") from None
    document.finish()
    if not motion.largest > 0.0:
        raise document.fault(
            None, "a motion that is zero throughout", "a motion with a non-zero value"
        )
    return motion


def _children(document: Document, key: str, wanted: str, least: int) -> list[Value]:
    """Return the items of a list of at least so many items. Raises DocumentError."""
    content = document.values[key].content
    if not isinstance(content, list) or len(content) < least:
        raise document.fault(
            key,
            (
                f"{len(content)} entries"
                if isinstance(content, list)
                else str(document.values[key])
            ),
            wanted,
        )
    return content


def _pieces(document: Document) -> tuple[Piece, ...]:
    """Return the pieces of a motion document, in which a period of omega_g lasts 1.
    Raises DocumentError.
    """
    pieces: list[Piece] = []
    for i, value in enumerate(_children(document, "pieces", _PIECES, 1), 1):
        part = document.part("pieces", value)
        start = part.quantity(
            "from",
            "number",
            least=0.0,
            most=MOST_CYCLES,
            where=f"a time in periods from 0 to {MOST_CYCLES:g}",
        )
        where = f"a time in periods after {start:g}, up to {MOST_CYCLES:g}"
        stop = part.quantity(
            "to", "number", least=start + SHORTEST, most=MOST_CYCLES, where=where
        )
        before = pieces[-1].stop / TURN if pieces else 0.0
        if abs(start - before) > 1e-9 * max(1.0, before):
            what = "overlaps the one before" if start < before else "leaves a gap"
            raise part.fault(
                "from",
                f"{start:g}, where piece {i} {what}",
                f"{before:g}, the end of the piece before" if i > 1 else "0",
            )
        steepest = LARGEST / (stop - start)
        constant, slope = (
            part.quantity(key, "number", least=-most, most=most, default=0.0)
            for key, most in (("constant", LARGEST), ("slope", steepest))
        )
        sines = (
            _children(part, "sines", "a list of sines", 1) if part.has("sines") else []
        )
        harmonics = tuple(_sine(part, child, stop - start) for child in sines)
        if not (harmonics or part.has("constant") or part.has("slope")):
            raise part.fault(
                None,
                "a piece without constant, slope or sines",
                "one of them (constant: 0 for a pause)",
            )
        part.finish()
        pieces.append(
            Piece(
                pieces[-1].stop if pieces else 0.0,
                TURN * stop,
                harmonics,
                constant,
                slope / TURN,
            )
        )
    return tuple(pieces)


def _sine(part: Document, value: Value, length: float) -> Harmonic:
    """Return a sinusoid of a piece. Raises DocumentError."""
    sine = part.part("sines", value)
    amplitude = sine.quantity("amplitude", "number", least=-LARGEST, most=LARGEST)
    highest = MOST_CYCLES / length
    where = (
        f"a positive multiple of omega_g, up to {highest:g} for {MOST_CYCLES:g} cycles"
        " in this piece"
    )
    frequency = sine.quantity(
        "frequency", "number", above=0.0, most=highest, where=where, default=1.0
    )
    phase = sine.quantity("phase", "angle", least=-LARGEST, most=LARGEST, default=0.0)
    sine.finish()
    return Harmonic(amplitude, frequency, phase)


def _lines(document: Document, name: str) -> Motion:
    """Return the motion of straight lines through the points of a document. Raises
    DocumentError.
    """
    points = [
        document.pair("points", value, "number", "point", _POINTS)
        for value in _children(document, "points", _POINTS, 2)
    ]
    if points[0][0] != 0.0:
        raise document.fault(
            "points", f"a first point at {points[0][0]:g}", "a motion that begins at 0"
        )
    for (t0, s0), (t1, s1) in pairwise(points):
        if not (t1 >= t0 + SHORTEST and t1 <= MOST_CYCLES):
            raise document.fault(
                "points",
                f"a point at {t1:g} after one at {t0:g}",
                f"rising times, up to {MOST_CYCLES:g} cycles",
            )
        if max(abs(s0), abs(s1)) > LARGEST:
            raise document.fault(
                "points",
                f"an acceleration of {s0 if abs(s0) > abs(s1) else s1:g}",
                f"one up to {LARGEST:g} a_g",
            )
    time, level = np.array(points).T
    return Polyline(
        name,
        TURN * time[:-1],
        TURN * time[1:],
        level[:-1],
        np.diff(level) / (TURN * np.diff(time)),
    )
