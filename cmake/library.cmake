# The models as libraries (docs/guide/library.md): capsoc::COMPONENT in a build that has capsoc as a subdirectory, and archives,
# headers, a CMake package and pkg-config files in an installed tree.
#
# capsoc_component(NAME TARGETS ... [NEEDS component...] [PACKAGES package...] [LIBRARIES -l...] [REQUIRES pc...])
# TARGETS: in the order of the linker; PACKAGES: package=target pairs that the CMake package looks for; REQUIRES and LIBRARIES: the
# same for pkg-config.
set(capsoc_component_table "")
function(capsoc_component name)
  cmake_parse_arguments(arg "" "" "TARGETS;NEEDS;PACKAGES;LIBRARIES;REQUIRES" ${ARGN})
  add_library(capsoc_component_${name} INTERFACE)
  target_link_libraries(capsoc_component_${name} INTERFACE ${arg_TARGETS})
  foreach(need ${arg_NEEDS})
    target_link_libraries(capsoc_component_${name} INTERFACE capsoc_component_${need})
  endforeach()
  add_library(capsoc::${name} ALIAS capsoc_component_${name})
  if(NOT PROJECT_IS_TOP_LEVEL)
    return()
  endif()
  install(TARGETS ${arg_TARGETS} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  string(APPEND capsoc_component_table
         "capsoc_component(${name} ARCHIVES ${arg_TARGETS} NEEDS ${arg_NEEDS} PACKAGES ${arg_PACKAGES})\n")
  string(REPLACE ";" " " capsoc_component_table "${capsoc_component_table}")
  set(capsoc_component_table "${capsoc_component_table}" PARENT_SCOPE)
  set(archives ${arg_TARGETS})
  list(TRANSFORM archives PREPEND -l)
  set(requires ${arg_NEEDS})
  list(TRANSFORM requires PREPEND capsoc-)
  list(APPEND requires ${arg_REQUIRES})
  list(JOIN archives " " archives)
  list(JOIN arg_LIBRARIES " " libraries)
  list(JOIN requires ", " requires)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/component.pc.in ${PROJECT_BINARY_DIR}/library/capsoc-${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/library/capsoc-${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
          COMPONENT development)
endfunction()

include(GNUInstallDirs)
# The tree may be moved as a whole: from a file's folder to the prefix.
file(RELATIVE_PATH pc_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
file(RELATIVE_PATH data_to_prefix /${CMAKE_INSTALL_DATADIR}/capsoc /)
set(asmjit_package "")
set(asmjit_library "")
find_package(asmjit QUIET)
if(asmjit_FOUND AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  set(asmjit_package asmjit=asmjit::asmjit)
  set(asmjit_library -lasmjit)
endif()

capsoc_component(base TARGETS capsoc_base)
capsoc_component(kit TARGETS capsoc_kit NEEDS base PACKAGES SystemC=capsoc::systemc spdlog=spdlog::spdlog fmt=fmt::fmt
                 REQUIRES systemc spdlog fmt)
capsoc_component(bus TARGETS capsoc_bus NEEDS kit)
capsoc_component(armv7m TARGETS capsoc_armv7m_tlm capsoc_armv7m NEEDS kit PACKAGES ${asmjit_package}
                 LIBRARIES ${asmjit_library})
capsoc_component(cmsdk TARGETS capsoc_cmsdk NEEDS kit)
capsoc_component(an385 TARGETS capsoc_an385 NEEDS kit)
capsoc_component(peripherals TARGETS capsoc_peripherals capsoc_peripherals_core NEEDS kit)
capsoc_component(coprocessor TARGETS capsoc_coprocessor_tlm capsoc_coprocessor NEEDS peripherals kit)
capsoc_component(sensor TARGETS capsoc_sensor NEEDS base PACKAGES fmt=fmt::fmt ZLIB=ZLIB::ZLIB yaml=yaml
                 REQUIRES fmt zlib yaml-0.1)
capsoc_component(identification TARGETS capsoc_identification NEEDS base PACKAGES Eigen3=Eigen3::Eigen REQUIRES eigen3)
capsoc_component(soc TARGETS capsoc_soc NEEDS armv7m bus cmsdk an385 coprocessor peripherals)

if(PROJECT_IS_TOP_LEVEL)
  # Headers that need another library's for what only capsoc's own program does.
  set(own_use "/base/(json|toml|data_table|curve|setting_fields|settings|shell)\\.h$|/executors/translator$|/sensor/overrides\\.h$|/identification/kernels_body\\.h$")
  set(parts base kit bus armv7m cmsdk an385 peripherals coprocessor sensor identification)
  foreach(part ${parts})
    install(DIRECTORY models/${part} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/capsoc COMPONENT development
            FILES_MATCHING PATTERN "*.h" PATTERN "*.def" REGEX "${own_use}" EXCLUDE)
  endforeach()
  # Of the processor's translator what the processor has as members.
  set(translator models/armv7m/executors/translator)
  install(FILES ${translator}/flag_sources.h ${translator}/host_context.h ${translator}/translator.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/capsoc/armv7m/executors/translator COMPONENT development)
  install(FILES platform/soc/soc.h platform/soc/board_map.h platform/soc/board_registers.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/capsoc/soc COMPONENT development)
  install(FILES ${PROJECT_BINARY_DIR}/generated/capsoc_registers.h ${PROJECT_BINARY_DIR}/generated/capsoc_coprocessor_map.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/capsoc COMPONENT development)
  configure_file(cmake/capsocComponents.cmake.in ${PROJECT_BINARY_DIR}/library/capsocComponents.cmake @ONLY)
  include(CMakePackageConfigHelpers)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/library/capsocConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/library/capsocComponents.cmake ${PROJECT_BINARY_DIR}/library/capsocConfigVersion.cmake
          DESTINATION ${CMAKE_INSTALL_DATADIR}/capsoc COMPONENT development)
endif()
