#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pangaea {

// One of our programs as a child process, and what it prints. Killed with its owner. One thread.
class Program {
 public:
  // `words`: the file and its arguments; `folder`: where it runs.
  Program(std::vector<std::string> words, const std::filesystem::path& folder);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void Signal(int signal) const;
  // Waits until it printed the text. False when it ended without.
  bool WaitForOutput(const std::string& text);
  // Waits for its end. Its exit code; 128 + signal when one killed it.
  int Wait();
  // What it printed to both streams, as far as one of the above waited for it.
  const std::string& output() const { return output_; }

 private:
  bool ReadSome();

  pid_t process_ = -1;
  int pipe_ = -1;
  std::string output_;
};

}  // namespace pangaea
