#include "trace/waves.h"

#include <fmt/format.h>

#include <utility>

#include "host/files.h"
#include "trace/exception_name.h"
#include "trace/picoseconds.h"
#include "trace/save_file.h"

namespace capsoc::trace {
namespace {

uint64_t picoseconds_now() {
  return picoseconds(sc_core::sc_time_stamp());
}

std::string stage_name(unsigned stage) {
  return stage == coprocessor::commit_stage ? "registers" : fmt::format("t{}", stage);
}

std::string range(unsigned width) {
  return width == 1 ? "" : fmt::format("[{}:0]", width - 1);
}

/// What is worth a curve and not only numbers.
bool is_curve(const std::string& node) {
  return node == "u" || node == "v" || node == "angle" || node == "error_u" || node == "error_v";
}

}  // namespace

Waves::Waves(std::unique_ptr<FstFile> file, std::string path, soc::Soc& soc)
    : file_(std::move(file)), path_(std::move(path)), soc_(soc) {
  file_->open_scope("soc");
  add_interrupts();
  add_bus();
  add_nodes();
  file_->close_scope();
}

void Waves::add_interrupts() {
  file_->open_scope("interrupts");
  soc_.each_interrupt(
      [this](kit::InterruptLine& source, const char* device, const bus::InterruptWire& wire) {
        Line added;
        added.name = fmt::format("{}_{}", device, wire.output);
        added.source = &source;
        added.signal = file_->add_bits(added.name, 1);
        lines_.push_back(added);
        file_->set(0, added.signal, 0);
        source.connect([this, index = lines_.size() - 1](bool level) { line(index, level); });
      });
  file_->close_scope();
  file_->open_scope("cpu");
  exception_ = file_->add_bits("exception", 9);
  exception_name_ = file_->add_text("exception_name");
  file_->close_scope();
  exception(0, 0);
}

void Waves::add_bus() {
  file_->open_scope("bus");
  active_ = file_->add_bits("active", 1);
  initiator_ = file_->add_text("initiator");
  write_ = file_->add_bits("write", 1);
  size_ = file_->add_bits("size", 3);
  address_ = file_->add_bits("address", 32);
  data_ = file_->add_bits("data", 32);
  status_ = file_->add_text("status");
  file_->close_scope();
  file_->set(0, active_, 0);
}

void Waves::add_nodes() {
  file_->open_scope("coprocessor");
  commits_ = file_->add_bits("commits", 32);
  unsigned stage = ~0U;
  for (const coprocessor::NamedNode& named : coprocessor::node_names()) {
    if (named.stage != stage) {
      if (stage != ~0U) file_->close_scope();
      file_->open_scope(stage_name(named.stage));
      stage = named.stage;
    }
    Node node;
    node.node = &named;
    node.word = file_->add_bits(named.name, named.format.width);
    node.path = fmt::format("soc.coprocessor.{}.{}", stage_name(stage), named.name);
    if (node.has_value()) {
      const char* unit =
          named.format.meaning == coprocessor::Meaning::turns ? "_degrees" : "_value";
      node.value = file_->add_real(named.name + std::string(unit));
      node.path += unit;
    } else {
      node.path += range(named.format.width);
    }
    nodes_.push_back(std::move(node));
  }
  file_->close_scope();
  file_->close_scope();
}

void Waves::line(std::size_t index, bool level) {
  lines_[index].level = level;
  if (!open_) return;
  const uint64_t now = picoseconds_now();
  file_->flush(now);
  file_->set(now, lines_[index].signal, level ? 1 : 0);
}

void Waves::open(bool on, uint64_t picoseconds) {
  if (on == open_) return;
  open_ = on;
  if (!on) return;
  for (const Line& line : lines_) file_->set(picoseconds, line.signal, line.level ? 1 : 0);
  exception(picoseconds, exception_number_);
}

void Waves::begin(uint64_t picoseconds, unsigned exception) {
  exception_number_ = exception;
  for (Line& line : lines_) line.level = line.source->level();
  if (!std::exchange(open_, false)) return;
  open(true, picoseconds);
}

void Waves::transfer(uint64_t begin_ps, uint64_t end_ps, const BusAccess& access) {
  file_->flush(picoseconds_now());
  file_->set(begin_ps, active_, 1);
  file_->set_text(begin_ps, initiator_, access.initiator);
  file_->set(begin_ps, write_, access.write ? 1 : 0);
  file_->set(begin_ps, size_, access.size);
  file_->set(begin_ps, address_, access.address);
  file_->set(begin_ps, data_, access.data);
  file_->set_text(begin_ps, status_, access.status);
  file_->set(end_ps, active_, 0);
}

void Waves::exception(uint64_t picoseconds, unsigned number) {
  exception_number_ = number;
  if (!open_) return;
  file_->flush(picoseconds_now());
  file_->set(picoseconds, exception_, number);
  file_->set_text(picoseconds, exception_name_, exception_name(number));
}

void Waves::result(uint64_t picoseconds, const coprocessor::Nodes& nodes) {
  if (!open_) return;
  file_->flush(picoseconds_now());
  file_->set(picoseconds, commits_, nodes.commits);
  for (const Node& node : nodes_) {
    const int64_t word = nodes.*node.node->value;
    file_->set(picoseconds, node.word, static_cast<uint64_t>(word));
    if (node.has_value()) file_->set_real(picoseconds, node.value, node.node->format.value(word));
  }
}

std::optional<Error> Waves::finish(uint64_t picoseconds) {
  if (auto error = file_->finish(picoseconds)) return error;
  return host::write_whole(save_file(path_), save_text());
}

std::string Waves::save_text() const {
  SaveText save(path_);
  using Radix = SaveText::Radix;
  save.begin_group("interrupts");
  for (const Line& line : lines_) save.add(Radix::binary, "soc.interrupts." + line.name);
  save.add(Radix::ascii, "soc.cpu.exception_name");
  save.end_group("interrupts");
  save.begin_group("bus");
  save.add(Radix::binary, "soc.bus.active");
  save.add(Radix::ascii, "soc.bus.initiator");
  save.add(Radix::binary, "soc.bus.write");
  save.add(Radix::hexadecimal, "soc.bus.address[31:0]");
  save.add(Radix::hexadecimal, "soc.bus.data[31:0]");
  save.add(Radix::ascii, "soc.bus.status");
  save.end_group("bus");
  unsigned stage = ~0U;
  for (const Node& node : nodes_) {
    if (node.node->stage != stage) {
      if (stage != ~0U) save.end_group("coprocessor " + stage_name(stage));
      stage = node.node->stage;
      save.begin_group("coprocessor " + stage_name(stage));
    }
    const Radix radix = node.has_value() ? Radix::real : Radix::hexadecimal;
    if (is_curve(node.node->name))
      save.add_curve(radix, node.path);
    else
      save.add(radix, node.path);
  }
  save.end_group("coprocessor " + stage_name(stage));
  return save.text();
}

}  // namespace capsoc::trace
