"""Independent readers, one file for each format. Each has `ours`, the name of our reader; `needs`,
Python modules and programs with the package of Debian that has them; and `find(path)`: what it knows
of the path, or None. Of two that know a path the first is asked."""

from . import (amira, dicom, hdf5, inrimage, metaimage, mrc, n5, nifti, nrrd, raw, stack, vdb, vti,
               vtk_legacy, zarr2, zarr3)

ALL = [raw, nrrd, metaimage, nifti, inrimage, zarr3, zarr2, n5, dicom, hdf5, vti, vtk_legacy, vdb, mrc,
       amira, stack]
