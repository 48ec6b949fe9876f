"""Motions and records that a text or a path stands for."""

import os
from collections.abc import Sequence
from pathlib import Path

from ..documents.files import is_document_text
from ..errors import ArgumentError, DocumentError, MotionError
from .given import HasMotion
from .motion import Motion
from .pulses import PULSES, pulse
from .reading import load_records, read_one
from .recording import Recording, with_distinct_labels
from .records import Record


def named_motion(given: str | Path) -> Motion | Recording:
    """Return the motion that a text or a path stands for. Raises as `motion_from`."""
    text = str(given)
    if isinstance(given, str) and is_document_text(given):
        return _of_text(given)
    if isinstance(given, str) and text in PULSES:
        return pulse(text)
    if isinstance(given, str) and _is_a_word(text) and not os.path.exists(text):
        # a pulse of an installed package, or a word that is misspelt
        try:
            return pulse(text)
        except MotionError as error:
            raise MotionError(f"{error}; or the path of a motion") from None
    return read_one(given, {})


def _is_a_word(text: str) -> bool:
    """True for a text that has no part of a path."""
    return text != "-" and not any(mark in text for mark in (".", "/", os.sep))


def _of_text(text: str) -> Motion:
    """Return the motion of the text of one motion document. Raises DocumentError."""
    from ..documents.parsing import parse_documents
    from .motion_document import build_motion

    first, *others = parse_documents(text)
    if others:
        raise DocumentError(
            f"{others[0].place}: a second document; a motion has one document"
        )
    return build_motion(first)


def recordings_from(
    given: str | Path | Sequence[HasMotion | str | Path],
) -> tuple[Recording, ...]:
    """Return the records of what was given, those of a path as `load_records` reads
    them, with distinct labels. Raises UsageError and DocumentError as it does.
    """
    found: list[Recording] = []
    for one in [given] if isinstance(given, str | Path) else given:
        if isinstance(one, str | Path):
            found += load_records(one)
        else:
            found.append(one if isinstance(one, Recording) else _recording_of(one))
    return with_distinct_labels(found)


def _recording_of(given: HasMotion) -> Recording:
    """Return a record as a recording. Raises ArgumentError for anything else."""
    if isinstance(given, Record):
        return Recording(given)
    raise ArgumentError(
        f"found a {type(given).__name__} for a record; expected a Record, a Recording"
        " or a path"
    )
