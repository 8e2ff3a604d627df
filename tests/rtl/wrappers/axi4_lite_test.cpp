// The AXI4-Lite top as a manager sees it, against the model.
#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>

#include "Vwrappers_bench.h"
#include "follower.h"

namespace capsoc::rtl_wrappers_test {
namespace {

constexpr uint8_t resp_okay = 0, resp_slverr = 2;

class Axi4Lite : public ::testing::Test {
 protected:
  static coprocessor::Options table_8() {
    coprocessor::Options options;
    options.arithmetic = coprocessor::Arithmetic::paper;
    options.paper_operand_bits = 16;
    options.paper_reference_lead = 2;
    options.paper_step_shift = 7;
    options.paper_plain_arctangent = true;
    return options;
  }

  // What a manager has on a channel: it stays until it is taken.
  struct Channel {
    bool valid = false;
    uint32_t word = 0;
    uint8_t strobes = 0;
  };

  Axi4Lite() {
    top.clk_i = 0;
    top.rst_ni = 1;
    top.eval();
    top.rst_ni = 0;
    top.eval();
    EXPECT_FALSE(top.bvalid_o || top.rvalid_o);
    top.rst_ni = 1;
    top.eval();
  }
  ~Axi4Lite() override { top.final(); }

  // One interval and the edge that ends it.
  void interval(bool b_ready, bool r_ready, SamplePins sample) {
    top.awvalid_i = aw.valid;
    top.awaddr_i = static_cast<uint16_t>(aw.word);
    top.wvalid_i = w.valid;
    top.wdata_i = w.word;
    top.wstrb_i = w.strobes;
    top.arvalid_i = ar.valid;
    top.araddr_i = static_cast<uint16_t>(ar.word);
    top.bready_i = b_ready;
    top.rready_i = r_ready;
    top.axi_sample_valid_i = sample.valid;
    top.axi_sample_u_i = sample.u;
    top.axi_sample_v_i = sample.v;
    top.axi_sample_clip_i = sample.clip;
    top.eval();
    sample.ready = top.axi_sample_ready_o;
    take(aw, top.awready_o, addresses);
    take(w, top.wready_o, data);
    take(ar, top.arready_o, read_addresses);
    const bool b_waits = top.bvalid_o && !b_ready, r_waits = top.rvalid_o && !r_ready;
    const uint8_t bresp = top.bresp_o, rresp = top.rresp_o;
    const uint32_t rdata = top.rdata_o;
    b_stalls += b_waits;
    r_stalls += r_waits;
    top.clk_i = 1;
    top.eval();
    top.clk_i = 0;
    top.eval();
    ++edge;
    if (b_waits) {
      EXPECT_TRUE(top.bvalid_o && top.bresp_o == bresp) << "edge " << edge;
    }
    if (r_waits) {
      EXPECT_TRUE(top.rvalid_o && top.rresp_o == rresp && top.rdata_o == rdata) << "edge " << edge;
    }
    follower.follow(edge, ended(b_waits, r_waits), sample, top.axi_irq_o, top.axi_idle_o);
  }

  static void take(Channel& channel, bool is_ready, std::deque<Channel>& taken) {
    if (!channel.valid || !is_ready) return;
    taken.push_back(channel);
    channel.valid = false;
  }

  // The access that ended in the interval before: its response is new.
  std::optional<Access> ended(bool b_waits, bool r_waits) {
    const bool new_b = top.bvalid_o && !b_waits, new_r = top.rvalid_o && !r_waits;
    EXPECT_FALSE(new_b && new_r) << "edge " << edge;
    Access access;
    if (new_b) {
      if (addresses.empty() || data.empty()) {
        ADD_FAILURE() << "a response without its request at edge " << edge;
        return {};
      }
      access = {true, addresses.front().word & ~3u, data.front().word, data.front().strobes,
                top.bresp_o == resp_slverr};
      EXPECT_TRUE(access.error || top.bresp_o == resp_okay);
      addresses.pop_front();
      data.pop_front();
    } else if (new_r) {
      if (read_addresses.empty()) {
        ADD_FAILURE() << "read data without a request at edge " << edge;
        return {};
      }
      access = {false, read_addresses.front().word & ~3u, top.rdata_o, 0,
                top.rresp_o == resp_slverr};
      EXPECT_TRUE(access.error || top.rresp_o == resp_okay);
      read_addresses.pop_front();
    } else {
      return {};
    }
    ++(access.error ? errors : access.write ? writes : reads);
    return access;
  }

