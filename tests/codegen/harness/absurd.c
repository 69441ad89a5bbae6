/* Turns of a control loop with the inputs of standard input, one turn a line after their count: the first is repeated after
   each other, which begins where it ended. Prints how many of the others were refused, how many of these had two statuses or
   moved x or the memory, and how often the first was not found again. */
#include "@{name}.h"

#include <stdio.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS };

static @{name}_workspace workspace;
static @{name}_memory memory, memory_before;

int main(void) {
  static double first[INPUTS], inputs[INPUTS], x[N], before[N], d_x[N * INPUTS];
  int turns, refused = 0, moved = 0, two_statuses = 0, lost_after = 0;
  if (scanf("%d", &turns) != 1) return 2;
  for (int k = 0; k < turns; k++) {
    for (int i = 0; i < INPUTS; i++) {
      if (scanf("%lf", inputs + i) != 1) return 2;
    }
    if (k == 0) {
      memcpy(first, inputs, sizeof first);
      if (@{name}_solve(inputs, x, &workspace, 0) != @{MACRO}_CONVERGED) return 1;
    }
    memcpy(before, x, sizeof x);
    memory_before = memory;
    @{name}_info info;
    const @{name}_status end = @{name}_track(inputs, x, &memory, 0, d_x, 0, &workspace, &info);
    two_statuses += end != info.status;
    if (end != @{MACRO}_CONVERGED) {
      refused++;
      moved += memcmp(before, x, sizeof x) != 0 || memcmp(&memory, &memory_before, sizeof memory) != 0;
    } else if (k > 0) {
      memcpy(x, before, sizeof x);
      memory = memory_before;
    }
    lost_after += @{name}_track(first, x, &memory, 0, d_x, 0, &workspace, 0) != @{MACRO}_CONVERGED;
  }
  printf("{\"refused\": %d, \"moved\": %d, \"two_statuses\": %d, \"lost_after\": %d}\n", refused, moved, two_statuses, lost_after);
  return 0;
}
