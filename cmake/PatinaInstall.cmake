# cmake --install: the program with its data, and the rooms as a CMake package (find_package(vdb-patina)).
#
#   bin/vdb-patina
#   share/vdb-patina/         data/: the program looks for ../share/vdb-patina/materials from where it lies
#   share/doc/vdb-patina/     licence, manual
#   include/vdb-patina/       the headers of src/, by room: #include "volume/vdb_file.h"
#   lib/libpatina_ROOM.a
#   lib/cmake/vdb-patina/     the package; private links of the rooms stay link-only, so that no room's users need the
#                             headers of what it hides, but the libraries must be found: PatinaDependencies.cmake goes along
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(PATINA_DATA_FOLDER "${CMAKE_INSTALL_DATADIR}/vdb-patina")
set(PATINA_PACKAGE_FOLDER "${CMAKE_INSTALL_LIBDIR}/cmake/vdb-patina")
get_property(PATINA_ROOMS GLOBAL PROPERTY PATINA_ROOMS)
list(TRANSFORM PATINA_ROOMS REPLACE "^patina_" "" OUTPUT_VARIABLE PATINA_ROOM_NAMES)

install(TARGETS vdb-patina ${PATINA_ROOMS} EXPORT vdb-patinaTargets
  RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}"
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/src/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/vdb-patina"
  FILES_MATCHING PATTERN "*.h")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/data/" DESTINATION "${PATINA_DATA_FOLDER}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/tools/blender" "${PROJECT_SOURCE_DIR}/tools/houdini" DESTINATION "${PATINA_DATA_FOLDER}"
  FILES_MATCHING PATTERN "*.py")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/" DESTINATION "${CMAKE_INSTALL_DOCDIR}" FILES_MATCHING PATTERN "*.md")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(FILES "${PROJECT_SOURCE_DIR}/README.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}" OPTIONAL)

install(EXPORT vdb-patinaTargets NAMESPACE vdb-patina:: DESTINATION "${PATINA_PACKAGE_FOLDER}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/vdb-patinaConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/package/vdb-patinaConfig.cmake"
  INSTALL_DESTINATION "${PATINA_PACKAGE_FOLDER}" PATH_VARS PATINA_DATA_FOLDER)
# Before 1.0 a minor version may change an interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/package/vdb-patinaConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
file(GLOB PATINA_FIND_MODULES CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/cmake/FindPatina*.cmake")
install(FILES
  "${PROJECT_BINARY_DIR}/package/vdb-patinaConfig.cmake"
  "${PROJECT_BINARY_DIR}/package/vdb-patinaConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/PatinaDependencies.cmake"
  ${PATINA_FIND_MODULES}
  DESTINATION "${PATINA_PACKAGE_FOLDER}")
