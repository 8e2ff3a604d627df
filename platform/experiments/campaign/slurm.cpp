#include "campaign/slurm.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "base/input_file.h"
#include "base/printable.h"
#include "base/shell.h"
#include "host/files.h"
#include "host/places.h"

namespace capsoc::campaign {
namespace {

constexpr uint64_t largest_description = 1U << 20U;

/// As a line of the script has it: sbatch splits it at blanks, as a shell does. The option's own
/// name stays as it is, and so does what the user has quoted.
std::string sbatch_option(const std::string& words) {
  const std::size_t end = words.find_first_of("= ");
  if (end == std::string::npos) return words;
  const std::string value = words.substr(end + 1);
  const bool quoted = value.size() > 1 && (value.front() == '\'' || value.front() == '"') &&
                      value.front() == value.back();
  return words.substr(0, end + 1) + (quoted || value.empty() ? value : shell_word(value));
}

/// Options of sbatch that both scripts begin with. %a and %j are Slurm's.
std::string head(const SlurmPlan& plan, const std::string& job, const std::string& log) {
  std::string text = "#!/bin/sh\n";
  const auto option = [&text](const std::string& words) { text += "#SBATCH " + words + "\n"; };
  option("--job-name=" + shell_word("capsoc-" + plan.name + job));
  option("--output=" + shell_word(plan.folder + "/" + log));
  option("--open-mode=append");
  option("--requeue");  // a task that begins again continues with its store
  for (const std::string& words : plan.options) option(sbatch_option(words));
  return text;
}

/// A run that fails a criterion is a result, and no reason for Slurm to call the task failed.
std::string array_script(const SlurmPlan& plan, const std::string& description) {
  const std::string program = shell_word(host::program_path());
  std::string text = head(plan, "", "task-%a.log");
  text += fmt::format("#SBATCH --array=1-{}\n\n", plan.tasks);
  text += fmt::format(
      "{} campaign run {} --shard \"$SLURM_ARRAY_TASK_ID/{}\" \\\n"
      "  --store {}/task-\"$SLURM_ARRAY_TASK_ID\".sqlite --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
      program, shell_word(description), plan.tasks, shell_word(plan.folder));
  return text + "code=$?\n[ $code -eq 1 ] && exit 0\nexit $code\n";
}

std::string last_script(const SlurmPlan& plan) {
  const std::string program = shell_word(host::program_path());
  const std::string store = shell_word(plan.store), folder = shell_word(plan.folder);
  std::string text = head(plan, "-report", "report.log") + "\n";
  text += fmt::format("{} campaign merge {} {}/task-*.sqlite || exit\n", program, store, folder);
  text += "# What tasks left that were killed and not requeued.\n";
  text += fmt::format(
      "exec {} campaign resume {} --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\" \\\n"
      "  --json {}/report.json --junit {}/report.xml\n",
      program, store, folder, folder);
  return text;
}

/// What a command prints on both streams, and how it ended.
struct Said {
  int status = -1;
  std::string text;
};

Said ask(const std::string& command) {
  Said said;
  std::FILE* stream = popen((command + " 2>&1").c_str(), "r");
  if (stream == nullptr) return said;
  char buffer[4096];
  for (std::size_t count; (count = std::fread(buffer, 1, sizeof buffer, stream)) > 0;)
    said.text.append(buffer, count);
  said.status = pclose(stream);
  while (!said.text.empty() && said.text.back() == '\n') said.text.pop_back();
  return said;
}

/// The number of the job: "--parsable" prints "number" or "number;cluster".
Result<std::string> sbatch(const std::string& arguments) {
  constexpr int not_found = 127;
  const Said said = ask("sbatch --parsable " + arguments);
  if (WIFEXITED(said.status) && WEXITSTATUS(said.status) == not_found)
    return Error{
        "sbatch: there is no such program; install slurm-client, or give the shards to another "
        "scheduler (capsoc campaign run --shard K/N)"};
  const std::string number = said.text.substr(0, said.text.find(';'));
  const bool is_number =
      !number.empty() && number.find_first_not_of("0123456789") == std::string::npos;
  if (said.status != 0 || !is_number)
    return Error{fmt::format("sbatch does not take the job: {}; correct that and submit again",
                             printable(said.text, 300))};
  return number;
}

}  // namespace

Result<SlurmScripts> write_scripts(const SlurmPlan& plan) {
  for (const std::string& words : plan.options)
    if (words.find('\n') != std::string::npos)
      return Error{fmt::format("--sbatch {}: has more than one line; give one option",
                               printable(words, 80))};
  std::error_code failure;
  std::filesystem::create_directories(plan.folder, failure);
  if (failure)
    return Error{fmt::format("{}: the folder cannot be made ({}); name another --folder",
                             plan.folder, failure.message())};
  const auto text = read_input(plan.description, {"name a description", largest_description});
  if (!text) return Error{text.error()};
  const SlurmScripts scripts{plan.folder + "/array.sh", plan.folder + "/last.sh",
                             plan.folder + "/campaign.toml"};
  if (auto error = host::write_together({{scripts.description, text.value()},
                                         {scripts.array, array_script(plan, scripts.description)},
                                         {scripts.last, last_script(plan)}}))
    return *error;
  return scripts;
}

Result<SlurmJobs> submit(const SlurmScripts& scripts) {
  const auto array = sbatch(shell_word(scripts.array));
  if (!array) return Error{array.error()};
  const auto last =
      sbatch(fmt::format("--dependency=afterany:{} {}", array.value(), shell_word(scripts.last)));
  if (!last) return Error{last.error()};
  return SlurmJobs{array.value(), last.value()};
}

}  // namespace capsoc::campaign
