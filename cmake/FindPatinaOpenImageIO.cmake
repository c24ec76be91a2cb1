find_path(PATINA_OIIO_INCLUDE OpenImageIO/imageio.h)
find_library(PATINA_OIIO OpenImageIO)
find_library(PATINA_OIIO_UTIL OpenImageIO_Util)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PatinaOpenImageIO REQUIRED_VARS PATINA_OIIO PATINA_OIIO_UTIL PATINA_OIIO_INCLUDE)
if(PatinaOpenImageIO_FOUND AND NOT TARGET Patina::OpenImageIO)
  add_library(Patina::OpenImageIO UNKNOWN IMPORTED)
  set_target_properties(Patina::OpenImageIO PROPERTIES
    IMPORTED_LOCATION "${PATINA_OIIO}" INTERFACE_INCLUDE_DIRECTORIES "${PATINA_OIIO_INCLUDE}"
    INTERFACE_LINK_LIBRARIES "${PATINA_OIIO_UTIL}")
endif()
mark_as_advanced(PATINA_OIIO_INCLUDE PATINA_OIIO PATINA_OIIO_UTIL)
