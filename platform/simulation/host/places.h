// Where the files that come with the program lie, in the build tree and in an install tree.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace capsoc::host {

/// The path of the running program itself, "" if the system does not tell.
std::string program_path();

/// A file or folder of the program's data (`firmware/selfcal.elf`, `traces`): next to the program,
/// in the share/capsoc of its install tree, or one level up. Relative to the current folder if it
/// lies below it, absolute otherwise. Where it should be next to the program if it is nowhere.
std::string data_path(const std::string& relative);

/// A library that the program loads: next to it, in the lib/capsoc of its install tree, or some
/// levels up, where the tests' programs find it. As data_path() otherwise.
std::string library_path(const std::string& name);

/// The regular files in a folder whose names end so (".elf"), in order; none of what cannot be
/// read.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder,
                                            const std::filesystem::path& ending);

}  // namespace capsoc::host
