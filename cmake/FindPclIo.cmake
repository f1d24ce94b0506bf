# Finds PCL's io library alone. PCL's own package file brings all of VTK, Qt and MPI to the link line and seconds to every
# configure; writing a point cloud needs none of them.
# Defines the target PclIo::PclIo.
find_path(PCL_IO_INCLUDE_DIR NAMES pcl/io/ply_io.h PATH_SUFFIXES pcl-1.15 pcl-1.14 pcl-1.13 pcl-1.12)
find_library(PCL_IO_LIBRARY NAMES pcl_io)
find_library(PCL_COMMON_LIBRARY NAMES pcl_common)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PclIo REQUIRED_VARS PCL_IO_LIBRARY PCL_COMMON_LIBRARY PCL_IO_INCLUDE_DIR)

if(PclIo_FOUND AND NOT TARGET PclIo::PclIo)
  add_library(PclIo::PclIo UNKNOWN IMPORTED GLOBAL)  # linked through static libraries, from other folders too
  set_target_properties(PclIo::PclIo PROPERTIES
    IMPORTED_LOCATION "${PCL_IO_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${PCL_IO_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${PCL_COMMON_LIBRARY};Eigen3::Eigen;Boost::headers")
endif()
mark_as_advanced(PCL_IO_INCLUDE_DIR PCL_IO_LIBRARY PCL_COMMON_LIBRARY)
