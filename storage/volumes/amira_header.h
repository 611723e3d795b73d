// What an Amira file says about itself, and where its streams of values lie.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/types/box.h"
#include "storage/volumes/array_choice.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {

struct AmiraArray {
  FileArray array;
  std::string of;           // what has these values: "Lattice", "Vertices" ...
  std::int64_t stream = 0;  // its number: 1 of "@1"
  DataEncoding encoding = DataEncoding::raw;
  std::optional<std::uint64_t> stored_bytes{};  // where it is compressed
};

struct AmiraHeader {
  bool text = false;
  std::endian byte_order = std::endian::big;
  std::map<std::string, std::vector<std::int64_t>> sizes;  // of what is defined: Lattice, Vertices
  std::vector<AmiraArray> arrays;                          // in the order of the header
  std::string coordinates;                                 // CoordType; empty: not said
  std::optional<std::array<double, 6>> bounds{};  // of the samples' places: x0 x1 y0 y1 z0 z1
  std::string unit;
  std::vector<std::string> materials;
  std::uint64_t data = 0;  // offset of the line of the first stream, "@1"
};

// FormatError for what is no Amira file, or damaged.
AmiraHeader read_amira_header(const ReadFile& file);

// The offset of the first value of a stream. Those before it are passed, of text line by line.
// FormatError where it is not there.
std::uint64_t find_amira_stream(const ReadFile& file, const AmiraHeader& header,
                                std::int64_t stream);

}  // namespace voxweld
