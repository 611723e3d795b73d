// What happens to the folders between and during runs.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "tests/chaos/episode.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// In place, from an offset; the file keeps its node.
void write_over(const fs::path& path, const std::string& bytes, std::size_t from,
                std::size_t count) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(from));
  file.write(bytes.data() + from,
             static_cast<std::streamsize>(std::min(count, bytes.size() - from)));
}

void set_time(const fs::path& path, timespec time) {
  const timespec times[] = {time, time};
  utimensat(AT_FDCWD, path.c_str(), times, AT_SYMLINK_NOFOLLOW);
}

}  // namespace

std::string Episode::change_input() {
  if (!fs::is_regular_file(input())) {
    std::error_code ignored;
    fs::remove_all(input(), ignored);
    put_input(static_cast<Content>(pick(random_, clean_.count())));
    return "the input is back";
  }
  struct stat before {};
  stat(input().c_str(), &before);
  const Content other = pick(random_, 2) == 0 ? clean_.made(random_)
                                              : static_cast<Content>(pick(random_, clean_.count()));
  const std::string bytes = clean_.bytes(other);
  const auto size = static_cast<std::size_t>(before.st_size);
  switch (pick(random_, 12)) {
    case 0:
      put_input(other);
      return fmt::format("replaced by input {}", other);
    case 1:
      put_input(other);
      set_time(input(), before.st_mtim);
      return fmt::format("replaced by input {}, with the old time", other);
    case 2:
      write_over(input(), bytes, 0, bytes.size());
      return fmt::format("written over by input {}", other);
    case 3:
    case 4:
      write_over(input(), bytes, 0, bytes.size());
      set_time(input(), before.st_mtim);
      return fmt::format("written over by input {}, and its time set back", other);
    case 5: {
      const std::size_t from = pick(random_, bytes.size());
      write_over(input(), bytes, from, 1 + pick(random_, 20000));
      if (pick(random_, 2) == 0) set_time(input(), before.st_mtim);
      return fmt::format("a piece written over from {}", from);
    }
    case 6:
      fs::resize_file(input(), pick(random_, size + 1));
      return "cut short";
    case 7:
      write_bytes(input(), bytes_of_file(input()) + std::string(1 + pick(random_, 3000), 'x'));
      return "longer";
    case 8:
      set_time(input(), {1000000000 + static_cast<time_t>(pick(random_, 1000)), 0});
      return "touched: its time is of 2001";
    case 9:
      fs::last_write_time(input(), fs::file_time_type::clock::now());
      return "touched";
    case 10:
      fs::remove(input());
      return "removed";
    default:
      fs::remove(input());
      fs::create_directory(input());
      return "a folder in its place";
  }
}

std::string Episode::input_change_command() {
  const Content other = clean_.made(random_), old = input_now();
  const fs::path with = root_ / "other", kept = root_ / "kept";
  write_bytes(with, clean_.bytes(other));
  if (old != no_content) write_bytes(kept, clean_.bytes(old));
  // What it may be read as, however the command ends.
  in_force_.insert(other);
  const std::string overwrite = R"(dd if="$2" of="$1" conv=notrunc status=none)";
  const std::vector<std::string> commands = {
      overwrite, R"(touch -r "$1" "$1.t"; )" + overwrite + R"(; touch -r "$1.t" "$1"; rm "$1.t")",
      "cp \"$2\" \"$1.new\"; mv \"$1.new\" \"$1\"", "touch -r \"$1\" \"$2\"; mv \"$2\" \"$1\"",
      "truncate -s 30000 \"$1\"", "cat \"$2\" >> \"$1\"", "rm \"$1\"", "touch \"$1\"",
      "touch -d 2001-01-01 \"$1\"",
      // There and back.
      overwrite +
          R"(; (sleep 0.02; dd if="$3" of="$1" conv=notrunc status=none) >/dev/null 2>&1 &)",
      R"(dd if="$2" of="$1" bs=1000 skip=20 seek=20 count=20 conv=notrunc status=none)"};
  const std::string& command = pick_from(random_, commands);
  return fmt::format("set -- '{}' '{}' '{}'; [ -f \"$1\" ] || exit 0; {}", input().string(),
                     with.string(), kept.string(), command);
}

void Episode::change_step() {
  say("    the input: " + change_input());
  if (pick(random_, 3) > 0) run_together({random_run(pick(random_, configs_.size()))});
}

void Episode::config_step() {
  Config& config = pick_from(random_, std::vector<std::size_t>{0, 0, 1, 2}) == 0
                       ? configs_[0]
                       : configs_[1 + pick(random_, 2)];
  config.variant = pick(random_, clean_.variants());
  write_config(config);
  say(fmt::format("    {} becomes variant {}", config.name, config.variant));
  if (pick(random_, 2) == 0)
    run_together({random_run(static_cast<std::size_t>(&config - configs_.data()))});
}

