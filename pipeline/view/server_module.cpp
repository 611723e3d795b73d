// The module "server": HTTP by cpp-httplib.
#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <thread>

#include "pipeline/view/http_server.h"

namespace voxweld {
namespace {

using httplib::Request;
using httplib::Response;

constexpr std::size_t piece_bytes = std::size_t{256} << 10;
constexpr int waiting_connections = 511;  // httplib asks for 5: others would be turned away
constexpr std::time_t idle_seconds = 1;   // how long a thread waits for the request of a connection

class HttplibServer final : public RunningServer, private httplib::Server {
 public:
  HttplibServer(const ServerOptions& options, ServerHandler handler)
      : handler_(std::move(handler)) {
    new_task_queue = [threads = static_cast<std::size_t>(options.threads)] {
      return new httplib::ThreadPool(threads);
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
    // Before httplib's own routes, which are regular expressions: those of libstdc++ take a piece of
    // stack for each character.
    set_pre_routing_handler([this](const Request& request, Response& answer) {
      respond(request, answer);
      return HandlerResponse::Handled;
    });
  }
  ~HttplibServer() override {
    stops_ = true;
    stop();
    if (thread_.joinable()) thread_.join();
  }

  int port() const override { return port_; }

  bool listen_on(const std::string& host, int port) {
    errno = 0;
    port_ = port == 0 ? bind_to_any_port(host) : bind_to_port(host, port) ? port : -1;
    if (port_ <= 0) return false;
    ::listen(svr_sock_, waiting_connections);
    thread_ = std::thread([this] { listen_after_bind(); });
    while (!is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return true;
  }

 private:
  void respond(const Request& request, Response& response) const {
    ServerAnswer answer = handler_({request.method, request.path, request.get_header_value("Host"),
                                    request.get_header_value("If-None-Match")});
    // httplib says by itself whether it is all (200) or a range (206).
    if (answer.status != 200) response.status = answer.status;
    for (const auto& [name, value] : answer.headers) response.set_header(name, value);
    if (answer.status == 304) return;
    // httplib calls no provider for an empty body.
    if (!answer.fill || answer.size == 0) return response.set_content(answer.text, answer.type);
    response.set_content_provider(
        answer.size, answer.type,
        [this, fill = std::move(answer.fill)](std::size_t offset, std::size_t length,
                                              httplib::DataSink& sink) {
          std::vector<std::byte> piece(std::min(length, piece_bytes));
          return !stops_ && fill(offset, piece) &&
                 sink.write(reinterpret_cast<const char*>(piece.data()), piece.size());
        });
  }

  const ServerHandler handler_;
  int port_ = 0;
  std::atomic<bool> stops_{false};
  std::thread thread_;
};

class HttplibService final : public ServerService {
 public:
  RunningServer* start(const ServerOptions& options, ServerHandler handler,
                       ModuleError& error) override {
    auto server = std::make_unique<HttplibServer>(options, std::move(handler));
    if (server->listen_on(options.host, options.port)) return server.release();
    const int number = errno;
    error = {
        ModuleError::Kind::input,
        fmt::format("cannot listen on {}{}{}; choose others with --host and --port", options.host,
                    options.port != 0 ? fmt::format(", port {}", options.port) : "",
                    number != 0 ? fmt::format(": {}", std::strerror(number)) : "")};
    return nullptr;
  }
};

class ServerModule final : public Module {
 public:
  ServerService* server() override { return &service_; }

 private:
  HttplibService service_;
};

Module* the_module() {
  static ServerModule module;
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::the_module};
