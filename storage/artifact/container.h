// The file every artifact of ours is: named sections, each with its own checksum, found through an
// index at the end. Little-endian.
//
//   offset 0   header, 64 bytes: magic "VOXWELD\x1a", kind (4 characters), version u32,
//              key 16 bytes, index offset u64, index size u64, header hash (XXH3-128 of the
//              48 bytes before it), written last
//   offset 64  sections, back to back, no padding
//   then       index: one 40-byte record a section (name u64, offset u64, size u64, XXH3-128),
//              then XXH3-128 of those records
//   end        origin: input stamp 16 bytes, text size u64, text (JSON: who made it, when, where;
//              support/provenance.h), then XXH3-128 of all that
//
// Any truncation is seen on opening, any flipped bit by the hash of the header, of the index, of
// the origin, or of the section it lies in. Contents are what the sections hold: the origin is in
// no content hash, so the same work done elsewhere or later leaves the same contents.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"

namespace voxweld {

// What a file is and which inputs and parameters it was made from.
struct ArtifactStamp {
  std::array<char, 4> kind{};  // "octr", "tops", ...
  std::uint32_t version = 0;   // of the format and of the stage that writes it
  Hash128 key;                 // DESIGN: commits and resume
};

struct SectionRecord {
  std::uint64_t name = 0;  // meaning is the format's; unique in a file, ascending in the index
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  Hash128 hash;
};

// What a section of these values holds.
template <class T>
std::span<const std::byte> as_section(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}
// And of one record.
template <class T>
std::span<const std::byte> as_record(const T& record) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span(&record, 1));
}

class ArtifactWriter {
 public:
  ArtifactWriter(const std::filesystem::path& path, const ArtifactStamp& stamp);

  // Appends one section. Names may come in any order.
  void section(std::uint64_t name, std::span<const std::byte> data);
  // The same in pieces: begin, any number of append, end.
  void begin_section(std::uint64_t name);
  void append(std::span<const std::byte> data);
  void end_section();

  // The state of the inputs (paths, sizes, times) the contents were made from, or last compared
  // with; zero where nobody asks.
  void set_input_stamp(Hash128 stamp) { input_stamp_ = stamp; }
  // Writes index, origin and header and renames into place. Returns the hash of the index: the
  // artifact's content hash, since it covers the hash of every section.
  Hash128 commit(Durability durability = Durability::rename_only);

 private:
  AtomicFile file_;
  ArtifactStamp stamp_;
  Hash128 input_stamp_;
  std::vector<SectionRecord> index_;
  std::unique_ptr<StreamHasher> open_hash_;
};

class ArtifactReader {
 public:
  // Opens and checks header and index. DamagedArtifact when they fail, or when kind or version is
  // another; StorageError when the file cannot be opened.
  ArtifactReader(const std::filesystem::path& path, std::array<char, 4> kind,
                 std::uint32_t version);

  const std::string& path() const { return file_.path(); }
  const Hash128& key() const { return key_; }
  const Hash128& content_hash() const { return content_hash_; }
  const Hash128& input_stamp() const { return input_stamp_; }
  const std::string& provenance() const { return provenance_; }  // JSON
  std::span<const SectionRecord> sections() const { return index_; }
  const SectionRecord* find(std::uint64_t name) const;

  // Reads one section and checks its hash; DamagedArtifact when absent or wrong.
  void read(std::uint64_t name, std::vector<std::byte>& out) const;
  // The same into memory of the section's size.
  void read(std::uint64_t name, std::span<std::byte> out) const;
  template <class T>
  void read_array(std::uint64_t name, std::vector<T>& out) const;
  template <class T>
  std::vector<T> read_array(std::uint64_t name) const {
    std::vector<T> values;
    read_array(name, values);
    return values;
  }
  // A section of one record. otherwise: what is wrong where it is none.
  template <class T>
  T read_record(std::uint64_t name, const char* otherwise) const {
    const std::vector<T> records = read_array<T>(name);
    if (records.size() != 1) damaged(otherwise);
    return records[0];
  }

  // Reads part of a section, unchecked: for sections whose parts have checksums of their own.
  void read_part(std::uint64_t name, std::uint64_t offset, std::span<std::byte> out) const;

  [[noreturn]] void damaged(const std::string& what) const;

 private:
  void read_checked(const SectionRecord& record, std::span<std::byte> out) const;
  const SectionRecord& required(std::uint64_t name) const;
  void read_index(std::span<const std::byte> bytes);
  void read_origin(std::span<const std::byte> bytes);

  ReadFile file_;
  Hash128 key_, content_hash_, input_stamp_;
  std::string provenance_;
  std::vector<SectionRecord> index_;
};

// What the readers of all kinds can say of their file.
class OpenArtifact {
 public:
  const std::string& path() const { return file_.path(); }
  const Hash128& key() const { return file_.key(); }
  const Hash128& content_hash() const { return file_.content_hash(); }
  const Hash128& input_stamp() const { return file_.input_stamp(); }
  const std::string& provenance() const { return file_.provenance(); }  // JSON

 protected:
  OpenArtifact(const std::filesystem::path& path, std::array<char, 4> kind, std::uint32_t version)
      : file_(path, kind, version) {}
  ArtifactReader file_;
};

// Writes the artifact again, the same but for its input stamp: what it was compared with since.
// DamagedArtifact when its origin fails its checks.
void restamp_artifact(const std::filesystem::path& path, Hash128 input_stamp);

// Whether the artifact is there and whole, and is_so(), which opens it and may read others. Damage
// of those is thrown on.
template <class F>
bool is_current(const std::filesystem::path& path, F&& is_so) {
  if (!std::filesystem::exists(path)) return false;
  try {
    return is_so();
  } catch (const DamagedArtifact& damage) {
    if (damage.path() != path.string()) throw;
    return false;
  }
}

template <class T>
void ArtifactReader::read_array(std::uint64_t name, std::vector<T>& out) const {
  static_assert(std::is_trivially_copyable_v<T>);
  const SectionRecord& record = required(name);
  if (record.size % sizeof(T) != 0) damaged("a section has an odd size");
  out.resize(record.size / sizeof(T));
  read_checked(record, std::as_writable_bytes(std::span(out)));
}

}  // namespace voxweld
