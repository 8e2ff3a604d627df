#include "inject/system_fields.h"

#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <utility>

#include "base/archive.h"

namespace capsoc::inject {
namespace {

namespace exception = armv7m::exception;
namespace ppb = armv7m::ppb;

/// Finds one value of an archive; with a change, loads that one and leaves the others as they are.
class OneValue final : public Archive {
 public:
  OneValue(const std::string& wanted, std::function<uint64_t(uint64_t)> change)
      : wanted_(wanted), change_(std::move(change)) {}
  bool loading() const override { return static_cast<bool>(change_); }
  uint64_t value() const { return value_; }

 private:
  void raw(void* bytes, std::size_t size) override {
    if (size > sizeof value_ || path() != wanted_) return;
    std::memcpy(&value_, bytes, size);
    if (!change_) return;
    value_ = change_(value_);
    std::memcpy(bytes, &value_, size);
  }

  const std::string& wanted_;
  std::function<uint64_t(uint64_t)> change_;
  uint64_t value_ = 0;
};

constexpr const char* systick = "systick";

uint64_t mask_of(const SystemField& field) {
  return ((uint64_t{1} << field.bits) - 1) << field.low;
}

struct SystemException {
  unsigned number;
  const char* name;
  uint32_t reg;  ///< a register that is there if the core has the exception
};
constexpr SystemException system_exceptions[] = {
    {exception::nmi, "nmi", ppb::ICSR},
    {exception::hard_fault, "hardfault", ppb::ICSR},
    {exception::mem_manage, "memmanage", ppb::CFSR},
    {exception::bus_fault, "busfault", ppb::CFSR},
    {exception::usage_fault, "usagefault", ppb::CFSR},
    {exception::svcall, "svcall", ppb::ICSR},
    {exception::debug_monitor, "debugmonitor", ppb::DEMCR},
    {exception::pendsv, "pendsv", ppb::ICSR},
    {exception::systick, "systick", ppb::SYST_CSR},
};

/// Bits of a register, at their places in it. A core has those that programs can write there.
struct WritableField {
  const char *name, *path;
  uint32_t reg;
  unsigned low, bits;
};
constexpr WritableField writable_fields[] = {
    {"systick.enable", "systick.csr", ppb::SYST_CSR, 0, 1},
    {"systick.tickint", "systick.csr", ppb::SYST_CSR, 1, 1},
    {"systick.clksource", "systick.csr", ppb::SYST_CSR, 2, 1},
    {"systick.reload", "systick.rvr", ppb::SYST_RVR, 0, 24},
    {"scb.actlr", "scb.actlr", ppb::ACTLR, 0, 3},
    {"scb.sleeponexit", "scb.scr", ppb::SCR, 1, 1},
    {"scb.sleepdeep", "scb.scr", ppb::SCR, 2, 1},
    {"scb.sevonpend", "scb.scr", ppb::SCR, 4, 1},
    {"mpu.ctrl", "mpu.ctrl", ppb::MPU_CTRL, 0, 3},
    {"mpu.rnr", "mpu.rnr", ppb::MPU_RNR, 0, 3},
    {"scb.nonbasethrdena", "scb.ccr", ppb::CCR, 0, 1},
    {"scb.usersetmpend", "scb.ccr", ppb::CCR, 1, 1},
    {"scb.unalign_trp", "scb.ccr", ppb::CCR, 3, 1},
    {"scb.div_0_trp", "scb.ccr", ppb::CCR, 4, 1},
    {"scb.bfhfnmign", "scb.ccr", ppb::CCR, 8, 1},
    {"scb.stkalign", "scb.ccr", ppb::CCR, 9, 1},
    {"scb.memfaultena", "scb.shcsr", ppb::SHCSR, 16, 1},
    {"scb.busfaultena", "scb.shcsr", ppb::SHCSR, 17, 1},
    {"scb.usgfaultena", "scb.shcsr", ppb::SHCSR, 18, 1},
    {"fpu.cp10", "fpu.cpacr", ppb::CPACR, 20, 2},
    {"fpu.lspact", "fpu.fpccr", ppb::FPCCR, 0, 1},
    {"fpu.lspen", "fpu.fpccr", ppb::FPCCR, 30, 1},
    {"fpu.aspen", "fpu.fpccr", ppb::FPCCR, 31, 1},
    {"fpu.fpcar", "fpu.fpcar", ppb::FPCAR, 3, 29},
};
/// Of each region. Bits of RBAR below 5 do not exist.
struct RegionField {
  const char *name, *path;
  unsigned low, bits;
};
constexpr RegionField region_fields[] = {
    {"rbar", "rbar", 5, 27}, {"enable", "rasr", 0, 1},     {"size", "rasr", 1, 5},
    {"srd", "rasr", 8, 8},   {"tex_s_c_b", "rasr", 16, 6}, {"ap", "rasr", 24, 3},
    {"xn", "rasr", 28, 1},
};

class Fields {
 public:
  explicit Fields(const armv7m::Core& core) : registers_(*core.profile().registers) {}

