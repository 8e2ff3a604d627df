#include "trace/fst_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "gtkwave/fstapi.h"
#include "host/files.h"

namespace capsoc::trace {
namespace {

constexpr int picosecond = -12;  // power of ten

}  // namespace

FstFile::FstFile(WaveFile file, void* writer) : file_(std::move(file)), writer_(writer) {}

Result<std::unique_ptr<FstFile>> FstFile::create(const std::string& path) {
  auto file = WaveFile::at(path);
  if (!file) return Error{file.error()};
  void* writer = fstWriterCreate(file.value().growing().c_str(), 1);
  if (writer == nullptr) return host::cannot_write(path, errno);
  fstWriterSetTimescale(writer, picosecond);
  fstWriterSetVersion(writer, "capsoc");
  fstWriterSetDate(writer, "");  // the same run gives the same bytes
  return std::unique_ptr<FstFile>(new FstFile(std::move(file.value()), writer));
}

FstFile::~FstFile() {
  if (writer_ != nullptr) fstWriterClose(writer_);
}

void FstFile::open_scope(const std::string& name) {
  fstWriterSetScope(writer_, FST_ST_VCD_MODULE, name.c_str(), nullptr);
}

void FstFile::close_scope() {
  fstWriterSetUpscope(writer_);
}

FstFile::Signal FstFile::add(const std::string& name, Kind kind, unsigned width) {
  const fstVarType type = kind == Kind::real   ? FST_VT_VCD_REAL
                          : kind == Kind::text ? FST_VT_GEN_STRING
                                               : FST_VT_VCD_WIRE;
  Variable variable;
  variable.kind = kind;
  variable.width = width;
  variable.handle = fstWriterCreateVar(writer_, type, FST_VD_IMPLICIT, width, name.c_str(), 0);
  variables_.push_back(variable);
  return static_cast<Signal>(variables_.size() - 1);
}

FstFile::Signal FstFile::add_bits(const std::string& name, unsigned width) {
  const std::string range = width == 1 ? "" : fmt::format(" [{}:0]", width - 1);
  return add(name + range, Kind::bits, width);
}

FstFile::Signal FstFile::add_real(const std::string& name) {
  return add(name, Kind::real, sizeof(double));
}

FstFile::Signal FstFile::add_text(const std::string& name) {
  return add(name, Kind::text, 0);
}

void FstFile::announce(uint64_t picoseconds, Change change) {
  waiting_.emplace(picoseconds, std::move(change));
}

void FstFile::set(uint64_t picoseconds, Signal signal, uint64_t value) {
  announce(picoseconds, {signal, value, {}});
}

void FstFile::set_real(uint64_t picoseconds, Signal signal, double value) {
  uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  announce(picoseconds, {signal, bits, {}});
}

void FstFile::set_text(uint64_t picoseconds, Signal signal, const std::string& text) {
  announce(picoseconds, {signal, 0, text});
}

void FstFile::emit(const Change& change) {
  Variable& variable = variables_[change.signal];
  std::string now = change.text;
  if (variable.kind != Kind::text) {
    now.resize(sizeof change.bits);
    std::memcpy(now.data(), &change.bits, sizeof change.bits);
  }
  if (variable.last == now) return;
  variable.last = now;
  switch (variable.kind) {
    case Kind::bits:
      fstWriterEmitValueChange64(writer_, variable.handle, variable.width, change.bits);
      break;
    case Kind::real:
      fstWriterEmitValueChange(writer_, variable.handle, &change.bits);
      break;
    case Kind::text:
      fstWriterEmitVariableLengthValueChange(writer_, variable.handle, change.text.data(),
                                             static_cast<uint32_t>(change.text.size()));
      break;
  }
}

void FstFile::flush(uint64_t picoseconds) {
  while (!waiting_.empty() && waiting_.begin()->first < picoseconds) {
    const uint64_t time = waiting_.begin()->first;
    fstWriterEmitTimeChange(writer_, time);
    for (; !waiting_.empty() && waiting_.begin()->first == time; waiting_.erase(waiting_.begin()))
      emit(waiting_.begin()->second);
  }
}

std::optional<Error> FstFile::finish(uint64_t picoseconds) {
  flush(picoseconds + 1);
  waiting_.clear();  // ends of transfers that the run did not reach
  fstWriterEmitTimeChange(writer_, picoseconds);
  fstWriterFlushContext(writer_);
  fstWriterClose(writer_);
  writer_ = nullptr;
  return file_.finish();
}

}  // namespace capsoc::trace
