# capsoc_embed(LIST NAMESPACE SYMBOL FILE)
# Adds to LIST a source that defines `extern const std::string_view SYMBOL` in NAMESPACE: the bytes of FILE.
function(capsoc_embed list namespace symbol file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${symbol}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -D INPUT=${file} -D OUTPUT=${source} -D NAMESPACE=${namespace} -D SYMBOL=${symbol}
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    DEPENDS ${file} ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    COMMENT "Building in ${file}" VERBATIM)
  set(${list} ${${list}} ${source} PARENT_SCOPE)
endfunction()
