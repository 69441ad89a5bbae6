/* Four threads compute the same motion; each must find, bit for bit, what one thread alone does. */
#include "@{name}.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, STEPS = 60, THREADS = 4 };

typedef struct {
  @{name}_state states[STEPS + 1];
  @{name}_step_info info[STEPS];
  double by_start[4 * N * N];
  double by_inputs[2 * N * INPUTS + 1];
  @{name}_step_memory memory;
  @{name}_workspace workspace;
} work;

static double own[INPUTS + 1] = @{MACRO}_DEFAULTS;
static work done[THREADS + 1];

static void *run(void *given) {
  work *mine = given;
  double inputs[INPUTS + 1], x[N] = {0};
  int i, k;
  @{name}_solve(own, x, &mine->workspace, 0);
  @{name}_rest(own, x, &mine->states[0], &mine->workspace);
  for (k = 0; k < STEPS; k++) {
    for (i = 0; i < INPUTS; i++) inputs[i] = own[i] * (1 + 0.1 * sin(0.2 * k + i));
    mine->states[k + 1] = mine->states[k];
    @{name}_step_sensitivity(inputs, 0, 1e-3, &mine->states[k + 1], &mine->memory, 0, mine->by_start, mine->by_inputs, 0, 0,
                             &mine->workspace, &mine->info[k]);
  }
  return 0;
}

/* Fields one by one: what lies between them in memory is nobody's. */
static int same(const work *a, const work *b) {
  int k;
  for (k = 0; k < STEPS; k++) {
    const @{name}_step_info *one = &a->info[k], *other = &b->info[k];
    if (one->status != other->status || one->iterations != other->iterations) return 0;
    if (one->jacobians != other->jacobians || one->parts != other->parts) return 0;
    if (memcmp(&one->residual, &other->residual, sizeof one->residual)) return 0;
  }
  return !memcmp(a->states, b->states, sizeof a->states) && !memcmp(a->by_start, b->by_start, sizeof a->by_start) &&
         !memcmp(a->by_inputs, b->by_inputs, sizeof a->by_inputs);
}

int main(void) {
  pthread_t threads[THREADS];
  int i, k, converged = 0;
  run(&done[THREADS]);
  for (i = 0; i < THREADS; i++) {
    if (pthread_create(&threads[i], 0, run, &done[i])) return 2;
  }
  for (i = 0; i < THREADS; i++) pthread_join(threads[i], 0);
  for (i = 0; i < THREADS; i++) {
    if (!same(&done[i], &done[THREADS])) return 1;
  }
  for (k = 0; k < STEPS; k++) converged += done[THREADS].info[k].status == @{MACRO}_MOTION_DONE;
  printf("%d\n", converged);
  return 0;
}
