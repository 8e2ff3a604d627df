// One figure as a picture for a paper: a file of the drawing that a page shows, too.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "report/figure.h"

namespace capsoc::report {

/// SVG on white, without scripts: axes, lines, marks and a legend; title and caption for screen
/// readers.
std::string svg_of(const Figure& figure, const Data& data);

/// Writes a picture whole: SVG, or PNG by rsvg-convert where the name ends with .png. An Error: the
/// place cannot be written, or rsvg-convert is not there.
std::optional<Error> write_picture(const std::string& path, const std::string& svg);

}  // namespace capsoc::report
