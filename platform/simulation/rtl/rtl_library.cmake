# Shared libraries of Verilated RTL behind rtl_abi.h: `capsoc` opens them at run time (--rtl-library), so RTL may change without it.
#
#   capsoc_add_rtl_library(NAME TOP MODULE SOURCES FILE...
#     [ARITHMETIC precise|paper] [OPERAND_BITS N] [REFERENCE_LEAD N] [STEP_SHIFT N] [PLAIN_ARCTANGENT 0|1] [ITERATION_CLOCKS 1|2]
#     [PINS PIN=PORT...] [PARAMETERS NAME=VALUE...] [VERILATOR_ARGS ARG...] [DEPENDS FILE...])
#
# makes libNAME.so of somebody's own design. It is compared with the model as a black box, at its pins:
#
#   capsoc regress --arithmetic precise --rtl-library libNAME.so
#
# MODULE has an APB and a sample port (docs/reference/coprocessor.md, "Bus and sample port").
# A pin that is not in PINS has its own name in the design; PIN= says that the design has none.
#   in   pclk, presetn (or preset, active high), psel, penable, pwrite, paddr[11:0], pwdata[31:0], pstrb[3:0] (may be missing),
#        sample_valid, sample_u[31:0], sample_v[31:0] (Q1.31), sample_clip; sample_channel[3:0] only if it is in PINS
#   out  prdata[31:0], and those that may be missing: pready, pslverr, sample_ready, irq, idle
# ARITHMETIC and the five behind it name the model that the design is to agree with (capsoc's settings coprocessor.arithmetic and
# coprocessor.paper_*). Verilator's warnings of the design are shown.
include_guard(GLOBAL)

set(CAPSOC_RTL_FOLDER ${CMAKE_CURRENT_LIST_DIR})
cmake_path(GET CAPSOC_RTL_FOLDER PARENT_PATH CAPSOC_RTL_INCLUDE)

# The list of settings that rtl_state.def includes. An installed tree has it; in a source tree it is generated.
set(CAPSOC_RTL_GENERATED ${CAPSOC_RTL_FOLDER})
if(NOT EXISTS ${CAPSOC_RTL_FOLDER}/capsoc_coprocessor_settings.def)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  set(CAPSOC_RTL_GENERATED ${CMAKE_BINARY_DIR}/generated)
  cmake_path(GET CAPSOC_RTL_INCLUDE PARENT_PATH capsoc_tree)
  cmake_path(GET capsoc_tree PARENT_PATH capsoc_tree)
  set(capsoc_description ${capsoc_tree}/models/registers/capsoc.svd)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${capsoc_description})
  execute_process(COMMAND ${Python3_EXECUTABLE} ${capsoc_tree}/scripts/tool registers ${capsoc_description} ${CAPSOC_RTL_GENERATED}
                  COMMAND_ERROR_IS_FATAL ANY)
endif()

find_program(VERILATOR verilator REQUIRED)
cmake_path(GET VERILATOR PARENT_PATH capsoc_verilator_bin)
cmake_path(GET capsoc_verilator_bin PARENT_PATH capsoc_verilator_prefix)
find_path(VERILATOR_INCLUDE verilated.h REQUIRED
          HINTS $ENV{VERILATOR_ROOT}/include ${capsoc_verilator_prefix}/share/verilator/include)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)

# One of Verilator's passes takes a bit of a packed struct from the wrong place: with 5.032 an assertion of datapath.sv fails that
# holds. 5.006 does not do it, and specialised/specialise.py knows the form of its code with the pass.
execute_process(COMMAND ${VERILATOR} --version OUTPUT_VARIABLE capsoc_verilator_version COMMAND_ERROR_IS_FATAL ANY)
set(capsoc_verilator_flags "")
if(NOT capsoc_verilator_version MATCHES "^Verilator 5\\.006 ")
  set(capsoc_verilator_flags -fno-dfg-peephole)
endif()
set_property(GLOBAL PROPERTY CAPSOC_VERILATOR_FLAGS ${capsoc_verilator_flags})  # for benches that call verilate()

set(capsoc_verilator_definitions VL_TIME_CONTEXT VM_COVERAGE=1 VM_TRACE=1 VM_TRACE_FST=1 VM_SC=0)

