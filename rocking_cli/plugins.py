"""Installed packages: those that a part of the program needs, the entry points of
others, and the errors of a package as one sentence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING

from .errors import OutputError, RockingError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


def require(needing: str, *packages: str, instead: str = "") -> None:
    """Import packages that are not always installed, before the work that needs them.

    needing: the words before their names, such as "figures need"; instead: what the
    message adds. Raises OutputError, which says how to install those that are missing.
    """
    missing = []
    for package in packages:
        try:
            import_module(package)
        except ImportError:
            missing.append(package)
    if missing:
        names, words = " and ".join(missing), " ".join(missing)
        raise OutputError(f"{needing} {names}: pip install {words}{instead}")


def installed(group: str) -> dict[str, EntryPoint]:
    """The entry points of a group by name."""
    from importlib.metadata import entry_points

    return {entry.name: entry for entry in entry_points(group=group)}


@contextmanager
def blamed(
    entry: EntryPoint, error_of: Callable[[str], RockingError]
) -> Iterator[None]:
    """Turn an error or exit of a package's code into `error_of` of a sentence that
    names the package; RockingErrors pass unchanged.
    """
    try:
        yield
    except RockingError:
        raise
    except (Exception, SystemExit) as error:
        package = f"the package {entry.dist.name}" if entry.dist else entry.value
        raise error_of(
            f"{entry.name}, which {package} adds and which cannot be used:"
            f" {type(error).__name__}: {error}"
        ) from error
