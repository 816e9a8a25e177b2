/*
 * x y + z, rounded once: an instruction where the compiler is told of a processor that has it (-mfma, -march=native), else a call. With
 * ROBOT_NO_MATH_H defined no header is needed: the compiler has it built in, and where it makes a call of it, the program has to have that.
 */
#ifndef ROBOT_NO_MATH_H
#include <math.h>
#define ROBOT_FMA(x, y, z) fma@f@(x, y, z)
#elif defined(__GNUC__)
#define ROBOT_FMA(x, y, z) __builtin_fma@f@(x, y, z)
#else
#error "with ROBOT_NO_MATH_H this compiler has no fused operation: leave it undefined, or generate the header without --fma"
#endif

