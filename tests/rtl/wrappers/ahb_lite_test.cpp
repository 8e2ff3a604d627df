// The AHB-Lite top as a manager and another subordinate of its bus see it, against the model.
#include <gtest/gtest.h>
#include <verilated.h>

#include "Vwrappers_bench.h"
#include "follower.h"

namespace capsoc::rtl_wrappers_test {
namespace {

// HTRANS; 1 is BUSY.
constexpr uint8_t trans_idle = 0, trans_nonseq = 2, trans_seq = 3;

class AhbLite : public ::testing::Test {
 protected:
  struct AddressPhase {
    bool selected = false, write = false;
    uint8_t trans = trans_idle, size = 2;
    uint32_t address = 0;
  };

  AhbLite() {
    top.clk_i = 0;
    top.rst_ni = 1;
    top.eval();
    top.rst_ni = 0;
    top.hready_i = 1;
    top.eval();
    EXPECT_TRUE(top.hreadyout_o);
    top.rst_ni = 1;
    top.eval();
  }
  ~AhbLite() override { top.final(); }

  bool active() const { return data_phase.selected && data_phase.trans >= trans_nonseq; }

  bool proper() const { return data_phase.address % (1u << data_phase.size) == 0; }

  // The lanes of the data phase, from the size and address alone.
  uint8_t lanes() const {
    uint8_t found = 0;
    for (unsigned lane = 0; lane < 4; ++lane)
      if (lane >= data_phase.address % 4 && lane < data_phase.address % 4 + (1u << data_phase.size))
        found = static_cast<uint8_t>(found | 1u << lane);
    return found;
  }

  // Checks the bus in this interval; the access that ends in it.
  std::optional<Access> observe(uint32_t data) {
    if (!active()) {
      EXPECT_TRUE(top.hreadyout_o) << "edge " << edge;
      EXPECT_FALSE(top.hresp_o) << "edge " << edge;
      return {};
    }
    if (failing) {
      EXPECT_TRUE(top.hreadyout_o && top.hresp_o) << "edge " << edge;
      return {};
    }
    if (data_phase.size > 2 || !proper()) {
      EXPECT_TRUE(!top.hreadyout_o && top.hresp_o) << "edge " << edge;
      ++refused;
      return {};
    }
    if (waits++ == 0) {
      EXPECT_TRUE(!top.hreadyout_o && !top.hresp_o) << "edge " << edge;
      return {};
    }
    EXPECT_NE(top.hreadyout_o, top.hresp_o) << "edge " << edge;
    Access access;
    access.write = data_phase.write;
    access.address = data_phase.address & ~3u;
    access.data = access.write ? data : top.hrdata_o;
    access.strobes = lanes();
    access.error = top.hresp_o;
    ++(access.error ? errors : access.write ? writes : reads);
    return access;
  }

  // One interval and the edge that ends it. `offered`: the address phase; `other_waits`: so does
  // the subordinate whose data phase it is, if it is not this one.
  void interval(const AddressPhase& offered, uint32_t data, bool other_waits, SamplePins sample) {
    top.hsel_i = offered.selected;
    top.hwrite_i = offered.write;
    top.htrans_i = offered.trans;
    top.hsize_i = offered.size;
    top.haddr_i = static_cast<uint16_t>(offered.address);
    top.hwdata_i = data;
    top.ahb_sample_valid_i = sample.valid;
    top.ahb_sample_u_i = sample.u;
    top.ahb_sample_v_i = sample.v;
    top.ahb_sample_clip_i = sample.clip;
    top.eval();
    // HREADY of the bus is HREADYOUT of the subordinate in its data phase.
    ready = data_phase.selected ? top.hreadyout_o : !other_waits;
    top.hready_i = ready;
    top.eval();
    sample.ready = top.ahb_sample_ready_o;
    const auto access = observe(data);
    failing = top.hresp_o && !top.hreadyout_o;
    if (ready) {
      data_phase = offered;
      waits = 0;
    }
    top.clk_i = 1;
    top.eval();
    top.clk_i = 0;
    top.eval();
    follower.follow(++edge, access, sample, top.ahb_irq_o, top.ahb_idle_o);
  }