// Work is put away, brought back from a backup, or used by another config.
void Episode::work_step() {
  const fs::path work = place_ / "a.work", backup = place_ / "backup.work";
  std::error_code ignored;
  switch (pick(random_, 4)) {
    case 0:
      fs::remove_all(backup, ignored);
      fs::rename(work, backup, ignored);
      say("    a.work is moved to backup.work");
      break;
    case 1:
      if (!fs::exists(backup)) break;
      fs::remove_all(work, ignored);
      fs::rename(backup, work, ignored);
      say("    backup.work is moved to a.work");
      break;
    case 2:
      fs::remove_all(backup, ignored);
      fs::copy(work, backup, fs::copy_options::recursive, ignored);
      say("    a.work is copied to backup.work");
      break;
    default:
      fs::rename(place_ / "c.work", place_ / "swap", ignored);
      fs::rename(work, place_ / "c.work", ignored);
      fs::rename(place_ / "swap", work, ignored);
      say("    a.work and c.work are exchanged");
  }
  run_together({random_run(pick(random_, configs_.size()))});
}

void Episode::damage_step() {
  const std::vector<std::string> folders = {"a.work", "a.work", "a.mesh", "b.mesh"};
  const std::string& folder = pick_from(random_, folders);
  const std::size_t count = 1 + pick(random_, 3), how = pick(random_, 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string file = random_file(folder);
    if (file.empty()) continue;
    say(fmt::format("    {}: way {}", file, how));
    if (how == 0) fs::remove(place_ / file);
    if (how == 1) set_time(place_ / file, {1000000000, 0});
    if (how == 2) fs::resize_file(place_ / file, fs::file_size(place_ / file) / 2);
    if (how == 3) {
      std::string bytes = bytes_of_file(place_ / file);
      if (bytes.empty()) continue;
      bytes[pick(random_, bytes.size())] ^= static_cast<char>(1 << pick(random_, 8));
      write_bytes(place_ / file, bytes);
    }
  }
  if (folder.ends_with(".mesh") && how != 1) {
    outputs_[folder].expected.clear();  // until the next run of it
    run_together({random_run(folder == "b.mesh" ? 1 : 2 * pick(random_, 2))});
  } else {
    run_together({random_run(pick(random_, configs_.size()))});
  }
}

void Episode::stage_step() {
  const std::size_t config = pick(random_, configs_.size());
  for (const char* stage : {"ingest", "build", "merge", "stitch"}) {
    Run run = random_run(config);
    run.command = stage;
    std::erase(run.words, "--force");
    run_together({run});
    if (pick(random_, 6) == 0) say("    the input: " + change_input());
    if (pick(random_, 8) == 0) return;
  }
  run_together({random_run(config)});
}

// The work or the output is on a disk of its own, which is small.
bool Episode::mount_small(const std::string& size) {
  const fs::path disk = place_ / "disk";
  fs::create_directories(disk);
  mounted_ = mount("tmpfs", disk.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  if (!mounted_) say("    skipped: no right to mount");
  return mounted_;
}

void Episode::unmount_small() {
  if (mounted_) umount2((place_ / "disk").c_str(), MNT_DETACH);
  mounted_ = false;
}

// The work or the output of one config, whichever it is, while f is called.
void Episode::on_small_disk(const std::string& size, const std::function<void()>& f) {
  if (!mount_small(size)) return;
  const Config before = configs_[1];
  (pick(random_, 2) == 0 ? configs_[1].work : configs_[1].output) = "disk/run";
  write_config(configs_[1]);
  f();
  unmount_small();
  outputs_.erase("disk/run");
  configs_[1] = before;
  write_config(before);
}

void Episode::run_and_check() {
  run_together({random_run(1)});
  check_output(configs_[1].output, outputs_[configs_[1].output]);
}

void Episode::full_disk_step() {
  on_small_disk(fmt::format("{}k", 16 << pick(random_, 6)), [&] {
    run_and_check();
    mount("tmpfs", (place_ / "disk").c_str(), "tmpfs", MS_REMOUNT, "size=64m");
    run_and_check();
  });
}

void Episode::read_only_step() {
  on_small_disk("64m", [&] {
    if (pick(random_, 2) == 0) run_together({random_run(1)});
    for (const unsigned long flags : {0UL + (MS_REMOUNT | MS_RDONLY), 0UL + MS_REMOUNT}) {
      mount("tmpfs", (place_ / "disk").c_str(), "tmpfs", flags, "size=64m");
      if (pick(random_, 2) == 0) say("    the input: " + change_input());
      run_and_check();
    }
  });
}

// The whole folder gets another name.
void Episode::move_step() {
  clear_queue(surroundings_);  // tasks go on where all was
  const fs::path to = root_ / (place_.filename() == "place" ? "moved" : "place");
  fs::rename(place_, to);
  place_ = to;
  say("    all is moved to " + to.string());
  run_together({random_run(pick(random_, configs_.size()))});
}

}  // namespace voxweld::testing
