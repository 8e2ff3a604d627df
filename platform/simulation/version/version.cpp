#include "version/version.h"

#include "commit.h"

namespace capsoc {

const char* version() {
  return CAPSOC_VERSION;
}

const char* commit() {
  return CAPSOC_COMMIT;
}

}  // namespace capsoc
