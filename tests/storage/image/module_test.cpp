#include "storage/image/image_service.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "storage/support/error.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

bool mapped(const std::string& library) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find(library) != std::string::npos) return true;
  return false;
}

// The cases that need a process without the module come first, as this file does in the program.

// Reports what a fresh process says when it looks for the module in `directory` first.
std::string message_of_child(const std::string& directory) {
  int channel[2];
  if (pipe(channel) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    std::string message = "loaded";
    try {
      setenv("VOXWELD_MODULES", directory.c_str(), 1);
      image_service();
    } catch (const InputError& error) {
      message = error.what();
    }
    const ssize_t put = write(channel[1], message.data(), message.size());
    _exit(put == static_cast<ssize_t>(message.size()) ? 0 : 1);
  }
  close(channel[1]);
  std::string message;
  char buffer[512];
  for (ssize_t got; (got = read(channel[0], buffer, sizeof buffer)) > 0;)
    message.append(buffer, static_cast<std::size_t>(got));
  close(channel[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return message;
}

TEST(ImageModule, NamesAFileThatIsNoModule) {
  if (mapped("libvoxweld_image")) GTEST_SKIP() << "another test of this process used it";
  const testing::TempDirectory directory;
  std::ofstream(directory / "libvoxweld_image.so") << "no library";
  const std::string message = message_of_child(directory.path().string());
  EXPECT_NE(message.find((directory / "libvoxweld_image.so").string()), std::string::npos)
      << message;
  EXPECT_NE(message.find("cannot load the module"), std::string::npos) << message;
}

TEST(ImageModule, FallsBackToTheProgramsDirectory) {
  if (mapped("libvoxweld_image")) GTEST_SKIP() << "another test of this process used it";
  const testing::TempDirectory directory;
  EXPECT_EQ(message_of_child(directory.path().string()), "loaded");
}

TEST(ImageModule, IsNotMappedBeforeItsFirstUse) {
  if (mapped("libvoxweld_image")) GTEST_SKIP() << "another test of this process used it";
  EXPECT_FALSE(mapped("libOpenImageIO"));
  image_service();
  EXPECT_TRUE(mapped("libvoxweld_image"));
  EXPECT_TRUE(mapped("libOpenImageIO"));
}

// Of an installed program, with its modules in lib/voxweld beside bin.
TEST(ImageModule, IsFoundWhereItIsInstalled) {
  const testing::TempDirectory directory;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  std::filesystem::create_directories(directory / "bin");
  std::filesystem::create_directories(directory / "lib/voxweld");
  std::filesystem::copy(program, directory / "bin/program");
  const auto run = [&] {
    const std::string command =
        fmt::format("'{}' --gtest_filter=ImageModule.LoadsOnceFromManyThreads >/dev/null 2>&1",
                    (directory / "bin/program").string());
    return std::system(command.c_str());
  };
  EXPECT_NE(run(), 0);
  std::filesystem::copy(program.parent_path() / "libvoxweld_image.so",
                        directory / "lib/voxweld/libvoxweld_image.so");
  EXPECT_EQ(run(), 0);
}

TEST(ImageModule, LoadsOnceFromManyThreads) {
  std::vector<ImageService*> modules(8);
  std::vector<std::thread> threads;
  for (ImageService*& module : modules)
    threads.emplace_back([&module] { module = &image_service(); });
  for (std::thread& thread : threads) thread.join();
  for (const ImageService* module : modules) EXPECT_EQ(module, modules.front());
}

}  // namespace
}  // namespace voxweld
