// A server on the loopback interface, in a thread of the test.
#pragma once

#include <httplib.h>

#include <chrono>
#include <string>
#include <thread>

namespace voxweld::testing {

class HttpServer {
 public:
  HttpServer() : port_(server_.bind_to_any_port("127.0.0.1")) {
    server_.set_tcp_nodelay(true);
    server_.set_keep_alive_timeout(1);  // seconds that stop() may wait
  }
  ~HttpServer() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // What it answers is to be said before start().
  httplib::Server& server() { return server_; }
  void start() {
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::string url(const std::string& path) const {
    return "http://127.0.0.1:" + std::to_string(port_) + path;
  }

 private:
  httplib::Server server_;
  int port_;
  std::thread thread_;
};

}  // namespace voxweld::testing
