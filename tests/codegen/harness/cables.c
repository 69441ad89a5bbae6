/* Turns of a control loop with the inputs of standard input, one turn a line after their count; by track, then by solve
   from the solution before; with a third word without derivatives. Prints how often each failed, the most work of a turn, and the calls of the kernels of an
   assembly's parts, which a linker's --wrap counts. */
#include "@{name}.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS };

static int residuals, jacobians, rates, cold_starts;

#define COUNTED(kernel, counter) \
  int __real_@{name}_k_##kernel(const double **arg, double **res, int *iw, double *w, int mem); \
  int __wrap_@{name}_k_##kernel(const double **arg, double **res, int *iw, double *w, int mem); \
  int __wrap_@{name}_k_##kernel(const double **arg, double **res, int *iw, double *w, int mem) { \
    counter++; \
    return __real_@{name}_k_##kernel(arg, res, iw, w, mem); \
  }

COUNTED(residual, residuals)
COUNTED(jacobian, jacobians)
COUNTED(rate, rates)
COUNTED(tangent, cold_starts)

static @{name}_workspace workspace;
static @{name}_memory memory;

static double largest(double so_far, double value) { return value > so_far ? value : so_far; }

int main(int count, char **words) {
  const @{name}_options options = {atoi(words[1]), atoi(words[2])};
  double inputs[INPUTS], x[N] = {0}, warm[N] = {0}, before[N], d_x[N * INPUTS], apart = 0;
  int turns, failures = 0, warm_failures = 0, lost = 0, moved_when_lost = 0, most_residuals = 0, most_jacobians = 0;
  int most_rates = 0, most_iterations = 0, continuations = 0, all_jacobians = 0;
  double *const derivatives = count > 3 ? 0 : d_x;
  /* The derivatives call the rate once for each input. */
  const int rates_of_derivatives = derivatives ? INPUTS : 0;
  if (count < 3 || scanf("%d", &turns) != 1) return 2;
  for (int k = 0; k < turns; k++) {
    @{name}_info info;
    for (int i = 0; i < INPUTS; i++) {
      if (scanf("%lf", inputs + i) != 1) return 2;
    }
    if (k == 0) {
      if (@{name}_solve(inputs, x, &workspace, 0) != @{MACRO}_CONVERGED) return 1;
      memcpy(warm, x, sizeof warm);
      cold_starts = 0;
    }
    memcpy(before, x, sizeof before);
    static @{name}_memory memory_before;
    memory_before = memory;
    residuals = jacobians = rates = 0;
    const @{name}_status end = @{name}_track(inputs, x, &memory, &options, derivatives, 0, &workspace, &info);
    if (end != info.status) return 1;
    if (end != @{MACRO}_CONVERGED) {
      moved_when_lost += memcmp(before, x, sizeof x) != 0 || memcmp(&memory, &memory_before, sizeof memory) != 0;
      if (end == @{MACRO}_LOST_TRACK) lost++;
      else failures++;
    }
    most_residuals = (int)largest(most_residuals, residuals);
    most_jacobians = (int)largest(most_jacobians, jacobians);
    all_jacobians += jacobians;
    most_rates = (int)largest(most_rates, end == @{MACRO}_CONVERGED ? rates - rates_of_derivatives : rates);
    continuations += end == @{MACRO}_CONVERGED && rates > rates_of_derivatives;
    most_iterations = (int)largest(most_iterations, info.iterations);
    warm_failures += @{name}_solve(inputs, warm, &workspace, 0) != @{MACRO}_CONVERGED;
    if (end == @{MACRO}_CONVERGED) {
      /* Relative where large: tensions are hundreds of units where strains are one. */
      for (int i = 0; i < N; i++) apart = largest(apart, fabs(x[i] - warm[i]) / (1 + fabs(warm[i])));
    }
  }
  printf("{\"failures\": %d, \"lost\": %d, \"moved_when_lost\": %d, \"warm_failures\": %d, \"cold_starts\": %d, ",
         failures, lost, moved_when_lost, warm_failures, cold_starts);
  printf("\"continuations\": %d, \"residuals\": %d, \"jacobians\": %d, \"rates\": %d, \"iterations\": %d, ",
         continuations, most_residuals, most_jacobians, most_rates, most_iterations);
  printf("\"all_jacobians\": %d, \"apart\": %.3g}\n", all_jacobians, apart);
  return 0;
}
