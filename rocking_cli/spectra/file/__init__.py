"""Spectra files: HDF5 with named dimensions, coordinates and units, that netCDF readers open as it is.

While a sweep runs, its chunks are appended to a partial file, `OUT.h5.part`, which begins with the layout of the file to come. When
all are there, the HDF5 file is written from it, and behind it a digest of all its bytes but the chunks, which have checksums. HDF5
reads nothing that has not been checked: a flipped bit in its own bookkeeping can make it crash or loop for ever.
"""
