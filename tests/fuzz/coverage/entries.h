// Every parser of voxweld as a function of bytes: what libFuzzer calls (fuzz_parsers.cpp), and what
// ctest gives the finds of earlier turns (replay_finds.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxweld::testing {

using Bytes = std::span<const std::byte>;

struct ParserEntry {
  std::string name;
  std::string ending;    // of the file the bytes become, with its dot
  std::string argument;  // meaning is the function's: the format of a volume ...
  std::string module;    // that the parser is in; empty: in the program
  // Parses. What it throws but voxweld::Error is a find. A check of the entry's own that fails
  // throws std::logic_error.
  void (*parse)(const ParserEntry& entry, Bytes bytes) = nullptr;
};

// By name. Null where there is none.
const ParserEntry* parser_named(std::string_view name);
const std::vector<ParserEntry>& parser_entries();
std::vector<ParserEntry> volume_entries();
std::vector<ParserEntry> text_entries();  // and meshes
std::vector<ParserEntry> store_entries();

// A processor's seconds that one input may take.
struct FeedLimits {
  double seconds = 1;
};
enum class FeedEnd : std::uint8_t { accepted, refused };

// Throws std::logic_error where it took longer.
FeedEnd feed(const ParserEntry& entry, Bytes bytes, const FeedLimits& limits);

// Where the files of an input lie: a folder of this process, below $TMPDIR, that goes with it.
std::filesystem::path case_folder();
// Makes the bytes a file of that ending there, or, where they are a bundle, the files of that; those
// of the last input are gone. Returns what is to be opened.
std::filesystem::path write_case(Bytes bytes, const std::string& ending);

// Several files as one text of bytes: of each a line "@@file NAME" and what it holds, up to the
// newline before the next. The first is what is opened, or, where its name has a folder, the first
// folder of it. Names are relative.
std::string bundle_of(const std::vector<std::pair<std::string, std::string>>& files);

}  // namespace voxweld::testing
