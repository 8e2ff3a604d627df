#include "cmsdk/id_registers.h"

namespace capsoc::cmsdk {

using registers::Access;
using registers::RegisterDescription;

RegisterDescription describe_register(const char* name, uint32_t offset, Access access,
                                      uint32_t bits) {
  const uint32_t writable = access == Access::read_only ? 0 : bits;
  const uint32_t readable = access == Access::write_only ? 0 : bits;
  return {name, offset, access, 0, writable, 0, readable};
}

IdRegisters::IdRegisters(kit::RegisterBank& bank, PartNumber part) {
  struct Id {
    const char* name;
    uint32_t offset;
    uint8_t value;
  };
  const Id ids[] = {
      {"PID4", 0xfd0, 0x04},
      {"PID5", 0xfd4, 0x00},
      {"PID6", 0xfd8, 0x00},
      {"PID7", 0xfdc, 0x00},
      {"PID0", 0xfe0, static_cast<uint8_t>(part)},
      {"PID1", 0xfe4, 0xb8},
      {"PID2", 0xfe8, 0x1b},
      {"PID3", 0xfec, 0x00},
      {"CID0", 0xff0, 0x0d},
      {"CID1", 0xff4, 0xf0},
      {"CID2", 0xff8, 0x05},
      {"CID3", 0xffc, 0xb1},
  };
  for (const Id& id : ids) {
    RegisterDescription description =
        describe_register(id.name, id.offset, Access::read_only, 0xff);
    description.reset = id.value;
    registers_.push_back(std::make_unique<kit::Register>(bank, description));
  }
}

}  // namespace capsoc::cmsdk
