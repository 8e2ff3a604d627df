// Settings of a program that a user changes without a compiler: `capsoc run PROGRAM -P name=value`
// writes them in the image, `capsoc run PROGRAM --list-program-settings` lists them with unit and
// range. The program lists them once:
/*
     #define SETTINGS(NUMBER, TEXT)                                               \
       NUMBER(uint32_t, rate_hz, 250, 1, 100000, 1, "Hz", "samples a second")     \
       NUMBER(uint32_t, step, 0.25, 0, 0.999, 0x1p31, "", "2 mu, kept as Q1.31")  \
       TEXT(greeting, 16, "hello", "what it says first")
     PROGRAM_SETTINGS(SETTINGS)
     #define settings (*program_settings_values())
*/
// and reads them as members: settings.rate_hz. A NUMBER has its C type (an integer of 1, 2, 4 or 8
// bytes), name, initial, least and greatest value, the word that stands for 1, unit and meaning. So
// the step above is 0.25 to a user and the word 0.25 * 2^31 to the program. A TEXT has the size of
// its array, the terminating 0 included. Names are lower-case letters, digits and '_'.
#ifndef CAPSOC_PROGRAM_SETTINGS_H
#define CAPSOC_PROGRAM_SETTINGS_H

#include <stddef.h>
#include <stdint.h>

#define PROGRAM_SETTINGS_MAGIC UINT32_C(0x31544553)  // of this layout

enum program_setting_kind {
  program_setting_unsigned = 0,
  program_setting_signed = 1,
  program_setting_text = 2,
};

// What a loader has to know of one value. Texts end with a 0, so there is room for one character
// less.
struct program_setting {
  char name[32];
  char unit[16];
  char help[80];
  uint32_t offset;  // of the value from the beginning of the object, bytes
  uint16_t size;    // bytes
  uint8_t kind;     // enum program_setting_kind
  uint8_t reserved;
  int64_t per_unit;         // the word for 1
  int64_t least, greatest;  // words
};

struct program_settings_header {
  uint32_t magic;
  uint32_t count;  // of the descriptions that follow
};

// For the loader, which finds it by the name program_settings, everything is in one constant
// object: header, descriptions, values. Values read through program_settings_values() are never
// those that the compiler saw.
#define PROGRAM_SETTINGS(LIST)                                                                    \
  struct program_settings_values {                                                                \
    LIST(PROGRAM_SETTINGS_NUMBER_MEMBER_, PROGRAM_SETTINGS_TEXT_MEMBER_)                          \
  };                                                                                              \
  enum {                                                                                          \
    program_settings_count = 0 LIST(PROGRAM_SETTINGS_COUNT_NUMBER_, PROGRAM_SETTINGS_COUNT_TEXT_) \
  };                                                                                              \
  struct program_settings {                                                                       \
    struct program_settings_header header;                                                        \
    struct program_setting descriptions[program_settings_count];                                  \
    struct program_settings_values values;                                                        \
  };                                                                                              \
  LIST(PROGRAM_SETTINGS_CHECK_NUMBER_, PROGRAM_SETTINGS_CHECK_TEXT_)                              \
  extern const struct program_settings program_settings;                                          \
  const struct program_settings program_settings = {                                              \
      .header = {PROGRAM_SETTINGS_MAGIC, program_settings_count},                                 \
      .descriptions = {LIST(PROGRAM_SETTINGS_DESCRIBE_NUMBER_, PROGRAM_SETTINGS_DESCRIBE_TEXT_)}, \
      .values = {LIST(PROGRAM_SETTINGS_INITIAL_NUMBER_, PROGRAM_SETTINGS_INITIAL_TEXT_)},         \
  };                                                                                              \
  static inline const struct program_settings_values* program_settings_values(void) {             \
    const struct program_settings_values* values = &program_settings.values;                      \
    __asm("" : "+r"(values)); /* the compiler must not know where this points */                  \
    return values;                                                                                \
  }

// Rounded to the nearest word.
#define PROGRAM_SETTINGS_WORD_(value, per_unit) \
  ((int64_t)((double)(value) * (double)(per_unit) + ((double)(value) < 0 ? -0.5 : 0.5)))

#define PROGRAM_SETTINGS_NUMBER_MEMBER_(type, name, initial, least, greatest, per_unit, unit, \
                                        help)                                                 \
  type name;
#define PROGRAM_SETTINGS_TEXT_MEMBER_(name, size, initial, help) char name[size];

#define PROGRAM_SETTINGS_COUNT_NUMBER_(type, name, initial, least, greatest, per_unit, unit, help) \
  +1
#define PROGRAM_SETTINGS_COUNT_TEXT_(name, size, initial, help) +1

// A name that fills its array would leave no room for the 0, which C allows.
#define PROGRAM_SETTINGS_ROOM_FOR_(member, text)                               \
  _Static_assert(sizeof(text) <= sizeof(((struct program_setting*)0)->member), \
                 "program setting: " text " is too long");
#define PROGRAM_SETTINGS_CHECK_NUMBER_(type, name_, initial, least, greatest, per_unit, unit_, \
                                       help_)                                                  \
  PROGRAM_SETTINGS_ROOM_FOR_(name, #name_)                                                     \
  PROGRAM_SETTINGS_ROOM_FOR_(unit, unit_) PROGRAM_SETTINGS_ROOM_FOR_(help, help_)
#define PROGRAM_SETTINGS_CHECK_TEXT_(name_, size, initial, help_) \
  PROGRAM_SETTINGS_ROOM_FOR_(name, #name_)                        \
  PROGRAM_SETTINGS_ROOM_FOR_(help, help_)                         \
  _Static_assert(sizeof(initial) <= (size), "program setting: " initial " is too long");

#define PROGRAM_SETTINGS_DESCRIBE_NUMBER_(type, name_, initial, least_, greatest_, per_unit_, \
                                          unit_, help_)                                       \
  {.name = #name_,                                                                            \
   .unit = unit_,                                                                             \
   .help = help_,                                                                             \
   .offset = offsetof(struct program_settings, values.name_),                                 \
   .size = sizeof(type),                                                                      \
   .kind = (type)-1 < (type)1 ? program_setting_signed : program_setting_unsigned,            \
   .per_unit = (int64_t)(per_unit_),                                                          \
   .least = PROGRAM_SETTINGS_WORD_(least_, per_unit_),                                        \
   .greatest = PROGRAM_SETTINGS_WORD_(greatest_, per_unit_)},
#define PROGRAM_SETTINGS_DESCRIBE_TEXT_(name_, size_, initial, help_) \
  {.name = #name_,                                                    \
   .help = help_,                                                     \
   .offset = offsetof(struct program_settings, values.name_),         \
   .size = (size_),                                                   \
   .kind = program_setting_text},

#define PROGRAM_SETTINGS_INITIAL_NUMBER_(type, name, initial, least, greatest, per_unit, unit, \
                                         help)                                                 \
  .name = (type)PROGRAM_SETTINGS_WORD_(initial, per_unit),
#define PROGRAM_SETTINGS_INITIAL_TEXT_(name, size, initial, help) .name = initial,

#endif
