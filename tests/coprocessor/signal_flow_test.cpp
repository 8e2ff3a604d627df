// The table of what nodes are made from, against the model: every input of random samples is
// changed, and what changes with it is compared with what the table lets it reach.
#include "coprocessor/signal_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "coprocessor/coprocessor.h"

namespace capsoc::coprocessor::test {
namespace {

struct Sample {
  int32_t u = 0, v = 0;
  bool clip = false;
};

/// One sample in a state.
struct Case {
  IdleState state;
  Sample sample;
  bool plain_arctangent = false;  // of paper: does not settle for short vectors
};

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  uint64_t pick(uint64_t bound) { return random_() % bound; }
  /// Of any size; often at an end of its range.
  int64_t word(unsigned bits) {
    const auto any = static_cast<int64_t>(random_() << (64 - bits)) >> (64 - bits);
    if (pick(8) == 0) return any < 0 ? -(int64_t{1} << (bits - 1)) : (int64_t{1} << (bits - 1)) - 1;
    return pick(2) == 0 ? any >> pick(bits) : any;
  }
  /// Some bits of it, at least one, are inverted.
  template <typename T>
  void change(T& value, unsigned bits) {
    value = static_cast<T>(static_cast<uint64_t>(value) ^ uint64_t{1} << pick(bits));
  }
  template <typename T>
  void change_signed(T& value, unsigned bits) {
    const uint64_t changed = static_cast<uint64_t>(value) ^ uint64_t { 1 } << pick(bits);
    value = static_cast<T>(static_cast<int64_t>(changed << (64 - bits)) >> (64 - bits));
  }

 private:
  std::mt19937_64 random_;
};

class SignalFlow : public testing::TestWithParam<Arithmetic> {
 protected:
  bool is_paper() const { return GetParam() == Arithmetic::paper; }
  unsigned weight_step() const { return is_paper() ? 15 : 0; }

  int64_t weight() { return (random_.word(48) >> weight_step()) * (int64_t{1} << weight_step()); }
  Weights weights() { return {weight(), weight(), weight()}; }

