#include "tests/server/server_process.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

extern char** environ;

namespace pangaea {

ServerProcess::ServerProcess(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{PANGAEA_SERVER_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  if (posix_spawn(&process_, pointers.front(), nullptr, nullptr, pointers.data(), environ) != 0) process_ = -1;
}

ServerProcess::~ServerProcess() {
  Signal(SIGKILL);
  (void)Wait();
}

void ServerProcess::Signal(int signal) const {
  if (process_ > 0) kill(process_, signal);
}

int ServerProcess::Wait() {
  if (process_ <= 0) return -1;
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  constexpr int kKilled = 128;
  return WIFEXITED(status) ? WEXITSTATUS(status) : kKilled + WTERMSIG(status);
}

void UseOwnDiscoveryTag() { setenv("PANGAEA_DDS_TAG", ("server-test-" + std::to_string(getpid())).c_str(), 1); }

}  // namespace pangaea
