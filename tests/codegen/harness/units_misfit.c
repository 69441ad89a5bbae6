/* least_misfit.c with a rod of one unknown x + x^3 = u_0 + u_1, of which x a + u_2 a^2 is measured at four abscissae a: for
   u_1 known, x and u_2 are linear least squares, and u_0 follows. */
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef double real;
typedef int solver_status;
enum { SOLVER_CONVERGED, SOLVER_LOAD_STALLED };
enum { N = 1, INPUTS = 3, K = 2, ROWS = 4, AT = 4, MEASURED = 4 };

typedef struct {
  real slope;
  int regular;
} jacobian_factors;

typedef struct {
  jacobian_factors factors;
  int count;
} updated_jacobian;

typedef struct {
  updated_jacobian updated_jacobians[1];
  real d_x_d_inputs[N * INPUTS];
} workspace;

typedef struct {
  const real *inputs;
} loads;

static const int UNKNOWN[K] = {0, 2};
static const real STRONGEST = 50; /* load beyond which the solver stalls */

static loads full_load(const real *inputs) {
  const loads full = {inputs};
  return full;
}

static int all_finite(const real *a, int count) {
  for (int i = 0; i < count; i++) {
    if (!isfinite(a[i])) return 0;
  }
  return 1;
}

static void residual_at(const real *x, const loads *at, real *residual, workspace *work) {
  (void)work;
  residual[0] = x[0] + x[0] * x[0] * x[0] - at->inputs[0] - at->inputs[1];
}

static int linearise(const real *x, const loads *at, jacobian_factors *factors, workspace *work) {
  (void)at;
  (void)work;
  factors->slope = 1 + 3 * x[0] * x[0];
  factors->regular = 1;
  return 1;
}

static void back_substitute(const jacobian_factors *factors, real *b, workspace *work) {
  (void)work;
  b[0] /= factors->slope;
}

static void input_jacobian_at(const real *x, const loads *at, real *d_residual_d_inputs, workspace *work) {
  const real columns[N * INPUTS] = {-1, -1, 0};
  (void)x;
  (void)at;
  (void)work;
  memcpy(d_residual_d_inputs, columns, sizeof columns);
}

static solver_status solver_solve(const real *inputs, real *x, workspace *work, void *info) {
  const loads at = full_load(inputs);
  (void)info;
  if (fabs(inputs[0]) > STRONGEST) return SOLVER_LOAD_STALLED;
  for (int k = 0; k < 200; k++) {
    real residual;
    residual_at(x, &at, &residual, work);
    x[0] -= residual / (1 + 3 * x[0] * x[0]);
  }
  return SOLVER_CONVERGED;
}

static void difference_at(const real *x, const real *inputs, const real *at, const real *measured, real *difference,
                          workspace *work) {
  (void)work;
  for (int i = 0; i < ROWS; i++) difference[i] = x[0] * at[i] + inputs[2] * at[i] * at[i] - measured[i];
}

static void measured_at(const real *x, const real *inputs, const real *at, const real *measured, real *difference,
                        real *by_x, real *by_unknown, workspace *work) {
  difference_at(x, inputs, at, measured, difference, work);
  for (int i = 0; i < ROWS; i++) {
    by_x[i] = at[i];
    by_unknown[i] = 0;
    by_unknown[ROWS + i] = at[i] * at[i];
  }
}

#include "least_misfit.c"

#define CHECK(condition) \
  if (!(condition)) { \
    fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
    return 1; \
  }

static const real ABSCISSAE[AT] = {0.25, 0.5, 0.75, 1};
static const real ANY[K] = {0, 0}, FREE_BELOW[K] = {-INFINITY, -INFINITY}, FREE_ABOVE[K] = {INFINITY, INFINITY};
static const real SIZES[K] = {1, 1};
static const real ALL_WEIGHTS[ROWS] = {10, 10, 10, 10};
static const real START[INPUTS] = {0, 0.3, 0};
static const real TRUTH[K] = {2.7, -1.4};

/* What is measured without noise where x = 1.2 and u_2 = -1.4: u_0 = 1.2 + 1.728 - 0.3 is near TRUTH. */
static void measure(real x, real second, real *measured) {
  for (int i = 0; i < ROWS; i++) measured[i] = x * ABSCISSAE[i] + second * ABSCISSAE[i] * ABSCISSAE[i];
}

static int estimate_one(const real *measured, const real *weights, const real *lower, const real *upper, const real *mean,
                        const real *weight, real *result) {
  return estimate_rows(1, START, ABSCISSAE, measured, weights, lower, upper, mean, weight, SIZES, result);
}

/* The search begins at bounds, which it leaves. */
static int test_data_without_noise(void) {
  const real lower[K] = {0, -INFINITY}, upper[K] = {INFINITY, 0};
  real measured[ROWS], result[RESULT];
  measure(1.2, -1.4, measured);
  CHECK(!estimate_one(measured, ALL_WEIGHTS, lower, upper, ANY, ANY, result));
  CHECK(result[0] == ROW_FOUND);
  CHECK(result[2] < 1e-16);
  CHECK(fabs(result[3] - (1.2 + 1.728 - 0.3)) < 1e-8);
  CHECK(fabs(result[4] + 1.4) < 1e-9);
  CHECK(fabs(result[RESULT - 1] - 1.2) < 1e-9);
  /* Information of u_2: the sum of the fourth powers of the abscissae over the variance. */
  real sum = 0;
  for (int i = 0; i < ROWS; i++) sum += 100 * pow(ABSCISSAE[i], 4);
  CHECK(fabs(result[5 + 3] - sum) < 1e-10 * sum);
  return 0;
}

