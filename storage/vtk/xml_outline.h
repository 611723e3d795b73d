// The markup of an XML file whose texts may be larger than memory, and where these texts lie.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "storage/support/file_io.h"

namespace voxweld {

struct XmlOutline {
  // The tags, without comments. Each text that is not blank is replaced by two numbers: the file
  // offsets of its first byte that is not blank, and of the '<' behind it.
  std::string markup;
  // Of an AppendedData element, which ends the XML proper: the offset behind its start tag. `markup`
  // has it without content.
  std::optional<std::uint64_t> appended;
};

// Reads from the start to the end tag `root`, or to the start of AppendedData. The whole file may be
// read, but little is held. FormatError: truncated, a DTD or CDATA, more markup than 64 MiB.
XmlOutline read_xml_outline(const ReadFile& file, const std::string& root);

}  // namespace voxweld
