// Writes a few brick stores, and beside each the raw samples, for other readers to be checked with
// (zarrita_check.mjs): write_sample_stores <directory>
#include <cstdio>
#include <exception>
#include <string>

#include "storage/support/file_io.h"
#include "tests/storage/store/memory_source.h"

namespace voxweld {
namespace {

struct Sample {
  const char* name;
  SampleType type;
  Index3 size;
  StoreParameters parameters;
};

void write_sample(const std::filesystem::path& directory, const Sample& sample) {
  const auto source = testing::random_source(sample.type, sample.size, 17);
  const std::string name = sample.name;
  testing::write_store(testing::layout_for(source, directory / (name + ".zarr"), sample.parameters),
                       source);
  write_whole_file(directory / (name + ".raw"), source.samples(), Durability::rename_only);
}

constexpr Sample samples[] = {
    {"lz4_uint8", SampleType::u8, {33, 40, 20}, {16, 32}},
    {"lz4_uint16", SampleType::u16, {100, 70, 65}, {32, 64}},
    {"lz4_int32", SampleType::i32, {20, 9, 33}, {8, 32}},
    {"lz4_uint64", SampleType::u64, {20, 9, 33}, {8, 32}},
    {"lz4_float64", SampleType::f64, {17, 18, 19}, {8, 16}},
    {"zstd_int16", SampleType::i16, {64, 64, 64}, {32, 64, StoreCompression::zstd, 3}},
    {"none_float32", SampleType::f32, {40, 30, 20}, {8, 16, StoreCompression::none}},
};

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_sample_stores <directory>\n");
    return 2;
  }
  try {
    for (const auto& sample : voxweld::samples) voxweld::write_sample(argv[1], sample);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
