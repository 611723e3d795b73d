#include "pipeline/view/view_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/view/page_files.h"
#include "pipeline/view/scene.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using httplib::Request;
using httplib::Response;

constexpr std::size_t piece_bytes = std::size_t{256} << 10;
constexpr int waiting_connections = 511;  // httplib asks for 5: others would be turned away
constexpr std::time_t idle_seconds = 1;   // how long a thread waits for the request of a connection

// Scripts and styles are the page's own. Decoders are WebAssembly, in workers made of text.
constexpr const char* page_policy =
    "default-src 'self'; script-src 'self' blob: 'wasm-unsafe-eval'; worker-src 'self' blob:; "
    "connect-src 'self' blob: data:; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; "
    "object-src 'none'; base-uri 'none'; frame-ancestors 'none'";
// A page among the files may be anybody's: it is shown, and runs nothing.
constexpr const char* data_policy =
    "sandbox; default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'";

// "HOST:PORT" or "[HOST]:PORT" without the port.
std::string host_of(const std::string& address) {
  if (address.starts_with('[')) return address.substr(1, address.find(']') - 1);
  return address.substr(0, address.find(':'));
}

void answer_text(Response& answer, int status, const std::string& text) {
  answer.status = status;
  answer.set_content(text + "\n", "text/plain; charset=utf-8");
}

bool is_known(const Request& request, Response& answer, const std::string& tag) {
  answer.set_header("ETag", tag);
  if (request.get_header_value("If-None-Match") != tag) return false;
  answer.status = 304;
  return true;
}

void answer_page(const Request& request, Response& answer, const std::string& name) {
  const auto files = page_files();
  const auto file = std::ranges::find(files, name, &PageFile::name);
  if (file == files.end()) return answer_text(answer, 404, "not found: " + request.path);
  const Hash128 hash = hash_bytes(std::as_bytes(std::span(file->bytes)));
  answer.set_header("Content-Security-Policy", page_policy);
  if (is_known(request, answer, '"' + to_hex(hash) + '"')) return;
  answer.set_content_provider(
      file->bytes.size(), std::string(content_type(name)),
      [bytes = file->bytes](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        const std::string_view piece = bytes.substr(offset, std::min(length, piece_bytes));
        return sink.write(piece.data(), piece.size());
      });
}

void answer_scene(Response& answer, const ServedFiles& files) {
  try {
    answer.set_content(scene_text(files), "application/json");
  } catch (const std::exception& error) {  // a run may be writing at this moment
    answer.status = 500;
    answer.set_content(json_text(nlohmann::json{{"error", error.what()}}), "application/json");
  }
}

// In pieces: a file may be larger than memory.
void answer_data(const Request& request, Response& answer,
                 const std::optional<std::filesystem::path>& path, const std::atomic<bool>& stops) {
  if (!path) return answer_text(answer, 404, "not found: " + request.path);
  answer.set_header("Content-Security-Policy", data_policy);
  const auto file = std::make_shared<ReadFile>(*path);
  const std::string tag = fmt::format("\"{}-{}\"", file->size(), file->state().mtime_ns);
  if (is_known(request, answer, tag)) return;
  const std::string type(content_type(request.path));
  if (file->size() == 0) return answer.set_content("", type);  // httplib calls no provider for it
  answer.set_content_provider(
      file->size(), type,
      [file, &stops](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        if (stops) return false;
        std::vector<std::byte> piece(std::min(length, piece_bytes));
        try {
          file->read(offset, piece);
        } catch (const Error&) {  // it became shorter meanwhile
          return false;
        }
        return sink.write(reinterpret_cast<const char*>(piece.data()), piece.size());
      });
}

}  // namespace

bool is_loopback(const std::string& host) {
  in_addr address{};
  if (inet_pton(AF_INET, host.c_str(), &address) == 1)
    return ntohl(address.s_addr) >> 24 == IN_LOOPBACKNET;
  return host == "localhost" || host == "::1";
}

class ViewServer::Server : private httplib::Server {
 public:
  Server(const std::filesystem::path& shown, const ViewServerOptions& options)
      : files_(shown), host_(options.host) {
    require_page();
    check_viewable(files_);
    set_up(options.threads);
    bind(options.port);
    thread_ = std::thread([this] { listen_after_bind(); });
    while (!is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Server() override {
    stops_ = true;
    stop();
    if (thread_.joinable()) thread_.join();
  }

  int port() const { return port_; }
  const std::string& host() const { return host_; }

 private:
  void set_up(int threads) {
    new_task_queue = [threads] {
      return new httplib::ThreadPool(static_cast<std::size_t>(threads));
    };
    set_keep_alive_timeout(idle_seconds);
    // A connection that is kept keeps its thread from others.
    set_keep_alive_max_count(1);
    set_tcp_nodelay(true);
    // Not SO_REUSEPORT, as httplib would: two servers would share a port, each with half the requests.
    set_socket_options([](int socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_default_headers({{"Cache-Control", "no-cache"},
                         {"X-Content-Type-Options", "nosniff"},
                         {"Referrer-Policy", "no-referrer"},
                         {"Cross-Origin-Resource-Policy", "same-origin"}});
    // Before httplib's own routes, which are regular expressions: those of libstdc++ take a piece of
    // stack for each character.
    set_pre_routing_handler([this](const Request& request, Response& answer) {
      if (!refuses(request, answer)) route(request, answer);
      return HandlerResponse::Handled;
    });
    set_exception_handler([](const Request&, Response& answer, std::exception_ptr thrown) {
      try {
        std::rethrow_exception(thrown);
      } catch (const std::exception& error) {
        answer_text(answer, 500, error.what());
      }
    });
  }

  void route(const Request& request, Response& answer) const {
    constexpr std::string_view data = "/data/";
    if (request.path == "/api/scene") return answer_scene(answer, files_);
    if (request.path.starts_with(data))
      return answer_data(request, answer, files_.find(request.path.substr(data.size())), stops_);
    answer_page(request, answer, request.path == "/" ? "index.html" : request.path.substr(1));
  }

  bool refuses(const Request& request, Response& answer) const {
    if (request.method != "GET" && request.method != "HEAD") {
      answer.set_header("Allow", "GET, HEAD");
      answer_text(answer, 405, "only GET and HEAD are answered");
      return true;
    }
    if (!is_loopback(host_) || is_loopback(host_of(request.get_header_value("Host")))) return false;
    answer_text(answer, 403, "call this server by the address that `voxweld view` tells");
    return true;
  }

  void bind(int port) {
    errno = 0;
    port_ = port != 0 ? (bind_to_port(host_, port) ? port : -1) : bind_to_any_port(host_);
    if (port_ <= 0) {
      const int error = errno;
      throw InputError(fmt::format("cannot listen on {}{}{}; choose others with --host and --port",
                                   host_, port != 0 ? fmt::format(", port {}", port) : "",
                                   error != 0 ? fmt::format(": {}", std::strerror(error)) : ""));
    }
    ::listen(svr_sock_, waiting_connections);
  }

  const ServedFiles files_;
  const std::string host_;
  int port_ = 0;
  std::atomic<bool> stops_{false};
  std::thread thread_;
};

ViewServer::ViewServer(const std::filesystem::path& shown, const ViewServerOptions& options)
    : server_(std::make_unique<Server>(shown, options)) {}
ViewServer::~ViewServer() = default;

int ViewServer::port() const {
  return server_->port();
}

std::string ViewServer::url() const {
  const std::string& host = server_->host();
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return fmt::format("http://{}:{}/", is_ipv6 ? "[" + host + "]" : host, port());
}

}  // namespace voxweld