  VerilatedContext context;
  Vwrappers_bench top{&context};
  Follower follower{table_8()};
  uint64_t edge = 0;
  Channel aw, w, ar;
  std::deque<Channel> addresses, data, read_addresses;  // taken and not answered
  unsigned reads = 0, writes = 0, errors = 0, b_stalls = 0, r_stalls = 0;
};

TEST_F(Axi4Lite, RandomTransfersAreThoseOfTheModel) {
  constexpr uint64_t seed = 2;
  RecordProperty("seed", static_cast<int>(seed));
  Stimulus stimulus(seed);
  unsigned address_first = 0, data_first = 0;
  std::deque<uint32_t> without_data;    // addresses whose data have no word yet
  std::deque<Channel> without_address;  // and the other way round
  uint32_t idle_in = 2;                 // how rarely the manager begins a transfer
  for (int i = 0; i < 200'000 && !HasFailure(); ++i) {
    if (stimulus.one_in(200)) idle_in = 1u << stimulus.below(5);
    if (!aw.valid && stimulus.one_in(idle_in) && without_data.size() < 2) {
      aw = {true, stimulus.address(), 0};
      without_data.push_back(aw.word);
    }
    if (!w.valid && stimulus.one_in(idle_in) && without_address.size() < 2) {
      // Data for an address that is known, or for one that follows.
      const uint32_t known = without_data.empty() ? stimulus.address() : without_data.front();
      w = {true, stimulus.data(known & ~3u),
           static_cast<uint8_t>(stimulus.one_in(8) ? stimulus.below(16) : 15)};
      without_address.push_back(w);
    }
    if (!without_data.empty() && !without_address.empty()) {
      without_data.pop_front();
      without_address.pop_front();
    }
    if (!ar.valid && stimulus.one_in(idle_in)) ar = {true, stimulus.address(), 0};
    interval(stimulus.one_in(2), stimulus.one_in(2), stimulus.sample());
    address_first += addresses.size() > data.size();
    data_first += data.size() > addresses.size();
  }
  EXPECT_GT(reads, 3000u);
  EXPECT_GT(follower.taken(), 500u);
  EXPECT_GT(follower.refused(), 500u);
  EXPECT_GT(writes, 2000u);
  EXPECT_GT(errors, 500u);
  EXPECT_GT(b_stalls, 1000u);
  EXPECT_GT(r_stalls, 1000u);
  EXPECT_GT(address_first, 500u);
  EXPECT_GT(data_first, 500u);
  // What is left of all that, register for register.
  w.valid = aw.valid = false;
  for (int i = 0; i < 200; ++i) interval(true, true, {});
  for (uint32_t address = 0; address < 0x110 && !HasFailure(); address += 4) {
    ar = {true, address, 0};
    for (int i = 0; i < 6; ++i) interval(true, true, {});
    EXPECT_TRUE(read_addresses.empty());
  }
}

TEST_F(Axi4Lite, AResponseComesThreeEdgesAfterItsRequest) {
  using namespace coprocessor;
  ar = {true, reg_id, 0};
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(top.rvalid_o);
    interval(false, false, {});
  }
  EXPECT_TRUE(top.rvalid_o);
  EXPECT_EQ(top.rdata_o, description::ID_reset);
  // Data first, the address ten cycles later.
  w = {true, 7, 15};
  for (int i = 0; i < 10; ++i) interval(true, true, {});
  EXPECT_TRUE(top.awready_o);
  EXPECT_FALSE(top.wready_o);
  aw = {true, reg_soft_u, 0};
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(top.bvalid_o);
    interval(true, true, {});
  }
  EXPECT_TRUE(top.bvalid_o);
}

TEST_F(Axi4Lite, StrobesThatLeaveOutAByteAreAnErrorWithoutAnEffect) {
  using namespace coprocessor;
  for (uint8_t strobes = 0; strobes < 16; ++strobes) {
    aw = {true, reg_soft_u, 0};
    w = {true, 0x1000u + strobes, strobes};
    for (int i = 0; i < 5; ++i) interval(true, true, {});
  }
  EXPECT_EQ(errors, 15u);
  ar = {true, reg_soft_u, 0};
  for (int i = 0; i < 4; ++i) interval(true, false, {});
  EXPECT_EQ(top.rdata_o, 0x100Fu);
}

}  // namespace
}  // namespace capsoc::rtl_wrappers_test
