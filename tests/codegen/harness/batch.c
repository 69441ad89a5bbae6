/* Reads a count and that many load cases, solves them as a batch, and prints status, estimated error and
   unknowns of each. */
#include <@{name}.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, THREADS = 4 };

static @{name}_workspace workspaces[THREADS];

int main(void) {
  int count, i, k;
  @{name}_real *inputs, *q;
  @{name}_info *info;
  if (scanf("%d", &count) != 1 || count < 1) return 2;
  inputs = malloc(sizeof *inputs * INPUTS * (size_t)count);
  q = malloc(sizeof *q * N * (size_t)count);
  info = malloc(sizeof *info * (size_t)count);
  for (i = 0; i < count * INPUTS; i++) {
    double value;
    if (scanf("%lf", &value) != 1) return 2;
    inputs[i] = (@{name}_real)value;
  }
  fprintf(stderr, "%d\n", @{name}_solve_batch(count, inputs, q, workspaces, THREADS, info));
  for (k = 0; k < count; k++) {
    printf("%d %.17g", (int)info[k].status, (double)info[k].error_estimate);
    for (i = 0; i < N; i++) printf(" %.17g", (double)q[k * N + i]);
    printf("\n");
  }
  free(inputs);
  free(q);
  free(info);
  return 0;
}
