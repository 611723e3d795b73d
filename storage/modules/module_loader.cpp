#include "storage/modules/module_loader.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr const char* folder_variable = "VOXWELD_MODULES";

std::vector<fs::path> search_folders() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv(folder_variable); chosen != nullptr && *chosen != '\0')
    folders.emplace_back(chosen);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    folders.push_back(program.parent_path());
    folders.push_back(program.parent_path().parent_path() / "lib" / "voxweld");
  }
  return folders;
}

fs::path find_module(const std::string& file, const std::string& purpose) {
  std::vector<std::string> tried;
  for (const fs::path& folder : search_folders()) {
    fs::path candidate = folder / file;
    std::error_code error;
    if (fs::exists(candidate, error)) return candidate;
    tried.push_back(folder.string());
  }
  throw InputError(
      fmt::format("cannot find the module {}, needed to {}; looked in {}; install it in one of "
                  "these, or name its folder in {}",
                  file, purpose, fmt::join(tried, ", "), folder_variable));
}

Module* load(const fs::path& path, const std::string& purpose) {
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    throw InputError(
        fmt::format("cannot load the module {}, needed to {}: {}; install the libraries it needs, "
                    "or the module that came with this program",
                    path.string(), purpose, reason != nullptr ? reason : "no reason given"));
  }
  const auto* entry = static_cast<const ModuleEntry*>(dlsym(handle, "voxweld_module_entry"));
  if (entry == nullptr || std::strcmp(entry->version, module_version) != 0)
    throw InputError(fmt::format(
        "the module {} belongs to another build: expected interface {}, found {}; install the "
        "module that came with this program",
        path.string(), module_version, entry != nullptr ? entry->version : "none"));
  return entry->module();
}

class ModuleSource final : public SampleSource {
 public:
  explicit ModuleSource(std::unique_ptr<ModuleVolume> volume) : volume_(std::move(volume)) {}

  const VolumeInfo& info() const override { return volume_->info(); }
  void read(const Box3& box, std::byte* out) const override {
    ModuleError error;
    if (!volume_->read(box, out, error)) raise_module_error(error);
  }

 private:
  std::unique_ptr<ModuleVolume> volume_;
};

}  // namespace

void raise_module_error(const ModuleError& error) {
  if (error.kind == ModuleError::Kind::input) throw InputError(error.text);
  if (error.kind == ModuleError::Kind::storage) throw StorageError(error.text, error.error_number);
  throw FormatError(error.text);
}

Module& load_module(const std::string& name, const std::string& purpose) {
  static std::mutex loading;
  static std::map<std::string, Module*> loaded;
  const std::lock_guard lock(loading);
  Module*& module = loaded[name];
  if (module == nullptr)
    module = load(find_module(fmt::format("libvoxweld_{}.so", name), purpose), purpose);
  return *module;
}

std::unique_ptr<SampleSource> open_by_module(const VolumeReader& reader, const InputSpec& spec) {
  const std::string purpose = reader.library.empty()
                                  ? fmt::format("read {} ({})", spec.path, reader.name)
                                  : fmt::format("read {} ({}) and built where {} is installed",
                                                spec.path, reader.name, reader.library);
  Module& module = load_module(reader.module, purpose);
  const std::vector<std::string> names = module.readers();
  if (std::find(names.begin(), names.end(), reader.name) == names.end())
    throw InputError(
        fmt::format("{}: the module {} has no reader {}, but {}; install the module that came with "
                    "this program",
                    spec.path, reader.module, reader.name,
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  ModuleError error;
  std::unique_ptr<ModuleVolume> volume(module.open_volume(reader.name, spec, error));
  if (!volume) raise_module_error(error);
  return std::make_unique<ModuleSource>(std::move(volume));
}

}  // namespace voxweld
