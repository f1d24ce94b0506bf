# Finds LCM (library and lcm-gen) without pkg-config: Debian's lcm.pc asks for glib-2.0's .pc, which liblcm-dev does not pull in.
# The component gen is lcm-gen, which only who has .lcm files needs: find_package(LCM COMPONENTS gen).
# Defines the target LCM::LCM, and LCM_GEN, LCM_VERSION, LCM_INCLUDE_DIR, LCM_LIBRARY.
find_path(LCM_INCLUDE_DIR NAMES lcm/lcm-cpp.hpp)
find_library(LCM_LIBRARY NAMES lcm)
find_program(LCM_GEN NAMES lcm-gen)

if(LCM_INCLUDE_DIR)
  file(STRINGS "${LCM_INCLUDE_DIR}/lcm/lcm.h" _lcm_version_lines REGEX "#define LCM_(MAJOR|MINOR|MICRO)_VERSION")
  string(REGEX MATCHALL "[0-9]+" _lcm_version_numbers "${_lcm_version_lines}")
  list(JOIN _lcm_version_numbers "." LCM_VERSION)
endif()

include(FindPackageHandleStandardArgs)
if(LCM_GEN)
  set(LCM_gen_FOUND TRUE)
endif()
find_package_handle_standard_args(LCM REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR VERSION_VAR LCM_VERSION HANDLE_COMPONENTS)

if(LCM_FOUND AND NOT TARGET LCM::LCM)
  add_library(LCM::LCM UNKNOWN IMPORTED)
  set_target_properties(LCM::LCM PROPERTIES IMPORTED_LOCATION "${LCM_LIBRARY}"
                                            INTERFACE_INCLUDE_DIRECTORIES "${LCM_INCLUDE_DIR}")
endif()
mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY LCM_GEN)
