"""Checks the arguments of the public functions by their annotations, so that a wrong
one is told in one sentence.

The package itself calls its functions directly; only those that `import rocking_cli`
offers are checked.
"""

import os
import reprlib
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, wraps
from inspect import BoundArguments, Parameter, Signature, signature
from itertools import islice
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from .errors import ArgumentError, did_you_mean

_MOST_ITEMS = 10_000  # number of items of a list that are checked
# types in words, with the functions that make what another one takes
_WORDS = {
    "float": "a number",
    "int": "a whole number",
    "bool": "True or False",
    "str": "a text",
    "NoneType": "None",
    "ndarray": "an array of numbers",
    "RockingParameters": "RockingParameters (see load_structures)",
    "Document": "a Document (see read_documents)",
    "Motion": "a Motion (see sine, pulse, read_motion)",
    "HasMotion": "a Record or Recording (see read_record, load_records, Record.of)",
    "Record": "a Record (see read_record)",
    "Recording": "a Recording (see load_records)",
    "Grid": "a Grid (see parse_grid)",
    "HazardCurve": "a HazardCurve (see read_hazard)",
    "SpectrumFile": "a SpectrumFile (see read_spectrum)",
    "Variation": "a Variation (see parse_variation)",
    "Verdict": "a Verdict (see check)",
    "CodeCheck": "a CodeCheck (see code_check)",
    "Fit": "a Fit (see fragility)",
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
        bound = _bound(name, of, args, kwargs)
        for argument, given in bound.arguments.items():
            parameter, hint = of.parameters[argument], hints().get(argument, Any)
            value = bound.arguments[argument] = _kept(given, hint)
            if parameter.kind is Parameter.VAR_KEYWORD:
                _check_keywords(name, hint, value)
            elif (
                parameter.kind is not Parameter.VAR_POSITIONAL
                and value is not parameter.default
            ):
                needed = parameter.default is Parameter.empty
                _check(name, argument, hint, value, needed)
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


def _bound(
    name: str, of: Signature, args: Sequence[Any], kwargs: Mapping[str, Any]
) -> BoundArguments:
    """Return the arguments by name. Raises ArgumentError, with the accepted names, for
    one too many or too few.
    """
    try:
        return of.bind(*args, **kwargs)
    except TypeError as error:
        said = str(error)
    word = said.partition("unexpected keyword argument '")[2].partition("'")[0]
    hint = did_you_mean(word, of.parameters) if word else ""
    raise ArgumentError(f"{name}: {said}{hint}; expected {', '.join(of.parameters)}")


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


def _check(
    name: str, argument: str, hint: Any, value: Any, needed: bool = False
) -> None:
    """Raise ArgumentError for a value that may not stand where the annotation is
    `hint`; needed: True refuses an empty list too.
    """
    empty = needed and isinstance(value, list | tuple) and not value
    lists = any(typing.get_origin(one) is Sequence for one in _options(hint))
    if (empty and lists) or not _fits(value, hint):
        raise ArgumentError(
            f"{name}: `{argument}`: found {_found(value)}; expected {_wanted(hint)}"
        )


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
    if isinstance(value, str | Path) and not _is_written(str(value)):
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


def _is_written(text: str) -> bool:
    """True for a text that a document or the name of a file can hold: not a NUL
    character, nor half a character.
    """
    try:
        os.fsencode(text)
    except UnicodeEncodeError:
        return False
    return "\0" not in text


def _is_numeric(value: Any) -> bool:
    """True for a number and for an array, or a list, of numbers."""
    import numpy as np

    try:
        return np.asarray(value).dtype.kind in "fiub" and value is not None
    except (TypeError, ValueError):
        return False


def _found(value: Any) -> str:
    """Return what was given, in words."""
    if isinstance(value, Real) and _is_too_large(value):
        return "a number beyond double precision"
    if isinstance(value, str | Path | Real | None):
        return reprlib.repr(value)
    kind = type(value).__name__
    if isinstance(value, list | tuple):
        kinds = dict.fromkeys(type(one).__name__ for one in value)
        return f"a {kind} of {', '.join(kinds)}" if kinds else f"an empty {kind}"
    return f"a {kind}"


def _wanted(hint: Any) -> str:
    """Return what fits an annotation, in words."""
    options, inner = _options(hint), typing.get_args(hint)
    if len(options) > 1:
        return " or ".join(dict.fromkeys(map(_wanted, options)))
    if inner and _is_list(hint):
        return f"a list, each item {_wanted(inner[0])}"
    name = getattr(typing.get_origin(hint) or hint, "__name__", str(hint))
    return _WORDS.get(name, name)
