# Writes FOLDER/all.cpp, which includes every C++ file that Verilator made there.
file(GLOB files RELATIVE ${FOLDER} ${FOLDER}/*.cpp)
set(text "")
foreach(file ${files})
  string(APPEND text "#include \"${file}\"\n")
endforeach()
file(WRITE ${FOLDER}/all.cpp "${text}")
