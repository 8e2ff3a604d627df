// GTKWave's FST library, whose sources come with Verilator.
#define HAVE_LIBPTHREAD
#define FST_CONFIG_INCLUDE "fst_config.h"
#include "gtkwave/fastlz.c"
// In this order.
#include "gtkwave/fstapi.c"
// In this order.
#include "gtkwave/lz4.c"
