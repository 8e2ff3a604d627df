#include "bench/cpu_bench.h"

#include <fcntl.h>
#include <fmt/ostream.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "host/console.h"
#include "host/end_signals.h"

extern char** environ;

namespace capsoc::bench {
namespace {

namespace fs = std::filesystem;

struct Run {
  bool good = false;
  double seconds = 0;  ///< user and system time of the process
  double slowest = 0;  ///< of several runs
  std::string text;    ///< what it wrote on stdout
};

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
}

/// Runs a command to its end, its stdout in a file.
Run execute(std::vector<std::string> command, const fs::path& output) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const bool started =
      posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  rusage usage{};
  if (!started) return {};
  const host::EndedAtSignal ended(child);
  if (wait4(child, &status, 0, &usage) != child) return {};
  return {WIFEXITED(status) && WEXITSTATUS(status) == 0,
          seconds(usage.ru_utime) + seconds(usage.ru_stime),
          seconds(usage.ru_utime) + seconds(usage.ru_stime), contents(output)};
}

/// The fastest of several runs of each command, taken in turns, so that a host that is busy for a
/// while slows all of them; a failed one spoils its command.
std::vector<Run> best_of(unsigned repeat, const std::vector<std::vector<std::string>>& commands,
                         const fs::path& output) {
  std::vector<Run> best(commands.size());
  for (unsigned i = 0; i < std::max(1u, repeat); ++i) {
    for (std::size_t n = 0; n < commands.size(); ++n) {
      if (i != 0 && !best[n].good) continue;
      Run run = execute(commands[n], output);
      const double slowest = std::max(run.seconds, best[n].slowest);
      if (i == 0 || !run.good || run.seconds < best[n].seconds) best[n] = std::move(run);
      best[n].slowest = slowest;
    }
  }
  return best;
}

std::vector<std::string> qemu(const CpuBench& bench, const std::string& elf, bool icount) {
  std::vector<std::string> command = {"qemu-system-arm",
                                      "-M",
                                      bench.profile == "m3" ? "mps2-an385" : "mps2-an386",
                                      "-display",
                                      "none",
                                      "-monitor",
                                      "none",
                                      "-serial",
                                      "stdio",
                                      "-semihosting-config",
                                      "enable=on,target=native",
                                      "-kernel",
                                      elf};
  if (icount) command.insert(command.end(), {"-icount", "shift=0,sleep=off"});
  return command;
}

/// A folder for what the processes write, gone with the object.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "capsoc-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) return;
    path = name;
    removed_.emplace_back(name);
  }
  ~Scratch() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
  /// A file in it, which a signal that ends the program removes with the folder.
  fs::path file(const char* name) {
    removed_.emplace_back((path / name).string());
    return path / name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  fs::path path;

 private:
  std::vector<host::RemovedAtSignal> removed_;
};

/// What QEMU needs for the same program.
struct Peer {
  double mips = 0, ratio = 0;  ///< the ratio is ours to QEMU's
  double mips_least = 0;       ///< of the slowest run
};

/// One program, or the means.
struct Line {
  std::string name;
  std::optional<double> instructions;
  double cpi = 0, mips = 0, translator_mips = 0;
  double mips_least = 0, translator_mips_least = 0;  ///< of the slowest run
  std::optional<Peer> plain, icount;
  bool is_mean = false;
  std::string verdict = "good";
};

/// The translator's speed divided by QEMU's.
double translator_ratio(const Line& line, const Peer& peer) {
  return line.mips > 0 ? peer.ratio * line.translator_mips / line.mips : 0;
}

void print(std::ostream& out, const Line& line) {
  if (line.verdict == "failed") {
    fmt::print(out, "{:<16} failed\n", line.name);
    return;
  }
  fmt::print(out, "{:<16} {:>10} {:>6.3f} {:>8.0f}", line.name,
             line.instructions ? fmt::format("{:.1f}", *line.instructions / 1e6) : "", line.cpi,
             line.mips);
  for (const std::optional<Peer>& peer : {line.plain, line.icount}) {
    if (!peer)
      fmt::print(out, " {:>8} {:>8}", "none", "");
    else if (line.is_mean)
      fmt::print(out, " {:>8} {:>8.2f}", "", peer->ratio);
    else
      fmt::print(out, " {:>8.0f} {:>8.2f}", peer->mips, peer->ratio);
  }
  fmt::print(out, " {:>10.0f}", line.translator_mips);
  for (const std::optional<Peer>& peer : {line.plain, line.icount})
    fmt::print(out, " {:>8}", peer ? fmt::format("{:.2f}", translator_ratio(line, *peer)) : "");
  fmt::print(out, "{}\n", line.verdict == "differs" ? " (prints another result than QEMU)" : "");
  out.flush();
}

Fields fields(const Line& line) {
  const bool failed = line.verdict == "failed";
  const auto number = [&](double value) { return failed ? Field() : Field(value); };
  const auto least = [&](double value) { return line.is_mean ? Field() : number(value); };
  const auto mips = [&](const std::optional<Peer>& peer) {
    return peer && !line.is_mean ? Field(peer->mips) : Field();
  };
  const auto ratio = [](const std::optional<Peer>& peer) {
    return peer ? Field(peer->ratio) : Field();
  };
  const auto translated = [&](const std::optional<Peer>& peer) {
    return peer ? Field(translator_ratio(line, *peer)) : Field();
  };
  return {{"program", line.name},
          {"instructions", line.instructions ? Field(*line.instructions) : Field()},
          {"cpi", number(line.cpi)},
          {"mips", number(line.mips)},
          {"qemu_mips", mips(line.plain)},
          {"qemu_ratio", ratio(line.plain)},
          {"icount_mips", mips(line.icount)},
          {"icount_ratio", ratio(line.icount)},
          {"translator_mips", number(line.translator_mips)},
          {"translator_ratio", translated(line.plain)},
          {"translator_icount_ratio", translated(line.icount)},
          {"verdict", line.verdict},
          {"mips_least", least(line.mips_least)},
          {"qemu_mips_least", line.plain ? least(line.plain->mips_least) : Field()},
          {"icount_mips_least", line.icount ? least(line.icount->mips_least) : Field()},
          {"translator_mips_least", least(line.translator_mips_least)}};
}

