/* Four threads solve the same load cases; each must find, bit for bit, what one thread alone does. */
#include "@{name}.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, CASES = 60, THREADS = 4 };

typedef struct {
  double q[CASES][N];
  double d_tip[CASES][@{MACRO}_RODS * 7 * INPUTS];
  @{name}_info info[CASES];
  @{name}_workspace workspace;
} work;

static double inputs[CASES][INPUTS];
static work done[THREADS + 1];

/* Fields one by one: what lies between them in memory is nobody's. */
static int same(const work *a, const work *b) {
  int k;
  for (k = 0; k < CASES; k++) {
    const @{name}_info *x = &a->info[k], *y = &b->info[k];
    if (x->status != y->status || x->iterations != y->iterations || x->jacobians != y->jacobians) return 0;
    if (memcmp(&x->residual_norm, &y->residual_norm, sizeof(@{name}_real))) return 0;
    if (memcmp(&x->load_factor, &y->load_factor, sizeof(@{name}_real))) return 0;
  }
  return !memcmp(a->q, b->q, sizeof a->q) && !memcmp(a->d_tip, b->d_tip, sizeof a->d_tip);
}

static void *run(void *given) {
  work *mine = given;
  int k;
  for (k = 0; k < CASES; k++) {
    @{name}_solve(inputs[k], mine->q[k], &mine->workspace, &mine->info[k]);
    @{name}_solve_sensitivity(inputs[k], mine->q[k], 0, mine->d_tip[k], &mine->workspace);
  }
  return 0;
}

int main(void) {
  pthread_t threads[THREADS];
  unsigned long seed = 12345;
  int i, k, converged = 0;
  for (k = 0; k < CASES; k++) {
    for (i = 0; i < INPUTS; i++) {
      seed = (seed * 1103515245u + 12345u) % 2147483648u;
      inputs[k][i] = 6.0 * (double)seed / 2147483648.0 - 3.0;
    }
  }
  run(&done[THREADS]);
  for (i = 0; i < THREADS; i++) {
    if (pthread_create(&threads[i], 0, run, &done[i])) return 2;
  }
  for (i = 0; i < THREADS; i++) pthread_join(threads[i], 0);
  for (i = 0; i < THREADS; i++) {
    if (!same(&done[i], &done[THREADS])) return 1;
  }
  for (k = 0; k < CASES; k++) converged += done[THREADS].info[k].status == @{MACRO}_CONVERGED;
  printf("%d\n", converged);
  return 0;
}
