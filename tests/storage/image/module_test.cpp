#include "storage/image/module_loader.h"

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
      setenv("VOXWELD_MODULE_DIR", directory.c_str(), 1);
      image_module();
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
  if (image_module_loaded()) GTEST_SKIP() << "another test of this process used it";
  const testing::TempDirectory directory;
  std::ofstream(directory / "libvoxweld_image.so") << "no library";
  const std::string message = message_of_child(directory.path().string());
  EXPECT_NE(message.find((directory / "libvoxweld_image.so").string()), std::string::npos)
      << message;
  EXPECT_NE(message.find("cannot load the image module"), std::string::npos) << message;
}

TEST(ImageModule, FallsBackToTheProgramsDirectory) {
  if (image_module_loaded()) GTEST_SKIP() << "another test of this process used it";
  const testing::TempDirectory directory;
  EXPECT_EQ(message_of_child(directory.path().string()), "loaded");
}

TEST(ImageModule, IsNotMappedBeforeItsFirstUse) {
  if (image_module_loaded()) GTEST_SKIP() << "another test of this process used it";
  EXPECT_FALSE(mapped("libOpenImageIO"));
  EXPECT_FALSE(mapped("libvoxweld_image"));
  image_module();
  EXPECT_TRUE(image_module_loaded());
  EXPECT_TRUE(mapped("libOpenImageIO"));
}

TEST(ImageModule, LoadsOnceFromManyThreads) {
  std::vector<ImageModule*> modules(8);
  std::vector<std::thread> threads;
  for (ImageModule*& module : modules)
    threads.emplace_back([&module] { module = &image_module(); });
  for (std::thread& thread : threads) thread.join();
  for (const ImageModule* module : modules) EXPECT_EQ(module, modules.front());
}

}  // namespace
}  // namespace voxweld
