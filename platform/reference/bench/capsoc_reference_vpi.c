/* SPDX-License-Identifier: Apache-2.0
 *
 * capsoc_reference.h for simulators with VPI: each function is a system function of the same name,
 * $capsoc_reference_NAME. A reference is an integer above 0 there. A function that fails prints the
 * sentence of capsoc_reference_error() and returns the code; $capsoc_reference_create returns 0. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "capsoc_reference.h"
#include "vpi_user.h"

enum { most_arguments = 9, most_references = 64 };

/* By the letters of a function's arguments: r reference, i input word, s input string,
 * o output word, q output of 64 bits. */
typedef struct {
  const char* name;
  const char* arguments;
} function_t;

static const function_t functions[] = {
    {"create", "iiiiiiiii"}, {"destroy", "r"},      {"reset", "r"},      {"write", "riiio"},
    {"read", "rioo"},        {"peek", "rio"},       {"sample", "riiio"}, {"clock", "ri"},
    {"outputs", "rooo"},     {"signal_index", "s"}, {"signal", "riq"},   {"commits", "rq"},
    {"edge", "rq"},
};
enum { function_count = sizeof functions / sizeof functions[0] };

static capsoc_reference* references[most_references];

typedef struct {
  vpiHandle handle;
  uint32_t word;
  int64_t wide;
  const char* text;
} argument_t;

/* The words of the inputs; the number of arguments, or -1 if they are not those of the function. */
static int read_arguments(const function_t* function, vpiHandle call, argument_t* arguments) {
  int count = 0;
  vpiHandle iterator = vpi_iterate(vpiArgument, call);
  for (vpiHandle handle = iterator ? vpi_scan(iterator) : NULL; handle != NULL;
       handle = vpi_scan(iterator)) {
    const char kind = function->arguments[count];
    if (kind == '\0') return -1;
    s_vpi_value value;
    argument_t* argument = &arguments[count++];
    argument->handle = handle;
    if (kind == 'r' || kind == 'i') {
      value.format = vpiIntVal;
      vpi_get_value(handle, &value);
      argument->word = (uint32_t)value.value.integer;
    } else if (kind == 's') {
      value.format = vpiStringVal;
      vpi_get_value(handle, &value);
      argument->text = value.value.str;
    }
  }
  return function->arguments[count] == '\0' ? count : -1;
}

static void write_outputs(const function_t* function, const argument_t* arguments, int count) {
  for (int i = 0; i < count; ++i) {
    const char kind = function->arguments[i];
    if (kind != 'o' && kind != 'q') continue;
    const uint64_t word = kind == 'o' ? arguments[i].word : (uint64_t)arguments[i].wide;
    s_vpi_vecval words[2] = {{(PLI_INT32)(uint32_t)word, 0},
                             {(PLI_INT32)(uint32_t)(word >> 32), 0}};
    s_vpi_value value;
    value.format = vpiVectorVal;
    value.value.vector = words;
    vpi_put_value(arguments[i].handle, &value, NULL, vpiNoDelay);
  }
}

static int32_t create(const argument_t* a) {
  for (int i = 0; i < most_references; ++i) {
    if (references[i] != NULL) continue;
    references[i] =
        capsoc_reference_create((int32_t)a[0].word, (int32_t)a[1].word, (int32_t)a[2].word,
                                (int32_t)a[3].word, (int32_t)a[4].word, (int32_t)a[5].word,
                                (int32_t)a[6].word, (int32_t)a[7].word, (int32_t)a[8].word);
    if (references[i] != NULL) return i + 1;
    vpi_printf("%s\n", capsoc_reference_error(NULL));
    return 0;
  }
  vpi_printf("$capsoc_reference_create: there are %d references already; destroy one\n",
             most_references);
  return 0;
}

static capsoc_reference* reference_of(uint32_t number) {
  return number >= 1 && number <= most_references ? references[number - 1] : NULL;
}

/* The value of the system function. */
static int32_t call_function(const function_t* function, argument_t* a) {
  const char* name = function->name;
  if (strcmp(name, "create") == 0) return create(a);
  if (strcmp(name, "signal_index") == 0) return capsoc_reference_signal_index(a[0].text);
  capsoc_reference* reference = reference_of(a[0].word);
  int32_t code = CAPSOC_REFERENCE_OK;
  if (strcmp(name, "destroy") == 0) {
    capsoc_reference_destroy(reference);
    if (reference != NULL) references[a[0].word - 1] = NULL;
  } else if (strcmp(name, "reset") == 0) {
    code = capsoc_reference_reset(reference);
  } else if (strcmp(name, "write") == 0) {
    code = capsoc_reference_write(reference, a[1].word, a[2].word, a[3].word, &a[4].word);
  } else if (strcmp(name, "read") == 0) {
    code = capsoc_reference_read(reference, a[1].word, &a[2].word, &a[3].word);
  } else if (strcmp(name, "peek") == 0) {
    code = capsoc_reference_peek(reference, a[1].word, &a[2].word);
  } else if (strcmp(name, "sample") == 0) {
    code = capsoc_reference_sample(reference, (int32_t)a[1].word, (int32_t)a[2].word,
                                   (int32_t)a[3].word, &a[4].word);
  } else if (strcmp(name, "clock") == 0) {
    code = capsoc_reference_clock(reference, a[1].word);
  } else if (strcmp(name, "outputs") == 0) {
    code = capsoc_reference_outputs(reference, &a[1].word, &a[2].word, &a[3].word);
  } else if (strcmp(name, "signal") == 0) {
    code = capsoc_reference_signal(reference, (int32_t)a[1].word, &a[2].wide);
  } else if (strcmp(name, "commits") == 0) {
    a[1].wide = (int64_t)capsoc_reference_commits(reference);
  } else {
    a[1].wide = (int64_t)capsoc_reference_edge(reference);
  }
  if (code != CAPSOC_REFERENCE_OK) vpi_printf("%s\n", capsoc_reference_error(reference));
  return code;
}

static PLI_INT32 called(PLI_BYTE8* user_data) {
  const function_t* function = (const function_t*)user_data;
  vpiHandle call = vpi_handle(vpiSysTfCall, NULL);
  argument_t arguments[most_arguments];
  memset(arguments, 0, sizeof arguments);
  const int count = read_arguments(function, call, arguments);
  s_vpi_value result;
  result.format = vpiIntVal;
  if (count < 0) {
    vpi_printf("$capsoc_reference_%s: wants %d arguments\n", function->name,
               (int)strlen(function->arguments));
    result.value.integer = CAPSOC_REFERENCE_ARGUMENT;
  } else {
    result.value.integer = call_function(function, arguments);
    write_outputs(function, arguments, count);
  }
  vpi_put_value(call, &result, NULL, vpiNoDelay);
  return 0;
}

static void register_functions(void) {
  for (int i = 0; i < function_count; ++i) {
    char name[64] = "$capsoc_reference_";
    strncat(name, functions[i].name, sizeof name - strlen(name) - 1);
    s_vpi_systf_data data;
    memset(&data, 0, sizeof data);
    data.type = vpiSysFunc;
    data.sysfunctype = vpiIntFunc;
    data.tfname = name;
    data.calltf = called;
    data.user_data = (PLI_BYTE8*)&functions[i];
    vpi_register_systf(&data);
  }
}

void (*vlog_startup_routines[])(void) = {register_functions, NULL};
