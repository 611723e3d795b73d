#include "storage/image/module_loader.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>
#include <system_error>
#include <vector>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr const char* module_file = "libvoxweld_image.so";
std::atomic<ImageModule*> loaded{nullptr};
std::mutex loading;

std::vector<std::filesystem::path> search_directories() {
  std::vector<std::filesystem::path> directories;
  if (const char* chosen = std::getenv("VOXWELD_MODULE_DIR"); chosen != nullptr && *chosen != '\0')
    directories.emplace_back(chosen);
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) {
    directories.push_back(program.parent_path());
    directories.push_back(program.parent_path().parent_path() / "lib" / "voxweld");
  }
  return directories;
}

std::filesystem::path find_module() {
  std::vector<std::string> tried;
  for (const std::filesystem::path& directory : search_directories()) {
    std::filesystem::path candidate = directory / module_file;
    std::error_code error;
    if (std::filesystem::exists(candidate, error)) return candidate;
    tried.push_back(directory.string());
  }
  throw InputError(
      fmt::format("cannot find the image module {}, needed to read and write images; looked in {}; "
                  "install it beside the program or name its directory in VOXWELD_MODULE_DIR",
                  module_file, fmt::join(tried, ", ")));
}

ImageModule* load(const std::filesystem::path& path) {
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    throw InputError(fmt::format("cannot load the image module {}: {}; is OpenImageIO installed?",
                                 path.string(), reason != nullptr ? reason : "no reason given"));
  }
  void* symbol = dlsym(handle, image_module_entry);
  ImageModule* module = symbol != nullptr
                            ? reinterpret_cast<ImageModuleEntry>(symbol)(image_module_version)
                            : nullptr;
  if (module == nullptr)
    throw InputError(
        fmt::format("the image module {} belongs to another build: expected interface {}; install "
                    "the module that came with this program",
                    path.string(), image_module_version));
  return module;
}

}  // namespace

ImageModule& image_module() {
  if (ImageModule* module = loaded.load(std::memory_order_acquire)) return *module;
  const std::lock_guard lock(loading);
  if (ImageModule* module = loaded.load(std::memory_order_relaxed)) return *module;
  ImageModule* module = load(find_module());
  loaded.store(module, std::memory_order_release);
  return *module;
}

bool image_module_loaded() {
  return loaded.load(std::memory_order_acquire) != nullptr;
}

}  // namespace voxweld
