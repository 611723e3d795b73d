// The viewer's server: the page, what there is to show, and the files of it, over HTTP on this
// machine. It reads and changes nothing else.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace voxweld {

struct ViewServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;      // 0: one that is free
  int threads = 64;  // requests that are answered at the same time; others wait
};

// Answers GET and HEAD:
//   /             the page, and its parts beside it
//   /api/scene    what there is to show (scene.h)
//   /data/NAME    the file of that name, relative to what is shown
// While it listens on the loopback interface alone, it answers only who calls it by a name of that
// interface: no page of a stranger reaches it through a name that has been made to point here.
class ViewServer {
 public:
  // Listens, and answers from threads of its own. InputError where there is nothing to show (scene.h),
  // where the build has no page, and where the address or port cannot be had.
  ViewServer(const std::filesystem::path& shown, const ViewServerOptions& options);
  // Ends answers that are under way.
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  int port() const;
  std::string url() const;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

// Whether only this machine reaches an address: "localhost", 127.0.0.0/8, "::1".
bool is_loopback(const std::string& host);

}  // namespace voxweld
