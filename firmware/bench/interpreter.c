// An interpreter of byte codes with a stack: one switch, and a jump through its table for each
// code.
#include "bench.h"

enum code { push, load, store, add, sub, mul, half, odd, less, jump, jump_if_zero, halt };
enum variable { i, x, steps, variables };
enum { rounds = 60 };

// Steps of the Collatz sequences from 500 down to 1; after each line the index of its first word.
static const uint16_t program[] = {
    push,
    500,
    store,
    i,  // 0
    load,
    i,
    store,
    x,  // 4
    load,
    x,
    push,
    2,
    less,
    jump_if_zero,
    17,  // 8
    jump,
    48,  // 15
    load,
    x,
    odd,
    jump_if_zero,
    34,  // 17
    load,
    x,
    push,
    3,
    mul,
    push,
    1,
    add,
    store,
    x,  // 22
    jump,
    39,  // 32
    load,
    x,
    half,
    store,
    x,  // 34
    load,
    steps,
    push,
    1,
    add,
    store,
    steps,  // 39
    jump,
    8,  // 46
    load,
    i,
    push,
    1,
    sub,
    store,
    i,  // 48
    load,
    i,
    jump_if_zero,
    61,  // 55
    jump,
    4,     // 59
    halt,  // 61
};

static uint32_t run(void) {
  uint32_t stack[8], value[variables] = {0};
  uint32_t* top = stack;
  const uint16_t* pc = program;
  for (;;) {
    switch ((enum code) * pc++) {
      case push:
        *top++ = *pc++;
        break;
      case load:
        *top++ = value[*pc++];
        break;
      case store:
        value[*pc++] = *--top;
        break;
      case add:
        --top;
        top[-1] += *top;
        break;
      case sub:
        --top;
        top[-1] -= *top;
        break;
      case mul:
        --top;
        top[-1] *= *top;
        break;
      case half:
        top[-1] >>= 1;
        break;
      case odd:
        top[-1] &= 1;
        break;
      case less:
        --top;
        top[-1] = top[-1] < *top;
        break;
      case jump:
        pc = program + *pc;
        break;
      case jump_if_zero:
        pc = *--top == 0 ? program + *pc : pc + 1;
        break;
      default:
        return value[steps];
    }
  }
}

int main(void) {
  uint32_t sum = 0;
  for (uint32_t round = 0; round < rounds; ++round) sum = sum * 31 + run();
  return report("interpreter", sum);
}