  // A whole word, without another address phase; what it ended with.
  uint32_t transfer(bool write, uint32_t address, uint32_t data) {
    interval({true, write, trans_nonseq, 2, address}, 0, false, {});
    uint32_t word = 0;
    do {
      interval({}, data, false, {});
      if (ready && !write) word = top.hrdata_o;
    } while (!ready);
    return word;
  }

  VerilatedContext context;
  Vwrappers_bench top{&context};
  Follower follower{{}};
  uint64_t edge = 0;
  AddressPhase data_phase;
  bool ready = true, failing = false;
  unsigned waits = 0;
  unsigned reads = 0, writes = 0, errors = 0, refused = 0;
};

TEST_F(AhbLite, RandomTransfersAreThoseOfTheModel) {
  constexpr uint64_t seed = 1;
  RecordProperty("seed", static_cast<int>(seed));
  Stimulus stimulus(seed);
  AddressPhase offered;
  uint32_t data = 0;
  const auto next_phase = [&] {
    offered.selected = !stimulus.one_in(6);
    offered.write = stimulus.one_in(2);
    offered.trans = stimulus.one_in(3) ? static_cast<uint8_t>(stimulus.below(4)) : trans_nonseq;
    offered.size = stimulus.one_in(8) ? static_cast<uint8_t>(stimulus.below(4)) : 2;
    offered.address = stimulus.address();
    if (offered.size < 2 && stimulus.one_in(2)) offered.address += stimulus.below(4);
  };
  for (int i = 0; i < 200'000 && !HasFailure(); ++i) {
    interval(offered, data, stimulus.one_in(3), stimulus.sample());
    if (ready) {
      // HWDATA of the transfer whose data phase begins.
      data = stimulus.data(data_phase.address & ~3u);
      next_phase();
    } else if (failing && stimulus.one_in(2)) {
      offered.trans = trans_idle;  // a manager may cancel what follows an ERROR
    }
  }
  EXPECT_GT(reads, 5000u);
  EXPECT_GT(follower.taken(), 500u);
  EXPECT_GT(follower.refused(), 500u);
  EXPECT_GT(writes, 5000u);
  EXPECT_GT(errors, 1000u);
  EXPECT_GT(refused, 100u);
  // What is left of all that, register for register.
  for (uint32_t address = 0; address < 0x110 && !HasFailure(); address += 4)
    transfer(false, address, 0);
}

TEST_F(AhbLite, BytesOfARegisterAreReadOnTheirLanes) {
  using namespace coprocessor;
  transfer(true, reg_soft_u, 0x44332211);
  for (uint32_t address = 0; address < 4; ++address) {
    interval({true, false, trans_nonseq, 0, reg_soft_u + address}, 0, false, {});
    interval({}, 0, false, {});
    interval({}, 0, false, {});
    EXPECT_TRUE(ready);
  }
  EXPECT_EQ(reads, 4u);
  EXPECT_EQ(errors, 0u);
}

TEST_F(AhbLite, ATransferTakesOneWaitAndTheNextFollowsAtOnce) {
  using namespace coprocessor;
  const uint64_t begin = edge;
  for (uint32_t word = 0; word < 8; ++word) {
    interval({true, true, word == 0 ? trans_nonseq : trans_seq, 2, reg_step_au}, word, false, {});
    if (word != 0) {
      EXPECT_FALSE(ready);
      interval({true, true, trans_seq, 2, reg_step_au}, word, false, {});
      EXPECT_TRUE(ready);
    }
  }
  EXPECT_EQ(edge - begin, 1u + 7u * 2u);
}

}  // namespace
}  // namespace capsoc::rtl_wrappers_test
