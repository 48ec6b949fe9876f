"""Tables of what is refused, as tests."""

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest


def refuses(
    call: Callable[[Any], Any],
    error: type[Exception],
    rows: Iterable[tuple[Any, str]],
    file: str = "",
    literal: bool = False,
) -> Callable[..., None]:
    """A test: for each row (given, words), call(given) raises the error, and the words
    match in its one line.

    file: the name of a file that is to hold what is given, a text or bytes; `call`
    takes its path then; literal: words are no pattern.
    """

    @pytest.mark.parametrize(("given", "words"), rows)
    def test(given: Any, words: str, tmp_path: Path) -> None:
        if file:
            (tmp_path / file).write_bytes(
                given if isinstance(given, bytes) else given.encode()
            )
            given = tmp_path / file
        with pytest.raises(
            error, match=re.escape(words) if literal else words
        ) as raised:
            call(given)
        assert "\n" not in str(raised.value)

    return test
