// Every semihosting call, well-formed and not: one line each with its name and result. Nothing that
// depends on the host or on speed.
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static int call(uint32_t number, const void* block) {
  register uint32_t operation __asm("r0") = number;
  register const void* argument __asm("r1") = block;
  __asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  return (int)operation;
}

static int call4(uint32_t number, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  const uint32_t block[4] = {a, b, c, d};
  return call(number, block);
}

static char buffer[256];

static int open_file(const char* name, uint32_t mode) {
  return call4(0x01, (uint32_t)name, mode, strlen(name), 0);
}
static int close_file(int handle) {
  return call4(0x02, (uint32_t)handle, 0, 0, 0);
}
static int write_file(int handle, const char* text) {
  return call4(0x05, (uint32_t)handle, (uint32_t)text, strlen(text), 0);
}
static int read_file(int handle, uint32_t size) {
  memset(buffer, 0, sizeof buffer);
  return call4(0x06, (uint32_t)handle, (uint32_t)buffer, size, 0);
}
static int is_terminal(int handle) {
  return call4(0x09, (uint32_t)handle, 0, 0, 0);
}
static int seek(int handle, uint32_t place) {
  return call4(0x0A, (uint32_t)handle, place, 0, 0);
}
static int length(int handle) {
  return call4(0x0C, (uint32_t)handle, 0, 0, 0);
}
static int remove_file(const char* name) {
  return call4(0x0E, (uint32_t)name, strlen(name), 0, 0);
}
static int rename_file(const char* from, const char* to) {
  return call4(0x0F, (uint32_t)from, strlen(from), (uint32_t)to, strlen(to));
}
static int error_number(void) {
  return call(0x13, NULL);
}

static void show(const char* name, int value) {
  printf("%s: %d\n", name, value);
}
static void show_read(const char* name, int value) {
  printf("%s: %d \"%s\"\n", name, value, buffer);
}

static void files(void) {
  int file = open_file("calls_a.txt", 4);
  show("open for writing", file > 0);
  show("write ten bytes", write_file(file, "0123456789"));
  show("length", length(file));
  show("read of a file for writing", read_file(file, 5));
  show("its error is EBADF", error_number() == 9);
  show("is a terminal", is_terminal(file));
  show("seek to 3", seek(file, 3));
  show("write over two", write_file(file, "XY"));
  show("close", close_file(file));
  show("close again", close_file(file));
  file = open_file("calls_a.txt", 0);
  show_read("read four", read_file(file, 4));
  show_read("read ten of six", read_file(file, 10));
  show("read at the end", read_file(file, 16));
  show("read nothing", read_file(file, 0));
  show("seek past the end", seek(file, 100));
  show("read past the end", read_file(file, 3));
  show("write to a file for reading", write_file(file, "q"));
  close_file(file);
  file = open_file("calls_a.txt", 8);
  show("append two", write_file(file, "zz"));
  close_file(file);
  file = open_file("calls_a.txt", 2);
  show("length behind append", length(file));
  show("seek to 20", seek(file, 20));
  show("write behind a hole", write_file(file, "e"));
  show("length with the hole", length(file));
  seek(file, 15);
  read_file(file, 1);
  show("the hole is zero", buffer[0]);
  close_file(file);
}

static void names(void) {
  show("open what is not there", open_file("calls_missing.txt", 0));
  show("its error is ENOENT", error_number() == 2);
  show("open it for reading and writing", open_file("calls_missing.txt", 2));
  show("rename", rename_file("calls_a.txt", "calls_b.txt"));
  show("remove the old name", remove_file("calls_a.txt"));
  show("remove", remove_file("calls_b.txt"));
  show("open with mode 12", open_file("calls_c.txt", 12));
  show("read from no handle", read_file(77, 3));
  show("write to no handle", write_file(77, "abc"));
  show("length of no handle", length(77));
  show("no handle is a terminal", is_terminal(77));
  show("seek in no handle", seek(77, 0));
  show("close no handle", close_file(77));
}

static void console(void) {
  const int in = open_file(":tt", 0), out = open_file(":tt", 4), err = open_file(":tt", 8);
  show("three consoles", in >= 0 && out >= 0 && err >= 0);
  show("write to the console", write_file(out, "[out]\n"));
  show("write to its errors", write_file(err, "[err]\n"));
  show("write to its input", write_file(in, "x") != 0);
}

static void features(void) {
  const int file = open_file(":semihosting-features", 0);
  show("features", file > 0);
  show("their length", length(file));
  show_read("their magic", read_file(file, 4));
  show("their byte", read_file(file, 1));
  show("its bits", buffer[0] & 3);
  show("read behind them", read_file(file, 1));
  show("write to them", write_file(file, "a"));
  show("seek in them", seek(file, 0));
  show("close them", close_file(file));
  show("open them for writing", open_file(":semihosting-features", 4));
}

static void others(void) {
  uint64_t elapsed = 0;
  const uint32_t room[2] = {(uint32_t)buffer, sizeof buffer};
  show("5 is an error", call4(0x08, 5, 0, 0, 0));
  show("-3 is an error", call4(0x08, (uint32_t)-3, 0, 0, 0) != 0);
  show("clock", call(0x10, NULL) >= 0);
  show("time", call(0x11, NULL) > 0);
  show("tick frequency", call(0x31, NULL) > 0);
  show("elapsed", call(0x30, &elapsed));
  show("it is not zero", elapsed != 0);
  show("command line", call(0x15, room));
  show("its length", room[1] == strlen(buffer));
  show("command line in two bytes", call4(0x15, (uint32_t)buffer, 2, 0, 0));
  show("temporary name", call4(0x0D, (uint32_t)buffer, 7, sizeof buffer, 0));
  show("it is a name", buffer[0] > ' ');
}

int main(void) {
  files();
  names();
  console();
  features();
  others();
  return 0;
}
