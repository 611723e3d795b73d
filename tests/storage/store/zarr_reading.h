// Arrays of others, read whole or refused.
#pragma once

#include <gmock/gmock.h>

#include <cstring>
#include <string>
#include <vector>

#include "storage/store/open_zarr.h"
#include "storage/support/error.h"
#include "tests/storage/store/memory_source.h"

namespace voxweld::testing {

template <class T>
std::vector<T> read_all(const SampleSource& source) {
  const std::vector<std::byte> bytes = read_box(source, {{}, source.info().geometry.size});
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

// What is said of an array that cannot be read; it names the path.
inline std::string refusal(const std::filesystem::path& path) {
  try {
    read_all<std::byte>(*open_zarr(path));
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 2);
    EXPECT_THAT(error.what(), ::testing::HasSubstr(path.string()));
    return error.what();
  }
  return "accepted";
}

}  // namespace voxweld::testing