# capsoc_verilated_library(NAME TOP MODULE WRAPPER FILE HASH FOLDER SOURCES FILE... FLAGS FLAG... DEFINITIONS DEFINITION...
#                          [DEPENDS FILE...] [COVERAGE] [FAST] [SPECIALISE SCRIPT] [FLIP_FLOPS SCRIPT]): what all of them have in common. FOLDER has rtl_hash.h;
# FAST is built fast, not run fast; the scripts make the edges of specialised/edges.h and flip_flops.inc.
function(capsoc_verilated_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "COVERAGE;FAST" "TOP;HASH;SPECIALISE;FLIP_FLOPS" "WRAPPER;SOURCES;FLAGS;DEFINITIONS;DEPENDS")
  # Verilator's own sources. They stay inside each library: two in one program share nothing.
  if(NOT TARGET capsoc_verilator_runtime)
    add_library(capsoc_verilator_runtime OBJECT EXCLUDE_FROM_ALL
                ${VERILATOR_INCLUDE}/verilated.cpp ${VERILATOR_INCLUDE}/verilated_cov.cpp
                ${VERILATOR_INCLUDE}/verilated_fst_c.cpp ${VERILATOR_INCLUDE}/verilated_save.cpp
                ${VERILATOR_INCLUDE}/verilated_threads.cpp)
    set_target_properties(capsoc_verilator_runtime PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_STANDARD 17
                          CXX_VISIBILITY_PRESET hidden EXPORT_COMPILE_COMMANDS OFF)
    target_include_directories(capsoc_verilator_runtime SYSTEM PRIVATE ${VERILATOR_INCLUDE} ${VERILATOR_INCLUDE}/vltstd)
    target_compile_definitions(capsoc_verilator_runtime PRIVATE ${capsoc_verilator_definitions})
    target_compile_options(capsoc_verilator_runtime PRIVATE -O3 -w)
  endif()
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name})
  # Plain C++ without threads. What has no value before its first use is 0: the formal proofs and the other simulators
  # take care of that question.
  set(flags --cc -O3 --x-assign 0 --x-initial 0 --trace-fst --trace-structs --no-timing -Wno-fatal ${capsoc_verilator_flags}
            --top-module ${arg_TOP} ${arg_FLAGS})
  set(coverage 0)
  if(arg_COVERAGE)
    # A bundle is wider than what Verilator counts by itself, 256 bits.
    list(APPEND flags --coverage-line --coverage-toggle --coverage-max-width 1024)
    set(coverage 1)
  endif()
  # The names of the files depend on their contents, so one file includes them all, and one those that write waves.
  add_custom_command(
    OUTPUT ${folder}/all.cpp ${folder}/trace.cpp
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${folder}
    COMMAND ${VERILATOR} ${flags} --Mdir ${folder} ${arg_SOURCES}
    COMMAND ${CMAKE_COMMAND} -D "FOLDER=${folder}" -P ${CAPSOC_RTL_FOLDER}/include_all.cmake
    DEPENDS ${arg_SOURCES} ${arg_DEPENDS}
    COMMENT "Verilating ${name}" VERBATIM)
  set(specialised "")
  if(arg_SPECIALISE)
    set(specialised ${folder}/specialised.cc)
    add_custom_command(
      OUTPUT ${specialised}
      COMMAND ${Python3_EXECUTABLE} ${arg_SPECIALISE} ${folder} ${specialised}
      DEPENDS ${folder}/all.cpp ${arg_SPECIALISE}
      COMMENT "Specialising ${name}" VERBATIM)
    set_source_files_properties(${specialised} PROPERTIES COMPILE_OPTIONS -w)
  endif()
  set(flip_flops "")
  if(arg_FLIP_FLOPS)
    set(flip_flops ${folder}/flip_flops.inc)
    add_custom_command(
      OUTPUT ${flip_flops}
      COMMAND ${Python3_EXECUTABLE} ${arg_FLIP_FLOPS} ${folder} ${flip_flops}
      DEPENDS ${folder}/all.cpp ${arg_FLIP_FLOPS}
      COMMENT "Listing the flip-flops of ${name}" VERBATIM)
  endif()
  set(compiled ${arg_WRAPPER} ${folder}/all.cpp ${folder}/trace.cpp)
  if(arg_FAST)
    # Of each file two seconds are Verilator's headers, so it is one.
    set(text "#define CAPSOC_RTL_FAST 1\n")
    foreach(source ${compiled})
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
      string(APPEND text "#include \"${source}\"\n")
    endforeach()
    file(CONFIGURE OUTPUT ${folder}.cpp CONTENT "${text}" @ONLY)
    set(compiled ${folder}.cpp)
    set_source_files_properties(${folder}.cpp PROPERTIES COMPILE_OPTIONS -w OBJECT_DEPENDS "${folder}/all.cpp;${flip_flops}")
  endif()
  add_library(${name} SHARED ${compiled} ${specialised} ${flip_flops} $<TARGET_OBJECTS:capsoc_verilator_runtime>)
  target_include_directories(${name} PRIVATE ${CAPSOC_RTL_INCLUDE} ${CAPSOC_RTL_GENERATED} ${arg_HASH})
  target_include_directories(${name} SYSTEM PRIVATE ${folder} ${VERILATOR_INCLUDE} ${VERILATOR_INCLUDE}/vltstd)
  target_compile_definitions(${name} PRIVATE ${arg_DEFINITIONS} CAPSOC_RTL_COVERAGE=${coverage} ${capsoc_verilator_definitions})
  target_compile_features(${name} PRIVATE cxx_std_17)
  set_target_properties(${name} PROPERTIES CXX_VISIBILITY_PRESET hidden)
  # With coverage it is 36 MB of source, which optimisation would take many minutes for. What writes waves waits for the file.
  set(optimised -O3)
  set(optimised_trace -O1)
  if(arg_COVERAGE)
    set(optimised -O0)
    set(optimised_trace -O0)
  elseif(arg_FAST)
    set(optimised -O1)
  endif()
  target_compile_options(${name} PRIVATE ${optimised})
  set_source_files_properties(${folder}/all.cpp PROPERTIES COMPILE_OPTIONS -w)
  set_source_files_properties(${folder}/trace.cpp PROPERTIES COMPILE_OPTIONS "-w;${optimised_trace}")
  target_link_libraries(${name} PRIVATE ${ZLIB_LIBRARIES} Threads::Threads)
