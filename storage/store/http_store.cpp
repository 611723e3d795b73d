#include "storage/store/http_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>

#include "storage/http/http_service.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/error.h"
#include "storage/support/hash.h"

namespace voxweld {
namespace {

constexpr std::uint64_t largest_fetch = std::uint64_t{32} << 20;

// As a path of an address: all but letters, digits and these marks in percent codes.
std::string escaped(const std::string& key) {
  constexpr std::string_view plain = "-._~/";
  std::string text;
  for (const char c : key) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || plain.find(c) != std::string_view::npos)
      text += c;
    else
      text += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

// Small ranges lie side by side in shards, and each request is a journey: they are cut from blocks,
// of which some are kept.
constexpr std::uint64_t block_bytes = std::uint64_t{1} << 20;
constexpr std::size_t kept_blocks = 32;
using Block = std::vector<std::byte>;
using BlockCache = BoundedCache<Block>;

class RangedObject final : public StoredObject {
 public:
  RangedObject(std::string name, std::uint64_t size, std::shared_ptr<BlockCache> blocks)
      : name_(std::move(name)), size_(size), blocks_(std::move(blocks)) {
    static std::atomic<std::uint64_t> objects = 0;
    id_ = objects.fetch_add(1, std::memory_order_relaxed);
  }
  const std::string& name() const override { return name_; }
  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    require_range(*this, offset, out.size());
    if (out.size() > block_bytes) return fetch(offset, out);
    while (!out.empty()) {
      const std::uint64_t number = offset / block_bytes, begin = number * block_bytes;
      const auto block = blocks_->get(id_ << 32 | number, [&] {
        auto bytes = std::make_shared<Block>(std::min(block_bytes, size_ - begin));
        fetch(begin, *bytes);
        return bytes;
      });
      const std::size_t part = std::min<std::size_t>(out.size(), block->size() - (offset - begin));
      std::memcpy(out.data(), block->data() + (offset - begin), part);
      out = out.subspan(part);
      offset += part;
    }
  }

 private:
  void fetch(std::uint64_t offset, std::span<std::byte> out) const {
    const HttpAnswer answer =
        send_http({.url = name_,
                   .range = HttpRequest::Range{offset, out.size()},
                   .most_bytes = std::max<std::uint64_t>(largest_fetch, out.size())});
    // A server may answer a range with the whole.
    const std::uint64_t begin = answer.status == 206 ? 0 : offset;
    const bool longer = answer.status == 206 && answer.body.size() > out.size();
    if (!answer.found() || longer || answer.body.size() < begin + out.size())
      throw FormatError(fmt::format("{}: {} bytes wanted at {}, the server gives {}", name_,
                                    out.size(), offset, answer.body.size()));
    std::memcpy(out.data(), answer.body.data() + begin, out.size());
  }

  std::string name_;
  std::uint64_t size_, id_ = 0;
  std::shared_ptr<BlockCache> blocks_;
};

class HttpStore final : public ByteStore {
 public:
  HttpStore(std::string base, std::string query)
      : base_(std::move(base)), query_(std::move(query)) {
    while (base_.ends_with('/')) base_.pop_back();
  }

  std::string name() const override { return base_; }

  std::unique_ptr<StoredObject> open(const std::string& key, ObjectUse use) const override {
    HttpRequest request{.url = address(key), .most_bytes = largest_fetch};
    // The answer to the first byte tells how many there are.
    if (use == ObjectUse::ranges) request.range = HttpRequest::Range{0, 1};
    HttpAnswer answer = send_http(request);
    if (!answer.found()) return nullptr;
    if (answer.status == 200) return held_object(request.url, std::move(answer.body));
    if (!answer.size)
      throw FormatError(request.url +
                        ": the server gives a byte range and does not say of how many "
                        "bytes; download it and read it from a disk");
    return std::make_unique<RangedObject>(request.url, *answer.size, blocks_);
  }

  bool holds(const std::string& key) const override { return key.empty() || look(key).found(); }

  std::optional<std::vector<std::string>> list(const std::string& /*folder*/) const override {
    return std::nullopt;
  }

  // A chunk that is fetched whole.
  std::uint64_t object_memory(const std::string& /*folder*/) const override {
    return largest_fetch;
  }

  std::optional<std::filesystem::path> file_of(const std::string& /*key*/) const override {
    return std::nullopt;
  }

  // In place of times what the server calls the version.
  InputFile input_file(const std::string& key) const override {
    const HttpAnswer answer = look(key);
    const Hash128 version = KeyHasher().text(answer.etag).text(answer.modified).finish();
    return {address(key),
            {answer.size.value_or(0), static_cast<std::int64_t>(version.lo),
             static_cast<std::int64_t>(version.hi)}};
  }

  Above above() const override {
    const std::size_t host = base_.find("//") + 2, slash = base_.rfind('/');
    if (slash == std::string::npos || slash < host) return {};
    return {std::make_shared<HttpStore>(base_.substr(0, slash), query_), base_.substr(slash + 1)};
  }

 private:
  std::string address(const std::string& key) const {
    return (key.empty() ? base_ : base_ + '/' + escaped(key)) + query_;
  }

  // Some servers answer no HEAD.
  HttpAnswer look(const std::string& key) const {
    HttpRequest request{.url = address(key), .method = HttpRequest::Method::head};
    try {
      return send_http(request);
    } catch (const InputError&) {
      request.method = HttpRequest::Method::get;
      request.range = HttpRequest::Range{0, 1};
      return send_http(request);
    }
  }

  std::string base_, query_;
  std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>(kept_blocks);
};

}  // namespace

std::shared_ptr<const ByteStore> http_store(const std::string& url) {
  const std::size_t question = std::min(url.find('?'), url.size());
  return std::make_shared<HttpStore>(url.substr(0, question), url.substr(question));
}

}  // namespace voxweld
