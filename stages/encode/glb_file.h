// A glTF binary in the making: what the kinds of them have in common.
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "stages/encode/byte_sink.h"
#include "stages/encode/glb.h"
#include "stages/encode/glb_format.h"

namespace voxweld::glb {

inline constexpr int target_vertices = 34962, target_indices = 34963;
// Of the columns of tables, which may be of 64 bits: in the file, and so of the chunks too.
inline constexpr std::size_t table_alignment = 8;

// Its JSON, and the pieces of its binary chunk: one node, one mesh, one primitive of triangles.
class GlbFile {
 public:
  // Keeps the reference.
  explicit GlbFile(const GlbParameters& parameters) : parameters_(parameters) {}
  GlbFile(const GlbFile&) = delete;
  GlbFile& operator=(const GlbFile&) = delete;

  // The piece has to outlive the file, unless it is kept. Returns the view's number.
  template <class T>
  std::size_t add_view(std::span<const T> piece, int target = 0, std::size_t alignment = 4) {
    return add_bytes(std::as_bytes(piece), target, alignment);
  }
  // Returns what is kept.
  std::span<const std::byte> keep(std::vector<std::byte> bytes) {
    return own_.emplace_back(std::move(bytes));
  }
  // A view of so many bytes in a buffer that is not there: the view's extension says how it is made of
  // the piece.
  std::size_t add_absent_view(std::span<const std::byte> piece, std::size_t bytes, Json view);

  // Of points, without a view.
  Json& add_attribute(const char* name, int component, std::uint64_t count, const char* type);
  // Of the triangles.
  Json& add_corners(std::uint64_t count);
  Json& primitive() { return primitive_; }
  // Whoever reads the file has to know the extension.
  void require(const char* extension) { required_.push_back(extension); }
  void add_table(std::span<const MaterialPair> pairs);
  const GlbParameters& parameters() const { return parameters_; }

  // InputError past 4 GiB.
  void write(const ByteSink& sink);

 private:
  std::size_t add_bytes(std::span<const std::byte> piece, int target, std::size_t alignment);
  Json document() const;

  const GlbParameters& parameters_;
  Json accessors_ = Json::array(), views_ = Json::array();
  Json primitive_ = Json::object(), metadata_ = nullptr;
  std::vector<const char*> required_;
  std::vector<std::span<const std::byte>> pieces_;
  std::vector<std::size_t> places_;  // where each piece begins
  std::deque<std::vector<std::byte>> own_;
  std::size_t size_ = 0;         // of the pieces, each but the last one padded
  std::size_t absent_size_ = 0;  // of the buffer that is not there
};

// The colours and numbers of the pairs of a mesh between labels, for each point: both of four bytes.
struct PointFeatures {
  std::vector<std::byte> colours, ids;  // ids are floats
};
PointFeatures point_features(const DecodedMesh& mesh, const MaterialTable* materials);

}  // namespace voxweld::glb
