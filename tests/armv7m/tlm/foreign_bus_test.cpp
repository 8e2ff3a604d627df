// The processor on a user's bus, not on that of models/bus.
#include <gtest/gtest.h>
#include <tlm_utils/simple_target_socket.h>

#include <array>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "../../elsewhere.h"
#include "armv7m/tlm/core_tlm.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint64_t kib = 1024;

enum class Grants { nothing, reads, everything, without_end };

/// 64 KiB of memory at the bottom of each port.
struct Target : sc_core::sc_module {
  tlm_utils::simple_target_socket_tagged<Target> icode{"icode"}, dcode{"dcode"}, system{"system"};
  std::vector<unsigned char> flash = std::vector<unsigned char>(64 * kib);
  std::vector<unsigned char> ram = std::vector<unsigned char>(64 * kib);
  Grants flash_grants = Grants::everything, ram_grants = Grants::everything;
  unsigned transfers = 0, requests = 0;

  explicit Target(const sc_core::sc_module_name& name) : sc_module(name) {
    for (auto* socket : {&icode, &dcode, &system}) {
      socket->register_b_transport(this, &Target::b_transport, 0);
      socket->register_get_direct_mem_ptr(this, &Target::get_direct_mem_ptr, 0);
    }
  }

 private:
  static bool is_ram(uint64_t address) { return address >= 0x20000000; }

  void b_transport(int, tlm::tlm_generic_payload& payload, sc_core::sc_time&) {
    ++transfers;
    const uint64_t address = payload.get_address();
    unsigned char* bytes = (is_ram(address) ? ram : flash).data() + address % (64 * kib);
    if (payload.is_read())
      std::memcpy(payload.get_data_ptr(), bytes, payload.get_data_length());
    else
      std::memcpy(bytes, payload.get_data_ptr(), payload.get_data_length());
    payload.set_dmi_allowed(true);  // a promise that is not always kept
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  }

  bool get_direct_mem_ptr(int, tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) {
    ++requests;
    const bool to_ram = is_ram(payload.get_address());
    const Grants grants = to_ram ? ram_grants : flash_grants;
    if (grants == Grants::nothing || (grants == Grants::reads && payload.is_write())) return false;
    if (grants == Grants::reads)
      dmi.allow_read();
    else
      dmi.allow_read_write();
    dmi.set_dmi_ptr((to_ram ? ram : flash).data());
    dmi.set_start_address(to_ram ? 0x20000000 : 0);
    dmi.set_end_address(grants == Grants::without_end ? ~uint64_t{0}
                                                      : dmi.get_start_address() + 64 * kib - 1);
    return true;
  }
};

struct System {
  kit::ClockDomain clock;
  CoreTlm cpu{"cpu", clock};
  Target target{"target"};
  unsigned unpredictable = 0;

  System() {
    sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
    cpu.icode.bind(target.icode);
    cpu.dcode.bind(target.dcode);
    cpu.system.bind(target.system);
    cpu.core().listeners().semihosting = [](Core&) { return false; };
    cpu.core().listeners().unpredictable = [this](Unpredictable, uint32_t) { ++unpredictable; };
  }
  template <typename T>
  void put(uint32_t address, const std::vector<T>& values) {
    std::memcpy(target.flash.data() + address, values.data(), sizeof(T) * values.size());
  }
};

/// Copies bytes from flash through RAM, at last from no aligned address.
void put_copying(System& system) {
  system.put<uint32_t>(0, {0x20001000, 0x41});
  system.put<uint16_t>(0x40, {
                                 0x2020, 0x0600,  // movs r0, #0x20; lsls r0, #24
                                 0x2100,          // movs r1, #0
                                 0x22C8,          // movs r2, #200
                                 0x780B,          // loop: ldrb r3, [r1]
                                 0x6043,          // str r3, [r0, #4]
                                 0x6844,          // ldr r4, [r0, #4]
                                 0x3101,          // adds r1, #1
                                 0x4291,          // cmp r1, r2
                                 0xD1F9,          // bne loop
                                 0xF8D0, 0x3001,  // ldr r3, [r0, #1]
                                 0xBEAB,          // bkpt 0xAB
                             });
}

struct Figures {
  uint64_t cycles, instructions;
  unsigned transfers, requests, unpredictable;
};

/// Of the program that copies; all 0 if it does not end.
Figures copying(Grants flash, Grants ram) {
  const std::string said = capsoc::test::elsewhere([&] {
    System system;
    system.target.flash_grants = flash;
    system.target.ram_grants = ram;
    put_copying(system);
    sc_core::sc_start(sc_core::sc_time(10, sc_core::SC_MS));
    const Figures run{system.cpu.core().cycles(), system.cpu.core().instructions(),
                      system.target.transfers, system.target.requests, system.unpredictable};
    const bool ended = system.cpu.end_reason() == EndReason::exit;
    return std::string(reinterpret_cast<const char*>(&run), ended ? sizeof run : 0);
  });
  Figures run{};
  if (said.size() == sizeof run) std::memcpy(&run, said.data(), sizeof run);
  return run;
}

