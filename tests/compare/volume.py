"""What an independent reader makes of a file, and what it says there is to compare."""

import json
from dataclasses import dataclass, field
from typing import Callable, Optional

import numpy as np

IMAGE_ENDINGS = (".tif", ".tiff", ".png", ".pbm", ".pgm", ".ppm", ".bmp", ".jpg", ".jpeg")


@dataclass
class Volume:
    """samples: [z, y, x]. spacing: (x, y, z), None where the file says nothing, which is 1 1 1.
    affine: 4 x 4, from index (x, y, z) to the world, None where the file has none. space: what the
    world's axes mean, "LPS" or "RAS", "" where that is not known. unit: None where it is not
    compared."""

    samples: np.ndarray
    spacing: Optional[tuple] = None
    affine: Optional[np.ndarray] = None
    space: str = ""
    unit: Optional[str] = None
    slope: float = 1.0
    intercept: float = 0.0


@dataclass
class Case:
    """One thing to open: a path with choices, and what another program reads there. refused: why no
    reader may open it so (several volumes and no choice)."""

    path: str
    load: Optional[Callable[[], Volume]] = None
    arguments: list = field(default_factory=list)
    refused: str = ""

    def name(self):
        return " ".join([self.path] + self.arguments)


@dataclass
class Found:
    """A reader's answer to a path: cases, and the other files that belong to them."""

    cases: list
    parts: list = field(default_factory=list)


class Unreadable(Exception):
    """The independent reader cannot read it either, and says why."""


def affine_of(steps, origin):
    """Steps: the world vector that one index makes, along x, y, z."""
    affine = np.eye(4)
    for axis in range(3):
        affine[:3, axis] = steps[axis]
    affine[:3, 3] = origin
    return affine


def diagonal(spacing, origin):
    return affine_of(np.diag(np.asarray(spacing, float)), origin)


def steps_length(affine):
    return tuple(float(np.linalg.norm(affine[:3, axis])) for axis in range(3))


def native(samples):
    """In the byte order of this machine."""
    return samples.astype(samples.dtype.newbyteorder("="), copy=False)


def as_volume_axes(array, axes):
    """An array with named axes, among them z, y and x and others of size 1, as [z, y, x]."""
    for name in [a for a in axes if a not in "zyx"]:
        at = axes.index(name)
        array, axes = np.take(array, 0, axis=at), axes[:at] + axes[at + 1 :]
    for name in "zyx":
        if name not in axes:
            array, axes = array[np.newaxis], [name] + list(axes)
    return array.transpose([list(axes).index(name) for name in "zyx"])


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def head_of(path, count=512):
    with open(path, "rb") as file:
        return file.read(count)
