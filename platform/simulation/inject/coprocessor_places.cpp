// The coprocessor's state as places: shared by model and RTL, of one side, and flip-flops.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"
#include "coprocessor/idle_state.h"
#include "coprocessor/register_map.h"
#include "inject/coprocessor_words.h"
#include "inject/places.h"
#include "rtl/rtl_state.h"

namespace capsoc::inject {
namespace {

using coprocessor::CoprocessorTlm;
using coprocessor::Device;
using coprocessor::IdleState;

const Device::IdleChange no_change = [](IdleState&) { return false; };

/// Some bits of a word, from `low` on.
struct Part {
  const CoprocessorWord* word;
  unsigned low, bits;

  Change change(capsoc_rtl_state& registers, const Place::To& to) const {
    const uint64_t mask = ~uint64_t{0} >> (64 - bits);
    uint64_t& value = value_of(registers, *word);
    const uint64_t before = value >> low & mask, after = to(before) & mask;
    value = (value & ~(mask << low)) | after << low;
    return {before, after};
  }
};

class CoprocessorPlace : public Place {
 public:
  CoprocessorPlace(CoprocessorTlm& shell, Part part) : shell_(shell), part_(part) {}
  sc_core::sc_time ready_at() const override {
    return shell_.quiet_at().value_or(sc_core::sc_time_stamp());
  }
  Writer writer() const override { return Writer::result; }

 protected:
  CoprocessorTlm& shell_;
  Part part_;
};

/// State that is the same in every device; the pipeline has to be empty. `side`: null: of all.
class SharedState final : public CoprocessorPlace {
 public:
  using Side = Device& (rtl::Lockstep::*)();
  SharedState(CoprocessorTlm& shell, Part part, rtl::Lockstep* lockstep, Side side)
      : CoprocessorPlace(shell, part), lockstep_(lockstep), side_(side) {}

  std::optional<Change> change(const To& to) override {
    std::optional<Change> made;
    const Device::IdleChange edit = [&](IdleState& state) {
      capsoc_rtl_state registers = rtl::to_rtl(state);
      made = part_.change(registers, to);
      if (made->before == made->after) return false;
      const uint64_t cycle = state.cycle;
      state = rtl::to_model(registers, coprocessor::Nodes(state.nodes));
      state.cycle = cycle;
      return true;
    };
    if (lockstep_ == nullptr) {
      shell_.change_idle(edit);
    } else if (shell_.change_idle(no_change)) {
      (lockstep_->*side_)().change_idle(edit);
      shell_.device_changed();
    }
    return made;
  }

 private:
  rtl::Lockstep* lockstep_;
  Side side_;
};

/// Up to 64 flip-flops of the RTL, whatever it does.
class FlipFlops final : public Place {
 public:
  FlipFlops(CoprocessorTlm& shell, const run::CoprocessorBackend& backend, uint32_t index,
            uint32_t part)
      : shell_(shell), backend_(backend), index_(index), part_(part) {}

  std::optional<Change> change(const To& to) override {
    meet();
    const uint64_t before = backend_.rtl->get_flip_flops(index_, part_), after = to(before);
    if (after != before) backend_.rtl->set_flip_flops(index_, part_, after);
    shell_.device_changed();
    return Change{before, after};
  }
  bool hold(unsigned bit, bool value) override {
    meet();
    const uint64_t mask = uint64_t{1} << bit;
    backend_.rtl->hold_flip_flops(index_, part_, mask, value ? mask : 0);
    return true;
  }
  void release(unsigned bit) override {
    meet();
    backend_.rtl->release_flip_flops(index_, part_, uint64_t{1} << bit);
  }
  Writer writer() const override { return Writer::result; }

 private:
  /// Takes the device to this instant.
  void meet() {
    shell_.change_idle(no_change);
    if (backend_.lockstep != nullptr) backend_.lockstep->rtl();
  }

