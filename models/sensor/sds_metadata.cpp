// The metadata of SDS recordings: a small part of YAML's documents, read by libyaml.
#include <fmt/format.h>
#include <yaml.h>

#include <array>
#include <optional>
#include <utility>

#include "base/number.h"
#include "base/printable.h"
#include "sensor/sds_file.h"
#include "sensor/text.h"

namespace capsoc::sensor {
namespace {

constexpr double most_elements = 1 << 20;

const std::array<std::pair<const char*, SdsValue::Type>, 10> types = {
    {{"int8_t", SdsValue::Type::i8},
     {"uint8_t", SdsValue::Type::u8},
     {"int16_t", SdsValue::Type::i16},
     {"uint16_t", SdsValue::Type::u16},
     {"int32_t", SdsValue::Type::i32},
     {"uint32_t", SdsValue::Type::u32},
     {"int64_t", SdsValue::Type::i64},
     {"uint64_t", SdsValue::Type::u64},
     {"float", SdsValue::Type::f32},
     {"double", SdsValue::Type::f64}}};

class MetadataReader {
 public:
  MetadataReader(const std::string& text, const std::string& file) : file_(file) {
    yaml_parser_initialize(&parser_);
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
    loaded_ = yaml_parser_load(&parser_, &document_) != 0;
  }
  ~MetadataReader() {
    if (loaded_) yaml_document_delete(&document_);
    yaml_parser_delete(&parser_);
  }
  MetadataReader(const MetadataReader&) = delete;
  MetadataReader& operator=(const MetadataReader&) = delete;

  Result<SdsMetadata> read() {
    if (!loaded_)
      return error_at(file_, parser_.problem_mark.line + 1,
                      fmt::format("is no YAML ({}); write it as the SDS-Framework's schema has it",
                                  parser_.problem != nullptr ? parser_.problem : "damaged"));
    const yaml_node_t* root = yaml_document_get_root_node(&document_);
    const yaml_node_t* sds = root != nullptr ? value_of(root, "sds") : nullptr;
    if (sds == nullptr) return Error{file_ + ": there is no 'sds:' in it"};
    const yaml_node_t* content = value_of(sds, "content");
    if (content == nullptr || content->type != YAML_SEQUENCE_NODE)
      return error(*sds, "there is no list 'content:' of the stream's values");
    if (auto wrong = frequencies(*sds)) return *wrong;
    for (auto* item = content->data.sequence.items.start; item < content->data.sequence.items.top;
         ++item) {
      const yaml_node_t* node = yaml_document_get_node(&document_, *item);
      if (node == nullptr) continue;
      if (auto wrong = entry(*node)) return *wrong;
    }
    if (metadata_.values.empty()) return error(*content, "'content:' has no value");
    return metadata_;
  }

 private:
  Error error(const yaml_node_t& node, const std::string& what) const {
    return error_at(file_, node.start_mark.line + 1, what);
  }

  static std::optional<std::string> scalar(const yaml_node_t* node) {
    if (node == nullptr || node->type != YAML_SCALAR_NODE) return std::nullopt;
    return std::string(reinterpret_cast<const char*>(node->data.scalar.value),
                       node->data.scalar.length);
  }

  const yaml_node_t* value_of(const yaml_node_t* mapping, const char* key) {
    if (mapping->type != YAML_MAPPING_NODE) return nullptr;
    for (auto* pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top;
         ++pair)
      if (scalar(yaml_document_get_node(&document_, pair->key)) == key)
        return yaml_document_get_node(&document_, pair->value);
    return nullptr;
  }

  /// Takes the number of a key, if it is there.
  std::optional<Error> number(const yaml_node_t& mapping, const char* key, double least,
                              std::optional<double>& value) {
    const yaml_node_t* node = value_of(&mapping, key);
    if (node == nullptr) return std::nullopt;
    const auto found = finite_number(scalar(node).value_or(""));
    if (!found || *found < least)
      return error(*node, fmt::format("'{}' is '{}'; give a number{}", key,
                                      printable(scalar(node).value_or("no value")),
                                      least > 0 ? " above 0" : ""));
    value = found;
    return std::nullopt;
  }

  std::optional<Error> frequencies(const yaml_node_t& sds) {
    constexpr double least = 1e-9;
    std::optional<double> tick, old;
    for (const auto& [key, value] :
         {std::pair("tick-frequency", &tick), std::pair("frequency", &old),
          std::pair("sample-frequency", &metadata_.rate_hz),
          std::pair("block-frequency", &metadata_.block_hz)})
      if (auto wrong = number(sds, key, least, *value)) return wrong;
    if (tick) metadata_.tick_hz = *tick;
    if (!metadata_.rate_hz) metadata_.rate_hz = old;
    return std::nullopt;
  }

  std::optional<Error> entry(const yaml_node_t& node) {
    if (const yaml_node_t* sound = value_of(&node, "audio")) return audio(*sound);
    const auto name = scalar(value_of(&node, "value")), type = scalar(value_of(&node, "type"));
    if (!name || !type)
      return error(node,
                   "an entry of 'content:' is no value with a type and no audio; signals are");
    SdsValue value;
    value.name = *name;
    value.unit = scalar(value_of(&node, "unit")).value_or("");
    bool known = false;
    for (const auto& [word, one] : types) {
      if (*type != word) continue;
      value.type = one;
      known = true;
    }
    if (!known)
      return error(node, fmt::format("'{}' has the type '{}'; int8_t to uint64_t, float and double "
                                     "are read",
                                     printable(*name), printable(*type)));
    std::optional<double> scale, offset, x, y;
    constexpr double any = -1.7e308;
    for (const auto& [key, least, number_of] :
         {std::make_tuple("scale", any, &scale), std::make_tuple("offset", any, &offset),
          std::make_tuple("dim-x", 1.0, &x), std::make_tuple("dim-y", 1.0, &y)})
      if (auto wrong = number(node, key, least, *number_of)) return wrong;
    value.scale = scale.value_or(1);
    value.offset = offset.value_or(0);
    const double count = x.value_or(1) * y.value_or(1);
    if (count > most_elements) return error(node, "dim-x and dim-y are too large");
    value.count = static_cast<std::size_t>(count);
    metadata_.values.push_back(std::move(value));
    return std::nullopt;
  }

  std::optional<Error> audio(const yaml_node_t& node) {
    std::optional<double> rate, bits, channels;
    for (const auto& [key, value] :
         {std::pair("sample-frequency", &rate), std::pair("bit-depth", &bits),
          std::pair("audio-channels", &channels), std::pair("channels", &channels)})
      if (auto wrong = number(node, key, 1, *value)) return wrong;
    if (!rate || !bits || !channels || *channels > 64 || (*bits != 16 && *bits != 32))
      return error(node, "audio needs sample-frequency, bit-depth (16 or 32) and audio-channels");
    metadata_.rate_hz = rate;
    for (int channel = 1; channel <= static_cast<int>(*channels); ++channel) {
      SdsValue value;
      value.name = fmt::format("channel {}", channel);
      value.type = *bits == 16 ? SdsValue::Type::i16 : SdsValue::Type::i32;
      value.scale = *bits == 16 ? 0x1p-15 : 0x1p-31;
      metadata_.values.push_back(std::move(value));
    }
    return std::nullopt;
  }

  std::string file_;
  yaml_parser_t parser_{};
  yaml_document_t document_{};
  bool loaded_ = false;
  SdsMetadata metadata_;
};

}  // namespace

Result<SdsMetadata> read_sds_metadata(const std::string& text, const std::string& file) {
  return MetadataReader(text, file).read();
}

}  // namespace capsoc::sensor
