// The module "http": requests by libcurl.
#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>

#include "storage/http/http_service.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::chrono::milliseconds first_pause{250};
constexpr std::chrono::seconds longest_pause{20};
constexpr long connect_seconds = 20, stalled_seconds = 60, most_redirects = 8;

struct FreeHandle {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
};
using Handle = std::unique_ptr<CURL, FreeHandle>;

// Handles keep their connections, so they are lent and given back.
class Handles {
 public:
  Handles() { curl_global_init(CURL_GLOBAL_DEFAULT); }
  Handle take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) return Handle(curl_easy_init());
    Handle handle = std::move(free_.back());
    free_.pop_back();
    return handle;
  }
  void give_back(Handle handle) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(handle));
  }

 private:
  std::mutex mutex_;
  std::vector<Handle> free_;
};

// One answer while it comes in.
struct Reception {
  const HttpRequest& request;
  HttpAnswer answer{};
  bool too_large = false;
  bool no_ranges = false;                 // a range was asked for, and the whole comes
  std::optional<std::uint64_t> length{};  // of what comes
  std::chrono::seconds retry_after{0};
};

std::optional<std::uint64_t> number_of(std::string_view text) {
  const auto value = parse_integer(text);
  return value && *value >= 0 ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
}

// A header line. A status line begins the headers of another answer, after a redirect.
std::size_t take_header(const char* data, std::size_t size, std::size_t count, void* user) {
  auto& in = *static_cast<Reception*>(user);
  const std::string_view line(data, size * count);
  if (line.starts_with("HTTP/")) {
    in.answer = {};
    in.length.reset();
  }
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return line.size();
  const std::string name = lower(line.substr(0, colon));
  const std::string value(trim(line.substr(colon + 1)));
  if (name == "etag") in.answer.etag = value;
  if (name == "last-modified") in.answer.modified = value;
  if (name == "content-length") in.length = number_of(value);
  if (name == "retry-after") in.retry_after = std::chrono::seconds(number_of(value).value_or(0));
  // "bytes 0-99/1234": the size of the whole comes last.
  if (name == "content-range" && value.find('/') != std::string::npos)
    in.answer.size = number_of(std::string_view(value).substr(value.find('/') + 1));
  return line.size();
}

std::size_t take_body(const char* data, std::size_t size, std::size_t count, void* user) {
  auto& in = *static_cast<Reception*>(user);
  const std::size_t bytes = size * count;
  const std::uint64_t have = in.answer.body.size();
  if (have + bytes > in.request.most_bytes || in.length.value_or(0) > in.request.most_bytes) {
    in.too_large = true;
    return 0;
  }
  const auto* first = reinterpret_cast<const std::byte*>(data);
  in.answer.body.insert(in.answer.body.end(), first, first + bytes);
  return bytes;
}

bool may_pass(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_CONNECT:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_PARTIAL_FILE:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
    case CURLE_SSL_CONNECT_ERROR:
      return true;
    default:
      return false;
  }
}

bool may_pass(int status) {
  return status == 408 || status == 429 || (status >= 500 && status != 501 && status != 505);
}

CURLcode perform(CURL* handle, Reception& in) {
  const HttpRequest& request = in.request;
  curl_easy_reset(handle);
  curl_easy_setopt(handle, CURLOPT_URL, request.url.c_str());
  curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);  // threads
  curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(handle, CURLOPT_MAXREDIRS, most_redirects);
  curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, connect_seconds);
  curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, stalled_seconds);
  curl_easy_setopt(handle, CURLOPT_USERAGENT, "voxweld/" VOXWELD_VERSION);
  curl_easy_setopt(handle, CURLOPT_HEADERFUNCTION, take_header);
  curl_easy_setopt(handle, CURLOPT_HEADERDATA, &in);
  curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, take_body);
  curl_easy_setopt(handle, CURLOPT_WRITEDATA, &in);
  if (request.method == HttpRequest::Method::head) curl_easy_setopt(handle, CURLOPT_NOBODY, 1L);
  if (request.range) {
    const std::uint64_t last = request.range->offset + request.range->size - 1;
    const std::string range = fmt::format("{}-{}", request.range->offset, last);
    curl_easy_setopt(handle, CURLOPT_RANGE, range.c_str());
    return curl_easy_perform(handle);  // `range` lives as long
  }
  return curl_easy_perform(handle);
}

class CurlService final : public HttpService {
 public:
  bool send(const HttpRequest& request, HttpAnswer& answer, ModuleError& error) const override try {
    Handle handle = handles_.take();
    if (!handle) throw std::bad_alloc();
    std::chrono::milliseconds pause = first_pause;
    for (int tries = 1;; ++tries) {
      Reception in{request};
      const CURLcode code = perform(handle.get(), in);
      long status = 0;
      curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
      in.answer.status = static_cast<int>(status);
      const bool again =
          code == CURLE_OK ? may_pass(in.answer.status) : !in.too_large && may_pass(code);
      if (!again || tries >= request.most_tries) {
        handles_.give_back(std::move(handle));
        return settle(in, code, tries, answer, error);
      }
      std::this_thread::sleep_for(
          std::max<std::chrono::milliseconds>(pause, std::min(in.retry_after, longest_pause)));
      pause = std::min<std::chrono::milliseconds>(2 * pause, longest_pause);
    }
  } catch (const std::bad_alloc&) {
    error = {ModuleError::Kind::storage, request.url + ": out of memory", ENOMEM};
    return false;
  } catch (const std::exception& failure) {
    error = {ModuleError::Kind::storage, request.url + ": " + failure.what()};
    return false;
  }

 private:
  static bool settle(Reception& in, CURLcode code, int tries, HttpAnswer& answer,
                     ModuleError& error) {
    using Kind = ModuleError::Kind;
    const std::string& url = in.request.url;
    const int status = in.answer.status;
    if (in.too_large) {
      error = {Kind::format, fmt::format("{}: more than {} bytes came, the most that is taken at "
                                         "once; download it and read it from a disk",
                                         url, in.request.most_bytes)};
      return false;
    }
    if (code != CURLE_OK) {
      const bool mistyped = code == CURLE_COULDNT_RESOLVE_HOST;
      error = {may_pass(code) && !mistyped ? Kind::storage : Kind::input,
               fmt::format("{}: cannot be read: {} ({}); check the address and the network", url,
                           curl_easy_strerror(code),
                           tries == 1 ? "tried once" : fmt::format("tried {} times", tries))};
      return false;
    }
    if (status == 200 || status == 206 || status == 404 || status == 410) {
      if (!in.answer.size && status == 200) in.answer.size = in.length;
      answer = std::move(in.answer);
      return true;
    }
    if (status == 401 || status == 403)
      error = {
          Kind::input,
          fmt::format("{}: the server refuses it (status {}): it is not public, or there is no "
                      "such thing; voxweld sends no password",
                      url, status)};
    else
      error = {may_pass(status) ? Kind::storage : Kind::input,
               fmt::format("{}: the server answers with status {}{}", url, status,
                           tries == 1 ? "" : fmt::format(", also at try {}", tries))};
    return false;
  }

  mutable Handles handles_;
};

class HttpModule final : public Module {
 public:
  HttpService* http() override { return &service_; }

 private:
  CurlService service_;
};

Module* the_module() {
  static HttpModule module;
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::the_module};
