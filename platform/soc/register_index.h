// The registers of the board by the names of the SVD file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "soc/board_registers.h"

namespace capsoc::soc {

/// A register, or one of its fields.
struct RegisterPlace {
  const BoardRegister* reg = nullptr;
  const RegisterField* field = nullptr;  ///< null: the register as a whole
};

inline uint32_t value_in(const RegisterField& field, uint32_t word) {
  return static_cast<uint32_t>(word >> field.low & ((uint64_t{1} << field.bits) - 1));
}

class RegisterIndex {
 public:
  explicit RegisterIndex(const Soc& soc) : peripherals_(board_peripherals(soc)) {}

  const std::vector<BoardPeripheral>& all() const { return peripherals_; }
  bool has_peripheral(const std::string& name) const;
  /// "COPROCESSOR.STATUS" or "COPROCESSOR.STATUS.LOCK". An Error names what there is instead. A
  /// place lives as long as the index.
  Result<RegisterPlace> find(const std::string& name) const;

 private:
  std::vector<BoardPeripheral> peripherals_;
};

}  // namespace capsoc::soc
