#include "cli/command.h"
#include "cli/digest.h"
#include "cli/simulate.h"
#include "cli/status.h"

int main(int argc, char** argv) {
  using namespace pangaea;
  return RunCommandLine({StatusCommand(), SimulateCommand(), DigestCommand()}, argc, argv);
}
