/* passages.c alone, with the places and distances of a scene: for each line of unknowns and inputs at both ends of a step
   whether it leads through something thin, 1 or 0. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "watched_kernels.h"

typedef double real;
#define SQUARE_ROOT sqrt
enum { N = @{size}, INPUTS = @{given} };

typedef struct {
  real places[3][3 * @{places}];
  real x_between[N];
  real inputs_between[INPUTS];
  real sizes[@{free_sizes} + 1];
  real kernel_reals[@{kernel_reals} + 1];
  int kernel_integers[@{kernel_integers} + 1];
} workspace;

@{calls}
@{passages}

static workspace work;

static int read_numbers(real *numbers, int count) {
  for (int i = 0; i < count; i++) {
    if (scanf("%lf", numbers + i) != 1) return 0;
  }
  return 1;
}

int main(void) {
  static real x[2][N], inputs[2][INPUTS];
  const step_ends step = {{x[0], x[1]}, {inputs[0], inputs[1]}};
  for (;;) {
    for (int end = 0; end < 2; end++) {
      if (!read_numbers(x[end], N) || !read_numbers(inputs[end], INPUTS)) return 0;
    }
    printf("%d\n", leads_through(&step, &work));
  }
}
