// The board's top as a host at its serial port and a converter at its SPI see it, against the
// model. The bench sees inside when a transfer ends and when a sample comes; what they are is what
// the host sent and the converter converted.
#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "../wrappers/follower.h"
#include "Vboard_bench.h"
#include "converter.h"
#include "peripherals/quantiser.h"
#include "serial_line.h"

namespace capsoc::rtl_board_test {
namespace {

using namespace coprocessor;
using rtl_wrappers_test::Access;
using rtl_wrappers_test::Follower;
using rtl_wrappers_test::SamplePins;
using Bytes = std::vector<uint8_t>;

// As in board_bench.sv
constexpr unsigned clocks_per_bit = 9, quiet_clocks = 300, sample_clocks = 400, status_clocks = 37;
constexpr uint8_t no_register = 1, no_command = 2, framing = 3, overrun = 4;
// A sensor: u = gain_u sin + offset_u, v = gain_v cos(+ shift) + offset_v, in units of full scale.
constexpr double gain_u = 0.62, offset_u = 0.05, gain_v = 0.55, offset_v = -0.04, shift = 0.1;
constexpr uint32_t angle_source = 2u << ctrl_ref_shift;  // CTRL.REF
constexpr double tau = 6.283185307179586;

class Board : public ::testing::TestWithParam<unsigned> {
 protected:
  Board() {
    top.clk_25mhz = 0;
    top.ftdi_txd = 1;
    top.btn_pwrn = 0;
    // Verilator begins with flip-flops of 0; those of the FPGA begin as their reset leaves them.
    rise_and_fall();
    reset();
  }
  ~Board() override { top.final(); }

  void reset() {
    top.btn_pwrn = 0;
    for (int i = 0; i < 3; ++i) edge_of_clock();
    top.btn_pwrn = 1;
    for (int i = 0; i < 2; ++i) edge_of_clock();
    follower.emplace(Options{});
    edge = 0;
    apb = {};
    samples = refused = framing_errors = 0;
    forget();
  }

  // The conversions of a pair that gives no sample
  void forget() {
    converter.take(0);
    converter.take(1);
  }

  void edge_of_clock() {
    converter.clock(top.adc_csn, top.adc_sclk, top.adc_mosi);
    top.adc_miso = converter.dout();
    rise_and_fall();
  }

  void rise_and_fall() {
    top.eval();
    top.clk_25mhz = 1;
    top.eval();
    top.clk_25mhz = 0;
    top.eval();
  }

  uint16_t code_of(unsigned channel) {
    if (channel == 0) angle += turns_a_sample;
    if (channel < codes.size() && !codes[channel].empty()) {
      const uint16_t code = codes[channel].front();
      codes[channel].pop_front();
      return code;
    }
    double value = 0.9;  // of other inputs: neither signal
    if (channel == 0) value = gain_u * std::sin(tau * angle) + offset_u;
    if (channel == 1) value = gain_v * std::cos(tau * angle + shift) + offset_v;
    return static_cast<uint16_t>(std::clamp(std::floor(2048 * (1 + value)), 0.0, 4095.0));
  }

  // The sample of this interval, from what the converter has converted.
  SamplePins sample_of_converter() {
    const auto u = converter.take(0), v = converter.take(1);
    EXPECT_TRUE(u && v) << "a sample without a conversion of each channel, edge " << edge;
    if (!u || !v) return {};
    SamplePins sample;
    sample.valid = true;
    sample.u = static_cast<uint32_t>(peripherals::quantise((*u - 2048) / 2048.0, 12).word);
    sample.v = static_cast<uint32_t>(peripherals::quantise((*v - 2048) / 2048.0, 12).word);
    sample.clip = *u == 0 || *u == 4095 || *v == 0 || *v == 4095;
    EXPECT_EQ(top.sample_u_o, sample.u) << "code " << *u;
    EXPECT_EQ(top.sample_v_o, sample.v) << "code " << *v;
    EXPECT_EQ(top.sample_clip_o, sample.clip) << "codes " << *u << " and " << *v;
    sample.ready = top.sample_ready_o;
    return sample;
  }

