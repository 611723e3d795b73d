#include "pipeline/executor/error_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <functional>
#include <new>

namespace voxweld {
namespace {

bool record(ErrorCollector& errors, std::uint64_t key, const std::function<void()>& thrower) {
  try {
    thrower();
  } catch (...) {
    return errors.record_current(key, "unit " + std::to_string(key));
  }
  ADD_FAILURE() << "nothing was thrown";
  return false;
}

ErrorSet caught(ErrorCollector& errors) {
  try {
    errors.throw_if_any("stitch");
  } catch (const ErrorSet& set) {
    return set;
  }
  throw std::logic_error("no ErrorSet was thrown");
}

const auto wrong_input = [] { throw InputError("bad value"); };
const auto damage = [] { throw DamagedArtifact("b.vx", "checksum"); };
const auto other_damage = [] { throw DamagedArtifact("a.vx", "magic"); };

TEST(ErrorSet, ExitCodeIsTheUsersOnlyWhenAllAre) {
  ErrorCollector users, mixed;
  record(users, 1, wrong_input);
  record(users, 2, [] { throw FormatError("truncated"); });
  EXPECT_EQ(caught(users).exit_code(), 2);
  record(mixed, 1, wrong_input);
  record(mixed, 2, [] { throw StorageError("cannot read"); });
  EXPECT_EQ(caught(mixed).exit_code(), 1);
}

TEST(ErrorSet, WhatTheFileSystemRefusesIsNoUnexpectedError) {
  ErrorCollector errors;
  record(errors, 1, [] {
    throw std::filesystem::filesystem_error(
        "status", "a.drc", std::make_error_code(std::errc::too_many_symbolic_link_levels));
  });
  record(errors, 2, wrong_input);
  EXPECT_THAT(caught(errors).what(),
              testing::HasSubstr("cannot use a.drc: Too many levels of symbolic links"));
}

TEST(ErrorSet, NamesTheDamagedArtifactsSortedAndOnce) {
  ErrorCollector errors;
  record(errors, 9, other_damage);
  record(errors, 3, damage);
  record(errors, 5, damage);
  const ErrorSet set = caught(errors);
  EXPECT_THAT(damaged_paths(set), testing::ElementsAre("a.vx", "b.vx"));
  EXPECT_TRUE(is_only_damage(set));
  EXPECT_THAT(damaged_paths(DamagedArtifact("c.vx", "size")), testing::ElementsAre("c.vx"));
  EXPECT_TRUE(damaged_paths(InputError("x")).empty());
  EXPECT_FALSE(is_only_damage(InputError("x")));
}

TEST(ErrorSet, DamageBesideAnotherFailureIsNotOnlyDamage) {
  ErrorCollector errors;
  record(errors, 1, damage);
  record(errors, 2, wrong_input);
  const ErrorSet set = caught(errors);
  EXPECT_THAT(damaged_paths(set), testing::ElementsAre("b.vx"));
  EXPECT_FALSE(is_only_damage(set));
}

TEST(ErrorSet, KnowsWhichFailuresEndAStage) {
  ErrorCollector errors;
  EXPECT_FALSE(record(errors, 1, wrong_input));
  EXPECT_FALSE(record(errors, 2, [] { throw_errno("read", "x", EIO); }));
  EXPECT_FALSE(record(errors, 3, [] { throw std::bad_alloc(); }));
  EXPECT_FALSE(record(errors, 4, [] { throw 1; }));
  EXPECT_TRUE(record(errors, 5, [] { throw_errno("write", "x", ENOSPC); }));
  EXPECT_TRUE(record(errors, 6, [] { throw_errno("write", "x", EDQUOT); }));
  EXPECT_TRUE(record(errors, 7, [] { throw Interrupted(); }));
}

TEST(ErrorSet, InterruptionsAreToldOnceAndLast) {
  ErrorCollector errors;
  record(errors, 1, [] { throw Interrupted(); });
  record(errors, 8, wrong_input);
  record(errors, 2, [] { throw Interrupted(); });
  const ErrorSet set = caught(errors);
  EXPECT_TRUE(set.interrupted());
  EXPECT_EQ(set.exit_code(), 1);
  EXPECT_EQ(std::string(set.what()),
            "stitch: 1 unit failed:\n  unit 8: bad value\n  " + std::string(Interrupted().what()));
}

TEST(ErrorSet, EqualMessagesShareALine) {
  ErrorCollector errors;
  for (std::uint64_t key = 20; key > 0; --key)
    record(errors, key, [] { throw StorageError("cannot open scan.nrrd"); });
  EXPECT_STREQ(caught(errors).what(),
               "stitch: 20 units failed:\n"
               "  unit 1, unit 2, unit 3, unit 4 and 16 more: cannot open scan.nrrd");
}

TEST(ErrorSet, NothingRecordedThrowsNothing) {
  ErrorCollector errors;
  EXPECT_NO_THROW(errors.throw_if_any("build"));
}

}  // namespace
}  // namespace voxweld
