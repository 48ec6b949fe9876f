"""Spectra files: HDF5 with named dimensions, coordinates and units, that netCDF readers open as it is.

While a sweep runs, its chunks are appended to a partial file, `OUT.h5.part`, which begins with the layout of the file to come. When
all are there, the HDF5 file is written from it, with a digest at its end of all bytes except the chunks, which have checksums. All bytes
are checked before HDF5 reads them, because a flipped bit in its bookkeeping can make it crash or loop for ever.
"""
