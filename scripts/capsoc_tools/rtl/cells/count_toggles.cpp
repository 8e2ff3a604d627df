// The coprocessor in standard cells next to its RTL, with a sampled sensor: how often each net
// toggles. Built and run by scripts/tool power.
//
// usage: count_toggles TABLE SAMPLES SEED PERIOD SAFETY UNIT_DELAY FILE
//
// A sample every PERIOD clocks; at its interrupt the bus reads ANGLE and clears FLAGS.RESULT.
// SAFETY 1 switches the mechanisms on; UNIT_DELAY 1 gives each cell the same delay, else none has
// one. Three designs get the same pins: the RTL, the netlist, and the netlist with a gated clock.
// The gate is open while idle_o is 0, a sample comes, or a transfer acts. All outputs are compared
// in every interval. FILE: a line of numbers about the run; for each memory its writes and reads;
// for each net of TABLE its half clocks at 1, its rises, and its falls. Status 1: the outputs
// differ; 2: usage, or FILE cannot be written.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string>

#include "Vcoprocessor.h"
#include "cell_simulator.h"

namespace {

constexpr double tau = 6.283185307179586476925;

// What the stimulus needs to know of the register map (docs/reference/coprocessor.md).
constexpr uint32_t reg_ctrl = 0x008, reg_flags = 0x010, reg_freq_lo = 0x018, reg_freq_hi = 0x01c,
                   reg_safety = 0x0ac, reg_angle = 0x0c0, reg_last = 0x0fc;
constexpr uint32_t ctrl_learn = 3u | 1u << 4 | 1u << 8;  // DEMOD, CALIB, ADC, IE_RESULT
constexpr uint32_t flags_result = 1;
constexpr uint32_t mechanisms = 15u | 1u << 16 | 1u << 24;
constexpr unsigned warm_up_samples = 16;

struct Inputs {
  bool select = false, enable = false, write = false, valid = false;
  uint32_t address = 0, data = 0, strobe = 0, u = 0, v = 0;
  bool operator==(const Inputs& o) const {
    return select == o.select && enable == o.enable && write == o.write && valid == o.valid &&
           address == o.address && data == o.data && strobe == o.strobe && u == o.u && v == o.v;
  }
};

struct Outputs {
  uint32_t data = 0;
  bool ready = false, error = false, sample_ready = false, interrupt = false, idle = false;
  bool operator==(const Outputs& o) const {
    return data == o.data && ready == o.ready && error == o.error &&
           sample_ready == o.sample_ready && interrupt == o.interrupt && idle == o.idle;
  }
};

/// The RTL.
class Rtl {
 public:
  void reset(bool value) { top_.presetn_i = value; }
  Outputs drive(const Inputs& in) {
    top_.psel_i = in.select;
    top_.penable_i = in.enable;
    top_.pwrite_i = in.write;
    top_.paddr_i = in.address;
    top_.pwdata_i = in.data;
    top_.pstrb_i = in.strobe;
    top_.sample_valid_i = in.valid;
    top_.sample_u_i = in.u;
    top_.sample_v_i = in.v;
    top_.pclk_i = 0;
    top_.eval();
    return {top_.prdata_o,   top_.pready_o != 0, top_.pslverr_o != 0, top_.sample_ready_o != 0,
            top_.irq_o != 0, top_.idle_o != 0};
  }
  void clock() {
    top_.pclk_i = 1;
    top_.eval();
  }

 private:
  Vcoprocessor top_;
};

/// The netlist.
class Cells {
 public:
  Cells(const std::string& table, bool unit_delay) : simulator(table, unit_delay) {}
  void reset(bool value) { set("presetn_i", value); }
  Outputs drive(const Inputs& in) {
    set("psel_i", in.select);
    set("penable_i", in.enable);
    set("pwrite_i", in.write);
    set("paddr_i", in.address);
    set("pwdata_i", in.data);
    set("pstrb_i", in.strobe);
    set("sample_valid_i", in.valid);
    set("sample_u_i", in.u);
    set("sample_v_i", in.v);
    simulator.settle();
    return {get("prdata_o"),       get("pready_o") != 0,
            get("pslverr_o") != 0, get("sample_ready_o") != 0,
            get("irq_o") != 0,     get("idle_o") != 0};
  }
  void clock() {
    simulator.clock();
    simulator.settle();
  }

  CellSimulator simulator;

 private:
  void set(const char* port, uint32_t value) { simulator.set(simulator.port(port), value); }
  uint32_t get(const char* port) const { return simulator.get(simulator.port(port)); }
};

class Bench {
 public:
  Bench(const std::string& table, bool unit_delay, uint64_t seed, uint64_t period, bool safety)
      : netlist_(table, unit_delay), gated_(table, false), random_(seed), period_(period) {
    reset(false);
    for (int i = 0; i < 3; ++i) cycle();
    reset(true);
    a_[0] = 0.4 + 0.3 * unit();
    a_[1] = a_[0] * (0.9 + 0.2 * unit());
    for (double& offset : b_) offset = 0.4 * unit() - 0.2;
    beta_ = 0.2 * unit() - 0.1;
    angle_ = unit();
    speed_ = 1 / (50 + 450 * unit());
    const auto frequency = static_cast<uint64_t>(std::ldexp(speed_, 48));
    write(reg_freq_lo, static_cast<uint32_t>(frequency & 0xffff));
    write(reg_freq_hi, static_cast<uint32_t>(frequency >> 16));
    if (safety) write(reg_safety, mechanisms);
    write(reg_ctrl, ctrl_learn);
  }

