"""Text to YAML nodes with their places; a text above a limit is refused before it costs
time and memory. A document on the command line does without them, and without PyYAML.
"""

import json
import re
from typing import Any

import yaml

from ..errors import DocumentError
from .composition import DEEPEST, LONGEST, MOST_VALUES, Place, place_in, unspaced

_BLANKS = re.compile(r"\s*")
# a quoted text, a comment of YAML, one of JavaScript
_COMMENT = re.compile(
    r'"(?:[^"\\\n]|\\.)*"?|\'[^\'\n]*\'|#[^\n]*|(?<![^\s,{}\[\]:"\'])(//|/\*)'
)


def compose(text: str, source: str, first: int = 0) -> list[yaml.Node]:
    """Return the root node of each document of a text, with its places in the file;
    first: lines before the text. Raises DocumentError.
    """
    begun = text.lstrip()
    if begun.startswith(("{", "//", "/*")):
        _refuse_comment(text, source)
    return (
        _compose_json(text, source)
        if begun.startswith("{")
        else _compose_yaml(text, source, first)
    )


def _refuse_comment(text: str, source: str) -> None:
    """Raise DocumentError for a text of braces with a comment of JavaScript, which
    neither JSON nor YAML has.
    """
    for found in _COMMENT.finditer(text):
        if found[1]:
            place = place_in(text, found.start(1), source)
            wanted = "expected no comment in JSON; write YAML, where # begins one"
            raise DocumentError(
                f"{place}: found a comment that begins with {found[1]}; {wanted}"
            )


class _Unlikely(yaml.MarkedYAMLError):
    """Raised for valid YAML that is too large for a structure document."""


class _Composer(yaml.SafeLoader):
    """PyYAML's composer with limits on depth and number of values; it raises _Unlikely
    beyond them.
    """

    def __init__(self, text: str, source: str, first: int) -> None:
        super().__init__(text)
        self.name, self.line = source, first
        self.values = self.depth = 0

    def compose_document(self) -> Any:
        self.values = 0
        return super().compose_document()

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        self.depth += 1
        if parent is not None and self.depth > DEEPEST + 1:
            raise _Unlikely(problem="nested too deeply", problem_mark=parent.start_mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        self.values += 1
        if node is not None and self.values > MOST_VALUES:
            raise _Unlikely(problem="too many values", problem_mark=node.start_mark)
        return node


def _compose_yaml(text: str, source: str, first: int = 0) -> list[yaml.Node]:
    """Return the root node of each YAML document of a text. Raises DocumentError."""
    if len(text) > LONGEST:
        place = place_in(text, LONGEST, source, first)
        raise DocumentError(
            f"{place}: longer than {LONGEST >> 20} MiB, the limit of a structure"
            " document"
        )
    nodes: list[yaml.Node] = []
    try:
        composer = _Composer(text, source, first)
        while composer.check_node():
            nodes.append(composer.compose_document())
    except (ValueError, OverflowError):  # of chr(): \UFFFFFFFF
        place = Place(source, composer.line + 1, composer.column + 1)
        raise DocumentError(
            f"{place}: not valid YAML: an escape of no character"
        ) from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = (
            Place(source, mark.line + 1, mark.column + 1)
            if mark
            else Place(source, first + 1, 1)
        )
        if isinstance(error, _Unlikely):
            raise DocumentError(
                f"{place}: {error.problem} to be a structure document"
            ) from None
        line = (
            text.splitlines()[mark.line - first - 1 : mark.line - first + 1]
            if mark
            else []
        )
        if hint := next(filter(None, map(unspaced, line)), ""):
            raise DocumentError(f"{place}: not valid YAML: {hint}") from None
        why = error.problem or error.context or ""
        if "'\\t'" in why:
            why = "found a tab; expected blanks at the start of a line"
        raise DocumentError(f"{place}: not valid YAML: {why}") from None
    except yaml.reader.ReaderError as error:
        place = place_in(text, error.position, source, first)
        raise DocumentError(
            f"{place}: not valid YAML: holds the control character"
            f" U+{error.character:04X}"
        ) from None
    return nodes


def _compose_json(text: str, source: str) -> list[yaml.Node]:
    """Return the nodes of JSON objects one after the other: a JSON decoder finds the
    end of each, YAML's composer the places in it.
    """
    nodes: list[yaml.Node] = []
    # numbers stay texts: Python refuses one of more than 4300 digits
    decoder = json.JSONDecoder(parse_int=str, parse_float=str)
    at = _after_blanks(text, 0)
    first = text.count("\n", 0, at)
    while at < len(text):
        try:
            _, end = decoder.raw_decode(text, at)
        except json.JSONDecodeError as error:
            if not nodes:  # a YAML flow mapping also begins with a brace
                return _compose_yaml(text, source)
            raise DocumentError(
                f"{source}:{error.lineno}:{error.colno}: not valid JSON:"
                f" {error.msg.removesuffix(' at')}"
            ) from None
        except RecursionError:
            end = len(text)  # the composer reports the place that is too deep
        nodes += _compose_yaml(text[at:end].replace("\t", " "), source, first)
        after = _after_blanks(text, end)
        first, at = first + text.count("\n", at, after), after
    return nodes


def _after_blanks(text: str, at: int) -> int:
    """Return the place of the next character that is no blank."""
    blanks = _BLANKS.match(text, at)
    return blanks.end() if blanks else at
