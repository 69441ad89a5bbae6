/* Feeds the solver what it should never be given, and checks what it promises. Prints JSON; any breach ends with 1. */
#define _POSIX_C_SOURCE 199309L
#include "@{name}.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, STATUSES = 9 };

static @{name}_workspace workspace;

static long counts[STATUSES];
static int most_iterations;
static long lost, tracked;
static double longest;

/* Of this process, so that a busy machine changes nothing. */
static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t state = 88172645463325252u;

static double uniform(void) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (double)(state >> 11) / 9007199254740992.0;
}

/* Either sign, 1e-12 to 1e12. */
static double any_magnitude(void) { return (uniform() < 0.5 ? -1 : 1) * pow(10, 24 * uniform() - 12); }

static int finite(const double *a, int count) {
  int i;
  for (i = 0; i < count; i++) {
    if (!isfinite(a[i])) return 0;
  }
  return 1;
}

static double norm(const double *a, int count) {
  double sum = 0;
  int i;
  for (i = 0; i < count; i++) sum += a[i] * a[i];
  return sqrt(sum);
}

static void fail(const char *what, const double *inputs, const double *start, const double *q, const @{name}_info *info) {
  int i;
  fprintf(stderr, "%s: status %d, iterations %d, norm %g, factor %g\ninputs", what, (int)info->status, info->iterations,
          info->residual_norm, info->load_factor);
  for (i = 0; i < INPUTS; i++) fprintf(stderr, " %.17g", inputs[i]);
  fprintf(stderr, "\nstart");
  for (i = 0; i < N; i++) fprintf(stderr, " %.17g", start[i]);
  fprintf(stderr, "\nq");
  for (i = 0; i < N; i++) fprintf(stderr, " %.17g", q[i]);
  fprintf(stderr, "\n");
  exit(1);
}

/* What holds after any solve, from any start. */
static void check(@{name}_status said, const double *inputs, const double *start, const double *q, const @{name}_info *info,
                  double took) {
  double position[3], quaternion[4], residual[N], d_q[N * INPUTS], d_tip[7 * INPUTS];
  int i, moved = 0;
  if (took > longest) longest = took;
  if (took > 1) fail("took more than a second", inputs, start, q, info);
  if (said != info->status || (int)said < 0 || said >= STATUSES) fail("no such status", inputs, start, q, info);
  if (info->iterations < 0 || info->jacobians < 0) fail("negative count", inputs, start, q, info);
  if (info->iterations > most_iterations) most_iterations = info->iterations;
  counts[said]++;
  for (i = 0; i < N; i++) moved |= memcmp(q + i, start + i, sizeof *q) != 0;
  if (moved && !finite(q, N)) fail("wrote unknowns that are not finite", inputs, start, q, info);
  if (!(info->load_factor >= 0 && info->load_factor <= 1)) fail("load factor", inputs, start, q, info);
  if (said != @{MACRO}_CONVERGED) {
    if (info->load_factor == 1 && said != @{MACRO}_UNRESOLVED && said != @{MACRO}_PATH_VANISHED) fail("whole load without convergence", inputs, start, q, info);
    return;
  }
  if (info->load_factor != 1) fail("converged short of the load", inputs, start, q, info);
  if (!finite(inputs, INPUTS) || !finite(q, N)) fail("converged, not finite", inputs, start, q, info);
  @{name}_tip(q, inputs, position, quaternion);
  if (!finite(position, 3) || !finite(quaternion, 4)) fail("tip is not finite", inputs, start, q, info);
  @{name}_residual(q, inputs, residual, &workspace);
  if (!(norm(residual, N) <= 1e-10 * (1 + norm(q, N)))) fail("no equilibrium", inputs, start, q, info);
  if (!isfinite(norm(q, N))) fail("unknowns beyond all measure", inputs, start, q, info);
  if (@{name}_solve_sensitivity(inputs, q, d_q, d_tip, &workspace) == @{MACRO}_CONVERGED) {
    if (!finite(d_q, N * INPUTS) || !finite(d_tip, 7 * INPUTS)) fail("sensitivity is not finite", inputs, start, q, info);
  }
}

static void solve(const double *inputs, const double *start) {
  @{name}_info info;
  @{name}_status said;
  double q[N], begun;
  memcpy(q, start, sizeof q);
  begun = seconds();
  said = @{name}_solve(inputs, q, &workspace, &info);
  check(said, inputs, start, q, &info, seconds() - begun);
}