  bool run(unsigned samples) {
    for (unsigned i = 0; i < warm_up_samples; ++i) sample();
    netlist_.simulator.start();
    counting_ = true;
    for (unsigned i = 0; i < samples; ++i) sample();
    return equal_;
  }

  /// Reads every register after the run, when nothing is counted any more.
  bool read_all() {
    counting_ = false;
    for (uint32_t address = 0; address <= reg_last; address += 4) transfer(false, address, 0);
    return equal_;
  }

  void write(std::FILE* file) const {
    std::fprintf(file, "%llu %llu %llu %llu %llu %.6f\n", static_cast<unsigned long long>(clocks_),
                 static_cast<unsigned long long>(open_), static_cast<unsigned long long>(quiet_),
                 static_cast<unsigned long long>(quiet_toggles_),
                 static_cast<unsigned long long>(results_), 1 / speed_);
    const CellSimulator& simulator = netlist_.simulator;
    for (std::size_t i = 0; i < simulator.memories(); ++i) {
      const auto [writes, reads] = simulator.accesses(i);
      std::fprintf(file, "%llu %llu\n", static_cast<unsigned long long>(writes),
                   static_cast<unsigned long long>(reads));
    }
    for (std::size_t i = 0; i < simulator.nets(); ++i) {
      const Edges net = simulator.edges(i);
      std::fprintf(file, "%llu %llu %llu\n", static_cast<unsigned long long>(net.high),
                   static_cast<unsigned long long>(net.rises),
                   static_cast<unsigned long long>(net.falls));
    }
  }

 private:
  void reset(bool value) {
    in_reset_ = !value;
    rtl_.reset(value);
    netlist_.reset(value);
    gated_.reset(value);
  }

  // One clock of all. The outputs are compared before the edge.
  void cycle() {
    const uint64_t before = netlist_.simulator.changed();
    outputs_ = rtl_.drive(in_);
    const bool same = netlist_.drive(in_) == outputs_, same_gated = gated_.drive(in_) == outputs_;
    if (!in_reset_ && equal_ && !(same && same_gated)) {
      equal_ = false;
      std::printf("clock %llu: the %s differs from the RTL\n",
                  static_cast<unsigned long long>(total_),
                  same ? "netlist with the gated clock" : "netlist");
    }
    const bool open = in_reset_ || !outputs_.idle || in_.valid || (in_.select && in_.enable);
    netlist_.simulator.half_clock();
    rtl_.clock();
    netlist_.clock();
    if (open) gated_.clock();
    netlist_.simulator.half_clock();
    ++total_;
    if (counting_) {
      ++clocks_;
      open_ += open;
      if (!open && in_ == last_in_) {
        ++quiet_;
        quiet_toggles_ += netlist_.simulator.changed() - before;
      }
    }
    last_in_ = in_;
  }

  // A transfer; address and data stay on the bus after it.
  uint32_t transfer(bool write, uint32_t address, uint32_t data) {
    in_.select = true;
    in_.write = write;
    in_.address = address;
    if (write) in_.data = data;
    in_.strobe = write ? 15 : 0;
    cycle();
    in_.enable = true;
    cycle();
    in_.select = in_.enable = false;
    return outputs_.data;
  }
  void write(uint32_t address, uint32_t data) { transfer(true, address, data); }

  void sample() {
    const uint64_t end = total_ + period_;
    angle_ = std::fmod(angle_ + speed_, 1.0);
    in_.u = q31(a_[0] * std::sin(tau * angle_) + b_[0] + noise());
    in_.v = q31(a_[1] * std::cos(tau * angle_ + beta_) + b_[1] + noise());
    in_.valid = true;
    cycle();
    in_.valid = false;
    while (total_ < end) {
      if (outputs_.interrupt && total_ + 5 <= end) {
        transfer(false, reg_angle, 0);
        write(reg_flags, flags_result);
        cycle();  // its edge has cleared the interrupt
        results_ += counting_;
      } else {
        cycle();
      }
    }
  }

  double unit() { return std::ldexp(static_cast<double>(random_() >> 11), -53); }
  // About 1e-4 of full scale, standard deviation: a converter's.
  double noise() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += unit();
    return 1e-4 * sum;
  }
  static uint32_t q31(double x) {
    return static_cast<uint32_t>(static_cast<int32_t>(std::lround(x * 2147483648.0)));
  }

  Rtl rtl_;
  Cells netlist_, gated_;
  std::mt19937_64 random_;
  uint64_t period_, total_ = 0, clocks_ = 0, open_ = 0, quiet_ = 0, quiet_toggles_ = 0,
                    results_ = 0;
  Inputs in_, last_in_;
  Outputs outputs_;
  bool in_reset_ = false, counting_ = false, equal_ = true;
  double a_[2] = {}, b_[2] = {}, beta_ = 0, angle_ = 0, speed_ = 0;
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 8) {
    std::fprintf(stderr, "usage: count_toggles TABLE SAMPLES SEED PERIOD SAFETY UNIT_DELAY FILE\n");
    return 2;
  }
  const auto number = [&](int i) { return std::strtoull(argv[i], nullptr, 10); };
  static Bench bench(argv[1], number(6) != 0, number(3), number(4), number(5) != 0);
  if (!bench.run(static_cast<unsigned>(number(2)))) return 1;
  std::FILE* file = std::fopen(argv[7], "w");
  if (file == nullptr) {
    std::fprintf(stderr, "count_toggles: cannot write %s\n", argv[7]);
    return 2;
  }
  bench.write(file);
  if (std::fclose(file) != 0) return 2;
  return bench.read_all() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "count_toggles: %s\n", error.what());
  return 2;
}