  // The transfer that ends in this interval is the one the host asked for.
  Access access_of_host() {
    Access access;
    access.write = top.write_o;
    access.address = top.address_o;
    access.data = access.write ? top.wdata_o : top.rdata_o;
    access.strobes = 15;
    access.error = top.error_o;
    ++accesses;
    if (any_access) return access;
    EXPECT_TRUE(asked) << "a transfer that nobody asked for, at " << access.address;
    if (!asked) return access;
    EXPECT_EQ(access.write, asked->write);
    EXPECT_EQ(access.address, asked->address);
    if (asked->write) {
      EXPECT_EQ(access.data, asked->data);
    }
    asked.reset();
    last_read = access.data;
    return access;
  }

  void clock() {
    top.ftdi_txd = line.next();
    top.adc_miso = converter.dout();
    top.eval();
    line.observe(top.ftdi_rxd);
    std::optional<Access> access;
    if (top.access_o) access = access_of_host();
    SamplePins sample;
    if (top.sample_valid_o) sample = sample_of_converter();
    samples += top.sample_valid_o;
    refused += top.refused_o;
    if (top.refused_o) forget();
    framing_errors += top.framing_o;
    check_apb();
    edge_of_clock();
    follower->follow(++edge, access, sample, top.irq_o, top.idle_o);
    EXPECT_EQ(top.led >> 4 & 1, top.irq_o);
    EXPECT_EQ(top.led >> 5 & 1, samples >> 7 & 1);
    if (edge > 1'000'000) ADD_FAILURE() << "what a test waits for does not come";
  }

  // The coprocessor's APB: each transfer has a setup phase, and keeps its address (IHI 0024C, 3.1).
  void check_apb() {
    const bool access_phase = apb.selected && !(apb.enabled && apb.ready);
    EXPECT_EQ(top.penable_o, access_phase) << "edge " << edge;
    EXPECT_TRUE(top.psel_o || !access_phase) << "edge " << edge;
    if (access_phase) {
      EXPECT_EQ(top.paddr_o, apb.address);
      EXPECT_EQ(top.pwrite_o, apb.write);
    }
    apb = {top.psel_o != 0, top.penable_o != 0, top.pready_o != 0, top.pwrite_o != 0, top.paddr_o};
  }

  // After what is in the pipeline, and a read of STATUS for the LEDs.
  uint32_t status_of_leds() {
    clocks(170 + 2 * status_clocks);
    const uint32_t status = read(reg_status);
    EXPECT_EQ(top.led & 1, (status & status_lock) != 0);
    EXPECT_EQ(top.led >> 1 & 1, (status & status_valid) != 0);
    EXPECT_EQ(top.led >> 2 & 1, (status & status_alarm) != 0);
    EXPECT_EQ(top.led >> 3 & 1, (status & status_diverged) != 0);
    return status & (status_lock | status_valid | status_alarm | status_diverged);
  }

  void clocks(unsigned count) {
    for (unsigned i = 0; i < count && !HasFailure(); ++i) clock();
  }

  void samples_come(unsigned count) {
    const unsigned until = samples + count;
    for (unsigned i = 0; samples < until && !HasFailure() && i < 2 * count * sample_clocks; ++i)
      clock();
    EXPECT_EQ(samples, until);
  }

  static Bytes read_command(uint32_t address) {
    return {'R', static_cast<uint8_t>(address >> 8), static_cast<uint8_t>(address)};
  }

  static Bytes write_command(uint32_t address, uint32_t data) {
    Bytes bytes{'W', static_cast<uint8_t>(address >> 8), static_cast<uint8_t>(address)};
    for (int at = 24; at >= 0; at -= 8) bytes.push_back(static_cast<uint8_t>(data >> at));
    return bytes;
  }

