"""A spectrum in memory as an xarray dataset, with the dimensions, names and attributes of the file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...errors import OutputError
from ..dimensions import Frame
from ..variables import VARIABLES

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    import xarray


def dataset_of(frame: Frame, cells: Mapping[str, np.ndarray]) -> xarray.Dataset:
    """The dataset of variables by name, in the dimensions of a frame. Raises OutputError where xarray is not installed."""
    try:
        import xarray as xr
    except ImportError:
        raise OutputError("to_xarray needs xarray: pip install xarray") from None
    lists = {**{name: (name, values) for name, values in frame.dimensions.items()}, **frame.beside}
    along = {
        name: xr.Variable(dimension, values, {"units": frame.about(name).units, "long_name": frame.about(name).long_name})
        for name, (dimension, values) in lists.items()
    }
    data = {
        name: xr.Variable(tuple(frame.dimensions), values, {k: v for k, v in VARIABLES[name].attributes.items() if k != "_FillValue"})
        for name, values in cells.items()
    }
    found = xr.Dataset({**data, **along})
    return found.set_coords(list(along)) if frame.of_records else found
