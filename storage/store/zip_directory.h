// The list of members at the end of a zip file.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "storage/support/file_io.h"

namespace voxweld {

struct ZipMember {
  std::uint64_t offset = 0;  // of its local header
  std::uint64_t packed = 0;  // bytes in the file
  std::uint64_t size = 0;    // bytes of the member
  std::uint32_t crc = 0;
  std::uint16_t method = 0, flags = 0;
};

// By name; folders, whose names end in "/", are left out. FormatError for what is damaged or spans
// several files. Memory is a few times the list's own bytes.
std::map<std::string, ZipMember> read_zip_directory(const ReadFile& file);

// Where the bytes of the member begin. FormatError where its header is none, or its bytes lie beyond
// the file's end.
std::uint64_t zip_member_data(const ReadFile& file, const std::string& name,
                              const ZipMember& member);

}  // namespace voxweld
