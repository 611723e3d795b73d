#include "pipeline/build/shard_builders.h"

namespace voxweld {

ShardBuilders::ShardBuilders(const BuildJob& job, int count) {
  for (int i = 0; i < count; ++i) {
    all_.push_back(std::make_unique<ShardBuilder>(job, *this));
    free_.push_back(all_.back().get());
  }
}

ShardBuilders::Loan ShardBuilders::borrow() {
  std::unique_lock lock(mutex_);
  freed_.wait(lock, [&] { return !free_.empty(); });
  return take();
}

ShardBuilders::Loan ShardBuilders::borrow_if_free() {
  const std::scoped_lock lock(mutex_);
  return take();
}

// With the lock held.
ShardBuilders::Loan ShardBuilders::take() {
  ShardBuilder* builder = nullptr;
  if (!free_.empty()) {
    builder = free_.back();
    free_.pop_back();
  }
  return {*this, builder};
}

void ShardBuilders::give_back(ShardBuilder* builder) {
  {
    const std::scoped_lock lock(mutex_);
    free_.push_back(builder);
  }
  freed_.notify_one();
}

}  // namespace voxweld
