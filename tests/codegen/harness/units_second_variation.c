/* second_variation.c with an energy whose eigenvalues over all variations are known, and whose constraints are along its
   eigenvectors. */
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef double real;
enum { N = 9, FREE = 6, HELD = 3 };

typedef enum { CONVERGED, NOT_FINITE, NOT_IN_EQUILIBRIUM } status;
typedef enum { STABLE_VERDICT, NEUTRAL_VERDICT, CRITICAL_VERDICT, UNSTABLE_VERDICT } verdict;
#define STABLE STABLE_VERDICT
#define NEUTRAL NEUTRAL_VERDICT
#define CRITICAL CRITICAL_VERDICT
#define UNSTABLE UNSTABLE_VERDICT

typedef struct {
  real smallest_eigenvalue;
  int negative;
  int zero;
  verdict verdict;
} verdict_info;

typedef struct {
  real jacobian[N * N], residual[N], beside[N];
  real hessian[FREE * FREE], vectors[FREE * FREE], constraints[FREE * HELD];
  real reflector[FREE], image[FREE], eigenvalues[FREE], beside_diagonal[FREE];
  int neutral[FREE];
} memory;

/* Eigenvalues of the energy, the eigenvector of each constraint and how strong that is, whether the solver falls back. */
typedef struct {
  real eigenvalues[FREE];
  int along[HELD];
  real strength[HELD];
  int falls_back;
} problem;

static const real ZERO = 1e-9, DEPENDENT = 1e-10, TOLERANCE = 1e-11, ASIDE = 1e-3;
static const int FREE_UNKNOWNS[FREE] = {0, 2, 3, 5, 6, 8};
static const int HELD_UNKNOWNS[HELD] = {1, 4, 7};
static const real ROOTS[FREE] = {1, 1, 0.8, 0.8, 0.6, 1};
static real eigenvectors[FREE][FREE];

/* Energies are in units of their own, ROOTS: the symmetric matrix is that of the scaled unknowns. */
static void jacobian_at(const problem *at, const real *x, real *jacobian, real *residual) {
  memset(jacobian, 0, N * N * sizeof *jacobian);
  for (int i = 0; i < FREE; i++) {
    for (int j = 0; j < FREE; j++) {
      real sum = 0;
      for (int k = 0; k < FREE; k++) sum += at->eigenvalues[k] * eigenvectors[k][i] * eigenvectors[k][j];
      jacobian[FREE_UNKNOWNS[j] * N + FREE_UNKNOWNS[i]] = sum * ROOTS[j] / ROOTS[i];
    }
    for (int k = 0; k < HELD; k++) {
      const real entry = at->strength[k] * eigenvectors[at->along[k]][i];
      jacobian[FREE_UNKNOWNS[i] * N + HELD_UNKNOWNS[k]] = entry * ROOTS[i];
      jacobian[HELD_UNKNOWNS[k] * N + FREE_UNKNOWNS[i]] = -entry / ROOTS[i];
    }
  }
  /* An elastic cable or stop yields: its stiffness is the square of a strength. */
  for (int k = 0; k < HELD; k++) jacobian[HELD_UNKNOWNS[k] * (N + 1)] = fabs(at->strength[k]) < 0.1;
  for (int i = 0; i < N; i++) {
    residual[i] = 0;
    for (int j = 0; j < N; j++) residual[i] += jacobian[j * N + i] * x[j];
  }
}

static int solve(const problem *at, real *x) {
  if (at->falls_back) memset(x, 0, N * sizeof *x);
  return 1;
}

#include "second_variation.c"

#define CHECK(condition) \
  if (!(condition)) { \
    fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
    return 1; \
  }

static const real ORIGIN[N];
static memory room;

/* An orthogonal matrix: a product of rotations of all pairs of axes. */
static void choose_eigenvectors(void) {
  for (int i = 0; i < FREE; i++) eigenvectors[i][i] = 1;
  for (int i = 0; i < FREE; i++) {
    for (int j = 0; j < i; j++) {
      const real c = cos(1 + 3 * i + j), s = sin(1 + 3 * i + j);
      for (int k = 0; k < FREE; k++) {
        const real one = eigenvectors[k][i], other = eigenvectors[k][j];
        eigenvectors[k][i] = c * one + s * other;
        eigenvectors[k][j] = c * other - s * one;
      }
    }
  }
}

