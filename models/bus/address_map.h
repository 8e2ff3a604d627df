// An address map as data: the target of each address range, its wait states and its interrupt
// lines. The board passes its map to matrix and bridge.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace capsoc::bus {

/// Kind of an entry's target.
enum class TargetKind : uint8_t {
  memory,         ///< RAM: direct memory pointers are granted
  device,         ///< a modelled device
  unimplemented,  ///< a named placeholder: reads 0, drops writes, is logged once
};

/// The bus on which the target sits. APB targets are reached through the bridge.
enum class BusKind : uint8_t { ahb, apb };

/// Number that stands for the non-maskable interrupt in InterruptWire::line.
constexpr int nmi_line = -1;

/// One interrupt output of a target and the processor line that it drives. Several outputs may
/// share a line (the UART overrun outputs do): they are ORed.
struct InterruptWire {
  std::string output;
  int line = 0;
};

/// One contiguous range of bus addresses.
struct MapEntry {
  std::string name;    ///< unique in the map
  std::string target;  ///< the model that answers; entries with one target are aliases of it
  uint64_t base = 0;
  uint64_t size = 0;  ///< bytes
  TargetKind kind = TargetKind::device;
  BusKind bus = BusKind::ahb;
  /// HCLK cycles that each transfer waits beyond its one data cycle. On APB: PREADY low cycles.
  unsigned wait_states = 0;
  /// Address inside the target of the first byte of the range.
  uint64_t offset = 0;
  /// If not 0, the range repeats the first `wrap` bytes (incomplete address decoding).
  uint64_t wrap = 0;
  std::vector<InterruptWire> interrupts = {};

  uint64_t last() const { return base + size - 1; }
  /// Bytes of the target that the range shows.
  uint64_t window() const { return wrap != 0 ? wrap : size; }
};

using AddressMap = std::vector<MapEntry>;

/// The name under which the matrix knows the AHB-to-APB bridge.
constexpr const char* apb_bridge_target = "apb_bridge";

/// Checks the map. Returns an empty string, or one sentence for each fault:
/// - empty or duplicate names
/// - zero sizes, or ranges past 32 bits
/// - boundaries that are no multiple of 4 bytes
/// - windows that do not divide their range
/// - overlaps
/// - one target on two buses
std::string validate(const AddressMap& map);

/// The entry of that name, or nullptr.
const MapEntry* find_entry(const AddressMap& map, const std::string& name);

}  // namespace capsoc::bus
