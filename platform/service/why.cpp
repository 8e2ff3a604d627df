#include "service/why.h"

#include <fmt/format.h>

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "base/nearest.h"
#include "base/printable.h"
#include "coprocessor/register_map.h"
#include "coprocessor/sequencer.h"
#include "coprocessor/signal_flow.h"
#include "service/advance.h"

namespace capsoc::service {
namespace {

using coprocessor::NamedNode;
using coprocessor::Nodes;
using coprocessor::Origin;

const std::string device = "COPROCESSOR.";

std::string stage_name(unsigned stage) {
  return stage == coprocessor::commit_stage ? "registers" : fmt::format("T{}", stage);
}

/// The registers that an input of the table stands for: one, or the two of a pair; none for other
/// inputs.
std::vector<std::string> registers_of(const Board& board, const std::string& input) {
  if (input.find("state.") == 0 || input.find("sample.") == 0) return {};
  if (board.registers().find(device + input)) return {input};
  return {input + "_HI", input + "_LO"};
}

/// What the registers held when a sample was taken.
struct Taken {
  uint64_t number = 0;
  Json registers = Json::object();
};

/// Observes samples and results until the first result.
class Watch {
 public:
  Watch(Board& board, const Origin& origin) : board_(board), origin_(origin) {
    coprocessor::CoprocessorTlm& part = board.soc().coprocessor;
    samples_ = part.samples.listen([this](uint64_t, bool is_taken, uint64_t number) {
      if (is_taken) take(number);
    });
    results_ = part.results.listen([this](uint64_t, const Nodes& nodes, uint64_t number) {
      if (!result_) result_ = {nodes, number};
    });
  }

  const std::optional<std::pair<Nodes, uint64_t>>& result() const { return result_; }
  /// Of the result's sample, if it was taken since this watches.
  const Json* registers() const {
    for (const Taken& each : taken_)
      if (each.number == result_->second) return &each.registers;
    return nullptr;
  }

 private:
  void take(uint64_t number) {
    Taken taken{number};
    for (const std::string& input : origin_.inputs)
      for (const std::string& name : registers_of(board_, input))
        if (const auto value = board_.number_of(device + name))
          taken.registers[name] = static_cast<uint64_t>(value.value());
    taken_.push_back(std::move(taken));
    if (taken_.size() > 1 + coprocessor::stage_count) taken_.pop_front();
  }

  Board& board_;
  const Origin& origin_;
  std::deque<Taken> taken_;
  std::optional<std::pair<Nodes, uint64_t>> result_;
  kit::Listening samples_, results_;
};

/// Whether a safety mechanism of the coprocessor is on, or its flag is set.
bool is_watched(Board& board) {
  const auto word = [&](const char* name) {
    const auto value = board.number_of(device + name);
    return value ? static_cast<uint64_t>(value.value()) : 0;
  };
  return word("SAFETY") != 0 || (word("FLAGS") & coprocessor::flags_safety) != 0;
}

Json steps_of(const Origin& origin, const Nodes& nodes,
              const std::vector<coprocessor::MadeFrom>& flow) {
  Json steps = Json::array();
  for (const std::size_t index : origin.nodes) {
    const NamedNode& node = coprocessor::node_names()[index];
    const int64_t word = nodes.*node.value;
    Json step = {{"name", node.name},
                 {"stage", stage_name(node.stage)},
                 {"unit", coprocessor::name_of(node.unit)},
                 {"word", word}};
    if (node.format.meaning != coprocessor::Meaning::word) step["value"] = node.format.value(word);
    step["is_angle"] = node.format.meaning == coprocessor::Meaning::turns;
    step["made_from"] = flow[index].sources;
    steps.push_back(std::move(step));
  }
  return steps;
}

Json inputs_of(const Board& board, const Origin& origin, const Nodes& nodes,
               const Json* registers) {
  const std::vector<std::pair<std::string, int64_t>> sample = {
      {"sample.sin", nodes.u}, {"sample.cos", nodes.v}, {"sample.clip", nodes.clip}};
  Json inputs = Json::object();
  for (const std::string& input : origin.inputs) {
    for (const auto& [name, word] : sample)
      if (name == input) inputs[name] = word;
    for (const std::string& name : registers_of(board, input))
      inputs[name] = registers == nullptr ? Json() : registers->value(name, Json());
    if (input.find("state.") == 0) inputs[input] = nullptr;
  }
  return inputs;
}

}  // namespace

Answer explain_next_result(Board& board, const std::string& signal) {
  const auto index = coprocessor::node_index(signal);
  if (!index) {
    std::vector<std::string> names;
    for (const NamedNode& node : coprocessor::node_names()) names.emplace_back(node.name);
    return refuse(fmt::format("history.why: the coprocessor has no signal '{}'; did you mean {}?",
                              printable(signal, 80), nearest_names(printable(signal, 80), names)),
                  Code::wrong_parameter);
  }
  const coprocessor::Arithmetic arithmetic = board.settings().coprocessor.arithmetic();
  const bool watched = is_watched(board);
  const Origin origin = coprocessor::origin_of(*index, arithmetic, watched);
  const Watch watch(board, origin);
  const uint64_t result = board.sample_count() + 1;
  Advance advance(board);
  if (auto error = advance.go(Target{Unit::samples, result})) return refuse(error->text);
  if (advance.is_interrupted()) return refuse("the way there was interrupted");
  if (!watch.result()) return refuse("history.why: the coprocessor had no such result");
  const auto& [nodes, number] = *watch.result();
  Answer answer;
  answer.result = {
      {"signal", signal},
      {"sample", result},
      {"position", to_json(board.position())},
      {"steps", steps_of(origin, nodes, coprocessor::signal_flow(arithmetic, watched))},
      {"inputs", inputs_of(board, origin, nodes, watch.registers())}};
  return answer;
}

}  // namespace capsoc::service
