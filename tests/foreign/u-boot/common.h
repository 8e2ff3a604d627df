// Stands for U-Boot's header of that name: what its Dhrystone takes from the C library.
#pragma once

#include <stdio.h>
#include <string.h>
