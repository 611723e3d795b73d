// Who made a file: kept beside its contents for people, never part of a key or a content hash.
#pragma once

#include <string>
#include <string_view>

#include "storage/support/hash.h"

namespace voxweld {

// Told once, before the first artifact is written; without it artifacts say the program, host and
// time alone. Not thread-safe.
void set_provenance_config(Hash128 config_fingerprint);
void set_provenance_kernels(std::string_view name);  // which instructions the numbers came from

// As JSON, one line: program and version, kernels, config fingerprint, host, process, time (UTC,
// ISO 8601) and, inside a Slurm job, its ids: job, array job, array task, node, how often it was
// restarted.
std::string provenance_json();

}  // namespace voxweld
