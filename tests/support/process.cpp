#include "support/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace planemap {
namespace {

/// In the child, between fork and exec: only calls that are safe there.
[[noreturn]] void become(char* const* argv, const char* out, const char* err, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(126);  // the test died before the line above
  setpgid(0, 0);                        // so that what it starts can be ended with it
  const int out_fd = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int err_fd = err == nullptr ? out_fd : open(err, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int in_fd = open("/dev/null", O_RDONLY);
  if (out_fd < 0 || err_fd < 0 || in_fd < 0) _exit(126);
  dup2(in_fd, STDIN_FILENO);
  dup2(out_fd, STDOUT_FILENO);
  dup2(err_fd, STDERR_FILENO);
  execvp(argv[0], argv);
  _exit(127);
}

pid_t start(const std::vector<std::string>& arguments, const std::string& out, const char* err) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (pid == 0) become(argv.data(), out.c_str(), err, parent);
  return pid;
}

int open_pid(pid_t pid) {
  return static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
}

/// True if the process ended within the limit.
bool wait_for_end(int pid_fd, std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    pollfd poll_fd{pid_fd, POLLIN, 0};
    const int ready = poll(&poll_fd, 1, static_cast<int>(std::max<std::chrono::milliseconds::rep>(0, left.count())));
    if (ready > 0) return true;
    if (ready == 0) return false;
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
  }
}

int exit_code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments, std::filesystem::path output) : output_(std::move(output)) {
  pid_ = start(arguments, output_.string(), nullptr);
  pid_fd_ = open_pid(pid_);
  if (pid_fd_ < 0) throw std::system_error(errno, std::generic_category(), "pidfd_open");
}

Process::~Process() {
  if (!exit_code_) {
    kill(-pid_, SIGKILL);
    kill(pid_, SIGKILL);
    reap(0);
  }
  close(pid_fd_);
}

void Process::reap(int options) {
  int status = 0;
  if (!exit_code_ && waitpid(pid_, &status, options) == pid_) exit_code_ = exit_code_of(status);
}

bool Process::running() {
  reap(WNOHANG);
  return !exit_code_;
}

void Process::send_signal(int signal) {
  if (!running()) throw std::runtime_error("the process has ended already; its output:\n" + output());
  kill(pid_, signal);
}

std::optional<int> Process::wait_for(std::chrono::milliseconds limit) {
  if (!exit_code_ && wait_for_end(pid_fd_, limit)) reap(0);
  return exit_code_;
}

std::string Process::output() const {
  return read_file(output_);
}

Finished run_program(const std::vector<std::string>& arguments, const std::filesystem::path& scratch,
                     std::chrono::milliseconds limit) {
  const std::string out = (scratch / "program.out").string();
  const std::string err = (scratch / "program.err").string();
  const pid_t pid = start(arguments, out, err.c_str());
  const int pid_fd = open_pid(pid);
  if (pid_fd < 0) throw std::system_error(errno, std::generic_category(), "pidfd_open");
  if (!wait_for_end(pid_fd, limit)) kill(pid, SIGKILL);
  close(pid_fd);
  int status = 0;
  waitpid(pid, &status, 0);
  return {exit_code_of(status), read_file(out), read_file(err)};
}

Finished run_in_shell(const std::string& command, const std::filesystem::path& scratch) {
  return run_program({"/bin/sh", "-c", "exec " + command}, scratch, std::chrono::minutes(10));
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace planemap
