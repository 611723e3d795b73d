// Medians of few keys by comparing and exchanging alone, the same steps for every sample: loops
// over a row become vectors. Rows of a set lie `pitch` keys apart or are named one by one.
#pragma once

#include <cstdint>

namespace voxweld::filter_detail {

template <class K>
K lesser(K a, K b) {
  return a < b ? a : b;
}
template <class K>
K greater(K a, K b) {
  return a < b ? b : a;
}
template <class K>
void exchange(K& a, K& b) {
  const K low = lesser(a, b);
  b = greater(a, b);
  a = low;
}
template <class K>
void sort_three(K& a, K& b, K& c) {
  exchange(a, b);
  exchange(b, c);
  exchange(a, b);
}
template <class K>
K middle_of(K a, K b, K c) {
  exchange(a, b);
  return greater(a, lesser(b, c));
}

// out[x] of three rows.
template <class K>
void median_of_three(const K* const* rows, std::int64_t count, K* __restrict out) {
  const K *a = rows[0], *b = rows[1], *c = rows[2];
  for (std::int64_t x = 0; x < count; ++x) out[x] = middle_of(a[x], b[x], c[x]);
}

// Each three keys sorted into three rows.
template <class K>
void sort_three_rows(const K* const* rows, std::int64_t count, K* __restrict out,
                     std::int64_t pitch) {
  const K *a = rows[0], *b = rows[1], *c = rows[2];
  for (std::int64_t x = 0; x < count; ++x) {
    K low = a[x], middle = b[x], high = c[x];
    sort_three(low, middle, high);
    out[x] = low;
    out[x + pitch] = middle;
    out[x + 2 * pitch] = high;
  }
}

// Of nine rows: three sets of three sorted ones, each after the other. The median is that of the
// greatest of the least, the middle of the middle and the least of the greatest.
template <class K>
void median_of_nine(const K* const* rows, std::int64_t count, K* __restrict out) {
  const K *r0 = rows[0], *r1 = rows[1], *r2 = rows[2], *r3 = rows[3], *r4 = rows[4], *r5 = rows[5],
          *r6 = rows[6], *r7 = rows[7], *r8 = rows[8];
#pragma GCC ivdep
  for (std::int64_t x = 0; x < count; ++x) {
    K a = r0[x], b = r1[x], c = r2[x], d = r3[x], e = r4[x], f = r5[x], g = r6[x], h = r7[x],
      i = r8[x];
    sort_three(a, b, c);
    sort_three(d, e, f);
    sort_three(g, h, i);
    out[x] = middle_of(greater(greater(a, d), g), middle_of(b, e, h), lesser(lesser(c, f), i));
  }
}

// Three sets of three sorted rows become nine sorted rows. R. W. Floyd's network of 25 exchanges
// for nine keys, less the nine that sort threes (Knuth, "The Art of Computer Programming" 3,
// 5.3.4).
template <class K>
void sort_nine_rows(const K* const* triples, std::int64_t count, K* __restrict out,
                    std::int64_t pitch) {
  const K *p = triples[0], *q = triples[1], *r = triples[2];
#pragma GCC ivdep
  for (std::int64_t x = 0; x < count; ++x) {
    K v0 = p[x], v1 = p[x + pitch], v2 = p[x + 2 * pitch];
    K v3 = q[x], v4 = q[x + pitch], v5 = q[x + 2 * pitch];
    K v6 = r[x], v7 = r[x + pitch], v8 = r[x + 2 * pitch];
    sort_three(v0, v3, v6);
    sort_three(v1, v4, v7);
    sort_three(v2, v5, v8);
    exchange(v1, v3);
    exchange(v5, v7);
    exchange(v2, v6);
    exchange(v4, v6);
    exchange(v2, v4);
    exchange(v2, v3);
    exchange(v5, v6);
    out[x] = v0;
    out[x + pitch] = v1;
    out[x + 2 * pitch] = v2;
    out[x + 3 * pitch] = v3;
    out[x + 4 * pitch] = v4;
    out[x + 5 * pitch] = v5;
    out[x + 6 * pitch] = v6;
    out[x + 7 * pitch] = v7;
    out[x + 8 * pitch] = v8;
  }
}

// The median of the 27 keys of three neighbouring columns, each of nine sorted keys; out[x] of the
// columns x, x + 1 and x + 2. Sorting the three keys of each rank too keeps the columns sorted. Of
// such a table of 9 by 3, the place of a key says how many keys cannot be above it and how many not
// below it: 13 keys remain that can be the median, seven below and seven above are out.
template <class K>
void median_of_columns(const K* sorted, std::int64_t pitch, std::int64_t count, K* __restrict out) {
#pragma GCC ivdep
  for (std::int64_t x = 0; x < count; ++x) {
    const K* s = sorted + x;
    const auto rank = [&](int i, int column) { return s[i * pitch + column]; };
    const auto least = [&](int i) { return lesser(lesser(rank(i, 0), rank(i, 1)), rank(i, 2)); };
    const auto middle = [&](int i) { return middle_of(rank(i, 0), rank(i, 1), rank(i, 2)); };
    const auto most = [&](int i) { return greater(greater(rank(i, 0), rank(i, 1)), rank(i, 2)); };
    // Two sorted fours become a sorted eight (K. E. Batcher's merge). Of it, the first and the last
    // are not asked for.
    K d0 = least(5), d1 = least(6), d2 = least(7), d3 = least(8);
    K d4 = most(0), d5 = most(1), d6 = most(2), d7 = most(3);
    exchange(d0, d4);
    exchange(d1, d5);
    exchange(d2, d6);
    exchange(d3, d7);
    exchange(d2, d4);
    exchange(d3, d5);
    exchange(d1, d2);
    exchange(d3, d4);
    exchange(d5, d6);
    // The seventh of these eight and the five in the middle: the least, over all ways to take seven
    // from the lower ends of both, of the greatest that is taken.
    K seventh = d6;
    seventh = lesser(seventh, greater(d5, middle(2)));
    seventh = lesser(seventh, greater(d4, middle(3)));
    seventh = lesser(seventh, greater(d3, middle(4)));
    seventh = lesser(seventh, greater(d2, middle(5)));
    seventh = lesser(seventh, greater(d1, middle(6)));
    out[x] = seventh;
  }
}

}  // namespace voxweld::filter_detail
