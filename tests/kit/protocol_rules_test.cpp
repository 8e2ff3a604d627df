// Each rule of the base protocol is broken once, by the component that can break it: the monitors
// name that rule and no other.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "protocol_bench.h"

TLM_DECLARE_EXTENDED_PHASE(beside_the_protocol);

namespace capsoc::test {
namespace {

using kit::ProtocolRule;
using Fault = std::function<void(ProtocolBench&)>;
using Faults = std::multimap<ProtocolRule, Fault>;
using Time = sc_core::sc_time;

const Time ten_ns(10, sc_core::SC_NS);

struct Mark : tlm::tlm_extension<Mark> {
  tlm::tlm_extension_base* clone() const override { return new Mark(*this); }
  void copy_from(const tlm::tlm_extension_base&) override {}
};

/// The initiator passes a request that a test has spoilt.
Fault request(const std::function<void(Request&)>& spoil,
              tlm::tlm_command command = tlm::TLM_READ_COMMAND) {
  return [=](ProtocolBench& b) {
    Request r(command);
    spoil(r);
    b.initiator.b_transport(r.payload);
  };
}

/// The target does something to a request that is legal.
Fault at_target(const std::function<void(Payload&)>& spoil,
                tlm::tlm_command command = tlm::TLM_WRITE_COMMAND) {
  return [=](ProtocolBench& b) {
    b.target.on_b = [&](Payload& payload, Time&) { spoil(payload); };
    Request r(command);
    r.use_enables(4);
    b.initiator.b_transport(r.payload);
  };
}

/// The interconnect does something, before it passes a request on and after.
Fault between(const std::function<void(Payload&)>& before,
              const std::function<void(Payload&)>& after,
              tlm::tlm_command command = tlm::TLM_READ_COMMAND) {
  return [=](ProtocolBench& b) {
    b.interconnect.before = before;
    b.interconnect.after = after;
    Request r(command);
    b.initiator.b_transport(r.payload);
  };
}

/// The target's answer to a request for direct memory.
Fault grant(const std::function<void(tlm::tlm_dmi&)>& spoil,
            tlm::tlm_command command = tlm::TLM_READ_COMMAND) {
  return [=](ProtocolBench& b) {
    b.target.on_dmi = [&](Payload&, tlm::tlm_dmi& dmi) { spoil(dmi); };
    Request r(command);
    tlm::tlm_dmi dmi;
    b.initiator.socket->get_direct_mem_ptr(r.payload, dmi);
  };
}

/// A managed request; the target accepts every phase.
Fault phases(const std::function<void(ProtocolBench&, Payload&)>& calls) {
  return [=](ProtocolBench& b) {
    b.target.on_nb = [](Payload&, tlm::tlm_phase&, Time&) { return tlm::TLM_ACCEPTED; };
    ManagedRequest r;
    r.manage();
    calls(b, r.payload);
    b.watch.forget_transactions();
  };
}

void break_attributes(Faults& faults) {
  using Rule = ProtocolRule;
  faults.insert({
      {Rule::data_pointer_null, request([](Request& r) { r.payload.set_data_ptr(nullptr); })},
      {Rule::data_length_zero, request([](Request& r) { r.payload.set_data_length(0); })},
      {Rule::byte_enable_length_zero, request([](Request& r) { r.use_enables(0); })},
      {Rule::byte_enable_value, request([](Request& r) {
         r.enables[1] = 0x0f;
         r.use_enables(4);
       })},
      {Rule::streaming_width_zero, request([](Request& r) { r.payload.set_streaming_width(0); })},
      {Rule::dmi_hint_set, request([](Request& r) { r.payload.set_dmi_allowed(true); })},
      {Rule::response_set,
       request([](Request& r) { r.payload.set_response_status(tlm::TLM_OK_RESPONSE); })},
      {Rule::option_set,
       request([](Request& r) { r.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD); })},
      {Rule::command_changed, at_target([](Payload& p) { p.set_read(); })},
      {Rule::command_changed,
       between([](Payload& p) { p.set_write(); }, [](Payload& p) { p.set_read(); })},
      {Rule::data_length_changed, at_target([](Payload& p) { p.set_data_length(2); })},
      {Rule::byte_enable_pointer_changed,
       at_target([](Payload& p) { p.set_byte_enable_ptr(nullptr); })},
      {Rule::byte_enable_length_changed,
       at_target([](Payload& p) { p.set_byte_enable_length(2); })},
      {Rule::byte_enables_changed,
       at_target([](Payload& p) { p.get_byte_enable_ptr()[1] = 0xff; })},
      {Rule::streaming_width_changed, at_target([](Payload& p) { p.set_streaming_width(1); })},
      {Rule::option_changed, at_target([](Payload& p) { p.set_gp_option(tlm::TLM_FULL_PAYLOAD); })},
      {Rule::write_data_changed, at_target([](Payload& p) { ++*p.get_data_ptr(); })},
      {Rule::write_data_changed,
       between([](Payload& p) { ++*p.get_data_ptr(); }, [](Payload& p) { --*p.get_data_ptr(); },
               tlm::TLM_WRITE_COMMAND)},
      {Rule::disabled_bytes_changed,
       at_target([](Payload& p) { ++p.get_data_ptr()[1]; }, tlm::TLM_READ_COMMAND)},
  });
  static unsigned char elsewhere[4];
  static unsigned char* given;
  faults.insert({Rule::data_pointer_changed,
                 between(
                     [](Payload& p) {
                       given = p.get_data_ptr();
                       p.set_data_ptr(elsewhere);
                     },
                     [](Payload& p) { p.set_data_ptr(given); }, tlm::TLM_WRITE_COMMAND)});
}

void break_responses(Faults& faults) {
  using Rule = ProtocolRule;
  static Mark mark;
  faults.insert({
      {Rule::address_changed, at_target([](Payload& p) { p.set_address(4); })},
      // What came from upstream is put back: too late, the target has it.
      {Rule::address_changed,
       between({}, [](Payload& p) { p.set_address(p.get_address() + target_base); })},
      {Rule::extension_left,
       [](ProtocolBench& b) {
         b.target.on_b = [](Payload& p, Time&) { p.set_extension(&mark); };
         Request r;
         b.initiator.b_transport(r.payload);
         r.payload.clear_extension<Mark>();
       }},
      {Rule::extension_lost,
       [](ProtocolBench& b) {
         b.target.on_b = [](Payload& p, Time&) { p.clear_extension<Mark>(); };
         Request r;
         r.payload.set_extension(&mark);
         b.initiator.b_transport(r.payload);
       }},
      {Rule::response_missing,
       at_target([](Payload& p) { p.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE); })},
      {Rule::response_changed,
       between({}, [](Payload& p) { p.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE); })},
      {Rule::read_data_changed, between({}, [](Payload& p) { ++*p.get_data_ptr(); })},
      {Rule::dmi_hint_raised, between({}, [](Payload& p) { p.set_dmi_allowed(true); })},
  });
}

