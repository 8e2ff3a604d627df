# The firmware is a project of its own, firmware/, because it has its own compiler. Target `firmware` configures and builds all of
# it, `firmware_applications` what people run; the ELF files are ${PROJECT_BINARY_DIR}/firmware/<name>.elf.
find_program(ARM_NONE_EABI_GCC arm-none-eabi-gcc)
if(NOT ARM_NONE_EABI_GCC)
  message(FATAL_ERROR "arm-none-eabi-gcc is missing; install gcc-arm-none-eabi and libnewlib-arm-none-eabi")
endif()
set(firmware ${PROJECT_SOURCE_DIR}/firmware)
set(firmware_output ${PROJECT_BINARY_DIR}/firmware)
set(firmware_build ${firmware_output}/objects)
set(firmware_toolchain ${firmware}/template/toolchain.cmake)

# A program outside this tree finds them beside the generated register header.
configure_file(${firmware}/common/program_settings.h ${PROJECT_BINARY_DIR}/generated/program_settings.h COPYONLY)
configure_file(${firmware}/common/program_verdict.h ${PROJECT_BINARY_DIR}/generated/program_verdict.h COPYONLY)

# The ELF files, so that a missing one is made again: the calls of programs.cmake, read for the names.
macro(capsoc_firmware name)
  list(APPEND elves ${firmware_output}/${name}.elf)
endmacro()
macro(capsoc_firmware_objects)
endmacro()
function(capsoc_list_firmware)
  include(${firmware}/programs.cmake)
  list(TRANSFORM capsoc_applications REPLACE "(.+)" "${firmware_output}/\\1.elf")
  list(REMOVE_ITEM elves ${capsoc_applications})
  set(firmware_application_elves ${capsoc_applications} PARENT_SCOPE)
  set(firmware_other_elves ${elves} PARENT_SCOPE)
endfunction()
capsoc_list_firmware()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${firmware}/programs.cmake)

# Which program needs which file is known to the inner build alone: any of them starts it, and it builds what is needed.
file(GLOB_RECURSE firmware_files CONFIGURE_DEPENDS ${firmware}/*.c ${firmware}/*.h ${firmware}/*.ld)
list(FILTER firmware_files EXCLUDE REGEX "^${firmware}/template/")
list(APPEND firmware_files ${firmware}/CMakeLists.txt ${firmware}/programs.cmake ${firmware}/template/capsoc_firmware.cmake
     ${PROJECT_SOURCE_DIR}/tests/examples/crc_unit/main.c ${PROJECT_SOURCE_DIR}/tests/examples/crc_unit/crc_unit_driver.h
     generate_registers ${PROJECT_BINARY_DIR}/generated/registers.stamp)

# Flags in the environment are for the host's compiler.
add_custom_command(
  OUTPUT ${firmware_build}/CMakeCache.txt
  COMMAND ${CMAKE_COMMAND} -E env --unset=CFLAGS --unset=LDFLAGS
          ${CMAKE_COMMAND} --fresh -G ${CMAKE_GENERATOR} -S ${firmware} -B ${firmware_build} --toolchain ${firmware_toolchain}
          -DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM} -DCMAKE_BUILD_TYPE= -DCAPSOC_BUILD=${PROJECT_BINARY_DIR} --log-level=WARNING
  DEPENDS ${firmware_toolchain}
  COMMENT "Configuring the firmware" VERBATIM)

set(quietly)
if(CMAKE_GENERATOR STREQUAL Ninja)
  set(quietly -- --quiet)
endif()
add_custom_command(
  OUTPUT ${firmware_output}/applications.stamp
  BYPRODUCTS ${firmware_application_elves}
  COMMAND ${CMAKE_COMMAND} --build ${firmware_build} --target applications ${quietly}
  COMMAND ${CMAKE_COMMAND} -E touch ${firmware_output}/applications.stamp
  DEPENDS ${firmware_build}/CMakeCache.txt ${firmware_files}
  COMMENT "Building the applications' firmware" VERBATIM)
add_custom_command(
  OUTPUT ${firmware_output}/firmware.stamp
  BYPRODUCTS ${firmware_other_elves}
  COMMAND ${CMAKE_COMMAND} --build ${firmware_build} ${quietly}
  COMMAND ${CMAKE_COMMAND} -E touch ${firmware_output}/firmware.stamp
  # After the applications: two builds of one folder would disturb each other.
  DEPENDS ${firmware_output}/applications.stamp ${firmware_application_elves} ${firmware_files}
  COMMENT "Building the firmware" VERBATIM)
add_custom_target(firmware_applications DEPENDS ${firmware_output}/applications.stamp)
add_custom_target(firmware ALL DEPENDS ${firmware_output}/firmware.stamp)
