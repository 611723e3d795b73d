"""By nibabel."""

import os

import nibabel
import numpy as np

from .samples import TYPES, rotation, volume


def save(path, samples, affine, make=nibabel.Nifti1Image, **settings):
    """samples: [z, y, x]. Settings go to the header: slope and inter are left alone by nibabel."""
    image = make(np.ascontiguousarray(samples.T), affine, dtype=samples.dtype)
    image.header.set_data_dtype(samples.dtype)
    image.header.set_xyzt_units(settings.pop("unit", "mm"))
    for form in ("sform", "qform"):
        code = settings.pop(form, None)
        if code is not None:
            image.header[form + "_code"] = code
    image.header.set_slope_inter(*settings.pop("scale", (1, 0)))
    nibabel.save(image, path)


def patch(path, offset, data):
    with open(path, "r+b") as file:
        file.seek(offset)
        file.write(data)


def write(folder):
    def at(name):
        return os.path.join(folder, name)

    plain = np.diag([0.5, 1.25, 3, 1])
    steps = rotation(30, 20) * [0.4, 0.7, 2.5]
    turned = np.eye(4)
    turned[:3, :3], turned[:3, 3] = steps, [-10.5, 20, 1000.25]
    for dtype in TYPES:
        save(at(dtype + ".nii"), volume(dtype), turned)
        save(at(dtype + ".nii.gz"), volume(dtype), plain)
        big = nibabel.Nifti1Header(endianness=">")
        image = nibabel.Nifti1Image(volume(dtype).T, turned, big, dtype=dtype)
        image.header.set_data_dtype(np.dtype(dtype).newbyteorder(">"))
        nibabel.save(image, at(dtype + "_big.nii"))
    small = volume("i2")
    save(at("nifti2.nii"), small, turned, nibabel.Nifti2Image)
    save(at("pair.hdr"), small, turned, nibabel.Nifti1Pair)
    save(at("flipped.nii"), small, np.diag([-1.0, -2, 3, 1]))
    save(at("sform_only.nii"), small, turned, qform=0)
    save(at("qform_only.nii"), small, turned, sform=0)
    save(at("left_handed_qform.nii"), small, turned @ np.diag([1.0, 1, -1, 1]), sform=0)
    save(at("half_turn_qform.nii"), small, np.diag([-1.0, -1, 2, 1]), sform=0)
    save(at("no_form.nii"), small, plain, sform=0, qform=0)
    sheared = np.array([[1, 0.2, 0, 5], [0, 1, 0.1, 6], [0, 0, 2, 7], [0, 0, 0, 1.0]])
    save(at("sheared.nii"), small, sheared, qform=0)
    save(at("microns.nii"), small, plain, unit="micron")
    save(at("no_unit.nii"), small, plain, unit="unknown")
    save(at("scaled.nii"), small, plain)
    patch(at("scaled.nii"), 112, np.array([0.5, -1024], "<f4").tobytes())
    save(at("slope_zero.nii"), small, plain)
    patch(at("slope_zero.nii"), 112, np.array([0, 7], "<f4").tobytes())
    # The two ways to give a spacing are a little apart: the transform counts.
    save(at("pixdim_off.nii"), volume("u1", (400, 3, 3)), plain, qform=0)
    patch(at("pixdim_off.nii"), 80, np.array([0.5004], "<f4").tobytes())
    save(at("times.nii"), volume("u1", (7, 5, 4, 3)), plain)
    save(at("one_slice.nii"), volume("u1", (7, 5, 1)), plain)
