#include "cli/command.h"
#include "cli/digest.h"
#include "cli/evaluate.h"
#include "cli/export.h"
#include "cli/import_keyframes.h"
#include "cli/lcm_publish.h"
#include "cli/plot.h"
#include "cli/simulate.h"
#include "cli/status.h"
#include "cli/undo.h"
#include "cli/vocabulary.h"
#include "common/base/blas_threads.h"

int main(int argc, char** argv) {
  using namespace pangaea;
  UseOneBlasThread();
  return RunCommandLine(
      {StatusCommand(), EvaluateCommand(), PlotCommand(), ExportCommand(), SimulateCommand(), DigestCommand(),
       UndoCommand(), VocabularyCommand(), LcmPublishCommand(), ImportKeyframesCommand()},
      argc, argv);
}
