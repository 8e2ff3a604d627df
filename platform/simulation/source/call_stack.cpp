#include "source/call_stack.h"

#include <fmt/format.h>

#include "armv7m/exception_frame.h"
#include "base/printable.h"
#include "source/prologue.h"
#include "source/register_numbers.h"

namespace capsoc::source {
namespace {

constexpr uint32_t first_exc_return = 0xFFFFFFE0;
constexpr uint32_t stacked_alignment = 1u << 9;

bool is_exc_return(uint32_t address) {
  return address >= first_exc_return && address != 0xFFFFFFFF;
}

/// Both stack pointers and the exception in addition to the registers of a frame.
struct Context {
  Registers r{};
  uint32_t process_stack = 0;  ///< PSP, while the main stack is in use
  unsigned exception = 0;
};

Context begin(const armv7m::InterruptedRegisters& from) {
  Context context;
  context.r = from.r;
  context.process_stack = from.psp;
  context.exception = from.ipsr;
  return context;
}

/// Through the frame that an exception stacked (B1.5.6) to what it interrupted.
bool leave_exception(uint32_t exc_return, Context& context, const ReadWord& read) {
  const bool process = (exc_return & 4) != 0;
  const uint32_t frame = process ? context.process_stack : context.r[stack_pointer];
  static constexpr unsigned numbers[] = {0, 1, 2, 3, 12, link, program_counter};
  Context before = context;
  for (unsigned i = 0; i < 7; ++i) {
    const auto word = read(frame + 4 * i);
    if (!word) return false;
    before.r[numbers[i]] = *word;
  }
  const auto psr = read(frame + 28);
  if (!psr) return false;
  before.r[program_counter] &= ~1u;
  before.r[stack_pointer] =
      frame + armv7m::frame_bytes(exc_return) + ((*psr & stacked_alignment) != 0 ? 4 : 0);
  before.exception = *psr & armv7m::exception_number_mask;
  context = before;
  return true;
}

}  // namespace

std::string to_text(const SourceLine& line) {
  constexpr std::size_t longest = 200;
  const std::string file = printable(line.file, longest);
  return line.line == 0 || file.empty() ? file : fmt::format("{}:{}", file, line.line);
}

std::string to_text(const Place& place) {
  const std::string line = to_text(place.at);
  return line.empty() ? place.function : place.function + ", " + line;
}

const std::vector<std::unique_ptr<DebugInformation>>& Program::debug_information() const {
  if (debug_.empty())
    for (const loader::ElfImage* image : images_)
      debug_.push_back(std::make_unique<DebugInformation>(
          image->path, image->file ? *image->file : std::string()));
  return debug_;
}

const loader::Symbol* Program::object_at(uint32_t address) const {
  for (const loader::ElfImage* image : images_)
    if (const loader::Symbol* symbol = image->symbol_at(address)) return symbol;
  return nullptr;
}

std::string Program::symbol_at(uint32_t address) const {
  for (const loader::ElfImage* image : images_)
    if (std::string name = image->symbolise(address); !name.empty()) return name;
  return "";
}

std::optional<SourceLine> Program::line_at(uint32_t address) const {
  for (const auto& information : debug_information())
    if (auto line = information->line_at(address)) return line;
  return std::nullopt;
}

std::optional<uint32_t> Program::address_of(const std::string& symbol) const {
  for (const loader::ElfImage* image : images_)
    if (const auto address = image->address_of(symbol)) return address;
  return std::nullopt;
}

std::vector<std::string> Program::symbol_names() const {
  std::vector<std::string> names;
  for (const loader::ElfImage* image : images_)
    for (const loader::Symbol& symbol : image->symbols) names.push_back(symbol.name);
  return names;
}

const loader::Symbol* Program::function_at(uint32_t address) const {
  const loader::Symbol* symbol = object_at(address & ~1u);
  return symbol != nullptr && symbol->is_code ? symbol : nullptr;
}

std::vector<Place> Program::places_at(uint32_t address) const {
  address &= ~1u;
  for (const auto& information : debug_information()) {
    const std::vector<Place>& places = information->places_at(address);
    if (!places.empty()) return places;
  }
  const loader::Symbol* function = function_at(address);
  if (function == nullptr) return {};
  Place place;
  place.function = symbol_at(address);
  // Assembly has lines, but no functions.
  for (const auto& information : debug_information())
    if (auto line = information->line_at(address)) place.at = *line;
  return {place};
}

std::string Program::describe(uint32_t address, bool returns) const {
  const std::vector<Place> places = places_at(returns ? (address & ~1u) - 1 : address);
  return places.empty() ? "" : to_text(places.front());
}

Unwound Program::unwind(uint32_t address, Registers& registers, const ReadWord& read,
                        bool& guessed) const {
  for (const auto& information : debug_information())
    if (const Unwound result = information->unwind(address, registers, read);
        result != Unwound::not_described)
      return result;
  guessed = true;
  if (const loader::Symbol* function = function_at(address))
    return unwind_by_prologue(function->address & ~1u, address, registers, read)
               ? Unwound::caller
               : Unwound::not_described;
  // A jump to nowhere: its caller is where LR says, as long as that is code.
  if (!is_exc_return(registers[link]) && !is_code(registers[link])) return Unwound::not_described;
  registers[program_counter] =
      is_exc_return(registers[link]) ? registers[link] : registers[link] & ~1u;
  return Unwound::caller;
}

CallStack Program::call_stack(const armv7m::InterruptedRegisters& registers, const ReadWord& read,
                              std::size_t most) const {
  CallStack stack;
  Context context = begin(registers);
  bool exact = true;  // the address is an instruction's, not one after a call
  while (stack.frames.size() < most) {
    const uint32_t address = context.r[program_counter];
    if (is_exc_return(address)) {
      CallFrame frame;
      frame.exception = context.exception;
      frame.process_stack = (address & 4) != 0;
      if (!leave_exception(address, context, read)) {
        stack.end = fmt::format("the frame that exception {} stacked on {} cannot be read",
                                frame.exception, frame.process_stack ? "PSP" : "MSP");
        return stack;
      }
      frame.address = context.r[program_counter];
      frame.stack_pointer = context.r[stack_pointer];
      stack.frames.push_back(frame);
      exact = true;
      continue;
    }
    const uint32_t inside = exact ? address : address - 1;
    std::vector<Place> places = places_at(inside);
    if (places.empty() && !exact) {
      if (address != 0 && address < first_exc_return)
        stack.end =
            fmt::format("{:#010x}, where it would return to, is no code of the program", address);
      return stack;
    }
    if (places.empty()) places.push_back({"no code of the program", {}, false});
    for (const Place& place : places) {
      CallFrame frame;
      frame.address = address;
      frame.stack_pointer = context.r[stack_pointer];
      frame.place = place;
      stack.frames.push_back(frame);
    }
    const Registers before = context.r;
    const Unwound result = unwind(inside & ~1u, context.r, read, stack.frames.back().guessed);
    if (result == Unwound::outermost) return stack;
    if (result == Unwound::not_described) {
      stack.end = fmt::format("the stack at {:#010x} cannot be read", before[stack_pointer]);
      if (exact && is_code(before[link] - 1))
        stack.end += "; LR is of " + describe(before[link], true);
      return stack;
    }
    // The outermost function: no return address was saved, so LR has that of its last call.
    const bool same_frame = context.r[stack_pointer] == before[stack_pointer];
    if (!exact && same_frame && context.r[program_counter] == before[program_counter]) return stack;
    if (context.r[stack_pointer] < before[stack_pointer]) {
      stack.end = "the stack pointer would go down; the stack is damaged, or its frames guessed";
      return stack;
    }
    exact = false;
  }
  stack.end = "more frames follow";
  return stack;
}

std::vector<std::string> Program::damage() const {
  std::vector<std::string> sentences;
  for (const auto& information : debug_information())
    for (std::string& sentence : information->complaints())
      sentences.push_back(std::move(sentence));
  return sentences;
}

std::vector<std::string> Program::gaps() const {
  std::vector<std::string> sentences = damage();
  if (!sentences.empty()) return sentences;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const loader::ElfImage& image = *images_[i];
    const DebugInformation& information = *debug_information()[i];
    if (information.has_lines() && information.has_frames()) continue;
    if (image.symbols.empty() && image.segments.empty()) continue;
    const char* missing = information.has_lines()
                              ? "call frames (.debug_frame): callers are guessed from code"
                              : "lines of source (compile with -g): names are of symbols";
    if (image.symbols.empty())
      missing = "symbols and no debug information: addresses have no names";
    sentences.push_back(fmt::format("{}: has no {}", image.path, missing));
  }
  return sentences;
}

}  // namespace capsoc::source
