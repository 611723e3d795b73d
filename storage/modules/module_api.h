// The contract between the program and its modules: libraries it loads when it first needs them, so
// that only runs that read such files pay for what reads them (OpenImageIO costs 120 MiB).
// Both are built from one tree, so C++ types cross freely; exceptions do not: a call that can fail
// returns false or null and says why. A module that reads volumes is best made of a ReaderModule
// (reader_module.h), whose readers throw as those of the program do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "storage/types/volume_reader.h"

namespace voxweld {

// Why a call failed, and what the program throws for it.
struct ModuleError {
  enum class Kind : std::uint8_t { input, format, storage };
  Kind kind = Kind::format;
  std::string text{};
  int error_number = 0;  // of Kind::storage: an errno value, or 0
};

// An open volume. Calls come as those of a SampleSource do: from many threads with Access::box.
class ModuleVolume {
 public:
  virtual ~ModuleVolume() = default;
  virtual const VolumeInfo& info() const = 0;
  // As SampleSource::read().
  virtual bool read(const Box3& box, std::byte* out, ModuleError& error) const = 0;
};

class HttpService;    // storage/http/http_service.h
class ImageService;   // storage/image/image_service.h
class ServerService;  // pipeline/view/http_server.h

class Module {
 public:
  virtual ~Module() = default;
  // The readers it has, by the names of their rows in the table of storage/readers.
  virtual std::vector<std::string> readers() const { return {}; }
  // The volume is the caller's; null where that fails. Precondition: the reader is one of these.
  virtual ModuleVolume* open_volume(const std::string& /*reader*/, const InputSpec& /*spec*/,
                                    ModuleError& /*error*/) {
    return nullptr;
  }
  // Null where the module knows nothing of images.
  virtual ImageService* images() { return nullptr; }
  // Null where it sends no requests.
  virtual HttpService* http() { return nullptr; }
  // Null where it answers none.
  virtual ServerService* server() { return nullptr; }
};

// What a module exports. The version comes first whatever the version is.
struct ModuleEntry {
  const char* version;  // module_version, as the module was built
  Module* (*module)();  // always the same one; called where the version is the program's own
};
inline constexpr const char* module_version = VOXWELD_VERSION "/5";

}  // namespace voxweld

// Defined by each module, in the file libvoxweld_NAME.so.
extern "C" __attribute__((visibility("default"))) const voxweld::ModuleEntry voxweld_module_entry;
