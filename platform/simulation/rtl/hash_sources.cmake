# Writes OUTPUT, a header with one hash over the SOURCES (names and contents), if it has changed.
set(text "")
foreach(source ${SOURCES})
  file(SHA256 ${source} hash)
  get_filename_component(name ${source} NAME)
  string(APPEND text "${name} ${hash}\n")
endforeach()
string(SHA256 hash "${text}")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n#define CAPSOC_RTL_SOURCE_HASH \"${hash}\"\n")
