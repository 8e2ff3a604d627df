# What the compiler spends its time on: the headers of SystemC, CLI11, nlohmann-json and fmt (two to five seconds of each source
# that includes them), and optimising code that runs once.

# capsoc_cold(TARGET): what runs a few times in a run (command line, settings, reports, tests) is compiled for the
# compiler's time and not for its own. -O1 takes two thirds of -O3's time for it.
add_library(capsoc_cold_options INTERFACE)
target_compile_options(capsoc_cold_options INTERFACE $<$<CONFIG:Release>:-O1>)
function(capsoc_cold)
  foreach(target ${ARGN})
    target_link_libraries(${target} PRIVATE capsoc_cold_options)
  endforeach()
endfunction()

# capsoc_precompiled(NAME LIBS ... HEADERS ... [COLD]): precompiles headers once, for capsoc_use_precompiled(NAME TARGET ...).
# Sources still include what they use: scripts/check_tidy compiles them without. A compiler takes a precompiled header only
# with the options it was made with, so there is one for hot and one for cold code.
function(capsoc_precompiled name)
  cmake_parse_arguments(arg "COLD" "" "LIBS;HEADERS" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Carries the precompiled header.\n")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${name} PUBLIC ${arg_LIBS} PRIVATE capsoc_options)
  if(arg_COLD)
    capsoc_cold(${name})
  endif()
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
  set_target_properties(${name} PROPERTIES EXPORT_COMPILE_COMMANDS OFF)
endfunction()

function(capsoc_use_precompiled name)
  foreach(target ${ARGN})
    # What the header was made with, without its object file.
    target_include_directories(${target} SYSTEM PRIVATE $<TARGET_PROPERTY:${name},INTERFACE_SYSTEM_INCLUDE_DIRECTORIES>)
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:${name},COMPILE_DEFINITIONS>)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endforeach()
endfunction()

set(systemc_headers <systemc> <tlm> <tlm_utils/simple_initiator_socket.h> <tlm_utils/simple_target_socket.h>)
capsoc_precompiled(capsoc_pch_shells LIBS capsoc_systemc fmt::fmt HEADERS ${systemc_headers} <fmt/format.h>)
capsoc_precompiled(capsoc_pch_run COLD LIBS capsoc_systemc fmt::fmt nlohmann_json::nlohmann_json
                   HEADERS ${systemc_headers} <fmt/format.h> <nlohmann/json.hpp>)
capsoc_precompiled(capsoc_pch_cli COLD LIBS CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json
                   HEADERS <CLI/CLI.hpp> <fmt/format.h> <nlohmann/json.hpp>)
if(CAPSOC_TESTS)
  capsoc_precompiled(capsoc_pch_tests COLD LIBS GTest::gtest HEADERS <gtest/gtest.h>)
  capsoc_precompiled(capsoc_pch_shell_tests COLD LIBS GTest::gtest capsoc_systemc
                     HEADERS ${systemc_headers} <gtest/gtest.h>)
endif()

# capsoc_together(TARGET...): several sources of a target are compiled as one, so that headers are read and templates are made
# once for all of them. A name without linkage must then be the only one of its kind in the target. A change of one source costs
# the others' time again: with -DCAPSOC_TOGETHER=OFF each is compiled by itself.
option(CAPSOC_TOGETHER "Compile several sources at once: less than half of the time for a whole build" ON)
# capsoc_all_together(TARGET...): the same for a checker, which needs no fast code and no second processor: all of a target's.
option(CAPSOC_ALL_TOGETHER "Compile all sources of a target at once, also where code is hot: for scripts/check_tidy" OFF)
function(capsoc_together)
  foreach(target ${ARGN})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${CAPSOC_TOGETHER} UNITY_BUILD_BATCH_SIZE 8)
  endforeach()
endfunction()
function(capsoc_all_together)
  if(CAPSOC_ALL_TOGETHER)
    set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  endif()
endfunction()

# Which targets; to be called when all of them are there.
function(capsoc_save_compile_time)
  capsoc_cold(capsoc capsoc_manual capsoc_fit capsoc_campaign capsoc_golden capsoc_reproduce capsoc_accuracy capsoc_tables capsoc_inputs capsoc_results capsoc_ports capsoc_backend
              capsoc_explain capsoc_observers capsoc_session capsoc_metrics capsoc_settings
              capsoc_host capsoc_loader capsoc_source capsoc_serial capsoc_semihosting capsoc_rsp capsoc_gdb capsoc_bench capsoc_service capsoc_view capsoc_fault capsoc_workers)
  capsoc_use_precompiled(capsoc_pch_cli capsoc)
  capsoc_use_precompiled(capsoc_pch_run capsoc_inputs capsoc_results capsoc_ports capsoc_backend capsoc_explain capsoc_observers
                         capsoc_session capsoc_gdb capsoc_service)
  capsoc_use_precompiled(capsoc_pch_shells capsoc_kit capsoc_bus capsoc_cmsdk capsoc_an385 capsoc_peripherals capsoc_coprocessor_tlm
                         capsoc_armv7m_tlm capsoc_soc)
  # Not the processor and the coprocessor: what is hot is compiled alone.
  capsoc_together(capsoc capsoc_inputs capsoc_results capsoc_ports capsoc_backend capsoc_explain capsoc_observers capsoc_session
                  capsoc_metrics capsoc_settings capsoc_host capsoc_loader capsoc_serial capsoc_semihosting
                  capsoc_rsp capsoc_gdb capsoc_bench capsoc_kit capsoc_bus capsoc_cmsdk capsoc_an385
                  capsoc_coprocessor_tlm capsoc_armv7m_tlm capsoc_soc capsoc_identification capsoc_sensor capsoc_fit capsoc_campaign capsoc_golden capsoc_regress
                  capsoc_reproduce capsoc_accuracy capsoc_trace capsoc_fst capsoc_tables capsoc_manual capsoc_service capsoc_report capsoc_source
                  capsoc_view capsoc_fault capsoc_workers)
  capsoc_all_together(capsoc_armv7m capsoc_rtl_adapter capsoc_wave_file capsoc_base capsoc capsoc_campaign capsoc_report
                      capsoc_sensor capsoc_observers capsoc_fit capsoc_reproduce capsoc_host capsoc_metrics capsoc_serial
                      capsoc_trace capsoc_view capsoc_inject)
endfunction()
