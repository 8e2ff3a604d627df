// The functions of capsoc_reference.h, on coprocessor::Coprocessor. No exception leaves them.
#include "capsoc_reference.h"

#include <new>
#include <optional>
#include <string>

#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"
#include "coprocessor/signal_flow.h"

namespace cop = capsoc::coprocessor;

// What an interval has on its pins is kept until its edge: the model takes events in the order of
// time, and the outputs of this interval come before those that act at its end.
struct capsoc_reference {
  struct Sample {
    int32_t u, v;
    bool clip;
  };
  struct Write {
    uint32_t address, data;
    uint8_t strobes;
  };

  explicit capsoc_reference(const cop::Options& options) : model(options) {}

  cop::Coprocessor model;
  uint64_t edge = 0;
  std::optional<Sample> sample;
  std::optional<Write> write;
  bool accessed = false;
  mutable std::string error;
};

namespace {

constexpr uint32_t last_address = 0xFFF;
constexpr uint64_t last_edge = uint64_t{1} << 62;

thread_local std::string error_without_reference;  // NOLINT

int32_t fail(const capsoc_reference* reference, int32_t code, const std::string& sentence) {
  (reference != nullptr ? reference->error : error_without_reference) = sentence;
  return code;
}

int32_t refuse(const capsoc_reference* reference, const char* function, const std::string& why) {
  return fail(reference, CAPSOC_REFERENCE_ARGUMENT,
              std::string("capsoc_reference_") + function + ": " + why);
}

// Whether a number is in its range; the sentence is written if it is not.
bool in_range(const capsoc_reference* reference, const char* function, const char* name,
              int64_t value, int64_t first, int64_t last) {
  if (value >= first && value <= last) return true;
  refuse(reference, function,
         std::string(name) + " is " + std::to_string(value) + "; it must be " +
             std::to_string(first) + " to " + std::to_string(last));
  return false;
}

constexpr const char* null_pointer = "a pointer is null";

// The bus carries one access an interval.
int32_t begin_access(capsoc_reference* reference, const char* function, uint32_t address) {
  if (!in_range(reference, function, "address", address, 0, last_address))
    return CAPSOC_REFERENCE_ARGUMENT;
  if (reference->accessed)
    return fail(reference, CAPSOC_REFERENCE_ORDER,
                std::string("capsoc_reference_") + function + ": the interval after edge " +
                    std::to_string(reference->edge) +
                    " has an access already; make an edge between two of them");
  reference->accessed = true;
  return CAPSOC_REFERENCE_OK;
}

// Whether the coming edge would take a sample.
bool takes_sample(const capsoc_reference& reference) {
  cop::Coprocessor trial = reference.model;
  return trial.submit(reference.edge + 1, 0, 0, false);
}

const cop::NamedNode* signal_at(int32_t index) {
  if (index < 0 || static_cast<std::size_t>(index) >= cop::node_count) return nullptr;
  return &cop::node_names()[static_cast<std::size_t>(index)];
}

}  // namespace

