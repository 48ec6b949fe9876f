"""Spectra files: HDF5 with named dimensions, coordinates and units, that netCDF readers
open as it is.

While a sweep runs, its chunks are appended to a partial file, `OUT.h5.part`, which
begins with the layout of the final file. When the sweep is complete, the HDF5 file is
written from the partial file. At its end stands a digest of all bytes except the
chunks, which have checksums. All bytes are checked before HDF5 reads them, because HDF5
can crash or loop for ever if a bit of its bookkeeping is flipped.
"""
