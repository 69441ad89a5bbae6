/* Maximum a posteriori of unknown inputs for a table of measured cases. Each row is solved by itself, from the unloaded
   rod: its results do not depend on the rows around it. Parameters, where there are any, are further inputs. The method
   is Levenberg's and Marquardt's, with bounds by projection: C. T. Kelley, Iterative Methods for Optimization, SIAM 1999,
   sections 3.3.5 and 5.4.

   A part of the library's own source, after the solver. Uses K, ROWS, AT, MEASURED, UNKNOWN, difference_at, measured_at.
   Gives: estimate_rows, costs_of_rows. */
#include <stdlib.h>

enum {
  RESULT = 3 + 2 * K + K * K + ROWS + N,
  MAX_SEARCH = 60,
  MAX_APPROACH = 25,
  MAX_TRIALS = 20
};

enum { ROW_FOUND, ROW_WITHOUT_EQUILIBRIUM, ROW_SINGULAR, ROW_NOT_FOUND };

static const real FIRST_DAMPING = 1e-3; /* shares of the squares of the columns */
static const real HARDLY_DAMPED = 1e-13;
static const real EXPECTED_SHARE = 1e-4; /* share of the predicted decrease that a step must bring */
static const real FAR = 1;               /* most that the unknowns of the rod move in a step of the approach (2-norm) */
static const real CLOSE = 1e-6;          /* residual of the equilibrium, and last step, that end the approach */
static const real SAME = 1e-3;           /* distance within which the solver's equilibrium is the one approached */
static const real ROUNDING = 1e-10;      /* predicted decrease, beside one plus the cost, that ends the search */

/* Prior knowledge of the unknowns: bounds, expected values with one over their deviations, typical sizes. */
typedef struct {
  const real *lower, *upper, *mean, *weight, *size;
} knowledge;

/* One row: abscissae, measured numbers, one over the standard deviation of each difference. */
typedef struct {
  const real *at, *measured, *weights;
} measured_row;

typedef struct {
  workspace solver;
  real inputs[INPUTS], trial_inputs[INPUTS];
  real x[N], trial_x[N];
  real d_x[N * K]; /* by the unknown inputs */
  real difference[ROWS], by_x[ROWS * N], by_unknown[ROWS * K];
  real shift[N];
  real information[K * K], factor[K * K], gradient[K], step[K];
  int held[K];
} misfit_memory;

/* Cost: half the sum of squares of all differences in deviations, also from the expected values. */
static real cost_of(const real *difference, const real *inputs, const measured_row *row, const knowledge *known) {
  real sum = 0;
  for (int i = 0; i < ROWS; i++) {
    /* A number that was not measured has no weight, and may be anything. */
    if (row->weights[i] != 0) sum += difference[i] * row->weights[i] * difference[i] * row->weights[i];
  }
  for (int j = 0; j < K; j++) {
    const real apart = (inputs[UNKNOWN[j]] - known->mean[j]) * known->weight[j];
    sum += apart * apart;
  }
  return sum / 2;
}

static real cost_at(const real *x, const real *inputs, const measured_row *row, const knowledge *known,
                    misfit_memory *room) {
  difference_at(x, inputs, row->at, row->measured, room->difference, &room->solver);
  return cost_of(room->difference, inputs, row, known);
}

/* Information of data and prior, and gradient of the cost, at room->x + room->shift. */
static void linearise_misfit(const measured_row *row, const knowledge *known, misfit_memory *room) {
  measured_at(room->x, room->inputs, row->at, row->measured, room->difference, room->by_x, room->by_unknown,
              &room->solver);
  for (int k = 0; k < N; k++) {
    if (room->shift[k] == 0) continue;
    for (int i = 0; i < ROWS; i++) room->difference[i] += room->by_x[k * ROWS + i] * room->shift[k];
  }
  for (int j = 0; j < K; j++) {
    const real *d_x = room->d_x + j * N;
    real *column = room->by_unknown + j * ROWS;
    for (int k = 0; k < N; k++) {
      if (d_x[k] == 0) continue;
      for (int i = 0; i < ROWS; i++) column[i] += room->by_x[k * ROWS + i] * d_x[k];
    }
    for (int i = 0; i < ROWS; i++) column[i] = row->weights[i] != 0 ? column[i] * row->weights[i] : 0;
  }
  for (int j = 0; j < K; j++) {
    const real weight = known->weight[j];
    const real *column = room->by_unknown + j * ROWS;
    real sum = (room->inputs[UNKNOWN[j]] - known->mean[j]) * weight * weight;
    for (int i = 0; i < ROWS; i++) {
      if (row->weights[i] != 0) sum += column[i] * room->difference[i] * row->weights[i];
    }
    room->gradient[j] = sum;
    for (int k = 0; k <= j; k++) {
      const real *other = room->by_unknown + k * ROWS;
      real product = j == k ? weight * weight : 0;
      for (int i = 0; i < ROWS; i++) product += column[i] * other[i];
      room->information[j * K + k] = room->information[k * K + j] = product;
    }
  }
}

