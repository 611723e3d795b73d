// Objects below an address of a server, by HTTP.
#pragma once

#include <memory>
#include <string>

#include "storage/store/byte_store.h"

namespace voxweld {

// The object KEY is at URL/KEY; a query ("?token=...") is kept behind it. Objects that are read in
// ranges are asked for by byte ranges, where the server has them; else, and where they are read
// whole, they are fetched when they are opened, at most 32 MiB. Up to 32 MiB of
// what was read in ranges are kept. The store lists nothing. An object
// that changes while it is read is not noticed.
// Errors as send_http (storage/http/http_service.h).
std::shared_ptr<const ByteStore> http_store(const std::string& url);

}  // namespace voxweld
