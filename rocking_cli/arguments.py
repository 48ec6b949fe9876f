"""Checks the arguments of the public functions by their annotations, so that a wrong
one is told in one sentence.

The package itself calls its functions directly; only those that `import rocking_cli`
offers are checked.
"""

import os
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, wraps
from inspect import Parameter, Signature, signature
from itertools import islice
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from .errors import ArgumentError, counted, did_you_mean

_MOST_ITEMS = 10_000  # number of items of a list that are checked
# The functions that return what another one takes.
_MADE = {
    "RockingParameters": "load_structures",
    "Document": "read_documents",
    "Motion": "sine, pulse, read_motion",
    "HasMotion": "read_record, load_records, or Record.of for an array",
    "Record": "read_record",
    "Recording": "load_records",
    "Grid": "parse_grid",
    "HazardCurve": "read_hazard",
    "SpectrumFile": "read_spectrum",
    "Variation": "parse_variation",
    "Verdict": "check",
    "CodeCheck": "code_check",
    "Fit": "fragility",
}
_PLAIN = {
    float: "a number",
    int: "a whole number",
    bool: "True or False",
    str: "a text",
    type(None): "None",
    dict: "a dictionary",
}


def checked(
    function: Callable[..., Any], name: str, package: str, public: Mapping[str, Any]
) -> Callable[..., Any]:
    """Return a function that raises ArgumentError for an argument whose annotation it
    does not fit, and for one too many or too few. name, package: under which it is
    public, and can be pickled; public: the names that its annotations may have.
    """
    of = signature(function)
    hints = cache(lambda: typing.get_type_hints(function, localns=_Names(public)))

    @wraps(function)
    def wrapper(*args: Any, **kwargs: Any) -> Any:
        try:
            bound = of.bind(*args, **kwargs)
        except TypeError as error:
            raise ArgumentError(f"{name}: {_in_words(str(error), of)}") from None
        for argument, given in bound.arguments.items():
            value = bound.arguments[argument] = _kept(given, hints().get(argument))
            kind = of.parameters[argument].kind
            needed = of.parameters[argument].default is Parameter.empty
            if kind is Parameter.VAR_KEYWORD:
                _check_keywords(name, hints().get(argument, Any), value)
            elif (
                kind is not Parameter.VAR_POSITIONAL
                and value is not of.parameters[argument].default
            ):
                _check(name, argument, hint := hints().get(argument, Any), value)
                if (
                    needed
                    and isinstance(value, list | tuple)
                    and not value
                    and any(
                        typing.get_origin(one) is Sequence for one in _options(hint)
                    )
                ):
                    raise ArgumentError(
                        f"{name}: `{argument}`: found an empty {type(value).__name__};"
                        f" expected {_wanted(hint)}"
                    )
        return function(*bound.args, **bound.kwargs)

    wrapper.__module__, wrapper.__qualname__ = package, name
    return wrapper


class _Names(dict[str, Any]):
    """The public names, each imported when an annotation has it."""

    def __init__(self, public: Mapping[str, Any]) -> None:
        super().__init__()
        self.public = public

    def __missing__(self, name: str) -> Any:
        return self.public[name]


def _in_words(said: str, of: Signature) -> str:
    """Return the text of Python's TypeError with the accepted names."""
    word = said.partition("unexpected keyword argument '")[2].partition("'")[0]
    return (
        f"{said}{did_you_mean(word, of.parameters) if word else ''}; expected"
        f" {', '.join(of.parameters)}"
    )


def check_choices(name: str, choices: Any, given: Mapping[str, Any]) -> None:
    """Raise ArgumentError unless the keyword arguments of the function `name` fit the
    annotations of a TypedDict or a dataclass.
    """
    known = typing.get_type_hints(choices)
    for argument, value in given.items():
        if argument not in known:
            raise ArgumentError(
                f"{name}: found an argument"
                f" {argument!r}{did_you_mean(argument, known)}; expected"
                f" {', '.join(known)}"
            )
        _check(name, argument, known[argument], value)