extern "C" {

int32_t capsoc_reference_version(void) {
  return CAPSOC_REFERENCE_VERSION;
}

capsoc_reference* capsoc_reference_create(int32_t paper, int32_t operand_bits,
                                          int32_t reference_lead, int32_t step_shift,
                                          int32_t plain_arctangent, int32_t iteration_clocks,
                                          int32_t block, int32_t harmonics, int32_t safety) {
  const auto allowed = [](const char* name, int64_t value, int64_t first, int64_t last) {
    return in_range(nullptr, "create", name, value, first, last);
  };
  if (!allowed("paper", paper, 0, 1) || !allowed("operand_bits", operand_bits, 2, 32) ||
      !allowed("reference_lead", reference_lead, -1024, 1024) ||
      !allowed("step_shift", step_shift, 0, 31) ||
      !allowed("plain_arctangent", plain_arctangent, 0, 1) ||
      !allowed("iteration_clocks", iteration_clocks, 1, 2) || !allowed("block", block, 0, 1) ||
      !allowed("harmonics", harmonics, 0, 1) || !allowed("safety", safety, 0, 1))
    return nullptr;
  cop::Options options;
  options.arithmetic = paper != 0 ? cop::Arithmetic::paper : cop::Arithmetic::precise;
  options.paper_operand_bits = operand_bits;
  options.paper_reference_lead = reference_lead;
  options.paper_step_shift = step_shift;
  options.paper_plain_arctangent = plain_arctangent != 0;
  options.paper_iteration_clocks = iteration_clocks;
  options.block_learning = block != 0;
  options.harmonic_correction = harmonics != 0;
  options.safety = safety != 0;
  auto* reference = new (std::nothrow) capsoc_reference(options);
  if (reference == nullptr) refuse(nullptr, "create", "there is no memory left");
  return reference;
}

void capsoc_reference_destroy(capsoc_reference* reference) {
  delete reference;
}

int32_t capsoc_reference_reset(capsoc_reference* reference) {
  if (reference == nullptr) return refuse(nullptr, "reset", null_pointer);
  reference->model.reset();
  reference->sample.reset();
  reference->write.reset();
  reference->accessed = false;
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_write(capsoc_reference* reference, uint32_t address, uint32_t data,
                               uint32_t strobes, uint32_t* error) {
  if (reference == nullptr || error == nullptr) return refuse(reference, "write", null_pointer);
  if (!in_range(reference, "write", "strobes", strobes, 0, cop::all_strobes))
    return CAPSOC_REFERENCE_ARGUMENT;
  if (const int32_t code = begin_access(reference, "write", address)) return code;
  reference->write = {address, data, static_cast<uint8_t>(strobes)};
  *error = strobes == cop::all_strobes && cop::is_register(address) ? 0 : 1;
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_read(capsoc_reference* reference, uint32_t address, uint32_t* data,
                              uint32_t* error) {
  if (reference == nullptr || data == nullptr || error == nullptr)
    return refuse(reference, "read", null_pointer);
  if (const int32_t code = begin_access(reference, "read", address)) return code;
  const cop::RegisterAccess access = reference->model.read(reference->edge, address, false);
  *data = access.value;
  *error = access.ok ? 0 : 1;
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_peek(const capsoc_reference* reference, uint32_t address, uint32_t* data) {
  if (reference == nullptr || data == nullptr) return refuse(reference, "peek", null_pointer);
  if (!in_range(reference, "peek", "address", address, 0, last_address))
    return CAPSOC_REFERENCE_ARGUMENT;
  // A read for debugging changes nothing, and the model is at this edge already.
  auto& model = const_cast<cop::Coprocessor&>(reference->model);  // NOLINT
  *data = model.read(reference->edge, address, true).value;
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_sample(capsoc_reference* reference, int32_t u, int32_t v, int32_t clip,
                                uint32_t* ready) {
  if (reference == nullptr || ready == nullptr) return refuse(reference, "sample", null_pointer);
  if (!in_range(reference, "sample", "clip", clip, 0, 1)) return CAPSOC_REFERENCE_ARGUMENT;
  if (reference->sample)
    return fail(reference, CAPSOC_REFERENCE_ORDER,
                "capsoc_reference_sample: the interval after edge " +
                    std::to_string(reference->edge) +
                    " has a sample already; make an edge between two of them");
  reference->sample = {u, v, clip != 0};
  *ready = takes_sample(*reference) ? 1 : 0;
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_clock(capsoc_reference* reference, uint32_t edges) {
  if (reference == nullptr) return refuse(nullptr, "clock", null_pointer);
  if (!in_range(reference, "clock", "edges", edges, 1, UINT32_MAX))
    return CAPSOC_REFERENCE_ARGUMENT;
  if (reference->edge > last_edge - edges)
    return refuse(reference, "clock", "the number of the edge would pass 2^62; create another");
  const uint64_t next = reference->edge + 1;
  if (const auto& sample = reference->sample)
    reference->model.submit(next, sample->u, sample->v, sample->clip);
  if (const auto& write = reference->write)
    reference->model.write_bytes(next, write->address, write->data, write->strobes);
  reference->sample.reset();
  reference->write.reset();
  reference->accessed = false;
  reference->edge += edges;
  reference->model.advance(reference->edge);
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_outputs(const capsoc_reference* reference, uint32_t* sample_ready,
                                 uint32_t* irq, uint32_t* idle) {
  if (reference == nullptr || sample_ready == nullptr || irq == nullptr || idle == nullptr)
    return refuse(reference, "outputs", null_pointer);
  *sample_ready = takes_sample(*reference) ? 1 : 0;
  *irq = reference->model.interrupt() ? 1 : 0;
  *idle = reference->model.idle() ? 1 : 0;
  return CAPSOC_REFERENCE_OK;
}

uint64_t capsoc_reference_edge(const capsoc_reference* reference) {
  return reference == nullptr ? 0 : reference->edge;
}

uint64_t capsoc_reference_commits(const capsoc_reference* reference) {
  return reference == nullptr ? 0 : reference->model.nodes().commits;
}

int32_t capsoc_reference_signal_count(void) {
  return static_cast<int32_t>(cop::node_count);
}

int32_t capsoc_reference_signal_index(const char* name) {
  const auto index = name == nullptr ? std::nullopt : cop::node_index(name);
  return index ? static_cast<int32_t>(*index) : -1;
}

const char* capsoc_reference_signal_name(int32_t index) {
  const cop::NamedNode* signal = signal_at(index);
  return signal == nullptr ? nullptr : signal->name;
}

int32_t capsoc_reference_signal_format(int32_t index, int32_t* bits, int32_t* is_signed,
                                       int32_t* fraction, int32_t* stage) {
  const cop::NamedNode* signal = signal_at(index);
  if (signal == nullptr)
    return refuse(nullptr, "signal_format", "no signal has the index " + std::to_string(index));
  if (bits == nullptr || is_signed == nullptr || fraction == nullptr || stage == nullptr)
    return refuse(nullptr, "signal_format", null_pointer);
  *bits = static_cast<int32_t>(signal->format.width);
  *is_signed = signal->format.is_signed ? 1 : 0;
  *fraction = static_cast<int32_t>(signal->format.fraction);
  *stage = static_cast<int32_t>(signal->stage);
  return CAPSOC_REFERENCE_OK;
}

int32_t capsoc_reference_signal(const capsoc_reference* reference, int32_t index, int64_t* value) {
  if (reference == nullptr || value == nullptr) return refuse(reference, "signal", null_pointer);
  const cop::NamedNode* signal = signal_at(index);
  if (signal == nullptr)
    return refuse(reference, "signal", "no signal has the index " + std::to_string(index));
  *value = reference->model.nodes().*signal->value;
  return CAPSOC_REFERENCE_OK;
}

const char* capsoc_reference_error(const capsoc_reference* reference) {
  return (reference != nullptr ? reference->error : error_without_reference).c_str();
}

}  // extern "C"
