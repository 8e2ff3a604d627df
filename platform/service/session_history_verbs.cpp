// The methods of a session that go back, or ask the past, as clients see them. What they do is in
// session_history.cpp.
#include "service/session.h"

namespace capsoc::service {

std::vector<Session::SessionVerb> Session::history_verbs() {
  const Member state{"state", "object", "as simulation.state"};
  const Parameter every = may("every_s", Type::number,
                              "how often to look at first: 1 ms of simulated time; a value that "
                              "comes and goes between two looks is not seen");
  return {
      {{"simulation.goto",
        "To the first instant at which a time or a count is reached, back or forward. Going back, "
        "the inputs of then take place again; what the UARTs sent and which events there were is "
        "not told again. Of the samples before it the newest is kept.",
        {may("time_s", Type::number, "simulated seconds since the start"),
         may("time_ps", Type::integer, "the same in picoseconds, exactly"),
         may("cycles", Type::integer, "of the processor's clock"),
         may("instructions", Type::integer, "executed since the start"),
         may("sample", Type::integer, "this many results of the coprocessor are there")},
        {state}},
       true,
       &Session::go_to},
      {{"history.back",
        "Back by a time or a count, or to the last instant before now at which something held.",
        {may("seconds", Type::number, "so long"),
         may("cycles", Type::integer, "this many cycles of the processor's clock"),
         may("instructions", Type::integer, "this many"),
         may("samples", Type::integer, "this many results of the coprocessor"),
         may("address", Type::address, "in front of the instruction there"),
         may("expression", Type::object,
             "text is not 0, looked at every every_s as in simulation.advance")},
        {state,
         {"reason", "text",
          "time, cycles, instructions, samples, address, expression; beginning: the history begins "
          "here; never: it did not hold, the simulation stays where it was"}}},
       true,
       &Session::go_back},
      {{"history.select",
        "Makes a history that was left the present one, and goes to its end; the present one is "
        "kept "
        "instead. What its UARTs sent is not reported again.",
        {need("number", Type::integer, "of history.list")},
        {state}},
       true,
       &Session::select_history},
      {{"history.last_write",
        "The last instruction before now, or the last request, that wrote to memory, to a variable "
        "or to a register of the processor (that changed it). The simulation stays where it is.",
        {may("address", Type::address, "of the first byte"),
         may("size", Type::integer, "of the range in bytes: 4"),
         may("variable", Type::text, "instead of an address, as in variable.read"),
         may("register", Type::text, "of the processor, but not pc")},
        {{"found", "boolean", "there is one since the history began"},
         {"by", "text", "instruction, or the method of a request"},
         {"pc", "integer", "of the instruction"},
         {"place", "text", "its function, file and line"},
         {"position", "object",
          "in front of the instruction, of a request after it: a position as history.when has it"},
         {"old", "any", "value before it: of memory a list of bytes"},
         {"new", "any", "value after it"}}},
       true,
       &Session::find_write},
      {{"history.last_change",
        "The last change before now of a register or field of a device, or of a signal of the "
        "coprocessor. The simulation stays where it is.",
        {may("name", Type::text, "PERIPHERAL.REGISTER or PERIPHERAL.REGISTER.FIELD"),
         may("signal", Type::text, "of coprocessor.read, exactly at a sample"), every},
        {{"found", "boolean", "there is one since the history began"},
         {"position", "object", "the first instant at which the new value was seen"},
         {"since", "object", "of a register: the last instant with the old one"},
         {"old", "any", "value before it"},
         {"new", "any", "value after it"},
         {"by", "text",
          "of a register. instruction: one that accessed the device; device: no instruction did; "
          "or "
          "the method of a request"},
         {"pc", "integer", "of the instruction"},
         {"place", "text", "its function, file and line"},
         {"access", "text", "write or read"},
         {"accessed", "text", "the register of the device that it accessed, or the address"},
         {"sample", "integer", "by the device: the result of this sample came"}}},
       true,
       &Session::find_change},
      {{"history.timeline",
        "What happened between two positions, in the order of time. The simulation stays where it "
        "is.",
        {need("one", Type::object,
              "time_s, time_ps, cycles, instructions or sample, as in simulation.goto"),
         may("other", Type::object, "as one; now"),
         may("kinds", Type::list, "of events, as in events.subscribe: all")},
        {{"one", "object", "its position"},
         {"other", "object", "its position"},
         {"events", "list",
          "as simulation.advance tells them; of a line of a UART that began before one, the "
          "rest"}}},
       true,
       &Session::tell_past},
      {{"history.trace",
        "Traces what happened between two positions, whether it was traced then or not. The "
        "simulation stays where it is.",
        {need("one", Type::object,
              "time_s, time_ps, cycles, instructions or sample, as in simulation.goto"),
         may("other", Type::object, "as one; now"),
         need("files", Type::object,
              "which traces, and where they go: the settings `trace.NAME` of a run without "
              "`trace.`, as {\"profile\": \"a.callgrind\", \"coverage\": \"a.info\"}")},
        {{"one", "object", "its position"},
         {"other", "object", "its position"},
         {"functions", "list",
          "with a profile: of those that took the most cycles function, cycles, instructions"},
         {"lost", "list", "a sentence for each file that is not whole"}}},
       true,
       &Session::trace_past},
      {{"history.why",
        "Why a signal of the coprocessor has its value in a result: which values made it, back to "
        "the sample and the registers. The simulation stays where it is.",
        {need("signal", Type::text, "a node of the pipeline: angle, a_u, error_u, relative, ..."),
         may("sample", Type::integer, "the number of the result, from 1; the newest")},
        {{"signal", "text", "as asked"},
         {"sample", "integer", "the number of the result"},
         {"position", "object", "of the result"},
         {"steps", "list",
          "the signal first, each before those that it is made from: name, stage (T0 to T4, or "
          "registers: as the commit leaves them), unit, word, value, made_from (names of steps and "
          "inputs). A value is a fraction of full scale; degrees if is_angle is set"},
         {"inputs", "object",
          "by name: words of the sample (Q1.31), registers and fields as they were when the sample "
          "was taken (a pair as NAME_HI and NAME_LO); null: state without a register"}}},
       true,
       &Session::explain},
      {{"history.diff",
        "How two positions differ: registers of processor and devices, and memory by the program's "
        "variables. The simulation stays where it is.",
        {need("one", Type::object,
              "time_s, time_ps, cycles, instructions or sample, as in simulation.goto"),
         may("other", Type::object, "as one; now")},
        {{"one", "object", "its position"},
         {"other", "object", "its position"},
         {"processor", "object", "names and both values"},
         {"devices", "object", "PERIPHERAL.REGISTER and both values"},
         {"memory", "list",
          "of objects: name (null: no variable), address, one, other; of memory without a name "
          "texts of hexadecimal digits"},
         {"left_out", "integer", "entries of memory beyond 1000"}}},
       true,
       &Session::compare},
      {{"debugger.reverse",
        "The processor goes back: by one instruction, or to the last instant before now at which "
        "debugger.resume would have stopped at a point.",
        {need("kind", Type::text, "step or run"),
         may("points", Type::any, "as in debugger.resume")},
        {state,
         {"reason", "text", "step, breakpoint, bkpt, watchpoint; beginning (of the history)"},
         {"point", "text", "the kind of the point"},
         {"address", "integer", "of a watchpoint: what was accessed"}}},
       true,
       &Session::reverse},
  };
}

}  // namespace capsoc::service
