// The synthesised netlist of the coprocessor against its RTL, both Verilated: the same stimulus,
// and every output compared in every clock cycle. Built and run by scripts/tool synth.
//
// usage: netlist_gate SAMPLES SEED CHANNELS
// Ends with status 1 at the first difference.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "Vcoprocessor.h"
#include "Vcoprocessor_netlist.h"

namespace {

constexpr double tau = 6.283185307179586476925;

// What the stimulus needs to know of the register map (docs/reference/coprocessor.md).
constexpr uint32_t reg_ctrl = 0x008, reg_flags = 0x010, reg_cmd = 0x014, reg_freq_lo = 0x018,
                   reg_freq_hi = 0x01c, reg_step_au = 0x028, reg_step_cv = 0x03c, reg_last = 0x0e0,
                   reg_channel = 0x100;
constexpr uint32_t ctrl_adc = 1u << 4, channel_hold = 1u << 8;
// A sample in each stage, one that waits, and two changes of context.
constexpr uint64_t until_ready = 300;

struct Inputs {
  bool select = false, enable = false, write = false;
  uint32_t address = 0, data = 0, strobe = 0;
  bool valid = false, clip = false;
  uint32_t u = 0, v = 0;
  uint8_t channel = 0;
};

template <typename Top>
void drive(Top& top, const Inputs& in) {
  top.psel_i = in.select;
  top.penable_i = in.enable;
  top.pwrite_i = in.write;
  top.paddr_i = in.address;
  top.pwdata_i = in.data;
  top.pstrb_i = in.strobe;
  top.sample_valid_i = in.valid;
  top.sample_clip_i = in.clip;
  top.sample_u_i = in.u;
  top.sample_v_i = in.v;
  top.sample_channel_i = in.channel;
  top.pclk_i = 0;
  top.eval();
}

class Gate {
 public:
  Gate(uint64_t seed, unsigned channels) : random_(seed), channels_(channels) {
    rtl_.presetn_i = netlist_.presetn_i = 0;
    for (int i = 0; i < 3; ++i) cycle({});
    rtl_.presetn_i = netlist_.presetn_i = 1;
  }

  bool run(unsigned samples) {
    while (equal_ && samples_ < samples) {
      if (samples_ % (channels_ > 1 ? 50 : 250) == 0) prepare_one();
      const uint64_t kind = random_() % 16;
      // Mostly as fast as the pipeline goes; sometimes too early, sometimes idle in between.
      gap(kind == 0 ? random_() % 32 : kind == 1 ? 32 + random_() % 300 : 32 + random_() % 4);
      sample();
    }
    gap(400);
    std::printf("%llu cycles, %u samples, %llu register reads: %s\n",
                static_cast<unsigned long long>(cycles_), samples_,
                static_cast<unsigned long long>(reads_), equal_ ? "identical" : "DIFFERENT");
    return equal_;
  }

 private:
  // One clock cycle of both; the outputs are compared before the edge.
  void cycle(const Inputs& in) {
    drive(rtl_, in);
    drive(netlist_, in);
    const bool same = rtl_.prdata_o == netlist_.prdata_o && rtl_.pready_o == netlist_.pready_o &&
                      rtl_.pslverr_o == netlist_.pslverr_o &&
                      rtl_.sample_ready_o == netlist_.sample_ready_o &&
                      rtl_.irq_o == netlist_.irq_o && rtl_.idle_o == netlist_.idle_o;
    if (!same && equal_) {
      equal_ = false;
      std::printf(
          "cycle %llu, sample %u, address %03x: rtl %08x %d%d%d%d%d, netlist %08x %d%d%d%d%d\n",
          static_cast<unsigned long long>(cycles_), samples_, in.address,
          static_cast<unsigned>(rtl_.prdata_o), rtl_.pready_o, rtl_.pslverr_o, rtl_.sample_ready_o,
          rtl_.irq_o, rtl_.idle_o, static_cast<unsigned>(netlist_.prdata_o), netlist_.pready_o,
          netlist_.pslverr_o, netlist_.sample_ready_o, netlist_.irq_o, netlist_.idle_o);
    }
    rtl_.pclk_i = netlist_.pclk_i = 1;
    rtl_.eval();
    netlist_.eval();
    ++cycles_;
  }

