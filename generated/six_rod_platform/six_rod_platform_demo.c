/* Solves six_rod_platform once and times it: prints one JSON object. */
#define _POSIX_C_SOURCE 199309L
#include "six_rod_platform.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = SIX_ROD_PLATFORM_UNKNOWNS, INPUTS = SIX_ROD_PLATFORM_INPUTS, ROOM = INPUTS > 0 ? INPUTS : 1 };

typedef six_rod_platform_real real;

static const real DEFAULTS[ROOM] = {1, 0.5, -2, 0, 0, 0, 0.42, 0.43, 0.45, 0.44, 0.41, 0.43};
static const char *const WORDS[] = {"converged", "max_iterations", "not_finite", "singular", "load_stalled",
                                    "unresolved", "not_in_equilibrium"};

static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int usage(const char *problem, const char *word) {
  fprintf(stderr, "%s: %s\nusage: six_rod_platform_demo [--repeat N] [%d input values: hand.force hand.moment leg_1.length leg_2.length leg_3.length leg_4.length leg_5.length leg_6.length]\n", problem, word, INPUTS);
  return 2;
}

static double parse(const char *word, int *sound) {
  char *end;
  const double value = strtod(word, &end);
  *sound = end != word && *end == 0;
  return value;
}

/* A number of the JSON text; null where it is not finite. */
static void print_number(double value) {
  if (isfinite(value)) printf("%.17g", value);
  else printf("null");
}

static void print_field(const char *word, double value) {
  printf(", \"%s\": ", word);
  print_number(value);
}

/* Best time of several runs, us. */
enum { COLD, WARM, IGM, JACOBIAN, TASKS };

static double best_of(int task, int repeat, const real *inputs, const real *solution) {
  double best = INFINITY;
  real q[N], near_inputs[ROOM], base_position[3] = {0, 0, 0}, base_quaternion[4] = {1, 0, 0, 0};
  real jacobian[N * N], residual[N], force[3], moment[3];
  int i, k;
  for (k = 0; k < repeat; k++) {
    double start, took;
    for (i = 0; i < INPUTS; i++) near_inputs[i] = inputs[i] * (real)(k % 2 ? 0.99 : 1.01);
    memcpy(q, solution, sizeof q);
    if (task == COLD) memset(q, 0, sizeof q);
    start = now_us();
    if (task == COLD) six_rod_platform_solve(inputs, q, 0);
    if (task == WARM) six_rod_platform_solve(near_inputs, q, 0);
    if (task == IGM) six_rod_platform_igm_leg_1(q, base_position, base_quaternion, inputs, residual, force, moment);
    if (task == JACOBIAN) six_rod_platform_residual_jacobian(q, inputs, jacobian, residual);
    took = now_us() - start;
    if (took < best) best = took;
  }
  return best;
}

int main(int count, char **words) {
  real inputs[ROOM], q[N] = {0}, position[3], quaternion[4];
  six_rod_platform_info info;
  int i, first = 1, repeat = 200, sound = 1;
  memcpy(inputs, DEFAULTS, sizeof inputs);
  if (count > 1 && strcmp(words[1], "--repeat") == 0) {
    const double wanted = count > 2 ? parse(words[2], &sound) : 0;
    if (!sound || !(wanted >= 1 && wanted <= 1e9)) return usage("--repeat takes a number of at least 1", count > 2 ? words[2] : "none");
    repeat = (int)wanted;
    first = 3;
  }
  if (count != first && count != first + INPUTS) return usage("the wrong number of input values", "give all or none");
  for (i = 0; i < count - first; i++) {
    inputs[i] = (real)parse(words[first + i], &sound);
    if (!sound) return usage("not a number", words[first + i]);
  }
  six_rod_platform_solve(inputs, q, &info);
  six_rod_platform_tip_leg_1(q, inputs, position, quaternion);
  printf("{\"status\": \"%s\", \"iterations\": %d, \"tip\": [", WORDS[info.status], info.iterations);
  for (i = 0; i < 3; i++) {
    if (i) printf(", ");
    print_number((double)position[i]);
  }
  printf("], \"load_factor\": ");
  print_number((double)info.load_factor);
  print_field("residual_norm", (double)info.residual_norm);
  print_field("cold_us", best_of(COLD, repeat, inputs, q));
  print_field("warm_us", best_of(WARM, repeat, inputs, q));
  print_field("igm_us", best_of(IGM, repeat, inputs, q));
  print_field("jacobian_us", best_of(JACOBIAN, repeat, inputs, q));
  printf("}\n");
  return info.status == SIX_ROD_PLATFORM_CONVERGED ? 0 : 3;
}
