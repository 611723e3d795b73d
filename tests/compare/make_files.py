"""Writes small files of every format with other people's programs, for tests/compare.sh.
usage: make_files.py FOLDER [--only FORMAT,...]. Formats as our readers are called. What has no
writer here is left out and named."""

import importlib
import os
import sys
import traceback

# By the name of our reader.
WRITERS = {"nrrd": "nrrd", "metaimage": "metaimage", "nifti": "nifti", "inrimage": "inrimage",
           "raw": "raw", "stack": "stack tiff", "zarr": "zarr", "n5": "n5", "dicom": "dicom",
           "hdf5": "hdf5", "vti": "vti", "vtk": "vtk", "vdb": "vdb", "mrc": "mrc", "amira": "amira"}


def main():
    folder = sys.argv[1]
    formats = sys.argv[3].split(",") if len(sys.argv) > 3 else WRITERS
    failed = False
    for name in " ".join(WRITERS[f] for f in formats).split():
        try:
            module = importlib.import_module("files." + name)
            here = os.path.join(folder, name)
            os.makedirs(here, exist_ok=True)
            module.write(here)
        except (ModuleNotFoundError, FileNotFoundError) as error:
            print(f"no {name} files are made: {error}", file=sys.stderr)
        except Exception:  # pylint: disable=broad-except
            traceback.print_exc()
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
