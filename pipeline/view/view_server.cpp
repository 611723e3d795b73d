#include "pipeline/view/view_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "pipeline/view/page_files.h"
#include "pipeline/view/scene.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

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

ServerAnswer refused(int status, const std::string& why) {
  ServerAnswer answer{.status = status, .text = why + "\n"};
  if (status == 405) answer.headers.emplace_back("Allow", "GET, HEAD");
  return answer;
}

ServerAnswer not_found(const ServerRequest& request) {
  return refused(404, "not found: " + request.path);
}

// What comes in pieces unless the client has it.
ServerAnswer tagged(const ServerRequest& request, const std::string& tag, ServerAnswer answer) {
  answer.headers.emplace_back("ETag", tag);
  if (request.known_tag == tag) answer.status = 304;
  return answer;
}

ServerAnswer page_answer(const ServerRequest& request, const std::string& name) {
  const auto files = page_files();
  const auto file = std::ranges::find(files, name, &PageFile::name);
  if (file == files.end()) return not_found(request);
  const auto bytes = std::as_bytes(std::span(file->bytes));
  ServerAnswer answer{.type = std::string(content_type(name)), .size = bytes.size()};
  answer.headers.emplace_back("Content-Security-Policy", page_policy);
  answer.fill = [bytes](std::uint64_t offset, std::span<std::byte> piece) {
    std::memcpy(piece.data(), bytes.data() + offset, piece.size());
    return true;
  };
  return tagged(request, '"' + to_hex(hash_bytes(bytes)) + '"', std::move(answer));
}

// In pieces: a file may be larger than memory.
ServerAnswer file_answer(const ServerRequest& request, const std::filesystem::path& path) {
  const auto file = std::make_shared<ReadFile>(path);
  ServerAnswer answer{.type = std::string(content_type(request.path)), .size = file->size()};
  answer.headers.emplace_back("Content-Security-Policy", data_policy);
  answer.fill = [file](std::uint64_t offset, std::span<std::byte> piece) {
    try {
      file->read(offset, piece);
    } catch (const Error&) {  // it became shorter meanwhile
      return false;
    }
    return true;
  };
  const std::string tag = fmt::format("\"{}-{}\"", file->size(), file->state().mtime_ns);
  return tagged(request, tag, std::move(answer));
}

ServerAnswer scene_answer(const ServedFiles& files) {
  ServerAnswer answer{.type = "application/json"};
  try {
    answer.text = scene_text(files);
  } catch (const std::exception& error) {  // a run may be writing at this moment
    answer.status = 500;
    answer.text = json_text(nlohmann::json{{"error", error.what()}});
  }
  return answer;
}

ServerAnswer routed(const ServerRequest& request, const ServedFiles& files) {
  constexpr std::string_view data = "/data/";
  const std::string& path = request.path;
  if (path == "/api/scene") return scene_answer(files);
  if (path.starts_with(data)) {
    const auto file = files.find(path.substr(data.size()));
    return file ? file_answer(request, *file) : not_found(request);
  }
  return path.empty() ? not_found(request)
                      : page_answer(request, path == "/" ? "index.html" : path.substr(1));
}

}  // namespace

bool is_loopback(const std::string& host) {
  in_addr address{};
  if (inet_pton(AF_INET, host.c_str(), &address) == 1)
    return ntohl(address.s_addr) >> 24 == IN_LOOPBACKNET;
  return host == "localhost" || host == "::1";
}

ViewServer::ViewServer(const std::filesystem::path& shown, const ServerOptions& options)
    : files_(shown), host_(options.host) {
  require_page();
  check_viewable(files_);
  server_ = start_server(options, [this](const ServerRequest& request) { return answer(request); });
}

ServerAnswer ViewServer::answer(const ServerRequest& request) const {
  ServerAnswer answer;
  try {
    if (request.method != "GET" && request.method != "HEAD")
      answer = refused(405, "only GET and HEAD are answered");
    else if (is_loopback(host_) && !is_loopback(host_of(request.host)))
      answer = refused(403, "call this server by the address that `voxweld view` tells");
    else
      answer = routed(request, files_);
  } catch (const std::exception& error) {
    answer = refused(500, error.what());
  }
  answer.headers.insert(answer.headers.end(), {{"Cache-Control", "no-cache"},
                                               {"X-Content-Type-Options", "nosniff"},
                                               {"Referrer-Policy", "no-referrer"},
                                               {"Cross-Origin-Resource-Policy", "same-origin"}});
  return answer;
}

std::string ViewServer::url() const {
  const bool is_ipv6 = host_.find(':') != std::string::npos;
  return fmt::format("http://{}:{}/", is_ipv6 ? "[" + host_ + "]" : host_, port());
}

}  // namespace voxweld
