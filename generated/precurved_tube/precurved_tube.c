/* Solver of precurved_tube: damped Newton with a kept Jacobian, inside adaptive continuation in the load.
   See precurved_tube.h for what each function does. */
#include "precurved_tube.h"

#define casadi_real precurved_tube_real
#define casadi_int int
#include "precurved_tube_kernels.h"

#include <math.h>
#include <string.h>

typedef precurved_tube_real real;
typedef precurved_tube_status outcome;

enum { N = PRECURVED_TUBE_UNKNOWNS, INPUTS = PRECURVED_TUBE_INPUTS, INPUT_ROOM = INPUTS > 0 ? INPUTS : 1, RODS = PRECURVED_TUBE_RODS };

#ifdef PRECURVED_TUBE_SINGLE
static const real TOLERANCE = (real)1e-5;
static const real SHORTEST = (real)1e-4;
static const real SINGULAR = (real)1e-7;
#else
static const real TOLERANCE = (real)1e-11;
static const real SHORTEST = (real)1e-07;
static const real SINGULAR = (real)1e-12;
#endif
enum { ITERATIONS = 60, STEPS = 400, QUICK = 2, SLOW = 4, KEPT_STEPS = 12, HALVINGS = 12 };
static const real SUFFICIENT_DECREASE = (real)0.0001;
static const real KEPT_DECREASE = (real)0.5;
static const real LONGEST = (real)4.0;
static const real ROUGH = (real)0.01;
static const real MOST_BENT = (real)0.5;
static const real FIRST = (real)1.0;
static const real NEAR = (real)0.5;