void break_calls(Faults& faults) {
  using Rule = ProtocolRule;
  faults.insert({Rule::memory_manager_left, [](ProtocolBench& b) {
                   struct : tlm::tlm_mm_interface {
                     void free(Payload*) override {}
                   } manager;
                   b.target.on_b = [&](Payload& p, Time&) { p.set_mm(&manager); };
                   Request r;
                   b.initiator.b_transport(r.payload);
                   r.payload.set_mm(nullptr);
                 }});
  faults.insert({Rule::reference_count, [](ProtocolBench& b) {
                   ManagedRequest r;
                   r.manage();
                   r.payload.release();
                   b.initiator.b_transport(r.payload);
                 }});
  faults.insert({Rule::called_from_method, [](ProtocolBench& b) {
                   sc_core::sc_spawn_options options;
                   options.spawn_method();
                   const std::function<void()> call = [&] {
                     Request r;
                     b.initiator.b_transport(r.payload);
                   };
                   sc_core::sc_spawn(call, sc_core::sc_gen_unique_name("method"), &options);
                   sc_core::sc_start(ten_ns);
                 }});
  faults.insert({Rule::called_again, [](ProtocolBench& b) {
                   b.target.on_b = [&](Payload& p, Time& delay) {
                     b.target.on_b = nullptr;
                     const uint64_t address = p.get_address();
                     b.initiator.socket->b_transport(p, delay);
                     p.set_address(address);
                   };
                   Request r(tlm::TLM_IGNORE_COMMAND);
                   b.initiator.b_transport(r.payload);
                 }});
  faults.insert({Rule::mixed_transport, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   b.initiator.b_transport(p);
                 })});
  faults.insert({Rule::time_decreased, [](ProtocolBench& b) {
                   b.target.on_b = [](Payload&, Time& delay) { delay = sc_core::SC_ZERO_TIME; };
                   Request r;
                   Time delay = ten_ns;
                   b.initiator.socket->b_transport(r.payload, delay);
                 }});
  faults.insert({Rule::time_decreased, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ, ten_ns);
                   b.target.nb_transport(p, tlm::END_REQ);
                 })});
}

