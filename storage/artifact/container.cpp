#include "storage/artifact/container.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "storage/support/error.h"

namespace voxweld {
namespace {

static_assert(std::endian::native == std::endian::little,
              "artifacts are written as they lie in memory");

constexpr std::array<char, 8> magic = {'V', 'O', 'X', 'W', 'E', 'L', 'D', '\x1a'};
constexpr std::size_t header_bytes = 64;

struct Header {
  std::array<char, 8> magic;
  std::array<char, 4> kind;
  std::uint32_t version;
  Hash128 key;
  std::uint64_t index_offset;
  std::uint64_t index_size;  // with its hash
  Hash128 hash;
};
static_assert(sizeof(Header) == header_bytes && std::is_trivially_copyable_v<Header>);
static_assert(sizeof(SectionRecord) == 40);

Hash128 header_hash(const Header& header) {
  return hash_bytes(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, hash)));
}

std::string kind_text(std::array<char, 4> kind) {
  return {kind.begin(), kind.end()};
}

}  // namespace

ArtifactWriter::ArtifactWriter(const std::filesystem::path& path, const ArtifactStamp& stamp)
    : file_(path), stamp_(stamp) {
  const std::array<std::byte, header_bytes> blank{};
  file_.append(blank);
}

void ArtifactWriter::begin_section(std::uint64_t name) {
  index_.push_back({name, file_.size(), 0, {}});
  open_hash_ = std::make_unique<StreamHasher>();
}

void ArtifactWriter::append(std::span<const std::byte> data) {
  open_hash_->update(data);
  file_.append(data);
}

void ArtifactWriter::end_section() {
  SectionRecord& record = index_.back();
  record.size = file_.size() - record.offset;
  record.hash = open_hash_->finish();
  open_hash_.reset();
}

void ArtifactWriter::section(std::uint64_t name, std::span<const std::byte> data) {
  index_.push_back({name, file_.size(), data.size(), hash_bytes(data)});
  file_.append(data);
}

Hash128 ArtifactWriter::commit(Durability durability) {
  std::sort(index_.begin(), index_.end(),
            [](const SectionRecord& a, const SectionRecord& b) { return a.name < b.name; });
  const auto records = std::as_bytes(std::span(index_));
  const Hash128 index_hash = hash_bytes(records);
  Header header{magic,      stamp_.kind,  stamp_.version,
                stamp_.key, file_.size(), records.size() + sizeof index_hash,
                {}};
  header.hash = header_hash(header);
  file_.append(records);
  file_.append(std::as_bytes(std::span(&index_hash, 1)));
  file_.write_at(0, std::as_bytes(std::span(&header, 1)));
  file_.commit(durability);
  return index_hash;
}

ArtifactReader::ArtifactReader(const std::filesystem::path& path, std::array<char, 4> kind,
                               std::uint32_t version)
    : file_(path) {
  Header header;
  if (file_.size() < sizeof header + sizeof(Hash128)) damaged("truncated: no room for a header");
  file_.read(0, std::as_writable_bytes(std::span(&header, 1)));
  if (header.magic != magic) damaged("not a voxweld artifact");
  if (header.hash != header_hash(header)) damaged("the header's checksum is wrong");
  if (header.kind != kind)
    damaged(
        fmt::format("is a '{}' artifact, expected '{}'", kind_text(header.kind), kind_text(kind)));
  if (header.version != version)
    damaged(fmt::format("has version {}, expected {}", header.version, version));
  if (header.index_offset < sizeof header || header.index_offset > file_.size() ||
      header.index_size < sizeof(Hash128) ||
      header.index_size != file_.size() - header.index_offset ||
      (header.index_size - sizeof(Hash128)) % sizeof(SectionRecord) != 0)
    damaged(fmt::format("has {} bytes, its header expects {}", file_.size(),
                        header.index_offset + header.index_size));
  index_.resize((header.index_size - sizeof(Hash128)) / sizeof(SectionRecord));
  file_.read(header.index_offset, std::as_writable_bytes(std::span(index_)));
  file_.read(file_.size() - sizeof content_hash_,
             std::as_writable_bytes(std::span(&content_hash_, 1)));
  if (hash_bytes(std::as_bytes(std::span(index_))) != content_hash_)
    damaged("the index's checksum is wrong");
  key_ = header.key;
}

const SectionRecord* ArtifactReader::find(std::uint64_t name) const {
  const auto at = std::lower_bound(
      index_.begin(), index_.end(), name,
      [](const SectionRecord& record, std::uint64_t n) { return record.name < n; });
  return at != index_.end() && at->name == name ? &*at : nullptr;
}

const SectionRecord& ArtifactReader::required(std::uint64_t name) const {
  const SectionRecord* record = find(name);
  if (record == nullptr) damaged(fmt::format("section {:#x} is missing", name));
  return *record;
}

void ArtifactReader::read(std::uint64_t name, std::vector<std::byte>& out) const {
  const SectionRecord& record = required(name);
  out.resize(record.size);
  read_checked(record, out);
}

void ArtifactReader::read_checked(const SectionRecord& record, std::span<std::byte> out) const {
  file_.read(record.offset, out);
  if (hash_bytes(out) != record.hash)
    damaged(fmt::format("the checksum of section {:#x} is wrong", record.name));
}

void ArtifactReader::damaged(const std::string& what) const {
  throw DamagedArtifact(file_.path(), what);
}

}  // namespace voxweld
