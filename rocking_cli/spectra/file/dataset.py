"""A spectrum in memory as xarray knows it: the dimensions, names and attributes that the file would have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...errors import OutputError
from ..dimensions import ABOUT, Frame
from ..variables import VARIABLES

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    import xarray


def dataset_of(frame: Frame, cells: Mapping[str, np.ndarray]) -> xarray.Dataset:
    """The dataset of variables of `layout` by name, in the dimensions of a frame. Raises OutputError where xarray is not installed."""
    try:
        import xarray as xr
    except ImportError:
        raise OutputError("to_xarray needs xarray: pip install xarray") from None

    def listed(name: str, dimension: str) -> xr.Variable:
        values = frame.dimensions[name] if name == dimension else frame.beside[name][1]
        return xr.Variable(dimension, values, {"units": ABOUT[name].units, "long_name": ABOUT[name].long_name})

    data = {
        name: xr.Variable(tuple(frame.dimensions), values, {k: v for k, v in VARIABLES[name].attributes.items() if k != "_FillValue"})
        for name, values in cells.items()
    }
    beside = {name: listed(name, dimension) for name, (dimension, _) in frame.beside.items()}
    places = {name: listed(name, name) for name in frame.dimensions}
    if frame.of_records:
        return xr.Dataset(data, places | beside)
    return xr.Dataset(data | beside, places)
