# Also read by the installed package, so only what the libraries need stands here.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Imath REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(fmt REQUIRED)
find_package(OpenMesh REQUIRED)
find_package(embree 3.12 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)

# OpenVDB ships a find-module instead of a config file.
find_path(PATINA_OPENVDB_MODULE FindOpenVDB.cmake
  PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB /usr/lib/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB)
list(APPEND CMAKE_MODULE_PATH "${PATINA_OPENVDB_MODULE}")
find_package(OpenVDB 10 REQUIRED COMPONENTS openvdb)

# Debian's own files for these two name libraries that it does not ship: ours look for what is there.
find_package(PatinaOpenSubdiv REQUIRED)
find_package(PatinaOpenImageIO REQUIRED)
find_package(PatinaXxHash REQUIRED)
find_package(PatinaDeflate REQUIRED)
