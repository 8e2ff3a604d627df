// The session: one process that owns clients and files, and has each simulation in a worker
// process.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/descriptor.h"
#include "host/file_uses.h"
#include "host/temporary_folder.h"
#include "service/history.h"
#include "service/message.h"
#include "service/outbox.h"
#include "service/verb.h"
#include "service/worker.h"

namespace capsoc::service {

/// Where clients come from.
struct Door {
  host::Descriptor listener;  ///< none: the one client is on stdin and stdout
  std::string token;          ///< that a client has to show first; "": none
  bool checks_user = false;   ///< only processes of the same user may connect
  /// Below which clients may have files written, and then they may name no library; "": what this
  /// process may do they may do.
  std::string writes_in;
};

class Session {
 public:
  explicit Session(Door door);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Serves until session.end, a signal, or the end of standard input. Returns once all workers
  /// have ended.
  void serve();

 private:
  struct Client;
  struct Simulation;
  struct Spare;
  /// Outcome of a call: an answer of the worker, or the loss of the worker.
  using Take = std::function<void(Answer answer)>;
  struct Request {
    uint64_t client;
    Json id;
    std::string method;
    Json parameters;
    Frames frames;
  };
  using Handler = void (Session::*)(Request& request);
  struct SessionVerb {
    Declaration about;
    bool of_simulation;
    Handler perform;
  };

 public:
  /// Of all methods: {"methods": [...]}.
  static Json schema();

 private:
  static const std::vector<SessionVerb>& verbs();
  static std::vector<SessionVerb> own_verbs();
  static std::vector<SessionVerb> history_verbs();
  bool waits(Request& request);
  static Answer no_such_method(const std::string& method);

  // Input and output.
  void send();
  void wait();
  void accept();
  void read_client(Client& client);
  void read_worker(Simulation& simulation);
  void take(Client& client, Message message);
  void take_answer(Simulation& simulation, Message message);
  void answer(const Request& request, Answer answer);
  void answer_client(uint64_t client, const Json& id, Answer answer);

  // Requests.
  void perform(Request& request);
  void about(Request& request);
  void tell_schema(Request& request);
  void authenticate(Request& request);
  void list(Request& request);
  void end(Request& request);
  void construct(Request& request);
  void close(Request& request);
  void interrupt(Request& request);
  void snapshot(Request& request);
  void restore(Request& request);
  void clone(Request& request);
  void drop(Request& request);
  void forward(Request& request);
  void hand_on(Simulation& simulation, Request& request);
  void resume(std::deque<Request> waiting);
  void settle(const Request& request, Answer final_answer);
  void finish_restore(const Request& request, uint64_t number, uint64_t fresh, Answer constructed);
  /// Clones under way.
  struct Family {
    uint64_t left = 0;
    std::vector<uint64_t> numbers;
    Answer refusal;
  };
  void finish_clone(const Request& request, Family& family);

  // Going back.
  struct Seek;
  void go_to(Request& request);
  void go_back(Request& request);
  void select_history(Request& request);
  void find_write(Request& request);
  void find_change(Request& request);
  Json goals_of(Request& request);
  void compare(Request& request);
  void ask_between(Request& request, const char* method, Json parameters);
  void tell_past(Request& request);
  void trace_past(Request& request);
  void explain(Request& request);
  void reverse(Request& request);
  void seek(Request& request, Json leave, std::function<void(Json, std::shared_ptr<Seek>)> then);
  void end_seek(const Seek& seek, Answer answer);
  void find(Request& request, Json what,
            std::function<void(const std::shared_ptr<Seek>&, Json)> found);
  void search(const std::shared_ptr<Seek>& seek, std::size_t part);
  static bool is_long(const Seek& seek, std::size_t part, const Position& end);
  void search_part(const std::shared_ptr<Seek>& seek, std::size_t part, const Position& end,
                   unsigned in_vain = 0);
  void search_before(const std::shared_ptr<Seek>& seek, std::size_t part);
  void narrow(const std::shared_ptr<Seek>& seek, std::size_t part, const Position& end,
              unsigned in_vain);
  void ask_search(const std::shared_ptr<Seek>& seek, Json begin, Json what, const Position& end,
                  bool is_first, std::function<void(Json found)> take);
  void search_from(const std::shared_ptr<Seek>& seek, Json begin, const Position& end,
                   bool is_first, std::function<void(const Position& from)> not_found);
  void refine(const std::shared_ptr<Seek>& seek, Json found);
  void replace(const std::shared_ptr<Seek>& seek, Json goal, Json more);
  void ask_past(const std::shared_ptr<Seek>& seek, Json how, std::string method, Json parameters,
                Frames frames, Take take);

