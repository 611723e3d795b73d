// libFuzzer's way in. VOXWELD_PARSER names the entry; VOXWELD_PARSE_SECONDS is a processor's seconds
// that an input may take.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <pthread.h>

#include "tests/fuzz/coverage/entries.h"

extern "C" void __sanitizer_set_death_callback(void (*callback)());

namespace voxweld::testing {
namespace {

const ParserEntry* chosen = nullptr;
FeedLimits limits;

void choose_parser() {
  const char* name = std::getenv("VOXWELD_PARSER");
  if (name != nullptr) chosen = parser_named(name);
  if (chosen == nullptr) {
    std::fprintf(stderr, "VOXWELD_PARSER has to name one of\n");
    for (const ParserEntry& entry : parser_entries())
      std::fprintf(stderr, "%s %s\n", entry.name.c_str(), entry.module.c_str());
    std::exit(2);
  }
  const char* seconds = std::getenv("VOXWELD_PARSE_SECONDS");
  limits.seconds = seconds != nullptr ? std::atof(seconds) : 5;
  // A library that fails in a child where it is tried out is no find: the child must not write one.
  pthread_atfork(nullptr, nullptr, [] { __sanitizer_set_death_callback(nullptr); });
}

}  // namespace
}  // namespace voxweld::testing

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  voxweld::testing::choose_parser();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace voxweld::testing;
  try {
    feed(*chosen, std::as_bytes(std::span(data, size)), limits);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "find: %s\n", error.what());
    std::abort();
  }
  return 0;
}
