// What the thread sanitizer is told in each test, however it is started: the build itself starts them, to list their
// cases. It cannot see the locks within libraries that were built without it (liblcm, GLib, PCL's OpenNI): those it
// leaves alone. A race of ours it finds all the same, as tests/sanitizer shows. TSAN_OPTIONS overrides what is said
// here.

extern "C" const char* __tsan_default_options();  // NOLINT: the sanitizer's name

extern "C" const char* __tsan_default_options() {
  return "ignore_noninstrumented_modules=1:halt_on_error=1:second_deadlock_stack=1";
}