  // Simulations.
  using Files = std::shared_ptr<host::TemporaryFolder>;
  struct Snapshot {
    Json settings, held;
    Frames frames;
    Files files = nullptr;
  };
  using Taken = std::function<void(std::optional<Snapshot> snapshot, Answer refusal)>;
  /// Null, and the request is answered, if there is none of that number.
  Simulation* simulation_of(const Request& request);
  /// Adds a worker and constructs in it; `done` gets its number, or the refusal.
  using Constructed = std::function<void(uint64_t number, Answer answer)>;
  /// `instead_of` as in Simulation.
  void start(uint64_t client, const Snapshot& from, Constructed done, uint64_t instead_of = 0);
  void start_with(uint64_t client, Json settings, Json parameters, Frames frames, Files files,
                  Constructed done, uint64_t instead_of = 0);
  std::optional<Error> check_outputs(const std::vector<host::FileUse>& outputs,
                                     uint64_t instead_of) const;
  /// What starts a worker in the past, and what it is to do there.
  struct Start {
    std::shared_ptr<Seek> seek;
    uint64_t client;
    Json how;
    Constructed done;
  };
  void start_past(const std::shared_ptr<Seek>& seek, uint64_t client, Json how, Constructed done);
  bool is_refused(const Start& start);
  void start_alone(Start start);
  void start_by_spare(Start start);
  void start_spare(Start start);
  void ask_history(Start start, void (Session::*then)(Start start));
  void fork_by_spare(Start start, Simulation& spare);
  void take_fork(Start start, WorkerProcess worker, uint64_t first);
  Simulation* spare_of(uint64_t simulation);
  bool make_room_for_spare();
  void spare_has_failed(Start start, Answer answer);
  static bool was_forking(const Simulation& simulation);
  void end_strays();
  std::function<void()> close_others();
  bool is_full() const;
  Take when_constructed(uint64_t number, Constructed done);
  void drop_worker(uint64_t number);
  /// With an id the worker's answer is a frame: the bytes for the client.
  void call(Simulation& simulation, const std::string& method, Json parameters, Frames frames,
            Take take, const Json& id = Json(Json::value_t::discarded));
  void take_snapshot(Simulation& simulation, Taken taken);
  void end_worker(Simulation& simulation);
  void end_simulation(uint64_t number, const std::string& why);
  void refuse_pending(Simulation& simulation, const std::string& sentence);
  void reap();
  void worker_is_gone(Simulation& simulation, int status);
  void client_is_gone(Client& client);
  void tidy();

  Door door_;
  std::map<uint64_t, std::unique_ptr<Client>> clients_;
  std::map<uint64_t, std::unique_ptr<Simulation>> simulations_;
  std::vector<std::unique_ptr<Simulation>> ending_;  ///< closed; their processes are on their way
  std::map<uint64_t, std::shared_ptr<const Snapshot>> snapshots_;
  std::map<uint64_t, std::string> ended_;  ///< why a number stands for nothing any more
  SharedPlaces places_;
  /// Numbers of spares are none of simulations, which clients count.
  static constexpr uint64_t first_spare = uint64_t{1} << 62U;
  uint64_t next_spare_ = first_spare, next_use_ = 1;
  uint64_t next_client_ = 1, next_simulation_ = 1, next_snapshot_ = 1, next_call_ = 1;
  bool is_ending_ = false;
};

}  // namespace capsoc::service
