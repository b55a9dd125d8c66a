#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pangaea {

// The server program as a child process. Killed with its owner.
class ServerProcess {
 public:
  explicit ServerProcess(const std::vector<std::string>& arguments);
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  void Signal(int signal) const;
  // Waits for its end. Its exit code; 128 + signal when one killed it.
  int Wait();

 private:
  pid_t process_ = -1;
};

// What the child inherits: a discovery tag that no other test program has.
void UseOwnDiscoveryTag();

}  // namespace pangaea
