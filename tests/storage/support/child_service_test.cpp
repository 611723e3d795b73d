// A child that is asked one thing after the other, and what is said when it goes down.
#include "storage/support/child_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <memory>
#include <stdexcept>
#include <vector>

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using Kind = CallEnd::Kind;

constexpr ServiceRules usual_rules{.most_seconds = 20};

TEST(ChildService, KeepsItsStateFromCallToCall) {
  ChildService child(
      8, [calls = 0](std::span<std::byte> memory) mutable { memory[0] = std::byte(++calls); },
      usual_rules);
  for (int i = 1; i < 4; ++i) {
    EXPECT_EQ(child.call().kind, Kind::done);
    EXPECT_EQ(child.memory()[0], std::byte(i));
  }
}

TEST(ChildService, WhatIsThrownIsSaidAndTheChildGoesOn) {
  ChildService child(
      8,
      [](std::span<std::byte> memory) {
        if (memory[0] == std::byte{0}) throw std::runtime_error("no\nluck");
      },
      usual_rules);
  const CallEnd end = child.call();
  EXPECT_EQ(end.kind, Kind::failed);
  EXPECT_EQ(end.why, "no luck");
  child.memory()[0] = std::byte{1};
  EXPECT_EQ(child.call().kind, Kind::done);
}

TEST(ChildService, ACrashIsTheEndOfIt) {
  ChildService child(
      8, [](std::span<std::byte>) { std::raise(SIGSEGV); }, usual_rules);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(child.call().kind, Kind::crashed);
}

TEST(ChildService, ItHasSoMuchTimeForEachCall) {
  ChildService child(8,
                     [](std::span<std::byte> memory) {
                       const volatile bool forever = memory[0] == std::byte{1};
                       while (forever) {
                       }
                     },
                     {.most_seconds = 1});
  EXPECT_EQ(child.call().kind, Kind::done);
  child.memory()[0] = std::byte{1};
  EXPECT_EQ(child.call().kind, Kind::out_of_time);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ChildService, MemoryWithoutEndIsRefusedToIt) {
  ChildService child(8,
                     [](std::span<std::byte>) {
                       const std::vector<char> large(std::size_t{1} << 30);
                       if (large.at(5) != 0) throw std::logic_error("cannot be");
                     },
                     {.most_seconds = 20, .most_more_bytes = std::uint64_t{64} << 20});
  const CallEnd end = child.call();
  EXPECT_EQ(end.kind, Kind::failed);
  EXPECT_THAT(end.why, HasSubstr("bad_alloc"));
}
#endif

// 0: well; 1: throws; 2: crashes.
TEST(ChildService, APartApartLeavesTheChildAsItWas) {
  ChildService child(
      8,
      [state = 0](std::span<std::byte> memory) mutable {
        ChildService::apart(
            [&] {
              state = 1;
              if (memory[0] == std::byte{1}) throw std::runtime_error("badly");
              if (memory[0] == std::byte{2}) std::raise(SIGSEGV);
              memory[1] = std::byte{9};
            },
            usual_rules);
        memory[2] = std::byte(state);
      },
      usual_rules);
  EXPECT_EQ(child.call().kind, Kind::done);
  EXPECT_EQ(child.memory()[1], std::byte{9});
  EXPECT_EQ(child.memory()[2], std::byte{0});
  child.memory()[0] = std::byte{1};
  EXPECT_EQ(child.call().why, "badly");
  child.memory()[0] = std::byte{2};
  EXPECT_THAT(child.call().why, HasSubstr("signal 11"));
  child.memory()[0] = std::byte{0};
  EXPECT_EQ(child.call().kind, Kind::done);
}

// A Ctrl-C goes to all processes at once; what it means is for the parent to say.
TEST(ChildService, ACtrlCDoesNotEndIt) {
  ChildService child(
      8, [](std::span<std::byte>) { std::raise(SIGINT); }, usual_rules);
  EXPECT_EQ(child.call().kind, Kind::done);
}

// A second one must not keep the first one waiting for an end that it holds open.
TEST(ChildService, SeveralEndInAnyOrder) {
  const auto make = [] {
    return std::make_unique<ChildService>(
        8, [](std::span<std::byte>) {}, usual_rules);
  };
  auto first = make(), second = make();
  EXPECT_EQ(first->call().kind, Kind::done);
  first.reset();
  EXPECT_EQ(second->call().kind, Kind::done);
}

// It sees none of the files that are open here.
TEST(ChildService, HoldsNoFileOpen) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ChildService child(
      8, [](std::span<std::byte>) {}, usual_rules);
  EXPECT_EQ(child.call().kind, Kind::done);
  close(ends[1]);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);  // the end of it: nobody else can write
  close(ends[0]);
}

}  // namespace
}  // namespace voxweld::testing
