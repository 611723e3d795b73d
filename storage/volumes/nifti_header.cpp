#include "storage/volumes/nifti_header.h"

#include <string_view>

#include "storage/support/byte_order.h"

namespace voxweld {
namespace {

class Fields {
 public:
  Fields(std::span<const std::byte> bytes, std::endian order) : bytes_(bytes), order_(order) {}

  template <class T>
  T at(std::size_t offset) const {
    return load_as<T>(bytes_.data(), offset, order_);
  }
  template <class T, std::size_t n, class Out>
  void array(std::size_t offset, std::array<Out, n>& out) const {
    for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<Out>(at<T>(offset + i * sizeof(T)));
  }

 private:
  std::span<const std::byte> bytes_;
  std::endian order_;
};

std::optional<std::endian> length_order(std::span<const std::byte> bytes, std::int32_t length) {
  for (const std::endian order : {std::endian::little, std::endian::big})
    if (load_as<std::int32_t>(bytes.data(), 0, order) == length) return order;
  return std::nullopt;
}

std::string_view magic(std::span<const std::byte> bytes, std::size_t offset, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes.data()) + offset, size};
}

NiftiHeader parse_first(const Fields& fields) {
  NiftiHeader header;
  fields.array<std::int16_t>(40, header.dim);
  header.datatype = fields.at<std::int16_t>(70);
  header.bitpix = fields.at<std::int16_t>(72);
  fields.array<float>(76, header.pixdim);
  header.vox_offset = static_cast<double>(fields.at<float>(108));
  header.slope = static_cast<double>(fields.at<float>(112));
  header.inter = static_cast<double>(fields.at<float>(116));
  header.units = fields.at<std::uint8_t>(123);
  header.qform_code = fields.at<std::int16_t>(252);
  header.sform_code = fields.at<std::int16_t>(254);
  fields.array<float>(256, header.quatern);
  fields.array<float>(268, header.qoffset);
  for (std::size_t row = 0; row < 3; ++row) fields.array<float>(280 + 16 * row, header.srow[row]);
  return header;
}

NiftiHeader parse_second(const Fields& fields) {
  NiftiHeader header;
  header.version = 2;
  header.datatype = fields.at<std::int16_t>(12);
  header.bitpix = fields.at<std::int16_t>(14);
  fields.array<std::int64_t>(16, header.dim);
  fields.array<double>(104, header.pixdim);
  header.vox_offset = static_cast<double>(fields.at<std::int64_t>(168));
  header.slope = fields.at<double>(176);
  header.inter = fields.at<double>(184);
  header.qform_code = fields.at<std::int32_t>(344);
  header.sform_code = fields.at<std::int32_t>(348);
  fields.array<double>(352, header.quatern);
  fields.array<double>(376, header.qoffset);
  for (std::size_t row = 0; row < 3; ++row) fields.array<double>(400 + 32 * row, header.srow[row]);
  header.units = fields.at<std::int32_t>(500);
  return header;
}

}  // namespace

std::optional<NiftiHeader> parse_nifti_header(std::span<const std::byte> bytes) {
  using namespace std::string_view_literals;
  // The line ends in the second magic show a transfer that rewrote them.
  struct Version {
    std::size_t bytes, magic_at;
    std::string_view single, pair;
    NiftiHeader (*parse)(const Fields&);
  };
  for (const Version& version :
       {Version{nifti1_bytes, 344, "n+1\0"sv, "ni1\0"sv, parse_first},
        Version{nifti2_bytes, 4, "n+2\0\r\n\x1a\n"sv, "ni2\0\r\n\x1a\n"sv, parse_second}}) {
    if (bytes.size() < version.bytes) return std::nullopt;
    const auto order = length_order(bytes, static_cast<std::int32_t>(version.bytes));
    if (!order) continue;
    const std::string_view name = magic(bytes, version.magic_at, version.single.size());
    if (name != version.single && name != version.pair) return std::nullopt;
    NiftiHeader header = version.parse(Fields(bytes, *order));
    header.byte_order = *order;
    header.single_file = name == version.single;
    return header;
  }
  return std::nullopt;
}

bool looks_analyze(std::span<const std::byte> bytes) {
  // "regular" is 'r' in every Analyze 7.5 header.
  return bytes.size() >= nifti1_bytes && length_order(bytes, nifti1_bytes).has_value() &&
         bytes[38] == std::byte{'r'} && !parse_nifti_header(bytes);
}

}  // namespace voxweld