  CoprocessorTlm& shell_;
  const run::CoprocessorBackend& backend_;
  uint32_t index_, part_;
};

constexpr const char* unit_name = "coprocessor.";
constexpr const char* model_name = "model.";
constexpr const char* rtl_name = "rtl.";

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

const CoprocessorWord* shared_word(const std::string& name) {
  for (const CoprocessorWord& word : coprocessor_words())
    if (word.is_shared && word.name == name) return &word;
  return nullptr;
}

/// Registers of the description that have another name in the state.
struct Renamed {
  const char *description, *word;
};
constexpr std::array<Renamed, 17> renamed = {{{"EARLY_COUNT", "early"},
                                              {"RAW_U", "sample_words.0"},
                                              {"RAW_V", "sample_words.1"},
                                              {"CAL_S", "sample_words.2"},
                                              {"CAL_C", "sample_words.3"},
                                              {"REF_PHASE", "error_words.0"},
                                              {"ERR_U", "error_words.1"},
                                              {"ERR_V", "error_words.2"},
                                              {"RESIDUE", "error_words.3"},
                                              {"AMPLITUDE", "quality_words.0"},
                                              {"ERROR_AVERAGE", "quality_words.8"},
                                              {"TURN_FLAGS", "last_flags"},
                                              {"TURN_DET", "quality_words.23"},
                                              {"RADIUS_MAX", "quality_words.28"},
                                              {"RESIDUE_MAX", "quality_words.29"},
                                              {"WINDING", "quality_words.30"},
                                              {"TURN_SAMPLES", "quality_words.31"}}};

/// Where a register keeps its value; nothing: it has none, or its fields have.
std::optional<Part> state_of(const soc::RegisterPlace& at) {
  const std::string& reg = at.reg->name;
  // Their fields are their own registers.
  const bool is_split = reg == "CTRL" || reg == "LOOP" || reg == "STATUS";
  if (is_split) {
    const CoprocessorWord* word =
        at.field != nullptr ? shared_word(lower(at.field->name)) : nullptr;
    return word == nullptr ? std::nullopt : std::optional(Part{word, 0, word->bits});
  }
  std::string name = lower(reg);
  for (const Renamed& one : renamed)
    if (reg == one.description) name = one.word;
  const CoprocessorWord* word = shared_word(name);
  if (word == nullptr) return std::nullopt;
  if (at.field == nullptr) return Part{word, 0, word->bits};
  if (at.field->low >= word->bits) return std::nullopt;
  return Part{word, at.field->low, std::min(at.field->bits, word->bits - at.field->low)};
}

std::unique_ptr<Place> shared(CoprocessorTlm& shell, Part part) {
  return std::make_unique<SharedState>(shell, part, nullptr, nullptr);
}

/// "u_turn_judge" of "u_datapath.u_turn_judge.words.3".
std::string unit_of(std::string flip_flop) {
  const std::size_t last = flip_flop.rfind(".u_");
  if (last != std::string::npos) flip_flop.erase(0, last + 1);
  return flip_flop.substr(0, flip_flop.find('.'));
}

}  // namespace

Result<PlacedBit> Places::coprocessor_register(const std::string& name,
                                               const soc::RegisterPlace& at, unsigned bit) const {
  const auto part = state_of(at);
  if (!part)
    return Error{fmt::format(
        "{} keeps no value itself; name one of its fields, or its state as coprocessor.NAME",
        name)};
  if (bit >= part->bits) return no_such_bit(name, bit, part->bits);
  return PlacedBit{shared(soc_.coprocessor, *part), bit};
}

Result<PlacedBit> Places::coprocessor_bit(const std::string& name, unsigned bit) const {
  const bool of_rtl = name.rfind(rtl_name, 0) == 0, of_model = name.rfind(model_name, 0) == 0;
  if (of_rtl && backend_.rtl == nullptr)
    return Error{fmt::format("{}: there is no RTL; take --coprocessor rtl or lockstep", name)};
  if (of_model && backend_.lockstep == nullptr && backend_.rtl != nullptr)
    return Error{fmt::format("{}: there is no model; take --coprocessor tlm or lockstep", name)};
  const std::string own = name.substr(name.find('.') + 1);
  std::vector<std::string> names;
  for (const CoprocessorWord& word : coprocessor_words()) {
    if (!word.is_shared) continue;
    names.push_back(word.name);
    if (word.name != own) continue;
    if (bit >= word.bits) return no_such_bit(name, bit, word.bits);
    const Part part{&word, 0, word.bits};
    const bool one_side = (of_rtl || of_model) && backend_.lockstep != nullptr;
    if (!one_side) return PlacedBit{shared(soc_.coprocessor, part), bit};
    const SharedState::Side side = of_rtl ? &rtl::Lockstep::rtl : &rtl::Lockstep::model;
    return PlacedBit{std::make_unique<SharedState>(soc_.coprocessor, part, backend_.lockstep, side),
                     bit};
  }
  for (uint32_t index = 0; of_rtl && index < backend_.rtl->flip_flop_count(); ++index) {
    const capsoc_rtl_flip_flops& word = backend_.rtl->flip_flops()[index];
    names.emplace_back(word.name);
    if (own != word.name) continue;
    if (bit >= word.bits) return no_such_bit(name, bit, word.bits);
    return PlacedBit{std::make_unique<FlipFlops>(soc_.coprocessor, backend_, index, bit / 64),
                     bit % 64};
  }
  return Error{fmt::format("the coprocessor has no '{}'; did you mean {}?", printable(own, 80),
                           nearest_names(own, std::move(names)))};
}

/// What model and RTL share, and also each flip-flop of the RTL: two views of one chip.
void Places::list_coprocessor(std::vector<ListedPlace>& list) const {
  for (const CoprocessorWord& word : coprocessor_words())
    if (word.is_shared) list.push_back({unit_name + word.name, word.bits, "coprocessor"});
  if (backend_.rtl == nullptr) return;
  for (std::size_t i = 0; i < backend_.rtl->flip_flop_count(); ++i) {
    const capsoc_rtl_flip_flops& word = backend_.rtl->flip_flops()[i];
    list.push_back(
        {std::string(rtl_name) + word.name, word.bits, std::string(rtl_name) + unit_of(word.name)});
  }
}

}  // namespace capsoc::inject
