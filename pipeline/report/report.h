// The report of a finished run: one HTML file for people.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/executor/interrupt.h"

namespace voxweld {

struct ReportOptions {
  std::filesystem::path directory;  // the output directory
  std::filesystem::path file;       // what to write
  bool threads = true;              // more than one may be used
  std::uint64_t memory = std::uint64_t{512}
                         << 20;  // bytes that meshes may take, beside little else
  const InterruptFlag* interrupt = nullptr;
};

// Reads the manifest, the meshes and, where they are still there, the volume and the config. The
// same of these give the same bytes. Throws InputError where the directory is no output of a run,
// what readers throw where its files are damaged; Interrupted. A volume that cannot be read is no
// error: the page says so.
std::string report_text(const ReportOptions& options);
void write_report(const ReportOptions& options);

// Whether the file is a report of the directory as it is.
bool report_is_current(const ReportOptions& options);

}  // namespace voxweld
