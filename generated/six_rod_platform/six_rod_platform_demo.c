/* Solves six_rod_platform once and times it: prints one JSON object. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 199309L
#endif
#include "six_rod_platform.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = SIX_ROD_PLATFORM_UNKNOWNS, INPUTS = SIX_ROD_PLATFORM_INPUTS, ROOM = INPUTS > 0 ? INPUTS : 1 };

typedef six_rod_platform_real real;

static const real DEFAULTS[ROOM] = SIX_ROD_PLATFORM_DEFAULTS;

/* Too large for the stack of a thread. */
static six_rod_platform_workspace workspace;

static double now_us(void) {
#if defined(__unix__) || defined(__APPLE__)
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
#else
  return 1e6 * (double)clock() / CLOCKS_PER_SEC;
#endif
}

/* A number of the JSON text; null where it is not finite. */
static void print_number(double value) {
  if (isfinite(value)) printf("%.17g", value);
  else printf("null");
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

static void print_position(const real *position) {
  printf("[");
  for (int i = 0; i < 3; i++) {
    if (i) printf(", ");
    print_number((double)position[i]);
  }
  printf("]");
}

static void print_field(const char *word, double value) {
  printf(", \"%s\": ", word);
  print_number(value);
}

enum { COLD, WARM, IGM, JACOBIAN };

static void perform(int task, const real *inputs, const real *near_inputs, real *x) {
  static real jacobian[N * N], residual[N];
  const real base_position[3] = {0, 0, 0}, base_quaternion[4] = {1, 0, 0, 0};
  real force[3], moment[3];
  switch (task) {
    case COLD:
      memset(x, 0, N * sizeof *x);
      six_rod_platform_solve(inputs, x, &workspace, 0);
      break;
    case WARM:
      six_rod_platform_solve(near_inputs, x, &workspace, 0);
      break;
    case IGM:
      six_rod_platform_igm_leg_1(x, base_position, base_quaternion, inputs, residual, force, moment);
      break;
    default:
      six_rod_platform_residual_jacobian(x, inputs, jacobian, residual, &workspace);
  }
}

/* Best time of several runs, us, with inputs that go to and fro by a hundredth. */
static double best_of(int task, int repeat, const real *inputs, const real *solution) {
  double best = HUGE_VAL;
  for (int k = 0; k < repeat; k++) {
    real x[N], near_inputs[ROOM];
    for (int i = 0; i < INPUTS; i++) near_inputs[i] = inputs[i] * (real)(k % 2 ? 0.99 : 1.01);
    memcpy(x, solution, sizeof x);
    const double start = now_us();
    perform(task, inputs, near_inputs, x);
    const double duration = now_us() - start;
    if (duration < best) best = duration;
  }
  return best;
}

int main(int count, char **words) {
  real inputs[ROOM], x[N] = {0}, position[3], quaternion[4];
  six_rod_platform_info info;
  int first = 1, repeat = 200, sound = 1;
  memcpy(inputs, DEFAULTS, sizeof inputs);
  if (count > 1 && strcmp(words[1], "--repeat") == 0) {
    const double wanted = count > 2 ? parse(words[2], &sound) : 0;
    if (!sound || !(wanted >= 1 && wanted <= 1e9)) {
      return usage("--repeat takes a number of at least 1", count > 2 ? words[2] : "none");
    }
    repeat = (int)wanted;
    first = 3;
  }
  if (count != first && count != first + INPUTS) return usage("the wrong number of input values", "give all or none");
  for (int i = 0; i < count - first; i++) {
    inputs[i] = (real)parse(words[first + i], &sound);
    if (!sound) return usage("not a number", words[first + i]);
  }
  six_rod_platform_solve(inputs, x, &workspace, &info);
  printf("{\"status\": \"%s\", \"iterations\": %d", six_rod_platform_status_label(info.status), info.iterations);
  six_rod_platform_tip_leg_1(x, inputs, position, quaternion);
  printf(", \"tip\": ");
  print_position(position);
  print_field("load_factor", (double)info.load_factor);
  print_field("error_estimate", (double)info.error_estimate);
  print_field("residual_norm", (double)info.residual_norm);
  print_field("cold_us", best_of(COLD, repeat, inputs, x));
  print_field("warm_us", best_of(WARM, repeat, inputs, x));
  print_field("igm_us", best_of(IGM, repeat, inputs, x));
  print_field("jacobian_us", best_of(JACOBIAN, repeat, inputs, x));
  printf("}\n");
  return info.status == SIX_ROD_PLATFORM_CONVERGED ? 0 : 3;
}
