#pragma once

namespace planemap {

/// Another thread that may do some of a scan's work. Core owns none: its caller may lend one. What is computed does not
/// depend on whether there is one.
class SecondThread {
 public:
  virtual ~SecondThread() = default;
  /// Begins work(argument) there, which throws nothing. @pre what was begun before has been waited for
  virtual void begin(void (*work)(void*), void* argument) = 0;
  /// Returns when the work is done; what it wrote can be read then.
  virtual void wait() = 0;
};

/// Does one part here and the other on the second thread; where there is none, here after the first. Returns, or throws
/// what `here` threw, when both are done. @param there  throws nothing
template <class Here, class There>
void do_both(SecondThread* second, Here&& here, There&& there) {
  if (second == nullptr) {
    here();
    there();
    return;
  }
  struct Waits {
    SecondThread* second;
    ~Waits() { second->wait(); }
  };
  auto work = [&there] { there(); };
  second->begin([](void* argument) { (*static_cast<decltype(work)*>(argument))(); }, &work);
  const Waits waits{second};
  here();
}

}  // namespace planemap
