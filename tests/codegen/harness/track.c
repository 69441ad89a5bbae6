/* A control loop: inputs wander, each turn solves and differentiates, beside a solver that starts afresh. In the middle
   a turn is given what is not a number, and one is given the Jacobian of inputs far away. */
#include "@{name}.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POSES = @{MACRO}_POSES };
enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, TURNS = 60, LOST = 30, FAR = 45 };

static double worst(double so_far, const double *a, const double *b, int count) {
  int i;
  for (i = 0; i < count; i++) so_far = fmax(so_far, fabs(a[i] - b[i]));
  return so_far;
}

int main(int count, char **words) {
  double inputs[INPUTS], q[N] = {0}, q_afresh[N], d_q[N * INPUTS], d_tip[POSES * 7 * INPUTS];
  double d_q_afresh[N * INPUTS], d_tip_afresh[POSES * 7 * INPUTS], off = 0, off_slope = 0;
  static @{name}_memory memory;
  static @{name}_workspace workspace;
  @{name}_info info;
  int i, k, converged = 0, jacobians = 0, lost = -1, kept = -1;
  const double step = strtod(words[count - 1], 0);
  for (k = 0; k < TURNS; k++) {
    for (i = 0; i < INPUTS; i++) {
      inputs[i] = strtod(words[1 + i], 0) * (1 + (k == FAR ? 0.5 : 0.1) * sin(step * k + i));
    }
    if (k == 0 && @{name}_solve(inputs, q, &workspace, 0) != @{MACRO}_CONVERGED) return 1;
    if (k == LOST) {
      inputs[0] = NAN;
      lost = (int)@{name}_track(inputs, q, &memory, 0, d_q, d_tip, &workspace, &info);
      kept = memory.has_jacobian;
      continue;
    }
    if (@{name}_track(inputs, q, &memory, 0, d_q, d_tip, &workspace, &info) != @{MACRO}_CONVERGED) continue;
    if (k > 0 && k != LOST + 1 && k != FAR && k != FAR + 1) jacobians += info.jacobians;
    memset(q_afresh, 0, sizeof q_afresh);
    if (@{name}_solve(inputs, q_afresh, &workspace, 0) != @{MACRO}_CONVERGED) continue;
    if (@{name}_solve_sensitivity(inputs, q, d_q_afresh, d_tip_afresh, &workspace) != @{MACRO}_CONVERGED) continue;
    converged++;
    off = worst(off, q, q_afresh, N);
    off_slope = worst(worst(off_slope, d_q, d_q_afresh, N * INPUTS), d_tip, d_tip_afresh, POSES * 7 * INPUTS);
  }
  printf("{\"converged\": %d, \"jacobians\": %d, \"off\": %.3g, \"off_slope\": %.3g, \"lost\": %d, \"kept\": %d}\n", converged,
         jacobians, off, off_slope, lost, kept);
  return 0;
}
