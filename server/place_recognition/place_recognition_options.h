#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/result.h"
#include "common/features/matching.h"
#include "common/mapping/measurement_noise.h"
#include "common/place/inverted_index.h"

namespace pangaea {

// Which keyframes are worth a look.
struct PlaceCandidateOptions {
  PlaceQueryOptions query = {.candidates = 20};
  // Places verified at most, best first; candidates that see a common landmark are one place. Each costs about a
  // millisecond even where it is another place.
  std::size_t places = 3;
  // Two keyframes of the query's surroundings must share this many landmarks for the surroundings to go on beyond them:
  // with fewer, one wrong match would hide a loop.
  std::uint32_t min_shared = 15;

  Status Check() const;
};

// When two keyframes are believed to show one place.
struct PlaceGeometryOptions {
  // Covisible keyframes whose landmarks are added to a keyframe's own, on either side.
  std::size_t covisible = 8;
  MeasurementNoiseOptions noise;
  // Of landmarks without an idea where they are.
  MatchOptions matching = {.max_distance = 60, .max_ratio = 0.8};
  // Matches between the two keyframes themselves below which a candidate is given up: chance gives 4 in the median, 14
  // at most.
  std::size_t min_own_matches = 8;
  // Matches below which no motion is sought; with fewer, the landmarks around the candidate are matched as well.
  std::size_t min_matches = 15;
  int ransac_iterations = 300;
  // A motion from three points is off by their noise: so many sigmas count as fitting.
  double ransac_sigmas = 5.0;
  std::size_t min_aligned = 12;  // matches that fit the best motion of RANSAC
  // Half the window in which a landmark is looked for once a motion is known, octave pixels; first and second search.
  double wide_radius = 10.0;
  double narrow_radius = 5.0;
  int octave_tolerance = 1;
  double max_view_angle = 60.0;  // degrees between the old and the new view of a landmark: descriptors differ beyond
  // Of landmarks with an idea where they are.
  MatchOptions guided_matching = {.max_distance = 60, .max_ratio = 0.9};
  std::size_t min_guided = 20;   // landmark pairs that fit after the first guided search
  std::size_t min_inliers = 30;  // after the second

  Status Check() const;
};

// When the keyframes of the query's surroundings confirm the motion.
struct PlaceAgreementOptions {
  // That confirm it, the query itself included (Elvira et al. 2019, "Seamless map merging": three).
  std::size_t keyframes = 3;
  std::size_t covisible = 6;  // best covisible keyframes of the query that are asked
  // Keyframes around the candidate among which those are sought that look where an asked one should look, and how many
  // of them it is compared with.
  std::size_t window = 40;
  std::size_t lookalikes = 4;
  // Between their optical axes at most, degrees: beyond, they say nothing about each other.
  double max_axis_angle = 45.0;
  double radius = 5.0;           // octave pixels around where the landmarks should be
  std::size_t min_matches = 15;  // landmarks that must be found for a yes
  // Part of the image's cells, of those in which several landmarks should be, that must hold some for a yes, and below
  // which it is a no. Most landmarks in view are not found again, in all of the image alike: of ten cells, where the
  // motion is right, 4 to 10 hold some, where it is not, at most 2. A thing that stands in two places fills its own
  // cells.
  double min_cell_share = 0.3;
  double contradicting_cell_share = 0.15;
  std::size_t min_cells = 8;  // for a no: of so many
  // Further keyframes of the map after which a motion that too few could confirm so far is forgotten.
  std::size_t patience = 10;

  Status Check() const;
};

struct PlaceRecognitionOptions {
  PlaceCandidateOptions candidates;
  PlaceGeometryOptions geometry;
  PlaceAgreementOptions agreement;
  std::uint64_t seed = 1;  // the same keyframes in the same order with the same seed give the same matches

  Status Check() const;
};

}  // namespace pangaea
