"""Files that end inside a number, as after a transfer that broke off."""

import re

_WRITTEN = re.compile(rb"[-+]?\d*\.?(\d*)[eEdD]([-+]?\d+)")
_BEGUN = re.compile(rb"[-+]?\d*\.?\d*(?:[eEdD][-+]?\d*)?")
_FEWEST = 8  # numbers that show how a file writes them


def cut_number(raw: bytes) -> str | None:
    """Return the last number of a file if it has other digits than those before it,
    which all have an exponent and the same number of digits; otherwise None.
    """
    tokens = raw[-1000:].split()[1:]  # the first one may begin before them
    if len(tokens) <= _FEWEST:
        return None
    *before, last = tokens
    if last == b"0" and raw.endswith(b"\n"):  # a whole number
        return None
    forms = {_form(token) for token in before}
    if (
        len(forms) > 1
        or None in forms
        or _form(last) in forms
        or not _BEGUN.fullmatch(last)
    ):
        return None
    return last.decode("ascii")


def _form(token: bytes) -> tuple[int, int] | None:
    """Return the numbers of decimals and of characters of the exponent of a number;
    None without an exponent.
    """
    found = _WRITTEN.fullmatch(token)
    return None if found is None else (len(found[1]), len(found[2]))
