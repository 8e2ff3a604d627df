# Run by cpack over the tree that becomes a Debian package: what Debian keeps elsewhere or otherwise than an install tree.
file(GLOB share LIST_DIRECTORIES true ${CPACK_TEMPORARY_DIRECTORY}/usr/share)
if(NOT share)
  message(FATAL_ERROR "debian_layout.cmake: there is no usr/share below ${CPACK_TEMPORARY_DIRECTORY}")
endif()
file(RENAME ${share}/zsh/site-functions ${share}/zsh/vendor-completions)
file(GLOB pages ${share}/man/man1/*.1)
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE ${share}/doc/capsoc/LICENSE) # Debian has it in common-licenses
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/debian_copyright ${share}/doc/capsoc/copyright)
