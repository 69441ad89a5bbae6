/* A control loop that loses its track: turns with the inputs of standard input, one turn a line after their count. Where
   track is lost the next turns call recover, with the inputs of that time, until it has them. Prints the end of each turn,
   negative where recover was called, whether x was the solution for the memory's inputs after each, and the most that a call
   of recover evaluated, which a linker's --wrap counts. */
#include "@{name}.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS };

static int residuals, jacobians, rates;

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

static @{name}_workspace workspace;
static @{name}_memory memory;

static double most(double so_far, double value) { return value > so_far ? value : so_far; }

static double residual_of(const double *x, const double *inputs) {
  double residual[N], sum = 0, size = 0;
  @{name}_residual(x, inputs, residual, &workspace);
  for (int i = 0; i < N; i++) {
    sum += residual[i] * residual[i];
    size += x[i] * x[i];
  }
  return sqrt(sum) / (1 + sqrt(size));
}

int main(int count, char **words) {
  double inputs[INPUTS], x[N] = {0}, worst = 0;
  int turns, lost = 0, most_residuals = 0, most_jacobians = 0, most_rates = 0;
  if (count < 3 || scanf("%d", &turns) != 1) return 2;
  const @{name}_options options = {atoi(words[1]), atoi(words[2])};
  printf("{\"ends\": [");
  for (int k = 0; k < turns; k++) {
    for (int i = 0; i < INPUTS; i++) {
      if (scanf("%lf", inputs + i) != 1) return 2;
    }
    if (k == 0 && @{name}_solve(inputs, x, &workspace, 0) != @{MACRO}_CONVERGED) return 1;
    @{name}_info info;
    @{name}_status end;
    if (lost) {
      residuals = jacobians = rates = 0;
      end = @{name}_recover(inputs, x, &memory, &options, &workspace, &info);
      most_residuals = (int)most(most_residuals, residuals);
      most_jacobians = (int)most(most_jacobians, jacobians);
      most_rates = (int)most(most_rates, rates);
    } else {
      end = @{name}_track(inputs, x, &memory, &options, 0, 0, &workspace, &info);
    }
    if (end != info.status) return 1;
    printf("%s%d", k ? ", " : "", lost ? -(int)end - 1 : (int)end + 1);
    lost = end != @{MACRO}_CONVERGED;
    worst = most(worst, residual_of(x, memory.inputs));
  }
  printf("], \"worst\": %.3g, \"residuals\": %d, \"jacobians\": %d, \"rates\": %d}\n", worst, most_residuals, most_jacobians,
         most_rates);
  return 0;
}
