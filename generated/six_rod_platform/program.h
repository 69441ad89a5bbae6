/* Macros and functions by which programs move numbers. */
#ifndef COSSERAT_PROGRAM_H
#define COSSERAT_PROGRAM_H

#include <string.h>

#if defined(__GNUC__)
#define PROGRAM_MAYBE_UNUSED __attribute__((unused))
#else
#define PROGRAM_MAYBE_UNUSED
#endif

/* A null argument stands for zeros. */
static PROGRAM_MAYBE_UNUSED void program_read(casadi_real *to, const casadi_real *from, int count) {
  if (from) {
    memcpy(to, from, (size_t)count * sizeof *to);
  } else {
    memset(to, 0, (size_t)count * sizeof *to);
  }
}

static PROGRAM_MAYBE_UNUSED void program_clear(casadi_real *to, int count) {
  int i;
  for (i = 0; i < count; i++) to[i] = 0;
}

/* Tables of places are groups: entries of a turn, number of turns, places of the first turn and, where there are more,
   how far each moves on from turn to turn. */
static PROGRAM_MAYBE_UNUSED void program_gather(casadi_real *to, const casadi_real *from, const int *groups,
                                                int count) {
  int i, k, turn;
  for (k = 0; k < count; k++) {
    const int width = groups[0], turns = groups[1], *places = groups + 2;
    const int *steps = turns > 1 ? places + width : places;
    groups = steps + width;
    if (turns == 1) {
      for (i = 0; i < width; i++) to[i] = from[places[i]];
    } else if (width == 1 && steps[0] == 1) {
      memcpy(to, from + places[0], (size_t)turns * sizeof *to);
    } else {
      for (i = 0; i < width; i++) {
        const casadi_real *entry = from + places[i];
        casadi_real *entries = to + i;
        const int step = steps[i];
        for (turn = 0; turn < turns; turn++) entries[turn * width] = entry[turn * step];
      }
    }
    to += width * turns;
  }
}

/* Products of entries, each with the places of its two factors and of the sum that it is added to. */
static PROGRAM_MAYBE_UNUSED void program_sparse(const casadi_real *x, const casadi_real *y, const int *groups,
                                                int count, casadi_real *z) {
  int i, k, turn;
  for (k = 0; k < count; k++) {
    const int width = 3 * groups[0], turns = groups[1], *places = groups + 2;
    const int *steps = turns > 1 ? places + width : places;
    for (i = 0; i < width; i += 3) {
      for (turn = 0; turn < turns; turn++) {
        z[places[i + 2] + turn * steps[i + 2]] +=
            x[places[i] + turn * steps[i]] * y[places[i + 1] + turn * steps[i + 1]];
      }
    }
    groups = steps + width;
  }
}
#endif
