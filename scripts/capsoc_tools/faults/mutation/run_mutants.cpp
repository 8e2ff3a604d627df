// Compares every mutant with the model's answers to the regression's stimulus.
//
// usage: run_mutants LIBRARY precise|paper COUNT [--samples N] [--accesses N] [--seed N] [--jobs N]
//                    [--first N] [--edges N] [--known FILE] [--scenarios NAME,NAME...]
// --known: what an earlier run printed; mutants killed there, or marked as equivalent, are not
// tried again. --scenarios: only these.
//
// One line each on stdout: number, "killed" or "survived", scenario and edge of the first
// difference, what differed. Mutant 0, the RTL as it is, must survive: status 1 if it does not.
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/splitmix64.h"
#include "mutants_abi.h"
#include "regress/bench.h"
#include "regress/recording.h"
#include "regress/scenario.h"

namespace {

using namespace capsoc;
using namespace capsoc::regress;

struct Arguments {
  std::string library;
  coprocessor::Options options;
  unsigned count = 0, jobs = 1;
  uint64_t seed = 1;
  Budget budget{2000, 2000};
  unsigned first = 0;
  uint64_t edges = 0;     // of each scenario; 0: all of them
  std::string known;      // what an earlier run printed
  std::string scenarios;  // names with commas between; empty: all of them
};

struct Named {
  const char* name;
  Recording recording;
};

/// Keeps what happens in the first `edges` edges.
void shorten(Recording& recording, uint64_t edges) {
  auto& events = recording.events;
  const auto late = [edges](const Event& event) { return event.edge > edges; };
  if (edges != 0) events.erase(std::find_if(events.begin(), events.end(), late), events.end());
}

bool chosen(const std::string& names, const char* name) {
  return names.empty() || ("," + names + ",").find(fmt::format(",{},", name)) != std::string::npos;
}

/// The regression's stimulus.
std::vector<Named> record(const Arguments& arguments) {
  std::vector<Named> result;
  for (const Scenario& scenario : scenarios()) {
    if (!chosen(arguments.scenarios, scenario.name)) continue;
    result.push_back({scenario.name, {}});
    Recorder recorder(arguments.options, result.back().recording);
    Coverage coverage(arguments.options.arithmetic);
    Bench bench(recorder, arguments.options.arithmetic, coverage, [] { return false; });
    Random random(arguments.seed, static_cast<uint64_t>(&scenario - scenarios().data()));
    scenario.run(bench, random,
                 {arguments.budget.samples * scenario.sample_share / 1000,
                  arguments.budget.accesses * scenario.access_share / 1000});
    bench.drain();
    bench.wait(2);
    recorder.close();
    shorten(result.back().recording, arguments.edges);
  }
  // What costs least goes first: few mutants are left when the long ones begin.
  const auto edges = [](const Named& named) {
    const auto& events = named.recording.events;
    return events.empty() ? 0 : events.back().edge;
  };
  std::stable_sort(result.begin(), result.end(),
                   [&](const Named& a, const Named& b) { return edges(a) < edges(b); });
  return result;
}

/// One recording at the pins of one mutant.
class Replay {
 public:
  Replay(const capsoc_mutants_api& api, capsoc_mutants* mutant, const Recording& recording)
      : api_(api), mutant_(mutant), pins_(*api.pins(mutant)), recording_(recording) {}

  /// What differed first; empty if nothing did.
  std::string run() {
    pins_ = {};
    api_.clock(mutant_);
    pins_.presetn = 1;
    api_.eval(mutant_);
    const auto& events = recording_.events;
    for (size_t i = 0; i < events.size() && difference_.empty();) {
      size_t end = i;
      while (end < events.size() && events[end].edge == events[i].edge) ++end;
      go_to(events[i].edge, i, end);
      if (difference_.empty()) after(i, end);
      i = end;
    }
    return difference_;
  }
  uint64_t edge() const { return now_; }

 private:
  void differ(std::string what) {
    if (difference_.empty()) difference_ = std::move(what);
  }

  void clock() {
    api_.clock(mutant_);
    ++now_;
    pins_.psel = pins_.penable = pins_.pwrite = pins_.sample_valid = 0;
  }

  void check_level() {
    if ((pins_.irq != 0) != interrupt_) differ("interrupt");
    if ((pins_.idle != 0) != idle_) differ("idle");
  }