/* Calls of generated kernels: arguments, results, and room as the kernel asks for. */
#define KERNEL(kernel, ...) \
  const real *given[] = {__VA_ARGS__}; \
  const real *arguments[kernel##_SZ_ARG + 1]; \
  real *results[kernel##_SZ_RES + 1]; \
  int whole[kernel##_SZ_IW + 1]; \
  real work[kernel##_SZ_W + 1]; \
  memcpy(arguments, given, sizeof given)
#define RESULTS(...) \
  { \
    real *const wanted[] = {__VA_ARGS__}; \
    memcpy(results, wanted, sizeof wanted); \
  }
#define CALL(kernel) (void)kernel(arguments, results, whole, work, 0)

/* A point of a path: inputs, and the share of the loads. */
typedef struct {
  real inputs[INPUT_ROOM];
  real factor;
} point;

/* From the unloaded rod under growing loads, or from some inputs to others. */
typedef struct {
  const real *from;
  const real *to;
} path;

/* A factorised Jacobian and the full steps taken since it was formed: Broyden's inverse by steps alone. */
typedef struct {
  precurved_tube_memory own;
  real steps[KEPT_STEPS][N];
  real squares[KEPT_STEPS];
  int count;
} secant;

typedef struct {
  outcome status;
  int iterations;
  int jacobians;
  int damped;
  real norm;
} correction;

/* Where Newton gives up, the length of the step to come at which it may stop, whether it begins with a Jacobian at hand. */
typedef struct {
  int jacobians;
  int halvings;
  real rough;
  int keep;
} limits;

static const limits ANYWHERE = {ITERATIONS, HALVINGS, 0, 0}, ON_TRACK = {ITERATIONS, HALVINGS, 0, 1};

static void whole_load(const real *inputs, point *at) {
  if (INPUTS > 0) memcpy(at->inputs, inputs, INPUTS * sizeof *inputs);
  at->factor = 1;
}

static void residual_at(const real *q, const point *at, real *residual) {
  KERNEL(precurved_tube_k_residual, q, at->inputs, &at->factor);
  RESULTS(residual);
  CALL(precurved_tube_k_residual);
}

static void jacobian_at(const real *q, const point *at, real *jacobian) {
  KERNEL(precurved_tube_k_jacobian, q, at->inputs, &at->factor);
  RESULTS(jacobian);
  CALL(precurved_tube_k_jacobian);
}

static void rate_at(const real *q, const point *at, const real *inputs_rate, real factor_rate, real *rate) {
  KERNEL(precurved_tube_k_rate, q, at->inputs, &at->factor, inputs_rate, &factor_rate);
  RESULTS(rate);
  CALL(precurved_tube_k_rate);
}

static void unloaded_tangent(const real *inputs, real *tangent) {
  KERNEL(precurved_tube_k_tangent, inputs);
  RESULTS(tangent);
  CALL(precurved_tube_k_tangent);
}

static real coarseness_of(const real *q, const real *inputs) {
  real coarseness;
  KERNEL(precurved_tube_k_coarseness, q, inputs);
  RESULTS(&coarseness);
  CALL(precurved_tube_k_coarseness);
  return coarseness;
}

static real dot(const real *a, const real *b) {
  real sum = 0;
  int i;
  for (i = 0; i < N; i++) sum += a[i] * b[i];
  return sum;
}

static real norm_of(const real *a) { return (real)sqrt((double)dot(a, a)); }

static real distance(const real *a, const real *b) {
  real sum = 0;
  int i;
  for (i = 0; i < N; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return (real)sqrt((double)sum);
}

/* How far a step goes: strains and poses count whole, forces by a share. */
static real step_length(const real *step) {
  real sum = 0;
  int i;
  for (i = 0; i < N; i++) {
    const real counted = step[i] * ((real)1.0);
    sum += counted * counted;
  }
  return (real)sqrt((double)sum);
}

static int all_finite(const real *a, int count) {
  int i;
  for (i = 0; i < count; i++) {
    if (!isfinite(a[i])) return 0;
  }
  return 1;
}

/* Gaussian elimination with partial pivoting, in place, column after column. A pivot at rounding becomes zero: symmetry
   may let a rod turn without energy. */
static void factorise(real *a, int *pivots) {
  int i, j, k;
  real tiny = 0;
  for (i = 0; i < N * N; i++) tiny = fabs((double)a[i]) > (double)tiny ? (real)fabs((double)a[i]) : tiny;
  tiny *= SINGULAR;
  for (k = 0; k < N; k++) {
    real *column = a + k * N;
    int best = k;
    for (i = k + 1; i < N; i++) {
      if (fabs((double)column[i]) > fabs((double)column[best])) best = i;
    }
    pivots[k] = best;
    if (best != k) {
      for (j = 0; j < N; j++) {
        const real kept = a[j * N + k];
        a[j * N + k] = a[j * N + best];
        a[j * N + best] = kept;
      }
    }
    if (fabs((double)column[k]) <= (double)tiny) {
      for (i = k; i < N; i++) column[i] = 0;
      continue;
    }
    for (i = k + 1; i < N; i++) column[i] /= column[k];
    for (j = k + 1; j < N; j++) {
      real *target = a + j * N;
      const real share = target[k];
      if (share == 0) continue;
      for (i = k + 1; i < N; i++) target[i] -= column[i] * share;
    }
  }
}

/* Solve with the factors, in place; an unknown without a pivot is left at zero. */
static void substitute(const real *a, const int *pivots, real *b) {
  int i, k;
  for (k = 0; k < N; k++) {
    const real kept = b[pivots[k]];
    b[pivots[k]] = b[k];
    b[k] = kept;
  }
  for (k = 0; k < N; k++) {
    for (i = k + 1; i < N; i++) b[i] -= a[k * N + i] * b[k];
  }
  for (k = N - 1; k >= 0; k--) {
    b[k] = a[k * N + k] == 0 ? 0 : b[k] / a[k * N + k];
    for (i = 0; i < k; i++) b[i] -= a[k * N + i] * b[k];
  }
}

/* Factorised Jacobian at q; zero where it is not finite. */
static int linearise(const real *q, const point *at, secant *kept) {
  jacobian_at(q, at, kept->own.factors);
  if (!all_finite(kept->own.factors, N * N)) return 0;
  factorise(kept->own.factors, kept->own.pivots);
  kept->count = 0;
  return 1;
}

/* Minus the inverse of the Jacobian times a vector, updated by each step and its follower. */
static void through(const secant *kept, const real *vector, real *result) {
  int i, j;
  for (i = 0; i < N; i++) result[i] = -vector[i];
  substitute(kept->own.factors, kept->own.pivots, result);
  for (j = 0; j + 1 < kept->count; j++) {
    const real share = dot(kept->steps[j], result) / kept->squares[j];
    for (i = 0; i < N; i++) result[i] += kept->steps[j + 1][i] * share;
  }
}

/* The step at an iterate with this residual; zero where it is not finite. */
static int step_for(const secant *kept, const real *residual, real *step) {
  int i;
  through(kept, residual, step);
  if (kept->count > 0) {
    const int last = kept->count - 1;
    const real share = 1 - dot(kept->steps[last], step) / kept->squares[last];
    for (i = 0; i < N; i++) step[i] /= share;
  }
  return all_finite(step, N);
}

/* Minus the inverse times any vector: the update that belongs to the last step takes the one that would follow it. */
static int response(const secant *kept, const real *residual, const real *vector, real *result) {
  real next[N];
  int i;
  through(kept, vector, result);
  if (kept->count > 0 && step_for(kept, residual, next)) {
    const int last = kept->count - 1;
    const real share = dot(kept->steps[last], result) / kept->squares[last];
    for (i = 0; i < N; i++) result[i] += next[i] * share;
  }
  return all_finite(result, N);
}

/* Halve the step until the residual falls; the length that served, or zero. q, residual and norm move on then. */
static real search(const point *at, const real *step, int halvings, real *q, real *residual, real *norm) {
  real trial[N], there[N], length = 1;
  int i, k;
  for (k = 0; k <= halvings; k++) {
    real trial_norm;
    for (i = 0; i < N; i++) trial[i] = q[i] + length * step[i];
    residual_at(trial, at, there);
    trial_norm = norm_of(there);
    if (isfinite(trial_norm) && trial_norm <= (1 - SUFFICIENT_DECREASE * length) * *norm) {
      memcpy(q, trial, sizeof trial);
      memcpy(residual, there, sizeof there);
      *norm = trial_norm;
      return length;
    }
    length /= 2;
  }
  return 0;
}

/* Newton at one point of a path, from q and the residual there. Leaves both, and the last Jacobian. */
static correction newton(const point *at, const limits *most, real *q, secant *kept, real *residual) {
  correction end = {PRECURVED_TUBE_MAX_ITERATIONS, 0, 0, 0, 0};
  real step[N], norm;
  int keep = most->keep;
  norm = norm_of(residual);
  for (;;) {
    const real before = norm, size = 1 + norm_of(q);
    real length = 0;
    end.norm = norm / size;
    /* Any residual is small beside unknowns whose norm overflows. */
    if (!isfinite(norm) || !isfinite(size)) {
      end.status = PRECURVED_TUBE_NOT_FINITE;
      return end;
    }
    if (norm <= TOLERANCE * size) end.status = PRECURVED_TUBE_CONVERGED;
    if (end.status == PRECURVED_TUBE_CONVERGED || end.iterations == ITERATIONS) return end;
    if (!keep) {
      if (end.jacobians == most->jacobians) return end;
      end.jacobians++;
      if (!linearise(q, at, kept)) {
        end.status = PRECURVED_TUBE_NOT_FINITE;
        return end;
      }
    }
    end.iterations++;
    if (step_for(kept, residual, step)) length = search(at, step, keep ? 0 : most->halvings, q, residual, &norm);
    if (length == 0) {
      if (!keep) {
        end.status = PRECURVED_TUBE_SINGULAR;
        return end;
      }
      keep = 0;
      continue;
    }
    if (length < 1) end.damped = 1;
    if (length == 1) {
      const real square = dot(step, step);
      memcpy(kept->steps[kept->count], step, sizeof step);
      kept->squares[kept->count] = square;
      kept->count++;
      if ((real)sqrt((double)square) * norm < most->rough * before) end.status = PRECURVED_TUBE_CONVERGED;
    }
    keep = length == 1 && norm <= KEPT_DECREASE * before && kept->count < KEPT_STEPS;
  }
}

static void point_on(const path *way, real t, point *at) {
  int i;
  /* Exact at both ends, whatever the sizes of the two. */
  for (i = 0; i < INPUTS; i++) at->inputs[i] = way->from ? (1 - t) * way->from[i] + t * way->to[i] : way->to[i];
  at->factor = way->from ? 1 : t;
}

/* Whether a correction leaves a point on the path and not on some other. */
static int is_small(const real *correction, const real *predicted) {
  return step_length(correction) <= (real)0.3 + (real)0.5 * step_length(predicted);
}

static int trusted(const correction *end, const real *trial, const real *q, const real *predicted) {
  real change[N];
  int i;
  if (end->status != PRECURVED_TUBE_CONVERGED || end->damped) return 0;
  for (i = 0; i < N; i++) change[i] = trial[i] - q[i] - predicted[i];
  return is_small(change, predicted);
}

/* A point of a path. */
typedef struct {
  real q[N];
  real residual[N];
  real tangent[N];
  real t;
} station;

/* dq/dt of a path at an equilibrium on it, with the Jacobian that Newton has left there; zero where there is none. */
static void tangent_at(const path *way, station *here, correction *found, secant *kept) {
  real rate[N], inputs_rate[INPUT_ROOM] = {0};
  point at;
  int i, sound;
  point_on(way, here->t, &at);
  for (i = 0; i < INPUTS; i++) inputs_rate[i] = way->from ? way->to[i] - way->from[i] : 0;
  rate_at(here->q, &at, inputs_rate, way->from ? 0 : 1, rate);
  sound = all_finite(rate, N);
  if (sound && found->jacobians == 0) {
    found->jacobians++;
    sound = linearise(here->q, &at, kept);
  }
  if (!sound || !response(kept, here->residual, rate, here->tangent)) memset(here->tangent, 0, sizeof here->tangent);
}

/* Change of q by the cubic through two points; by the tangent where there is one point, or the two differ much. */
static void predict(const station *here, const station *before, real step, real *predicted) {
  real bent[N];
  int i;
  for (i = 0; i < N; i++) predicted[i] = step * here->tangent[i];
  if (before) {
    const real way = here->t - before->t, share = step / way;
    for (i = 0; i < N; i++) {
      const real moved = here->q[i] - before->q[i];
      const real cubic = way * (here->tangent[i] + before->tangent[i]) - 2 * moved;
      bent[i] = share * share * (cubic + way * here->tangent[i] - moved) + share * share * share * cubic;
    }
    if (step_length(bent) <= MOST_BENT * step_length(predicted)) {
      for (i = 0; i < N; i++) predicted[i] += bent[i];
    }
  }
}

/* Follow a path from t = 0 to 1; the first station is the equilibrium at 0, and info has been begun. The last Jacobian
   at a station, known or not at the first, foresees the next correction: a new one costs far more than to ask it.
   Corrections before the end are rough: where the way ends before it, the last one is completed. */
static void follow(const path *way, station *first, secant *kept, int known, real *q, precurved_tube_info *info) {
  const limits rough = {SLOW, 0, ROUGH, 0}, whole = {SLOW, 0, 0, 0};
  station others[2], *here = first, *before = others, *next = others + 1, *free_station;
  secant other, *spare = &other, *free_secant;
  correction end;
  point at;
  real step = way->from ? 1 : FIRST;
  int k, i, taken = 0;
  for (k = 0; k < STEPS; k++) {
    real predicted[N], foreseen[N], length = step_length(here->tangent);
    if (step > 1 - here->t) step = 1 - here->t;
    if (step * length > LONGEST) step = LONGEST / length;
    if (step < SHORTEST && step < 1 - here->t) break;
    next->t = here->t + step > 1 - (real)1e-12 ? 1 : here->t + step;
    predict(here, taken ? before : 0, step, predicted);
    for (i = 0; i < N; i++) next->q[i] = here->q[i] + predicted[i];
    point_on(way, next->t, &at);
    residual_at(next->q, &at, next->residual);
    if (known && response(kept, here->residual, next->residual, foreseen) && !is_small(foreseen, predicted)) {
      info->iterations++;
      step /= 2;
      continue;
    }
    end = newton(&at, next->t == 1 ? &whole : &rough, next->q, spare, next->residual);
    info->iterations += end.iterations;
    info->jacobians += end.jacobians;
    if (!trusted(&end, next->q, here->q, predicted)) {
      step /= 2;
      continue;
    }
    if (next->t < 1) {
      if (end.jacobians <= QUICK) step *= 2;
      info->jacobians -= end.jacobians;
      tangent_at(way, next, &end, spare);
      info->jacobians += end.jacobians;
    }
    free_station = before;
    before = here;
    here = next;
    next = free_station;
    free_secant = kept;
    kept = spare;
    spare = free_secant;
    known = taken = 1;
    if (here->t == 1) {
      info->status = PRECURVED_TUBE_CONVERGED;
      info->residual_norm = end.norm;
      break;
    }
  }
  memcpy(q, here->q, sizeof here->q);
  info->load_factor = here->t;
  if (here->t < 1) {
    point_on(way, here->t, &at);
    end = newton(&at, &ANYWHERE, q, spare, here->residual);
    info->status = PRECURVED_TUBE_LOAD_STALLED;
    info->iterations += end.iterations;
    info->jacobians += end.jacobians;
    info->residual_norm = end.norm;
  }
}

static void solve_cold(const real *inputs, real *q, precurved_tube_info *info) {
  const path way = {0, inputs};
  station rest = {{0}, {0}, {0}, 0};
  secant none;
  memset(q, 0, N * sizeof *q);
  unloaded_tangent(inputs, rest.tangent);
  if (!isfinite(norm_of(rest.tangent))) {
    info->status = PRECURVED_TUBE_NOT_FINITE;
    return;
  }
  follow(&way, &rest, &none, 0, q, info);
}

/* Newton at the full load from q; zero, and q as it was, where that strays so far that it may be another branch. */
static int solve_near(const limits *most, secant *kept, const real *inputs, real *q, precurved_tube_info *info) {
  real trial[N], residual[N];
  correction end;
  point at;
  memcpy(trial, q, sizeof trial);
  whole_load(inputs, &at);
  residual_at(trial, &at, residual);
  end = newton(&at, most, trial, kept, residual);
  info->iterations += end.iterations;
  info->jacobians += end.jacobians;
  if (end.status != PRECURVED_TUBE_CONVERGED || end.damped || distance(trial, q) > NEAR) return 0;
  memcpy(q, trial, sizeof trial);
  info->status = end.status;
  info->residual_norm = end.norm;
  info->load_factor = 1;
  return 1;
}

static int is_zero(const real *q) {
  int i;
  for (i = 0; i < N; i++) {
    if (q[i] != 0) return 0;
  }
  return 1;
}

/* Nodes too few for so bent a rod give equations whose solution is not one of the rod. */
static outcome finish(const real *q, const real *inputs, precurved_tube_info *found, precurved_tube_info *info) {
  if (found->status == PRECURVED_TUBE_CONVERGED && !(coarseness_of(q, inputs) <= 1)) found->status = PRECURVED_TUBE_UNRESOLVED;
  if (info) *info = *found;
  return found->status;
}

static outcome solve_from(const limits *most, secant *kept, const real *inputs, real *q, precurved_tube_info *info) {
  precurved_tube_info found = {PRECURVED_TUBE_NOT_FINITE, 0, 0, 0, 0};
  const int warm = all_finite(q, N) && !is_zero(q);
  if (!all_finite(inputs, INPUTS)) return finish(q, inputs, &found, info);
  if (!warm || !solve_near(most, kept, inputs, q, &found)) solve_cold(inputs, q, &found);
  return finish(q, inputs, &found, info);
}

outcome precurved_tube_solve(const real *inputs, real *q, precurved_tube_info *info) {
  secant none;
  return solve_from(&ANYWHERE, &none, inputs, q, info);
}

outcome precurved_tube_follow(const real *from, const real *inputs, real *q, precurved_tube_info *info) {
  precurved_tube_info found = {PRECURVED_TUBE_NOT_FINITE, 0, 0, 0, 0};
  const path way = {from, inputs};
  station first;
  secant kept;
  correction end;
  point at;
  if (!all_finite(from, INPUTS) || !all_finite(inputs, INPUTS) || !all_finite(q, N)) return finish(q, inputs, &found, info);
  memcpy(first.q, q, sizeof first.q);
  first.t = 0;
  point_on(&way, 0, &at);
  residual_at(first.q, &at, first.residual);
  end = newton(&at, &ANYWHERE, first.q, &kept, first.residual);
  found.status = end.status;
  found.iterations = end.iterations;
  found.jacobians = end.jacobians;
  found.residual_norm = end.norm;
  if (end.status != PRECURVED_TUBE_CONVERGED) return finish(q, inputs, &found, info);
  tangent_at(&way, &first, &end, &kept);
  found.jacobians = end.jacobians;
  follow(&way, &first, &kept, 1, q, &found);
  return finish(q, inputs, &found, info);
}

/* Cases first to last, one after the other. */
static int solve_run(int first, int last, const real *inputs, real *q, precurved_tube_info *info) {
  int i, converged = 0;
  for (i = first; i < last; i++) {
    real *here = q + (size_t)i * N;
    if (i > first && info[i - 1].status == PRECURVED_TUBE_CONVERGED) memcpy(here, here - N, N * sizeof *here);
    else memset(here, 0, N * sizeof *here);
    converged += precurved_tube_solve(inputs + (size_t)i * INPUTS, here, info + i) == PRECURVED_TUBE_CONVERGED;
  }
  return converged;
}

int precurved_tube_solve_batch(int count, const real *inputs, real *q, precurved_tube_info *info) {
#ifdef _OPENMP
  enum { RUN = 64 };
  int converged = 0, first;
#pragma omp parallel for schedule(dynamic) reduction(+ : converged)
  for (first = 0; first < count; first += RUN) {
    converged += solve_run(first, count - first < RUN ? count : first + RUN, inputs, q, info);
  }
  return converged;
#else
  return solve_run(0, count, inputs, q, info);
#endif
}

void precurved_tube_residual(const real *q, const real *inputs, real *residual) {
  const real factor = 1;
  KERNEL(precurved_tube_k_residual, q, inputs, &factor);
  RESULTS(residual);
  CALL(precurved_tube_k_residual);
}

void precurved_tube_residual_jacobian(const real *q, const real *inputs, real *jacobian, real *residual) {
  const real factor = 1;
  KERNEL(precurved_tube_k_jacobian, q, inputs, &factor);
  RESULTS(jacobian);
  CALL(precurved_tube_k_jacobian);
  precurved_tube_residual(q, inputs, residual);
}

void precurved_tube_input_jacobian(const real *q, const real *inputs, real *d_residual_d_inputs) {
  real one[INPUT_ROOM] = {0};
  point at;
  int j;
  whole_load(inputs, &at);
  for (j = 0; j < INPUTS; j++) {
    one[j] = 1;
    rate_at(q, &at, one, 0, d_residual_d_inputs + j * N);
    one[j] = 0;
  }
}

void precurved_tube_igm(const real *q, const real *base_position, const real *base_quaternion, const real *inputs,
            real *generalised_force, real *base_force, real *base_moment) {
  KERNEL(precurved_tube_k_igm, q, base_position, base_quaternion, inputs);
  RESULTS(generalised_force, base_force, base_moment);
  CALL(precurved_tube_k_igm);
}

void precurved_tube_tip(const real *q, const real *inputs, real *position, real *quaternion) {
  KERNEL(precurved_tube_k_tip, q, inputs);
  RESULTS(position, quaternion);
  CALL(precurved_tube_k_tip);
}

void precurved_tube_tip_jacobian(const real *q, const real *inputs, real *d_pose_d_q, real *d_pose_d_inputs) {
  KERNEL(precurved_tube_k_tip_jacobian, q, inputs);
  RESULTS(d_pose_d_q, d_pose_d_inputs);
  CALL(precurved_tube_k_tip_jacobian);
}

void precurved_tube_shape(const real *q, const real *inputs, real X, real *position, real *quaternion) {
  KERNEL(precurved_tube_k_shape, q, inputs, &X);
  RESULTS(position, quaternion);
  CALL(precurved_tube_k_shape);
}

static void (*const TIP_JACOBIANS[RODS])(const real *, const real *, real *, real *) = {precurved_tube_tip_jacobian};

/* Rows of d_pose_d_q times columns of d_q_d_inputs, added to d_pose_d_inputs. */
static void add_product(const real *d_pose_d_q, const real *d_q_d_inputs, real *d_pose_d_inputs) {
  int i, j, k;
  for (j = 0; j < INPUTS; j++) {
    for (k = 0; k < N; k++) {
      for (i = 0; i < 7; i++) d_pose_d_inputs[j * 7 + i] += d_pose_d_q[k * 7 + i] * d_q_d_inputs[j * N + k];
    }
  }
}

/* Derivatives of the solution, and the Jacobian that they were taken with. */
static outcome derivatives(const real *inputs, const real *q, secant *kept, real *d_q_d_inputs, real *d_tip_d_inputs) {
  real columns[N * INPUT_ROOM], tips[RODS * 7 * INPUT_ROOM], d_pose_d_q[7 * N];
  point at;
  int i, j;
  whole_load(inputs, &at);
  if (!linearise(q, &at, kept)) return PRECURVED_TUBE_NOT_FINITE;
  for (i = 0; i < N; i++) {
    if (kept->own.factors[i * N + i] == 0) return PRECURVED_TUBE_SINGULAR;
  }
  precurved_tube_input_jacobian(q, inputs, columns);
  for (j = 0; j < INPUTS; j++) {
    for (i = 0; i < N; i++) columns[j * N + i] = -columns[j * N + i];
    substitute(kept->own.factors, kept->own.pivots, columns + j * N);
  }
  if (!all_finite(columns, N * INPUTS)) return PRECURVED_TUBE_SINGULAR;
  for (i = 0; i < RODS; i++) {
    TIP_JACOBIANS[i](q, inputs, d_pose_d_q, tips + i * 7 * INPUTS);
    add_product(d_pose_d_q, columns, tips + i * 7 * INPUTS);
  }
  if (d_q_d_inputs) memcpy(d_q_d_inputs, columns, (size_t)N * INPUTS * sizeof *columns);
  if (d_tip_d_inputs) memcpy(d_tip_d_inputs, tips, (size_t)RODS * 7 * INPUTS * sizeof *tips);
  return PRECURVED_TUBE_CONVERGED;
}

outcome precurved_tube_solve_sensitivity(const real *inputs, const real *q, real *d_q_d_inputs, real *d_tip_d_inputs) {
  real residual[N];
  secant here;
  point at;
  if (!all_finite(inputs, INPUTS) || !isfinite(norm_of(q))) return PRECURVED_TUBE_NOT_FINITE;
  whole_load(inputs, &at);
  residual_at(q, &at, residual);
  if (!(norm_of(residual) <= 10 * TOLERANCE * (1 + norm_of(q)))) return PRECURVED_TUBE_NOT_IN_EQUILIBRIUM;
  return derivatives(inputs, q, &here, d_q_d_inputs, d_tip_d_inputs);
}

outcome precurved_tube_track(const real *inputs, real *q, precurved_tube_memory *memory, real *d_q_d_inputs, real *d_tip_d_inputs,
                      precurved_tube_info *info) {
  secant kept;
  outcome end;
  kept.own = *memory;
  kept.count = 0;
  end = solve_from(memory->known ? &ON_TRACK : &ANYWHERE, &kept, inputs, q, info);
  memory->known = 0;
  if (end == PRECURVED_TUBE_CONVERGED) end = derivatives(inputs, q, &kept, d_q_d_inputs, d_tip_d_inputs);
  if (end == PRECURVED_TUBE_CONVERGED) {
    *memory = kept.own;
    memory->known = 1;
  }
  return end;
}

const char *precurved_tube_status_text(outcome status) {
  switch (status) {
    case PRECURVED_TUBE_CONVERGED:
      return "Equilibrium found: the residual is below its tolerance.";
    case PRECURVED_TUBE_MAX_ITERATIONS:
      return "No equilibrium found: the iterations ran out before the residual was small enough.";
    case PRECURVED_TUBE_NOT_FINITE:
      return "No equilibrium found: the equations gave a value that is not a finite number.";
    case PRECURVED_TUBE_SINGULAR:
      return "No equilibrium found: the Jacobian is singular and no step reduces the residual.";
    case PRECURVED_TUBE_LOAD_STALLED:
      return "No equilibrium found: growing the load from zero, the path could not be followed further; there may be a limit point or a buckling load.";
    case PRECURVED_TUBE_UNRESOLVED:
      return "An equilibrium of the discrete model was found, but the rod is not resolved by its modes and nodes: allow more of them, or a larger tolerance.";
    case PRECURVED_TUBE_NOT_IN_EQUILIBRIUM:
      return "The unknowns are no equilibrium for these inputs: solve first.";
  }
  return "No such status.";
}
