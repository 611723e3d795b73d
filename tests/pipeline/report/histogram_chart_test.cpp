#include "pipeline/report/histogram_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "stages/ingest/statistics.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Histogram histogram_of(const std::vector<std::uint8_t>& samples) {
  HistogramStatistics statistics(SampleType::u8);
  statistics.add(std::as_bytes(std::span(samples)));
  return statistics.take();
}

TEST(HistogramChart, HasABarForEachValue) {
  const auto chart = histogram_chart(histogram_of({10, 10, 10, 11, 13, 13}), {{}, 11.5});
  // Cells 10, 11, 12 and 13; the highest is as high as the drawing, nothing stands at 12.
  EXPECT_THAT(chart.html, HasSubstr("viewBox=\"0 0 4 1000\""));
  EXPECT_THAT(chart.html, HasSubstr("d=\"M0 1000v-1000h1v1000zM1 1000v-500h1v500zM3 1000v-"));
  EXPECT_THAT(chart.html, HasSubstr("M2.000 0V1000"));  // the isovalue: from 9.5 halfway to 13.5
  EXPECT_THAT(chart.html, HasSubstr("left:50.00%\">isovalue 11.5<"));
}

TEST(HistogramChart, LeavesPaddingOutOfTheGreys) {
  std::vector<std::uint8_t> samples(100, 0);
  for (const int value : {90, 91, 92, 93, 140, 141, 142, 143})
    samples.insert(samples.end(), 50, static_cast<std::uint8_t>(value));
  const auto chart = histogram_chart(histogram_of(samples), {});
  EXPECT_EQ(chart.lo, 90);
  EXPECT_EQ(chart.hi, 143);
  EXPECT_THAT(chart.html, HasSubstr("d=\"M0 1000v-"));  // but not of the bars
}

TEST(HistogramChart, IsOfRealValues) {
  const auto chart = histogram_chart(histogram_of({10, 20}), {{2, -1000}, -970.0});
  EXPECT_EQ(chart.lo, -980);
  EXPECT_EQ(chart.hi, -960);
  EXPECT_THAT(chart.html, HasSubstr("isovalue -970"));
}

TEST(HistogramChart, ReachesToAnIsovalueBeyondAllSamples) {
  const auto chart = histogram_chart(histogram_of({10, 11, 12}), {{}, 30.0});
  EXPECT_EQ(chart.hi, 12);
  EXPECT_THAT(chart.html, HasSubstr("viewBox=\"0 0 21 1000\""));
  EXPECT_THAT(chart.html, HasSubstr("mark left"));  // the text turns to where there is room
}

TEST(HistogramChart, WithoutAnIsovalueHasNoMark) {
  EXPECT_THAT(histogram_chart(histogram_of({1, 2}), {}).html, Not(HasSubstr("isovalue")));
}

TEST(HistogramChart, IsEmptyWhereNoSampleIsANumber) {
  Histogram nans;
  nans.type = SampleType::f32;
  nans.nans = 5;
  EXPECT_EQ(histogram_chart(nans, {}).html, "");
}

TEST(HistogramChart, TicksAreRound) {
  EXPECT_EQ(round_ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(round_ticks(-130, 130, 6), (std::vector<double>{-100, -50, 0, 50, 100}));
  EXPECT_EQ(round_ticks(3, 3, 6), std::vector<double>());
}

}  // namespace
}  // namespace voxweld
