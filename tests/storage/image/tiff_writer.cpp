#include "tests/storage/image/tiff_writer.h"

#include <algorithm>
#include <cstring>

#include "storage/support/file_io.h"
#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

enum FieldType : std::uint16_t { ascii = 2, short_int = 3, long_int = 4, rational = 5, long8 = 16 };

struct Field {
  std::uint16_t tag, type;
  std::uint64_t count;
  std::vector<std::byte> value;
};

template <class T>
void put(std::vector<std::byte>& out, T value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  for (std::size_t i = 0; i < sizeof value; ++i) out.push_back(bytes[i]);
}

Field short_field(std::uint16_t tag, std::vector<std::uint16_t> values) {
  Field field{tag, short_int, values.size(), {}};
  for (const std::uint16_t value : values) put(field.value, value);
  return field;
}

class Writer {
 public:
  explicit Writer(bool big) : big_(big) {
    put<std::uint16_t>(out_, 0x4949);
    put<std::uint16_t>(out_, big ? 43 : 42);
    if (big) put<std::uint32_t>(out_, 8);
    link_ = out_.size();
    put_offset(out_, 0);
  }

  void page(const TiffPage& page) {
    std::vector<Field> fields = strips(page);
    add_tags(page, fields);
    std::sort(fields.begin(), fields.end(),
              [](const Field& a, const Field& b) { return a.tag < b.tag; });
    directory(fields);
  }

  const std::vector<std::byte>& bytes() const { return out_; }

 private:
  void put_offset(std::vector<std::byte>& out, std::uint64_t value) const {
    if (big_)
      put(out, value);
    else
      put(out, static_cast<std::uint32_t>(value));
  }

  Field offsets(std::uint16_t tag, const std::vector<std::uint64_t>& values) const {
    Field field{tag, big_ ? long8 : long_int, values.size(), {}};
    for (const std::uint64_t value : values) put_offset(field.value, value);
    return field;
  }

  std::vector<Field> strips(const TiffPage& page) {
    const std::uint32_t rows = page.strip_rows != 0 ? page.strip_rows : page.height;
    const std::size_t row_bytes = page.data.size() / page.height;
    std::vector<std::uint64_t> starts, sizes;
    for (std::uint32_t y = 0; y < page.height; y += rows) {
      const std::size_t bytes = row_bytes * std::min(rows, page.height - y);
      const std::byte* raw = page.data.data() + y * row_bytes;
      std::vector<std::byte> strip(raw, raw + bytes);
      if (page.deflate) strip = deflated(strip);
      const bool lost = page.lost_tail && y + rows >= page.height;
      starts.push_back(out_.size() + (lost ? std::size_t{1} << 20 : 0));
      sizes.push_back(strip.size());
      out_.insert(out_.end(), strip.begin(), strip.end());
    }
    return {offsets(273, starts), offsets(279, sizes), offsets(278, {rows})};
  }

  static std::uint16_t sample_format(SampleType type) {
    switch (type) {
      case SampleType::i8:
      case SampleType::i16:
      case SampleType::i32:
      case SampleType::i64:
        return 2;
      case SampleType::f32:
      case SampleType::f64:
        return 3;
      default:
        return 1;
    }
  }

  void add_tags(const TiffPage& page, std::vector<Field>& fields) const {
    const auto bits =
        page.bits != 0 ? page.bits : static_cast<std::uint16_t>(8 * sample_bytes(page.type));
    fields.push_back(offsets(256, {page.width}));
    fields.push_back(offsets(257, {page.height}));
    fields.push_back(short_field(258, std::vector<std::uint16_t>(page.channels, bits)));
    fields.push_back(short_field(259, {static_cast<std::uint16_t>(page.deflate ? 8 : 1)}));
    fields.push_back(short_field(262, {page.photometric}));
    fields.push_back(short_field(277, {page.channels}));
    fields.push_back(short_field(339, {sample_format(page.type)}));
    if (page.orientation != 0) fields.push_back(short_field(274, {page.orientation}));
    if (!page.description.empty()) {
      Field text{270, ascii, page.description.size() + 1, {}};
      for (const char c : page.description) put(text.value, c);
      put(text.value, '\0');
      fields.push_back(text);
    }
    if (page.resolution == 0) return;
    for (const std::uint16_t tag : {std::uint16_t{282}, std::uint16_t{283}}) {
      Field field{tag, rational, 1, {}};
      put(field.value, static_cast<std::uint32_t>(page.resolution * 1000));
      put<std::uint32_t>(field.value, 1000);
      fields.push_back(field);
    }
    fields.push_back(short_field(296, {page.resolution_unit}));
  }

  void directory(std::vector<Field>& fields) {
    const std::size_t inline_bytes = big_ ? 8 : 4;
    for (Field& field : fields) {
      if (field.value.size() > inline_bytes) {
        if (out_.size() % 2 != 0) out_.push_back(std::byte{0});
        const std::uint64_t at = out_.size();
        out_.insert(out_.end(), field.value.begin(), field.value.end());
        field.value.clear();
        put_offset(field.value, at);
      }
      field.value.resize(inline_bytes);
    }
    if (out_.size() % 2 != 0) out_.push_back(std::byte{0});
    std::vector<std::byte> here;
    put_offset(here, out_.size());
    std::copy(here.begin(), here.end(), out_.begin() + static_cast<std::ptrdiff_t>(link_));
    if (big_)
      put<std::uint64_t>(out_, fields.size());
    else
      put(out_, static_cast<std::uint16_t>(fields.size()));
    for (const Field& field : fields) {
      put(out_, field.tag);
      put(out_, field.type);
      put_offset(out_, field.count);
      out_.insert(out_.end(), field.value.begin(), field.value.end());
    }
    link_ = out_.size();
    put_offset(out_, 0);
  }

  bool big_;
  std::size_t link_ = 0;  // where the offset of the next directory goes
  std::vector<std::byte> out_;
};

}  // namespace

void write_tiff(const std::filesystem::path& path, const std::vector<TiffPage>& pages, bool big) {
  Writer writer(big);
  for (const TiffPage& page : pages) writer.page(page);
  write_whole_file(path, writer.bytes(), Durability::rename_only);
}

}  // namespace voxweld::testing