TEST(ForeignBus, AFlashThatGrantsReadsIsMapped) {
  const Figures all = copying(Grants::everything, Grants::everything);
  ASSERT_EQ(all.instructions, 1206u);
  const Figures flash = copying(Grants::reads, Grants::everything);
  EXPECT_EQ(flash.cycles, all.cycles);
  EXPECT_EQ(flash.transfers, all.transfers);
  EXPECT_LT(flash.requests, 10u);
}

TEST(ForeignBus, AMemoryThatRefusesIsNotAskedAtEveryAccess) {
  const Figures none = copying(Grants::nothing, Grants::nothing);
  EXPECT_EQ(none.instructions, 1206u);
  EXPECT_GT(none.transfers, 1500u);
  EXPECT_LT(none.requests, 10u);
}

TEST(ForeignBus, RamThatReadsOnlyIsWrittenOverTheBus) {
  const Figures run = copying(Grants::everything, Grants::reads);
  EXPECT_EQ(run.instructions, 1206u);
  EXPECT_GE(run.transfers, 200u);
  EXPECT_LT(run.requests, 10u);
}

/// Of the first access to a memory that is granted it is not known yet.
TEST(ForeignBus, RamWithoutDirectMemoryIsNormalMemoryAllTheSame) {
  const Figures direct = copying(Grants::everything, Grants::everything);
  const Figures bus = copying(Grants::everything, Grants::nothing);
  EXPECT_EQ(direct.unpredictable, 0u);
  EXPECT_EQ(bus.unpredictable, 0u);
  EXPECT_NEAR(double(bus.cycles), double(direct.cycles), 1);
}

TEST(ForeignBus, AGrantWithoutEndEndsWhereThePortDoes) {
  const Figures all = copying(Grants::everything, Grants::everything);
  const Figures endless = copying(Grants::without_end, Grants::without_end);
  EXPECT_EQ(endless.cycles, all.cycles);
  EXPECT_EQ(endless.transfers, all.transfers);
}

/// Enables interrupt 0 and sleeps; the handler ends the program.
void put_sleeping(System& system) {
  std::vector<uint32_t> vectors(17);
  vectors[0] = 0x20001000;
  vectors[1] = 0x45;
  vectors[16] = 0x55;
  system.put(0, vectors);
  system.put<uint16_t>(0x44, {
                                 0x4802,          // ldr r0, =0xE000E100
                                 0x2101, 0x6001,  // movs r1, #1; str r1, [r0]
                                 0xBF30, 0xE7FD,  // wfi; b .-2
                                 0xBF00,          // nop
                                 0xE100, 0xE000,  // the literal
                                 0xBEAB,          // handler: bkpt 0xAB
                             });
}

/// An interrupt of the host's, from its own thread.
class HostChannel : public sc_core::sc_prim_channel {
 public:
  explicit HostChannel(CoreTlm& cpu) : sc_prim_channel("host"), cpu_(cpu) {
    async_attach_suspending();
    sc_core::sc_spawn_options options;
    options.spawn_method();
    options.dont_initialize();
    options.set_sensitivity(&called_);
    sc_core::sc_spawn([this] { cpu_.set_interrupt(0, true); }, "interrupt", &options);
  }
  void call() { async_request_update(); }

 private:
  void update() override {
    called_.notify(sc_core::SC_ZERO_TIME);
    async_detach_suspending();
  }
  CoreTlm& cpu_;
  sc_core::sc_event called_;
};

TEST(ForeignBus, AHostThatIsWaitedForWakesASleep) {
  EXPECT_EQ(capsoc::test::elsewhere([] {
              System system;
              put_sleeping(system);
              HostChannel host(system.cpu);
              std::thread thread([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                host.call();
              });
              sc_core::sc_start();
              thread.join();
              return system.cpu.end_reason() == EndReason::exit ? "woken" : "asleep";
            }),
            "woken");
}

TEST(ForeignBus, ASleepWithoutEndReturnsFromTheKernelAndMayBeEnded) {
  EXPECT_EQ(capsoc::test::elsewhere([]() -> std::string {
              System system;
              put_sleeping(system);
              sc_core::sc_start();
              if (system.cpu.end_reason() != EndReason::asleep) return "not asleep";
              if (sc_core::sc_get_status() != sc_core::SC_PAUSED) return "stopped";
              system.cpu.set_interrupt(0, true);
              sc_core::sc_start();
              return system.cpu.end_reason() == EndReason::exit ? "woken" : "not woken";
            }),
            "woken");
}

}  // namespace
}  // namespace capsoc::armv7m::test