static real smallest_difference(real value, const real *values, int count) {
  real smallest = INFINITY;
  for (int k = 0; k < count; k++) smallest = fmin(smallest, fabs(values[k] - value));
  return smallest;
}

static int test_eigenvalues_and_variations(void) {
  const problem at = {{3, -0.5, 7, 1e-3, 20, 2}, {0, 1, 2}, {0, 0, 0}, 0};
  jacobian_at(&at, ORIGIN, room.jacobian, room.residual);
  CHECK(spectrum(&room, room.vectors) == 0);
  for (int k = 0; k < FREE; k++) CHECK(smallest_difference(at.eigenvalues[k], room.eigenvalues, FREE) < 1e-13);
  for (int k = 0; k < FREE; k++) {
    const real *vector = room.vectors + k * FREE;
    CHECK(fabs(norm_of(vector, FREE) - 1) < 1e-13);
    /* Along one of the eigenvectors: the one of this eigenvalue. */
    for (int m = 0; m < FREE; m++) {
      real cosine = 0;
      for (int i = 0; i < FREE; i++) cosine += vector[i] * eigenvectors[m][i];
      const int same = fabs(at.eigenvalues[m] - room.eigenvalues[k]) < 1e-12;
      CHECK(fabs(fabs(cosine) - same) < 1e-12);
    }
  }
  return 0;
}

/* What releases energy is forbidden by a constraint, which another repeats. */
static int test_constraints(void) {
  const problem held = {{3, -0.5, 7, 0.1, 20, 2}, {1, 1, 3}, {4, -2, 1}, 0};
  const problem slack = {{3, -0.5, 7, 0.1, 20, 2}, {1, 1, 3}, {0.05, 0, 1}, 0};
  verdict_info info;
  CHECK(stability(&held, ORIGIN, &room, &info) == CONVERGED);
  CHECK(info.verdict == STABLE);
  CHECK(info.negative == 0 && info.zero == 0);
  CHECK(fabs(info.smallest_eigenvalue - 2) < 1e-13);
  CHECK(stability(&slack, ORIGIN, &room, &info) == CONVERGED);
  CHECK(info.verdict == UNSTABLE);
  CHECK(info.negative == 1);
  CHECK(fabs(info.smallest_eigenvalue + 0.5 - 0.05 * 0.05) < 1e-13);
  return 0;
}

static int test_neutral_and_critical(void) {
  problem at = {{3, 0, 7, 0.1, 20, 2}, {0, 2, 4}, {0, 1, 1}, 0};
  verdict_info info;
  CHECK(stability(&at, ORIGIN, &room, &info) == CONVERGED);
  CHECK(info.verdict == NEUTRAL);
  CHECK(info.zero == 1);
  /* The way along the variation, in unscaled unknowns. */
  for (int i = 0; i < FREE; i++) {
    CHECK(fabs(fabs(room.beside[FREE_UNKNOWNS[i]]) - ASIDE * fabs(eigenvectors[1][i]) / ROOTS[i]) < 1e-14);
  }
  at.falls_back = 1;
  CHECK(stability(&at, ORIGIN, &room, &info) == CONVERGED);
  CHECK(info.verdict == CRITICAL);
  return 0;
}

static int test_what_is_not_judged(void) {
  problem at = {{3, 1, 7, 0.1, 20, 2}, {0, 2, 4}, {0, 0, 0}, 0};
  real x[N] = {0};
  verdict_info info;
  x[2] = 1e-6;
  CHECK(stability(&at, x, &room, &info) == NOT_IN_EQUILIBRIUM);
  x[2] = NAN;
  CHECK(stability(&at, x, &room, &info) == NOT_FINITE);
  at.eigenvalues[3] = NAN;
  CHECK(stability(&at, ORIGIN, &room, &info) == NOT_FINITE);
  return 0;
}

int main(void) {
  choose_eigenvectors();
  return test_eigenvalues_and_variations() || test_constraints() || test_neutral_and_critical() ||
         test_what_is_not_judged();
}
