/* Beginning of a source of kernels that is compiled for lanes: `lanes` in place of casadi_real, and the functions of
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

/* Comparisons have all bits of a lane set where they hold. */
typedef long long lane_marks __attribute__((vector_size(8 * LANES), aligned(8), may_alias));

/* Numbers in the lanes that are marked, zero in the others, whatever their numbers there. */
IN_PLACE lanes lanes_where(lane_marks marks, lanes x) { return (lanes)((lane_marks)x & marks); }

IN_PLACE lanes lanes_chosen(lane_marks marks, lanes x, lanes y) {
  return (lanes)(((lane_marks)x & marks) | ((lane_marks)y & ~marks));
}

/* Like fmax and fmin, these return the number if the other argument is not a number. */
IN_PLACE lanes lanes_fmax(lanes x, lanes y) { return lanes_chosen((lane_marks)(x > y) | (lane_marks)(y != y), x, y); }
IN_PLACE lanes lanes_fmin(lanes x, lanes y) { return lanes_chosen((lane_marks)(x < y) | (lane_marks)(y != y), x, y); }

/* Operators of C: 1 if the comparison holds, else 0. */
#define HOLDS(marks) lanes_where((lane_marks)(marks), IN_ALL(1.0))
IN_PLACE lanes lanes_less(lanes x, lanes y) { return HOLDS(x < y); }
IN_PLACE lanes lanes_at_most(lanes x, lanes y) { return HOLDS(x <= y); }
IN_PLACE lanes lanes_equal(lanes x, lanes y) { return HOLDS(x == y); }
IN_PLACE lanes lanes_unequal(lanes x, lanes y) { return HOLDS(x != y); }
IN_PLACE lanes lanes_not(lanes x) { return HOLDS(x == IN_ALL(0.0)); }
IN_PLACE lanes lanes_and(lanes x, lanes y) { return HOLDS((x != IN_ALL(0.0)) & (y != IN_ALL(0.0))); }
IN_PLACE lanes lanes_or(lanes x, lanes y) { return HOLDS((x != IN_ALL(0.0)) | (y != IN_ALL(0.0))); }

/* condition ? x : 0, and x < 0 ? -1 : x > 0 ? 1 : x. */
IN_PLACE lanes lanes_if(lanes condition, lanes x) { return lanes_where((lane_marks)(condition != IN_ALL(0.0)), x); }
IN_PLACE lanes lanes_sign(lanes x) {
  const lanes not_below = lanes_chosen((lane_marks)(x > IN_ALL(0.0)), IN_ALL(1.0), x);
  return lanes_chosen((lane_marks)(x < IN_ALL(0.0)), IN_ALL(-1.0), not_below);
}
