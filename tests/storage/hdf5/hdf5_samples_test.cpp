// Samples of HDF5 files against what h5py reads of them: types, byte orders, filters, layouts.
#include <atomic>
#include <thread>

#include "tests/storage/hdf5/hdf5_files.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class Hdf5Samples : public Hdf5Files {};

TEST_F(Hdf5Samples, AllTypesInBothByteOrders) {
  const char* names[] = {"u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"};
  std::vector<std::string> files;
  for (const char* name : names)
    for (const char* order : {"<", ">"}) files.push_back(std::string("type-") + order + name);
  make(files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    expect_reads(files[i], all_types[i / 2]);
    const VolumeInfo info = open_path(path(files[i]))->info();
    EXPECT_TRUE(info.row_major) << "read in place";
    EXPECT_EQ(info.format, "hdf5");
  }
}

TEST_F(Hdf5Samples, ChunksWithFilters) {
  const std::vector<std::string> files = {
      "chunked-plain",   "chunked-gzip",       "chunked-fletcher",
      "chunked-lzf",     "chunked-lzfshuffle", "chunked-latest",
      "chunked-growing", "chunked-growing1",   "chunked-userblock"};
  make(files);
  for (const std::string& file : files) {
    expect_reads(file, SampleType::u16);
    const VolumeInfo info = open_path(path(file))->info();
    EXPECT_EQ(info.chunk, (Index3{9, 7, 5}));
    EXPECT_EQ(info.chunk_first, Index3{});
    EXPECT_FALSE(info.row_major);
    EXPECT_GE(info.largest_decode, 2U * 9 * 7 * 5 * 2);
  }
  make({"bigendian", "random", "userblock"});
  expect_reads("bigendian", SampleType::i32);
  expect_reads("random", SampleType::u8);
  expect_reads("userblock", SampleType::u16);
}

TEST_F(Hdf5Samples, ChunksThatTheLibraryDecodes) {
  make({"chunked-szip", "chunked-scaleoffset"});
  const std::string said = said_of("chunked-szip");
  if (said.empty())
    expect_reads("chunked-szip", SampleType::u16);
  else
    EXPECT_THAT(said, HasSubstr("number 4")) << "where the library comes without szip";
  expect_reads("chunked-scaleoffset", SampleType::u16);
}

TEST_F(Hdf5Samples, ChunksWithRegisteredFilters) {
  VOXWELD_NEEDS_PYTHON("h5py, numcodecs");
  const std::vector<std::string> files = {"blosc", "zstd", "lz4", "bitshuffle", "bitshuffle-lz4"};
  make(files);
  for (const std::string& file : files) expect_reads(file, SampleType::u16);
}

TEST_F(Hdf5Samples, WhatWasNeverWrittenIsTheFillValue) {
  make({"sparse", "unwritten", "huge"});
  expect_reads("sparse", SampleType::i16);
  EXPECT_THAT(open_path(path("sparse"))->info().warnings,
              Contains(HasSubstr("12 of 48 chunks are stored")));
  expect_reads("unwritten", SampleType::f32);
  const auto huge = open_path(path("huge"));
  EXPECT_EQ(huge->info().geometry.size, (Index3{10486, 10240, 10240}));
  EXPECT_LT(huge->info().largest_decode, 96U << 20);
  const Bytes last = read_box(*huge, {{10480, 10239, 10239}, {10486, 10240, 10240}});
  EXPECT_EQ(last, Bytes(6));
}

TEST_F(Hdf5Samples, TypesThatAreNoneOfOurs) {
  make({"half", "boolean", "names"});
  expect_reads("half", SampleType::f32);
  EXPECT_THAT(open_path(path("half"))->info().warnings, Contains(HasSubstr("floats of 16 bits")));
  expect_reads("boolean", SampleType::u8);
  expect_reads("names", SampleType::u8);
  for (const auto& [name, text] : {std::pair{"compound", "compound"},
                                   {"complex", "complex"},
                                   {"text", "text"},
                                   {"quad", "float"}}) {
    const std::string file = std::string("refused-") + name;
    make({file});
    expect_says(complaint(with_dataset(path(file), "data")),
                {dataset_text(path(file)), "samples are", text, "expected integers"});
    expect_says(said_of(file), {"no dataset of three dimensions of numbers", "/data", text});
  }
}

TEST_F(Hdf5Samples, OneSourceServesManyThreads) {
  make({"chunked-gzip", "chunked-scaleoffset"});
  for (const char* name : {"chunked-gzip", "chunked-scaleoffset"}) {
    const KnownVolume volume = expected(name, SampleType::u16, {33, 18, 20});
    const auto source = open_path(path(name));
    std::atomic<int> wrong = 0;
    std::vector<std::jthread> threads;
    for (unsigned seed = 0; seed < 4; ++seed)
      threads.emplace_back([&, seed] {
        std::mt19937_64 random(seed);
        for (int i = 0; i < 50; ++i) {
          const Box3 box = random_box(volume.size, random);
          if (read_box(*source, box) != volume.box(box)) ++wrong;
        }
      });
    threads.clear();
    EXPECT_EQ(wrong, 0);
  }
}

TEST_F(Hdf5Samples, FiltersThatAreNotThereAreNamed) {
  make({"filtered"});
  expect_says(said_of("filtered"),
              {dataset_text(path("filtered")), "number 32013", "HDF5_PLUGIN_PATH", "h5repack"});
}

TEST_F(Hdf5Samples, OtherFilesAreReadWhereThatIsAllowed) {
  make({"external", "outside", "virtual"});
  expect_says(said_of("external"), {path("external"), "/data leads into another file", "--follow"});
  expect_says(complaint(with_dataset(path("external"), "/data")),
              {dataset_text(path("external")), "external link", "--follow"});
  expect_says(said_of("outside"),
              {dataset_text(path("outside")), "outside.bin' outside", "--follow"});
  for (const char* name : {"external", "outside"}) {
    InputSpec spec{.path = path(name)};
    spec.follow = true;
    const auto source = open_volume(spec);
    expect_volume(*source, expected(name, SampleType::u16, {33, 18, 20}));
    EXPECT_EQ(source->info().files.size(), 2U);
  }
  expect_says(said_of("virtual"), {dataset_text(path("virtual")), "a virtual dataset", "h5py"});
}

TEST_F(Hdf5Samples, FilesOfOtherFormatsAreNamed) {
  const VolumeFolder folder;
  EXPECT_THAT(folder.complaint("a.h5", std::string("some words that are no file")),
              HasSubstr("a.h5: not an HDF5 file: expected the signature"));
  EXPECT_THAT(folder.complaint("a.mnc", std::string("CDF\1 and so on")),
              HasSubstr("mincconvert -2"));
  EXPECT_THAT(folder.complaint("a.hdf", std::string("\x0e\x03\x13\x01 and so on")),
              HasSubstr("h4toh5"));
  EXPECT_THAT(folder.complaint("empty.h5", std::string()), HasSubstr("empty.h5: not an HDF5 file"));
}

}  // namespace
}  // namespace voxweld::testing
