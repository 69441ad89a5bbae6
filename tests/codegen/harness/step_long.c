/* Very many steps of a damped scene whose inputs are drawn anew in each. Prints JSON. */
#include "@{name}.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, STATUSES = 6 };

static @{name}_workspace workspace;
static @{name}_step_memory memory;
static @{name}_state state;

static uint64_t random_state = 88172645463325252u;

static double uniform(void) {
  random_state ^= random_state << 13;
  random_state ^= random_state >> 7;
  random_state ^= random_state << 17;
  return (double)(random_state >> 11) / 9007199254740992.0;
}

int main(int count, char **words) {
  const long steps = count > 1 ? atol(words[1]) : 1000;
  const double dt = count > 2 ? atof(words[2]) : 1e-3;
  double own[INPUTS + 1] = @{MACRO}_DEFAULTS;
  double inputs[INPUTS + 1], still[INPUTS + 1] = {0}, x[N] = {0};
  double kinetic, elastic, of_loads[16], dead[16], most = 0;
  long counts[STATUSES] = {0}, jacobians = 0, cut = 0, k;
  int i;
  @{name}_step_info info;
  @{name}_solve(own, x, &workspace, 0);
  if (@{name}_rest(own, x, &state, &workspace) != @{MACRO}_MOTION_DONE) return 1;
  for (k = 0; k < steps; k++) {
    for (i = 0; i < INPUTS; i++) inputs[i] = own[i] * 4 * (uniform() - 0.5);
    @{name}_step(inputs, 0, dt, &state, &memory, 0, &workspace, &info);
    counts[info.status]++;
    jacobians += info.jacobians;
    cut += info.parts > 1;
    @{name}_energies(state.x, state.v, inputs, still, &kinetic, &elastic, of_loads, dead);
    if (!isfinite(kinetic + elastic)) return 1;
    most = fmax(most, kinetic + elastic);
  }
  printf("{\"most_J\": %.17g, \"jacobians\": %ld, \"cut\": %ld, \"counts\": [", most, jacobians, cut);
  for (i = 0; i < STATUSES; i++) printf("%s%ld", i ? ", " : "", counts[i]);
  printf("]}\n");
  return 0;
}
