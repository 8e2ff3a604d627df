# Run by cpack over the trees that become Debian packages, a folder each: what Debian keeps elsewhere or otherwise than an
# install tree.
function(capsoc_find_share group)
  file(GLOB share LIST_DIRECTORIES true ${CPACK_TEMPORARY_DIRECTORY}/${group}/usr/share)
  if(NOT share)
    message(FATAL_ERROR "debian_layout.cmake: there is no ${group}/usr/share below ${CPACK_TEMPORARY_DIRECTORY}")
  endif()
  set(share ${share} PARENT_SCOPE)
endfunction()

# Licences, third parties' among them, and changes of each package.
function(capsoc_documents group package)
  set(folder ${CPACK_TEMPORARY_DIRECTORY}/${group}/usr/share/doc/${package})
  file(COPY_FILE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/debian_copyright ${folder}/copyright)
  file(COPY_FILE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../CHANGELOG.md ${folder}/changelog)
  execute_process(COMMAND gzip -9nf ${folder}/changelog COMMAND_ERROR_IS_FATAL ANY)
endfunction()

capsoc_find_share(program)
file(RENAME ${share}/zsh/site-functions ${share}/zsh/vendor-completions)
file(GLOB pages ${share}/man/man1/*.1)
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE ${share}/doc/capsoc/LICENSE) # Debian has it in common-licenses
capsoc_documents(program capsoc)

capsoc_find_share(development)
file(MAKE_DIRECTORY ${share}/doc/libcapsoc-dev)
capsoc_documents(development libcapsoc-dev)

# With what pip would write: pytest finds its plugin there.
capsoc_find_share(python)
set(packages ${share}/../lib/python3/dist-packages)
set(information ${packages}/capsoc-${CPACK_PACKAGE_VERSION}.dist-info)
file(MAKE_DIRECTORY ${information} ${share}/doc/python3-capsoc)
file(RENAME ${share}/capsoc/python/capsoc ${packages}/capsoc)
file(RENAME ${share}/capsoc/python/README.md ${share}/doc/python3-capsoc/README.md)
file(REMOVE_RECURSE ${share}/capsoc)
file(WRITE ${information}/METADATA "Metadata-Version: 2.1\nName: capsoc\nVersion: ${CPACK_PACKAGE_VERSION}\n")
file(WRITE ${information}/entry_points.txt "[pytest11]\ncapsoc = capsoc.pytest_plugin\n")
file(WRITE ${information}/INSTALLER "dpkg\n")
capsoc_documents(python python3-capsoc)
