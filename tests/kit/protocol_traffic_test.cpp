// Legal traffic, random, of all kinds at once: no monitor reports anything.
#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "base/random.h"
#include "protocol_bench.h"

TLM_DECLARE_EXTENDED_PHASE(first_beat);

namespace capsoc::test {
namespace {

using Time = sc_core::sc_time;

/// Initiator and target of several transactions at a time, each phase of which comes when it may.
class Traffic {
 public:
  Traffic(ProtocolBench& bench, uint64_t seed) : b_(bench), random_(seed) {
    b_.target.on_nb = [this](Payload& p, tlm::tlm_phase& phase, Time& delay) {
      return target_gets(p, phase, delay);
    };
    b_.initiator.on_nb = [this](Payload& p, tlm::tlm_phase& phase, Time& delay) {
      return initiator_gets(p, phase, delay);
    };
    b_.target.on_b = [this](Payload& p, Time& delay) {
      p.set_dmi_allowed(chance(2));
      if (chance(8)) p.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      delay += time();
    };
    b_.interconnect.after = [this](Payload& p) {
      if (chance(4)) p.set_dmi_allowed(false);
    };
  }

  void step() {
    switch (below(9)) {
      case 0:
        return block();
      case 1:
        return debug();
      case 2:
        return ask_for_memory();
      case 3:
        return b_.target.socket->invalidate_direct_mem_ptr(4, 4 + below(100));
      case 4:
        return begin();
      case 5:
        return end_request();
      case 6:
        return respond();
      case 7:
        return end_response();
      default:
        return mark();
    }
  }
  uint64_t completed() const { return completed_; }

 private:
  enum class State { requested, accepted, responding };
  struct Transaction {
    std::unique_ptr<ManagedRequest> request;
    State state = State::requested;
    Time delay;
  };

  uint64_t below(uint64_t n) { return random_.below(n); }
  bool chance(uint64_t n) { return below(n) == 0; }
  Time time() { return {static_cast<double>(below(50)), sc_core::SC_NS}; }

  void fill(Request& r) {
    const tlm::tlm_command commands[] = {tlm::TLM_READ_COMMAND, tlm::TLM_WRITE_COMMAND,
                                         tlm::TLM_IGNORE_COMMAND};
    const auto length = static_cast<unsigned>(1 + below(16));
    r.renew(commands[below(3)], length);
    r.payload.set_address(target_base + below(target_size - 16));
    if (chance(3)) r.payload.set_streaming_width(static_cast<unsigned>(1 + below(20)));
    for (unsigned char& enable : r.enables) enable = chance(2) ? 0xff : 0;
    if (chance(3)) r.use_enables(static_cast<unsigned>(1 + below(16)));
    if (r.payload.get_command() == tlm::TLM_IGNORE_COMMAND && chance(2))
      r.payload.set_data_ptr(nullptr);
  }

  void block() {
    Request r;
    fill(r);
    Time delay = time();
    b_.initiator.socket->b_transport(r.payload, delay);
  }
  void debug() {
    Request r;
    fill(r);
    if (r.payload.get_data_ptr() == nullptr) r.payload.set_data_length(0);
    b_.target.on_debug = [this](Payload& p) {
      return static_cast<unsigned>(below(p.get_data_length() + 1));
    };
    b_.initiator.socket->transport_dbg(r.payload);
  }
  void ask_for_memory() {
    Request r(chance(2) ? tlm::TLM_READ_COMMAND : tlm::TLM_WRITE_COMMAND);
    tlm::tlm_dmi dmi;
    b_.initiator.socket->get_direct_mem_ptr(r.payload, dmi);
  }

  Transaction* in(State state) {
    for (Transaction& each : under_way_)
      if (each.state == state) return &each;
    return nullptr;
  }
  Transaction* of(const Payload& p) {
    for (Transaction& each : under_way_)
      if (&each.request->payload == &p) return &each;
    return nullptr;
  }
  void complete(const Payload& p) {
    ++completed_;
    for (auto each = under_way_.begin(); each != under_way_.end(); ++each)
      if (&each->request->payload == &p) {
        under_way_.erase(each);
        return;
      }
  }

