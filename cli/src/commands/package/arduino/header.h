/* @MADE@ */
/* Where Arduino and PlatformIO look for the header. */
#include "../include/@NAME@/@ROBOT@.h"