endfunction()

# capsoc_rtl_hash(FOLDER FILE...): FOLDER/rtl_hash.h, which names the sources by what is in them.
function(capsoc_rtl_hash folder)
  set(sources ${ARGN})
  add_custom_command(
    OUTPUT ${folder}/rtl_hash.h
    COMMAND ${CMAKE_COMMAND} -D "OUTPUT=${folder}/rtl_hash.h" -D "SOURCES=${sources}" -P ${CAPSOC_RTL_FOLDER}/hash_sources.cmake
    DEPENDS ${sources} ${CAPSOC_RTL_FOLDER}/hash_sources.cmake
    COMMENT "Hashing the RTL" VERBATIM)
endfunction()

# The ports of `MODULE` that a pin is connected to, by PINS; "" for a missing one. Sets port_PIN in the caller.
function(capsoc_ports name)
  set(inputs pclk presetn preset psel penable pwrite paddr pwdata pstrb sample_valid sample_u sample_v sample_clip sample_channel)
  set(outputs prdata pready pslverr sample_ready irq idle)
  set(optional sample_channel pstrb pready pslverr sample_ready irq idle)
  foreach(pin ${inputs} ${outputs})
    set(port_${pin} ${pin})
  endforeach()
  set(port_preset "")
  set(port_sample_channel "")
  foreach(connection ${ARGN})
    set(pins ${inputs} ${outputs})
    if(NOT connection MATCHES "^([a-z_]+)=([A-Za-z_0-9$]*)$" OR NOT CMAKE_MATCH_1 IN_LIST pins)
      message(FATAL_ERROR "capsoc_add_rtl_library(${name}): '${connection}' is no PIN=PORT; the pins are ${pins}")
    endif()
    set(pin ${CMAKE_MATCH_1})
    set(port "${CMAKE_MATCH_2}")
    if("${port}" STREQUAL "" AND NOT pin IN_LIST optional)
      message(FATAL_ERROR "capsoc_add_rtl_library(${name}): the design must have ${pin}; only ${optional} may be missing")
    endif()
    set(port_${pin} "${port}")
    if(pin STREQUAL "preset")
      set(port_presetn "")
    endif()
  endforeach()
  foreach(pin ${inputs} ${outputs})
    set(port_${pin} "${port_${pin}}" PARENT_SCOPE)
  endforeach()
