// What the module "server" (the only code that knows cpp-httplib, whose libraries would cost every run
// 4 MiB) does for the viewer: it listens, and asks a handler for each answer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/modules/module_api.h"

namespace voxweld {

struct ServerRequest {
  std::string method, path;  // path: decoded, without what follows a "?"
  std::string host;          // as the client calls the server
  std::string known_tag;     // the ETag of what the client has; else empty
};

struct ServerAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string text{};  // the body, where it does not come in pieces
  // The body in pieces: its size, and what fills one at an offset. False ends the answer early.
  std::uint64_t size = 0;
  std::function<bool(std::uint64_t offset, std::span<std::byte> piece)> fill{};
};

// Called from many threads at once. Throws nothing.
using ServerHandler = std::function<ServerAnswer(const ServerRequest&)>;

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;      // 0: one that is free
  int threads = 64;  // requests that are answered at the same time; others wait
};

// Listens until it is destroyed, which ends answers that are under way.
class RunningServer {
 public:
  virtual ~RunningServer() = default;
  virtual int port() const = 0;
};

class ServerService {
 public:
  virtual ~ServerService() = default;
  // The server is the caller's; null, and why, where the address or port cannot be had.
  virtual RunningServer* start(const ServerOptions& options, ServerHandler handler,
                               ModuleError& error) = 0;
};

// InputError as of load_module(), and where the address or port cannot be had.
std::unique_ptr<RunningServer> start_server(const ServerOptions& options, ServerHandler handler);

}  // namespace voxweld
