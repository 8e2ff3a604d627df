// Random traffic of several masters: matrix, bridge and memory keep the TLM-2.0 base protocol.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>

#include "base/random.h"
#include "bench.h"

namespace capsoc::test {
namespace {

/// What an initiator may ask for: any address, in or across windows and in holes, any length,
/// command, streaming width and byte enables, with time ahead or without.
class Traffic : public testing::Test {
 protected:
  Traffic() { b_.forget(); }

  template <typename T, std::size_t n>
  T one_of(const std::array<T, n>& all) {
    return all[random_.below(n)];
  }

  uint64_t address() {
    static constexpr std::array<uint64_t, 9> places{at::ram,       at::ram_alias, at::slow_ram,
                                                    at::small_ram, at::probe,     at::sluggish,
                                                    at::apb_hole,  at::absent,    at::nothing};
    const uint64_t offset = random_.chance(0.1) ? 0xff0 + random_.below(32) : random_.below(0x400);
    return one_of(places) + (random_.chance(0.7) ? offset & ~uint64_t{3} : offset);
  }

  void describe(tlm::tlm_generic_payload& payload) {
    static constexpr std::array<tlm::tlm_command, 5> commands{
        tlm::TLM_READ_COMMAND, tlm::TLM_READ_COMMAND, tlm::TLM_WRITE_COMMAND,
        tlm::TLM_WRITE_COMMAND, tlm::TLM_IGNORE_COMMAND};
    static constexpr std::array<unsigned, 8> lengths{1, 2, 4, 4, 4, 8, 16, 3};
    Initiator::describe(payload, one_of(commands), address(), bytes_.data(), one_of(lengths));
    for (unsigned char& byte : bytes_) byte = static_cast<unsigned char>(random_.word());
    if (random_.chance(0.1))
      payload.set_streaming_width(1 + static_cast<unsigned>(random_.below(16)));
    if (random_.chance(0.3)) {
      for (unsigned char& enable : enables_) enable = random_.chance(0.5) ? TLM_BYTE_ENABLED : 0;
      payload.set_byte_enable_ptr(enables_.data());
      payload.set_byte_enable_length(1 + static_cast<unsigned>(random_.below(16)));
    }
  }

  void step(Initiator& initiator) {
    tlm::tlm_generic_payload payload;
    describe(payload);
    static constexpr std::array<tlm::tlm_response_status, 4> responses{
        tlm::TLM_OK_RESPONSE, tlm::TLM_OK_RESPONSE, tlm::TLM_ADDRESS_ERROR_RESPONSE,
        tlm::TLM_COMMAND_ERROR_RESPONSE};
    b_.probe.response = one_of(responses);
    switch (random_.below(6)) {
      case 0: {
        initiator.socket->transport_dbg(payload);
        break;
      }
      case 1: {
        tlm::tlm_dmi dmi;
        if (payload.get_command() != tlm::TLM_IGNORE_COMMAND)
          initiator.socket->get_direct_mem_ptr(payload, dmi);
        break;
      }
      default: {
        sc_core::sc_time delay = b_.cycles(random_.below(4));
        initiator.socket->b_transport(payload, delay);
        ++answers_[payload.get_response_status()];
      }
    }
  }

  Bench& b_ = bench();
  Random random_{38};
  std::array<unsigned char, 32> bytes_{};
  std::array<unsigned char, 16> enables_{};
  std::map<tlm::tlm_response_status, unsigned> answers_;
};

TEST_F(Traffic, OfAllMastersKeepsTheBaseProtocol) {
  const std::array<Initiator*, 4> masters{&b_.fetch, &b_.load, &b_.system, &b_.dma};
  const uint64_t before = b_.watch.calls();
  for (int i = 0; i < 20000; ++i) step(*one_of(masters));
  EXPECT_EQ(b_.faults, "");
  EXPECT_EQ(b_.initiators_faults, "");
  EXPECT_GT(b_.watch.calls() - before, 35000u) << "each of most is seen by two monitors or more";
  for (const auto status : {tlm::TLM_OK_RESPONSE, tlm::TLM_ADDRESS_ERROR_RESPONSE,
                            tlm::TLM_GENERIC_ERROR_RESPONSE, tlm::TLM_BURST_ERROR_RESPONSE})
    EXPECT_GT(answers_[status], 100u) << status;
}

TEST_F(Traffic, KeepsTheBaseProtocolWhileItIsShown) {
  unsigned shown = 0;
  const kit::Listening listening =
      b_.matrix.transfers.listen([&](const tlm::tlm_generic_payload&, const sc_core::sc_time&,
                                     const sc_core::sc_time&) { ++shown; });
  for (int i = 0; i < 5000; ++i) step(b_.system);
  EXPECT_EQ(b_.faults, "");
  EXPECT_GT(shown, 3000u);
}

TEST_F(Traffic, OfAListenerHasTheAddressOnTheBus) {
  uint64_t seen = 0;
  const kit::Listening listening = b_.matrix.transfers.listen(
      [&](const tlm::tlm_generic_payload& payload, const sc_core::sc_time&,
          const sc_core::sc_time&) { seen = payload.get_address(); });
  b_.system.read(at::ram_alias + 4);
  EXPECT_EQ(seen, at::ram_alias + 4);
  b_.dma.write(at::sluggish + 8, 1);
  EXPECT_EQ(seen, at::sluggish + 8);
}

TEST_F(Traffic, OfASecondPortReachesTheSameMemory) {
  b_.video.write(0x20, 0xcafe);
  EXPECT_EQ(b_.system.read(at::ram + 0x20).value, 0xcafeu);
  b_.system.write(at::ram + 0x24, 0xbeef);
  EXPECT_EQ(b_.video.read(0x24).value, 0xbeefu);
  EXPECT_EQ(b_.video.debug_read(0x24), 0xbeefu);
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(b_.video.direct_memory(0x20, dmi));
  EXPECT_EQ(dmi.get_dmi_ptr(), b_.ram.data());
}

}  // namespace
}  // namespace capsoc::test
