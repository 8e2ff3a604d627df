// All places by name: cpu.r3, mem:0x20000100, mem:results+8, ADC.PERIOD, COPROCESSOR.A1,
// coprocessor.au, model.au, rtl.u_datapath.angle_q.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "backend/coprocessor_backend.h"
#include "base/result.h"
#include "inject/fault.h"
#include "inject/place.h"
#include "loader/elf_image.h"
#include "soc/register_index.h"
#include "soc/soc.h"
#include "source/variables.h"

namespace capsoc::inject {

/// A place of the list that campaigns draw from.
struct ListedPlace {
  std::string name;  ///< as a fault names it, without the bit
  uint64_t bits = 0;
  std::string unit;  ///< processor, a memory, a device, coprocessor, or a unit of the RTL

  template <typename Archive>
  void visit(Archive& archive) {
    archive("name", name);
    archive("bits", bits);
    archive("unit", unit);
  }
};

/// As lists of places have it: place, bits, unit.
nlohmann::ordered_json to_json(const ListedPlace& place);

/// The places of one system. Nothing passed in is owned, and all of it must outlive the places.
class Places {
 public:
  /// `images`: the programs, whose variables are places.
  Places(soc::Soc& soc, const run::CoprocessorBackend& backend,
         const std::vector<const loader::ElfImage*>& images);

  /// An Error is the end of a sentence: no such place (with the nearest names), or no such bit.
  Result<PlacedBit> find(const std::string& name, unsigned bit) const;

  /// The word that an access to a device's register carries.
  struct OnBus {
    uint32_t address = 0;
    unsigned bit = 0;  ///< of the word, from that of a field
  };
  /// An Error is the end of a sentence: there is no such register on the bus, or no such bit.
  Result<OnBus> on_bus(const Fault& fault) const;

  /// Every place that exists in this system, by unit. Of memories the parts that programs fill,
  /// "mem:0x20000000" with the bits from there on (bit 8 is bit 0 of the next byte).
  std::vector<ListedPlace> all() const;

 private:
  Result<PlacedBit> core_bit(const std::string& name, unsigned bit) const;
  Result<PlacedBit> memory_bit(const std::string& name, unsigned bit) const;
  Result<PlacedBit> device_bit(const std::string& name, unsigned bit) const;
  Result<PlacedBit> coprocessor_register(const std::string& name, const soc::RegisterPlace& at,
                                         unsigned bit) const;
  Result<PlacedBit> coprocessor_bit(const std::string& name, unsigned bit) const;
  kit::RegisterBank* bank_at(uint32_t address, uint32_t& offset) const;
  kit::Register* register_at(uint32_t address) const;
  void list_devices(std::vector<ListedPlace>& list) const;
  void list_coprocessor(std::vector<ListedPlace>& list) const;
  void list_memories(std::vector<ListedPlace>& list) const;

  soc::Soc& soc_;
  const run::CoprocessorBackend& backend_;
  const std::vector<const loader::ElfImage*>& images_;
  soc::RegisterIndex registers_;
  source::Variables variables_;
};

/// The Error of a bit that a place does not have.
Error no_such_bit(const std::string& name, unsigned bit, uint64_t bits);

}  // namespace capsoc::inject
