#include "storage/support/run_file.h"

#include <algorithm>

namespace voxweld {

void RunFile::write_through(std::span<const std::byte> bytes) {
  flush();
  if (bytes.size() > pending_bytes)
    file_.append(bytes);
  else
    pending_.insert(pending_.end(), bytes.begin(), bytes.end());
}

RunExtent RunFile::end_run() {
  flush();
  const RunExtent run{begin_, file_.size()};
  begin_ = run.end;
  return run;
}

void RunFile::flush() {
  file_.append(pending_);
  pending_.clear();
}

void RunReader::read_on(std::span<std::byte> out) {
  while (!out.empty()) {
    if (next_ == held_.size()) {
      held_.resize(std::min(window_, run_.end - run_.begin));
      file_->read(run_.begin, held_);
      run_.begin += held_.size();
      next_ = 0;
    }
    const std::size_t part = std::min(out.size(), held_.size() - next_);
    std::memcpy(out.data(), held_.data() + next_, part);
    next_ += part;
    out = out.subspan(part);
  }
}

}  // namespace voxweld
