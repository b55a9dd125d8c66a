#include "tests/base/module_of_a_test.h"

namespace {
int Double(int number) { return 2 * number; }
}  // namespace

extern "C" __attribute__((visibility("default"))) const pangaea::testing::DoublingTable pangaea_module_of_a_test;
const pangaea::testing::DoublingTable pangaea_module_of_a_test{.doubled = &Double};
