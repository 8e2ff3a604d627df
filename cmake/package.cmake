# cpack -G DEB: a package for the Debian release that it is made on. Needs dpkg-dev and file.
set(CPACK_PACKAGE_NAME capsoc)
set(CPACK_PACKAGE_VENDOR capsoc)
set(CPACK_PACKAGE_CONTACT "capsoc maintainers <maintainers@capsoc.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION "capsoc runs Cortex-M3 firmware on a SystemC model of a system-on-chip whose
coprocessor calibrates sine/cosine angle sensors by itself, bit for bit and
cycle for cycle, and fits recorded sensor signals without a simulation.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_MONOLITHIC_INSTALL ON)
set(CPACK_SOURCE_GENERATOR "") # sources come from git
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian_layout.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gcc-arm-none-eabi, gdb-multiarch, gtkwave, qemu-system-arm")
include(CPack)
