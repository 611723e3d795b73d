// Builders of shards for the threads of a stage.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "pipeline/build/shard_builder.h"

namespace voxweld {

// One for each thread of the stage, for whoever needs one. Thread-safe.
class ShardBuilders {
 public:
  ShardBuilders(const BuildJob& job, int count);

  class Loan {
   public:
    Loan(ShardBuilders& of, ShardBuilder* builder) : of_(&of), builder_(builder) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() {
      if (builder_ != nullptr) of_->give_back(builder_);
    }
    explicit operator bool() const { return builder_ != nullptr; }
    ShardBuilder* operator->() const { return builder_; }
    ShardBuilder& operator*() const { return *builder_; }

   private:
    ShardBuilders* of_;
    ShardBuilder* builder_;
  };
  // Waits until one is free; helpers give theirs back soon.
  Loan borrow();
  // None where none is free.
  Loan borrow_if_free();
  const std::vector<std::unique_ptr<ShardBuilder>>& all() const { return all_; }

 private:
  Loan take();
  void give_back(ShardBuilder* builder);

  std::vector<std::unique_ptr<ShardBuilder>> all_;
  std::mutex mutex_;
  std::condition_variable freed_;
  std::vector<ShardBuilder*> free_;
};

}  // namespace voxweld
