// A volume whose samples the test knows, ways to write it to files, and the comparison with what a
// source reads back.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "storage/readers/open_volume.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/deflated.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

inline constexpr SampleType all_types[] = {
    SampleType::u8,  SampleType::i8,  SampleType::u16, SampleType::i16, SampleType::u32,
    SampleType::i32, SampleType::u64, SampleType::i64, SampleType::f32, SampleType::f64};

using Bytes = std::vector<std::byte>;

struct KnownVolume {
  SampleType type = SampleType::u8;
  Index3 size;
  Bytes samples;  // native byte order

  Bytes box(const Box3& b) const {
    const auto width = static_cast<std::int64_t>(sample_bytes(type));
    Bytes out;
    for (std::int64_t z = b.lo.z; z < b.hi.z; ++z)
      for (std::int64_t y = b.lo.y; y < b.hi.y; ++y) {
        const auto begin = samples.begin() + ((z * size.y + y) * size.x + b.lo.x) * width;
        out.insert(out.end(), begin, begin + b.size().x * width);
      }
    return out;
  }
  // Shares 0 .. count-1 of the samples as a file would hold them.
  Bytes share(std::size_t index, std::size_t count, std::endian order) const {
    const std::size_t bytes = samples.size() / count;
    Bytes out(samples.begin() + static_cast<std::ptrdiff_t>(index * bytes),
              samples.begin() + static_cast<std::ptrdiff_t>((index + 1) * bytes));
    if (order != std::endian::native)
      for (std::size_t i = 0; i < out.size(); i += sample_bytes(type))
        std::reverse(out.begin() + static_cast<std::ptrdiff_t>(i),
                     out.begin() + static_cast<std::ptrdiff_t>(i + sample_bytes(type)));
    return out;
  }
  Bytes stored(std::endian order = std::endian::little) const { return share(0, 1, order); }
};

// Integers over their whole range, real numbers in eighths.
inline KnownVolume make_volume(SampleType type, Index3 size, unsigned seed = 1) {
  KnownVolume volume{type, size, {}};
  std::mt19937_64 random(seed);
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    volume.samples.resize(static_cast<std::size_t>(size.x * size.y * size.z) * sizeof(T));
    for (std::size_t i = 0; i < volume.samples.size(); i += sizeof(T)) {
      T value{};
      if constexpr (std::is_floating_point_v<T>)
        value = static_cast<T>(static_cast<int>(random() % 20001) - 10000) / T{8};
      else
        value = static_cast<T>(random());
      std::memcpy(volume.samples.data() + i, &value, sizeof(T));
    }
  });
  return volume;
}

inline std::string as_text(const KnownVolume& volume, const std::string& separator = " ") {
  std::string text;
  dispatch_sample_type(volume.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    for (std::size_t i = 0; i < volume.samples.size(); i += sizeof(T)) {
      T value{};
      std::memcpy(&value, volume.samples.data() + i, sizeof(T));
      text += std::to_string(value) + (i % (7 * sizeof(T)) == 0 ? "\n" : separator);
    }
  });
  return text;
}

inline Bytes to_bytes(const std::string& text) {
  const auto bytes = as_bytes(text);
  return {bytes.begin(), bytes.end()};
}
inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline std::filesystem::path write_file(const std::filesystem::path& path,
                                        std::span<const std::byte> data) {
  write_whole_file(path, data, Durability::rename_only);
  return path;
}
inline std::filesystem::path write_file(const std::filesystem::path& path,
                                        const std::string& text) {
  return write_file(path, as_bytes(text));
}

inline Bytes read_box(const SampleSource& source, const Box3& box) {
  const auto width = sample_bytes(source.info().type);
  // Bytes beyond the box must stay as they are.
  Bytes out(static_cast<std::size_t>(box.count()) * width + 8, std::byte{0xa5});
  source.read(box, out.data());
  for (std::size_t i = out.size() - 8; i < out.size(); ++i)
    if (out[i] != std::byte{0xa5}) throw std::runtime_error("wrote beyond the box");
  out.resize(out.size() - 8);
  return out;
}

