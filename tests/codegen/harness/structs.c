/* Inputs and results by name against the vectors and functions that they stand for. Ends with 1 where they differ. */
#include "@{name}.h"

#include <stdio.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS };

static @{name}_workspace workspace;

int main(void) {
  const @{name}_real defaults[INPUTS] = @{MACRO}_DEFAULTS;
  @{name}_real inputs[INPUTS], x[N] = {0}, d_x[N * INPUTS], d_poses[@{MACRO}_POSES * 7 * INPUTS];
  @{name}_inputs named;
  @{name}_results results;
  memset(&named, 0, sizeof named);
  memset(inputs, 0, sizeof inputs);
  @{name}_unpack(defaults, &named);
  @{name}_pack(&named, inputs);
  if (memcmp(inputs, defaults, sizeof inputs)) return 1;
  if (@{name}_solve(inputs, x, &workspace, 0) != @{MACRO}_CONVERGED) return 1;
  if (@{name}_solve_sensitivity(inputs, x, d_x, d_poses, &workspace) != @{MACRO}_CONVERGED) return 1;
  if (@{MACRO}_WORKSPACE_SIZE != (size_t)@{name}_workspace_size()) return 1;
  @{name}_evaluate(x, inputs, &results);
  printf("%d.%d.%d\n", @{MACRO}_VERSION_MAJOR, @{MACRO}_VERSION_MINOR, @{MACRO}_VERSION_PATCH);
  for (int i = 0; i < INPUTS; i++) printf("%.17g ", (double)inputs[i]);
  printf("\n");
  for (size_t i = 0; i < sizeof results / sizeof(@{name}_real); i++) printf("%.17g ", ((const double *)&results)[i]);
  printf("\n");
  for (int pose = 0; pose < @{MACRO}_POSES; pose++) {
    for (int i = 0; i < 7; i++) {
      for (int k = 0; k < INPUTS; k++) printf("%.17g ", (double)@{MACRO}_D_POSE(d_poses, pose, i, k));
    }
  }
  printf("\n");
  return 0;
}
