"""What can go wrong, and the exit code that each kind of failure has at the shell."""

from __future__ import annotations


class RockingError(Exception):
    """Base of every error that is told to the user in one sentence."""

    exit_code = 1


class UsageError(RockingError):
    """The call itself is wrong: an axis that cannot be read, a grid too large."""

    exit_code = 2


class MotionError(UsageError):
    """A motion that cannot be built."""


class DocumentError(RockingError):
    """A structure document that cannot be read, or a structure that the theory does not cover."""

    exit_code = 3


class StructureError(RockingError, ValueError):
    """Numbers that make no rocking structure; of a document this becomes a DocumentError, which tells the place too."""

    exit_code = 3


class OutputError(RockingError):
    """A file that cannot be written or read."""


class Interrupted(RockingError):
    """Stopped by the user; what was done is kept."""

    exit_code = 130