/* Unknowns stay at a bound beyond which the cost falls, and so do unknowns with equal bounds. */
static void hold(const knowledge *known, misfit_memory *room) {
  for (int j = 0; j < K; j++) {
    const real value = room->inputs[UNKNOWN[j]];
    room->held[j] = (value <= known->lower[j] && room->gradient[j] > 0) ||
                    (value >= known->upper[j] && room->gradient[j] < 0) || known->lower[j] >= known->upper[j];
  }
}

/* Computes the damped step room->step by Cholesky's factors of the information in typical sizes. Returns the decrease
   of the cost that the linear model predicts, negative without factors. */
static real step_of(real damping, const knowledge *known, misfit_memory *room) {
  real *a = room->factor, *step = room->step;
  real largest = 0;
  for (int j = 0; j < K; j++) {
    const real square = room->information[j * K + j] * known->size[j] * known->size[j];
    if (!room->held[j] && square > largest) largest = square;
  }
  for (int j = 0; j < K; j++) {
    for (int i = 0; i < K; i++) {
      const int apart = room->held[i] || room->held[j];
      a[j * K + i] = apart ? 0 : room->information[j * K + i] * known->size[i] * known->size[j];
    }
    /* No step goes along a direction that no datum sees. */
    const real square = a[j * K + j] > 1e-12 * largest ? a[j * K + j] : 1e-12 * largest;
    a[j * K + j] += damping * square;
    if (a[j * K + j] == 0) a[j * K + j] = 1;
    step[j] = room->held[j] ? 0 : -room->gradient[j] * known->size[j];
  }
  for (int j = 0; j < K; j++) {
    for (int k = 0; k < j; k++) {
      for (int i = j; i < K; i++) a[j * K + i] -= a[k * K + i] * a[k * K + j];
    }
    if (!(a[j * K + j] > 0)) return -1;
    const real root = sqrt(a[j * K + j]);
    for (int i = j; i < K; i++) a[j * K + i] /= root;
  }
  for (int j = 0; j < K; j++) {
    for (int k = 0; k < j; k++) step[j] -= a[k * K + j] * step[k];
    step[j] /= a[j * K + j];
  }
  for (int j = K - 1; j >= 0; j--) {
    for (int k = j + 1; k < K; k++) step[j] -= a[j * K + k] * step[k];
    step[j] /= a[j * K + j];
  }
  for (int j = 0; j < K; j++) step[j] *= known->size[j];
  real slope = 0, curvature = 0;
  for (int j = 0; j < K; j++) {
    slope += room->gradient[j] * step[j];
    for (int i = 0; i < K; i++) curvature += step[i] * room->information[j * K + i] * step[j];
  }
  return -slope - curvature / 2;
}

static real within(real value, int j, const knowledge *known) {
  if (value < known->lower[j]) return known->lower[j];
  return value > known->upper[j] ? known->upper[j] : value;
}

/* Solves for the equilibrium a step away, room->trial_x. Returns its cost, INFINITY without an equilibrium. */
static real try_step(const measured_row *row, const knowledge *known, misfit_memory *room) {
  memcpy(room->trial_inputs, room->inputs, sizeof room->inputs);
  memcpy(room->trial_x, room->x, sizeof room->x);
  for (int j = 0; j < K; j++) {
    const int index = UNKNOWN[j];
    const real value = within(room->inputs[index] + room->step[j], j, known);
    const real moved = value - room->inputs[index];
    room->trial_inputs[index] = value;
    for (int k = 0; k < N; k++) room->trial_x[k] += room->d_x[j * N + k] * moved;
  }
  if (solver_solve(room->trial_inputs, room->trial_x, &room->solver, 0) != SOLVER_CONVERGED) return INFINITY;
  return cost_at(room->trial_x, room->trial_inputs, row, known, room);
}

/* Derivatives room->d_x of the unknowns of the rod by the unknown inputs at constant residual. Returns zero if the
   Jacobian is singular. Leaves its factors in the solver's workspace. */
