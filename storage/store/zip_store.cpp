#include "storage/store/zip_store.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>

#include "storage/store/decompress.h"
#include "storage/store/zip_directory.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t stored = 0, deflated = 8, encrypted_flag = 1;

// zlib counts in 32 bits: long buffers go through it in windows.
std::uint32_t crc_of(std::span<const std::byte> bytes) {
  constexpr std::size_t window = std::size_t{1} << 30;
  uLong crc = crc32(0, nullptr, 0);
  while (!bytes.empty()) {
    const std::size_t part = std::min(bytes.size(), window);
    crc = crc32(crc, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(part));
    bytes = bytes.subspan(part);
  }
  return static_cast<std::uint32_t>(crc);
}

// A member whose bytes lie in the file as they are.
class StoredMember final : public StoredObject {
 public:
  StoredMember(const ReadFile& file, std::string name, std::uint64_t begin, const ZipMember& member)
      : file_(file), name_(std::move(name)), begin_(begin), size_(member.size), crc_(member.crc) {}

  const std::string& name() const override { return name_; }
  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    require_range(*this, offset, out.size());
    file_.read(begin_ + offset, out);
    if (out.size() == size_ && crc_of(out) != crc_)
      throw FormatError(name_ + ": damaged: wrong checksum of a member of a zip file");
  }

 private:
  const ReadFile& file_;
  std::string name_;
  std::uint64_t begin_, size_;
  std::uint32_t crc_;
};

class ZipStore final : public ByteStore {
 public:
  explicit ZipStore(const fs::path& path) : file_(path), members_(read_zip_directory(file_)) {}

  const std::map<std::string, ZipMember>& members() const { return members_; }

  std::string name() const override { return file_.path(); }

  std::unique_ptr<StoredObject> open(const std::string& key, ObjectUse /*use*/) const override {
    const auto found = members_.find(key);
    if (found == members_.end()) return nullptr;
    const ZipMember& member = found->second;
    const std::string name = file_.path() + '/' + key;
    if ((member.flags & encrypted_flag) != 0)
      throw FormatError(name + ": encrypted members of zip files are not supported");
    const std::uint64_t begin = zip_member_data(file_, key, member);
    if (member.method == stored) {
      if (member.packed != member.size)
        throw FormatError(fmt::format("{}: damaged: a stored member of {} bytes takes {}", name,
                                      member.size, member.packed));
      return std::make_unique<StoredMember>(file_, name, begin, member);
    }
    if (member.method == deflated) return inflate_member(name, begin, member);
    throw FormatError(
        fmt::format("{}: method {} of zip files is not supported; members must be "
                    "stored or deflated",
                    name, member.method));
  }

  // A folder is where names begin so.
  bool holds(const std::string& key) const override {
    if (key.empty() || members_.contains(key)) return true;
    const auto after = members_.lower_bound(key + '/');
    return after != members_.end() && after->first.starts_with(key + '/');
  }

  std::optional<std::vector<std::string>> list(const std::string& folder) const override {
    const std::string prefix = folder.empty() ? "" : folder + '/';
    std::vector<std::string> names;
    auto at = members_.lower_bound(prefix);
    while (at != members_.end() && at->first.starts_with(prefix)) {
      const std::string rest = at->first.substr(prefix.size());
      names.push_back(rest.substr(0, rest.find('/')));
      // Past all that begins so: '0' is the character after '/'.
      at = names.back().size() == rest.size() ? std::next(at)
                                              : members_.lower_bound(prefix + names.back() + '0');
    }
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }

  std::uint64_t object_memory(const std::string& folder) const override {
    const std::string prefix = folder.empty() ? "" : folder + '/';
    std::uint64_t most = 0;
    for (auto at = members_.lower_bound(prefix);
         at != members_.end() && at->first.starts_with(prefix); ++at)
      if (at->second.method == deflated)
        most = std::max(most, std::min(at->second.size, largest_inflated(at->second)));
    return most;
  }

  std::optional<fs::path> file_of(const std::string& /*key*/) const override {
    return std::nullopt;
  }
  InputFile input_file(const std::string& /*key*/) const override {
    return {file_.path(), file_.state()};
  }

 private:
  // deflate makes at most 1032 bytes of one.
  static std::uint64_t largest_inflated(const ZipMember& member) {
    constexpr std::uint64_t ratio = 1032, slack = 64;
    return member.packed > (std::uint64_t{1} << 50) ? member.packed : member.packed * ratio + slack;
  }

  std::unique_ptr<StoredObject> inflate_member(const std::string& name, std::uint64_t begin,
                                               const ZipMember& member) const {
    if (member.size > largest_inflated(member))
      throw FormatError(fmt::format("{}: damaged: {} bytes cannot inflate to {}", name,
                                    member.packed, member.size));
    if (member.size == 0) return held_object(name, {});
    std::vector<std::byte> packed(member.packed), bytes(member.size);
    file_.read(begin, packed);
    if (const std::string wrong = inflate_all(packed, bytes, true); !wrong.empty())
      throw FormatError(name + ": damaged member of a zip file: " + wrong);
    if (crc_of(bytes) != member.crc)
      throw FormatError(name + ": damaged: wrong checksum of a member of a zip file");
    return held_object(name, std::move(bytes));
  }

  ReadFile file_;
  std::map<std::string, ZipMember> members_;
};

}  // namespace

bool looks_zip(std::span<const std::byte> head) {
  constexpr std::array member{std::byte{'P'}, std::byte{'K'}, std::byte{3}, std::byte{4}};
  return head.size() >= member.size() && std::equal(member.begin(), member.end(), head.begin());
}

bool is_zip_file(const fs::path& path) {
  const ReadFile file(path);
  std::vector<std::byte> head(std::min<std::uint64_t>(4, file.size()));
  file.read(0, head);
  return looks_zip(head);
}

std::shared_ptr<const ByteStore> zip_store(const fs::path& file) {
  return std::make_shared<ZipStore>(file);
}

std::vector<std::string> zip_member_names(const fs::path& file) {
  std::vector<std::string> names;
  const ReadFile zip(file);
  for (const auto& [name, member] : read_zip_directory(zip)) names.push_back(name);
  return names;
}

}  // namespace voxweld
