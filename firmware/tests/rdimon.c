// A program of newlib's own start-up and system calls, all by semihosting
// (arm-none-eabi-gcc --specs=rdimon.specs): standard streams, files, times, heap, command line.
// Prints nothing that depends on the host or on speed.
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef void (*handler)(void);
struct vector_table {
  const void* initial_stack;
  handler exceptions[15];  // index: exception number - 1
};

extern unsigned char stack_top[];
void _start(void);  // newlib's crt0

__attribute__((naked)) static void fault(void) {
  __asm volatile("udf #0");
}

__attribute__((section(".vectors"), used)) static const struct vector_table vectors = {
    .initial_stack = stack_top, .exceptions = {_start, fault, fault, fault, fault, fault}};

static unsigned failures;

static void check(const char* what, int passed) {
  printf("%-28s %s\n", what, passed ? "ok" : "FAILED");
  if (!passed) ++failures;
}

// newlib's rename() makes a hard link, which semihosting has not.
static int rename_file(const char* from, const char* to) {
  enum { sys_rename = 0x0F };
  const uint32_t block[4] = {(uint32_t)from, strlen(from), (uint32_t)to, strlen(to)};
  register uint32_t operation __asm("r0") = sys_rename;
  register const uint32_t* argument __asm("r1") = block;
  __asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  return (int)operation;
}

static void check_file(void) {
  char text[32] = "";
  FILE* file = fopen("notes.txt", "w+");
  check("open for writing", file != NULL);
  if (file == NULL) return;
  check("write", fputs("first line\nsecond line\n", file) >= 0);
  check("seek", fseek(file, 6, SEEK_SET) == 0);
  check("read behind a seek", fgets(text, sizeof text, file) != NULL && !strcmp(text, "line\n"));
  check("seek to the end", fseek(file, 0, SEEK_END) == 0 && ftell(file) == 23);
  check("close", fclose(file) == 0);
  file = fopen("notes.txt", "a");
  check("append", file != NULL && fputs("third\n", file) >= 0 && fclose(file) == 0);
  check("rename", rename_file("notes.txt", "kept.txt") == 0);
  check("the old name is gone", fopen("notes.txt", "r") == NULL && errno == ENOENT);
  file = fopen("kept.txt", "r");
  unsigned lines = 0;
  while (file != NULL && fgets(text, sizeof text, file) != NULL) ++lines;
  check("all lines", lines == 3 && !strcmp(text, "third\n"));
  if (file != NULL) fclose(file);
  check("remove", remove("kept.txt") == 0 && remove("kept.txt") != 0);
}

static void check_large_file(void) {
  enum { count = 20000 };
  static unsigned char out[count], in[count];
  for (unsigned i = 0; i < count; ++i) out[i] = (unsigned char)(i * 7 + i / 256);
  FILE* file = fopen("large.bin", "w+b");
  check("large write", file != NULL && fwrite(out, 1, count, file) == count);
  if (file == NULL) return;
  rewind(file);
  check("large read", fread(in, 1, count, file) == count && !memcmp(in, out, count));
  fclose(file);
  remove("large.bin");
}

int main(int argc, char** argv) {
  printf("rdimon: %d arguments", argc);
  for (int i = 1; i < argc; ++i) printf(" [%s]", argv[i]);
  printf("\n");
  check_file();
  check_large_file();
  void* const block = malloc(1 << 20);
  check("a heap of a mebibyte", block != NULL);
  free(block);
  check("time", time(NULL) > 1700000000);
  const clock_t start = clock();
  check("clock", start != (clock_t)-1 && clock() >= start);
  check("an unknown file", fopen("none.txt", "r") == NULL && errno == ENOENT);
  fprintf(stderr, "rdimon: %u failures\n", failures);
  return failures == 0 ? 23 : 1;
}
