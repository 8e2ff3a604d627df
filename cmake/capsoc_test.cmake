include(GoogleTest)

# capsoc_test(NAME SOURCES ... LIBS ... [SYSTEMC] [ALONE])
# A GoogleTest program. With SYSTEMC its sources define sc_main, which calls RUN_ALL_TESTS; with ALONE each is
# compiled by itself, since names without linkage occur twice.
function(capsoc_test name)
  cmake_parse_arguments(arg "SYSTEMC;ALONE" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE capsoc_options ${arg_LIBS})
  if(NOT arg_ALONE)
    capsoc_together(${name})
  endif()
  if(arg_SYSTEMC)
    target_link_libraries(${name} PRIVATE capsoc_systemc GTest::gtest)
    capsoc_use_precompiled(capsoc_pch_shell_tests ${name})
  else()
    target_link_libraries(${name} PRIVATE GTest::gtest GTest::gtest_main)
    capsoc_use_precompiled(capsoc_pch_tests ${name})
  endif()
  capsoc_cold(${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                       TEST_PREFIX "${name}: " PROPERTIES TIMEOUT 300)
endfunction()
