#include "storage/http/http_service.h"

#include <algorithm>

#include "storage/modules/module_loader.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {

bool is_url(std::string_view path) {
  constexpr std::size_t longest = 8;
  const std::string begin = lower(path.substr(0, std::min(path.size(), longest)));
  return begin.starts_with("http://") || begin.starts_with("https://");
}

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
