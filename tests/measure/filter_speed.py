"""Our filters and those of scipy.ndimage on the same kind of volume, one thread each, in one run.

usage: filter_speed.py PROGRAM [FILTER]
PROGRAM is build/filter_speed; FILTER: only those whose name begins so.
Prints type, filter, millions of samples a second of ours and of scipy's, and their ratio. scipy's
is measured on a slab, which it is given at once.
"""
import subprocess
import sys
import time

import numpy as np
from scipy import ndimage

SLAB = (16, 256, 256)


def as_floats(samples):
    return samples.astype(np.float32)


FILTERS = {
    "gaussian-1": lambda s: ndimage.gaussian_filter(as_floats(s), 1, mode="nearest"),
    "gaussian-2": lambda s: ndimage.gaussian_filter(as_floats(s), 2, mode="nearest"),
    "mean-1": lambda s: ndimage.uniform_filter(as_floats(s), 3, mode="nearest"),
    "median-1": lambda s: ndimage.median_filter(s, 3, mode="nearest"),
    "median-2": lambda s: ndimage.median_filter(s, 5, mode="nearest"),
    "downsample-mean-2": lambda s: s.reshape(8, 2, 128, 2, 128, 2).mean(axis=(1, 3, 5)),
}


def main():
    random = np.random.default_rng(1)
    prefix = sys.argv[2] if len(sys.argv) > 2 else ""
    for name in FILTERS:
        if name.startswith(prefix):
            compare(name, random)


def compare(name, random):
    ours = subprocess.run([sys.argv[1], name], capture_output=True, text=True, check=True).stdout
    for line in ours.splitlines():
        kind, _, speed = line.split()
        samples = (random.random(SLAB) * 0.8 * (255 if kind == "uint8" else 65535)).astype(kind)
        seconds = []
        for _ in range(3):
            start = time.perf_counter()
            FILTERS[name](samples)
            seconds.append(time.perf_counter() - start)
        theirs = samples.size / min(seconds) / 1e6
        print(kind, name, speed, f"{theirs:.2f} x{float(speed) / theirs:.1f}", flush=True)


if __name__ == "__main__":
    main()