  void send(const Bytes& bytes) {
    for (const uint8_t byte : bytes) line.send(byte);
  }

  // Whole answers that have come until the line is quiet.
  std::vector<Bytes> answers() {
    while (line.sending() && !HasFailure()) clock();
    for (unsigned idle = 0; idle < 2 * quiet_clocks && !HasFailure(); ++idle) {
      clock();
      if (!top.ftdi_rxd) idle = 0;
    }
    std::vector<Bytes> found;
    while (!line.received.empty()) {
      const uint8_t kind = line.received.front();
      const std::size_t size = kind == 'w' ? 1 : kind == 'e' ? 2 : 5;
      EXPECT_TRUE(kind == 'w' || kind == 'e' || kind == 'r' || kind == 's') << unsigned{kind};
      EXPECT_GE(line.received.size(), size);
      if (HasFailure()) break;
      found.emplace_back(line.received.begin(), line.received.begin() + static_cast<int>(size));
      line.received.erase(line.received.begin(), line.received.begin() + static_cast<int>(size));
    }
    return found;
  }

  // As soon as its `size` bytes have come; the next command may follow at once.
  Bytes answer(std::size_t size) {
    for (unsigned i = 0; line.received.size() < size && !HasFailure(); ++i) {
      clock();
      if (i > 40 * 10 * clocks_per_bit) ADD_FAILURE() << "no answer";
    }
    Bytes bytes(line.received.begin(), line.received.end());
    line.received.clear();
    return bytes;
  }

  static uint32_t word(const Bytes& bytes) {
    uint32_t value = 0;
    for (std::size_t i = 1; i < bytes.size(); ++i) value = value << 8 | bytes[i];
    return value;
  }

  uint32_t read(uint32_t address) {
    asked = Access{false, address, 0, 0, false};
    send(read_command(address));
    const Bytes bytes = answer(5);
    EXPECT_EQ(bytes.empty() ? 0 : bytes[0], 'r') << "register " << address;
    EXPECT_FALSE(asked) << "an answer without a transfer";
    EXPECT_EQ(word(bytes), last_read);  // which the follower has compared with the model
    return word(bytes);
  }

  void write(uint32_t address, uint32_t data) {
    asked = Access{true, address, data, 15, false};
    send(write_command(address, data));
    EXPECT_EQ(answer(1), Bytes{'w'}) << "register " << address;
    EXPECT_FALSE(asked) << "an answer without a transfer";
  }

  // 31:16 pairs refused, 15:0 pairs given
  uint32_t pairs() {
    send({'S'});
    const Bytes bytes = answer(5);
    EXPECT_EQ(bytes.empty() ? 0 : bytes[0], 's');
    return word(bytes);
  }

  // The next commands work, and there was no transfer but theirs since the last time.
  void works() {
    EXPECT_EQ(accesses, 0u);
    EXPECT_EQ(read(reg_id), 0x43415053u);
    const auto data = static_cast<uint32_t>(edge * 0x9E3779B9u);
    write(reg_soft_u, data);
    EXPECT_EQ(read(reg_soft_u), data);
    accesses = 0;
  }

