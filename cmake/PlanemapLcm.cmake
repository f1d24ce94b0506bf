# planemap_lcm_library(target package type...)
# Runs lcm-gen on <package>/<type>.lcm for each type and gives the C++ headers as the interface target.
include_guard(GLOBAL)

function(planemap_lcm_library target package)
  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/include")
  set(headers "")
  foreach(type IN LISTS ARGN)
    set(source "${CMAKE_CURRENT_SOURCE_DIR}/${package}/${type}.lcm")
    set(header "${output_dir}/${package}/${type}.hpp")
    add_custom_command(
      OUTPUT "${header}"
      COMMAND "${LCM_GEN}" --cpp --cpp-std c++11 --cpp-hpath "${output_dir}" "${source}"
      DEPENDS "${source}"
      COMMENT "lcm-gen ${package}.${type}"
      VERBATIM)
    list(APPEND headers "${header}")
  endforeach()
  file(MAKE_DIRECTORY "${output_dir}")
  add_custom_target(${target}_headers DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_headers)
  # SYSTEM: generated code is not held to our warnings.
  target_include_directories(${target} SYSTEM INTERFACE "$<BUILD_INTERFACE:${output_dir}>")
  target_link_libraries(${target} INTERFACE LCM::LCM)
endfunction()
