// The synthesised netlist of the coprocessor in calibration mode, with one net stuck at 0 or 1:
// what software would see. Built and run by scripts/tool net_faults.
//
// usage: stuck_nets NETS SAMPLES REFERENCE ERROR_LIMIT STEP_LIMIT PART PARTS
//
// REFERENCE is a value of CTRL.REF, the limits are those of SAFETY.
// Any of the nets 0 .. NETS - 1 can be stuck. A warm-up without a fault ends with LOCK; each fault
// then runs SAMPLES samples in a process that begins there. Writes a line for each fault: net,
// value and the words of print(). Does each PARTS-th fault, from PART on.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "Vcoprocessor_netlist.h"
#include "capsoc_registers.h"

namespace {

namespace reg = capsoc::registers::coprocessor;

constexpr double pi = 3.14159265358979323846;
constexpr unsigned samples_a_turn = 256;
constexpr unsigned clocks_a_sample = 200, clocks_to_wait = 180;
constexpr double wrong_deg = 0.1;
constexpr int silent_samples = 3;

// The sensor of traces/, as docs/reference/firmware.md has it, in amplitudes of full scale.
constexpr double a1 = 0.6079, a2 = 0.6228, b1 = 0.1336, b2 = 0.1831, beta = 0.0629;

uint32_t q31(double value) {
  return static_cast<uint32_t>(static_cast<int32_t>(std::lround(value * 2147483648.0)));
}
uint32_t turns(double radians) {
  return static_cast<uint32_t>(static_cast<int64_t>(std::llround(radians / (2 * pi) * 0x1p32)));
}

struct Result {
  uint32_t angle = 0, status = 0, flags = 0, samples = 0;
  bool came = false, bus_error = false;
};

class Chip {
 public:
  Chip() {
    top_.presetn_i = 0;
    for (int i = 0; i < 3; ++i) clock();
    top_.presetn_i = 1;
  }

  /// net: `count` for none.
  void stick(unsigned net, bool value) {
    top_.stuck_net_i = net;
    top_.stuck_value_i = value;
  }

  void write(uint32_t address, uint32_t data) { transfer(true, address, data); }
  uint32_t read(uint32_t address) { return transfer(false, address, 0); }

  /// A sample, and what the driver reads when its result interrupts.
  Result sample(uint32_t u, uint32_t v) {
    Result result;
    bus_error_ = false;
    top_.sample_valid_i = 1;
    top_.sample_u_i = u;
    top_.sample_v_i = v;
    clock();
    top_.sample_valid_i = 0;
    unsigned clocks = 1;
    for (; clocks < clocks_to_wait && !result.came; ++clocks) {
      clock();
      result.came = top_.irq_o;
    }
    if (result.came) {
      result.flags = read(reg::FLAGS_offset);
      result.samples = read(reg::SAMPLES_offset);
      result.status = read(reg::STATUS_offset);
      result.angle = read(reg::ANGLE_offset);
      write(reg::FLAGS_offset, reg::FLAGS_RESULT_mask);
      clocks += 10;
    }
    for (; clocks < clocks_a_sample; ++clocks) clock();
    result.bus_error = bus_error_;
    return result;
  }

 private:
  void clock() {
    top_.pclk_i = 0;
    top_.eval();
    top_.pclk_i = 1;
    top_.eval();
    top_.pclk_i = 0;
    top_.eval();
  }

  uint32_t transfer(bool is_write, uint32_t address, uint32_t data) {
    top_.psel_i = 1;
    top_.penable_i = 0;
    top_.pwrite_i = is_write;
    top_.paddr_i = address;
    top_.pwdata_i = data;
    top_.pstrb_i = is_write ? 15 : 0;
    clock();
    top_.penable_i = 1;
    top_.eval();
    const uint32_t word = top_.prdata_o;
    bus_error_ |= top_.pslverr_o || !top_.pready_o;
    clock();
    top_.psel_i = top_.penable_i = top_.pwrite_i = 0;
    return word;
  }

