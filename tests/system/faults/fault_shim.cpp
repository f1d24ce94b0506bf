// Loaded into planemapd by LD_PRELOAD: faults of the disk and of the clock that a test switches on and off by files in
// the folder that PLANEMAP_FAULTS names:
//   io_error  while it is there, map files cannot be written: EIO
//   stall     a FIFO: whoever syncs a map file waits until its writing end was opened and is closed again
//   clock     seconds by which the host's clock is off
// It calls the kernel itself: nothing has to be looked up, and no sanitizer is asked.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

using Path = std::array<char, 512>;

/// @return false: no faults are asked for
bool path_of(const char* fault, Path& path) {
  const char* folder = getenv("PLANEMAP_FAULTS");
  if (folder == nullptr) return false;
  return std::snprintf(path.data(), path.size(), "%s/%s", folder, fault) < static_cast<int>(path.size());
}

bool is_on(const char* fault, Path& path) {
  return path_of(fault, path) && access(path.data(), F_OK) == 0;
}

bool is_of_a_map(int file) {
  Path link{};
  Path name{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link.data(), name.data(), name.size() - 1);
  return size > 0 && std::strstr(name.data(), ".planemap") != nullptr;
}

bool fails(int file) {
  const int before = errno;
  Path path{};
  const bool bad = is_on("io_error", path) && is_of_a_map(file);
  errno = bad ? EIO : before;
  return bad;
}

void wait_where_it_stalls(int file) {
  const int before = errno;
  Path path{};
  if (is_on("stall", path) && is_of_a_map(file)) {
    const int fifo = open(path.data(), O_RDONLY | O_CLOEXEC);  // until there is a writer
    char byte = 0;
    while (fifo >= 0 && read(fifo, &byte, 1) > 0) {
    }
    if (fifo >= 0) close(fifo);
  }
  errno = before;
}

long seconds_off() {
  Path path{};
  if (!path_of("clock", path)) return 0;
  const int before = errno;
  long seconds = 0;
  const int file = open(path.data(), O_RDONLY | O_CLOEXEC);
  if (file >= 0) {
    std::array<char, 32> text{};
    if (read(file, text.data(), text.size() - 1) > 0) seconds = std::strtol(text.data(), nullptr, 10);
    close(file);
  }
  errno = before;
  return seconds;
}

}  // namespace

extern "C" {

ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  if (fails(file)) return -1;
  return syscall(SYS_pwrite64, file, bytes, size, at);
}

ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  return pwrite64(file, bytes, size, at);
}

int fdatasync(int file) {
  wait_where_it_stalls(file);
  return fails(file) ? -1 : static_cast<int>(syscall(SYS_fdatasync, file));
}

int fsync(int file) {
  wait_where_it_stalls(file);
  return fails(file) ? -1 : static_cast<int>(syscall(SYS_fsync, file));
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const int result = static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  if (result == 0 && clock == CLOCK_REALTIME) time->tv_sec += seconds_off();
  return result;
}

int gettimeofday(timeval* time, void* /*zone*/) noexcept {
  timespec now{};
  const int result = clock_gettime(CLOCK_REALTIME, &now);
  *time = {now.tv_sec, static_cast<suseconds_t>(now.tv_nsec / 1000)};
  return result;
}

time_t time(time_t* seconds) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (seconds != nullptr) *seconds = now.tv_sec;
  return now.tv_sec;
}

}  // extern "C"
