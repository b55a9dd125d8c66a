#include "common/base/module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/text.h"
#include "tests/base/module_of_a_test.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::AllOf;
using testing::DoublingTable;
using ::testing::HasSubstr;

struct LaterTable : DoublingTable {
  static constexpr int kVersion = 8;
};
struct OtherTable : DoublingTable {
  static constexpr const char* kSymbol = "pangaea_something_else";
};

template <typename Table>
Error ErrorOf(const std::filesystem::path& folder) {
  const auto table = OpenModule<Table>(folder);
  return table ? Error{ErrorCode::kRefused, "opened"} : table.error();
}

TEST(Module, IsFoundBesideTheFolderOfTheProgram) {
  EXPECT_EQ(ModuleFolder(), std::filesystem::path(PANGAEA_MODULES));
  const auto table = OpenModule<DoublingTable>(ModuleFolder());
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ((*table)->doubled(21), 42);
}

TEST(Module, AMissingOneIsAnErrorThatNamesItsPlace) {
  const testing::TemporaryFolder empty;
  const Error error = ErrorOf<DoublingTable>(empty.path());
  EXPECT_EQ(error.code, ErrorCode::kNotFound);
  EXPECT_THAT(error.message, HasSubstr((empty.path() / DoublingTable::kFile).string()));
}

TEST(Module, ATruncatedOneIsAnErrorWhereverItEnds) {
  const testing::TemporaryFolder folder;
  const std::string whole = *ReadTextFile(std::filesystem::path(PANGAEA_MODULES) / DoublingTable::kFile);
  for (std::size_t length = 0; length < whole.size() / 2; length += 1 + length / 3) {
    ASSERT_TRUE(WriteTextFile(folder.path() / DoublingTable::kFile, whole.substr(0, length)));
    EXPECT_THAT(ErrorOf<DoublingTable>(folder.path()).message, HasSubstr("cannot be opened")) << length;
  }
}

TEST(Module, AFileThatIsNoLibraryIsAnErrorThatNamesIt) {
  const testing::TemporaryFolder folder;
  for (const char* text : {"",
                           "\x7F"
                           "ELF",
                           "this is no library"}) {
    ASSERT_TRUE(WriteTextFile(folder.path() / DoublingTable::kFile, text));
    EXPECT_THAT(ErrorOf<DoublingTable>(folder.path()).message,
                AllOf(HasSubstr((folder.path() / DoublingTable::kFile).string()), HasSubstr("cannot be opened")));
  }
}

TEST(Module, ALibraryWithoutTheTableIsAnErrorThatNamesBoth) {
  EXPECT_THAT(ErrorOf<OtherTable>(PANGAEA_MODULES).message,
              AllOf(HasSubstr(DoublingTable::kFile), HasSubstr("pangaea_something_else")));
}

TEST(Module, OneOfAnotherVersionIsAnErrorWithBothVersions) {
  const Error error = ErrorOf<LaterTable>(PANGAEA_MODULES);
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.message, AllOf(HasSubstr("has version 7"), HasSubstr("needs version 8")));
}

}  // namespace
}  // namespace pangaea
