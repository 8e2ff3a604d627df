# find_package(capsoc): what a project with a design of its own needs of capsoc (docs/guide/for-rtl.md). Installed as
# share/capsoc/capsocConfig.cmake; from a source tree, -Dcapsoc_DIR=TREE/cmake.
if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/rtl/rtl_library.cmake)
  include(${CMAKE_CURRENT_LIST_DIR}/rtl/rtl_library.cmake)
else()
  include(${CMAKE_CURRENT_LIST_DIR}/../platform/simulation/rtl/rtl_library.cmake)
endif()
# With components: the models as libraries (docs/guide/library.md). Only an installed tree has them.
if(capsoc_FIND_COMPONENTS)
  if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/capsocComponents.cmake)
    include(${CMAKE_CURRENT_LIST_DIR}/capsocComponents.cmake)
  else()
    set(capsoc_FOUND FALSE)
    set(capsoc_NOT_FOUND_MESSAGE "a source tree has no components: install it (cmake --install), or use add_subdirectory()")
  endif()
endif()
