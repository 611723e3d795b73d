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

// False, and why in `error`, where the call throws.
template <class Call>
bool guarded(ModuleError& error, const Call& call) try {
  call();
  return true;
} catch (const InputError& failure) {
  error = {Kind::input, failure.what()};
  return false;
} catch (const StorageError& failure) {
  error = {Kind::storage, failure.what(), failure.error_number()};
  return false;
} catch (const std::bad_alloc&) {
  error = {Kind::storage, "out of memory; lower run.memory or run.threads", ENOMEM};
  return false;
} catch (const std::exception& failure) {  // of a library: something about the file
  error = {Kind::format, failure.what()};
  return false;
}

class SourceVolume final : public ModuleVolume {
 public:
  explicit SourceVolume(std::unique_ptr<SampleSource> source) : source_(std::move(source)) {}

  const VolumeInfo& info() const override { return source_->info(); }
  bool read(const Box3& box, std::byte* out, ModuleError& error) const override {
    return guarded(error, [&] { source_->read(box, out); });
  }

 private:
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
  guarded(error, [&] { volume = std::make_unique<SourceVolume>(row->open(spec)); });
  return volume.release();
}

}  // namespace voxweld
