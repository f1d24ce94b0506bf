#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

namespace planemap {

/// What a program's main() does once its options are defined: parses the command line, does the work, and says on
/// stderr why it could not.
/// @param app  has the program's name
/// @return exit code: 0 done, 1 failed, 2 wrong use
template <class Work>
int run_program(CLI::App& app, int argc, char** argv, const Work& work) {
  try {
    app.parse(argc, argv);
    work();
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), e.what());
    return 1;
  }
}

}  // namespace planemap