static int move_with_unknowns(misfit_memory *room) {
  workspace *work = &room->solver;
  updated_jacobian *jacobian = work->updated_jacobians;
  const loads at = full_load(room->inputs);
  jacobian->count = 0;
  if (!linearise(room->x, &at, &jacobian->factors, work) || !jacobian->factors.regular) return 0;
  input_jacobian_at(room->x, &at, work->d_x_d_inputs, work);
  for (int j = 0; j < K; j++) {
    const real *column = work->d_x_d_inputs + UNKNOWN[j] * N;
    real *d_x = room->d_x + j * N;
    for (int i = 0; i < N; i++) d_x[i] = -column[i];
    back_substitute(&jacobian->factors, d_x, work);
  }
  return all_finite(room->d_x, N * K);
}

/* Goes near the least misfit with the rod's unknowns free, its equations linearised and met at the end alone: lifted,
   the problem is far less bent (J. Albersmeyer, M. Diehl, SIAM J. Optim. 20, 2010, 1655-1684). Returns zero if it
   strays, and room->x has no use then; else room->x is an equilibrium. */
static int approach(const measured_row *row, const knowledge *known, misfit_memory *room) {
  const loads at = full_load(room->inputs);
  memset(room->x, 0, sizeof room->x);
  for (int k = 0; k < MAX_APPROACH; k++) {
    real size = 0, length = 0;
    residual_at(room->x, &at, room->shift, &room->solver);
    for (int i = 0; i < N; i++) {
      size += room->shift[i] * room->shift[i];
      room->shift[i] = -room->shift[i];
    }
    if (!isfinite(size) || !move_with_unknowns(room)) return 0;
    back_substitute(&room->solver.updated_jacobians[0].factors, room->shift, &room->solver);
    linearise_misfit(row, known, room);
    hold(known, room);
    if (step_of(HARDLY_DAMPED, known, room) < 0) return 0;
    for (int j = 0; j < K; j++) {
      for (int i = 0; i < N; i++) room->shift[i] += room->d_x[j * N + i] * room->step[j];
    }
    for (int i = 0; i < N; i++) length += room->shift[i] * room->shift[i];
    length = sqrt(length);
    if (!isfinite(length)) return 0;
    const real share = length > FAR ? FAR / length : 1;
    for (int i = 0; i < N; i++) room->x[i] += share * room->shift[i];
    for (int j = 0; j < K; j++) {
      real *value = room->inputs + UNKNOWN[j];
      *value = within(*value + share * room->step[j], j, known);
    }
    if (length > CLOSE || sqrt(size) > CLOSE) continue;
    real distance = 0;
    memcpy(room->trial_x, room->x, sizeof room->x);
    if (solver_solve(room->inputs, room->x, &room->solver, 0) != SOLVER_CONVERGED) return 0;
    for (int i = 0; i < N; i++) distance += (room->x[i] - room->trial_x[i]) * (room->x[i] - room->trial_x[i]);
    return distance <= SAME * SAME;
  }
  return 0;
}

/* Whether a step leads to values within the bounds. */
static int is_inside(const misfit_memory *room, const knowledge *known) {
  for (int j = 0; j < K; j++) {
    const real value = room->inputs[UNKNOWN[j]] + room->step[j];
    if (value < known->lower[j] || value > known->upper[j]) return 0;
  }
  return 1;
}

/* Finds the least misfit of a row, in room. Returns how the search ended. */
static int search(const measured_row *row, const knowledge *known, misfit_memory *room, real *cost, int *iterations) {
  real damping = FIRST_DAMPING;
  memcpy(room->trial_inputs, room->inputs, sizeof room->inputs);
  if (!approach(row, known, room)) {
    /* Searches from the unloaded rod through equilibria. */
    memcpy(room->inputs, room->trial_inputs, sizeof room->inputs);
    memset(room->x, 0, sizeof room->x);
    if (solver_solve(room->inputs, room->x, &room->solver, 0) != SOLVER_CONVERGED) return ROW_WITHOUT_EQUILIBRIUM;
  }
  memset(room->shift, 0, sizeof room->shift);
  *cost = cost_at(room->x, room->inputs, row, known, room);
  for (*iterations = 0; *iterations < MAX_SEARCH; ++*iterations) {
    if (!move_with_unknowns(room)) return ROW_SINGULAR;
    linearise_misfit(row, known, room);
    hold(known, room);
    const real left = step_of(HARDLY_DAMPED, known, room);
    if (!isfinite(left)) return ROW_NOT_FOUND;
    if (left >= 0 && left <= ROUNDING * (1 + *cost)) return ROW_FOUND;
    int k;
    for (k = 0; k < MAX_TRIALS; k++) {
      const real predicted = step_of(damping, known, room);
      const real trial = predicted > 0 ? try_step(row, known, room) : INFINITY;
      if (*cost - trial >= EXPECTED_SHARE * predicted) {
        memcpy(room->inputs, room->trial_inputs, sizeof room->inputs);
        memcpy(room->x, room->trial_x, sizeof room->x);
        *cost = trial;
        damping = damping > HARDLY_DAMPED ? damping / 10 : damping;
        break;
      }
      damping *= 10;
    }
    if (k == MAX_TRIALS) return ROW_NOT_FOUND;
  }
  return ROW_NOT_FOUND;
}

