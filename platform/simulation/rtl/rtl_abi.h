/* The C interface between capsoc and a shared library that holds a Verilated coprocessor: ours
 * (rtl/verification/coprocessor_probe.sv around rtl/coprocessor.sv), or a user's design of
 * which only the pins are known (rtl_library.cmake). One function is looked up by name; the rest is
 * a table after it. Plain C, so that library and program need not agree on a C++ runtime, and the
 * library may be built again without the program. */
#ifndef CAPSOC_RTL_ABI_H
#define CAPSOC_RTL_ABI_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CAPSOC_RTL_ABI_VERSION 8
#define CAPSOC_RTL_ENTRY "capsoc_rtl_entry"

/* Pins that a design need not have: bits of capsoc_rtl_api::absent_pins. As inputs they go nowhere,
 * as outputs they show nothing. */
enum {
  CAPSOC_RTL_PSTRB = 1,
  CAPSOC_RTL_PREADY = 2,
  CAPSOC_RTL_PSLVERR = 4,
  CAPSOC_RTL_SAMPLE_READY = 8,
  CAPSOC_RTL_IRQ = 16,
  CAPSOC_RTL_IDLE = 32
};

/* Pins of one instance. The caller writes the inputs and calls eval(), which puts them on the
 * design; clock() uses what eval() has put there. Both leave the outputs as they are with the clock
 * low, in the interval after the last rising edge. */
typedef struct capsoc_rtl_pins {
  /* inputs */
  uint8_t presetn, psel, penable, pwrite, pstrb;
  uint8_t sample_valid, sample_clip, sample_channel;
  uint16_t paddr;
  uint32_t pwdata, sample_u, sample_v;
  /* outputs */
  uint8_t pready, pslverr, sample_ready, irq, idle;
  uint32_t prdata;
  /* The sequencer, from the probe; 0 without capsoc_rtl_api::inside. */
  uint8_t boundary;   /* the edge that ends this interval begins a tick or ends one */
  uint8_t enter;      /* with boundary: the held sample enters T0 */
  uint8_t cycle;      /* 0..31 in the running tick, 0..63 with two clocks an iteration */
  uint8_t stage;      /* bit s: stage s holds a sample */
  uint8_t load;       /* one-hot: L0..L2 under way */
  uint8_t load_start; /* with boundary: the load stage that begins */
  uint8_t held;       /* a sample waits in the holding register */
  uint8_t load_pending;
  uint8_t running; /* a tick is under way or begins at the coming edge */
  uint8_t commit;  /* a result becomes visible at the coming edge */
  /* Of several channels */
  uint8_t active;  /* whose context is in the registers */
  uint8_t ready;   /* CHANNEL.READY */
  uint8_t blocked; /* the held sample may not enter */
  uint8_t change;  /* edges to the next one at which a context's change begins or ends; 0: none */
} capsoc_rtl_pins;

typedef struct capsoc_rtl capsoc_rtl;

/* What the registers of one instance hold while its pipeline is empty; raw bits, zero-extended. */
typedef struct capsoc_rtl_state {
#define WORD(name, bits, instance, variable) uint64_t name;
#define WORDS(name, count, bits, instance, variable) uint64_t name[count];
#include "rtl/rtl_state.def"
#undef WORD
#undef WORDS
} capsoc_rtl_state;

/* The members of capsoc_rtl_state and their bits, in order. */
#define WORD(name, bits, instance, variable) #name ":" #bits ";"
#define WORDS(name, count, bits, instance, variable) #name ":" #bits "*" #count ";"
static const char capsoc_rtl_state_layout[] =
#include "rtl/rtl_state.def"
    ;
#undef WORD
#undef WORDS

/* A register, or a word of a memory: "u_sequencer.held_u_q", "u_register_bank.u_words.words.5". */
typedef struct capsoc_rtl_flip_flops {
  const char* name;
  uint32_t bits; /* may be more than 64 */
} capsoc_rtl_flip_flops;

