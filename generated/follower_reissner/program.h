/* What programs move numbers with. */
#ifndef COSSERAT_PROGRAM_H
#define COSSERAT_PROGRAM_H

#if defined(__GNUC__)
#define PROGRAM_MAYBE_UNUSED __attribute__((unused))
#else
#define PROGRAM_MAYBE_UNUSED
#endif

/* An argument that is not there stands for zeros. */
static PROGRAM_MAYBE_UNUSED void program_read(casadi_real *to, const casadi_real *from, int count) {
  int i;
  for (i = 0; i < count; i++) to[i] = from ? from[i] : 0;
}

static PROGRAM_MAYBE_UNUSED void program_move(casadi_real *to, const casadi_real *from, int count) {
  int i;
  for (i = 0; i < count; i++) to[i] = from[i];
}

static PROGRAM_MAYBE_UNUSED void program_clear(casadi_real *to, int count) {
  int i;
  for (i = 0; i < count; i++) to[i] = 0;
}

static PROGRAM_MAYBE_UNUSED void program_gather(casadi_real *to, const casadi_real *from, const int *places,
                                                int count) {
  int i;
  for (i = 0; i < count; i++) to[i] = from[places[i]];
}

/* Runs of entries, each with its first place, how far its places are apart, and its length. */
static PROGRAM_MAYBE_UNUSED void program_strides(casadi_real *to, const casadi_real *from, const int *runs, int count) {
  int i, k;
  for (k = 0; k < count; k++, runs += 3) {
    const casadi_real *entry = from + runs[0];
    for (i = 0; i < runs[2]; i++, entry += runs[1]) *to++ = *entry;
  }
}

/* Products of entries, each with the places of its two factors and of the sum that it is added to. */
static PROGRAM_MAYBE_UNUSED void program_sparse(const casadi_real *x, const casadi_real *y, const int *places,
                                                int count, casadi_real *z) {
  int k;
  for (k = 0; k < count; k++, places += 3) z[places[2]] += x[places[0]] * y[places[1]];
}
#endif
