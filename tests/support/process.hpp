#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace planemap {

/// A program that a test starts. It ends with the test, whatever happens: killed by the destructor, and by the kernel
/// if the test dies.
class Process {
 public:
  /// Starts a program; its stdout and stderr go to a file.
  /// @param arguments  program and arguments; looked up in PATH unless it has a slash
  /// @param output     file, written anew
  /// @throws std::runtime_error if it cannot be started
  Process(const std::vector<std::string>& arguments, std::filesystem::path output);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool running();
  void send_signal(int signal);
  /// Waits for its end. The exit code, 128 + signal if a signal ended it; empty: it still runs.
  std::optional<int> wait_for(std::chrono::milliseconds limit);

  std::string output() const;  ///< what it wrote so far
  pid_t pid() const { return pid_; }

 private:
  void reap(int options);

  pid_t pid_ = -1;
  int pid_fd_ = -1;
  std::optional<int> exit_code_;
  std::filesystem::path output_;
};

/// What a program that has ended left behind.
struct Finished {
  int exit_code = -1;  ///< 128 + signal if a signal ended it
  std::string out;
  std::string err;
};

/// Runs a program to its end; killed, exit code 137, if that takes longer than the limit.
/// @param scratch  folder for its output
Finished run_program(const std::vector<std::string>& arguments, const std::filesystem::path& scratch,
                     std::chrono::milliseconds limit);

/// Runs a command of the shell's to its end, ten minutes at most.
/// @param scratch  folder for its output
Finished run_in_shell(const std::string& command, const std::filesystem::path& scratch);

/// The file's whole content; empty if there is none.
std::string read_file(const std::filesystem::path& path);

}  // namespace planemap
