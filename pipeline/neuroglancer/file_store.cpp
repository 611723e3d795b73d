#include <fmt/format.h>

#include "pipeline/neuroglancer/object_store.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

class FileStore : public ObjectStore {
 public:
  explicit FileStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void append(std::uint64_t id, std::span<const std::byte> fragment) override {
    if (!data_) data_.emplace(folder_ / fmt::to_string(id));
    data_->append(fragment);
  }
  void finish(std::uint64_t id, std::span<const std::byte> manifest) override {
    append(id, {});  // of an object without a fragment too
    bytes_ += data_->size() + manifest.size();
    files_ += 2;
    data_->commit(Durability::rename_only);
    data_.reset();
    write_whole_file(folder_ / fmt::format("{}.index", id), manifest, Durability::rename_only);
  }
  void close() override {}

 private:
  std::filesystem::path folder_;
  std::optional<AtomicFile> data_;  // of the object under way
};

}  // namespace

std::unique_ptr<ObjectStore> file_store(const std::filesystem::path& folder) {
  return std::make_unique<FileStore>(folder);
}

}  // namespace voxweld
