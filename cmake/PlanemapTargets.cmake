# What every target of the project has in common: warnings, sanitizers, precompiled headers.
include_guard(GLOBAL)

if(PLANEMAP_SANITIZER STREQUAL "address")
  # GCC 12's vptr check breaks calls through member pointers, which is how LCM calls its handlers.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=vptr -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
elseif(PLANEMAP_SANITIZER STREQUAL "thread")
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer)
  add_link_options(-fsanitize=thread)
elseif(PLANEMAP_SANITIZER STREQUAL "fuzzer")
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "PLANEMAP_SANITIZER=fuzzer needs clang++: cmake --preset fuzz")
  endif()
  # Every object counts its edges; the fuzz targets alone link libFuzzer and its main(). Overflow of unsigned numbers is no error.
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize=vptr -fno-sanitize-recover=all
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
elseif(PLANEMAP_SANITIZER)
  message(FATAL_ERROR "PLANEMAP_SANITIZER is '${PLANEMAP_SANITIZER}'; it takes 'address', 'thread' or 'fuzzer'")
endif()

find_program(PLANEMAP_CCACHE ccache)
if(PLANEMAP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Without these two ccache passes over everything that uses a precompiled header; with the base, what one clone has
  # compiled serves the next one.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros
      "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 "${PLANEMAP_CCACHE}")
endif()

# planemap_precompiled_headers(name header...)
# Compiles the headers once; the targets of planemap_use_precompiled_headers(target name) start with them. A third of the time
# of a build went into reading the same few. No source may count on it: clang-tidy reads each without, as does
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON.
function(planemap_precompiled_headers name)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "// Something to compile, so that the headers are.\n")
  add_library(${name} OBJECT "${source}")
  target_precompile_headers(${name} PRIVATE ${ARGN})
  planemap_warnings(${name})  # -Wpedantic defines a macro less: GCC wants the same ones
endfunction()

function(planemap_use_precompiled_headers target name)
  target_precompile_headers(${target} REUSE_FROM ${name})
endfunction()

# Adds our warnings to a target of ours (never to generated code).
function(planemap_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                           -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual -Wextra-semi)
  # GCC 12 at -O3 sees overlaps within std::string and uninitialised values within Boost.Geometry that are not there (GCC's
  # PR 105651 is one). The other builds, CI's too, go on warning.
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-Wno-restrict;-Wno-maybe-uninitialized>")
  if(PLANEMAP_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# planemap_add_library(name SOURCES ... [DEPENDS ...] [PRIVATE_DEPENDS ...])
# A static library whose public headers are in include/ beside it, where there is one, else its own folder src/.
function(planemap_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  if(IS_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/include")
    target_include_directories(${name} PUBLIC "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>")
    target_include_directories(${name} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}/src")
  else()
    target_include_directories(${name} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/src")
  endif()
  target_link_libraries(${name} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  planemap_use_precompiled_headers(${name} planemap_headers)
  planemap_warnings(${name})
endfunction()

# planemap_add_executable(name SOURCES ... [DEPENDS ...])
function(planemap_add_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS})
  planemap_use_precompiled_headers(${name} planemap_headers)
  planemap_warnings(${name})
endfunction()
