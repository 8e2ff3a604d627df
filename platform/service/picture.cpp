#include "service/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "service/value.h"

namespace capsoc::service {
namespace {

constexpr std::size_t most_entries = 1000;
constexpr uint32_t longest_run = 64;  // bytes without a name in one entry

Json changed(const Json& one, const Json& other) {
  Json all = Json::object();
  for (const auto& [name, value] : one.items())
    if (const auto found = other.find(name); found != other.end() && *found != value)
      all[name] = {value, *found};
  return all;
}

std::string hexadecimal(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<uint8_t>(byte));
  return text;
}

/// The memory of two pictures, byte by byte.
class Comparison {
 public:
  Comparison(const Picture& one, const Picture& other) : one_(one), other_(other) {
    for (const Picture* each : {&one, &other})
      for (const auto& [address, bytes] : each->pages) compare(address);
  }

  Json take(const std::vector<source::Variable>& variables) {
    for (const source::Variable& variable : variables) {
      add(variable);
      for (auto at = different_.lower_bound(variable.address);
           at != different_.end() && *at - variable.address < variable.type->size;)
        at = different_.erase(at);
    }
    add_nameless();
    return std::move(list_);
  }
  std::size_t left_out() const { return left_out_; }

 private:
  static std::string read(const Picture& picture, uint32_t address, uint32_t size) {
    std::string bytes(size, '\0');
    for (uint32_t i = 0; i < size; ++i) {
      const uint32_t at = address + i;
      const auto found = picture.pages.find(at / Picture::page * Picture::page);
      if (found != picture.pages.end()) bytes[i] = found->second[at % Picture::page];
    }
    return bytes;
  }

  void compare(uint32_t address) {
    const std::string one = read(one_, address, Picture::page);
    const std::string other = read(other_, address, Picture::page);
    if (one == other) return;
    for (uint32_t i = 0; i < Picture::page; ++i)
      if (one[i] != other[i]) different_.insert(address + i);
  }

  bool differs(const source::Variable& variable) const {
    const auto first = different_.lower_bound(variable.address);
    return first != different_.end() && *first - variable.address < variable.type->size;
  }

  void put(Json entry) {
    if (list_.size() < most_entries)
      list_.push_back(std::move(entry));
    else
      ++left_out_;
  }

  /// Down to the parts that differ.
  void add(const source::Variable& variable) {
    if (!differs(variable)) return;
    const source::Type& type = *variable.type;
    if (type.kind == source::Type::Kind::structure) {
      for (const source::Type::Member& member : type.members)
        add({variable.name + "." + member.name, variable.address + member.offset, member.type,
             member.bits, member.bit});
    } else if (type.kind == source::Type::Kind::array && type.target != nullptr &&
               type.target->kind != source::Type::Kind::character) {
      for (uint32_t i = 0; i < type.count; ++i)
        add({fmt::format("{}[{}]", variable.name, i), variable.address + i * type.target->size,
             type.target});
    } else {
      add_leaf(variable);
    }
  }

  void add_leaf(const source::Variable& variable) {
    const uint32_t size = variable.size();
    Json one = value_of(variable, read(one_, variable.address, size));
    Json other = value_of(variable, read(other_, variable.address, size));
    if (one == other) return;  // another bit-field of the same word
    put({{"name", variable.name},
         {"address", variable.address},
         {"one", std::move(one)},
         {"other", std::move(other)}});
  }

  void add_nameless() {
    for (auto at = different_.begin(); at != different_.end();) {
      const uint32_t begin = *at;
      uint32_t size = 0;
      while (at != different_.end() && *at == begin + size && size < longest_run) {
        ++at;
        ++size;
      }
      put({{"name", nullptr},
           {"address", begin},
           {"one", hexadecimal(read(one_, begin, size))},
           {"other", hexadecimal(read(other_, begin, size))}});
    }
  }

  const Picture& one_;
  const Picture& other_;
  std::set<uint32_t> different_;
  Json list_ = Json::array();
  std::size_t left_out_ = 0;
};

}  // namespace

Picture Picture::of(Board& board) {
  Picture picture;
  picture.position = board.position();
  for (unsigned i = 0; i < debug::registers.size(); ++i)
    if (board.target().has_register(i))
      picture.processor[debug::registers[i].name] = board.target().read_register(i);
  for (const soc::BoardPeripheral& peripheral : board.registers().all())
    for (const soc::BoardRegister& reg : peripheral.registers)
      if (const auto word = board.read_word(reg.address))
        picture.devices[peripheral.name + "." + reg.name] = *word;
  std::set<std::string> seen;
  for (const bus::MapEntry& entry : board.soc().ahb.map()) {
    if (entry.kind != bus::TargetKind::memory || !seen.insert(entry.target).second) continue;
    for (uint64_t at = entry.base; at < entry.base + entry.window(); at += page) {
      std::string bytes = board.target().read_memory(static_cast<uint32_t>(at), page);
      bytes.resize(page);
      if (bytes.find_first_not_of('\0') != std::string::npos)
        picture.pages[static_cast<uint32_t>(at)] = std::move(bytes);
    }
  }
  return picture;
}

Json Picture::pack(Frames& frames) const {
  Json addresses = Json::array();
  std::string all;
  for (const auto& [address, bytes] : pages) {
    addresses.push_back(address);
    all += bytes;
  }
  frames.push_back(std::move(all));
  return {{"position", to_json(position)},
          {"processor", processor},
          {"devices", devices},
          {"pages", std::move(addresses)},
          {"frame", frames.size() - 1}};
}

Picture Picture::unpack(const Json& about, const Frames& frames) {
  Picture picture;
  picture.position = position_in(about.at("position")).value_or(Position());
  picture.processor = about.at("processor");
  picture.devices = about.at("devices");
  const std::string& all = frames.at(about.at("frame").get<std::size_t>());
  std::size_t at = 0;
  for (const Json& address : about.at("pages")) {
    picture.pages[address.get<uint32_t>()] = all.substr(at, page);
    at += page;
  }
  return picture;
}

Json difference(Board& board, const Picture& one, const Picture& other) {
  Comparison memory(one, other);
  Json list = memory.take(board.variables().all());
  return {{"processor", changed(one.processor, other.processor)},
          {"devices", changed(one.devices, other.devices)},
          {"memory", std::move(list)},
          {"left_out", memory.left_out()}};
}

}  // namespace capsoc::service