static int test_rows_without_weight_may_hold_anything(void) {
  const real weights[ROWS] = {10, 0, 10, 10};
  real measured[ROWS], result[RESULT];
  measure(1.2, -1.4, measured);
  measured[1] = NAN;
  CHECK(!estimate_one(measured, weights, FREE_BELOW, FREE_ABOVE, ANY, ANY, result));
  CHECK(result[0] == ROW_FOUND);
  CHECK(fabs(result[4] + 1.4) < 1e-9);
  return 0;
}

/* At a bound the gradient points outwards, and the other unknown is the least squares of what is left. */
static int test_bound(void) {
  const real upper[K] = {1.7, INFINITY};
  real measured[ROWS], result[RESULT];
  real numerator = 0, denominator = 0;
  measure(1.2, -1.4, measured);
  CHECK(!estimate_one(measured, ALL_WEIGHTS, FREE_BELOW, upper, ANY, ANY, result));
  CHECK(result[0] == ROW_FOUND);
  CHECK(result[3] == 1.7);
  CHECK(result[5 + K * K] < -1e-3);
  CHECK(fabs(result[5 + K * K + 1]) < 1e-6);
  /* u_0 + u_1 = 2: x is 1. */
  for (int i = 0; i < ROWS; i++) {
    numerator += (measured[i] - ABSCISSAE[i]) * pow(ABSCISSAE[i], 2);
    denominator += pow(ABSCISSAE[i], 4);
  }
  CHECK(fabs(result[4] - numerator / denominator) < 1e-8);
  return 0;
}

/* With nothing measured the expected values are found. */
static int test_prior(void) {
  const real weights[ROWS] = {0, 0, 0, 0}, deviations[K] = {2, 5};
  real measured[ROWS], result[RESULT];
  measure(0, 0, measured);
  CHECK(!estimate_one(measured, weights, FREE_BELOW, FREE_ABOVE, TRUTH, deviations, result));
  CHECK(result[0] == ROW_FOUND);
  for (int j = 0; j < K; j++) {
    CHECK(fabs(result[3 + j] - TRUTH[j]) < 1e-9);
    CHECK(result[5 + j * K + j] == deviations[j] * deviations[j]);
  }
  return 0;
}

static int test_a_row_alone_and_behind_another(void) {
  real inputs[2 * INPUTS], at[2 * AT], measured[2 * ROWS], weights[2 * ROWS], results[2 * RESULT], alone[RESULT];
  for (int row = 0; row < 2; row++) {
    memcpy(inputs + row * INPUTS, START, sizeof START);
    memcpy(at + row * AT, ABSCISSAE, sizeof ABSCISSAE);
    memcpy(weights + row * ROWS, ALL_WEIGHTS, sizeof ALL_WEIGHTS);
    measure(1.2 - row, 0.5 * row, measured + row * ROWS);
  }
  CHECK(!estimate_rows(2, inputs, at, measured, weights, FREE_BELOW, FREE_ABOVE, ANY, ANY, SIZES, results));
  CHECK(!estimate_one(measured + ROWS, ALL_WEIGHTS, FREE_BELOW, FREE_ABOVE, ANY, ANY, alone));
  CHECK(memcmp(results + RESULT, alone, sizeof alone) == 0);
  return 0;
}

static int test_no_equilibrium(void) {
  const real lower[K] = {60, -1}, upper[K] = {70, 1};
  real measured[ROWS], result[RESULT];
  measure(1.2, -1.4, measured);
  CHECK(!estimate_one(measured, ALL_WEIGHTS, lower, upper, ANY, ANY, result));
  CHECK(result[0] == ROW_WITHOUT_EQUILIBRIUM);
  for (int j = 3; j < RESULT; j++) CHECK(isnan(result[j]));
  return 0;
}

static int test_costs_of_steps(void) {
  const real lower[K] = {-3, -3}, upper[K] = {3, 3};
  const real steps[3 * K] = {0, 0, 0, 0.1, 0.5, 0};
  real measured[ROWS], costs[3], expected = 0;
  const real inputs[INPUTS] = {1.2 + 1.728 - 0.3, 0.3, -1.4}, x = 1.2;
  measure(1.2, -1.4, measured);
  CHECK(!costs_of_rows(1, 3, inputs, &x, ABSCISSAE, measured, ALL_WEIGHTS, lower, upper, ANY, ANY, SIZES, steps, costs));
  for (int i = 0; i < ROWS; i++) expected += 0.5 * 100 * 0.01 * pow(ABSCISSAE[i], 4);
  CHECK(costs[0] < 1e-20);
  CHECK(fabs(costs[1] - expected) < 1e-12);
  CHECK(isinf(costs[2]));
  return 0;
}

int main(void) {
  return test_data_without_noise() || test_rows_without_weight_may_hold_anything() || test_bound() || test_prior() ||
         test_a_row_alone_and_behind_another() || test_no_equilibrium() || test_costs_of_steps();
}
