"""The kinds of failure, each with its exit code at the shell."""

from collections.abc import Iterable, Mapping


class RockingError(Exception):
    """Base of every error that is told to the user in one sentence."""

    exit_code = 1


class UsageError(RockingError):
    """The call itself is wrong: an axis that cannot be read, a grid too large."""

    exit_code = 2


class ArgumentError(UsageError, TypeError, ValueError):
    """An argument of a public function of another type or value than the function
    takes.
    """


class MotionError(UsageError):
    """A motion that cannot be built."""


class NoComponent(UsageError):
    """A record file without the component that is asked for; in a directory it is left
    out.
    """


class DocumentError(RockingError):
    """A structure document that cannot be read, or a structure that the theory does not
    cover.
    """

    exit_code = 3


class NoAcceleration(DocumentError):
    """A file in a record format that holds something else, such as velocities or
    spectra; in a directory it is left out.
    """


class StructureError(RockingError, ValueError):
    """Numbers that do not make a rocking structure; from a document this becomes a
    DocumentError, which names the place too.
    """

    exit_code = 3


class OutputError(RockingError):
    """A file that cannot be written or read."""


class Interrupted(RockingError):
    """Stopped by the user; finished work is kept."""

    exit_code = 130


def counted(number: int, thing: str) -> str:
    """Return a number with its thing, such as `1 level` or `2 levels`."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def did_you_mean(
    word: str, known: Iterable[str], meant: Mapping[str, str] | None = None
) -> str:
    """Return ` (did you mean 'x'?)` for an unknown word, or an empty text. x is the
    word that `meant` gives for it, else the same word in other letters (a_g for a-g)
    and the known words that begin with it, else a known word of similar spelling.
    """
    from difflib import get_close_matches

    def plain(text: str) -> str:
        return text.casefold().replace("_", "-")

    words = {plain(other): other for other in known}
    mine = plain(word)
    if meant and plain(meant.get(mine, "")) in words:
        found = [plain(meant[mine])]
    else:
        found = [
            other
            for other in words
            if other == mine or (len(mine) > 2 and other.startswith(mine))
        ][:3]
        found = found or get_close_matches(mine, words, n=1)
    return (
        f" (did you mean {' or '.join(repr(words[other]) for other in found)}?)"
        if found
        else ""
    )
