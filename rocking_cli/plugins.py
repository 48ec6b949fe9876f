"""Installed packages: those that a part of the program needs, the entry points of
others, and the errors of a package as one sentence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING

from .errors import ArgumentError, OutputError, RockingError, UsageError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


def require(needing: str, *packages: str, instead: str = "") -> None:
    """Import packages that are not always installed, before the work that needs them.

    needing: the words before their names, such as "figures need"; instead: what the
    message adds. Raises OutputError, which says how to install those that are missing,
    and UsageError where a setting keeps one from starting, such as MPLBACKEND.
    """
    missing = []
    for package in packages:
        try:
            import_module(package)
        except ImportError:
            missing.append(package)
        except ValueError as error:
            first = str(error).partition(";")[0]
            where = " (the variable MPLBACKEND)" if "backend" in first else ""
            raise UsageError(f"{package} cannot start: {first}{where}") from None
    if missing:
        names, words = " and ".join(missing), " ".join(missing)
        raise OutputError(f"{needing} {names}: pip install {words}{instead}")


def installed(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group by name. Raises UsageError if a package has a
    list of entry points that cannot be read, and if two packages add one name.
    """
    from importlib.metadata import distributions, entry_points

    try:
        listed = entry_points(group=group)
    except Exception as error:
        for one in distributions():
            try:
                _ = one.entry_points
            except Exception:
                name = one.metadata["Name"]
                raise UsageError(
                    f"the package {name}: its entry_points.txt cannot be read; expected"
                    " lines such as name = module:attribute"
                ) from error
        raise
    found: dict[str, EntryPoint] = {}
    for entry in listed:
        other = found.setdefault(entry.name, entry)
        if other.value != entry.value:
            raise UsageError(
                f"{_package(other)} and {_package(entry)} both add {entry.name} to"
                f" {group}; expected only one of them"
            )
    return found


def _package(entry: EntryPoint) -> str:
    """Return the package of an entry point in words."""
    return f"the package {entry.dist.name}" if entry.dist else entry.value


@contextmanager
def blamed(
    entry: EntryPoint, error_of: Callable[[str], RockingError]
) -> Iterator[None]:
    """Turn whatever a package's code raises into `error_of` of a sentence that names
    the package; Ctrl-C and what a user did wrong pass unchanged.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        # an argument that does not fit is a fault of the package that gives it
        if isinstance(error, RockingError) and not isinstance(error, ArgumentError):
            raise
        raise error_of(
            f"{entry.name}, which {_package(entry)} adds and which cannot be used:"
            f" {_in_one_line(error)}"
        ) from error


def _in_one_line(error: BaseException) -> str:
    """Return the name of an error and what it says, in one line."""
    try:
        said = " ".join(str(error).split())
    except Exception:  # of a class that cannot say what it means
        said = ""
    return f"{type(error).__name__}: {said}" if said else type(error).__name__
