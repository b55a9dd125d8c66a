#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/dds/two_processes.h"

namespace pangaea {
namespace {

TEST(DdsConfiguration, TheShippedFileIsTheBuiltInDefault) {
  std::ifstream file(PANGAEA_SOURCE_DIR "/config/cyclonedds-loopback.xml");
  ASSERT_TRUE(file);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), kLoopbackConfiguration);
}

TEST(DdsConfiguration, ABrokenConfigurationIsAnErrorThatSaysSo) {
  DomainOptions options = TestDomain(11);
  options.configuration = "<CycloneDDS><Domain><NoSuchElement/></Domain></CycloneDDS>";
  const auto domain = Domain::Open(options);
  ASSERT_FALSE(domain);
  EXPECT_NE(domain.error().message.find("configuration"), std::string::npos);
}

TEST(DdsConfiguration, TheEnvironmentsConfigurationIsUsedWhereNoneIsGiven) {
  DomainOptions options = TestDomain(12);
  options.configuration.clear();
  setenv("CYCLONEDDS_URI", "<CycloneDDS><Domain><NoSuchElement/></Domain></CycloneDDS>", 1);
  EXPECT_FALSE(Domain::Open(options));
  setenv("CYCLONEDDS_URI", "file://" PANGAEA_SOURCE_DIR "/config/cyclonedds-loopback.xml", 1);
  EXPECT_TRUE(Domain::Open(options));
  unsetenv("CYCLONEDDS_URI");
}

TEST(DdsConfiguration, ImpossibleOptionsAndSitesAreRefused) {
  DomainOptions options = TestDomain(13);
  options.discovery_tag = "</Tag>";
  EXPECT_FALSE(Domain::Open(options));
  options = TestDomain(231);
  EXPECT_FALSE(Domain::Open(options));
  for (const char* site : {"", "*", "a b", "hall/1"}) EXPECT_FALSE(CheckSiteName(site)) << site;
  EXPECT_TRUE(CheckSiteName("hall-1.b_2"));
}

TEST(DdsConfiguration, ADomainCannotBeOpenedTwiceAtOnce) {
  const auto first = Domain::Open(TestDomain(14));
  ASSERT_TRUE(first);
  EXPECT_FALSE(Domain::Open(TestDomain(14)));
}

}  // namespace
}  // namespace pangaea
