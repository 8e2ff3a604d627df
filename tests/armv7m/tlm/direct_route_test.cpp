// Accesses without transactions, on a bus that describes its way to a device (kit::DirectRoute).
#include "kit/direct_route.h"

#include <gtest/gtest.h>
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <cstring>
#include <string>
#include <vector>

#include "../../elsewhere.h"
#include "armv7m/tlm/core_tlm.h"
#include "kit/clocked_bank.h"

namespace capsoc::armv7m::test {
namespace {

using registers::Access;

/// A register that is written early and read ahead.
class Device : public kit::ClockedBank {
 public:
  Device(const sc_core::sc_module_name& name, kit::ClockDomain& clock) : ClockedBank(name, clock) {
    DATA.on_write([this](uint32_t value) {
      DATA.store(value);
      sum = sum * 31 + value * 7 + now();
    });
    DATA.on_peek([this] { return DATA.get() + static_cast<uint32_t>(now()); });
  }
  kit::Register DATA{*this, {"DATA", 8, Access::read_write, 0, ~0U, 0, ~0U}};
  uint64_t sum = 0;

 private:
  void advance(uint64_t) override {}
  uint64_t next_change() const override { return never; }
  bool takes_early(uint32_t, uint32_t, uint32_t) const override { return true; }
};

/// What a bus says of the way from its socket on.
enum class Says { truth, nothing, other_socket, fewer_cycles };

/// 64 KiB of memory below 0x40000000, the device at all other addresses, three cycles away.
struct Way : sc_core::sc_module {
  tlm_utils::simple_target_socket_tagged<Way> icode{"icode"}, dcode{"dcode"}, system{"system"};
  tlm_utils::simple_initiator_socket<Way> out{"out"};
  std::vector<unsigned char> memory = std::vector<unsigned char>(64 << 10);
  kit::ClockDomain& clock;
  Device& device;
  Says says = Says::truth;
  unsigned transactions = 0;  // with the device

  Way(const sc_core::sc_module_name& name, kit::ClockDomain& clock_domain, Device& at)
      : sc_module(name), clock(clock_domain), device(at) {
    for (auto* socket : {&icode, &dcode, &system})
      socket->register_b_transport(this, &Way::b_transport, 0);
    out.bind(device.socket);
  }

 private:
  void b_transport(int, tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
    const uint64_t address = payload.get_address();
    if (address >= 0x40000000) return pass_on(payload, delay);
    unsigned char* const bytes = memory.data() + address % memory.size();
    if (payload.is_read())
      std::memcpy(payload.get_data_ptr(), bytes, payload.get_data_length());
    else
      std::memcpy(bytes, payload.get_data_ptr(), payload.get_data_length());
  }

  void pass_on(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    ++transactions;
    payload.set_address(payload.get_address() % kit::device_size);
    out->b_transport(payload, delay);
    delay += clock.duration(3, sc_core::sc_time_stamp());
    auto* const route = payload.get_extension<kit::DirectRoute>();
    if (route == nullptr || says == Says::nothing) return;
    auto& here = says == Says::other_socket ? dcode : system;
    route->extend(out.operator->(), here.get_base_export().operator->(),
                  says == Says::fewer_cycles ? 2 : 3);
  }
};

struct Described {
  kit::ClockDomain clock;
  CoreTlm cpu{"cpu", clock};
  Device device{"device", clock};
  Way bus{"bus", clock, device};
  explicit Described(Executor executor) {
    sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
    cpu.icode.bind(bus.icode);
    cpu.dcode.bind(bus.dcode);
    cpu.system.bind(bus.system);
    TranslatorLimits limits;
    limits.warm_up = 0;
    limits.threshold = 3;
    cpu.core().limit_translator(limits);
    cpu.core().set_executor(executor);
    cpu.core().listeners().semihosting = [](Core&) { return false; };
    cpu.core().map_memory(0, 4096, bus.memory.data(), false, 0);
    const uint32_t vectors[] = {0x20001000, 0x41};
    const uint16_t program[] = {
        0x2040, 0x0600,  // movs r0, #0x40; lsls r0, #24
        0x2100,          // movs r1, #0
        0x6081,          // loop: str r1, [r0, #8]
        0x6882,          // ldr r2, [r0, #8]
        0x7A43,          // ldrb r3, [r0, #9]
        0x189B,          // adds r3, r3, r2
        0x7243,          // strb r3, [r0, #9]
        0x3101,          // adds r1, #1
        0x29C8,          // cmp r1, #200
        0xD1F7,          // bne loop
        0xBEAB,          // bkpt 0xAB
    };
    std::memcpy(bus.memory.data(), vectors, sizeof vectors);
    std::memcpy(bus.memory.data() + 0x40, program, sizeof program);
  }
};

struct Counted {
  uint64_t cycles = 0, instructions = 0, sum = 0;
  unsigned transactions = 0;
};

/// Of the program, all 0 if it does not end. Forgets its routes after N cycles, if N is not 0.
Counted accessing(Says says, Executor executor, uint64_t forgets_after = 0) {
  const std::string said = capsoc::test::elsewhere([&] {
    Described system(executor);
    system.bus.says = says;
    if (forgets_after != 0)
      sc_core::sc_spawn([&] {
        sc_core::wait(system.clock.time_of(forgets_after));
        system.bus.system->invalidate_direct_mem_ptr(0x40000000, 0x40000FFF);
      });
    sc_core::sc_start(sc_core::sc_time(10, sc_core::SC_MS));
    const Counted run{system.cpu.core().cycles(), system.cpu.core().instructions(),
                      system.device.sum, system.bus.transactions};
    const bool ended = system.cpu.end_reason() == EndReason::exit;
    return std::string(reinterpret_cast<const char*>(&run), ended ? sizeof run : 0);
  });
  Counted run{};
  if (said.size() == sizeof run) std::memcpy(&run, said.data(), sizeof run);
  return run;
}

TEST(DirectRoute, ReplacesTransactionsWithTheSameTimes) {
  const Counted all = accessing(Says::nothing, Executor::stepping);
  EXPECT_EQ(all.transactions, 800u);
  for (const Executor executor : {Executor::stepping, Executor::blocks, Executor::translator}) {
    const Counted direct = accessing(Says::truth, executor);
    EXPECT_EQ(direct.cycles, all.cycles);
    EXPECT_EQ(direct.instructions, all.instructions);
    EXPECT_EQ(direct.sum, all.sum);
    EXPECT_EQ(direct.transactions, 4u) << "one of each kind";
  }
}

TEST(DirectRoute, IsNotTakenIfItsDescriptionIsWrong) {
  EXPECT_EQ(accessing(Says::other_socket, Executor::translator).transactions, 800u);
  EXPECT_EQ(accessing(Says::fewer_cycles, Executor::translator).transactions, 800u);
}

TEST(DirectRoute, IsForgottenWhenTheBusRevokesIt) {
  const Counted once = accessing(Says::truth, Executor::translator);
  const Counted twice = accessing(Says::truth, Executor::translator, 2000);
  EXPECT_EQ(twice.transactions, 8u);
  EXPECT_EQ(twice.cycles, once.cycles);
  EXPECT_EQ(twice.sum, once.sum);
}

}  // namespace
}  // namespace capsoc::armv7m::test
