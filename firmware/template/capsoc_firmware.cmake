# Programs for the board, in a project that is configured with toolchain.cmake.
#
#   capsoc_firmware(<name> SOURCES <file>... [OBJECTS <objects>...] [OPTIMISE <level>] [PROCESSOR <name>]
#                   [LINKER_SCRIPT <file>] [LINK_OPTIONS <option>...] [NEWLIB_START])
#
# makes the executable target <name> and its file <name>.elf. The linker takes the sources and then the objects, in the order
# in which they are named; what nothing calls is left out. OPTIMISE is -Os without a word, LINKER_SCRIPT the variable
# CAPSOC_LINKER_SCRIPT. PROCESSOR is for the compiler's -mcpu (cortex-m0plus, cortex-m4), the toolchain's without a word; cortex-m4f is a cortex-m4 whose FPU
# takes the arguments of functions, too. Vectors and start-up are among the sources, or with NEWLIB_START newlib's own.
#
#   capsoc_firmware_objects(<objects> SOURCES <file>... [OPTIMISE <level>] [PROCESSOR <name>])
#
# compiles files once for several programs. Include folders, warnings and other options are those of the folder
# (include_directories, add_compile_options, add_link_options).

# The compiler's options for a PROCESSOR, also for the linker, which chooses libraries by them.
function(capsoc_processor_options result processor)
  if(processor STREQUAL "cortex-m4f")
    set(${result} -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard PARENT_SCOPE)
  else()
    set(${result} -mcpu=${processor} PARENT_SCOPE)
  endif()
endfunction()

function(capsoc_firmware_objects name)
  cmake_parse_arguments(PARSE_ARGV 1 of "" "OPTIMISE;PROCESSOR" "SOURCES")
  if(NOT of_OPTIMISE)
    set(of_OPTIMISE -Os)
  endif()
  add_library(${name} OBJECT ${of_SOURCES})
  set_target_properties(${name} PROPERTIES C_STANDARD 11)
  target_compile_options(${name} PRIVATE -g ${of_OPTIMISE} -ffunction-sections -fdata-sections -fno-common)
  if(of_PROCESSOR)
    capsoc_processor_options(options "${of_PROCESSOR}")
    target_compile_options(${name} PRIVATE ${options}) # the last one counts
  endif()
endfunction()

function(capsoc_firmware name)
  cmake_parse_arguments(PARSE_ARGV 1 of "NEWLIB_START" "OPTIMISE;PROCESSOR;LINKER_SCRIPT" "SOURCES;OBJECTS;LINK_OPTIONS")
  if(NOT of_LINKER_SCRIPT)
    set(of_LINKER_SCRIPT "${CAPSOC_LINKER_SCRIPT}")
  endif()
  get_filename_component(script "${of_LINKER_SCRIPT}" ABSOLUTE)
  if(of_SOURCES)
    capsoc_firmware_objects(${name}_sources OPTIMISE "${of_OPTIMISE}" PROCESSOR "${of_PROCESSOR}" SOURCES ${of_SOURCES})
    list(PREPEND of_OBJECTS ${name}_sources)
  endif()
  list(TRANSFORM of_OBJECTS REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  add_executable(${name} ${of_OBJECTS})
  set_target_properties(${name} PROPERTIES SUFFIX .elf LINKER_LANGUAGE C LINK_DEPENDS "${script}")
  if(of_PROCESSOR)
    capsoc_processor_options(options "${of_PROCESSOR}")
    target_link_options(${name} PRIVATE ${options})
  endif()
  if(NOT of_NEWLIB_START)
    target_link_options(${name} PRIVATE -nostartfiles)
  endif()
  target_link_options(${name} PRIVATE -T "${script}" -Wl,--gc-sections -Wl,--no-warn-rwx-segments ${of_LINK_OPTIONS})
  target_link_libraries(${name} PRIVATE m)
endfunction()
