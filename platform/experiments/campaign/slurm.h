// A campaign as a job array of Slurm: each task does its shard in its own store, and a job
// after them merges these, does what a killed task left, and reports. The scheduling is Slurm's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc::campaign {

struct SlurmPlan {
  std::string description;  ///< the file
  std::string name;         ///< of the campaign
  std::string store;        ///< where all runs come together
  std::string folder;       ///< of scripts, the tasks' stores and logs
  uint64_t tasks = 1;
  std::vector<std::string> options;  ///< further ones of sbatch, for both jobs: "--partition=long"
};

/// The two scripts, by name in the folder, and the description as it is now, which the tasks read.
struct SlurmScripts {
  std::string array, last, description;  ///< paths
};

/// Writes them. Started again, also after some tasks were killed, the tasks continue with their
/// stores.
Result<SlurmScripts> write_scripts(const SlurmPlan& plan);

struct SlurmJobs {
  std::string array, last;  ///< numbers
};

/// Error: sbatch is not there, or what it says.
Result<SlurmJobs> submit(const SlurmScripts& scripts);

}  // namespace capsoc::campaign