/* What a design shows in addition to its pins. */
typedef struct capsoc_rtl_inside {
  const char* state_layout; /* capsoc_rtl_state_layout of the library */

  /* Named nodes: names in the order of the values. A node of stage s is what it will be at the end
   * of the tick in an interval with `boundary` and that stage occupied. */
  uint32_t node_count;
  const char* const* node_names;

  /* Up to `count` rising edges; stops in front of an edge that ends an interval with `boundary` or
   * `idle`. Returns how many were made. */
  uint64_t (*clock_on)(capsoc_rtl*, uint64_t count);
  void (*nodes)(capsoc_rtl*, int64_t* values); /* node_count values */
  /* node_count values of the model, which stand next to the RTL's in a wave file. */
  void (*model_nodes)(capsoc_rtl*, const int64_t* values);
  /* The 48-bit registers as they are now: FREQ, PHASE, AU, BU, CU, AV, BV, CV, all but PHASE
   * sign-extended. */
  void (*pairs)(capsoc_rtl*, int64_t* values);

  /* The whole state, for copies. save: returns the size in bytes (0 with coverage: no copies) and
   * writes it if it fits. restore: takes what save() of the same library wrote. */
  size_t (*save)(capsoc_rtl*, void* bytes, size_t size);
  void (*restore)(capsoc_rtl*, const void* bytes, size_t size);

  /* The registers between two instances, or between this one and the model. set_state: after a
   * reset; drops what a register has no bits for. */
  void (*get_state)(capsoc_rtl*, capsoc_rtl_state*);
  void (*set_state)(capsoc_rtl*, const capsoc_rtl_state*);

  /* Every flip-flop, to be changed at any time; combinational logic follows. get, set: up to 64
   * bits of flip_flops[index], from bit 64 * part on. */
  uint32_t flip_flop_count;
  const capsoc_rtl_flip_flops* flip_flops;
  uint64_t (*get_flip_flops)(capsoc_rtl*, uint32_t index, uint32_t part);
  void (*set_flip_flops)(capsoc_rtl*, uint32_t index, uint32_t part, uint64_t value);
} capsoc_rtl_inside;

typedef struct capsoc_rtl_api {
  uint32_t abi_version;
  uint32_t pins_size;                                      /* sizeof(capsoc_rtl_pins) */
  const char* source_hash;                                 /* SHA-256 of the RTL, in hexadecimal */
  int32_t paper, operand_bits, reference_lead, step_shift; /* which model it is to agree with */
  int32_t plain_arctangent;                                /* the fifth */
  int32_t iteration_clocks;                                /* the sixth: 1 or 2 */
  int32_t channels;                                        /* the seventh: 1 to 16 */
  int32_t coverage;                                        /* built with line and toggle coverage */
  uint32_t absent_pins;

  capsoc_rtl* (*create)(void); /* all inputs 0: in reset; NULL: out of memory */
  void (*destroy)(capsoc_rtl*);
  capsoc_rtl_pins* (*pins)(capsoc_rtl*);
  void (*eval)(capsoc_rtl*);  /* takes over the inputs and settles combinational outputs */
  void (*clock)(capsoc_rtl*); /* one rising edge, and back to low */

  /* An FST file of everything, one time unit a nanosecond. 0: cannot be written. */
  int (*open_waves)(capsoc_rtl*, const char* file);
  void (*wave_time)(capsoc_rtl*, uint64_t rise_ns, uint64_t fall_ns); /* of the next clock() */
  void (*close_waves)(capsoc_rtl*);

  /* Writes this instance's coverage in Verilator's format. 0: not built with coverage. */
  int (*write_coverage)(capsoc_rtl*, const char* file);

  const capsoc_rtl_inside* inside; /* NULL: the pins are all that there is */
} capsoc_rtl_api;

/* The type of the entry point. */
typedef const capsoc_rtl_api* (*capsoc_rtl_entry_function)(void);

#ifdef __cplusplus
}
#endif
#endif
