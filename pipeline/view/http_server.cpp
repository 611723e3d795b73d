#include "pipeline/view/http_server.h"

#include "storage/modules/module_loader.h"
#include "storage/support/error.h"

namespace voxweld {

std::unique_ptr<RunningServer> start_server(const ServerOptions& options, ServerHandler handler) {
  ServerService* const service = load_module("server", "answer browsers").server();
  if (service == nullptr)
    throw InputError(
        "the module server is of another kind; install the module that came with this program");
  ModuleError error;
  std::unique_ptr<RunningServer> server(service->start(options, std::move(handler), error));
  if (!server) raise_module_error(error);
  return server;
}

}  // namespace voxweld
