// The settings of the coprocessor.
#pragma once

#include "base/setting_fields.h"
#include "coprocessor/sequencer.h"
#include "coprocessor/types.h"
#include "rtl/coprocessor_rtl.h"

namespace capsoc::run {

enum class Backend { model, rtl, lockstep };

struct CoprocessorSettings {
  Settings& all;
  ChoiceField<coprocessor::Arithmetic> arithmetic{
      all,
      {{"paper", coprocessor::Arithmetic::paper}, {"precise", coprocessor::Arithmetic::precise}},
      setting("coprocessor.arithmetic", SettingKind::choice, "precise", "paper or precise")
          .by({"--arithmetic", "paper|precise", "Arithmetic of the coprocessor"})};
  IntegerField paper_operand_bits{
      all, setting("coprocessor.paper_operand_bits", SettingKind::integer, "32",
                   "paper: width of the arctangent's multipliers (the SoC paper's Table 8: 16)")
               .in(2, 32)};
  IntegerField paper_reference_lead{
      all, setting("coprocessor.paper_reference_lead", SettingKind::integer, "0",
                   "paper: samples by which the reference leads the data (Table 8: 2)")
               .in(0, 1024)};
  IntegerField paper_step_shift{
      all, setting("coprocessor.paper_step_shift", SettingKind::integer, "0",
                   "paper: right shift of the steps after their registers (Table 8: 7)")
               .in(0, 31)};
  FlagField paper_plain_arctangent{
      all, setting("coprocessor.paper_plain_arctangent", SettingKind::flag, "false",
                   "paper: the arctangent's input neither shifted nor folded (Table 8: true)")};
  IntegerField paper_iteration_clocks{
      all, setting("coprocessor.paper_iteration_clocks", SettingKind::integer, "1",
                   "paper: clocks of an iteration of the arctangent; 2: results after 321 clocks")
               .in(1, 2)};
  // Not in results unless it is set.
  IntegerField channels{all, of_several_channels()};
  ChoiceField<Backend> backend{
      all,
      {{"tlm", Backend::model}, {"rtl", Backend::rtl}, {"lockstep", Backend::lockstep}},
      setting("coprocessor.backend", SettingKind::choice, "tlm",
              "tlm (model), rtl (Verilated) or lockstep (both, compared)")
          .is_host_side()
          .by({"--coprocessor", "tlm|rtl|lockstep",
               "The model, the Verilated RTL, or both compared"})};
  TextField rtl_library{
      all, setting("coprocessor.rtl_library", SettingKind::input, "",
                   "Verilated coprocessor; empty: the build's own")
               .is_host_side()
               .by({"--rtl-library", "FILE.so", "Verilated coprocessor (default: the build's)"})};
  ChoiceField<rtl::Clocking> rtl_clock{
      all,
      {{"skip", rtl::Clocking::skip}, {"every", rtl::Clocking::every}},
      setting("coprocessor.rtl_clock", SettingKind::choice, "skip",
              "skip idle clocks or make every one; same results")
          .is_host_side()
          .by({"--rtl-clock", "skip|every", "Clocks of the idle RTL; changes speed only"})};
  TextField waves{
      all, setting("results.waves", SettingKind::output, "",
                   "FST file: of the SoC, of the RTL, or of both sides around a difference")
               .is_place()
               .by({"--waves", "FILE.fst",
                    "Waves of the SoC, of the RTL's inside, or with lockstep of both around a "
                    "difference"})};

  /// What the device is made with.
  coprocessor::Options options() const;

 private:
  static Setting of_several_channels() {
    Setting declared =
        setting("coprocessor.channels", SettingKind::integer, "1",
                "sensors that share the coprocessor; with more than one it has CHANNEL")
            .in(1, coprocessor::most_channels);
    declared.optional = true;
    return declared;
  }
};

}  // namespace capsoc::run
