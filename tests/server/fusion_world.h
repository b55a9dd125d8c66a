#pragma once

#include <cstddef>
#include <vector>

#include "server/fusion/welding.h"
#include "tests/server/surveyed_world.h"

namespace pangaea::testing {

inline constexpr SessionId kOlder = 0x11;
inline constexpr SessionId kNewer = 0x22;

// A random motion (up to a radian and some metres) and this scale.
Similarity3d RandomFrame(std::uint64_t seed, double scale = 1.0);

// Two sessions in one room that overlap by half, each in a random frame with the scale given. The second begins later
// than the first, by 1000 s and what its options say.
SurveyedWorld TwoMaps(std::uint64_t seed, const SurveyOptions& newer = {}, const SurveyOptions& older = {});
// A match in the middle of their overlap.
PlaceMatch MiddleMatch(const SurveyedWorld& world);
std::vector<KeyframeId> AllKeyframes(const SurveyedWorld& world);

// Two sessions that flew the same way, welded where both are at the keyframe `at` of it.
struct WeldedFlights {
  WeldedFlights(std::uint64_t seed, const std::vector<Rigid3d>& way, std::size_t at, const FusionOptions& options = {});
  SurveyedWorld world;  // before
  Atlas merged;
};

// What the owner of an atlas does with a plan. Fails the test where an edit of the correction does not fit.
void Carry(const WeldingPlan& plan, Atlas& atlas);

// The largest distance between where keyframes are, seen from the first of them, and where they truly are. Map units,
// `scale` of them to a metre.
double WorstError(const SurveyedWorld& world, const Atlas& atlas, const std::vector<KeyframeId>& keyframes,
                  double scale = 1.0);
// Corners that have more than one landmark.
std::size_t CountDuplicates(const SurveyedWorld& world, const Atlas& atlas);
// Landmarks whose observations show different corners.
std::size_t CountMixed(const SurveyedWorld& world, const Atlas& atlas);

}  // namespace pangaea::testing
