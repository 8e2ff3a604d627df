#include "parameter_report.h"

#include "fixed_print.h"

static void print_word(const char* name, int32_t word) {
  print_text(name);
  print_signed(word, 0);
}

void print_progress(uint32_t seconds, const struct coprocessor_parameters* parameters) {
  print_text("t ");
  print_unsigned(seconds, 4);
  print_word(" s: a1 ", parameters->a1);
  print_word(" a2 ", parameters->a2);
  print_word(" b1 ", parameters->b1);
  print_word(" b2 ", parameters->b2);
  print_word(" beta ", (int32_t)parameters->beta);
  print_word(" phi ", (int32_t)parameters->phi);
  print_text("\n");
}

static void print_fraction_row(const char* name, int32_t word) {
  print_text(name);
  print_signed(word, 12);
  print_q31(word, 15);
  print_text("\n");
}

static void print_angle_row(const char* name, uint32_t word) {
  print_text(name);
  print_signed((int32_t)word, 12);
  print_radians(word, 15);
  print_text(" rad\n");
}

void print_parameter_table(const struct coprocessor_parameters* parameters) {
  print_text("parameter        word         number\n");
  print_fraction_row("a1       ", parameters->a1);
  print_fraction_row("a2       ", parameters->a2);
  print_fraction_row("b1       ", parameters->b1);
  print_fraction_row("b2       ", parameters->b2);
  print_angle_row("beta     ", parameters->beta);
  print_angle_row("phi      ", parameters->phi);
}
