"""Files that are written: whole or not at all, under a name that was free or that the
user gives up.

A file is written under another name in the same folder, created exclusively, and put in
place when it is complete.
"""

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from .errors import OutputError, UsageError

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFLNK: "a link",
}


def followed(path: Path) -> Path:
    """The file that a path leads to: a link stays, and the file that it names is
    replaced.
    """
    return (
        Path(os.path.realpath(path))
        if os.path.islink(path) and os.path.exists(path)
        else path
    )


def kind_of(path: Path) -> str:
    """The kind of thing under a path, such as "a folder"; empty for a regular file or a
    free name. Raises OSError.
    """
    try:
        mode = os.lstat(path).st_mode
    except FileNotFoundError:
        return ""
    return (
        ""
        if stat.S_ISREG(mode)
        else _KINDS.get(stat.S_IFMT(mode), "not a regular file")
    )


def check_target(path: Path, overwrite: bool, suffixes: tuple[str, ...] = ()) -> None:
    """Refuse, before any work is done, an output that cannot or must not be written, or
    has none of the suffixes. Raises UsageError.
    """
    if str(path) in ("-", ".", ""):
        raise UsageError(
            f"{str(path)!r} is not the name of a file; this output cannot be written to"
            " standard output"
        )
    if suffixes and path.suffix.lower() not in suffixes:
        *some, last = suffixes
        raise UsageError(
            f"{path}: expected a name that ends in"
            f" {', '.join(some)}{' or ' if some else ''}{last}"
        )
    target = followed(path)
    try:
        if _is_a_stream(path):
            raise UsageError(
                f"{path}: is a standard stream of this call; expected the name of a"
                " file"
            )
        if not target.parent.is_dir():
            raise UsageError(f"{path}: the folder {target.parent} does not exist")
        if kind := kind_of(target):
            raise UsageError(
                f"{path}: is"
                f" {kind}{' that leads nowhere' if os.path.islink(path) else ''};"
                " expected the name of a file"
            )
        # Windows says what a folder allows only when a file is made in it. A name that
        # is too long is refused here too.
        trial = _partial(target)
        open(trial, "xb").close()
        trial.unlink()
        if sys.platform == "win32" and target.exists():
            # there a file that is read-only, or open elsewhere, cannot be replaced
            open(target, "r+b").close()
    except OSError as error:
        raise UsageError(
            f"{path}: cannot be written: {error.strerror or error}"
        ) from None
    if os.path.lexists(target) and not overwrite:
        raise UsageError(f"{path}: exists; use `overwrite` to replace it")


@contextmanager
def published(
    path: Path, overwrite: bool, partial: Path | None = None
) -> Iterator[BinaryIO]:
    """Context of a new file to write to, which takes its name when the block ends, and
    is removed when the block fails. partial: its name until then; a file of this name
    was left by a kill, and is removed. Without overwrite no file is replaced, not even
    one that has appeared meanwhile. Raises OutputError.
    """
    target = followed(path)
    try:
        if partial is None:
            partial = _partial(target)
        else:
            partial.unlink(missing_ok=True)
        with open(partial, "x+b") as file:
            try:
                yield file
                file.flush()
                os.fsync(file.fileno())
                file.close()
                put_in_place(partial, target, overwrite)
            except BaseException:
                # after a failed write `close` tries it again and fails again
                with suppress(OSError):
                    file.close()
                with suppress(OSError):
                    partial.unlink()
                raise
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written: {error.strerror or error}"
        ) from None


def put_in_place(partial: Path, target: Path, overwrite: bool) -> None:
    """Give a complete file its final name. Raises OutputError if the name is taken and
    `overwrite` is false, and OSError if the file system refuses.
    """
    if not overwrite:
        try:
            # A link fails where the name is taken; a rename would replace the file.
            os.link(partial, target)
        except FileExistsError:
            raise OutputError(
                f"{target}: has appeared meanwhile; use `overwrite` to replace it"
            ) from None
        except OSError:
            # A file system without links: an empty file reserves the name first.
            try:
                open(target, "xb").close()
            except FileExistsError:
                raise OutputError(
                    f"{target}: has appeared meanwhile; use `overwrite` to replace it"
                ) from None
            overwrite = True
        else:
            os.unlink(partial)
    if overwrite:
        os.replace(partial, target)
    with suppress(OSError):  # not every system lets a folder be opened
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _partial(target: Path) -> Path:
    """A name for the partial file of a target that nobody else has."""
    return target.with_name(f"{target.name}.{os.urandom(4).hex()}.part")


def _is_a_stream(path: Path) -> bool:
    """True if a path is standard output or standard error, such as /dev/stdout."""
    for descriptor in (1, 2):
        with suppress(OSError):
            if os.path.samestat(os.stat(path), os.fstat(descriptor)):
                return True
    return False