endfunction()

function(capsoc_add_rtl_library name)
  set(model ARITHMETIC OPERAND_BITS REFERENCE_LEAD STEP_SHIFT PLAIN_ARCTANGENT ITERATION_CLOCKS)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TOP;${model}" "SOURCES;PINS;PARAMETERS;VERILATOR_ARGS;DEPENDS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_TOP OR NOT arg_SOURCES)
    message(FATAL_ERROR "capsoc_add_rtl_library(${name}): wants TOP and SOURCES, and nothing that it does not know (${arg_UNPARSED_ARGUMENTS})")
  endif()
  set(arithmetics precise paper)
  set(defaults precise 32 0 0 0 1)
  foreach(key default IN ZIP_LISTS model defaults)
    if(NOT DEFINED arg_${key})
      set(arg_${key} ${default})
    endif()
  endforeach()
  list(FIND arithmetics "${arg_ARITHMETIC}" paper)
  if(paper EQUAL -1)
    message(FATAL_ERROR "capsoc_add_rtl_library(${name}): ARITHMETIC is precise or paper")
  endif()
  capsoc_ports(${name} ${arg_PINS})

  # The design in a wrapper with our names.
  set(connections "")
  foreach(pin presetn psel penable pwrite paddr pwdata pstrb sample_valid sample_u sample_v sample_clip sample_channel)
    if(port_${pin})
      list(APPEND connections "    .${port_${pin}}(${pin})")
    endif()
  endforeach()
  list(APPEND connections "    .${port_pclk}(pclk_i)")
  if(port_preset)
    list(APPEND connections "    .${port_preset}(~presetn)")
  endif()
  set(absent "")
  set(absent_pins 0)
  foreach(pin prdata pready pslverr sample_ready irq idle)
    if(port_${pin})
      list(APPEND connections "    .${port_${pin}}(${pin}_o)")
    else()
      string(APPEND absent "  assign ${pin}_o = '0;\n")
    endif()
  endforeach()
  foreach(pin pstrb pready pslverr sample_ready irq idle)
    if(NOT port_${pin})
      string(TOUPPER ${pin} upper)
      string(APPEND absent_pins " | CAPSOC_RTL_${upper}")
    endif()
  endforeach()
  set(parameters "")
  foreach(parameter ${arg_PARAMETERS})
    string(REGEX REPLACE "^([^=]+)=(.*)$" ".\\1(\\2)" parameter "${parameter}")
    list(APPEND parameters "${parameter}")
  endforeach()
  list(JOIN connections ",\n" connections)
  list(JOIN parameters ", " parameters)
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/${name}_generated)
  set(design ${arg_TOP})
  configure_file(${CAPSOC_RTL_FOLDER}/black_box.sv.in ${generated}/capsoc_black_box.sv @ONLY)
  configure_file(${CAPSOC_RTL_FOLDER}/black_box.cpp.in ${generated}/black_box.cpp COPYONLY)

  set(sources "")
  foreach(source ${arg_SOURCES})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    list(APPEND sources ${source})
  endforeach()
  capsoc_rtl_hash(${generated} ${sources} ${arg_DEPENDS})
  capsoc_verilated_library(${name} TOP capsoc_black_box WRAPPER ${generated}/black_box.cpp HASH ${generated}
    SOURCES ${sources} ${generated}/capsoc_black_box.sv DEPENDS ${arg_DEPENDS} FLAGS ${arg_VERILATOR_ARGS}
    DEFINITIONS CAPSOC_RTL_PAPER=${paper} CAPSOC_RTL_OPERAND_BITS=${arg_OPERAND_BITS} CAPSOC_RTL_REFERENCE_LEAD=${arg_REFERENCE_LEAD}
                CAPSOC_RTL_STEP_SHIFT=${arg_STEP_SHIFT} CAPSOC_RTL_PLAIN_ARCTANGENT=${arg_PLAIN_ARCTANGENT}
                CAPSOC_RTL_ITERATION_CLOCKS=${arg_ITERATION_CLOCKS} CAPSOC_RTL_CHANNELS=1
                "CAPSOC_RTL_ABSENT_PINS=(${absent_pins})")
  target_sources(${name} PRIVATE ${generated}/rtl_hash.h)
endfunction()
