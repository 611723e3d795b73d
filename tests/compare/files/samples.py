"""Known samples: every value differs from its neighbours, ends of the range and NaNs are among
them."""

import numpy as np

TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")


def volume(dtype, size=(7, 5, 4), seed=1):
    """[z, y, x] of a size (x, y, z)."""
    random = np.random.default_rng(seed)
    kind = np.dtype(dtype)
    shape = size[::-1]
    if kind.kind == "f":
        samples = (random.integers(-10000, 10001, shape) / 8).astype(kind)
        samples.flat[:4] = [np.nan, np.inf, -np.inf, -0.0]
        return samples
    ends = np.iinfo(kind)
    samples = random.integers(ends.min, ends.max, shape, kind.newbyteorder("="), endpoint=True)
    samples.flat[:2] = [ends.min, ends.max]
    return samples.astype(kind)


def smooth(dtype, size, seed=2):
    """Like a scan: compresses well, and has an inside and an outside."""
    z, y, x = (np.linspace(-1, 1, n) for n in size[::-1])
    far = np.sqrt(z[:, None, None] ** 2 + y[None, :, None] ** 2 + x[None, None, :] ** 2)
    noise = np.random.default_rng(seed).integers(0, 5, far.shape)
    return (np.clip(100 - 80 * far, 0, 120) + noise).astype(dtype)


def rotation(degrees_z, degrees_x=0.0):
    """Columns: the directions of the axes."""
    a, b = np.radians([degrees_z, degrees_x])
    about_z = [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    about_x = [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
    return np.array(about_z) @ np.array(about_x)
