// The viewer's server: the page, what there is to show, and the files of it, over HTTP on this
// machine. It reads and changes nothing else.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "pipeline/view/http_server.h"
#include "pipeline/view/served_files.h"

namespace voxweld {

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
  ViewServer(const std::filesystem::path& shown, const ServerOptions& options);
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  int port() const { return server_->port(); }
  std::string url() const;

 private:
  ServerAnswer answer(const ServerRequest& request) const;

  const ServedFiles files_;
  const std::string host_;
  std::unique_ptr<RunningServer> server_;  // ends first
};

// Whether only this machine reaches an address: "localhost", 127.0.0.0/8, "::1".
bool is_loopback(const std::string& host);

}  // namespace voxweld