void break_phases(Faults& faults) {
  using Rule = ProtocolRule;
  faults.insert({Rule::memory_manager_missing, [](ProtocolBench& b) {
                   Request r;
                   b.initiator.nb_transport(r.payload, tlm::BEGIN_REQ);
                 }});
  faults.insert({Rule::nb_waits, phases([](ProtocolBench& b, Payload& p) {
                   b.target.on_nb = [](Payload&, tlm::tlm_phase&, Time&) {
                     sc_core::wait(ten_ns);
                     return tlm::TLM_ACCEPTED;
                   };
                   ProtocolBench::in_thread(
                       [&] { b.initiator.nb_transport(p, tlm::BEGIN_REQ, ten_ns); });
                 })});
  faults.insert({Rule::accepted_changed, phases([](ProtocolBench& b, Payload& p) {
                   b.target.on_nb = [](Payload&, tlm::tlm_phase&, Time& delay) {
                     delay += ten_ns;
                     return tlm::TLM_ACCEPTED;
                   };
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                 })});
  faults.insert({Rule::phase_direction, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::END_REQ);
                 })});
  faults.insert({Rule::phase_direction, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   b.target.nb_transport(p, tlm::END_RESP);
                 })});
  faults.insert({Rule::phase_order, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   b.initiator.nb_transport(p, tlm::END_RESP);
                 })});
  faults.insert({Rule::phase_order, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   b.target.nb_transport(p, tlm::END_REQ);
                   b.target.nb_transport(p, tlm::END_REQ);
                 })});
  faults.insert({Rule::phase_outside, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, beside_the_protocol);
                 })});
  faults.insert({Rule::completion, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   b.initiator.on_nb = [](Payload&, tlm::tlm_phase&, Time&) {
                     return tlm::TLM_COMPLETED;
                   };
                   b.target.nb_transport(p, tlm::END_REQ);
                 })});
  faults.insert({Rule::request_exclusion, phases([](ProtocolBench& b, Payload& p) {
                   ManagedRequest other;
                   other.manage();
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   b.initiator.nb_transport(other.payload, tlm::BEGIN_REQ);
                 })});
  faults.insert({Rule::response_exclusion, phases([](ProtocolBench& b, Payload& p) {
                   ManagedRequest other;
                   other.manage();
                   for (Payload* each : {&p, &other.payload}) {
                     b.initiator.nb_transport(*each, tlm::BEGIN_REQ);
                     b.target.nb_transport(*each, tlm::END_REQ);
                   }
                   for (Payload* each : {&p, &other.payload}) {
                     TestTarget::execute(*each);
                     b.target.nb_transport(*each, tlm::BEGIN_RESP);
                   }
                 })});
  faults.insert({Rule::response_before_target, phases([](ProtocolBench& b, Payload& p) {
                   b.initiator.nb_transport(p, tlm::BEGIN_REQ);
                   TestTarget::execute(p);
                   tlm::tlm_phase phase = tlm::BEGIN_RESP;
                   Time delay;
                   b.interconnect.target->nb_transport_bw(p, phase, delay);
                 })});
}

