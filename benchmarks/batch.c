/* Times NAME_solve_batch over random load cases around the scene's own: prints cases, converged, microseconds a case. */
#define _POSIX_C_SOURCE 199309L
#include LIBRARY_HEADER

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

enum { UNKNOWNS = JOIN(MACRO, _UNKNOWNS), INPUTS = JOIN(MACRO, _INPUTS), MOST_THREADS = 64 };

static JOIN(NAME, _workspace) workspaces[MOST_THREADS];

int main(int count, char **words) {
  static const double own[INPUTS] = {OWN_INPUTS};
  const int cases = count > 1 ? atoi(words[1]) : 20000;
  double *inputs = malloc(sizeof *inputs * (size_t)cases * INPUTS), *q = malloc(sizeof *q * (size_t)cases * UNKNOWNS);
  JOIN(NAME, _info) *info = malloc(sizeof *info * (size_t)cases);
  struct timespec start, end;
  const int threads = count > 2 ? atoi(words[2]) : 1;
  int i, converged;
  unsigned state = 1;
  if (!inputs || !q || !info || threads < 1 || threads > MOST_THREADS) return 1;
  for (i = 0; i < cases * INPUTS; i++) {
    state = state * 1664525u + 1013904223u;
    inputs[i] = own[i % INPUTS] * (0.5 + (double)(state >> 8) / (1 << 24));
  }
  clock_gettime(CLOCK_MONOTONIC, &start);
  converged = JOIN(NAME, _solve_batch)(cases, inputs, q, workspaces, threads, info);
  clock_gettime(CLOCK_MONOTONIC, &end);
  printf("%d %d %.4f\n", cases, converged,
         (1e6 * (double)(end.tv_sec - start.tv_sec) + 1e-3 * (double)(end.tv_nsec - start.tv_nsec)) / cases);
  free(inputs);
  free(q);
  free(info);
  return 0;
}