  void add(const std::string& name, const std::string& path, unsigned low, unsigned bits) {
    list_.push_back({name, name.substr(0, name.find('.')), path, low, bits});
  }
  void add(const WritableField& one) {
    const uint32_t mask = ((1U << one.bits) - 1) << one.low;
    if (registers_.has(one.reg) &&
        (registers_.at(one.reg).description.writable_mask & mask) == mask)
      add(one.name, one.path, one.low, one.bits);
  }
  std::vector<SystemField> take() { return std::move(list_); }

 private:
  const armv7m::SystemRegisters& registers_;
  std::vector<SystemField> list_;
};

}  // namespace

std::vector<SystemField> system_fields(const armv7m::Core& core) {
  const armv7m::SystemRegisters& registers = *core.profile().registers;
  Fields fields(core);
  for (const char* state : {"enabled", "pending", "active"})
    fields.add(fmt::format("nvic.{}", state), fmt::format("nvic.{}", state),
               exception::first_interrupt, exception::interrupts);
  const auto width = static_cast<unsigned>(__builtin_popcount(core.state().nvic.priority_mask()));
  for (unsigned line = 0; line < exception::interrupts; ++line)
    fields.add(fmt::format("nvic.priority.{}", line),
               fmt::format("nvic.priority.{}", exception::first_interrupt + line), 8 - width,
               width);
  for (const SystemException& each : system_exceptions) {
    if (!registers.has(each.reg)) continue;
    for (const char* state : {"pending", "active"})
      fields.add(fmt::format("scb.{}.{}", state, each.name), fmt::format("nvic.{}", state),
                 each.number, 1);
    if (each.number > exception::hard_fault)
      fields.add(fmt::format("scb.priority.{}", each.name),
                 fmt::format("nvic.priority.{}", each.number), 8 - width, width);
  }
  const uint32_t vtor = registers.at(ppb::VTOR).description.writable_mask;
  fields.add("scb.vtor", "scb.vtor", static_cast<unsigned>(__builtin_ctz(vtor)),
             static_cast<unsigned>(__builtin_popcount(vtor)));
  if ((registers.at(ppb::AIRCR).description.writable_mask & 0x700) != 0)
    fields.add("scb.prigroup", "scb.prigroup", 0, 3);
  for (const WritableField& each : writable_fields) fields.add(each);
  if (registers.has(ppb::MPU_RBAR))
    for (unsigned region = 0; region < armv7m::Mpu::regions; ++region)
      for (const RegionField& each : region_fields)
        fields.add(fmt::format("mpu.{}.{}", region, each.name),
                   fmt::format("mpu.{}.{}", each.path, region), each.low, each.bits);
  return fields.take();
}

uint32_t read_field(armv7m::Core& core, const SystemField& field) {
  OneValue reader(field.path, nullptr);
  core.visit(reader);
  return static_cast<uint32_t>((reader.value() & mask_of(field)) >> field.low);
}

void write_field(armv7m::Core& core, const SystemField& field, uint32_t value) {
  const uint64_t mask = mask_of(field);
  if (field.unit == systick) {
    // The counter continues from where it is, as after a program's write.
    const uint32_t address = field.path == "systick.csr" ? ppb::SYST_CSR : ppb::SYST_RVR;
    OneValue reader(field.path, nullptr);
    core.visit(reader);
    const auto word =
        static_cast<uint32_t>((reader.value() & ~mask) | (uint64_t{value} << field.low & mask));
    core.edit().systick.write(core.profile().registers->at(address), {word, ~uint32_t{0}},
                              core.cycles());
    return;
  }
  OneValue writer(field.path, [&](uint64_t before) {
    return (before & ~mask) | (uint64_t{value} << field.low & mask);
  });
  core.edit();
  core.visit(writer);
}

}  // namespace capsoc::inject