  /// A state that software can bring about, mostly near a locked one: elsewhere everything is
  /// saturated.
  Case draw(bool is_watched) {
    Coprocessor fresh({GetParam()});
    Case drawn;
    EXPECT_TRUE(fresh.save_idle(drawn.state));
    IdleState& s = drawn.state;
    s.ctrl = static_cast<uint32_t>(random_.pick(ctrl_ie_safety << 1)) &
             ~uint32_t{ctrl_block | ctrl_correct};
    if (!is_paper())
      s.ctrl |= static_cast<uint32_t>(random_.pick(2)) * ctrl_block |
                static_cast<uint32_t>(random_.pick(2)) * ctrl_correct;
    s.ctrl = (s.ctrl & ~uint32_t{ctrl_ref_mask}) | ctrl_adc |
             static_cast<uint32_t>(random_.pick(3)) << ctrl_ref_shift;
    s.flags = static_cast<uint32_t>(random_.pick(1U << flags_safety_shift));
    if (is_watched) {
      s.safety = static_cast<uint32_t>(random_.word(32)) & safety_writable;
      if (random_.pick(2) == 0) s.flags |= static_cast<uint32_t>(random_.pick(2)) * flag_misfit;
      s.unfit = random_.pick(2) * parity_bit(reg_loop);
    }
    const bool is_wild = random_.pick(3) == 0;
    auto& c = s.state.coefficients;
    if (is_wild) {
      c = {weights(), weights()};
    } else {
      const auto near = [&](double value) {
        const auto word = static_cast<int64_t>(value * 0x1p46) + random_.word(40);
        return (word >> weight_step()) * (int64_t{1} << weight_step());
      };
      c = {{near(0.6), near(0.05), near(0.1)},
           {near(random_.pick(4) == 0 ? 0.1 : -0.1), near(random_.pick(4) == 0 ? -0.6 : 0.6),
            near(0.2)}};
    }
    s.state.block.sums = {weights(), weights()};
    s.state.block.open = random_.pick(2) != 0;
    s.state.block.begun = s.state.block.open && random_.pick(2) != 0;
    s.state.block.window_ended = random_.pick(2) != 0;
    Parameters& p = s.state.parameters;
    p = {static_cast<int32_t>(random_.word(32)) & INT32_MAX,
         static_cast<int32_t>(random_.word(32)) & INT32_MAX,
         static_cast<int32_t>(random_.word(32)),
         static_cast<int32_t>(random_.word(32)),
         static_cast<uint32_t>(random_.word(32)),
         static_cast<uint32_t>(random_.word(32))};
    s.state.reference = {static_cast<uint64_t>(random_.word(48)) & phase_mask, random_.word(48)};
    s.state.error_sum_u = random_.pick(uint64_t{1} << 37);
    s.state.error_sum_v = random_.pick(uint64_t{1} << 37);
    for (Steps* steps : {&s.settings.steps_u, &s.settings.steps_v})
      *steps = {static_cast<uint32_t>(random_.pick(1U << 31)),
                static_cast<uint32_t>(random_.pick(1U << 31)),
                static_cast<uint32_t>(random_.pick(1U << 31))};
    s.lock_threshold = static_cast<uint32_t>(random_.word(31));
    s.diverge_threshold = static_cast<uint32_t>(random_.word(31));
    s.settled = static_cast<unsigned>(random_.pick(2) == 0 ? 64 : 60 + random_.pick(4));
    s.judge_settings = {static_cast<uint32_t>(random_.pick(256)),
                        static_cast<uint32_t>(random_.pick(256)),
                        static_cast<unsigned>(random_.pick(4)), random_.pick(2) != 0,
                        static_cast<uint32_t>(random_.pick(8))};
    s.settings.kp = static_cast<unsigned>(random_.pick(31));
    s.settings.ki = static_cast<unsigned>(random_.pick(31));
    s.settings.slew = static_cast<unsigned>(random_.pick(8));
    draw_judge(s.judge);
    for (int32_t& node : s.corrections) node = static_cast<int32_t>(random_.word(20));
    drawn.sample = {static_cast<int32_t>(random_.word(32)), static_cast<int32_t>(random_.word(32)),
                    random_.pick(2) != 0};
    if (random_.pick(16) == 0) make_zero(drawn);
    drawn.plain_arctangent = random_.pick(2) != 0;
    apply_ctrl(s);
    return drawn;
  }

  void draw_judge(TurnJudge& judge) {
    judge.glitches =
        static_cast<unsigned>(random_.pick(2) == 0 ? random_.pick(17) : 15 * random_.pick(2));
    judge.alarm = random_.pick(2) != 0;
    judge.good_turns = static_cast<unsigned>(random_.pick(4));
    judge.turn_count = static_cast<uint8_t>(random_.pick(256));
    judge.any = true;
    judge.last_angle = static_cast<uint32_t>(random_.word(32));
    judge.window.samples = static_cast<uint32_t>(random_.pick(8));
    judge.window.winding = static_cast<int32_t>(random_.word(32));
    judge.window.flags =
        static_cast<uint32_t>(random_.pick(4) == 0 ? 0xFF : random_.pick(1U << 16));
    judge.last.flags = static_cast<uint32_t>(random_.pick(1U << 24));
    judge.wild = random_.pick(2) != 0;
  }

  /// Without a vector: the sample is the offset.
  static void make_zero(Case& drawn) {
    drawn.state.state.parameters.b1 = drawn.sample.u;
    drawn.state.state.parameters.b2 = drawn.sample.v;
    drawn.state.state.coefficients.u.constant = int64_t{drawn.sample.u} * 32768;
    drawn.state.state.coefficients.v.constant = int64_t{drawn.sample.v} * 32768;
  }

  /// The settings as CTRL says.
  static void apply_ctrl(IdleState& s) {
    s.settings.demodulate = (s.ctrl & ctrl_demod) != 0;
    s.settings.source = static_cast<ReferenceSource>((s.ctrl & ctrl_ref_mask) >> ctrl_ref_shift);
    s.settings.block = (s.ctrl & ctrl_block) != 0;
    s.settings.guard = (s.ctrl & ctrl_guard) != 0;
    s.settings.correct = (s.ctrl & ctrl_correct) != 0;
  }

