#include "storage/artifact/node_record_bytes.h"

#include <gtest/gtest.h>

#include <functional>

namespace voxweld {
namespace {

ClusterRecord cluster(std::uint64_t code, std::int32_t euler) {
  ClusterRecord made;
  made.qef.r = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  made.qef.mass = {0.1F, 0.2F, 0.3F};
  made.normals.sum[0] = {0, 0.6F, 0.8F};
  made.offset = {-0.5F, 0.25F, 0};
  made.residual = 0.01F;
  made.first = FirstSheet::make(code, 2);
  made.euler = euler;
  made.collapses = euler == 1 ? 1 : 0;
  made.leaves.leaves[3] = 17;
  made.leaves.errors[3] = 0.09F;
  return made;
}

NodeRecord record() {
  NodeRecord made;
  made.closes = true;
  made.clusters = {cluster(5, 1), cluster(77, -2)};
  made.curves = {{Crossing::make(0, {1, 2, 3}), Crossing::make(1, {4, 5, 6}), 0, 2, 0},
                 {Crossing::make(2, {7, 8, 9}), Crossing::make(2, {7, 8, 9}), 1, 5, 1}};
  made.pairs = {{0, 1}};
  return made;
}

ReducedNode reduced() {
  ReducedNode made;
  made.record = record();
  made.leaves = {{FirstSheet::make(5, 2), 7, 1, {}, 0.05F}};
  made.nodes = {{0, 0, 1}, {64, 2, 0}};
  made.links = {{0, 1}, {no_cluster, no_cluster}, {no_cluster, 0}};
  made.counts.leaves[0] = 4;
  made.counts.leaves[max_levels] = 1;
  return made;
}

std::vector<std::byte> bytes_of(const ReducedNode& node) {
  std::vector<std::byte> bytes;
  put_bytes(node.record, bytes);
  put_links(node, bytes);
  return bytes;
}
bool reads(std::span<const std::byte> bytes) {
  ReducedNode node;
  RecordBytes in(bytes);
  return in.take(node.record) && in.take_links(node) && in.empty();
}

TEST(NodeRecordBytes, ComeBackAsTheyWere) {
  std::vector<std::byte> bytes;
  put_bytes(record(), bytes);
  put_bytes(reduced().record, bytes);
  put_links(reduced(), bytes);
  RecordBytes in(bytes);
  NodeRecord node;
  ReducedNode all;
  ASSERT_TRUE(in.take(node));
  ASSERT_TRUE(in.take(all.record));
  ASSERT_TRUE(in.take_links(all));
  EXPECT_TRUE(in.empty());
  EXPECT_FALSE(node.blocked);
  EXPECT_TRUE(node.closes);
  ASSERT_EQ(node.clusters.size(), 2u);
  EXPECT_EQ(node.clusters[1].first.code(), 77u);
  EXPECT_EQ(node.clusters[1].first.sheet(), 2);
  EXPECT_EQ(node.clusters[1].euler, -2);
  EXPECT_EQ(node.clusters[0].qef.r, cluster(5, 1).qef.r);
  EXPECT_EQ(node.clusters[0].leaves.leaves, cluster(5, 1).leaves.leaves);
  EXPECT_EQ(node.clusters[0].leaves.errors, cluster(5, 1).leaves.errors);
  EXPECT_EQ(node.curves[0].high[1], 5);
  EXPECT_EQ(node.curves[1].closed, 1);
  EXPECT_EQ(node.pairs, record().pairs);
  EXPECT_EQ(all.leaves[0].level, 7u);
  EXPECT_EQ(all.nodes[1].first_link, 2u);
  EXPECT_EQ(all.links[2].root, 0u);
  EXPECT_EQ(all.counts.leaves, reduced().counts.leaves);
  // The same record is the same bytes, whatever lay in memory before.
  EXPECT_EQ(bytes_of(all), bytes_of(reduced()));
}

TEST(NodeRecordBytes, ThatEndTooEarlyAreFound) {
  const std::vector<std::byte> bytes = bytes_of(reduced());
  ASSERT_TRUE(reads(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(reads(std::span(bytes).first(size))) << size;
}

TEST(NodeRecordBytes, ThatNameWhatIsNotThereAreFound) {
  const std::vector<std::function<void(ReducedNode&)>> faults = {
      [](ReducedNode& n) { n.record.curves[0].cluster = 2; },
      [](ReducedNode& n) { n.record.curves[0].face = 6; },
      [](ReducedNode& n) { n.record.curves[0].closed = 2; },
      [](ReducedNode& n) { n.record.pairs[0].second = 2; },
      [](ReducedNode& n) { n.record.clusters[0].collapses = 2; },
      [](ReducedNode& n) { n.record.clusters[0].normals.sense = NormalSense{2}; },
      [](ReducedNode& n) { n.leaves[0].level = max_levels + 1; },
      [](ReducedNode& n) { n.leaves[0].shares = 2; },
      [](ReducedNode& n) { n.nodes[1].first_link = 4; },
      [](ReducedNode& n) { n.nodes[1].code = 0; },
      [](ReducedNode& n) { n.nodes[0].first_link = 3; },
      [](ReducedNode& n) { n.nodes[0].covered = 2; },
      [](ReducedNode& n) { n.links[0].leaf = 1; },
      [](ReducedNode& n) { n.links[0].root = 2; }};
  for (std::size_t i = 0; i < faults.size(); ++i) {
    ReducedNode node = reduced();
    faults[i](node);
    EXPECT_FALSE(reads(bytes_of(node))) << i;
  }
}

TEST(NodeRecordBytes, AnyByteMayBeAnything) {
  std::vector<std::byte> bytes = bytes_of(reduced());
  std::size_t refused = 0;
  for (std::byte& byte : bytes)
    for (const unsigned bit : {0u, 3u, 7u}) {
      byte ^= std::byte{1} << bit;
      refused += reads(bytes) ? 0 : 1;
      byte ^= std::byte{1} << bit;
    }
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace voxweld
