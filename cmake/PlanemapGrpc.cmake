# planemap_grpc_library(target import_dir file.proto...)
# Runs protoc with gRPC's plugin on import_dir/<file> and builds messages, stubs and service bases as a static library.
# Messages of files that these import come from planemap_protobuf_library.
include_guard(GLOBAL)

function(planemap_grpc_library target import_dir)
  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/generated")
  file(MAKE_DIRECTORY "${output_dir}")
  planemap_protobuf_library(${target} "${import_dir}" ${ARGN})
  foreach(proto IN LISTS ARGN)
    string(REGEX REPLACE "\\.proto$" "" stem "${proto}")
    set(outputs "${output_dir}/${stem}.grpc.pb.cc" "${output_dir}/${stem}.grpc.pb.h")
    add_custom_command(
      OUTPUT ${outputs}
      COMMAND protobuf::protoc "--proto_path=${import_dir}" "--grpc_out=${output_dir}"
              "--plugin=protoc-gen-grpc=$<TARGET_FILE:gRPC::grpc_cpp_plugin>" "${import_dir}/${proto}"
      DEPENDS "${import_dir}/${proto}"
      COMMENT "protoc, gRPC ${proto}"
      VERBATIM)
    target_sources(${target} PRIVATE ${outputs})
  endforeach()
  target_link_libraries(${target} PUBLIC gRPC::grpc++)
endfunction()
