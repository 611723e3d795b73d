#include "storage/artifact/container.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "storage/support/error.h"
#include "storage/support/provenance.h"

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

struct Origin {
  Hash128 input_stamp;
  std::uint64_t text_size;
};
static_assert(sizeof(Origin) == 24 && std::is_trivially_copyable_v<Origin>);

std::vector<std::byte> origin_bytes(Hash128 input_stamp, const std::string& text) {
  const Origin origin{input_stamp, text.size()};
  std::vector<std::byte> bytes(sizeof origin + text.size() + sizeof(Hash128));
  std::memcpy(bytes.data(), &origin, sizeof origin);
  std::memcpy(bytes.data() + sizeof origin, text.data(), text.size());
  const Hash128 hash = hash_bytes(std::span(bytes).first(sizeof origin + text.size()));
  std::memcpy(bytes.data() + sizeof origin + text.size(), &hash, sizeof hash);
  return bytes;
}

std::string kind_text(std::array<char, 4> kind) {
  return {kind.begin(), kind.end()};
}

// Takes off a hash that stands behind the rest.
Hash128 hash_behind(std::span<const std::byte>& bytes) {
  Hash128 hash;
  const std::span<const std::byte> last = bytes.last(sizeof hash);
  std::memcpy(&hash, last.data(), sizeof hash);
  bytes = bytes.first(bytes.size() - sizeof hash);
  return hash;
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
  file_.append(origin_bytes(input_stamp_, provenance_json()));
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
      header.index_size > file_.size() - header.index_offset ||
      (header.index_size - sizeof(Hash128)) % sizeof(SectionRecord) != 0)
    damaged(fmt::format("has {} bytes, its header expects more than {}", file_.size(),
                        header.index_offset + header.index_size));
  const std::uint64_t behind = file_.size() - (header.index_offset + header.index_size);
  constexpr std::uint64_t most = 1 << 20;
  if (behind < sizeof(Origin) + sizeof(Hash128)) damaged("truncated: who made it is missing");
  if (behind > most) damaged(fmt::format("has {} bytes after its index", behind));
  // All at once: on a network file system each look takes its time.
  std::vector<std::byte> rest(header.index_size + behind);
  file_.read(header.index_offset, rest);
  const std::span<const std::byte> all(rest);
  read_index(all.first(header.index_size));
  read_origin(all.subspan(header.index_size));
  key_ = header.key;
}

void ArtifactReader::read_index(std::span<const std::byte> bytes) {
  content_hash_ = hash_behind(bytes);
  index_.resize(bytes.size() / sizeof(SectionRecord));
  if (!index_.empty()) std::memcpy(index_.data(), bytes.data(), bytes.size());
  if (hash_bytes(bytes) != content_hash_) damaged("the index's checksum is wrong");
}

void ArtifactReader::read_origin(std::span<const std::byte> bytes) {
  const Hash128 hash = hash_behind(bytes);
  if (hash_bytes(bytes) != hash) damaged("the checksum of who made it is wrong");
  Origin origin;
  std::memcpy(&origin, bytes.data(), sizeof origin);
  input_stamp_ = origin.input_stamp;
  provenance_.assign(reinterpret_cast<const char*>(bytes.data()) + sizeof origin,
                     bytes.size() - sizeof origin);
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

void ArtifactReader::read(std::uint64_t name, std::span<std::byte> out) const {
  const SectionRecord& record = required(name);
  if (record.size != out.size()) damaged(fmt::format("section {:#x} has an odd size", name));
  read_checked(record, out);
}

void ArtifactReader::read_checked(const SectionRecord& record, std::span<std::byte> out) const {
  file_.read(record.offset, out);
  if (hash_bytes(out) != record.hash)
    damaged(fmt::format("the checksum of section {:#x} is wrong", record.name));
}

void ArtifactReader::read_part(std::uint64_t name, std::uint64_t offset,
                               std::span<std::byte> out) const {
  const SectionRecord& record = required(name);
  if (offset > record.size || out.size() > record.size - offset)
    damaged(fmt::format("section {:#x} is shorter than what refers to it", name));
  file_.read(record.offset + offset, out);
}

void ArtifactReader::damaged(const std::string& what) const {
  throw DamagedArtifact(file_.path(), what);
}

void restamp_artifact(const std::filesystem::path& path, Hash128 input_stamp) {
  const ReadFile file(path);
  Header header;
  if (file.size() < sizeof header) throw DamagedArtifact(path.string(), "truncated");
  file.read(0, std::as_writable_bytes(std::span(&header, 1)));
  const ArtifactReader reader(path, header.kind, header.version);
  AtomicFile out(path);
  std::vector<std::byte> piece(std::size_t{1} << 20);
  const std::uint64_t end = header.index_offset + header.index_size;
  for (std::uint64_t at = 0; at < end; at += piece.size()) {
    piece.resize(std::min<std::uint64_t>(piece.size(), end - at));
    file.read(at, piece);
    out.append(piece);
  }
  out.append(origin_bytes(input_stamp, reader.provenance()));
  out.commit(Durability::rename_only);
}

}  // namespace voxweld
