"""The kinds of failure, each with its exit code at the shell."""

from collections.abc import Iterable, Mapping


class RockingError(Exception):
    """Base of every error that rocking tells in one sentence.

    Catch it to catch all of them. Its subclasses say what is wrong: `UsageError` (the
    call), `DocumentError` (a file), `OutputError` (an output), `Interrupted` (Ctrl-C).

    Attributes
    ----------
    exit_code: what a command returns to the shell for this error

    Examples
    --------
    >>> try:
    ...     parse_grid("A=2")
    ... except RockingError as error:
    ...     print(error.exit_code, str(error)[:25])
    2 `grid`: found A; expected
    """

    exit_code = 1


class UsageError(RockingError):
    """The call itself is wrong: an axis that cannot be read, a grid too large.

    Exit code 2. `ArgumentError` and `MotionError` are special cases.

    Examples
    --------
    >>> Method("quadratic")
    Traceback (most recent call last):
        ...
    rocking_cli.errors.UsageError: unknown model 'quadratic'; expected linear, nonlinear
    """

    exit_code = 2


class ArgumentError(UsageError, TypeError, ValueError):
    """An argument of another type or value than a function takes.

    Every function that `import rocking_cli` offers raises it, also for an argument too
    many or too few. It is a `UsageError`, and a TypeError and ValueError of Python.
    Exit code 2. The package catches it where it can name the document too; another
    ValueError is a fault of the package, and is caught nowhere.

    Examples
    --------
    >>> parse_grid(3)
    Traceback (most recent call last):
        ...
    rocking_cli.errors.ArgumentError: parse_grid: `text`: found 3; expected a text
    """


class MotionError(UsageError):
    """A motion that cannot be built. It is a `UsageError`; exit code 2.

    Examples
    --------
    >>> sine(cycles=0.3)
    Traceback (most recent call last):
        ...
    rocking_cli.errors.MotionError: sine pulse: cycles is 0.3; expected a positive
    multiple of 0.5 up to 100000
    """


class NoComponent(UsageError):
    """A record file without the component that is asked for; in a directory it is left
    out.
    """


class DocumentError(RockingError):
    """A document or a data file that cannot be read, or a structure that the theory
    does not cover.

    The message names file, line, column and key, what was found and what is accepted.
    Exit code 3.

    Examples
    --------
    >>> build_structure(parse_documents("{kind: block, width: 0.5, hight: 2}")[0])
    Traceback (most recent call last):
        ...
    rocking_cli.errors.DocumentError: <text>:1:27: unknown key 'hight' (did you mean
    'height'?)
    """

    exit_code = 3


class NoAcceleration(DocumentError):
    """A file in a record format that holds something else, such as velocities or
    spectra; in a directory it is left out.
    """


class StructureError(RockingError, ValueError):
    """Numbers that do not make a rocking structure. It is a ValueError of Python too.

    From a document it becomes a `DocumentError`, which names the place too. Exit code
    3.

    Examples
    --------
    >>> dimensionless_oscillator(eta=1.2)
    Traceback (most recent call last):
        ...
    rocking_cli.errors.StructureError: eta is 1.2; expected a number from 0 to 1
    """

    exit_code = 3


class OutputError(RockingError):
    """A file that is damaged or cannot be written, or a worker process that died.

    Exit code 1. A file that is not there is a `UsageError`.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("d.h5").write_text("no spectrum")
    >>> SpectraFile("d.h5")
    Traceback (most recent call last):
        ...
    rocking_cli.errors.OutputError: d.h5: is not an HDF5 file, or is damaged
    """


class Interrupted(RockingError):
    """The user stopped a sweep (Ctrl-C); finished work is kept. Exit code 130.

    `write_spectrum(..., resume=True)` goes on with the partial file.

    Examples
    --------
    >>> Interrupted("interrupted; 3 of 8 chunks are kept").exit_code
    130
    """

    exit_code = 130


def counted(number: int, thing: str) -> str:
    """Return a number with its thing, such as `1 level` or `2 levels`."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


_NEAR = 0.65  # share of common letters from which a word is similar


def did_you_mean(
    word: str, known: Iterable[str], meant: Mapping[str, str] | None = None
) -> str:
    """Return ` (did you mean 'x'?)` for an unknown word, or an empty text. x is the
    word that `meant` gives for it, else the same word in other letters (a_g for a-g)
    and the known words that begin with it or end with -x, else a known word of similar
    spelling.
    """
    from difflib import get_close_matches

    def plain(text: str) -> str:
        return text.casefold().replace("_", "-").lstrip("-")  # dashes are no letters

    words = {plain(other): other for other in known}
    mine = plain(word)
    instead = plain({plain(k): x for k, x in (meant or {}).items()}.get(mine, ""))
    if instead in words:
        found = [instead]
    else:
        found = [
            other
            for other in words
            if other == mine
            or (
                len(mine) > 2 and (other.startswith(mine) or other.endswith(f"-{mine}"))
            )
        ][:3]
        found = found or get_close_matches(mine, words, n=1, cutoff=_NEAR)
    return (
        f" (did you mean {' or '.join(repr(words[other]) for other in found)}?)"
        if found
        else ""
    )