  VerilatedContext context;
  Vboard_bench top{&context};
  SerialLine line{clocks_per_bit};
  Converter converter{GetParam(), [this](unsigned channel) { return code_of(channel); }};
  std::optional<Follower> follower;
  uint64_t edge = 0;
  double angle = 0, turns_a_sample = 0.0309;
  std::array<std::deque<uint16_t>, 2> codes;  // instead of the sensor's
  std::optional<Access> asked;
  bool any_access = false;
  uint32_t last_read = 0;
  unsigned accesses = 0, samples = 0, refused = 0, framing_errors = 0;
  struct {
    bool selected, enabled, ready, write;
    uint32_t address;
  } apb = {};  // of the coprocessor, in the interval before
};

TEST_P(Board, LearnsTheSensorAsTheModelDoes) {
  EXPECT_TRUE(top.wifi_gpio0);
  for (uint32_t step = reg_step_au; step <= reg_step_cv; step += 4) write(step, 0x0A000000);
  write(reg_turn_limit, 1000);
  write(reg_lock_threshold, 1u << 24);  // above the errors of 12 bits
  write(reg_ctrl, ctrl_demod | ctrl_calib | angle_source | ctrl_adc | ctrl_ie_result);
  const unsigned ignored = follower->refused();  // CTRL.ADC was 0
  constexpr uint64_t seed = 3;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937_64 random(seed);
  while (follower->taken() < 600 && !HasFailure()) {
    const auto address = static_cast<uint32_t>(4 * (random() % (reg_last / 4 + 1)));
    if (is_register(address)) read(address);
    if (random() % 4 == 0) write(reg_flags, flag_writable);
    clocks(static_cast<unsigned>(random() % 1000));
  }
  EXPECT_EQ(follower->refused(), ignored);
  write(reg_ctrl, ctrl_calib | angle_source);
  samples_come(1);
  for (uint32_t address = 0; address <= reg_last; address += 4)
    if (is_register(address)) read(address);
  EXPECT_EQ(read(reg_samples), follower->taken());
  EXPECT_EQ(pairs() >> 16, 0u);
  // The sensor's own numbers, of which the model knows nothing.
  const auto value = [&](uint32_t address) {
    return std::ldexp(static_cast<int32_t>(read(address)), -31);
  };
  EXPECT_NEAR(value(reg_a1), gain_u, 0.01);
  EXPECT_NEAR(value(reg_a2), gain_v, 0.01);
  EXPECT_NEAR(value(reg_b1), offset_u, 0.01);
  EXPECT_NEAR(value(reg_b2), offset_v, 0.01);
  EXPECT_EQ(status_of_leds(), status_lock | status_valid);
  EXPECT_EQ(top.led >> 6, 0);
}

TEST_P(Board, EachLedShowsItsBitOfStatus) {
  write(reg_ctrl, ctrl_calib | angle_source);
  EXPECT_EQ(status_of_leds(), 0u);
  const auto one_sample = [&] {
    write(reg_ctrl, ctrl_calib | angle_source | ctrl_adc);
    samples_come(1);
    write(reg_ctrl, ctrl_calib | angle_source);
  };
  one_sample();
  EXPECT_EQ(status_of_leds(), status_valid);
  write(reg_diverge_threshold, 0);
  write(reg_ctrl, ctrl_calib | angle_source | ctrl_adc);
  samples_come(64);
  write(reg_ctrl, ctrl_calib | angle_source);
  EXPECT_EQ(status_of_leds(), status_valid | status_diverged);
  write(reg_diverge_threshold, 1u << 31);
  codes[0].assign(20, 4095);
  codes[1].assign(20, 2048);
  write(reg_ctrl, ctrl_calib | angle_source | ctrl_adc);
  while (!codes[1].empty() && !HasFailure()) clock();
  write(reg_ctrl, ctrl_calib | angle_source);
  EXPECT_EQ(status_of_leds(), status_valid | status_alarm);
}

TEST_P(Board, EveryCodeIsTheWordOfAnIdealConverter) {
  write(reg_ctrl, ctrl_adc);
  for (unsigned code = 0; code < 4096; code += code < 4 || code > 4090 ? 1 : 31) {
    codes[0].push_back(static_cast<uint16_t>(code));
    codes[1].push_back(static_cast<uint16_t>(4095 - code));
  }
  while (!codes[1].empty() && !HasFailure()) clock();
  samples_come(1);
}

TEST_P(Board, ACodeAtARailIsClipped) {
  write(reg_ctrl, ctrl_adc);
  samples_come(2);
  write(reg_flags, flag_writable);
  bool lit = false;
  for (const auto& [u, v, clips] : {std::tuple{1, 4094, false},
                                    {0, 2048, true},
                                    {4095, 2048, true},
                                    {2048, 0, true},
                                    {2048, 4095, true}}) {
    codes[0].push_back(static_cast<uint16_t>(u));
    codes[1].push_back(static_cast<uint16_t>(v));
    while (!codes[1].empty() && !HasFailure()) clock();
    samples_come(1);
    clocks(200);
    EXPECT_EQ((read(reg_flags) & flag_clip) != 0, clips) << u << " " << v;
    lit = lit || clips;  // for 255 pairs
    EXPECT_EQ(top.led >> 6 & 1, lit) << u << " " << v;
    write(reg_flags, flag_writable);
  }
  EXPECT_EQ(top.led >> 6 & 1, 1);
  samples_come(256);
  EXPECT_EQ(top.led >> 6 & 1, 0);
}

TEST_P(Board, AnAnswerOfAnotherChannelGivesNoSample) {
  write(reg_ctrl, ctrl_adc);
  samples_come(3);
  for (unsigned which = 0; which < 4; ++which) {
    for (unsigned bit = 12; bit < 16; ++bit) {
      samples_come(1);
      converter.disturb(which, static_cast<uint16_t>(1u << bit));
      const unsigned samples_before = samples, refused_before = refused;
      while (samples + refused == samples_before + refused_before && !HasFailure()) clock();
      // Of the answers to a pair's commands, the one to the last of the pair before counts for
      // nothing.
      const unsigned counts = GetParam() == 1 ? which >= 1 : which <= 2;
      EXPECT_EQ(refused, refused_before + counts) << "answer " << which << " bit " << bit;
      EXPECT_EQ(samples, samples_before + 1 - counts) << "answer " << which << " bit " << bit;
    }
  }
  samples_come(1);
  EXPECT_EQ(pairs(), refused << 16 | samples);
  write(reg_ctrl, 0);
  clocks(170);
  EXPECT_EQ(read(reg_samples), follower->taken());
  EXPECT_EQ(top.led >> 7, 1);
}

TEST_P(Board, WithoutAConverterThereIsNoSample) {
  for (const bool value : {false, true}) {
    converter.stick(value);
    const unsigned before = samples, refused_before = refused;
    clocks(5 * sample_clocks);
    EXPECT_EQ(samples, before);
    EXPECT_GE(refused, refused_before + 4);
    EXPECT_EQ(top.led >> 7, 1);
  }
  converter.stick({});
  samples_come(2);
}

TEST_P(Board, TheResetButtonResetsAll) {
  write(reg_soft_u, 5);
  converter.stick(true);
  clocks(3 * sample_clocks);
  EXPECT_EQ(top.led >> 7, 1);
  converter.stick({});
  samples_come(130);  // LED 5
  const unsigned resets = converter.resets();
  while (!top.adc_csn && !HasFailure()) clock();  // not within a frame
  reset();
  EXPECT_EQ(top.led, 0);
  EXPECT_EQ(read(reg_soft_u), 0u);
  samples_come(2);
  EXPECT_EQ(converter.resets(), resets + 2);
}

TEST_P(Board, AnAddressWithoutARegisterIsAnError) {
  for (const uint32_t address : {0x0E8u, 0x002u, 0x100u, 0xFFCu}) {
    asked = Access{false, address, 0, 0, true};
    send(read_command(address));
    EXPECT_EQ(answer(2), (Bytes{'e', no_register})) << address;
    asked = Access{true, address, 7, 15, true};
    send(write_command(address, 7));
    EXPECT_EQ(answer(2), (Bytes{'e', no_register})) << address;
  }
  // Above the window: no transfer at all.
  for (const uint32_t address : {0x1000u, 0x8008u}) {
    send(read_command(address));
    EXPECT_EQ(answer(2), (Bytes{'e', no_register})) << address;
    send(write_command(address, 7));
    EXPECT_EQ(answer(2), (Bytes{'e', no_register})) << address;
  }
  accesses = 0;
  works();
}

TEST_P(Board, RubbishIsOneErrorAndNoTransfer) {
  Bytes bytes{'x'};
  for (const uint8_t byte : write_command(reg_soft_u, 0x57575757)) bytes.push_back(byte);
  for (const uint8_t byte : read_command(reg_id)) bytes.push_back(byte);
  send(bytes);
  EXPECT_EQ(answers(), (std::vector<Bytes>{{'e', no_command}}));
  works();
}

TEST_P(Board, AFramingErrorDropsTheCommand) {
  const Bytes bytes = write_command(reg_soft_u, 0x57005257);
  for (std::size_t broken = 0; broken < bytes.size(); ++broken) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      line.send(bytes[i], i != broken);
      if (i == broken) line.level(true, 2 * clocks_per_bit);
    }
    EXPECT_EQ(answers(), (std::vector<Bytes>{{'e', framing}})) << "byte " << broken;
    works();
  }
  const unsigned before = framing_errors;
  line.level(false, 3 * quiet_clocks);  // a break
  while (line.sending() && !HasFailure()) clock();
  EXPECT_EQ(answers(), (std::vector<Bytes>{{'e', framing}}));
  EXPECT_EQ(framing_errors, before + 1) << "a break is one framing error";
  works();
}

