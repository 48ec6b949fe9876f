"""Rocking dynamics of masonry structures: parameters, spectra and overturning
envelopes.

`load_structures` reads structures; `sine`, `pulse`, `read_motion` and `load_records`
make motions; `parse_grid` states amplitudes and frequencies. `check` then tells whether
a structure stands, `time_history` how it moves, and `envelope` which amplitudes
overturn it. `spectrum` and `write_spectrum` compute whole maps, and `fragility` fits
probabilities. `rocking help python` lists every name.

>>> (column,) = load_structures("configs/block.yaml")
>>> f"{check(column, sine(), parse_grid('a_g=0.35g,f_g=1.5')).capacity_demand:.3f}"
'1.115'

The public names stand in `__init__.pyi`, each with its home. They are imported on first
use, so that a program pays only for what it calls.
"""

import sys
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from types import FunctionType, ModuleType
from typing import Any

from . import showing

__version__ = "0.2.0"

showing.WRITERS.append(lambda: import_module(f"{__name__}.reports.tables"))


@cache
def _homes() -> dict[str, tuple[str, str]]:
    """The module of every public name, and its name there."""
    import ast
    from pkgutil import get_data

    stub = ast.parse(get_data(__name__, "__init__.pyi") or b"")
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    return {
        alias.asname or alias.name: (f"{__name__}.{node.module}", alias.name)
        for node in imports
        for alias in node.names
    }


def __getattr__(name: str) -> Any:
    if name == "__all__":
        return __dir__()
    if name.startswith("__") or name not in _homes():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _public(name)


@cache
def _public(name: str) -> Any:
    """The thing of a public name; a function checks its arguments."""
    module, there = _homes()[name]
    found = getattr(import_module(module), there)
    if not isinstance(found, FunctionType):
        return found
    from .arguments import checked

    return checked(found, name, __name__, _Public())


class _Public(Mapping[str, Any]):
    """The things of all public names."""

    def __getitem__(self, name: str) -> Any:
        if name not in _homes():
            raise KeyError(name)
        return _public(name)

    def __iter__(self) -> Iterator[str]:
        return iter(_homes())

    def __len__(self) -> int:
        return len(_homes())


class _Package(ModuleType):
    """This package: its function `fragility` stands before the subpackage of the same
    name.
    """

    fragility = property(
        lambda self: __getattr__("fragility"), lambda self, subpackage: None
    )


sys.modules[__name__].__class__ = _Package


def __dir__() -> list[str]:
    return sorted([*_homes(), "__version__"])