  // What must have no effect on a bus: setup phases, writes of a part of a word, transfers to
  // another slave, samples' words without their strobe.
  void disturb() {
    const uint64_t noise = splitmix64(now_);
    if ((noise >> 56) % 8 != 0) return;
    pins_.pwrite = noise & 1;
    pins_.paddr = static_cast<uint16_t>((noise >> 1) & 0xFC);
    pins_.pwdata = static_cast<uint32_t>(noise >> 32);
    pins_.sample_u = static_cast<uint32_t>(noise >> 8);
    pins_.sample_v = static_cast<uint32_t>(noise >> 16);
    pins_.sample_clip = noise >> 9 & 1;
    pins_.pstrb = noise >> 10 & 15;
    switch (noise >> 14 & 3) {
      case 0:
        pins_.psel = 1;
        break;
      case 1:
        pins_.penable = 1;
        break;
      case 2:
        if (pins_.pstrb == 15) pins_.pstrb = 7;
        pins_.psel = pins_.penable = pins_.pwrite = 1;
        api_.eval(mutant_);
        if (pins_.pslverr == 0) differ("pslverr of a partial write");
        break;
      default:
        break;
    }
    if (pins_.psel != 0 && pins_.penable != 0) return;
    api_.eval(mutant_);
    if (pins_.pslverr != 0) differ("pslverr without a transfer");
  }

  // Up to edge `edge`, with what the events [begin, end) drive at it.
  void go_to(uint64_t edge, size_t begin, size_t end) {
    if (now_ >= edge) return;
    while (now_ + 1 < edge && difference_.empty()) {
      if (pins_.psel == 0) disturb();
      clock();
      check_level();
      if (idle_ && quiet_++ > 2 && difference_.empty()) now_ = edge - 1;
      if (!idle_) quiet_ = 0;
    }
    quiet_ = 0;
    for (size_t i = begin; i < end; ++i) drive(recording_.events[i]);
    if (!difference_.empty()) return;
    clock();
    for (size_t i = begin; i < end; ++i) {
      const Event& event = recording_.events[i];
      if (event.kind == Event::Kind::level) {
        interrupt_ = event.flag;
        idle_ = event.answer;
      }
      if (event.kind != Event::Kind::reset) continue;
      pins_.presetn = 0;
      api_.eval(mutant_);
      pins_.presetn = 1;
      api_.eval(mutant_);
    }
    check_level();
  }

  void drive(const Event& event) {
    if (event.kind == Event::Kind::sample) {
      pins_.sample_valid = 1;
      pins_.sample_u = event.offset_or_u;
      pins_.sample_v = event.value_or_v;
      pins_.sample_clip = event.flag;
      api_.eval(mutant_);
      if ((pins_.sample_ready != 0) != event.answer) differ("sample_ready");
    }
    if (event.kind == Event::Kind::write) {
      transfer(event.offset_or_u);
      pins_.pwrite = 1;
      pins_.pstrb = event.strobes;
      pins_.pwdata = event.value_or_v;
      api_.eval(mutant_);
      check_response(event);
    }
  }

  void transfer(uint32_t offset) {
    pins_.psel = pins_.penable = 1;
    pins_.pwrite = 0;
    pins_.pstrb = 0;
    pins_.paddr = static_cast<uint16_t>(offset);
  }

  void check_response(const Event& event) {
    if (pins_.pready == 0) differ("pready");
    if ((pins_.pslverr == 0) != event.answer)
      differ(fmt::format("pslverr at {:#05x}", event.offset_or_u));
  }

  void after(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (recording_.events[i].kind == Event::Kind::look) look(recording_.events[i]);
    for (size_t i = begin; i < end; ++i) {
      const Event& event = recording_.events[i];
      if (event.kind != Event::Kind::read) continue;
      transfer(event.offset_or_u);
      api_.eval(mutant_);
      check_response(event);
      if (event.answer && pins_.prdata != event.value_or_v)
        differ(fmt::format("read of {:#05x}: {:#x}, not {:#x}", event.offset_or_u, pins_.prdata,
                           event.value_or_v));
    }
  }

  // Reads without a clock, so without an effect.
  void look(const Event& event) {
    for (size_t i = 0; i < look_offsets.size(); ++i) {
      transfer(look_offsets[i]);
      api_.eval(mutant_);
      if (pins_.prdata != recording_.words[event.offset_or_u + i])
        differ(fmt::format("register {:#05x} at a commit: {:#x}, not {:#x}", look_offsets[i],
                           pins_.prdata, recording_.words[event.offset_or_u + i]));
    }
    pins_.psel = pins_.penable = 0;
    api_.eval(mutant_);
  }