TEST_P(Board, AHalfCommandIsDropped) {
  const Bytes bytes = write_command(reg_soft_u, 0x52575352);
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    send(Bytes(bytes.begin(), bytes.begin() + static_cast<int>(size)));
    EXPECT_TRUE(answers().empty());
    works();
  }
  // Bytes with pauses below the limit are one command.
  asked = Access{true, reg_soft_u, 3, 15, false};
  for (const uint8_t byte : write_command(reg_soft_u, 3)) {
    line.send(byte);
    line.level(true, quiet_clocks - 20);
  }
  EXPECT_EQ(answers(), (std::vector<Bytes>{{'w'}}));
}

TEST_P(Board, AByteDuringAnAnswerIsAnError) {
  asked = Access{false, reg_id, 0, 0, false};
  send(read_command(reg_id));
  send(write_command(reg_soft_u, 0x57575757));
  EXPECT_EQ(answers(), (std::vector<Bytes>{{'r', 0x43, 0x41, 0x50, 0x53}, {'e', overrun}}));
  EXPECT_EQ(accesses, 1u);
  accesses = 0;
  works();
}

TEST_P(Board, NoiseOnTheIdleLineIsNoByte) {
  line.level(false, clocks_per_bit / 2 - 2);
  EXPECT_TRUE(answers().empty());
  works();
}

TEST_P(Board, NoBytesMakeItHang) {
  constexpr uint64_t seed = 5;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937_64 random(seed);
  any_access = true;
  constexpr char likely[] = "RWS";
  for (int burst = 0; burst < 60 && !HasFailure(); ++burst) {
    for (uint64_t left = 1 + random() % 12; left > 0; --left) {
      const bool command = random() % 3 == 0;
      const auto byte = static_cast<uint8_t>(command             ? likely[random() % 3]
                                             : random() % 4 == 0 ? random()
                                                                 : 0);
      line.send(byte, random() % 16 != 0);
      line.level(true,
                 static_cast<unsigned>(random() % (random() % 4 == 0 ? 2 * quiet_clocks : 12)));
    }
    answers();
    send(read_command(reg_id));
    EXPECT_EQ(answer(5), (Bytes{'r', 0x43, 0x41, 0x50, 0x53})) << "burst " << burst;
  }
}

INSTANTIATE_TEST_SUITE_P(AnswersLater, Board, ::testing::Values(1u, 2u), [](const auto& one) {
  return "by" + std::to_string(one.param) + "Frames";
});

}  // namespace
}  // namespace capsoc::rtl_board_test
