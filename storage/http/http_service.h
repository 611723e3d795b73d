// What the HTTP module (the only code that knows libcurl) does for the program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/modules/module_api.h"

namespace voxweld {

struct HttpRequest {
  enum class Method : std::uint8_t { get, head };
  struct Range {
    std::uint64_t offset = 0, size = 0;  // size above 0
  };

  std::string url;
  Method method = Method::get;
  std::optional<Range> range{};
  // Larger answers are refused before they are received. Bytes.
  std::uint64_t most_bytes = std::uint64_t{64} << 20;
  int most_tries = 6;  // in all some eight seconds apart, or as long as the server asks for
};

struct HttpAnswer {
  int status = 0;  // 200, 206, or 404 and 410 where there is no such thing
  std::vector<std::byte> body;
  std::optional<std::uint64_t> size;  // of the whole object, where the server says
  std::string etag, modified;         // as the server says them; else empty

  bool found() const { return status == 200 || status == 206; }
};

class HttpService {
 public:
  virtual ~HttpService() = default;
  // From many threads. What may pass by itself (no connection, a time-out, an answer that breaks
  // off, 408, 429 and 5xx) is tried again some times, each after a longer pause. False, and why in
  // `error`, for all answers but those of HttpAnswer::status.
  virtual bool send(const HttpRequest& request, HttpAnswer& answer, ModuleError& error) const = 0;
};

// Sends the request by the module "http", which the first call from any thread loads.
// InputError as of load_module(), and where the server refuses (401, 403 ...); StorageError where
// it does not answer.
HttpAnswer send_http(const HttpRequest& request);

}  // namespace voxweld
