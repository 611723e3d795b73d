// Inrimage-4: .inr, .inr.gz; common for label volumes.
//
// A header of 256-byte blocks: "#INRIMAGE-4#{", lines "KEY=value" or, behind a #, remarks; newlines
// to the end of the last block, which is "##}\n". Then the samples, x fastest. Keys:
//   XDIM, YDIM, ZDIM   samples a side; VDIM: values a sample, 1
//   TYPE               "unsigned fixed", "signed fixed" or "float"; PIXSIZE: "8 bits" .. "64 bits"
//   CPU                byte order: decm, pc, alpha: little; sun, sgi: big
//   VX, VY, VZ         distance of samples; TX, TY, TZ: where the first is
//   SCALE              2**n; others (RX, RY, RZ: rotation) are not looked at
#pragma once

#include "storage/types/volume_reader.h"

namespace voxweld {

// Any box where the file is not compressed, else a stream. FormatError, InputError, StorageError.
VolumeReader inrimage_reader();

}  // namespace voxweld
