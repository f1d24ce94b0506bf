# Finds libraries of PCL one by one: find_package(PclParts REQUIRED COMPONENTS io filters ...). PCL's own package file brings
# all of VTK, Qt and MPI to the link line and seconds to every configure; what is used here needs none of them.
# Defines a target PclParts::<component> for each, and PclParts_VERSION.
find_path(PCL_INCLUDE_DIR NAMES pcl/pcl_config.h PATH_SUFFIXES pcl-1.15 pcl-1.14 pcl-1.13 pcl-1.12)
set(_pcl_parts_required PCL_INCLUDE_DIR)
foreach(part IN ITEMS common ${PclParts_FIND_COMPONENTS})
  find_library(PCL_${part}_LIBRARY NAMES pcl_${part})
  mark_as_advanced(PCL_${part}_LIBRARY)
  list(APPEND _pcl_parts_required PCL_${part}_LIBRARY)
  if(PCL_${part}_LIBRARY)
    set(PclParts_${part}_FOUND TRUE)
  endif()
endforeach()
mark_as_advanced(PCL_INCLUDE_DIR)
if(PCL_INCLUDE_DIR)
  file(STRINGS "${PCL_INCLUDE_DIR}/pcl/pcl_config.h" _pcl_version_line REGEX "define PCL_VERSION_PRETTY")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" PclParts_VERSION "${_pcl_version_line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PclParts REQUIRED_VARS ${_pcl_parts_required} VERSION_VAR PclParts_VERSION HANDLE_COMPONENTS)

if(PclParts_FOUND)
  foreach(part IN LISTS PclParts_FIND_COMPONENTS)
    if(TARGET PclParts::${part})
      continue()
    endif()
    add_library(PclParts::${part} UNKNOWN IMPORTED GLOBAL)  # linked through static libraries, from other folders too
    set_target_properties(PclParts::${part} PROPERTIES
      IMPORTED_LOCATION "${PCL_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${PCL_INCLUDE_DIR}"
      INTERFACE_LINK_LIBRARIES "${PCL_common_LIBRARY};Eigen3::Eigen;Boost::headers")
  endforeach()
endif()
