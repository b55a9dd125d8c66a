#include "cli/command.h"
#include "cli/simulate.h"

int main(int argc, char** argv) { return pangaea::RunCommandLine({pangaea::SimulateCommand()}, argc, argv); }
