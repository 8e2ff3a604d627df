// What this build is.
#pragma once

namespace capsoc {

/// "0.1.0"
const char* version();

/// The commit that was built as `git describe` names it, with "-dirty" if files had changed;
/// "unknown" when the sources were not in a git checkout.
const char* commit();

}  // namespace capsoc
