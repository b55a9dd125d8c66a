#include <gtest/gtest.h>

#include "server/place_recognition/place_recognition_options.h"

namespace pangaea {
namespace {

TEST(PlaceRecognitionOptions, DefaultsAreInRangeAndANonsenseValueIsNamed) {
  EXPECT_TRUE(PlaceRecognitionOptions{}.Check());
  const auto message = [](const auto& change) {
    PlaceRecognitionOptions options;
    change(options);
    const Status status = options.Check();
    return status ? std::string("accepted") : status.error().message;
  };
  EXPECT_NE(message([](auto& o) { o.candidates.places = 0; }).find("places"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.candidates.query.min_score = 2.0; }).find("min_score"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.geometry.min_inliers = 3; }).find("min_inliers"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.geometry.noise.pixel_sigma = 0.0; }).find("pixel_sigma"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.geometry.wide_radius = 1.0; }).find("wide_radius"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.agreement.contradicting_cell_share = 0.5; }).find("contradicting_cell_share"),
            std::string::npos);
  EXPECT_NE(message([](auto& o) { o.agreement.keyframes = 0; }).find("keyframes"), std::string::npos);
}

}  // namespace
}  // namespace pangaea