static void follow(const double *from, const double *inputs, const double *start) {
  @{name}_info info;
  @{name}_status said;
  double q[N], begun;
  memcpy(q, start, sizeof q);
  begun = seconds();
  said = @{name}_follow(from, inputs, q, &workspace, &info);
  check(said, inputs, start, q, &info, seconds() - begun);
}

/* A turn of a control loop from any start, with whatever the turn before has left. */
static void track(const double *inputs, const double *start) {
  static @{name}_memory memory;
  const @{name}_options options = {12, 6};
  const @{name}_options *chosen = uniform() < 0.5 ? 0 : &options;
  @{name}_info info;
  double q[N], d_q[N * INPUTS], d_tip[7 * INPUTS], begun;
  static @{name}_memory before;
  before = memory;
  memcpy(q, start, sizeof q);
  begun = seconds();
  const @{name}_status said = @{name}_track(inputs, q, &memory, chosen, d_q, d_tip, &workspace, &info);
  if (chosen && info.iterations > options.max_iterations) fail("more work than allowed", inputs, start, q, &info);
  if (said != info.status) fail("two statuses of one turn", inputs, start, q, &info);
  if (said == @{MACRO}_CONVERGED) {
    tracked++;
    check(said, inputs, start, q, &info, seconds() - begun);
    return;
  }
  lost += said == @{MACRO}_LOST_TRACK;
  if (memcmp(q, start, sizeof q)) fail("no solution, and moved", inputs, start, q, &info);
  if (memcmp(&memory, &before, sizeof memory)) fail("no solution, and other memory", inputs, start, q, &info);
  if (info.load_factor != 0) fail("no solution, and a load", inputs, start, q, &info);
}

int main(int count, char **words) {
  const double special[] = {NAN,     INFINITY, -INFINITY, 1e300,    -1e300, DBL_MAX, -DBL_MAX, 1e154, -1e154, 1e77, 1e16,
                            DBL_MIN, 4e-320,   -4.9e-324, DBL_EPSILON, 0.0, -0.0,    1.0,      -1.0};
  enum { SPECIAL = sizeof special / sizeof *special };
  const long random = count > 1 ? atol(words[1]) : 1000;
  double inputs[INPUTS], other[INPUTS], start[N];
  long k;
  int i, a, b, place;
  /* Each special number at each place, beside each other one everywhere else; in the inputs, then in the start. */
  for (a = 0; a < SPECIAL; a++) {
    for (b = 0; b < SPECIAL; b++) {
      for (place = 0; place < INPUTS; place++) {
        for (i = 0; i < INPUTS; i++) inputs[i] = i == place ? special[a] : special[b];
        for (i = 0; i < INPUTS; i++) other[i] = i == place ? special[b] : 0.1;
        for (i = 0; i < N; i++) start[i] = 0;
        solve(inputs, start);
        follow(inputs, other, start);
        follow(other, inputs, start);
        for (i = 0; i < N; i++) start[i] = special[b];
        solve(inputs, start);
      }
      for (place = 0; place < N; place++) {
        for (i = 0; i < N; i++) start[i] = i == place ? special[a] : special[b];
        for (i = 0; i < INPUTS; i++) inputs[i] = 0.1 * (i + 1);
        solve(inputs, start);
        track(inputs, start);
        follow(inputs, inputs, start);
      }
    }
  }
  for (k = 0; k < random; k++) {
    const double level = 24 * uniform() - 12;
    for (i = 0; i < INPUTS; i++) {
      inputs[i] = any_magnitude();
      /* Half of them all alike in size, so that those of moderate loads are not rare. */
      if (k % 2) inputs[i] = pow(10, 0.5 * level) * (2 * uniform() - 1);
      other[i] = k % 4 < 2 ? inputs[i] * (1 + 0.1 * uniform()) : any_magnitude();
    }
    for (i = 0; i < N; i++) start[i] = k % 3 == 0 ? any_magnitude() : k % 3 == 1 ? 4 * uniform() - 2 : 0;
    solve(inputs, start);
    if (k % 8 == 0) follow(other, inputs, start);
    track(inputs, start);
  }
  printf("{\"most_iterations\": %d, \"longest\": %.3g, \"counts\": [", most_iterations, longest);
  for (i = 0; i < STATUSES; i++) printf("%s%ld", i ? ", " : "", counts[i]);
  printf("], \"lost\": %ld, \"tracked\": %ld}\n", lost, tracked);
  return 0;
}
