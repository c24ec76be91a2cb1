# patina_room(NAME SOURCES ... LINKS ... [PRIVATE_LINKS ...])
# One folder of src/ as the static library patina_NAME (exported as vdb-patina::NAME).
function(patina_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  set(target patina_${name})
  add_library(${target} STATIC ${ROOM_SOURCES})
  add_library(vdb-patina::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
    $<INSTALL_INTERFACE:include/vdb-patina>)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PUBLIC ${ROOM_LINKS} PRIVATE $<BUILD_INTERFACE:patina_options> ${ROOM_PRIVATE_LINKS})
  set_property(GLOBAL APPEND PROPERTY PATINA_ROOMS ${target})
endfunction()

# patina_test(ROOM SOURCES ... [LINKS ...] [LABELS ...] [TIMEOUT s])
# The tests of one room as one GoogleTest program, tests found when it is built.
function(patina_test room)
  cmake_parse_arguments(TEST "" "TIMEOUT" "SOURCES;LINKS;LABELS" ${ARGN})
  set(target ${room}_tests)
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 120)
  endif()
  if(NOT TEST_LABELS)
    set(TEST_LABELS ${room})
  endif()
  add_executable(${target} ${TEST_SOURCES})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  target_compile_definitions(${target} PRIVATE
    PATINA_SOURCE_DIR="${PROJECT_SOURCE_DIR}" PATINA_PROGRAM="${PROJECT_BINARY_DIR}/vdb-patina")
  target_link_libraries(${target} PRIVATE patina_options ${TEST_LINKS} GTest::gmock GTest::gtest_main)
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 DISCOVERY_MODE PRE_TEST
    PROPERTIES TIMEOUT ${TEST_TIMEOUT} LABELS "${TEST_LABELS}")
endfunction()