  const capsoc_mutants_api& api_;
  capsoc_mutants* mutant_;
  capsoc_rtl_pins& pins_;
  const Recording& recording_;
  std::string difference_;
  uint64_t now_ = 0;
  unsigned quiet_ = 0;
  bool interrupt_ = false, idle_ = true;
};

struct Verdict {
  std::string scenario, what;
  uint64_t edge = 0;
};

/// What one scenario finds; nothing if the mutant does what the model does.
Verdict judge(const capsoc_mutants_api& api, unsigned mutant, const Named& stimulus) {
  capsoc_mutants* instance = api.create(mutant);
  if (instance == nullptr) return {stimulus.name, "out of memory", 0};
  Replay replay(api, instance, stimulus.recording);
  const std::string what = replay.run();
  api.destroy(instance);
  return {stimulus.name, what, replay.edge()};
}

std::string line(unsigned mutant, const Verdict& verdict) {
  if (verdict.what.empty()) return fmt::format("{}\tsurvived\t\t\t", mutant);
  return fmt::format("{}\tkilled\t{}\t{}\t{}", mutant, verdict.scenario, verdict.edge,
                     verdict.what);
}

/// Those of `mutants` that a scenario does not tell from the RTL; the others' lines are printed.
std::vector<unsigned> survivors(const capsoc_mutants_api& api, unsigned jobs,
                                const std::vector<unsigned>& mutants, const Named& stimulus) {
  std::vector<unsigned> left;
  std::mutex mutex;
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < mutants.size(); i = next++) {
      const Verdict verdict = judge(api, mutants[i], stimulus);
      const std::lock_guard lock(mutex);
      if (verdict.what.empty())
        left.push_back(mutants[i]);
      else
        fmt::print("{}\n", line(mutants[i], verdict));
    }
  };
  std::vector<std::thread> threads;
  for (unsigned job = 1; job < jobs; ++job) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  std::fflush(stdout);
  std::sort(left.begin(), left.end());
  return left;
}

std::set<unsigned> decided_before(const std::string& file) {
  std::set<unsigned> decided;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.find("\tkilled\t") != std::string::npos ||
        line.find("\tequivalent\t") != std::string::npos)
      decided.insert(static_cast<unsigned>(std::stoul(line)));
  return decided;
}

bool parse(int argc, char** argv, Arguments& arguments) {
  if (argc < 4 || argc % 2 != 0) return false;
  arguments.library = argv[1];
  if (std::strcmp(argv[2], "paper") == 0)
    arguments.options.arithmetic = coprocessor::Arithmetic::paper;
  else if (std::strcmp(argv[2], "precise") != 0)
    return false;
  arguments.count = static_cast<unsigned>(std::strtoul(argv[3], nullptr, 10));
  for (int i = 4; i < argc; i += 2) {
    const std::string name = argv[i];
    const uint64_t value = std::strtoull(argv[i + 1], nullptr, 10);
    if (name == "--samples")
      arguments.budget.samples = value;
    else if (name == "--accesses")
      arguments.budget.accesses = value;
    else if (name == "--seed")
      arguments.seed = value;
    else if (name == "--jobs")
      arguments.jobs = static_cast<unsigned>(value);
    else if (name == "--first")
      arguments.first = static_cast<unsigned>(value);
    else if (name == "--edges")
      arguments.edges = value;
    else if (name == "--known")
      arguments.known = argv[i + 1];
    else if (name == "--scenarios")
      arguments.scenarios = argv[i + 1];
    else
      return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (!parse(argc, argv, arguments)) {
    fmt::print(stderr,
               "usage: run_mutants LIBRARY precise|paper COUNT [--samples N] [--accesses N] "
               "[--seed N] [--jobs N] [--first N] [--edges N] [--known FILE] "
               "[--scenarios NAME,NAME...]\n");
    return 2;
  }
  void* handle = dlopen(arguments.library.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* entry = handle == nullptr ? nullptr : dlsym(handle, CAPSOC_MUTANTS_ENTRY);
  if (entry == nullptr) {
    fmt::print(stderr, "run_mutants: {}\n", dlerror());
    return 2;
  }
  const capsoc_mutants_api& api = *reinterpret_cast<capsoc_mutants_entry_function>(entry)();
  const std::vector<Named> stimuli = record(arguments);

  // Scenario by scenario, with the mutants that are left; the RTL itself is one of them.
  const std::set<unsigned> known = decided_before(arguments.known);
  std::vector<unsigned> left = {0};
  for (unsigned mutant = std::max(arguments.first, 1u); mutant <= arguments.count; ++mutant)
    if (known.count(mutant) == 0) left.push_back(mutant);
  for (const Named& stimulus : stimuli) {
    left = survivors(api, arguments.jobs, left, stimulus);
    if (left.empty() || left.front() != 0) return 1;
    const auto& events = stimulus.recording.events;
    fmt::print(stderr, "{:>5} left after {}, {} edges\n", left.size() - 1, stimulus.name,
               events.empty() ? 0 : events.back().edge);
  }
  for (unsigned mutant : left) fmt::print("{}\n", line(mutant, {}));
  return 0;
}
