#include "view/page.h"

#include <string_view>

#include "host/sha256.h"

namespace capsoc::view {

// Embedded at build time.
extern const std::string_view page_body, page_script, page_style;

std::string page() {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>capsoc view</title>\n<style>";
  out.append(page_style).append("</style>\n</head>\n<body>\n").append(page_body);
  return out.append("<script>").append(page_script).append("</script>\n</body>\n</html>\n");
}

std::string page_policy() {
  return "default-src 'none'; script-src 'sha256-" + host::base64_sha256_of(page_script) +
         "'; style-src 'sha256-" + host::base64_sha256_of(page_style) +
         "'; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
         "frame-ancestors 'none'";
}

}  // namespace capsoc::view
