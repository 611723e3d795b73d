#include "storage/http/http_service.h"

#include "storage/modules/module_loader.h"
#include "storage/support/error.h"

namespace voxweld {

HttpAnswer send_http(const HttpRequest& request) {
  static HttpService* const service = load_module("http", "read " + request.url).http();
  if (service == nullptr)
    throw InputError(request.url +
                     ": the module http is of another kind; install the module that came with "
                     "this program");
  HttpAnswer answer;
  ModuleError error;
  if (!service->send(request, answer, error)) raise_module_error(error);
  return answer;
}

}  // namespace voxweld
