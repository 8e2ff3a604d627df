// A result as a report reads it: whatever is in the file, nothing of it is believed.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/curve.h"
#include "base/result.h"

namespace capsoc::report {

using Json = nlohmann::ordered_json;

/// One result of a command.
struct ResultFile {
  std::string label;  ///< what tells it from others in one report: its file's name; "" alone
  Json json;
};

/// Reads a result file. An Error: no regular file, no JSON, or no result of a command that has a
/// report.
Result<ResultFile> read_result(const std::string& path);

/// The command that wrote it: "run", "fit", "reproduce", "accuracy", "bench", "campaign",
/// "regress", and "mutation" for what scripts/tool mutation wrote; "" if it is none of these.
std::string command_of(const Json& json);

/// Of a regression and of the mutation score, in the order of their results.
inline constexpr const char* arithmetics[] = {"precise", "paper"};

using Path = std::initializer_list<const char*>;

/// What stands there; null if nothing does.
const Json* find(const Json& json, Path path);
/// A finite number, or nothing.
std::optional<double> number_at(const Json& json, Path path);
/// A text; "" if there is none. Bytes that are no UTF-8 are replaced.
std::string text_at(const Json& json, Path path);
/// As a table shows it: a text as it is, anything else as JSON has it, "-" for nothing.
std::string shown_at(const Json& json, Path path);
/// The elements of an array; none if there is no array.
std::vector<const Json*> elements_at(const Json& json, Path path);
/// `{"x": [...], "y": [...]}`: points whose x is a finite number; a y that is none is a gap.
Curve curve_at(const Json& json, Path path);

}  // namespace capsoc::report