  Vcoprocessor_netlist top_;
  bool bus_error_ = false;
};

/// The shaft, a step a sample.
struct Sensor {
  uint64_t taken = 0;
  Result next(Chip& chip) {
    const double theta = 2 * pi * static_cast<double>(taken++ % samples_a_turn) / samples_a_turn;
    return chip.sample(q31(a1 * std::sin(theta) + b1), q31(a2 * std::cos(theta + beta) + b2));
  }
};

constexpr uint32_t mechanisms = reg::SAFETY_PARITY_mask | reg::SAFETY_MISFIT_mask |
                                reg::SAFETY_JUMP_mask | reg::SAFETY_MISSED_mask;
constexpr uint32_t found_mask =
    reg::FLAGS_PARITY_mask | reg::FLAGS_MISFIT_mask | reg::FLAGS_JUMP_mask | reg::FLAGS_MISSED_mask;
constexpr uint32_t error_mask = reg::FLAGS_CLIP_mask | reg::FLAGS_SAT_mask | reg::FLAGS_ZERO_mask |
                                reg::FLAGS_EARLY_mask | reg::FLAGS_CONFIG_mask |
                                reg::FLAGS_UNSETTLED_mask;

/// As the driver does it: parameters, coefficients of them, the reference on the angle, then with a
/// lock the mechanisms (firmware/apps/calibrate, firmware/drivers/coprocessor_safety.c).
void begin(Chip& chip, Sensor& sensor, uint32_t reference, uint32_t limits) {
  chip.write(reg::A1_offset, q31(a1));
  chip.write(reg::A2_offset, q31(a2));
  chip.write(reg::B1_offset, q31(b1));
  chip.write(reg::B2_offset, q31(b2));
  chip.write(reg::BETA_offset, turns(beta));
  chip.write(reg::PHI_offset, 0);
  chip.write(reg::CMD_offset, reg::CMD_LOAD_mask);
  for (int i = 0; i < 400; ++i) chip.read(reg::STATUS_offset);
  chip.write(reg::LOCK_THRESHOLD_offset, ~uint32_t{0});
  chip.write(reg::FREQ_LO_offset, 0);
  chip.write(reg::FREQ_HI_offset, (uint32_t{1} << 31) / samples_a_turn * 2);
  chip.write(reg::CTRL_offset, reg::CTRL_CALIB_mask | reg::CTRL_ADC_mask |
                                   reg::CTRL_IE_RESULT_mask | reference << reg::CTRL_REF_shift);
  for (unsigned i = 0; i < 4 * samples_a_turn + 8; ++i) sensor.next(chip);
  chip.write(reg::SAFETY_offset, mechanisms | limits);
  chip.write(reg::FLAGS_offset, found_mask | error_mask);
}

/// What one fault does, as far as software can see it.
struct Verdict {
  int first_wrong = -1, detected = -1, trusted = 0;
  const char* by = "-";
  double largest_deg = 0;
  bool differs = false;
};

const char* detection(const Result& got, uint32_t samples_before) {
  if (got.bus_error) return "bus error";
  if (!got.came) return "no interrupt";
  if (got.flags & reg::FLAGS_PARITY_mask) return "PARITY";
  if (got.flags & reg::FLAGS_MISFIT_mask) return "MISFIT";
  if (got.flags & reg::FLAGS_JUMP_mask) return "JUMP";
  if (got.flags & reg::FLAGS_MISSED_mask) return "MISSED";
  if (got.samples != samples_before + 1) return "SAMPLES";
  if (!(got.status & reg::STATUS_VALID_mask)) return "VALID";
  if (!(got.status & reg::STATUS_LOCK_mask)) return "LOCK";
  if (got.status & (reg::STATUS_ALARM_mask | reg::STATUS_DIVERGED_mask)) return "ALARM";
  if (got.flags & error_mask) return "error flag";
  return nullptr;
}

Verdict run(Chip& chip, Sensor sensor, uint32_t before, const std::vector<Result>& golden) {
  Verdict verdict;
  for (int i = 0; i < static_cast<int>(golden.size()) && verdict.detected < 0; ++i) {
    const Result got = sensor.next(chip);
    const Result& good = golden[static_cast<std::size_t>(i)];
    verdict.differs |= got.angle != good.angle || got.status != good.status ||
                       got.flags != good.flags || got.samples != good.samples ||
                       got.came != good.came;
    const double off = std::abs(static_cast<int32_t>(got.angle - good.angle)) * 0x1p-32 * 360;
    if (const char* by = detection(got, before)) {
      verdict.detected = i;
      verdict.by = by;
    } else if (off > wrong_deg) {
      ++verdict.trusted;
      verdict.largest_deg = std::max(verdict.largest_deg, off);
    }
    if (off > wrong_deg && verdict.first_wrong < 0) verdict.first_wrong = i;
    before = got.samples;
  }
  return verdict;
}

void print(unsigned net, bool value, const Verdict& v) {
  const char* word = v.trusted > silent_samples ? "silent"
                     : v.detected >= 0          ? "detected"
                     : v.trusted > 0            ? "wrong"
                     : v.differs                ? "latent"
                                                : "unseen";
  const int after = v.detected < 0 ? -1 : v.first_wrong < 0 ? 0 : v.detected - v.first_wrong;
  std::printf("%u %d %s %d %d %.4f %s\n", net, value ? 1 : 0, word, after, v.trusted, v.largest_deg,
              v.by);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 8) return 2;
  const auto number = [&](int i) { return static_cast<unsigned>(std::atoi(argv[i])); };
  const unsigned nets = number(1), count = number(2), part = number(6), parts = number(7);
  static Chip chip;
  Sensor sensor;
  chip.stick(nets, false);
  begin(chip, sensor, number(3),
        number(4) << reg::SAFETY_ERROR_LIMIT_shift | number(5) << reg::SAFETY_STEP_LIMIT_shift);
  const uint32_t before = chip.read(reg::SAMPLES_offset);
  // Without a fault, in a separate process, so that each begins from here.
  auto* shared = static_cast<Result*>(mmap(nullptr, count * sizeof(Result), PROT_READ | PROT_WRITE,
                                           MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (fork() == 0) {
    Sensor own = sensor;
    for (unsigned i = 0; i < count; ++i) shared[i] = own.next(chip);
    _exit(0);
  }
  wait(nullptr);
  const std::vector<Result> golden(shared, shared + count);
  uint32_t last = before;
  for (const Result& result : golden) {
    const char* by = detection(result, last);
    last = result.samples;
    if (by == nullptr) continue;
    std::fprintf(stderr, "without a fault: %s, flags %x, status %x, angle %x\n", by, result.flags,
                 result.status, result.angle);
    return 1;
  }
  for (unsigned fault = part; fault < 2 * nets; fault += parts) {
    std::fflush(stdout);
    if (fork() == 0) {
      const bool value = fault % 2 != 0;
      chip.stick(fault / 2, value);
      print(fault / 2, value, run(chip, sensor, before, golden));
      std::fflush(stdout);
      _exit(0);
    }
    wait(nullptr);
  }
  return 0;
}
