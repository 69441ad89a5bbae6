/* Feeds a step what it should never be given, and checks what it promises. Prints JSON; any breach ends with 1. */
#define _POSIX_C_SOURCE 199309L
#include "@{name}.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, STATUSES = 6 };

static @{name}_workspace workspace;
static @{name}_step_memory memory;
static double by_start[4 * N * N], by_inputs[2 * N * INPUTS + 1], by_rate[2 * N * INPUTS + 1];
static double by_acceleration[2 * N * INPUTS + 1];
static double matrices[6][N * (N > INPUTS ? N : INPUTS)];
static long counts[STATUSES], cut, differentiated;

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t random_state = 88172645463325252u;

static double uniform(void) {
  random_state ^= random_state << 13;
  random_state ^= random_state >> 7;
  random_state ^= random_state << 17;
  return (double)(random_state >> 11) / 9007199254740992.0;
}

static double any_magnitude(void) { return (uniform() < 0.5 ? -1 : 1) * pow(10, 24 * uniform() - 12); }

static int finite(const double *a, int count) {
  int i;
  for (i = 0; i < count; i++) {
    if (!isfinite(a[i])) return 0;
  }
  return 1;
}

static void fail(const char *what, const @{name}_step_info *info) {
  fprintf(stderr, "%s: status %d, iterations %d, jacobians %d, parts %d\n", what, (int)info->status, info->iterations,
          info->jacobians, info->parts);
  exit(1);
}

static void step(const double *inputs, const double *rate, const double *acceleration, double dt,
                 const @{name}_state *start, int differentiate) {
  const @{name}_step_options options = {1e-11, 12, 8, acceleration};
  @{name}_state state = *start;
  @{name}_step_info info;
  @{name}_motion_status said;
  const double begun = seconds();
  if (differentiate) {
    said = @{name}_step_sensitivity(inputs, rate, dt, &state, &memory, &options, by_start, by_inputs, by_rate,
                                    by_acceleration, &workspace, &info);
  } else {
    said = @{name}_step(inputs, rate, dt, &state, &memory, &options, &workspace, &info);
  }
  if (seconds() - begun > 2) fail("took more than two seconds", &info);
  if ((int)info.status < 0 || info.status >= STATUSES) fail("no such status", &info);
  if (info.iterations < 0 || info.iterations > 2 * 12 * 15) fail("more work than allowed", &info);
  if (info.jacobians < 0 || info.jacobians > 15) fail("more Jacobians than allowed", &info);
  counts[info.status]++;
  cut += info.status == @{MACRO}_MOTION_DONE && info.parts > 1;
  if (info.status != @{MACRO}_MOTION_DONE) {
    if (said != info.status) fail("two statuses", &info);
    if (memcmp(&state, start, sizeof state)) fail("failed, and moved", &info);
    return;
  }
  if (!(dt > 0) || !finite(inputs, INPUTS) || (rate && !finite(rate, INPUTS))) fail("done with bad numbers", &info);
  if (acceleration && !finite(acceleration, INPUTS)) fail("done with a bad acceleration", &info);
  if (!finite(state.x, N) || !finite(state.v, N) || !finite(state.a, N)) fail("done, not finite", &info);
  if (!isfinite(info.residual) || !isfinite(info.error_left)) fail("done, with what is left not finite", &info);
  if (differentiate && said == @{MACRO}_MOTION_DONE) {
    if (!finite(by_start, 4 * N * N) || !finite(by_inputs, 2 * N * INPUTS) || !finite(by_rate, 2 * N * INPUTS) ||
        !finite(by_acceleration, 2 * N * INPUTS)) {
      fail("derivatives are not finite", &info);
    }
    differentiated++;
  }
}

int main(int count, char **words) {
  const double special[] = {NAN,     INFINITY, -INFINITY, 1e300,    -1e300, DBL_MAX, 1e154, 1e77, 1e16,
                            DBL_MIN, 4e-320,   -4.9e-324, DBL_EPSILON, 0.0, -0.0,   1.0,   -1.0, 1e-3};
  enum { SPECIAL = sizeof special / sizeof *special };
  const long random = count > 1 ? atol(words[1]) : 1000;
  double own[INPUTS + 1] = @{MACRO}_DEFAULTS;
  double inputs[INPUTS + 1], rate[INPUTS + 1], acceleration[INPUTS + 1], x[N] = {0};
  @{name}_state rest = {{0}, {0}, {0}}, state;
  long k;
  int i, a;
  @{name}_solve(own, x, &workspace, 0);
  @{name}_rest(own, x, &rest, &workspace);
  /* Each special number in each place; the memory is what the call before has left. */
  for (a = 0; a < SPECIAL; a++) {
    step(own, 0, 0, special[a], &rest, a % 2);
    for (i = 0; i < INPUTS; i++) {
      memcpy(inputs, own, sizeof inputs);
      memset(rate, 0, sizeof rate);
      inputs[i] = special[a];
      step(inputs, 0, 0, 1e-3, &rest, a % 2);
      rate[i] = special[a];
      step(own, rate, 0, 1e-3, &rest, 1 - a % 2);
      step(own, 0, rate, 1e-3, &rest, a % 2);
      @{name}_rest(inputs, x, &state, &workspace);
    }
    for (i = 0; i < 3 * N; i++) {
      state = rest;
      if (i < N) state.x[i] = special[a];
      else if (i < 2 * N) state.v[i - N] = special[a];
      else state.a[i - 2 * N] = special[a];
      step(own, 0, 0, 1e-3, &state, i % 2);
      @{name}_inverse_dynamics(state.x, state.v, state.a, own, 0, 0, matrices[0], &workspace);
      @{name}_linearise(&state, own, 0, matrices[0], matrices[1], matrices[2], matrices[3], matrices[4],
                        matrices[5], &workspace);
    }
  }
  for (k = 0; k < random; k++) {
    const double dt = pow(10, 5 * uniform() - 5);
    const double level = pow(10, 4 * uniform() - 2);
    state = rest;
    for (i = 0; i < N; i++) {
      state.x[i] += k % 3 ? level * 0.1 * (uniform() - 0.5) : 0;
      state.v[i] = k % 5 ? level * (uniform() - 0.5) : any_magnitude();
    }
    for (i = 0; i < INPUTS; i++) {
      inputs[i] = k % 7 ? own[i] * (1 + level * (uniform() - 0.5)) : any_magnitude();
      rate[i] = k % 4 ? level * (uniform() - 0.5) : 0;
      acceleration[i] = k % 11 ? 10 * level * (uniform() - 0.5) : any_magnitude();
    }
    step(inputs, rate, k % 3 ? acceleration : 0, dt, &state, k % 2);
  }
  printf("{\"cut\": %ld, \"differentiated\": %ld, \"counts\": [", cut, differentiated);
  for (i = 0; i < STATUSES; i++) printf("%s%ld", i ? ", " : "", counts[i]);
  printf("]}\n");
  return 0;
}