def check_fields(record: Any) -> None:
    """Raise ArgumentError unless the fields of a dataclass fit their annotations."""
    kind = type(record)
    for name, hint in typing.get_type_hints(kind).items():
        _check(kind.__name__, name, hint, getattr(record, name))


def _check_keywords(name: str, hint: Any, given: Mapping[str, Any]) -> None:
    """Check the keyword arguments that an annotation such as Unpack[MotionChoices] or
    float is for.
    """
    if typing.is_typeddict(choices := next(iter(typing.get_args(hint)), None)):
        check_choices(name, choices, given)
    else:
        for argument, value in given.items():
            _check(name, argument, hint, value)


def _kept(value: Any, hint: Any) -> Any:
    """Return the list of what can be gone through only once, where a list may stand;
    any other value as it is.
    """
    once = isinstance(value, Iterator) and any(map(_is_list, _options(hint)))
    return list(value) if once else value


def _check(name: str, argument: str, hint: Any, value: Any) -> None:
    if not _fits(value, hint):
        raise ArgumentError(
            f"{name}: `{argument}`: found {_found(value, hint)}; expected"
            f" {_wanted(hint)}{_instead(argument, hint, value)}"
        )


def _instead(argument: str, hint: Any, value: Any) -> str:
    """Return what to write where one thing stands for a list of them, or a list for
    one.
    """
    if not isinstance(value, str | Path) and any(
        _is_list(one) and _fits([value], one) for one in _options(hint)
    ):
        return f"; write [{argument}]"
    if isinstance(value, list | tuple) and value and _fits(value[0], hint):
        return f"; write {argument}[0]"
    return ""


def _options(hint: Any) -> tuple[Any, ...]:
    """Return the members of a union, a single type as one."""
    return (
        typing.get_args(hint)
        if typing.get_origin(hint) in (typing.Union, types.UnionType)
        else (hint,)
    )


def _is_list(hint: Any) -> bool:
    origin = typing.get_origin(hint)
    return (
        isinstance(origin, type)
        and issubclass(origin, Iterable)
        and origin is not tuple
        and not issubclass(origin, Mapping)
    )