/* inputs (INPUTS x count) with the values to begin with, at (AT x count), measured (MEASURED x count), weights (ROWS x
   count): one over the standard deviation, 0 where nothing was measured; knowledge: K numbers each. results (RESULT x
   count): how it ended, iterations, cost, then unknowns, information (K x K), gradient of the cost (K), differences in
   deviations (ROWS) and the equilibrium, which are NAN where nothing was found. Returns 1 where there is no memory. */
int estimate_rows(int count, const real *inputs, const real *at, const real *measured, const real *weights,
                  const real *lower, const real *upper, const real *mean, const real *weight, const real *size,
                  real *results) {
  const knowledge known = {lower, upper, mean, weight, size};
  misfit_memory *room = (misfit_memory *)malloc(sizeof *room);
  if (!room) return 1;
  for (int i = 0; i < count; i++) {
    const measured_row row = {at + (size_t)i * AT, measured + (size_t)i * MEASURED, weights + (size_t)i * ROWS};
    real *result = results + (size_t)i * RESULT;
    real cost = NAN;
    int iterations = 0;
    memcpy(room->inputs, inputs + (size_t)i * INPUTS, sizeof room->inputs);
    for (int j = 0; j < K; j++) room->inputs[UNKNOWN[j]] = within(room->inputs[UNKNOWN[j]], j, &known);
    const int outcome = search(&row, &known, room, &cost, &iterations);
    result[0] = outcome;
    result[1] = iterations;
    result[2] = cost;
    for (int j = 3; j < RESULT; j++) result[j] = NAN;
    if (outcome != ROW_FOUND) continue;
    for (int j = 0; j < K; j++) result[3 + j] = room->inputs[UNKNOWN[j]];
    memcpy(result + 3 + K, room->information, sizeof room->information);
    memcpy(result + 3 + K + K * K, room->gradient, sizeof room->gradient);
    for (int j = 0; j < ROWS; j++)
      result[3 + 2 * K + K * K + j] = row.weights[j] != 0 ? room->difference[j] * row.weights[j] : 0;
    memcpy(result + 3 + 2 * K + K * K + ROWS, room->x, sizeof room->x);
  }
  free(room);
  return 0;
}

/* Costs a few steps away from estimates. inputs (INPUTS x count) and equilibria (N x count): the estimates; at, measured,
   weights and knowledge as above; steps (K x draws x count) of the unknowns; costs (draws x count): INFINITY outside the
   bounds, and where no equilibrium was found. Returns 1 where there is no memory. */
int costs_of_rows(int count, int draws, const real *inputs, const real *equilibria, const real *at, const real *measured,
                  const real *weights, const real *lower, const real *upper, const real *mean, const real *weight,
                  const real *size, const real *steps, real *costs) {
  const knowledge known = {lower, upper, mean, weight, size};
  misfit_memory *room = (misfit_memory *)malloc(sizeof *room);
  if (!room) return 1;
  for (int i = 0; i < count; i++) {
    const measured_row row = {at + (size_t)i * AT, measured + (size_t)i * MEASURED, weights + (size_t)i * ROWS};
    memcpy(room->inputs, inputs + (size_t)i * INPUTS, sizeof room->inputs);
    memcpy(room->x, equilibria + (size_t)i * N, sizeof room->x);
    const int moves = move_with_unknowns(room);
    for (int k = 0; k < draws; k++) {
      const size_t draw = (size_t)i * draws + k;
      memcpy(room->step, steps + draw * K, sizeof room->step);
      costs[draw] = moves && is_inside(room, &known) ? try_step(&row, &known, room) : INFINITY;
    }
  }
  free(room);
  return 0;
}