  void begin() {
    if (in(State::requested) != nullptr || under_way_.size() > 4) return;
    under_way_.emplace_back();
    Transaction& new_one = under_way_.back();
    new_one.request = std::make_unique<ManagedRequest>();
    fill(*new_one.request);
    new_one.request->manage();
    Payload& p = new_one.request->payload;
    tlm::tlm_phase phase = tlm::BEGIN_REQ;
    Time delay = new_one.delay = time();
    const Sync status = b_.initiator.socket->nb_transport_fw(p, phase, delay);
    if (status == tlm::TLM_COMPLETED) return complete(p);
    if (status != tlm::TLM_UPDATED) return;
    new_one.state = phase == tlm::END_REQ ? State::accepted : State::responding;
    new_one.delay = delay;
  }

  Sync target_gets(Payload& p, tlm::tlm_phase& phase, Time& delay) {
    if (phase == tlm::END_RESP) return chance(2) ? tlm::TLM_COMPLETED : tlm::TLM_ACCEPTED;
    if (phase != tlm::BEGIN_REQ || chance(2)) return tlm::TLM_ACCEPTED;
    delay += time();
    if (chance(2) || in(State::responding) != nullptr) {
      phase = tlm::END_REQ;
      return tlm::TLM_UPDATED;
    }
    TestTarget::execute(p);
    phase = tlm::BEGIN_RESP;
    return chance(2) ? tlm::TLM_UPDATED : tlm::TLM_COMPLETED;
  }

  void end_request() {
    Transaction* const transaction = in(State::requested);
    if (transaction == nullptr) return;
    transaction->state = State::accepted;
    b_.target.nb_transport(transaction->request->payload, tlm::END_REQ, transaction->delay);
  }

  /// Of any transaction that waits, not the first, and with END_REQ left out or not.
  void respond() {
    if (in(State::responding) != nullptr || under_way_.empty()) return;
    Transaction& transaction = under_way_[below(under_way_.size())];
    Payload& p = transaction.request->payload;
    transaction.state = State::responding;
    TestTarget::execute(p);
    transaction.delay += time();
    const Sync status = b_.target.nb_transport(p, tlm::BEGIN_RESP, transaction.delay);
    if (status != tlm::TLM_ACCEPTED) complete(p);
  }

  Sync initiator_gets(Payload&, tlm::tlm_phase& phase, Time& delay) {
    if (phase != tlm::BEGIN_RESP || chance(2)) return tlm::TLM_ACCEPTED;
    delay += time();
    phase = tlm::END_RESP;
    return chance(2) ? tlm::TLM_UPDATED : tlm::TLM_COMPLETED;
  }

  void end_response() {
    Transaction* const transaction = in(State::responding);
    if (transaction == nullptr) return;
    Payload& p = transaction->request->payload;
    b_.initiator.nb_transport(p, tlm::END_RESP, transaction->delay);
    complete(p);
  }

  /// An ignorable phase, in either direction.
  void mark() {
    if (under_way_.empty()) return;
    Transaction& transaction = under_way_[below(under_way_.size())];
    Payload& p = transaction.request->payload;
    if (chance(2))
      b_.initiator.nb_transport(p, first_beat, transaction.delay);
    else
      b_.target.nb_transport(p, first_beat, transaction.delay);
  }

  ProtocolBench& b_;
  Random random_;
  std::deque<Transaction> under_way_;
  uint64_t completed_ = 0;
};

TEST(ProtocolTraffic, ThatIsLegalIsNotReported) {
  ProtocolBench& b = protocol_bench();
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    b.renew();
    Traffic traffic(b, seed);
    for (int i = 0; i < 5000; ++i) traffic.step();
    EXPECT_EQ(b.said, "") << "seed " << seed;
    EXPECT_GT(traffic.completed(), 300u);
    if (!b.broken.empty()) break;
  }
  b.renew();
}

}  // namespace
}  // namespace capsoc::test