def _fits(value: Any, hint: Any) -> bool:
    """True if a value may stand where the annotation is `hint`."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if isinstance(value, str | Path) and _wrong_character(str(value)):
        return False
    if hint is Any or isinstance(hint, typing.TypeVar | str):
        return True
    if len(options := _options(hint)) > 1:
        return any(_fits(value, one) for one in options)
    if origin is Callable or hint is Callable:
        return callable(value)
    if origin is tuple:
        fixed = (
            inner
            if Ellipsis not in inner
            else inner[:1] * len(value)
            if isinstance(value, tuple)
            else ()
        )
        return (
            isinstance(value, tuple)
            and len(value) == len(fixed)
            and all(map(_fits, value, fixed))
        )
    if _is_list(hint):
        return _fits_list(value, inner[0] if inner else Any)
    if isinstance(origin, type):
        return isinstance(value, origin)
    if getattr(hint, "_is_protocol", False):
        return not isinstance(value, type) and all(
            hasattr(type(value), part)
            for part in vars(hint)
            if not part.startswith("_")
        )
    if hint in (float, int):
        number = isinstance(value, Real if hint is float else Integral)
        return number and not isinstance(value, bool) and not _is_too_large(value)
    if getattr(hint, "__name__", "") == "ndarray":
        return _is_numeric(value)
    return isinstance(value, hint) if isinstance(hint, type) else True


def _fits_list(value: Any, inner: Any) -> bool:
    """True for a list, or another iterable, of such items; a text, a path, a dictionary
    and what can be gone through only once are none.
    """
    none = str | bytes | Path | Mapping | Iterator | type
    if isinstance(value, none) or not isinstance(value, Iterable):
        return False
    if inner in (float, int):
        return _is_numeric(value)
    try:
        return all(_fits(one, inner) for one in islice(value, _MOST_ITEMS))
    except TypeError:  # an array without a dimension
        return False


def _is_too_large(value: Any) -> bool:
    """True for a number beyond the range of double precision."""
    try:
        float(value)
    except OverflowError:
        return True
    return False


def _wrong_character(text: str) -> str:
    """Return what no name of a file and no document holds, in words; empty without."""
    if "\0" in text:
        return "a NUL character"
    try:
        os.fsencode(text)
    except UnicodeEncodeError:
        return "half a character (a lone surrogate)"
    return ""


def _is_numeric(value: Any) -> bool:
    """True for a number and for an array, or a list, of numbers."""
    import numpy as np

    try:
        return np.asarray(value).dtype.kind in "fiub" and value is not None
    except (TypeError, ValueError):
        return False


def _found(value: Any, hint: Any) -> str:
    """Return what was given, in words."""
    if isinstance(value, str | Path) and (character := _wrong_character(str(value))):
        return f"a text with {character}"
    if isinstance(value, str):
        return f"the text {value[:60]!r}"
    if value is None or isinstance(value, bool):
        return repr(value)
    if isinstance(value, Real):
        large = _is_too_large(value)
        return "a number beyond double precision" if large else f"the number {value}"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if isinstance(value, list | tuple):
        inner = next(
            (
                typing.get_args(one)[0]
                for one in _options(hint)
                if _is_list(one) and typing.get_args(one)
            ),
            Any,
        )
        wrong = next(
            (one for one in value[:_MOST_ITEMS] if not _fits(one, inner)), None
        )
        begun = f"a {type(value).__name__} of {counted(len(value), 'item')}"
        return (
            begun
            if wrong is None and None not in value
            else f"a {type(value).__name__} with {_found(wrong, Any)} in it"
        )
    word = (
        "a dictionary"
        if isinstance(value, Mapping)
        else "a path"
        if isinstance(value, Path)
        else ""
    )
    kind = type(value).__name__
    return word or (
        "a function"
        if isinstance(value, types.FunctionType)
        else f"{'an' if kind[0] in 'AEIOUaeiou' else 'a'} {kind}"
    )


def _wanted(hint: Any) -> str:
    """Return what fits an annotation, in words."""
    if hint is Any:
        return "another value"
    options = _options(hint)
    if {str, Path} <= set(options):
        rest = [one for one in options if one not in (str, Path)]
        pulse = any(getattr(one, "__name__", "") == "Motion" for one in rest)
        path = f"{'the name of a pulse or ' * pulse}a path (a text or a Path)"
        return " or ".join([path, *map(_wanted, rest)])
    if len(options) > 1:
        return " or ".join(dict.fromkeys(map(_wanted, options)))
    if hint in _PLAIN:
        return _PLAIN[hint]
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is Callable:
        return "a function"
    if origin is tuple:
        return f"a tuple of ({', '.join(map(_wanted, inner))})"
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return "a dictionary"
    if _is_list(hint):
        return f"a list of {_many(inner[0])}" if inner else "a list"
    named = _named(hint)
    return (
        "an array of numbers"
        if named == "ndarray"
        else f"{'an' if named[0] in 'AEIOU' else 'a'} {named}"
    )


def _many(hint: Any) -> str:
    """Return what fits an annotation, in words for several."""
    options = _options(hint)
    if {str, Path} <= set(options):
        return "paths"
    if len(options) > 1:
        return " or ".join(dict.fromkeys(map(_many, options)))
    return {float: "numbers", int: "whole numbers", str: "texts"}.get(hint) or _named(
        hint
    )


def _named(hint: Any) -> str:
    """Return the name of a type, with the public function that makes such an object
    where there is one: `Motion (see read_motion)`.
    """
    options = _options(hint)
    if len(options) > 1 or hint in _PLAIN or typing.get_origin(hint):
        return _wanted(hint)
    kind = {"HasMotion": "Record or Recording"}.get(hint.__name__, hint.__name__)
    return (
        f"{kind} (see {_MADE[hint.__name__]})" if hint.__name__ in _MADE else str(kind)
    )
