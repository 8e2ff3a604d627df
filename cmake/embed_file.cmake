# Writes OUTPUT, C++ source that defines `extern const std::string_view SYMBOL` in NAMESPACE: the bytes of INPUT, without the
# names of source maps: files that are not there, which a browser's tools would ask for.
file(READ ${INPUT} text)
string(REGEX REPLACE "/[/*]# sourceMappingURL=[^\n]*" "" text "${text}")
set(end ")capsoc_embedded\"")
string(FIND "${text}" "${end}" inside)
if(NOT inside EQUAL -1)
  message(FATAL_ERROR "${INPUT}: holds ${end}, the end of the literal that it is written into")
endif()
file(WRITE ${OUTPUT} "#include <string_view>\n\nnamespace ${NAMESPACE} {\n\nextern const std::string_view ${SYMBOL};\n"
     "const std::string_view ${SYMBOL} =\n    R\"capsoc_embedded(${text}${end};\n\n}  // namespace ${NAMESPACE}\n")
