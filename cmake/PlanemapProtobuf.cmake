# planemap_protobuf_library(target import_dir file.proto...)
# Runs protoc on import_dir/<file> and builds the generated C++ as a static library.
include_guard(GLOBAL)

function(planemap_protobuf_library target import_dir)
  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/generated")
  file(MAKE_DIRECTORY "${output_dir}")
  set(sources "")
  foreach(proto IN LISTS ARGN)
    string(REGEX REPLACE "\\.proto$" "" stem "${proto}")
    set(outputs "${output_dir}/${stem}.pb.cc" "${output_dir}/${stem}.pb.h")
    add_custom_command(
      OUTPUT ${outputs}
      COMMAND protobuf::protoc "--proto_path=${import_dir}" "--cpp_out=${output_dir}" "${import_dir}/${proto}"
      DEPENDS "${import_dir}/${proto}"
      COMMENT "protoc ${proto}"
      VERBATIM)
    list(APPEND sources ${outputs})
  endforeach()
  add_library(${target} STATIC ${sources})
  target_include_directories(${target} SYSTEM PUBLIC "$<BUILD_INTERFACE:${output_dir}>")
  target_link_libraries(${target} PUBLIC protobuf::libprotobuf)
endfunction()