  void transfer(bool write, uint32_t address, uint32_t data) {
    Inputs in;
    in.select = true;
    in.write = write;
    in.address = address;
    in.data = data;
    in.strobe = write ? 15 : 0;
    cycle(in);
    in.enable = true;
    cycle(in);
    reads_ += !write;
  }
  void write(uint32_t address, uint32_t data) { transfer(true, address, data); }

  uint32_t word() { return static_cast<uint32_t>(random_() >> 32); }
  uint32_t any_register() { return static_cast<uint32_t>(random_() % (reg_last / 4 + 2)) * 4; }

  // Of one channel, whose window is open for it.
  void prepare_one() {
    if (channels_ == 1) return prepare();
    const auto window = static_cast<uint32_t>(random_() % channels_);
    write(reg_channel, window | channel_hold);
    gap(until_ready);
    prepare();
    write(reg_channel, window);
  }

  // A new round: settings, the sensor's speed, the kind of signal.
  void prepare() {
    const uint32_t source = static_cast<uint32_t>(random_() % 3);
    speed_ = std::ldexp(static_cast<double>(static_cast<int32_t>(word())), -36);
    if (samples_ != 0 && random_() % 4 == 0) write(reg_ctrl, 1u << 31);  // SRST
    const auto frequency = static_cast<int64_t>(std::ldexp(speed_, 48));
    write(reg_freq_lo, static_cast<uint32_t>(frequency & 0xffff));
    write(reg_freq_hi, static_cast<uint32_t>(frequency >> 16));
    const uint32_t step = word() >> (4 + random_() % 8);
    for (uint32_t r = reg_step_au; r <= reg_step_cv; r += 4) write(r, step);
    write(reg_ctrl, 3u | source << 2 | ctrl_adc | 1u << (8 + random_() % 3));
    noise_ = random_() % 4 == 0;
  }

  void sample() {
    Inputs in;
    in.valid = true;
    in.clip = random_() % 32 == 0;
    if (channels_ > 1) in.channel = static_cast<uint8_t>(random_() % channels_);
    angle_ = std::fmod(angle_ + speed_, 1.0);
    if (noise_) {
      in.u = random_() % 8 == 0 ? 0x80000000u : word();
      in.v = random_() % 8 == 0 ? 0x7fffffffu : word();
    } else {
      const auto q31 = [](double x) {
        return static_cast<uint32_t>(static_cast<int32_t>(std::lround(x * 2147483648.0)));
      };
      in.u = q31(0.6079 * std::sin(tau * angle_ + 0.0876) + 0.1336);
      in.v = q31(0.6228 * std::cos(tau * angle_ + 0.0876 + 0.0629) + 0.1831);
    }
    cycle(in);
    ++samples_;
  }

  // Register traffic until the next sample: nearly always reads.
  void gap(uint64_t cycles) {
    const uint64_t end = cycles_ + cycles;
    while (equal_ && cycles_ + 1 < end) {
      const uint64_t kind = random_() % 400;
      if (kind < 4)
        write(any_register() % 0xa8, word() >> (kind == 0 ? 0 : random_() % 24));
      else if (kind == 4)
        write(reg_cmd, word() & 7);
      else if (kind == 5)
        write(reg_flags, word() & 0x1ff);
      else if (kind == 6)
        write(reg_ctrl, (word() & 0x70f) | ctrl_adc);
      else
        transfer(false, any_register(), 0);
    }
    while (cycles_ < end) cycle({});
  }

  Vcoprocessor rtl_;
  Vcoprocessor_netlist netlist_;
  std::mt19937_64 random_;
  unsigned channels_;
  uint64_t cycles_ = 0;
  uint64_t reads_ = 0;
  unsigned samples_ = 0;
  bool equal_ = true;
  bool noise_ = false;
  double speed_ = 0;  // turns a sample
  double angle_ = 0;  // turns
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: netlist_gate SAMPLES SEED CHANNELS\n");
    return 2;
  }
  Gate gate(std::strtoull(argv[2], nullptr, 10),
            static_cast<unsigned>(std::strtoul(argv[3], nullptr, 10)));
  return gate.run(static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10))) ? 0 : 1;
}
