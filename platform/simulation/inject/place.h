// What a fault can change.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <systemc>

namespace capsoc::inject {

/// What a change found and left.
struct Change {
  uint64_t before = 0, after = 0;
};

/// State of the chip, of up to 64 bits. All calls come between two instructions, with the processor
/// and the kernel at one instant.
class Place {
 public:
  /// What writes it, so that a stuck bit has to be set again.
  enum class Writer {
    instruction,  ///< looked at after each instruction
    result,       ///< looked at after each result of the coprocessor
  };

  Place() = default;
  virtual ~Place() = default;
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// Gives it the value that `to` makes of the present one. Nothing: it cannot be changed at this
  /// instant, and nothing was done; see ready_at().
  using To = std::function<uint64_t(uint64_t present)>;
  virtual std::optional<Change> change(const To& to) = 0;
  /// When to try again.
  virtual sc_core::sc_time ready_at() const { return sc_core::sc_time_stamp(); }
  /// Holds the bit from now on by itself, until release(). False: it cannot, and is to be changed
  /// again and again.
  virtual bool hold(unsigned /*bit*/, bool /*value*/) { return false; }
  virtual void release(unsigned /*bit*/) {}
  virtual Writer writer() const { return Writer::instruction; }
};

/// A bit of a place.
struct PlacedBit {
  std::unique_ptr<Place> place;
  unsigned bit = 0;
};

}  // namespace capsoc::inject
