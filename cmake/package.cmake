# cpack -G DEB: packages for the Debian release that they are made on. Needs dpkg-dev and file.
#   capsoc           the program, the RTL's libraries, firmware, traces, pages
#   libcapsoc-dev    the models as libraries (docs/guide/library.md)
#   python3-capsoc   the Python package and its pytest plugin
set(CPACK_PACKAGE_NAME capsoc)
set(CPACK_PACKAGE_VENDOR capsoc)
set(CPACK_PACKAGE_CONTACT "capsoc maintainers <maintainers@capsoc.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_SOURCE_GENERATOR "") # sources come from git
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian_layout.cmake)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program rtl data doc development python)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
foreach(component program rtl data doc)
  string(TOUPPER ${component} name)
  set(CPACK_COMPONENT_${name}_GROUP program)
endforeach()
set(CPACK_COMPONENT_DEVELOPMENT_GROUP development)
set(CPACK_COMPONENT_PYTHON_GROUP python)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME capsoc)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "gcc-arm-none-eabi, gdb-multiarch, gtkwave, qemu-system-arm, libcapsoc-dev, python3-capsoc")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "${PROJECT_DESCRIPTION}
capsoc runs Cortex-M3 firmware on a SystemC model of a system-on-chip whose
coprocessor calibrates sine/cosine angle sensors by itself, bit for bit and
cycle for cycle, and fits recorded sensor signals without a simulation.")

# What the headers and the CMake package ask for; libcapsoc-dev's package for designs of one's own is capsoc's.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcapsoc-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(needs libsystemc-dev libfmt-dev libspdlog-dev libeigen3-dev zlib1g-dev libyaml-dev)
if(asmjit_package)
  list(APPEND needs libasmjit-dev)
endif()
list(JOIN needs ", " needs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "capsoc (= ${PROJECT_VERSION}), ${needs}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "SystemC and TLM-2.0 models of capsoc as libraries
A Cortex-M3, AHB matrix, APB bridge, memories, UARTs, timers and a coprocessor
for angle sensors as static libraries with headers, a CMake package and
pkg-config files.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-capsoc)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.9), capsoc (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pytest, python3-numpy, python3-pandas")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "simulations of capsoc driven from Python
Sessions, probes, checkpoints and campaigns from Python programs, and a pytest
plugin for tests of Cortex-M3 firmware.")
include(CPack)
