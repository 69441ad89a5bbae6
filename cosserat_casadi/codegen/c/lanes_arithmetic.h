/* What a source of kernels begins with that is compiled for lanes: `lanes` in place of casadi_real, and the functions of
   the mathematical library for them. */
#include <math.h>

#if defined(__x86_64__) && !defined(__AVX2__)
int processor_has_lanes(void) { return __builtin_cpu_supports("avx2") != 0; }
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#define LANES_END _Pragma("clang attribute pop")
#else
#pragma GCC target("avx2")
#endif
#else
int processor_has_lanes(void) { return 1; }
#endif

/* Straight-line code gains nothing from what a compiler does beyond this, and takes it half as long again. Without the
   second, registers are left as code that was compiled for older processors is slow with. */
#ifndef __clang__
#pragma GCC optimize("O1", "expensive-optimizations")
#endif

/* Aligned as numbers are: an array of lanes is an array of numbers. */
typedef double lanes __attribute__((vector_size(8 * LANES), aligned(8), may_alias));

#define ALIKE_4(number) {number, number, number, number}
#define ALIKE(number) ALIKE_4(number)
#define IN_ALL(number) ((lanes)ALIKE(number))

/* Also into functions that are compiled with other options: a call would store all registers. */
#define IN_PLACE static inline __attribute__((always_inline))

#define LANE_AFTER_LANE(function)                          \
  IN_PLACE lanes lanes_##function(lanes x) {               \
    lanes y;                                               \
    for (int i = 0; i < LANES; i++) y[i] = function(x[i]); \
    return y;                                              \
  }
LANE_AFTER_LANE(exp)
LANE_AFTER_LANE(fabs)

#if defined(__x86_64__) && !defined(__clang__)
IN_PLACE lanes lanes_sqrt(lanes x) { return (lanes)__builtin_ia32_sqrtpd256(x); }
#else
LANE_AFTER_LANE(sqrt)
#endif

/* As fmax does, a number beside what is none. */
IN_PLACE lanes lanes_fmax(lanes x, lanes y) {
  lanes larger;
  for (int i = 0; i < LANES; i++) larger[i] = x[i] > y[i] || y[i] != y[i] ? x[i] : y[i];
  return larger;
}
