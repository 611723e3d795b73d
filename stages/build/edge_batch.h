// Eight edges of one axis on their way through the kernel for smooth ones; those that may have a kink,
// or are near the volume's border, go to the estimator one by one. The same bits as if all did.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "stages/build/edge_estimator.h"
#include "stages/build/edge_kernels.h"

namespace voxweld {

// Types whose differences are doubles that neither round nor overflow.
template <class T>
inline constexpr bool has_edge_kernel = !has_base<T> && !std::is_same_v<T, double>;

template <class T>
class EdgeBatch {
 public:
  // The block and the estimator of it, and where the edges go, outlive it.
  EdgeBatch(const HaloBlock& block, const ContourParameters& parameters,
            const EdgeEstimator<T>& estimator, std::span<HermiteEdge> edges)
      : block_(block),
        estimator_(estimator),
        edges_(edges),
        kernel_(edge_kernel()),
        rule_{0, parameters.surface.isovalue.value,
              parameters.surface.inside == Inside::above ? -1.0 : 1.0, parameters.spacing,
              parameters.surface.noise} {
    if (parameters.surface.isovalue.rest != 0) rule_.isovalue = 0;
  }

  // The edge number `to` along `axis` from sample s.
  void add(std::size_t to, int axis, Index3 s, bool low_inside) {
    if (!is_inner(axis, s)) {
      edges_[to] = estimator_.edge(axis, s, low_inside);
      return;
    }
    if (axis != rule_.axis) {
      flush();
      rule_.axis = axis;
    }
    load(s);
    waiting_[count_] = {to, s, low_inside};
    if (++count_ == lanes) flush();
  }
  void flush() {
    if (count_ == 0) return;
    kernel_(stencils_, rule_, lanes_);
    for (std::size_t i = 0; i < count_; ++i) {
      const Waiting& edge = waiting_[i];
      HermiteEdge& out = edges_[edge.to];
      if (lanes_.smooth[i] == 0) {
        out = estimator_.edge(rule_.axis, edge.sample, edge.low_inside);
        continue;
      }
      out.t = static_cast<float>(lanes_.t[i]);
      for (std::size_t a = 0; a < 3; ++a) out.normal[a] = static_cast<float>(lanes_.normal[a][i]);
    }
    count_ = 0;
  }

 private:
  struct Waiting {
    std::size_t to = 0;
    Index3 sample;
    bool low_inside = false;
  };

  // Whether the volume has all samples of the stencil.
  bool is_inner(int axis, Index3 s) const {
    for (int a = 0; a < 3; ++a) {
      const std::int64_t before = a == axis ? 2 : 1, behind = a == axis ? 3 : 1;
      if (s[a] < before || s[a] + behind >= block_.size[a]) return false;
    }
    return true;
  }
  void load(Index3 s) {
    const std::array<std::int64_t, 3> strides = {1, block_.row, block_.slice};
    const Index3 d = s - block_.samples.lo;
    const T* low =
        reinterpret_cast<const T*>(block_.data) + d.z * block_.slice + d.y * block_.row + d.x;
    const std::int64_t step = strides[static_cast<std::size_t>(rule_.axis)];
    for (std::int64_t k = 0; k < 6; ++k)
      stencils_.along[static_cast<std::size_t>(k)][count_] =
          static_cast<double>(low[(k - 2) * step]);
    std::size_t other = 0;
    for (int a = 0; a < 3; ++a) {
      if (a == rule_.axis) continue;
      const std::int64_t across = strides[static_cast<std::size_t>(a)];
      auto& ends = stencils_.beside[other++];
      for (std::size_t end = 0; end < 2; ++end) {
        const T* at = low + static_cast<std::int64_t>(end) * step;
        ends[end][0][count_] = static_cast<double>(at[-across]);
        ends[end][1][count_] = static_cast<double>(at[across]);
      }
    }
  }

  EdgeStencils stencils_;
  EdgeLanes lanes_;
  const HaloBlock& block_;
  const EdgeEstimator<T>& estimator_;
  std::span<HermiteEdge> edges_;
  EdgeKernel kernel_;
  EdgeRule rule_;
  std::array<Waiting, lanes> waiting_;
  std::size_t count_ = 0;
};

}  // namespace voxweld