  Nodes nodes_of(const Case& given) const {
    Options options{GetParam()};
    options.paper_plain_arctangent = given.plain_arctangent;
    Coprocessor dut(options);
    dut.load_idle(given.state);
    const uint64_t cycle = given.state.cycle + 1;
    EXPECT_TRUE(dut.submit(cycle, given.sample.u, given.sample.v, given.sample.clip));
    dut.advance(cycle + latency_cycles);
    return dut.nodes();
  }

  using Change = std::function<void(Case&)>;
  void toggle(Case& c, uint32_t mask) {
    c.state.ctrl ^= mask;
    apply_ctrl(c.state);
  }

  /// Input -> how to change it.
  std::map<std::string, Change> changes(bool is_watched) {
    std::map<std::string, Change> all;
    const auto weight = [&](const char* name, auto member) {
      all[name] = [this, member](Case& c) {
        int64_t& value = member(c.state.state.coefficients);
        value >>= weight_step();
        random_.change_signed(value, 48 - weight_step());
        value *= int64_t{1} << weight_step();
      };
    };
    weight("AU", [](Coefficients& c) -> int64_t& { return c.u.sine; });
    weight("BU", [](Coefficients& c) -> int64_t& { return c.u.cosine; });
    weight("CU", [](Coefficients& c) -> int64_t& { return c.u.constant; });
    weight("AV", [](Coefficients& c) -> int64_t& { return c.v.sine; });
    weight("BV", [](Coefficients& c) -> int64_t& { return c.v.cosine; });
    weight("CV", [](Coefficients& c) -> int64_t& { return c.v.constant; });
    const auto word = [&](const char* name, auto member, unsigned bits = 32) {
      all[name] = [this, member, bits](Case& c) { random_.change(member(c), bits); };
    };
    word("sample.sin", [](Case& c) -> int32_t& { return c.sample.u; });
    word("sample.cos", [](Case& c) -> int32_t& { return c.sample.v; });
    all["sample.clip"] = [](Case& c) { c.sample.clip = !c.sample.clip; };
    word(
        "A1", [](Case& c) -> int32_t& { return c.state.state.parameters.a1; }, 31);
    word(
        "A2", [](Case& c) -> int32_t& { return c.state.state.parameters.a2; }, 31);
    word("B1", [](Case& c) -> int32_t& { return c.state.state.parameters.b1; });
    word("B2", [](Case& c) -> int32_t& { return c.state.state.parameters.b2; });
    word("BETA", [](Case& c) -> uint32_t& { return c.state.state.parameters.beta; });
    word("PHI", [](Case& c) -> uint32_t& { return c.state.state.parameters.phi; });
    word(
        "PHASE", [](Case& c) -> uint64_t& { return c.state.state.reference.phase; }, 48);
    all["FREQ"] = [this](Case& c) { random_.change_signed(c.state.state.reference.frequency, 48); };
    const auto step = [&](const char* name, auto member) { word(name, member, 31); };
    step("STEP_AU", [](Case& c) -> uint32_t& { return c.state.settings.steps_u.sine; });
    step("STEP_BU", [](Case& c) -> uint32_t& { return c.state.settings.steps_u.cosine; });
    step("STEP_CU", [](Case& c) -> uint32_t& { return c.state.settings.steps_u.constant; });
    step("STEP_AV", [](Case& c) -> uint32_t& { return c.state.settings.steps_v.sine; });
    step("STEP_BV", [](Case& c) -> uint32_t& { return c.state.settings.steps_v.cosine; });
    step("STEP_CV", [](Case& c) -> uint32_t& { return c.state.settings.steps_v.constant; });
    all["CTRL.DEMOD"] = [this](Case& c) { toggle(c, ctrl_demod); };
    all["CTRL.CALIB"] = [this](Case& c) { toggle(c, ctrl_calib); };
    all["CTRL.FREEZE"] = [this](Case& c) { toggle(c, ctrl_freeze); };
    all["CTRL.BLOCK"] = [this](Case& c) { toggle(c, ctrl_block); };
    all["CTRL.GUARD"] = [this](Case& c) { toggle(c, ctrl_guard); };
    all["CTRL.CORRECT"] = [this](Case& c) { toggle(c, ctrl_correct); };
    all["CTRL.REF"] = [this](Case& c) {
      const uint32_t before = (c.state.ctrl & ctrl_ref_mask) >> ctrl_ref_shift;
      const auto other = static_cast<uint32_t>((before + 1 + random_.pick(2)) % 3);
      toggle(c, (before ^ other) << ctrl_ref_shift);
    };
    all["LOOP.KP"] = [this](Case& c) {
      c.state.settings.kp = static_cast<unsigned>(random_.pick(31));
    };
    all["LOOP.KI"] = [this](Case& c) {
      c.state.settings.ki = static_cast<unsigned>(random_.pick(31));
    };
    all["JUDGE.SLEW"] = [this](Case& c) {
      c.state.settings.slew = static_cast<unsigned>(random_.pick(8));
    };
    all["JUDGE.RADIUS_LIMIT"] = [this](Case& c) {
      random_.change(c.state.judge_settings.radius_limit, 8);
    };
    all["JUDGE.ALARM_LIMIT"] = [this](Case& c) {
      random_.change(c.state.judge_settings.alarm_limit, 8);
    };
    all["JUDGE.TURNS"] = [this](Case& c) { random_.change(c.state.judge_settings.turns, 2); };
    all["JUDGE.COUNT"] = [](Case& c) {
      c.state.judge_settings.count = !c.state.judge_settings.count;
    };
    all["TURN_LIMIT"] = [this](Case& c) { random_.change(c.state.judge_settings.turn_limit, 3); };
    all["LOCK_THRESHOLD"] = [this](Case& c) {
      c.state.lock_threshold = static_cast<uint32_t>(random_.word(31));
    };
    all["DIVERGE_THRESHOLD"] = [this](Case& c) {
      c.state.diverge_threshold = static_cast<uint32_t>(random_.word(31));
    };
    word(
        "FLAGS", [](Case& c) -> uint32_t& { return c.state.flags; },
        is_watched ? flag_count : flags_safety_shift);
    all["STATUS"] = [this](Case& c) {
      (random_.pick(2) == 0 ? c.state.results.lock : c.state.results.mirror) ^= true;
    };
    word("ANGLE", [](Case& c) -> uint32_t& { return c.state.results.angle; });
    word("SAMPLES", [](Case& c) -> uint32_t& { return c.state.samples; });
    all["TURN_FLAGS"] = [this](Case& c) {
      if (random_.pick(8) == 0)
        random_.change(c.state.judge.turn_count, 8);
      else
        random_.change(c.state.judge.last.flags, 24);
    };
    all["state.error_sums"] = [this](Case& c) {
      random_.change(random_.pick(2) == 0 ? c.state.state.error_sum_u : c.state.state.error_sum_v,
                     37);
    };
    all["state.settled"] = [](Case& c) { c.state.settled = c.state.settled == 64 ? 10 : 64; };
    all["state.corrections"] = [this](Case& c) {
      for (int32_t& node : c.state.corrections) node = static_cast<int32_t>(random_.word(20));
    };
    all["state.block"] = [this](Case& c) {
      BlockLearning& block = c.state.state.block;
      if (random_.pick(2) == 0)
        block.sums = {weights(), weights()};
      else
        block.open = block.begun = !block.begun, block.window_ended = random_.pick(2) != 0;
    };
    all["state.judge"] = [this](Case& c) {
      const uint8_t turn_count = c.state.judge.turn_count;
      const uint32_t last_flags = c.state.judge.last.flags;
      draw_judge(c.state.judge);
      c.state.judge.turn_count = turn_count;
      c.state.judge.last.flags = last_flags;
    };
    if (is_watched) {
      all["SAFETY"] = [this](Case& c) {
        c.state.safety ^= safety_writable & static_cast<uint32_t>(random_.word(32));
      };
      all["state.parity"] = [](Case& c) { c.state.unfit ^= parity_bit(reg_loop); };
    }
    if (is_paper())
      for (const char* name :
           {"CTRL.BLOCK", "CTRL.GUARD", "CTRL.CORRECT", "state.block", "state.corrections"})
        all.erase(name);
    return all;
  }

