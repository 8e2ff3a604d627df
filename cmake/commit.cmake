# Writes OUTPUT, a header with the commit that FOLDER is at ("-dirty" with changes), or "unknown" outside a git checkout of its
# own, if that has changed. Run at every build.
set(commit unknown)
find_program(GIT git)
if(GIT)
  set(ENV{GIT_OPTIONAL_LOCKS} 0) # no lock that another git would stumble over
  execute_process(COMMAND ${GIT} -C ${FOLDER} rev-parse --show-toplevel
                  OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH ${FOLDER} folder)
  if(top STREQUAL folder) # not the sources inside somebody else's repository
    execute_process(COMMAND ${GIT} -C ${FOLDER} describe --always --dirty --abbrev=12 --match v[0-9]*
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed AND described MATCHES "^[-.A-Za-z0-9]+$")
      set(commit ${described})
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n#define CAPSOC_COMMIT \"${commit}\"\n")
