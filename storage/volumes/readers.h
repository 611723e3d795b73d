// The readers of volume files: rows of the table in storage/readers. What they open can be read in
// any box where its samples lie raw in the file, else as a stream (text and compressed ones). They
// throw FormatError for damaged files and what they do not support, InputError and StorageError.
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// NRRD, attached (.nrrd) and detached (.nhdr): teem.sourceforge.net/nrrd/format.html. 3-D scalar
// volumes, also with further axes of size 1; encodings raw, gzip, bzip2 and text.
VolumeReader nrrd_reader();

// MetaImage, .mha (header and samples) and .mhd (header beside the samples), as ITK reads them. 3-D
// scalar volumes, also with further axes of size 1, of one channel.
VolumeReader metaimage_reader();

// NIfTI-1 and NIfTI-2: one file (.nii, .nii.gz) or a pair (.hdr, .img), of which the path may be
// either: nifti.nimh.nih.gov. One 3-D scalar volume, no colours or complex numbers. The stored
// values are read as they are: a slope and intercept in the header is a warning.
VolumeReader nifti_reader();

// Inrimage-4: .inr, .inr.gz; common for label volumes.
// A header of 256-byte blocks: "#INRIMAGE-4#{", lines "KEY=value" or, behind a #, remarks; newlines
// to the end of the last block, which is "##}\n". Then the samples, x fastest. Keys:
//   XDIM, YDIM, ZDIM   samples a side; VDIM: values a sample, 1
//   TYPE               "unsigned fixed", "signed fixed" or "float"; PIXSIZE: "8 bits" .. "64 bits"
//   CPU                byte order: decm, pc, alpha: little; sun, sgi: big
//   VX, VY, VZ         distance of samples; TX, TY, TZ: where the first is
//   SCALE              2**n; others (RX, RY, RZ: rotation) are not looked at
VolumeReader inrimage_reader();

// MRC and CCP4 maps, also compressed with gzip: ccpem.ac.uk/mrc_format. Of electron microscopy, in
// angstrom. Columns, rows and sections may run along x, y and z in any order.
VolumeReader mrc_reader();

// Amira and Avizo: .am, "# AmiraMesh" or "# Avizo": lattices with uniform coordinates; text or binary
// in either byte order, plain, in runs of bytes (HxByteRLE) or deflated (HxZip).
VolumeReader amira_reader();

// Headerless samples: everything about them is the caller's to say. Told by name only: .raw and
// .bin. InputError for a bad layout and where the spec's raw pieces lack size or type; FormatError
// when the file is shorter than they say.
VolumeReader raw_reader();

}  // namespace voxweld
