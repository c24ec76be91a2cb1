# cmake -D BUILD=… -D FOLDER=… [-D GENERATOR=… -D COMPILER=… -D LAUNCHER=… -D CONFIG=…] -P install_test.cmake
# Installs into an empty folder, runs the program from there and builds a stranger's project against it.
cmake_minimum_required(VERSION 3.25)

set(prefix "${FOLDER}/prefix")
set(consumer "${FOLDER}/consumer")
file(REMOVE_RECURSE "${FOLDER}")
file(MAKE_DIRECTORY "${FOLDER}")
# What is installed has to find everything by itself.
unset(ENV{VDB_PATINA_DATA})
unset(ENV{DESTDIR})

# run(SAYS TEXT… COMMAND …): the command must end with 0 and print each of the texts.
function(run)
  cmake_parse_arguments(RUN "" "" "SAYS;COMMAND" ${ARGN})
  list(JOIN RUN_COMMAND " " line)
  message(STATUS "$ ${line}")
  execute_process(COMMAND ${RUN_COMMAND} WORKING_DIRECTORY "${FOLDER}"
    OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "ended with ${result}:\n${output}")
  endif()
  foreach(text IN LISTS RUN_SAYS)
    if(NOT output MATCHES "${text}")
      message(FATAL_ERROR "says nothing of '${text}':\n${output}")
    endif()
  endforeach()
endfunction()

run(COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}")

# Nothing may point back to where it was built.
file(GLOB_RECURSE package "${prefix}/*/cmake/vdb-patina/*.cmake")
if(NOT package)
  message(FATAL_ERROR "no CMake package was installed")
endif()
cmake_path(SET source NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../..")
foreach(file IN LISTS package)
  file(READ "${file}" text)
  foreach(folder IN ITEMS "${BUILD}" "${source}")
    string(FIND "${text}" "${folder}" found)
    if(NOT found EQUAL -1)
      message(FATAL_ERROR "${file} names ${folder}")
    endif()
  endforeach()
endforeach()
foreach(file IN ITEMS share/vdb-patina/materials/tarnish_1.toml share/vdb-patina/scripts/marine.patina share/doc/vdb-patina/LICENSE)
  if(NOT EXISTS "${prefix}/${file}")
    message(FATAL_ERROR "${file} was not installed")
  endif()
endforeach()

set(program "${prefix}/bin/vdb-patina")
file(WRITE "${FOLDER}/sample.patina" "new copper;\ncoat tarnish_1 0.35;\ncoat cuprite_2 1.2;\n")
run(SAYS tarnish_1 COMMAND "${program}" materials)
run(COMMAND "${program}" run sample.patina sphere --voxels 32 --resolution 32 --picture 0 --progress none -o result)

# Moved as a whole, as a package manager or a user would.
file(RENAME "${prefix}" "${FOLDER}/moved")
set(prefix "${FOLDER}/moved")
# A material that only this place has: the data is read from here, not from a source tree further up.
configure_file("${prefix}/share/vdb-patina/materials/soot.toml" "${prefix}/share/vdb-patina/materials/only_here.toml" COPYONLY)
run(SAYS only_here COMMAND "${prefix}/bin/vdb-patina" materials)

set(choices "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_BUILD_TYPE=${CONFIG}")
if(GENERATOR)
  list(APPEND choices -G "${GENERATOR}")
endif()
if(COMPILER)
  list(APPEND choices "-DCMAKE_CXX_COMPILER=${COMPILER}")
endif()
if(LAUNCHER)
  list(APPEND choices "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}")
endif()
if(SANITIZE)
  list(APPEND choices "-DCMAKE_CXX_FLAGS=-fsanitize=${SANITIZE}")
endif()
run(COMMAND "${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}/consumer" -B "${consumer}" ${choices})
run(COMMAND "${CMAKE_COMMAND}" --build "${consumer}")

# The top of the sphere of `make`, which stands on the ground and measures 10 cm.
set(data "${prefix}/share/vdb-patina")
run(SAYS "tarnish_1 0\\.3[45]" "cuprite_2 1\\.[12]" "colour #"
  COMMAND "${consumer}/core-sample" result/sample.vdb 0 0.1 0 0 1 0 "${data}")
run(SAYS "2 statements" COMMAND "${consumer}/all-rooms" "${data}")
file(REMOVE_RECURSE "${FOLDER}")
