// Zip files as stores of named ranges: what zarr-python's ZipStore and OME's .ozx are.
// Specification: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", 6.3.10: the central
// directory, zip64, members that are stored or deflated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "storage/store/byte_store.h"

namespace voxweld {

// Whether a file begins as a zip file does.
bool looks_zip(std::span<const std::byte> head);
bool is_zip_file(const std::filesystem::path& path);

// Ranges of stored members are read where they lie; deflated members are inflated whole when they
// are opened, and checked against their CRC-32, as are all that are read as ObjectUse::whole. Every
// place and size is checked against the file before it is used. FormatError for damage, encrypted
// members and other ways of compression, naming the member.
std::shared_ptr<const ByteStore> zip_store(const std::filesystem::path& file);

// Of all members that are no folders. Errors as zip_store.
std::vector<std::string> zip_member_names(const std::filesystem::path& file);

}  // namespace voxweld
