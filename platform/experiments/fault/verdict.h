// The outcome of a run with a fault, from its results and those of the run without it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace capsoc::fault {

/// The coprocessor's result for one sample.
struct SampleResult {
  uint64_t number = 0;                    ///< of the sample, from 1
  uint32_t angle = 0;                     ///< 2^-32 turn
  uint32_t status = 0, flags = 0;         ///< registers STATUS and FLAGS
  bool has_angle = false, exists = true;  ///< exists: false of a sample that got lost on its way

  template <typename Archive>
  void visit(Archive& archive) {
    archive("number", number);
    archive("angle", angle);
    archive("status", status);
    archive("flags", flags);
    archive("has_angle", has_angle);
    archive("exists", exists);
  }
};

/// In the order in which they are given: the first one that holds.
enum class Verdict {
  unapplied,  ///< nothing changed: the run ended before, or the bit cannot be changed
  silent,     ///< wrong for more samples than are allowed, with VALID and LOCK and no alarm
  detected,   ///< a flag or an alarm came, VALID or LOCK went, or the program failed
  crashed,    ///< the program crashed, with a report
  hung,       ///< it does not end, and does without the fault
  wrong,      ///< an angle was off, or did not come, for so few samples that it does not count
  masked,     ///< no angle was off, and the state is as without the fault again
  latent      ///< no angle was off, and the state differs
};
const char* name_of(Verdict verdict);

/// What is wrong.
struct Tolerance {
  double degrees = 0.1;  ///< an angle that is further off than that
  uint64_t samples = 3;  ///< no more of them than that
};

/// How the run came to its end, or was left.
struct Ending {
  int code = 0, golden_code = 0;  ///< exit codes
  bool is_applied = true;         ///< the fault changed something
  bool is_same_state = false;     ///< the chip's state is that of the run without it
};

/// Takes the results of both runs side by side, sample by sample.
class Judgement {
 public:
  explicit Judgement(const Tolerance& tolerance) : tolerance_(tolerance) {}

  /// `result`: the sample's result; null: it has none.
  void take(const SampleResult& golden, const SampleResult* result);

  /// The program ended, other than without the fault: that says so, in the newest sample.
  void note_end();

  /// What said first that something is wrong and does not say so without the fault: "ALARM",
  /// "no LOCK", ...; "": nothing yet, or the program's end.
  const std::string& detected_by() const { return detected_by_; }
  /// Samples from the first wrong angle to that; 0 if it came before. Nothing without one of them.
  std::optional<uint64_t> detected_after() const;
  bool is_wrong() const { return first_wrong_.has_value(); }
  double largest_deg() const { return largest_deg_; }
  /// Wrong angles before a detection, with VALID and LOCK and no alarm.
  uint64_t trusted() const { return trusted_; }

  Verdict conclude(const Ending& ending) const;

 private:
  void note_wrong(const SampleResult& status);

  Tolerance tolerance_;
  uint64_t samples_ = 0, trusted_ = 0;
  std::optional<uint64_t> first_wrong_, detected_;  // numbers of samples
  std::optional<SampleResult> last_;
  std::string detected_by_;
  double largest_deg_ = 0;
};

}  // namespace capsoc::fault