  void compare_with_model(bool is_watched);

  Random random_{20261127};
};

TEST_P(SignalFlow, EveryNodeHasALineAndNoneIsMadeFromItself) {
  for (std::size_t i = 0; i < node_count; ++i) {
    const MadeFrom& made = signal_flow(GetParam(), true)[i];
    ASSERT_EQ(made.node, &node_names()[i]) << node_names()[i].name;
    for (const std::string& source : made.sources) {
      const auto index = node_index(source);
      if (!index) continue;
      const auto nodes = origin_of(*index, GetParam(), true).nodes;
      EXPECT_EQ(std::find(nodes.begin(), nodes.end(), i), nodes.end()) << source;
    }
  }
}

TEST_P(SignalFlow, NamesEachNodeBeforeWhatItIsMadeFrom) {
  const std::vector<std::size_t> nodes =
      origin_of(node_index("status").value(), GetParam(), true).nodes;
  for (std::size_t at = 0; at < nodes.size(); ++at) {
    const auto later = nodes.begin() + static_cast<std::ptrdiff_t>(at);
    for (const std::string& source : signal_flow(GetParam(), true)[nodes[at]].sources) {
      const auto index = node_index(source);
      if (!index) continue;
      EXPECT_NE(std::find(later, nodes.end(), *index), nodes.end()) << source;
    }
  }
}

void SignalFlow::compare_with_model(bool is_watched) {
  const auto all = changes(is_watched);
  std::set<std::string> inputs;
  std::map<std::string, std::set<std::size_t>> reached;  // by an input
  std::set<std::pair<std::string, std::size_t>> direct, seen;
  for (std::size_t i = 0; i < node_count; ++i) {
    for (const std::string& input : origin_of(i, GetParam(), is_watched).inputs)
      reached[input].insert(i);
    for (const std::string& source : signal_flow(GetParam(), is_watched)[i].sources)
      if (!node_index(source)) direct.emplace(source, i);
  }
  for (const auto& [input, nodes] : reached) ASSERT_TRUE(all.count(input) == 1) << input;
  constexpr int rounds = 3000;
  for (int round = 0; round < rounds; ++round) {
    const Case given = draw(is_watched);
    const Nodes before = nodes_of(given);
    for (const auto& [input, change] : all) {
      Case changed = given;
      change(changed);
      const Nodes after = nodes_of(changed);
      for (std::size_t i = 0; i < node_count; ++i) {
        const NamedNode& node = node_names()[i];
        if (before.*node.value == after.*node.value) continue;
        ASSERT_TRUE(reached[input].count(i) == 1)
            << input << " changes " << node.name << ", round " << round;
        seen.emplace(input, i);
      }
    }
  }
  // PHI is taken off the relative angle and added again.
  if (is_paper()) direct.erase({"PHI", node_index("found_angle").value()});
  for (const auto& [input, node] : direct)
    EXPECT_TRUE(seen.count({input, node}) == 1)
        << input << " never changes " << node_names()[node].name;
}

TEST_P(SignalFlow, IsWhatTheModelDoes) {
  compare_with_model(false);
}

TEST_P(SignalFlow, IsWhatTheModelDoesWithItsSafetyMechanisms) {
  compare_with_model(true);
}

INSTANTIATE_TEST_SUITE_P(Coprocessor, SignalFlow,
                         testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& suite) {
                           return suite.param == Arithmetic::paper ? "Paper" : "Precise";
                         });

TEST(Origin, LeadsFromTheAngleToTheSample) {
  const Origin origin = origin_of(node_index("angle").value(), Arithmetic::precise, false);
  EXPECT_EQ(node_names()[origin.nodes.front()].name, std::string("angle"));
  for (const char* input : {"sample.sin", "sample.cos", "AU", "CV", "CTRL.CALIB"})
    EXPECT_NE(std::find(origin.inputs.begin(), origin.inputs.end(), input), origin.inputs.end())
        << input;
  for (const char* input : {"LOCK_THRESHOLD", "state.judge", "SAFETY", "state.parity"})
    EXPECT_EQ(std::find(origin.inputs.begin(), origin.inputs.end(), input), origin.inputs.end())
        << input;
  const Origin watched = origin_of(node_index("angle").value(), Arithmetic::precise, true);
  for (const char* input : {"SAFETY", "state.parity", "state.judge"})
    EXPECT_NE(std::find(watched.inputs.begin(), watched.inputs.end(), input), watched.inputs.end())
        << input;
}

}  // namespace
}  // namespace capsoc::coprocessor::test
