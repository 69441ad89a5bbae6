/* Static functions of the solver and of the linear algebra of assemblies. Ends with the line of what failed. */
#include "@{name}.c"

#include "units.h"

static workspace work;
static real dense[N * N];
static jacobian_factors by_fronts, whole;

/* The fronts against the matrix as a whole, at a random shape. */
static int test_fronts(void) {
  const real inputs[INPUTS] = @{MACRO}_DEFAULTS;
  const loads at = full_load(inputs);
  real x[N], b[N], solution[N], product_of[N];
  for (int trial = 0; trial < 20; trial++) {
    for (int i = 0; i < N; i++) {
      x[i] = 0.1 * uniform();
      b[i] = uniform();
    }
    dense_jacobian_at(x, &at, dense, &work);
    CHECK(linearise(x, &at, &by_fronts, &work));
    CHECK(by_fronts.regular && !by_fronts.dense);
    memcpy(solution, b, sizeof b);
    back_substitute(&by_fronts, solution, &work);
    product(dense, solution, product_of, N);
    CHECK(distance(product_of, b, N) < 1e-9 * (1 + norm_of(solution)));
    memcpy(whole.factors, dense, sizeof dense);
    whole.dense = 1;
    CHECK(eliminate(whole.factors, N, N, 1e-12, whole.pivots));
    back_substitute(&whole, b, &work);
    CHECK(distance(solution, b, N) < 1e-8 * (1 + norm_of(solution)));
  }
  return 0;
}

/* Residual and Jacobian in parts, and what the public functions give, at full load. */
static int test_parts(void) {
  const real inputs[INPUTS] = @{MACRO}_DEFAULTS;
  const loads at = full_load(inputs);
  real x[N], residual[N], moved[N], slope[N];
  const real h = 1e-6;
  for (int i = 0; i < N; i++) x[i] = 0.1 * uniform();
  dense_jacobian_at(x, &at, dense, &work);
  for (int j = 0; j < N; j++) {
    const real kept = x[j];
    x[j] = kept + h;
    residual_at(x, &at, moved, &work);
    x[j] = kept - h;
    residual_at(x, &at, residual, &work);
    x[j] = kept;
    for (int i = 0; i < N; i++) slope[i] = (moved[i] - residual[i]) / (2 * h);
    CHECK(distance(slope, dense + j * N, N) < 1e-6 * (1 + norm_of(slope)));
  }
  return 0;
}

int main(void) {
  int line = test_fronts();
  if (!line) line = test_parts();
  return line ? line : test_solver(&work);
}
