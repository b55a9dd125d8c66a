#pragma once

namespace pangaea::testing {

// What the module that is built for the tests gives.
struct DoublingTable {
  static constexpr const char* kFile = "pangaea_module_of_a_test.so";
  static constexpr const char* kSymbol = "pangaea_module_of_a_test";
  static constexpr int kVersion = 7;

  int version = kVersion;
  int (*doubled)(int number);
};

}  // namespace pangaea::testing