void break_direct_memory(Faults& faults) {
  using Rule = ProtocolRule;
  faults.insert({Rule::dmi_descriptor_used, [](ProtocolBench& b) {
                   Request r;
                   tlm::tlm_dmi dmi;
                   dmi.set_end_address(0xff);
                   b.initiator.socket->get_direct_mem_ptr(r.payload, dmi);
                 }});
  faults.insert({Rule::dmi_range_order, grant([](tlm::tlm_dmi& dmi) {
                   dmi.set_start_address(0x20);
                   dmi.set_end_address(0x10);
                 })});
  faults.insert(
      {Rule::dmi_range_address, grant([](tlm::tlm_dmi& dmi) { dmi.set_start_address(0x800); })});
  faults.insert(
      {Rule::dmi_pointer_null, grant([](tlm::tlm_dmi& dmi) { dmi.set_dmi_ptr(nullptr); })});
  faults.insert({Rule::dmi_access,
                 grant([](tlm::tlm_dmi& dmi) { dmi.allow_read(); }, tlm::TLM_WRITE_COMMAND)});
  faults.insert({Rule::dmi_waits, [](ProtocolBench& b) {
                   ProtocolBench::in_thread([&] {
                     grant([](tlm::tlm_dmi&) { sc_core::wait(sc_core::SC_ZERO_TIME); })(b);
                   });
                 }});
  faults.insert({Rule::dmi_in_invalidation, [](ProtocolBench& b) {
                   b.initiator.on_invalidate = [&] { grant([](tlm::tlm_dmi&) {})(b); };
                   b.target.socket->invalidate_direct_mem_ptr(0, 0xf);
                 }});
  faults.insert({Rule::invalidation_order,
                 [](ProtocolBench& b) { b.target.socket->invalidate_direct_mem_ptr(0x10, 0xf); }});
}

void break_debug(Faults& faults) {
  using Rule = ProtocolRule;
  faults.insert({Rule::debug_pointer_null, [](ProtocolBench& b) {
                   Request r;
                   r.payload.set_data_ptr(nullptr);
                   b.initiator.socket->transport_dbg(r.payload);
                 }});
  faults.insert({Rule::debug_count, [](ProtocolBench& b) {
                   b.target.on_debug = [](Payload& p) { return p.get_data_length() + 1; };
                   Request r;
                   b.initiator.socket->transport_dbg(r.payload);
                 }});
  faults.insert({Rule::debug_waits, [](ProtocolBench& b) {
                   b.target.on_debug = [](Payload&) {
                     sc_core::wait(ten_ns);
                     return 4u;
                   };
                   Request r;
                   ProtocolBench::in_thread([&] { b.initiator.socket->transport_dbg(r.payload); });
                 }});
  faults.insert({Rule::data_length_changed, [](ProtocolBench& b) {
                   b.target.on_debug = [](Payload& p) {
                     p.set_data_length(2);
                     return 2u;
                   };
                   Request r;
                   b.initiator.socket->transport_dbg(r.payload);
                 }});
}

Faults all_faults() {
  Faults faults;
  break_attributes(faults);
  break_responses(faults);
  break_calls(faults);
  break_phases(faults);
  break_direct_memory(faults);
  break_debug(faults);
  return faults;
}

TEST(ProtocolRules, EachIsNamedWhereItIsBrokenAndNoOther) {
  const Faults faults = all_faults();
  ProtocolBench& b = protocol_bench();
  for (const kit::ProtocolRuleText& rule : kit::protocol_rules) {
    EXPECT_NE(faults.count(rule.rule), 0u) << rule.name << " has no test";
    const auto [first, last] = faults.equal_range(rule.rule);
    for (auto fault = first; fault != last; ++fault) {
      b.renew();
      fault->second(b);
      EXPECT_EQ(b.broken, std::set{rule.rule}) << rule.name << "\n" << b.said;
    }
  }
}

TEST(ProtocolRules, AReportNamesTheMonitorTheClauseAndTheTransaction) {
  ProtocolBench& b = protocol_bench();
  b.renew();
  Request r;
  r.payload.set_streaming_width(0);
  b.initiator.b_transport(r.payload);
  EXPECT_EQ(b.said.substr(0, b.said.find('\n')),
            "near: streaming_width_zero (IEEE 1666-2011, 14.15 f): The streaming width is not 0. "
            "Here: read of 4 bytes at 0x00001010");
}

TEST(ProtocolRules, WithoutAListenerAViolationIsAReportOfSystemC) {
  kit::ProtocolWatch watch;
  kit::ProtocolChecker checker(watch, "alone", kit::Downstream::unknown);
  sc_core::sc_report_handler::set_actions("/capsoc/protocol", sc_core::SC_THROW);
  EXPECT_THROW(checker.invalidate_direct_mem_ptr(
                   *protocol_bench().near.from_initiator.get_base_port()[0], 2, 1),
               sc_core::sc_report);
  sc_core::sc_report_handler::set_actions("/capsoc/protocol", sc_core::SC_UNSPECIFIED);
  EXPECT_EQ(watch.violations(), 1u);
}

}  // namespace
}  // namespace capsoc::test
