// GTKWave's FST library, whose sources come with Verilator.
#define HAVE_LIBPTHREAD
#define FST_CONFIG_INCLUDE "fst_config.h"
// It is there as source alone, to be included, and in this order.
// NOLINTBEGIN(bugprone-suspicious-include)
#include "gtkwave/fastlz.c"
//
#include "gtkwave/fstapi.c"
//
#include "gtkwave/lz4.c"
// NOLINTEND(bugprone-suspicious-include)
