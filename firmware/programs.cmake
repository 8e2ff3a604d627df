# Every program of this folder, one call each (template/capsoc_firmware.cmake); paths are relative to this folder.
# cmake/firmware.cmake reads the same calls for the names of the ELF files.

# What every program has below it: start-up, console, newlib's system calls, drivers.
set(runtime)
foreach(source startup bus_probe system semihosting sleep console syscalls fixed_print program_verdict)
  list(APPEND runtime common/${source}.c)
endforeach()
foreach(source adc clock coprocessor gpio timer uart)
  list(APPEND runtime drivers/${source}.c)
endforeach()
capsoc_firmware_objects(runtime SOURCES ${runtime})
foreach(level -O0 -O2 -O3)
  capsoc_firmware_objects(runtime${level} OPTIMISE ${level} SOURCES ${runtime})
endforeach()

# What people run: the applications. What several share, and what only one has but its main file calls.
set(shared)
foreach(source angle_report evenness judgement parameter_report sampling signal_shape start_load start_range steering supervision)
  list(APPEND shared apps/common/${source}.c)
endforeach()
capsoc_firmware_objects(shared SOURCES ${shared})
capsoc_firmware_objects(blocks SOURCES apps/common/blocks.c)
capsoc_firmware_objects(turn_meter SOURCES apps/track/turn_meter.c)
capsoc_firmware_objects(calibration SOURCES apps/calibrate/parameter_block.c apps/calibrate/sensor_change.c)
capsoc_firmware_objects(follower SOURCES apps/follow/follower.c)
capsoc_firmware_objects(error_table OPTIMISE -O2 SOURCES apps/harmonics/error_table.c)
capsoc_firmware_objects(estimator OPTIMISE -O2 SOURCES apps/recursive/estimator.c)

capsoc_firmware(selfcal SOURCES apps/selfcal/main.c OBJECTS shared runtime)
capsoc_firmware(safe SOURCES apps/safe/main.c apps/safe/protection.c drivers/safe_angle.c drivers/coprocessor_safety.c OBJECTS shared runtime)
capsoc_firmware(paper SOURCES apps/paper/main.c OBJECTS shared runtime)
capsoc_firmware(channels SOURCES apps/channels/main.c drivers/coprocessor_channels.c apps/common/parameter_report.c OBJECTS runtime)
capsoc_firmware(track SOURCES apps/track/main.c OBJECTS shared turn_meter runtime)
capsoc_firmware(calibrate SOURCES apps/calibrate/main.c OBJECTS shared calibration runtime)
capsoc_firmware(quick SOURCES apps/quick/main.c OBJECTS shared blocks runtime)
capsoc_firmware(harmonics SOURCES apps/harmonics/main.c OBJECTS shared blocks error_table runtime)
capsoc_firmware(follow SOURCES apps/follow/main.c OBJECTS shared blocks follower runtime)
capsoc_firmware(unordered SOURCES apps/unordered/main.c OBJECTS shared runtime)
capsoc_firmware(recursive SOURCES apps/recursive/main.c OBJECTS shared estimator runtime)
set(capsoc_applications selfcal safe paper channels track calibrate quick harmonics follow unordered recursive)

# Programs for tests.
foreach(test hello debuggee profiled divzero evenjump badread stackoverflow forever exit_code drivers board newlib echo
        spin exceptions faults mpu threads imprecise itm priority_probe priority_bits overrun qemu_differences idle
        task_start failures pins transmit semihosting_calls questions long_text viewer presence endless overwritten)
  capsoc_firmware(${test} SOURCES tests/${test}.c OBJECTS runtime)
endforeach()
# The same program elsewhere, vector table included.
capsoc_firmware(hello_psram SOURCES tests/hello.c OBJECTS runtime LINK_OPTIONS -Wl,--defsym=code_origin=0x21000000)
capsoc_firmware(hello_sram SOURCES tests/hello.c OBJECTS runtime
                LINK_OPTIONS -Wl,--defsym=code_origin=0x20000000 -Wl,--defsym=data_origin=0x20200000)
# For the Cortex-M0+ (-C cpu.profile=m0plus).
capsoc_firmware_objects(runtime_m0plus PROCESSOR cortex-m0plus SOURCES ${runtime})
capsoc_firmware(hello_m0plus SOURCES tests/hello.c OBJECTS runtime_m0plus PROCESSOR cortex-m0plus)
capsoc_firmware(selfcal_m0plus SOURCES apps/selfcal/main.c ${shared} OBJECTS runtime_m0plus PROCESSOR cortex-m0plus)
# For the Cortex-M4 (-C cpu.profile=m4).
capsoc_firmware_objects(runtime_m4 PROCESSOR cortex-m4 SOURCES ${runtime})
foreach(test hello dsp no_fpu)
  capsoc_firmware(${test}_m4 SOURCES tests/${test}.c OBJECTS runtime_m4 PROCESSOR cortex-m4)
endforeach()
capsoc_firmware(selfcal_m4 SOURCES apps/selfcal/main.c ${shared} OBJECTS runtime_m4 PROCESSOR cortex-m4)
# For the Cortex-M4 with FPU (-C cpu.profile=m4f).
capsoc_firmware_objects(runtime_m4f PROCESSOR cortex-m4f SOURCES ${runtime})
foreach(test hello fpu fpu_context)
  capsoc_firmware(${test}_m4f SOURCES tests/${test}.c OBJECTS runtime_m4f PROCESSOR cortex-m4f)
endforeach()
capsoc_firmware(selfcal_m4f SOURCES apps/selfcal/main.c ${shared} OBJECTS runtime_m4f PROCESSOR cortex-m4f)
# Without our start-up.
capsoc_firmware(armv6m SOURCES tests/armv6m.c LINKER_SCRIPT tests/armv6m.ld PROCESSOR cortex-m0plus)
capsoc_firmware(rdimon SOURCES tests/rdimon.c NEWLIB_START LINKER_SCRIPT tests/rdimon.ld LINK_OPTIONS --specs=rdimon.specs)
capsoc_firmware(resets SOURCES tests/resets.c drivers/clock.c LINKER_SCRIPT tests/psram.ld)
# What the compiler emits differs from level to level.
foreach(level -O0 -O2 -O3)
  foreach(test newlib exceptions faults mpu threads)
    capsoc_firmware_objects(${test}_at${level} OPTIMISE ${level} SOURCES tests/${test}.c)
    capsoc_firmware(${test}${level} OBJECTS runtime${level} ${test}_at${level})
  endforeach()
endforeach()

# The driver and program of docs/developer/extending.md's device.
capsoc_firmware(crc_unit SOURCES ../tests/examples/crc_unit/main.c OBJECTS runtime)

# Kernels for `capsoc bench cpu`, and programs for the tests of the processor.
foreach(kernel list_search matrix state_machine crc sort strings sha256 aes md5 soft_float long_division function_pointers
               copy interpreter tasks polling interrupts device unaligned
               exclusives)
  capsoc_firmware(bench_${kernel} OPTIMISE -O2 SOURCES bench/${kernel}.c OBJECTS runtime-O2)
endforeach()
# The same with the FPU of a Cortex-M4 (`capsoc bench cpu --profile m4f`).
capsoc_firmware_objects(runtime_m4f-O2 OPTIMISE -O2 PROCESSOR cortex-m4f SOURCES ${runtime})
foreach(kernel float_matrix float_filter float_control)
  capsoc_firmware(bench_${kernel}_m4f OPTIMISE -O2 SOURCES bench/${kernel}.c OBJECTS runtime_m4f-O2 PROCESSOR cortex-m4f)
endforeach()
