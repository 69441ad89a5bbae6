/* Times of one library's functions in motion, best of many, us: prints one JSON object. The motion begins at rest in the
   equilibrium of the scene's inputs, of which each then grows or shrinks by a quarter of itself in a second and back. */
#define _POSIX_C_SOURCE 199309L
#include "@{name}.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, STEPS = 200 };

static @{name}_workspace workspace;
static @{name}_state states[STEPS + 1];
static @{name}_step_memory memory;
static double inputs[INPUTS + 1] = @{MACRO}_DEFAULTS;
static double given[INPUTS + 1], rate[INPUTS + 1];
static const double not_accelerated[INPUTS + 1];
static const @{name}_step_options options = {
  .tolerance = 1e-11, .max_iterations = 12, .max_parts = 8, .inputs_acceleration = not_accelerated};
static double by_start[4 * N * N], by_inputs[2 * N * INPUTS + 1], by_inputs_rate[2 * N * INPUTS + 1];
static double stiffness[N * N], damping[N * N], mass[N * N], residual[N];

static double now_us(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static void inputs_at(double t) {
  for (int i = 0; i < INPUTS; i++) {
    given[i] = inputs[i] * (1 + 0.25 * sin(6.28 * t + i));
    rate[i] = inputs[i] * 0.25 * 6.28 * cos(6.28 * t + i);
  }
}

enum { INVERSE_DYNAMICS, MATRICES, STEP, STEP_WITH_NEW_JACOBIAN, SENSITIVITY, TASKS };

static const char *const NAMES[TASKS] = {"inverse_dynamics", "matrices", "step", "step_with_new_jacobian", "step_sensitivity"};

static double best[STEPS];

/* Computes the motion once, and keeps the best time of each step; counts what steps took. */
static void run(int task, double dt, long *iterations, long *jacobians, long *parts) {
  const @{name}_step_memory fresh = {0};
  @{name}_step_info info;
  memory = fresh;
  *iterations = *jacobians = *parts = 0;
  for (int k = 0; k < STEPS; k++) {
    @{name}_state state = states[k];
    inputs_at(k * dt);
    if (task == STEP_WITH_NEW_JACOBIAN) memory.jacobian_size = 0;
    const double begun = now_us();
    if (task == INVERSE_DYNAMICS) {
      @{name}_inverse_dynamics(state.x, state.v, state.a, given, rate, 0, residual, &workspace);
    } else if (task == MATRICES) {
      @{name}_linearise(&state, given, rate, stiffness, damping, mass, 0, 0, 0, &workspace);
    } else if (task == SENSITIVITY) {
      @{name}_step_sensitivity(given, rate, dt, &state, &memory, &options, by_start, by_inputs, by_inputs_rate, 0,
                               &workspace, &info);
    } else {
      @{name}_step(given, rate, dt, &state, &memory, &options, &workspace, &info);
    }
    best[k] = fmin(best[k], now_us() - begun);
    if (task < STEP) continue;
    if (info.status != @{MACRO}_MOTION_DONE) {
      fprintf(stderr, "step %d: %s\n", k, @{name}_motion_status_text(info.status));
      exit(1);
    }
    states[k + 1] = state;
    *iterations += info.iterations;
    *jacobians += info.jacobians;
    *parts += info.parts;
  }
}

int main(int count, char **words) {
  const int repeat = count > 1 ? atoi(words[1]) : 20;
  const double dt = count > 2 ? atof(words[2]) : 1e-3;
  double x[N] = {0};
  long iterations, jacobians, parts;
  inputs_at(0);
  if (@{name}_solve(given, x, &workspace, 0) != @{MACRO}_CONVERGED) return 1;
  if (@{name}_rest(given, x, &states[0], &workspace) != @{MACRO}_MOTION_DONE) return 1;
  run(STEP, dt, &iterations, &jacobians, &parts);
  printf("{");
  for (int task = 0; task < TASKS; task++) {
    double mean = 0;
    for (int k = 0; k < STEPS; k++) best[k] = HUGE_VAL;
    for (int k = 0; k < repeat; k++) run(task, dt, &iterations, &jacobians, &parts);
    for (int k = 0; k < STEPS; k++) mean += best[k] / STEPS;
    printf("%s\"%s\": {\"us\": %.3f", task ? ", " : "", NAMES[task], mean);
    if (task >= STEP) {
      printf(", \"iterations\": %.2f, \"jacobians\": %.3f, \"parts\": %.2f", (double)iterations / STEPS,
             (double)jacobians / STEPS, (double)parts / STEPS);
    }
    printf("}");
  }
  printf("}\n");
  return 0;
}
