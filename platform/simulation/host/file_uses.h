// The files that a command reads and writes, compared with each other before anything is opened.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc::host {

/// One file of a command.
struct FileUse {
  enum class Kind { input, output };
  Kind kind;
  std::string name;  ///< of the option, as an error sentence has it: "--json"
  std::string path;
};

/// An Error if an output is an input's file or another output's: by device and inode, or, of files
/// that are not there yet, by where the name leads to. The standard streams of the program count
/// where they are files. Devices, pipes and names of open descriptors (/dev/stdout) are exempt. The
/// sentence names both options and the file.
std::optional<Error> check_uses(const std::vector<FileUse>& uses);

/// An Error if an output is not below `folder`, also by a link or "..". /dev/null is exempt. The
/// sentence names the output.
std::optional<Error> check_within(const std::vector<FileUse>& uses, const std::string& folder);

/// The first of these outputs that is one of the others, by whatever names; null: there is none.
/// The same files count as in check_uses().
const FileUse* shared_output(const std::vector<FileUse>& uses, const std::vector<FileUse>& others);

}  // namespace capsoc::host
