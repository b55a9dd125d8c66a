#include "tests/cli/command_run.h"

#include <gtest/gtest.h>

#include "cli/command.h"
#include "cli/digest.h"
#include "cli/evaluate.h"
#include "cli/export.h"
#include "cli/import_keyframes.h"
#include "cli/plot.h"

namespace pangaea::testing {

CommandRun RunPangaea(const std::vector<std::string>& arguments) {
  std::vector<const char*> words{"pangaea"};
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  CommandRun run;
  run.exit_code =
      RunCommandLine({EvaluateCommand(), ExportCommand(), PlotCommand(), DigestCommand(), ImportKeyframesCommand()},
                     static_cast<int>(words.size()), words.data());
  run.out = ::testing::internal::GetCapturedStdout();
  run.err = ::testing::internal::GetCapturedStderr();
  return run;
}

}  // namespace pangaea::testing
