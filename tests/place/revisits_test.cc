#include "tests/place/revisits.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/place/shipped_vocabulary.h"
#include "tests/place/surveyed_recording.h"

namespace pangaea {
namespace {

using namespace testing;

// Real recordings lie outside of the repository.
std::filesystem::path RecordingWithRevisits() {
  const char* shared = std::getenv("PANGAEA_SHARED");
  return std::filesystem::path(shared != nullptr ? shared : PANGAEA_SOURCE_DIR "/../shared") /
         "data/euroc_V1_01_keyframes";
}

void Print(const std::vector<PrecisionRecall>& curve) {
  double last_recall = -1.0;
  for (const PrecisionRecall& point : curve) {
    if (point.recall < last_recall + 0.1) continue;
    last_recall = point.recall;
    std::printf("  score >= %.4f: precision %.3f, recall %.3f\n", point.threshold, point.precision, point.recall);
  }
}

TEST(Revisits, TheFirstCandidateFindsPlacesSeenBeforeWithoutAFalseOne) {
  const std::filesystem::path folder = RecordingWithRevisits();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here; set PANGAEA_SHARED";
  const auto vocabulary = ReadShippedVocabulary();
  ASSERT_TRUE(vocabulary) << vocabulary.error().message;
  const auto keyframes = ReadSurveyedKeyframes(folder, 1000);
  ASSERT_TRUE(keyframes) << keyframes.error().message;
  ASSERT_EQ(keyframes->size(), 100U);

  // 25 keyframes are within 0.75 m and 20 degrees of one more than 20 keyframes (about 20 s) earlier.
  const RevisitLimits near{.least_gap = 20, .distance = 0.75, .angle = 20.0};
  const auto lookups = LookUpAll(*keyframes, *vocabulary, near);
  EXPECT_EQ(std::ranges::count(lookups, true, &Lookup::is_revisit), 25);
  const auto curve = PrecisionRecallCurve(lookups);
  std::printf("revisits within 0.75 m and 20 degrees, more than 20 keyframes earlier: recall at full precision %.3f\n",
              RecallAtFullPrecision(curve));
  Print(curve);
  EXPECT_GE(RecallAtFullPrecision(curve), 0.6);
  const auto right_first = std::ranges::count_if(
      lookups, [](const Lookup& lookup) { return lookup.is_revisit && lookup.candidate_is_right; });
  EXPECT_GE(right_first, 23) << "of 25 first candidates";

  const RevisitLimits wide{.least_gap = 10, .distance = 1.0, .angle = 30.0};
  const auto wide_curve = PrecisionRecallCurve(LookUpAll(*keyframes, *vocabulary, wide));
  std::printf("within 1 m and 30 degrees, more than 10 keyframes earlier: recall at full precision %.3f\n",
              RecallAtFullPrecision(wide_curve));
  Print(wide_curve);
  EXPECT_GE(wide_curve.back().recall, 0.85);
}

}  // namespace
}  // namespace pangaea
