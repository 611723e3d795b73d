// A module that reads a format nobody has: "MADE-UP x y z" on a line, then samples of 8 bits.
#include <new>
#include <sstream>
#include <stdexcept>

#include "storage/modules/reader_module.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

class MadeUpSource final : public SampleSource {
 public:
  explicit MadeUpSource(const std::string& path) : file_(path) {
    std::string line(static_cast<std::size_t>(std::min<std::uint64_t>(64, file_.size())), ' ');
    file_.read(0, std::as_writable_bytes(std::span(line)));
    line.resize(std::min(line.find('\n'), line.size()));
    std::string magic;
    Index3& size = info_.geometry.size;
    std::istringstream words(line);
    words >> magic >> size.x >> size.y >> size.z;
    if (!words) throw FormatError(path + ": no sizes in its first line");
    if (size.z == 0) throw InputError(path + ": has no slices");
    if (size.z == -1) throw std::bad_alloc();
    if (size.z == -2) throw std::runtime_error("a library's words");
    if (size.z == -3) throw 3;
    info_.format = "made_up";
    info_.files.push_back({path, file_.state()});
    info_.warnings.push_back(path + ": of a format nobody has");
    first_ = line.size() + 1;
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    const Index3 size = info_.geometry.size;
    const auto row = static_cast<std::size_t>(box.hi.x - box.lo.x);
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, out += row) {
        const auto at = static_cast<std::uint64_t>((z * size.y + y) * size.x + box.lo.x);
        if (first_ + at + row > file_.size()) throw FormatError(file_.path() + ": is cut short");
        file_.read(first_ + at, std::span(out, row));
      }
  }

 private:
  ReadFile file_;
  VolumeInfo info_;
  std::uint64_t first_ = 0;
};

Module* module() {
  static ReaderModule made_up({{"made_up", {}, {}, [](const InputSpec& spec) {
                                  return std::make_unique<MadeUpSource>(spec.path);
                                }}});
  return &made_up;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::module};
