// The filters against scipy.ndimage and skimage.measure (compare_filters.py).
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "storage/support/file_io.h"
#include "tests/stages/filter/plain_filters.h"
#include "tests/support/python_script.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using Json = nlohmann::json;

class ScipyCases {
 public:
  explicit ScipyCases(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Of every type into itself, small integers and floats, each filter with some parameters.
  void write() {
    for (int type = 0; type < 10; ++type)
      dispatch_sample_type(static_cast<SampleType>(type), [&](auto tag) {
        for (const Index3 size : {Index3{17, 13, 11}, Index3{3, 20, 1}, Index3{40, 2, 5}})
          write_filters<typename decltype(tag)::type>(size);
      });
    const std::string text = cases_.dump();
    write_whole_file(folder_ / "cases.json", as_bytes(text), Durability::rename_only);
  }

 private:
  template <class T>
  void write_filters(Index3 size) {
    // scipy's sums of doubles are not ours where 64-bit integers need more than 53 bits.
    auto in = testing::random_grid<T>(size, random_, false);
    if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
      for (T& v : in.values) v /= T{1} << 24;
    const SampleGrid shape{size, testing::type_of<T>()};
    for (const SampleType to : {shape.type, SampleType::u8, SampleType::f32, SampleType::f64}) {
      for (const Vec3 sigma : {Vec3{1, 1, 1}, Vec3{0.4, 0, 2.3}, Vec3{0, 3.7, 0.1}})
        add("gaussian", sigma, in, *gaussian_kernel(shape, sigma, to));
      for (const Index3 r : {splat(1), Index3{2, 0, 3}, Index3{0, 9, 1}})
        add("mean", vector_of(r), in, *mean_kernel(shape, r, to));
      const Index3 f = min(size, {2, 2, 2});
      add("block-mean", vector_of(f), in, *downsample_kernel(shape, f, DownsampleMethod::mean, to));
    }
    for (const Index3 r : {splat(1), Index3{1, 0, 1}, Index3{0, 0, 1}, splat(2), Index3{0, 2, 5}})
      add("median", vector_of(r), in, *median_kernel(shape, r));
    const Index3 f = min(size, {3, 2, 4});
    add("block-max", vector_of(f), in,
        *downsample_kernel(shape, f, DownsampleMethod::max, shape.type));
  }

  static Vec3 vector_of(Index3 p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  }

  template <class T>
  void add(const std::string& filter, Vec3 p, const testing::Grid<T>& in,
           const FilterKernel& kernel) {
    const std::string name = std::to_string(cases_.size()) + "-" + filter;
    const Box3 all{{}, kernel.output().size};
    const Box3 needs = kernel.needs(all);  // less than all where blocks leave something over
    const auto used =
        testing::Grid<T>::made(needs.size(), [&](Index3 at) { return in.at(at + needs.lo); });
    std::vector<std::byte> out(static_cast<std::size_t>(all.count()) *
                               sample_bytes(kernel.output().type));
    kernel.apply(all, std::as_bytes(std::span(used.values)), out);
    write_whole_file(folder_ / (name + ".in"), std::as_bytes(std::span(in.values)),
                     Durability::rename_only);
    write_whole_file(folder_ / (name + ".out"), out, Durability::rename_only);
    cases_.push_back({{"name", name},
                      {"filter", filter},
                      {"parameters", {p.x, p.y, p.z}},
                      {"size", {in.size.x, in.size.y, in.size.z}},
                      {"from", sample_type_name(kernel.input().type)},
                      {"to", sample_type_name(kernel.output().type)}});
  }

  std::filesystem::path folder_;
  std::mt19937_64 random_{11};
  Json cases_ = Json::array();
};

TEST(ScipyFilters, AreTheSame) {
  const auto python = testing::python_with("scipy.ndimage, skimage.measure");
  if (!python) GTEST_SKIP() << "no Python with scipy and skimage";
  const testing::TempDirectory folder;
  ScipyCases(folder.path()).write();
  const auto compare = [&] {
    return std::system((*python + " " + VOXWELD_COMPARE_FILTERS + " '" + folder.path().string() +
                        "' >'" + (folder / "log").string() + "' 2>&1")
                           .c_str());
  };
  EXPECT_EQ(0, compare()) << read_text_file(folder / "log");
  // A sample that is one off is seen.
  auto out = read_whole_file(folder / "0-gaussian.out");
  out[20] ^= std::byte{1};
  write_whole_file(folder / "0-gaussian.out", out, Durability::rename_only);
  EXPECT_NE(0, compare());
}

}  // namespace
}  // namespace voxweld
