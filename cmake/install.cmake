# cmake --install: a tree that may be moved as a whole.
#   bin/capsoc
#   lib/capsoc/        the Verilated coprocessor and the reference for test benches, if they were built
#   share/capsoc/      firmware/ (what was built), traces/, template/, include/,
#                      sources/ of the programs, svd/, gdb/, rtl/ for designs of one's own,
#                      python/ with the package capsoc
#   share/doc/capsoc/  README.md, docs/, licence; html/, if the target site was built
#   share/man, share/bash-completion, share/zsh, share/fish
include(GNUInstallDirs)
set(data ${CMAKE_INSTALL_DATADIR}/capsoc)
set(generated ${PROJECT_BINARY_DIR}/generated)

# Man pages and completions, made by the program itself from the declarations of its command line.
set(pages ${generated}/share)
add_custom_command(
  OUTPUT ${generated}/share.stamp
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}
  COMMAND capsoc generate ${pages}
  COMMAND ${CMAKE_COMMAND} -E touch ${generated}/share.stamp
  DEPENDS capsoc
  COMMENT "Generating man pages and completions" VERBATIM)
add_custom_target(capsoc_manuals ALL DEPENDS ${generated}/share.stamp)

install(TARGETS capsoc RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
foreach(library capsoc_rtl_precise capsoc_rtl_paper)
  if(TARGET ${library})
    install(FILES $<TARGET_FILE:${library}> DESTINATION ${CMAKE_INSTALL_LIBDIR}/capsoc COMPONENT rtl OPTIONAL)
  endif()
endforeach()
# find_package(capsoc): libraries of RTL of one's own.
set(rtl platform/simulation/rtl)
install(FILES ${rtl}/rtl_library.cmake ${rtl}/include_all.cmake ${rtl}/hash_sources.cmake ${rtl}/black_box.sv.in ${rtl}/black_box.cpp.in
              ${rtl}/rtl_abi.h ${rtl}/rtl_state.def ${generated}/capsoc_coprocessor_settings.def ${rtl}/verilated_instance.h ${rtl}/verilated_pins.h
        DESTINATION ${data}/rtl COMPONENT rtl)
install(FILES cmake/capsocConfig.cmake DESTINATION ${data} COMPONENT rtl)
# The C interface to the reference, and a bench that uses it.
if(TARGET capsoc_reference)
  install(FILES $<TARGET_FILE:capsoc_reference> DESTINATION ${CMAKE_INSTALL_LIBDIR}/capsoc COMPONENT rtl OPTIONAL)
endif()
set(reference platform/reference)
install(FILES ${reference}/capsoc_reference.h ${reference}/bench/capsoc_reference_vpi.c
              ${reference}/bench/capsoc_reference_monitor.sv ${reference}/bench/capsoc_reference_bench.sv
        DESTINATION ${data}/rtl/reference COMPONENT rtl)
install(DIRECTORY ${PROJECT_BINARY_DIR}/firmware/ DESTINATION ${data}/firmware COMPONENT data
        FILES_MATCHING PATTERN "*.elf" PATTERN objects EXCLUDE PATTERN CMakeFiles EXCLUDE)
install(DIRECTORY platform/python DESTINATION ${data} COMPONENT python FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "*.toml" PATTERN "*.md"
        PATTERN build EXCLUDE PATTERN __pycache__ EXCLUDE PATTERN "*.egg-info" EXCLUDE)
install(DIRECTORY traces/ DESTINATION ${data}/traces COMPONENT data)
install(DIRECTORY firmware/template DESTINATION ${data} COMPONENT data)
install(FILES ${generated}/capsoc_device.h ${generated}/program_settings.h ${generated}/program_verdict.h DESTINATION ${data}/include COMPONENT data)
install(DIRECTORY firmware/apps firmware/common firmware/drivers DESTINATION ${data}/sources COMPONENT data)
install(FILES models/registers/capsoc.svd ${generated}/board.svd DESTINATION ${data}/svd COMPONENT data)
install(FILES scripts/debugger/svd.py scripts/debugger/history.gdb DESTINATION ${data}/gdb COMPONENT data)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(FILES ${generated}/registers.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs/reference COMPONENT doc)
# The pages as a site. By name only: it takes packages that nothing else of the build needs.
add_custom_target(site COMMAND ${PROJECT_SOURCE_DIR}/scripts/tool site --out ${PROJECT_BINARY_DIR}/site
                  COMMENT "Making the site of the pages" VERBATIM)
install(DIRECTORY ${PROJECT_BINARY_DIR}/site/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/html COMPONENT doc OPTIONAL)
install(DIRECTORY ${pages}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT doc)
install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program PATTERN man EXCLUDE)
