/* Checks of solver.c that hold whatever its linear algebra, and tools for all checks. */
#include <stdio.h>

#define CHECK(condition) \
  if (!(condition)) { \
    fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
    return 1; \
  }

static unsigned long long state = 88172645463325252u;

/* Between -1 and 1. */
static real uniform(void) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (real)(state >> 11) / 4503599627370496.0 - 1;
}

static void product(const real *a, const real *x, real *b, int n) {
  for (int i = 0; i < n; i++) b[i] = 0;
  for (int j = 0; j < n; j++) {
    for (int i = 0; i < n; i++) b[i] += a[j * n + i] * x[j];
  }
}

static real distance(const real *a, const real *b, int n) {
  real largest = 0;
  for (int i = 0; i < n; i++) largest = fmax(largest, fabs(a[i] - b[i]));
  return largest;
}

/* Broyden's update: B += r s^T / (s^T s) for a full step s that leaves the residual r. The inverse that is applied from
   the steps alone is that of the matrix updated step by step. */
static int test_broyden(workspace *work) {
  static real updated[N * N], residual[N], other[N], back[N];
  updated_jacobian *jacobian = work->updated_jacobians;
  const real inputs[INPUTS] = SOLVER_DEFAULTS;
  const loads at = full_load(inputs);
  real x[N];
  /* A straight rod on a support may be singular. */
  for (int i = 0; i < N; i++) x[i] = 0.5 * uniform();
  CHECK(linearise(x, &at, &jacobian->factors, work));
  dense_jacobian_at(x, &at, updated, work);
  jacobian->count = 0;
  for (int i = 0; i < N; i++) residual[i] = 0.1 * uniform();
  for (int k = 0; k < 4; k++) {
    real *step = place_of_step(jacobian);
    const real square = newton_step(jacobian, residual, step, work);
    CHECK(fabs(square - dot(step, step)) <= 1e-14 * square);
    product(updated, step, back, N);
    for (int i = 0; i < N; i++) back[i] = -back[i];
    CHECK(distance(back, residual, N) < 1e-9 * (1 + norm_of(step)));
    append_step(jacobian, square);
    for (int i = 0; i < N; i++) residual[i] = 0.05 * uniform();
    for (int j = 0; j < N; j++) {
      for (int i = 0; i < N; i++) updated[j * N + i] += residual[i] * step[j] / square;
    }
    /* Any vector, not the residual alone. */
    real vector[N];
    for (int i = 0; i < N; i++) vector[i] = uniform();
    CHECK(response(jacobian, residual, vector, other, work));
    product(updated, other, back, N);
    for (int i = 0; i < N; i++) back[i] = -back[i];
    CHECK(distance(back, vector, N) < 1e-8 * (1 + norm_of(other)));
  }
  return 0;
}

/* A cubic in t is predicted exactly; one whose curvature is much larger than its slope is not trusted. */
static int test_predictor(workspace *work) {
  path_point *point = work->points;
  path_point *previous = work->points + 1;
  real predicted[N], bent[N];
  const real step = 0.1;
  previous->t = 0.2;
  point->t = 0.5;
  for (int i = 0; i < N; i++) {
    const real c = 0.3 * i + 1;
    previous->x[i] = c * pow(0.2, 3) + 5 * 0.2;
    previous->tangent[i] = 3 * c * pow(0.2, 2) + 5;
    point->x[i] = c * pow(0.5, 3) + 5 * 0.5;
    point->tangent[i] = 3 * c * pow(0.5, 2) + 5;
  }
  predict(point, previous, step, 0, predicted, bent);
  for (int i = 0; i < N; i++) {
    const real c = 0.3 * i + 1;
    CHECK(fabs(point->x[i] + predicted[i] - (c * pow(0.6, 3) + 5 * 0.6)) < 1e-12);
  }
  for (int i = 0; i < N; i++) point->x[i] += 100;
  predict(point, previous, step, 0, predicted, bent);
  for (int i = 0; i < N; i++) CHECK(fabs(predicted[i] - step * point->tangent[i]) < 1e-12);
  predict(point, 0, step, 0, predicted, bent);
  for (int i = 0; i < N; i++) CHECK(fabs(predicted[i] - step * point->tangent[i]) < 1e-12);
  return 0;
}

/* The line search halves a step that is too long, and gives up one that leads uphill. */
static int test_line_search(workspace *work) {
  static real x[N], residual[N], step[N];
  updated_jacobian *jacobian = work->updated_jacobians;
  const real inputs[INPUTS] = SOLVER_DEFAULTS;
  const loads at = full_load(inputs);
  memset(x, 0, sizeof x);
  residual_at(x, &at, residual, work);
  real norm = norm_of(residual);
  const real first = norm;
  CHECK(linearise(x, &at, &jacobian->factors, work));
  jacobian->count = 0;
  CHECK(newton_step(jacobian, residual, step, work));
  for (int i = 0; i < N; i++) step[i] *= -1;
  CHECK(line_search(&at, step, 12, x, residual, &norm, work) == 0);
  CHECK(norm == first && norm_of(x) == 0);
  for (int i = 0; i < N; i++) step[i] *= -64;
  const real length = line_search(&at, step, 12, x, residual, &norm, work);
  CHECK(length > 0 && length < 0.1 && norm < first);
  return 0;
}

/* The tangent of the load path, against differences of solutions. */
static int test_tangent(workspace *work) {
  const real inputs[INPUTS] = SOLVER_DEFAULTS;
  const load_path path = {.grows_load = 1, .from = inputs, .to = inputs};
  static real ends[2][N], residual[N];
  path_point *point = work->points;
  const real h = 1e-5;
  real x[N] = {0};
  CHECK(solver_solve(inputs, x, work, 0) == SOLVER_CONVERGED);
  for (int k = 0; k < 3; k++) {
    const loads at = {inputs, 1 + (k - 1) * h};
    real *end = k == 1 ? point->x : ends[k / 2];
    memcpy(end, x, sizeof x);
    residual_at(end, &at, residual, work);
    CHECK(newton(&at, &DAMPED_NEWTON, end, residual, work->updated_jacobians, work).status == SOLVER_CONVERGED);
    if (k == 1) memcpy(point->residual, residual, sizeof residual);
  }
  point->t = 1;
  CHECK(tangent_at(&path, point, 0, work->updated_jacobians, work) == 1);
  for (int i = 0; i < N; i++) ends[1][i] = (ends[1][i] - ends[0][i]) / (2 * h);
  CHECK(distance(ends[1], point->tangent, N) < 1e-4 * (1 + norm_of(point->tangent)));
  return 0;
}

static int test_solver(workspace *work) {
  if (test_broyden(work)) return 1;
  if (test_predictor(work)) return 1;
  if (test_line_search(work)) return 1;
  return test_tangent(work);
}
