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
#include <limits>
#include <nlohmann/json.hpp>
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
          seconds(usage.ru_utime) + seconds(usage.ru_stime), contents(output)};
}

/// The fastest of several runs; a failed one spoils all.
Run best_of(unsigned repeat, const std::vector<std::string>& command, const fs::path& output) {
  Run best;
  best.seconds = std::numeric_limits<double>::infinity();
  for (unsigned i = 0; i < std::max(1u, repeat); ++i) {
    Run run = execute(command, output);
    if (!run.good) return run;
    if (run.seconds < best.seconds) best = std::move(run);
  }
  return best;
}

std::vector<std::string> qemu(const std::string& elf, bool icount) {
  std::vector<std::string> command = {"qemu-system-arm",
                                      "-M",
                                      "mps2-an385",
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

struct Line {
  double mips = 0, cpi = 0, against_plain = 0, against_icount = 0;
};

}  // namespace

int run_cpu_bench(const CpuBench& bench, std::ostream& out) {
  Scratch scratch;
  if (scratch.path.empty()) {
    host::say("capsoc: no temporary folder can be made; let TMPDIR name one that can be written\n");
    return 1;
  }
  const fs::path json = scratch.file("result.json"), text = scratch.file("stdout");
  bool good = true;
  std::vector<Line> lines;
  fmt::print(out, "{:<16} {:>10} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "", "million", "", "",
             "QEMU", "ratio", "-icount", "ratio");
  fmt::print(out, "{:<16} {:>10} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "program", "instr.", "CPI",
             "MIPS", "MIPS", "", "MIPS", "");
  for (const std::string& elf : bench.firmware) {
    const std::string name = fs::path(elf).stem().string();
    const Run ours = best_of(
        bench.repeat,
        {bench.program, "run", elf, "--quantum", bench.quantum_ns, "--json", json.string()}, text);
    const nlohmann::json result =
        nlohmann::json::parse(contents(json), nullptr, /*allow_exceptions=*/false);
    if (!ours.good || result.is_discarded()) {
      fmt::print(out, "{:<16} failed; try: {} run {}\n", name, bench.program, elf);
      good = false;
      continue;
    }
    const auto instructions = result["cpu"]["instructions"].get<double>();
    Line line;
    line.mips = instructions / ours.seconds / 1e6;
    line.cpi = result["cpu"]["cycles"].get<double>() / instructions;
    fmt::print(out, "{:<16} {:>10.1f} {:>6.3f} {:>8.0f}", name, instructions / 1e6, line.cpi,
               line.mips);
    for (const bool icount : {false, true}) {
      const Run theirs = best_of(bench.repeat, qemu(elf, icount), text);
      if (!theirs.good) {
        fmt::print(out, " {:>8} {:>8}", "none", "");
        good = false;
        continue;
      }
      if (theirs.text != ours.text) {
        fmt::print(out, " (prints another result than QEMU)");
        good = false;
      }
      (icount ? line.against_icount : line.against_plain) = theirs.seconds / ours.seconds;
      fmt::print(out, " {:>8.0f} {:>8.2f}", instructions / theirs.seconds / 1e6,
                 theirs.seconds / ours.seconds);
    }
    fmt::print(out, "\n");
    out.flush();
    lines.push_back(line);
  }
  const auto mean = [&](double Line::*value) {
    double sum = 0;
    for (const Line& line : lines) sum += std::log(std::max(line.*value, 1e-9));
    return lines.empty() ? 0 : std::exp(sum / static_cast<double>(lines.size()));
  };
  const double ratio = mean(&Line::against_icount);
  fmt::print(out, "{:<16} {:>10} {:>6.3f} {:>8.0f} {:>8} {:>8.2f} {:>8} {:>8.2f}\n",
             "geometric mean", "", mean(&Line::cpi), mean(&Line::mips), "",
             mean(&Line::against_plain), "", ratio);
  if (ratio < bench.least_ratio) {
    fmt::print(out, "{:.2f} of QEMU with -icount is below {:.2f}\n", ratio, bench.least_ratio);
    good = false;
  }
  return good ? 0 : 1;
}

}  // namespace capsoc::bench
