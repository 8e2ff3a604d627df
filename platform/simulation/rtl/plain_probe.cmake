# Writes OUTPUT: the probe INPUT around a coprocessor whose arctangent takes its input as it is.
file(READ ${INPUT} text)
set(last ".StepShift     (StepShift),")
string(FIND "${text}" "${last}" found)
if(found EQUAL -1)
  message(FATAL_ERROR "${INPUT}: has no ${last}, where the parameter would go")
endif()
string(REPLACE "${last}" "${last}\n    .PlainArctangent(1)," text "${text}")
file(WRITE ${OUTPUT} "${text}")
