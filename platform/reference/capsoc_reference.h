/* SPDX-License-Identifier: Apache-2.0
 *
 * C interface to the reference model of the coprocessor, for test benches: libcapsoc_reference.so.
 * docs/reference/coprocessor.md is the text that the model obeys, bit for bit and cycle for cycle.
 *
 * Time is the number of rising edges of PCLK. Interval n is the time from edge n to edge n + 1. A
 * reference is in interval 0 when it is created. In each interval a bench
 *   1. says what is on the pins: capsoc_reference_read() or _write() if an APB transfer is in its
 *      access phase, capsoc_reference_sample() if sample_valid is high, in any order;
 *   2. reads what the pins show: capsoc_reference_outputs(), and what the read returned;
 *   3. makes the edge: capsoc_reference_clock().
 * Samples and writes act at that edge. A read returns what the edge before left, and its side
 * effect acts at the coming edge. Outputs of an interval do not depend on step 1.
 *
 * Formats: Q1.31 is a signed 32-bit word in units of 2^-31. Register words, signals and their
 * formats are those of docs/reference/coprocessor.md.
 *
 * Errors: functions that return int return CAPSOC_REFERENCE_OK or a code of the list below; then
 * nothing has changed, outputs are not written, and capsoc_reference_error() has a sentence. An
 * APB error (PSLVERR) is not an error of a call: it is a value that the call returns.
 *
 * Ownership: capsoc_reference_create() makes a reference, and the caller destroys it. Strings are
 * the library's. References share nothing; each may be used by one thread at a time.
 *
 * Parameters are integers, pointers to integers or strings, so that SystemVerilog imports each
 * function by DPI. There capsoc_reference* is chandle, int32_t int, uint32_t int unsigned, int64_t
 * longint, uint64_t longint unsigned, const char* string; other pointers are outputs. */
#ifndef CAPSOC_REFERENCE_H
#define CAPSOC_REFERENCE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* Changes when a function or its meaning changes; functions may be added without it. */
#define CAPSOC_REFERENCE_VERSION 3

enum {
  CAPSOC_REFERENCE_OK = 0,
  /* A pointer is null, or a number outside its range. */
  CAPSOC_REFERENCE_ARGUMENT = 1,
  /* A second access, or a second sample, in one interval. */
  CAPSOC_REFERENCE_ORDER = 2
};

typedef struct capsoc_reference capsoc_reference;

/* CAPSOC_REFERENCE_VERSION of the library. */
int32_t capsoc_reference_version(void);

/* Makes a reference in the state after reset. The parameters are those of the module coprocessor
 * (rtl/coprocessor.sv), in its order:
 *   paper             0: arithmetic `precise`, 1: `paper`
 *   operand_bits      paper: width of the arctangent's operands, 2 to 32
 *   reference_lead    paper: samples by which the reference leads the data, -1024 to 1024
 *   step_shift        paper: right shift of the steps, 0 to 31
 *   plain_arctangent  paper: 1: the arctangent's input as it is
 *   iteration_clocks  paper: clocks of an iteration of the arctangent, 1 or 2
 *   block, harmonics  precise: 1: block learning, harmonic correction
 *   safety            1: safety mechanisms
 * Null: a parameter is outside its range; capsoc_reference_error(NULL) says which. */
capsoc_reference* capsoc_reference_create(int32_t paper, int32_t operand_bits,
                                          int32_t reference_lead, int32_t step_shift,
                                          int32_t plain_arctangent, int32_t iteration_clocks,
                                          int32_t block, int32_t harmonics, int32_t safety);

/* Ends a reference. Null is ignored. */
void capsoc_reference_destroy(capsoc_reference* reference);

/* PRESETn is low in this interval. It acts at once, and forgets what this interval has had on its
 * pins so far. The number of the edge continues. The nodes of the harmonic correction keep their
 * words. */
int32_t capsoc_reference_reset(capsoc_reference* reference);

/* The access phase of a write. address: PADDR, 0 to 0xFFF; strobes: PSTRB, 0 to 15.
 * *error: PSLVERR, 0 or 1. */
int32_t capsoc_reference_write(capsoc_reference* reference, uint32_t address, uint32_t data,
                               uint32_t strobes, uint32_t* error);

/* The access phase of a read. *data: PRDATA, 0 after an error; *error: PSLVERR, 0 or 1. */
int32_t capsoc_reference_read(capsoc_reference* reference, uint32_t address, uint32_t* data,
                              uint32_t* error);

/* A register as a debugger sees it, at any time: no side effect, and LO of a 48-bit register shows
 * its present word. *data is 0 if there is no register. */
int32_t capsoc_reference_peek(const capsoc_reference* reference, uint32_t address, uint32_t* data);

/* sample_valid is high. u, v: Q1.31; clip: 0 or 1. *ready: sample_ready, 1 if the coming edge takes
 * the sample. */
int32_t capsoc_reference_sample(capsoc_reference* reference, int32_t u, int32_t v, int32_t clip,
                                uint32_t* ready);

/* Makes `edges` edges, 1 to 2^32 - 1. The first one takes what is on the pins, those after it find
 * no access and no sample. */
int32_t capsoc_reference_clock(capsoc_reference* reference, uint32_t edges);

/* Output pins in this interval, 0 or 1 each: sample_ready_o, irq_o, idle_o. */
int32_t capsoc_reference_outputs(const capsoc_reference* reference, uint32_t* sample_ready,
                                 uint32_t* irq, uint32_t* idle);

/* The number of the last edge; 0 for a null reference. */
uint64_t capsoc_reference_edge(const capsoc_reference* reference);

/* Results committed since the last reset, soft or hard; 0 for a null reference. */
uint64_t capsoc_reference_commits(const capsoc_reference* reference);

/* Signals are the values of the pipeline that model and RTL have in common
 * (models/coprocessor/nodes.def). Their order and number may change with the version of capsoc, so
 * a bench looks them up by name. */
int32_t capsoc_reference_signal_count(void);
/* -1: no signal has the name. */
int32_t capsoc_reference_signal_index(const char* name);
/* Null: there is no signal of that index. */
const char* capsoc_reference_signal_name(int32_t index);
/* *bits: width of the word, 1 to 64. *is_signed: 0 or 1. *fraction: number of fraction bits.
 * *stage: 0 to 4 for the tick T0 to T4 that makes it, 5 for a register as the commit leaves it. */
int32_t capsoc_reference_signal_format(int32_t index, int32_t* bits, int32_t* is_signed,
                                       int32_t* fraction, int32_t* stage);
/* *value: the raw word of the sample that was committed last, sign-extended if it is signed; 0
 * before the first. */
int32_t capsoc_reference_signal(const capsoc_reference* reference, int32_t index, int64_t* value);

/* The sentence of the last call that failed with this reference, empty if none has. It is valid
 * until the next call that fails. Null: the same of the calls without a reference, of this thread.
 */
const char* capsoc_reference_error(const capsoc_reference* reference);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