/// Runs one program here and on QEMU; `json` and `text` are files for what they write.
Line measure(const CpuBench& bench, const std::string& elf, const fs::path& json,
             const fs::path& text) {
  Line line;
  line.name = fs::path(elf).stem().string();
  const auto here = [&](const char* executor) {
    return std::vector<std::string>{bench.program,
                                    "run",
                                    elf,
                                    "--quantum",
                                    bench.quantum_ns,
                                    "-C",
                                    executor,
                                    "-C",
                                    "cpu.profile=" + bench.profile,
                                    "--json",
                                    json.string()};
  };
  const std::vector<Run> runs = best_of(bench.repeat,
                                        {here("cpu.executor=blocks"), qemu(bench, elf, false),
                                         qemu(bench, elf, true), here("cpu.executor=translator")},
                                        text);
  const Run &ours = runs[0], &translated = runs[3];
  const nlohmann::json result =
      nlohmann::json::parse(contents(json), nullptr, /*allow_exceptions=*/false);
  if (!ours.good || !translated.good || result.is_discarded()) {
    line.verdict = "failed";
    return line;
  }
  const auto instructions = result["cpu"]["instructions"].get<double>();
  line.instructions = instructions;
  line.mips = instructions / ours.seconds / 1e6;
  line.translator_mips = instructions / translated.seconds / 1e6;
  line.mips_least = instructions / ours.slowest / 1e6;
  line.translator_mips_least = instructions / translated.slowest / 1e6;
  line.cpi = result["cpu"]["cycles"].get<double>() / instructions;
  if (translated.text != ours.text) line.verdict = "differs";
  for (const bool icount : {false, true}) {
    const Run& theirs = runs[icount ? 2 : 1];
    if (!theirs.good) {
      if (line.verdict == "good") line.verdict = "no QEMU";
      continue;
    }
    if (theirs.text != ours.text) line.verdict = "differs";
    (icount ? line.icount : line.plain) =
        Peer{instructions / theirs.seconds / 1e6, theirs.seconds / ours.seconds,
             instructions / theirs.slowest / 1e6};
  }
  return line;
}

/// Geometric means of those that ran.
Line means(const std::vector<Line>& lines) {
  const auto mean = [&](auto value) {
    double sum = 0;
    for (const Line& line : lines) sum += std::log(std::max(value(line), 1e-9));
    return lines.empty() ? 0 : std::exp(sum / static_cast<double>(lines.size()));
  };
  const auto ratio = [](const std::optional<Peer>& peer) { return peer ? peer->ratio : 0; };
  Line line;
  line.name = "geometric mean";
  line.is_mean = true;
  line.cpi = mean([](const Line& l) { return l.cpi; });
  line.mips = mean([](const Line& l) { return l.mips; });
  line.translator_mips = mean([](const Line& l) { return l.translator_mips; });
  line.plain = Peer{0, mean([&](const Line& l) { return ratio(l.plain); }), 0};
  line.icount = Peer{0, mean([&](const Line& l) { return ratio(l.icount); }), 0};
  return line;
}

}  // namespace

int run_cpu_bench(const CpuBench& bench, std::ostream& out, DataTable* table) {
  Scratch scratch;
  if (scratch.path.empty()) {
    host::say("capsoc: no temporary folder can be made; let TMPDIR name one that can be written\n");
    return 1;
  }
  const fs::path json = scratch.file("result.json"), text = scratch.file("stdout");
  DataTable rows{"cpu", "Million instructions a second beside QEMU", {}};
  bool good = true;
  std::vector<Line> ran;
  fmt::print(out, "{:<16} {:>10} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8}\n", "",
             "million", "", "", "QEMU", "ratio", "-icount", "ratio", "translator", "ratio",
             "-icount");
  fmt::print(out, "{:<16} {:>10} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8}\n",
             "program", "instr.", "CPI", "MIPS", "MIPS", "", "MIPS", "", "MIPS", "", "ratio");
  for (const std::string& elf : bench.firmware) {
    const Line line = measure(bench, elf, json, text);
    print(out, line);
    if (line.verdict == "failed") fmt::print(out, "try: {} run {}\n", bench.program, elf);
    rows.rows.push_back(fields(line));
    good = good && line.verdict == "good";
    if (line.verdict != "failed") ran.push_back(line);
  }
  Line mean = means(ran);
  const bool too_slow = mean.icount->ratio < bench.least_ratio;
  if (too_slow) mean.verdict = "too slow";
  print(out, mean);
  rows.rows.push_back(fields(mean));
  if (too_slow)
    fmt::print(out, "{:.2f} of QEMU with -icount is below {:.2f}\n", mean.icount->ratio,
               bench.least_ratio);
  if (table != nullptr) *table = std::move(rows);
  return good && !too_slow ? 0 : 1;
}

}  // namespace capsoc::bench
