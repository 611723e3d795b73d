#include "storage/dicom/transfer_syntax.h"

#include <algorithm>

namespace voxweld {
namespace {

struct KnownSyntax {
  std::string_view uid;
  std::string_view name;
  FrameCoding coding = FrameCoding::unknown;
};

using enum FrameCoding;
// DICOM PS3.5 and PS3.6. Those of coding `unknown` are here for their names.
constexpr KnownSyntax known[] = {
    {implicit_little_uid, "implicit little endian", native},
    {explicit_little_uid, "explicit little endian", native},
    {"1.2.840.10008.1.2.1.99", "deflated explicit little endian", native},
    {"1.2.840.10008.1.2.2", "explicit big endian", native},
    {"1.2.840.10008.1.2.5", "RLE", run_lengths},
    {"1.2.840.10008.1.2.4.50", "JPEG baseline", jpeg},
    {"1.2.840.10008.1.2.4.51", "JPEG extended", jpeg},
    {"1.2.840.10008.1.2.4.53", "JPEG spectral selection", jpeg},
    {"1.2.840.10008.1.2.4.55", "JPEG full progression", jpeg},
    {"1.2.840.10008.1.2.4.57", "JPEG lossless", jpeg},
    {"1.2.840.10008.1.2.4.70", "JPEG lossless, first order", jpeg},
    {"1.2.840.10008.1.2.4.80", "JPEG-LS lossless", jpeg_ls},
    {"1.2.840.10008.1.2.4.81", "JPEG-LS near lossless", jpeg_ls},
    {"1.2.840.10008.1.2.4.90", "JPEG 2000 lossless", jpeg_2000},
    {"1.2.840.10008.1.2.4.91", "JPEG 2000", jpeg_2000},
    {"1.2.840.10008.1.2.1.98", "encapsulated uncompressed"},
    {"1.2.840.10008.1.2.4.92", "JPEG 2000 part 2 lossless"},
    {"1.2.840.10008.1.2.4.93", "JPEG 2000 part 2"},
    {"1.2.840.10008.1.2.4.94", "JPIP referenced"},
    {"1.2.840.10008.1.2.4.95", "JPIP referenced deflated"},
    {"1.2.840.10008.1.2.4.100", "MPEG2 main level"},
    {"1.2.840.10008.1.2.4.101", "MPEG2 high level"},
    {"1.2.840.10008.1.2.4.102", "MPEG-4 AVC/H.264 4.1"},
    {"1.2.840.10008.1.2.4.103", "MPEG-4 AVC/H.264 4.1 BD"},
    {"1.2.840.10008.1.2.4.107", "HEVC/H.265 main"},
    {"1.2.840.10008.1.2.4.108", "HEVC/H.265 main 10"},
    {"1.2.840.10008.1.2.4.110", "JPEG XL lossless"},
    {"1.2.840.10008.1.2.4.111", "JPEG XL recompression"},
    {"1.2.840.10008.1.2.4.112", "JPEG XL"},
    {"1.2.840.10008.1.2.4.201", "high-throughput JPEG 2000 lossless"},
    {"1.2.840.10008.1.2.4.202", "high-throughput JPEG 2000 RPCL lossless"},
    {"1.2.840.10008.1.2.4.203", "high-throughput JPEG 2000"},
    {"1.2.840.113619.5.2", "GE private, big endian samples"},
};

}  // namespace

TransferSyntax transfer_syntax(std::string_view uid) {
  TransferSyntax syntax;
  syntax.uid = uid;
  syntax.name = "private or unknown";
  const auto* found = std::ranges::find(known, uid, &KnownSyntax::uid);
  if (found != std::end(known)) {
    syntax.name = found->name;
    syntax.coding = found->coding;
  }
  syntax.explicit_vr = uid != implicit_little_uid && uid != "1.2.840.113619.5.2";
  syntax.deflated = uid == "1.2.840.10008.1.2.1.99";
  if (uid == "1.2.840.10008.1.2.2") syntax.order = std::endian::big;
  return syntax;
}

}  // namespace voxweld