inline Box3 random_box(Index3 size, std::mt19937_64& random) {
  Box3 box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = static_cast<std::uint64_t>(size[axis]);
    box.lo[axis] = static_cast<std::int64_t>(random() % side);
    box.hi[axis] =
        box.lo[axis] + 1 +
        static_cast<std::int64_t>(random() % (side - static_cast<std::uint64_t>(box.lo[axis])));
  }
  return box;
}

// Facts and samples of `source` against `volume`, in the order its access allows.
inline void expect_volume(const SampleSource& source, const KnownVolume& volume) {
  const VolumeInfo& info = source.info();
  ASSERT_EQ(info.geometry.size, volume.size);
  ASSERT_EQ(info.type, volume.type);
  for (const InputFile& file : info.files)
    EXPECT_EQ(std::filesystem::file_size(file.path), file.state.size);
  EXPECT_EQ(read_box(source, {{}, volume.size}), volume.samples);
  std::mt19937_64 random(7);
  if (info.access == Access::box || info.access == Access::chunks) {
    for (int i = 0; i < 40; ++i) {
      const Box3 box = random_box(volume.size, random);
      ASSERT_EQ(read_box(source, box), volume.box(box));
    }
    return;
  }
  ASSERT_EQ(info.access, Access::stream);
  ASSERT_LT(info.largest_decode, std::uint64_t{1} << 20);
  for (const std::int64_t step : {1, 3})  // the second pass starts again at the first slice
    for (std::int64_t z = step - 1; z < volume.size.z; z += 2 * step - 1) {
      const Box3 box{{0, 0, z}, {volume.size.x, volume.size.y, std::min(z + step, volume.size.z)}};
      ASSERT_EQ(read_box(source, box), volume.box(box));
    }
}

inline VolumeGeometry geometry_of(Index3 size) {
  VolumeGeometry geometry;
  geometry.size = size;
  return geometry;
}

// What opening and reading everything says of a bad file; empty when it says nothing.
inline std::string complaint(const InputSpec& spec) {
  try {
    const auto source = open_volume(spec);
    const Box3 all{{}, source->info().geometry.size};
    if (all.count() < 1'000'000) read_box(*source, all);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 2) << error.what();
    return error.what();
  }
  return {};
}
inline std::string complaint(const std::filesystem::path& path) {
  return complaint(InputSpec{.path = path.string()});
}

inline std::unique_ptr<SampleSource> open_path(const std::filesystem::path& path) {
  return open_volume({.path = path.string()});
}

// Every one of the parts stands in what was said.
inline void expect_says(const std::string& said, std::initializer_list<std::string> parts) {
  for (const std::string& part : parts) EXPECT_THAT(said, ::testing::HasSubstr(part));
}

// Where tests write volumes. Content: text or bytes.
class VolumeFolder : public TempDirectory {
 public:
  template <class Content>
  std::unique_ptr<SampleSource> open(const std::string& name, const Content& content) const {
    return open_path(write_file(*this / name, content));
  }
  template <class Content>
  std::string complaint(const std::string& name, const Content& content) const {
    return testing::complaint(write_file(*this / name, content));
  }
  // Cut short after `begin` bytes, and after each `step` more, it is refused by its name.
  void expect_cuts_refused(const std::string& name, const Bytes& whole, std::size_t step,
                           std::size_t begin = 0) const {
    for (std::size_t size = begin; size < whole.size(); size += step)
      EXPECT_THAT(complaint(name, std::span(whole).first(size)), ::testing::HasSubstr(name))
          << size;
  }
};

// `text` with the line that starts with `line_start` replaced by `line` (dropped when empty).
inline std::string with_line(const std::string& text, const std::string& line_start,
                             const std::string& line) {
  const std::size_t at = text.find("\n" + line_start);
  if (at == std::string::npos) throw std::runtime_error("no line " + line_start);
  const std::size_t end = text.find('\n', at + 1);
  return text.substr(0, at + 1) + (line.empty() ? "" : line + "\n") + text.substr(end + 1);
}

}  // namespace voxweld::testing
