#include "storage/modules/reader_module.h"

#include <algorithm>
#include <cerrno>
#include <exception>
#include <memory>
#include <new>

#include "storage/support/error.h"

namespace voxweld {
namespace {

using Kind = ModuleError::Kind;

// False, and why in `error`, where the call throws. What is not ours does not name the file.
template <class Call>
bool guarded(const std::string& path, ModuleError& error, const Call& call) try {
  call();
  return true;
} catch (const InputError& failure) {
  error = {Kind::input, failure.what()};
  return false;
} catch (const StorageError& failure) {
  error = {Kind::storage, failure.what(), failure.error_number()};
  return false;
} catch (const Error& failure) {
  error = {Kind::format, failure.what()};
  return false;
} catch (const std::bad_alloc&) {
  error = {Kind::storage, path + ": out of memory; lower run.memory or run.threads", ENOMEM};
  return false;
} catch (const std::exception& failure) {
  error = {Kind::format, path + ": cannot be read: " + failure.what()};
  return false;
} catch (...) {
  error = {Kind::format, path + ": cannot be read, and its library does not say why"};
  return false;
}

class SourceVolume final : public ModuleVolume {
 public:
  SourceVolume(std::string path, std::unique_ptr<SampleSource> source)
      : path_(std::move(path)), source_(std::move(source)) {}

  const VolumeInfo& info() const override { return source_->info(); }
  bool read(const Box3& box, std::byte* out, ModuleError& error) const override {
    return guarded(path_, error, [&] { source_->read(box, out); });
  }

 private:
  std::string path_;
  std::unique_ptr<SampleSource> source_;
};

}  // namespace

std::vector<std::string> ReaderModule::readers() const {
  std::vector<std::string> names;
  for (const VolumeReader& row : rows_) names.push_back(row.name);
  return names;
}

ModuleVolume* ReaderModule::open_volume(const std::string& reader, const InputSpec& spec,
                                        ModuleError& error) {
  const auto row = std::ranges::find(rows_, reader, &VolumeReader::name);
  std::unique_ptr<ModuleVolume> volume;
  guarded(spec.path, error,
          [&] { volume = std::make_unique<SourceVolume>(spec.path, row->open(spec)); });
  return volume.release();
}

}  // namespace voxweld
