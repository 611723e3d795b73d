"""Compares what our filters made with scipy.ndimage and skimage.measure.

usage: compare_filters.py FOLDER. FOLDER/cases.json lists the cases: name, filter, its parameters
along x, y, z, size along x, y, z, type of the input and of the result. FOLDER/NAME.in and NAME.out
are the samples. Prints what differs; exit status 1 where anything does.
"""
import json
import pathlib
import sys

import numpy as np
from scipy import ndimage
from skimage import measure


def expected(case, samples):
    """In double, not rounded yet; medians and maxima in the type of the input."""
    along = case["parameters"][::-1]
    if case["filter"] == "gaussian":
        return ndimage.gaussian_filter(samples.astype(float), along, mode="nearest", truncate=4)
    whole = [int(a) for a in along]
    box = [2 * r + 1 for r in whole]
    if case["filter"] == "mean":
        return ndimage.uniform_filter(samples.astype(float), box, mode="nearest")
    if case["filter"] == "median":
        return ndimage.median_filter(samples, box, mode="nearest")
    crop = samples[tuple(slice(0, n // f * f) for n, f in zip(samples.shape, whole))]
    block = tuple(whole)
    if case["filter"] == "block-mean":
        return measure.block_reduce(crop.astype(float), block, np.mean)
    return measure.block_reduce(crop, block, np.max)


def wrong(result, wanted, samples):
    """Which samples are not what they should be."""
    if wanted.dtype == result.dtype and not np.issubdtype(result.dtype, np.floating):
        return result != wanted
    if np.issubdtype(result.dtype, np.floating):
        relative = 1e-12 if result.dtype == np.float64 else 1e-6
        largest = np.abs(samples.astype(float)).max()
        return ~(np.abs(result.astype(float) - wanted.astype(float)) <= relative * largest)
    limits = np.iinfo(result.dtype)
    rounded = np.clip(np.rint(wanted), limits.min, limits.max)
    lost = 1e-9 + 2e-15 * np.abs(samples.astype(float)).max()  # two bits of a double
    halfway = np.abs(wanted - np.floor(wanted) - 0.5) < lost
    return np.abs(result.astype(float) - rounded) > halfway


def main():
    folder = pathlib.Path(sys.argv[1])
    bad = 0
    cases = json.loads((folder / "cases.json").read_text())
    for case in cases:
        samples = np.fromfile(folder / (case["name"] + ".in"), case["from"])
        samples = samples.reshape(case["size"][::-1])
        wanted = expected(case, samples)
        result = np.fromfile(folder / (case["name"] + ".out"), case["to"])
        if result.size != wanted.size:
            print(case["name"], "has", result.size, "samples instead of", wanted.size)
            bad += 1
            continue
        result = result.reshape(wanted.shape)
        places = np.argwhere(wrong(result, wanted, samples))
        if len(places):
            first = tuple(places[0])
            print(case["name"], len(places), "samples differ, first at z y x", first,
                  result[first], "instead of", wanted[first])
            bad += 1
    print(len(cases), "cases,", bad, "bad")
    return 1 if bad or not cases else 0


if __name__ == "__main__":
    sys.exit(main())
