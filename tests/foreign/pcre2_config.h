// PCRE2 with its compiler to Thumb-2 code (sljit), without an operating system: code is written to
// the heap.
#include <stdlib.h>
#define SUPPORT_JIT 1
#define SUPPORT_UNICODE 1
#define SUPPORT_PCRE2_8 1
#define SLJIT_EXECUTABLE_ALLOCATOR 0
#define SLJIT_MALLOC_EXEC(size, data) malloc(size)
#define SLJIT_FREE_EXEC(pointer, data) free(pointer)
#define SLJIT_EXEC_OFFSET(pointer) 0
#define SLJIT_UTIL_SIMPLE_STACK_ALLOCATION 1
#define SLJIT_CACHE_FLUSH(from, to) __asm volatile("dsb\n\tisb" ::: "memory")
