/* Steps of a simulated motion whose sizes are controlled, by Radau IIA with three stages. It is compiled once, for models
   of all sizes.

   cosserat_casadi/numerics holds the same algorithm in Python, which runs where there is no compiler: time_steps.py,
   step_run.py, step_matrices.py, step_control.py; and stage_newton.c is Newton's method. */

/* Loops and sums are put into vectors, and little else, so that the first motion waits for it less. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O1", "tree-loop-vectorize", "tree-slp-vectorize", "vect-cost-model=dynamic", "unswitch-loops")
#endif
#ifdef __clang__
/* A product and a sum are rounded one after the other, as by CasADi's virtual machine. */
#pragma STDC FP_CONTRACT OFF
#endif

#include <math.h>
#include <string.h>

#include "controlled_steps.h"

typedef double real;
#define casadi_real real
#ifdef __GNUC__
#define FOURS_IN_VECTORS
#endif
#include "fours.h"
#define ABSOLUTE fabs

static inline real larger(real a, real b) { return a > b ? a : b; }
static real smaller(real a, real b) { return a < b ? a : b; }

/* A function of Python that reads and writes the arrays of the record. Not zero: it was interrupted. */
typedef int (*python_call)(double time);

/* moving_contacts.c: takes forces of contacts from equations of motion, and writes open gaps behind them. */
typedef void (*contact_call)(const void *contacts, const real *x, const real *inputs, const real *forces, real *rows,
                             real *open);

/* Inverse dynamics in machine code, as CasADi calls it. */
typedef int (*casadi_kernel)(const real **arguments, real **results, long long *integers, real *scratch, int memory);

typedef enum {
  GOES_ON,
  COMPLETED,
  STEP_TOO_SMALL,
  STEP_NOT_FINITE,
  STEP_SINGULAR,
  INTERRUPTED
} steps_outcome;

/* What Python shares: cosserat_casadi/motion/steps_library.py has the same record. Matrices are stored column after
   column. */
typedef struct {
  int unknowns;
  int touch_count; /* forces of contacts, the last unknowns */
  int inputs;
  int moving; /* whether the inputs change */
  int kink_count;
  int most_steps; /* and tries: then Python is asked whether to go on */
  int most_tries;
  const int *differential;
  const real *weights; /* of an error of each unknown, 0 for algebraic ones */
  const real *kinks;   /* ascending times, s */
  /* Where inverse dynamics is evaluated, and its value. */
  real *x;
  real *v;
  real *a;
  real *input_values;
  real *input_rates;
  real *input_accelerations;
  real *residual;
  casadi_kernel kernel; /* null where Python evaluates */
  const real **kernel_arguments;
  real **kernel_results;
  long long *kernel_integers;
  real *kernel_scratch;
  /* The same at all stages at once; null where there is none. */
  casadi_kernel at_stages;
  const real **at_stages_arguments;
  real **at_stages_results;
  long long *at_stages_integers;
  real *at_stages_scratch;
  /* Its derivatives likewise: they read linearised_at and the inputs, and write the matrices. */
  casadi_kernel derivatives; /* null where Python evaluates */
  const real **derivatives_arguments;
  real **derivatives_results;
  long long *derivatives_integers;
  real *derivatives_scratch;
  const real *cubics; /* coefficients of inputs, rates and accelerations, power after power; null where Python evaluates */
  /* The same as a program on slots, each of which has four lanes: x, v, a, inputs, rates and accelerations, residual,
     and what is computed on the way. Null where there is none. */
  const int *program;
  real *slots;
  int program_lines;
  int program_arguments;
  contact_call push; /* null where nothing touches, or where Python evaluates that too */
  const void *contacts;
  python_call residual_at;
  python_call residual_of_stages; /* null where residual_at is called for one stage after the other */
  python_call inputs_at;
  python_call jacobians_at;
  real *stage_times;
  real *stage_x;
  real *stage_v;
  real *stage_a;
  real *stage_results;
  real *stage_input_values;
  real *stage_input_rates;
  real *stage_input_accelerations;
  real *matrices; /* stiffness, damping, mass at the state of the Jacobian in use */
  real *linearised_at; /* that state: x, v, a */
  real *kept_at;       /* and where it was evaluated when the last step was accepted */
  real *now;           /* x, v, a; before the first step as it begins */
  real *before;        /* unknowns of the stages of the last step */
  real *room;          /* steps_room numbers */
  /* The steps taken: time at the end, size, error over tolerance, iterations, residual, contraction, size wanted next. */
  real *facts;
  real *ends;     /* x, v, a of each */
  real *stages;   /* unknowns of the stages of each */
  real *tried_at; /* time before each try */
  real cubics_begin; /* time that their powers are counted from */
  real stop;
  real newton; /* weighted error that Newton's method may leave */
  real lasting;  /* time over which the error of a shorter step acts */
  real drifting; /* time below which Newton's method may leave less, as the step is shorter */
  real longest_allowed;
  real shortest;
  real time;
  real linearised_time;
  real kept_time;
  real before_size; /* 0 before the first step */
  real longest;
  real wanted;
  real size;
  real last_size;
  real last_error;
  real factorised; /* size of the step that the inverses are for, 0 where there are none */
  int refused;
  int linearised;
  int kept; /* whether that Jacobian serves on */
  int fresh;
  int singular_steps;
  int reason;
  int steps;
  int tries;
  int rejected;
  int iterations;
  int jacobians;
  int factorisations;
  int interrupted;
  /* Parts of the room. */
  real *inverses; /* real, rows one after the other; then real and imaginary parts of the factors of the complex matrix */
  real *pair_rows; /* numbers that its rows were multiplied with, and its columns; and where its pivots came from */
  real *pair_columns;
  int *pair_pivots;
  real *stage_inputs;
  real *iterate;
  real *stage_residuals;
  real *stage_corrections;
  real *stage_changes;
  real *transformed;
  real *solutions;
  real *vectors;
  real *taken[ITERATIONS];
  real *duals[ITERATIONS];
} workspace;

enum { STAGES = 3, LANES = 4, PLANES = 3, FACTS = 7, VECTORS = 6, ORDERS = 3 };
#define N (work->unknowns)
#define OWN (work->unknowns - work->touch_count)
#define STAGED (STAGES * N)
#define IS_SHAPE (work->differential)
#define DISPLACEMENTS (work->weights)

/* Four sums, none of which waits for the others. */
static int all_finite(const real *a, int count) {
  real sums[4] = {0, 0, 0, 0};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    for (int k = 0; k < 4; k++) sums[k] += a[i + k] * 0;
  }
  for (; i < count; i++) sums[0] += a[i] * 0;
  return sums[0] + sums[1] + sums[2] + sums[3] == 0;
}

/* ---- Equations ---- */

typedef struct {
  const real *x;
  real size;
} step_start;

/* The inverses are in the workspace. */
typedef int stage_factors;

typedef enum {
  SOLVER_MOTION_DONE,
  SOLVER_MOTION_NOT_SOLVED,
  SOLVER_MOTION_NOT_FINITE,
  SOLVER_MOTION_SINGULAR
} solver_motion_status;

typedef struct {
  int iterations;
  real residual;
  real error_left;
} solver_step_info;

static void call(python_call function, real time, workspace *work) {
  if (!work->interrupted && function(time)) work->interrupted = 1;
}

static void evaluate_inputs(real time, workspace *work) {
  if (!work->moving) return;
  if (!work->cubics) {
    call(work->inputs_at, time, work);
    return;
  }
  real *orders[] = {work->input_values, work->input_rates, work->input_accelerations};
  const real since = time - work->cubics_begin;
  const int stride = 3 * work->inputs;
  for (int order = 0; order < 3; order++) {
    for (int i = 0; i < work->inputs; i++) {
      const real *of_input = work->cubics + order * work->inputs + i;
      real value = 0;
      for (int power = 3; power >= 0; power--) value = value * since + of_input[power * stride];
      orders[order][i] = value;
    }
  }
}

/* The part of contacts in F at the state and the inputs of the record. */
static void push_contacts(real *rows, workspace *work) {
  if (work->push) work->push(work->contacts, work->x, work->input_values, work->x + OWN, rows, rows + OWN);
}

/* F at the state and the inputs of the record. After an interrupt no value counts. */
static void evaluate(real time, workspace *work) {
  if (work->kernel) {
    work->kernel(work->kernel_arguments, work->kernel_results, work->kernel_integers, work->kernel_scratch, 0);
  } else {
    call(work->residual_at, time, work);
  }
  push_contacts(work->residual, work);
  if (work->interrupted) work->residual[0] = NAN;
}

static void residual_at(real time, const real *x, const real *v, const real *a, workspace *work) {
  const size_t bytes = (size_t)N * sizeof *x;
  memcpy(work->x, x, bytes);
  memcpy(work->v, v, bytes);
  memcpy(work->a, a, bytes);
  evaluate_inputs(time, work);
  evaluate(time, work);
}

static void copy_inputs(const real *from, workspace *work) {
  const size_t bytes = (size_t)work->inputs * sizeof *from;
  memcpy(work->input_values, from, bytes);
  memcpy(work->input_rates, from + work->inputs, bytes);
  memcpy(work->input_accelerations, from + 2 * work->inputs, bytes);
}

/* The inputs at the stages of a step: every iteration asks for them. */
static void remember_inputs(real size, workspace *work) {
  const size_t bytes = (size_t)work->inputs * sizeof(real);
  for (int stage = 0; stage < STAGES; stage++) {
    real *kept = work->stage_inputs + 3 * stage * work->inputs;
    work->stage_times[stage] = work->time + STAGE_NODES[stage] * size;
    if (!work->moving) continue;
    evaluate_inputs(work->stage_times[stage], work);
    memcpy(kept, work->input_values, bytes);
    memcpy(kept + work->inputs, work->input_rates, bytes);
    memcpy(kept + 2 * work->inputs, work->input_accelerations, bytes);
  }
}

/* The polynomial of a step of so many s, from its values and its integrals somewhere in it. */
static void motion_in(real size, real share, const real *values, const real *integrals, const real *double_integrals,
                      const real *unknowns, real *x, real *v, real *a, const workspace *work) {
  const real *begin_x = work->now;
  const real *begin_v = work->now + N;
  for (int i = 0; i < N; i++) {
    real value = 0;
    real integral = 0;
    real twice = 0;
    for (int stage = 0; stage < STAGES; stage++) {
      value += values[stage] * unknowns[stage * N + i];
      integral += integrals[stage] * unknowns[stage * N + i];
      twice += double_integrals[stage] * unknowns[stage * N + i];
    }
    x[i] = IS_SHAPE[i] ? begin_x[i] + share * size * begin_v[i] + size * size * twice : value;
    v[i] = IS_SHAPE[i] ? begin_v[i] + size * integral : 0;
    a[i] = IS_SHAPE[i] ? value : 0;
  }
}

/* ---- Inverse dynamics at all stages at once: scalar_program.py, straight_program.py ---- */

#ifdef FOURS_IN_VECTORS
#define EVERY(assignment) \
  for (int i = 0; i < LANES; i++) assignment
#else
#define EVERY(assignment) \
  {                       \
    enum { i = 0 };       \
    assignment;           \
  }
#endif

#define SLOT(number) (slots + LANES * (number))

/* A line computes neighbouring slots from as many neighbours of each operand. */
#define MANY(statement)                                                     \
  {                                                                         \
    const real *a = SLOT(line[2]), *b = SLOT(line[3]), *c = SLOT(line[4]);  \
    for (; to < end; to += LANES, a += LANES, b += LANES, c += LANES) statement;\
    (void)b, (void)c;                                                       \
  }

/* Tables behind the lines list slots that are no neighbours: those that are copied, */
#define GATHER                                                              \
  {                                                                         \
    const int *from = tables + line[2];                                     \
    for (; to < end; to += LANES) STORE(to, LOAD(SLOT(*from++)));           \
  }

/* or the factors of as many products for each slot as an earlier table counts. */
#define ADD_PRODUCTS                                                        \
  {                                                                         \
    const int *counts = tables + line[2], *pair = tables + line[3];         \
    for (; to < end; to += LANES) {                                         \
      FOUR sum = SPREAD(0);                                                 \
      for (int left = *counts++; left > 0; left--, pair += 2) {             \
        sum += LOAD(SLOT(pair[0])) * LOAD(SLOT(pair[1]));                   \
      }                                                                     \
      STORE(to, sum);                                                       \
    }                                                                       \
  }

static void run_lines(const int *program, int lines, real *slots) {
  const int *tables = program + 6 * lines;
  for (const int *line = program; line < tables; line += 6) {
    real *to = SLOT(line[1]);
    const real *end = to + LANES * line[5];
    switch (line[0]) {
      SCALAR_OPERATIONS
    }
  }
}

/* A program of so many lines on slots of four lanes. */
void program_run(const int *program, int lines, real *slots) {
  EVERY_LANE(run_lines(program, lines, slots + lane))
}

static void fill_lane(int lane, int first, const real *values, int count, workspace *work) {
  for (int i = 0; i < count; i++) work->slots[LANES * (first + i) + lane] = values[i];
}

static int is_together(const workspace *work) { return work->program || work->at_stages; }

/* The arguments of a stage are where inverse dynamics is evaluated. */
static void fill_stage(int stage, workspace *work) {
  if (work->at_stages) {
    const size_t bytes = (size_t)OWN * sizeof(real);
    const size_t of_inputs = (size_t)work->inputs * sizeof(real);
    const int first = stage * work->inputs;
    memcpy(work->stage_x + stage * OWN, work->x, bytes);
    memcpy(work->stage_v + stage * OWN, work->v, bytes);
    memcpy(work->stage_a + stage * OWN, work->a, bytes);
    memcpy(work->stage_input_values + first, work->input_values, of_inputs);
    memcpy(work->stage_input_rates + first, work->input_rates, of_inputs);
    memcpy(work->stage_input_accelerations + first, work->input_accelerations, of_inputs);
    return;
  }
  fill_lane(stage, 0, work->x, OWN, work);
  fill_lane(stage, OWN, work->v, OWN, work);
  fill_lane(stage, 2 * OWN, work->a, OWN, work);
  fill_lane(stage, 3 * OWN, work->input_values, work->inputs, work);
  fill_lane(stage, 3 * OWN + work->inputs, work->input_rates, work->inputs, work);
  fill_lane(stage, 3 * OWN + 2 * work->inputs, work->input_accelerations, work->inputs, work);
}

/* Adds inverse dynamics to the part of contacts. */
static void add_together(real *residuals, workspace *work) {
  if (work->at_stages) {
    work->at_stages(work->at_stages_arguments, work->at_stages_results, work->at_stages_integers,
                    work->at_stages_scratch, 0);
    for (int stage = 0; stage < STAGES; stage++) {
      for (int i = 0; i < OWN; i++) residuals[stage * N + i] += work->stage_results[stage * OWN + i];
    }
    return;
  }
  /* The lane that is left over repeats the last stage. */
  fill_stage(STAGES, work);
  program_run(work->program, work->program_lines, work->slots);
  for (int stage = 0; stage < STAGES; stage++) {
    for (int i = 0; i < OWN; i++) residuals[stage * N + i] += work->slots[LANES * (work->program_arguments + i) + stage];
  }
}

/* Residuals of all stages. Returns the largest entry, or one that is not finite. */
static real residuals_of_stages(const step_start *start, const real *unknowns, real *residuals, workspace *work) {
  const size_t bytes = (size_t)N * sizeof *residuals;
  real largest = 0;
  for (int stage = 0; stage < STAGES; stage++) {
    const real values[STAGES] = {stage == 0, stage == 1, stage == 2};
    real *x = work->residual_of_stages ? work->stage_x + stage * N : work->x;
    real *v = work->residual_of_stages ? work->stage_v + stage * N : work->v;
    real *a = work->residual_of_stages ? work->stage_a + stage * N : work->a;
    motion_in(start->size, STAGE_NODES[stage], values, STAGE_MATRIX[stage], STAGE_MATRIX_SQUARED[stage], unknowns, x, v,
              a, work);
    if (work->residual_of_stages) continue;
    if (work->moving) copy_inputs(work->stage_inputs + 3 * stage * work->inputs, work);
    if (is_together(work)) {
      fill_stage(stage, work);
      memset(residuals + stage * N, 0, bytes);
      push_contacts(residuals + stage * N, work);
      continue;
    }
    evaluate(work->stage_times[stage], work);
    memcpy(residuals + stage * N, work->residual, bytes);
  }
  if (is_together(work)) add_together(residuals, work);
  if (work->residual_of_stages) {
    call(work->residual_of_stages, work->time, work);
    memcpy(residuals, work->stage_results, STAGES * bytes);
  }
  if (work->interrupted) return NAN;
  for (int i = 0; i < STAGED; i++) {
    if (!isfinite(residuals[i])) return residuals[i];
    largest = larger(largest, fabs(residuals[i]));
  }
  return largest;
}

/* ---- Linear systems: step_matrices.py ---- */

/* Of a complex number the sum of the sizes of its parts, as in LAPACK: a root for each entry takes longer than the sums. */
static inline real size_of(const real *entry, int plane) {
  return plane ? fabs(entry[0]) + fabs(entry[plane]) : fabs(entry[0]);
}

static void swap(real *a, int stride, real *b, int count) {
  for (int i = 0; i < count; i++) {
    const real kept = a[i * stride];
    a[i * stride] = b[i * stride];
    b[i * stride] = kept;
  }
}

/* Real numbers less a multiple of others. */
static void subtract_real(real *restrict numbers, real factor, const real *restrict others, int count) {
  for (int i = 0; i < count; i++) numbers[i] -= factor * others[i];
}

/* Complex numbers less a multiple of others. */
static void subtract_complex(real *restrict numbers, real *restrict imaginary, real factor, real factor_imaginary,
                             const real *restrict others, const real *restrict others_imaginary, int count) {
  for (int i = 0; i < count; i++) {
    numbers[i] -= factor * others[i] - factor_imaginary * others_imaginary[i];
    imaginary[i] -= factor * others_imaginary[i] + factor_imaginary * others[i];
  }
}

/* Complex numbers times one. */
static void multiply_complex(real *restrict numbers, real *restrict imaginary, real factor, real factor_imaginary,
                             int count) {
  for (int i = 0; i < count; i++) {
    const real whole = numbers[i];
    numbers[i] = whole * factor - imaginary[i] * factor_imaginary;
    imaginary[i] = whole * factor_imaginary + imaginary[i] * factor;
  }
}

/* The rows of a matrix less multiples of the row of a pivot, which is the identity's then. */
static void eliminate(real *a, int k, int n) {
  real *own = a + k * n;
  const real inverse = 1 / own[k];
  own[k] = 1;
  for (int j = 0; j < n; j++) own[j] *= inverse;
  for (int i = 0; i < n; i++) {
    real *row = a + i * n;
    const real factor = row[k];
    if (i == k || factor == 0) continue;
    row[k] = 0;
    subtract_real(row, factor, own, n);
  }
}

/* Largest sum of the sizes of the entries of a column. */
static real norm_of_columns(const real *a, int plane, int n, real *sums) {
  real largest = 0;
  memset(sums, 0, (size_t)n * sizeof *sums);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) sums[j] += size_of(a + i * n + j, plane);
  }
  for (int j = 0; j < n; j++) {
    if (!(sums[j] <= largest)) largest = sums[j];
  }
  return largest;
}

/* Every entry of a matrix times a number of its row and one of its column. */
static void scale_entries(real *a, int plane, const real *restrict of_rows, const real *restrict of_columns, int n) {
  for (int p = 0; p <= plane; p += n * n) {
    for (int i = 0; i < n; i++) {
      real *row = a + p + i * n;
      const real factor = of_rows[i];
      for (int j = 0; j < n; j++) row[j] *= factor * of_columns[j];
    }
  }
}

/* Scales a matrix so that the largest entry of every row and column is one. Returns the largest sum of the sizes of the
   entries of a column then, zero where a row or a column is zero. */
static real scale(real *a, int plane, real *rows, real *columns, real *sums, int n) {
  memset(columns, 0, (size_t)n * sizeof *columns);
  for (int i = 0; i < n; i++) {
    rows[i] = 0;
    for (int j = 0; j < n; j++) rows[i] = larger(rows[i], size_of(a + i * n + j, plane));
    if (!(rows[i] > 0)) return 0;
    rows[i] = 1 / rows[i];
    for (int j = 0; j < n; j++) columns[j] = larger(columns[j], size_of(a + i * n + j, plane) * rows[i]);
  }
  for (int j = 0; j < n; j++) {
    if (!(columns[j] > 0)) return 0;
    columns[j] = 1 / columns[j];
  }
  scale_entries(a, plane, rows, columns, n);
  return norm_of_columns(a, plane, n, sums);
}

/* The largest of some entries that stand so far apart, from one on. */
static int largest_from(int first, const real *a, int plane, int stride, int n) {
  int found = first;
  real largest = size_of(a + first * stride, plane);
  for (int i = first + 1; i < n; i++) {
    const real size = size_of(a + i * stride, plane);
    if (size > largest) {
      largest = size;
      found = i;
    }
  }
  return found;
}

/* The inverse of a real matrix, in place, by Gauss-Jordan elimination with partial pivoting, of the scaled matrix. Zero where
   that one is singular to rounding. */
static int invert(real *a, workspace *work) {
  const int n = N;
  real *rows = work->vectors;
  real *columns = rows + n;
  real *sums = columns + n;
  int *pivots = (int *)(sums + n);
  const real norm = scale(a, 0, rows, columns, sums, n);
  if (!(norm > 0)) return 0;
  for (int k = 0; k < n; k++) {
    pivots[k] = largest_from(k, a + k, 0, n, n);
    if (!(fabs(a[pivots[k] * n + k]) > 0)) return 0;
    if (pivots[k] != k) swap(a + k * n, 1, a + pivots[k] * n, n);
    eliminate(a, k, n);
  }
  for (int k = n - 1; k >= 0; k--) {
    if (pivots[k] != k) swap(a + k, n, a + pivots[k], n);
  }
  if (!(norm * norm_of_columns(a, 0, n, sums) <= SINGULAR_STEP)) return 0;
  scale_entries(a, 0, columns, rows, n);
  return 1;
}

/* The factors of the complex matrix, in place, column after column, by elimination with partial pivoting, of the scaled
   matrix: its inverse would take three times as long. Zero where that one is singular to rounding. */
static int factorise_pair(real *a, workspace *work) {
  const int n = N;
  const int plane = n * n;
  const real norm = scale(a, plane, work->pair_columns, work->pair_rows, work->vectors, n);
  if (!(norm > 0)) return 0;
  for (int k = 0; k < n; k++) {
    real *own = a + k * n;
    real *own_imaginary = own + plane;
    const int row = work->pair_pivots[k] = largest_from(k, own, plane, 1, n);
    /* A pivot is no smaller than the inverse allows. */
    if (!(norm <= SINGULAR_STEP * size_of(own + row, plane))) return 0;
    if (row != k) {
      for (int p = 0; p <= plane; p += plane) swap(a + p + k, n, a + p + row, n);
    }
    const real square = own[k] * own[k] + own_imaginary[k] * own_imaginary[k];
    own[k] = own[k] / square;
    own_imaginary[k] = -own_imaginary[k] / square;
    const int behind = k + 1;
    multiply_complex(own + behind, own_imaginary + behind, own[k], own_imaginary[k], n - behind);
    for (int j = behind; j < n; j++) {
      real *other = a + j * n;
      real *other_imaginary = other + plane;
      if (other[k] == 0 && other_imaginary[k] == 0) continue;
      subtract_complex(other + behind, other_imaginary + behind, other[k], other_imaginary[k], own + behind,
                       own_imaginary + behind, n - behind);
    }
  }
  return 1;
}

/* Solves the complex system by its factors, in place. */
static void solve_pair(real *rows, real *imaginary, const workspace *work) {
  const int n = N;
  const real *factors = work->inverses + n * n;
  const real *factors_imaginary = factors + n * n;
  for (int i = 0; i < n; i++) {
    rows[i] *= work->pair_rows[i];
    imaginary[i] *= work->pair_rows[i];
  }
  for (int k = 0; k < n; k++) {
    swap(rows + k, 1, rows + work->pair_pivots[k], 1);
    swap(imaginary + k, 1, imaginary + work->pair_pivots[k], 1);
  }
  for (int k = 0; k < n; k++) {
    const int behind = k + 1;
    subtract_complex(rows + behind, imaginary + behind, rows[k], imaginary[k], factors + k * n + behind,
                     factors_imaginary + k * n + behind, n - behind);
  }
  for (int k = n - 1; k >= 0; k--) {
    multiply_complex(rows + k, imaginary + k, factors[k * n + k], factors_imaginary[k * n + k], 1);
    subtract_complex(rows, imaginary, rows[k], imaginary[k], factors + k * n, factors_imaginary + k * n, k);
  }
  for (int j = 0; j < n; j++) {
    rows[j] *= work->pair_columns[j];
    imaginary[j] *= work->pair_columns[j];
  }
}

/* The inverse of K + p C + p^2 M at the real eigenvalue of the method, and its factors at the complex one. */
static int factorise_step(real size, workspace *work) {
  const int entries = N * N;
  const real *stiffness = work->matrices;
  const real *damping = stiffness + entries;
  const real *mass = damping + entries;
  real *whole = work->inverses;
  real *of_pair = whole + entries;
  const real rate = REAL_RATE / size;
  const real pair = PAIR_RATE[0] / size;
  const real pair_imaginary = PAIR_RATE[1] / size;
  const real square = pair * pair - pair_imaginary * pair_imaginary;
  const real square_imaginary = 2 * pair * pair_imaginary;
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      const int from = j * N + i;
      whole[i * N + j] = stiffness[from] + rate * damping[from] + rate * rate * mass[from];
    }
  }
  for (int i = 0; i < entries; i++) {
    of_pair[i] = stiffness[i] + pair * damping[i] + square * mass[i];
    of_pair[entries + i] = pair_imaginary * damping[i] + square_imaginary * mass[i];
  }
  return invert(whole, work) && factorise_pair(of_pair, work);
}

/* Of stage_newton.c, which asks for what stands here. */
static real inner_product(const real *a, const real *b, int count);

/* Rows of a matrix times a vector. */
static void multiply(const real *a, const real *b, real *result, int n) {
  for (int i = 0; i < n; i++) result[i] = inner_product(a + i * n, b, n);
}

/* Corrections of h^2 a, of the values of multipliers. */
static void corrections_of(const stage_factors *factors, const real *residuals, real *corrections, workspace *work) {
  const int n = N;
  real *whole = work->transformed;
  real *pair = whole + n;
  real *pair_imaginary = pair + n;
  real *by_whole = work->solutions;
  (void)factors;
  for (int i = 0; i < n; i++) {
    whole[i] = pair[i] = pair_imaginary[i] = 0;
    for (int stage = 0; stage < STAGES; stage++) {
      whole[i] += TO_REAL[stage] * residuals[stage * n + i];
      pair[i] += TO_PAIR[stage][0] * residuals[stage * n + i];
      pair_imaginary[i] += TO_PAIR[stage][1] * residuals[stage * n + i];
    }
  }
  multiply(work->inverses, whole, by_whole, n);
  solve_pair(pair, pair_imaginary, work);
  for (int i = 0; i < n; i++) {
    real own = by_whole[i];
    real real_part = pair[i];
    real imaginary = pair_imaginary[i];
    if (IS_SHAPE[i]) {
      /* A change of position is so many times one of h^2 a. */
      own *= REAL_RATE * REAL_RATE;
      real_part = PAIR_SHARE[0] * pair[i] - PAIR_SHARE[1] * pair_imaginary[i];
      imaginary = PAIR_SHARE[0] * pair_imaginary[i] + PAIR_SHARE[1] * pair[i];
    }
    for (int stage = 0; stage < STAGES; stage++) {
      const real of_both = FROM_PAIR[stage][0] * real_part - FROM_PAIR[stage][1] * imaginary;
      corrections[stage * n + i] = -(FROM_REAL[stage] * own + of_both);
    }
  }
}

#include "stage_newton.c"

/* ---- The equations of a step: step_run.py ---- */

/* Whether F is finite at the start of the step and straight on from it: else no iterate is to blame. */
static int finite_here(workspace *work) {
  const real *x = work->now;
  const real *v = x + N;
  const real *a = v + N;
  real *straight_on = work->vectors;
  for (int i = 0; i < N; i++) straight_on[i] = x[i] + work->size * v[i];
  residual_at(work->time, x, v, a, work);
  const int here = all_finite(work->residual, N);
  residual_at(work->time + work->size, straight_on, v, a, work);
  return here && all_finite(work->residual, N);
}

/* First iterate: the polynomial of the step before, or the start. */
static void guess_stages(real *unknowns, const workspace *work) {
  for (int stage = 0; stage < STAGES; stage++) {
    const real share = 1 + STAGE_NODES[stage] * (work->before_size > 0 ? work->size / work->before_size : 0);
    for (int i = 0; i < N; i++) {
      real guess = IS_SHAPE[i] ? work->now[2 * N + i] : work->now[i];
      if (work->before_size > 0) {
        guess = 0;
        for (int k = STAGES - 1; k >= 0; k--) {
          real coefficient = 0;
          for (int j = 0; j < STAGES; j++) coefficient += STAGE_POLYNOMIALS[k][j] * work->before[j * N + i];
          guess = guess * share + coefficient;
        }
      }
      unknowns[stage * N + i] = guess;
    }
  }
}

/* The Jacobian in the middle of the step as the guess has it: there it is nearest to those of all stages. */
static void renew_jacobian(const real *unknowns, workspace *work) {
  real *at = work->linearised_at;
  work->linearised_time = work->time + work->size / 2;
  motion_in(work->size, 0.5, MIDDLE_VALUES, MIDDLE_INTEGRALS, MIDDLE_DOUBLE_INTEGRALS, unknowns, at, at + N, at + 2 * N,
            work);
  if (work->derivatives) {
    evaluate_inputs(work->linearised_time, work);
    work->derivatives(work->derivatives_arguments, work->derivatives_results, work->derivatives_integers,
                      work->derivatives_scratch, 0);
  } else {
    call(work->jacobians_at, work->linearised_time, work);
  }
  work->jacobians++;
  work->linearised = 1;
  work->fresh = 1;
  work->factorised = 0;
}

static void drop_jacobian(workspace *work) {
  work->linearised = 0;
  work->factorised = 0;
}

/* What is wrong where a step was not solved. */
static solver_motion_status not_solved(workspace *work) {
  return finite_here(work) ? SOLVER_MOTION_NOT_SOLVED : SOLVER_MOTION_NOT_FINITE;
}

static solver_motion_status solve_with_jacobian(real *contraction, workspace *work, solver_step_info *info) {
  const step_start start = {work->now, work->size};
  const real share = work->size < work->drifting ? work->size / work->drifting : 1;
  const real allowed = larger(share * work->newton, STAGE_ROUNDING * weighted_length(work->now, 1, work));
  const stage_factors factors = 0;
  guess_stages(work->iterate, work);
  if (!work->linearised) renew_jacobian(work->iterate, work);
  if (work->factorised == 0 && !all_finite(work->matrices, ORDERS * N * N)) return not_solved(work);
  if (work->factorised != work->size) {
    work->factorisations++;
    work->factorised = factorise_step(work->size, work) ? work->size : 0;
  }
  if (work->factorised == 0) return SOLVER_MOTION_SINGULAR;
  remember_inputs(work->size, work);
  info->iterations = 0;
  const solver_motion_status status =
      solve_stages(&start, &factors, allowed, ITERATIONS, work->iterate, contraction, work, info);
  work->iterations += info->iterations;
  return status == SOLVER_MOTION_DONE ? status : not_solved(work);
}

static solver_motion_status solve_step(real *contraction, workspace *work, solver_step_info *info) {
  solver_motion_status status = solve_with_jacobian(contraction, work, info);
  if (status != SOLVER_MOTION_DONE && !work->fresh) {
    /* The Jacobian may be too old. */
    drop_jacobian(work);
    status = solve_with_jacobian(contraction, work, info);
  }
  if (status != SOLVER_MOTION_DONE) drop_jacobian(work);
  return status;
}

/* ---- The error of a step and the size of the next one: step_control.py ---- */

static real size_of_deviation(const real *position, const real *velocity, const workspace *work) {
  return larger(weighted_length(position, 1, work), work->size * weighted_length(velocity, 1, work));
}

/* (1 - h mu J)^-1 applied to a deviation of position and velocity, in place. */
static void filter(real *position, real *velocity, workspace *work) {
  const int n = N;
  const real rate = REAL_RATE / work->size;
  const real *damping = work->matrices + n * n;
  const real *mass = damping + n * n;
  real *impulse = work->transformed;
  real *changed = work->solutions;
  memset(impulse, 0, (size_t)n * sizeof *impulse);
  for (int j = 0; j < n; j++) {
    const real moved = rate * position[j] + velocity[j];
    for (int i = 0; i < n; i++) impulse[i] += mass[j * n + i] * moved + damping[j * n + i] * position[j];
  }
  for (int i = 0; i < n; i++) impulse[i] *= rate;
  multiply(work->inverses, impulse, changed, n);
  for (int i = 0; i < n; i++) {
    velocity[i] = rate * (changed[i] - position[i]);
    position[i] = changed[i];
  }
}

/* NaN is larger than any error. */
static real larger_error(real a, real b) { return a > b || isnan(a) ? a : b; }

static real estimated_error(int after_a_jump, workspace *work) {
  const real scale = work->size / REAL_RATE;
  real *position = work->vectors;
  real *velocity = position + N;
  for (int i = 0; i < N; i++) {
    real missed_velocity = 0;
    real at_start = 0;
    for (int stage = 0; stage < STAGES; stage++) {
      missed_velocity += START_INTEGRALS[stage] * work->iterate[stage * N + i];
      at_start += START_VALUES[stage] * work->iterate[stage * N + i];
    }
    position[i] = -scale * work->size * missed_velocity;
    velocity[i] = scale * (work->now[2 * N + i] - at_start);
  }
  filter(position, velocity, work);
  real error = size_of_deviation(position, velocity, work);
  if (after_a_jump && error > 1) {
    filter(position, velocity, work);
    error = size_of_deviation(position, velocity, work);
  }
  return error;
}

/* Weighted length of what forces move by the dynamic stiffness at the real eigenvalue. */
static real answer_to(const real *forces, workspace *work) {
  multiply(work->inverses, forces, work->solutions, N);
  return REAL_RATE * REAL_RATE * weighted_length(work->solutions, 1, work);
}

/* Start of the step, its kinks and its end: the times between which F is taken to be linear. */
static real bend(int k, int first, int last, const workspace *work) {
  return k < first ? work->time : k < last ? work->kinks[k] : work->time + work->size;
}

/* F at the state of the record at one of these times, by a program at four of them at once. */
static void evaluate_bend(int k, int first, int last, workspace *work) {
  const real time = bend(k, first, last, work);
  const int lane = (k - first + 1) % LANES;
  if (!work->program) {
    evaluate_inputs(time, work);
    evaluate(time, work);
    return;
  }
  for (int ahead = 0; lane == 0 && ahead < LANES; ahead++) {
    evaluate_inputs(bend(k + ahead, first, last, work), work);
    fill_stage(ahead, work);
  }
  if (lane == 0) program_run(work->program, work->program_lines, work->slots);
  for (int i = 0; i < OWN; i++) work->residual[i] = work->slots[LANES * (work->program_arguments + i) + lane];
  if (work->push) evaluate_inputs(time, work);
  push_contacts(work->residual, work);
}

/* Error over tolerance by what the stages do not see of the equations between them, at kinks of F in time. */
static real overlooked_error(workspace *work) {
  const int n = N;
  const real begin = work->time;
  const real end = begin + work->size;
  int first = 0;
  int last = work->kink_count;
  while (first < last && work->kinks[first] <= begin) first++;
  while (last > first && work->kinks[last - 1] >= end) last--;
  if (first == last) return 0;
  real *middle = work->stage_corrections;
  real *seen = work->stage_residuals;
  real *before = work->stage_changes;
  real *impulse = before + n;
  real *moment = impulse + n;
  motion_in(work->size, 0.5, MIDDLE_VALUES, MIDDLE_INTEGRALS, MIDDLE_DOUBLE_INTEGRALS, work->iterate, middle, middle + n,
            middle + 2 * n, work);
  for (int stage = 0; stage < STAGES; stage++) {
    residual_at(work->stage_times[stage], middle, middle + n, middle + 2 * n, work);
    memcpy(seen + stage * n, work->residual, (size_t)n * sizeof *seen);
  }
  memset(impulse, 0, 2 * (size_t)n * sizeof *impulse);
  real share_before = 0;
  for (int k = first - 1; k <= last; k++) {
    const real share = (bend(k, first, last, work) - begin) / work->size;
    const real half = (share - share_before) / 2;
    evaluate_bend(k, first, last, work);
    for (int i = 0; i < n; i++) {
      real missed = 0;
      for (int power = STAGES - 1; power >= 0; power--) {
        real coefficient = 0;
        for (int j = 0; j < STAGES; j++) coefficient += STAGE_POLYNOMIALS[power][j] * seen[j * n + i];
        missed = missed * share + coefficient;
      }
      missed = work->residual[i] - missed;
      if (k >= first) {
        impulse[i] += half * (before[i] + missed);
        moment[i] += half * ((1 - share_before) * before[i] + (1 - share) * missed);
      }
      before[i] = missed;
    }
    share_before = share;
  }
  const real pace = larger(work->size, work->longest) / work->size;
  const real moved = answer_to(moment, work);
  return larger_error(moved, pace * answer_to(impulse, work));
}

static real within(real value, real least, real most) { return smaller(larger(value, least), most); }

/* Factor of a step for the next to meet the tolerance; many iterations call for caution. */
static real factor_of(real error, int iterations) {
  const real safety = SAFETY * (2 * ITERATIONS + 1) / (2 * ITERATIONS + iterations);
  return within(safety * pow(larger(error, SMALLEST_ERROR), -1.0 / (STAGES + 1)), SHRINKAGE, GROWTH);
}

/* Factor that the trend of the last two errors allows (Gustafsson). */
static real predicted_factor(real error, const workspace *work) {
  const real current = larger(error, SMALLEST_ERROR);
  const real trend = pow(work->last_error / (current * current), 1.0 / (STAGES + 1));
  return within(SAFETY * work->size / work->last_size * trend, SHRINKAGE, GROWTH);
}

static void refuse(real factor, workspace *work) {
  work->refused = 1;
  work->wanted = factor * work->size;
}

static void choose_next(real error, int iterations, workspace *work) {
  real factor = factor_of(error, iterations);
  if (work->last_size > 0) factor = smaller(factor, predicted_factor(error, work));
  if (work->refused) factor = smaller(factor, 1);
  /* Little more or less would not pay for new matrices. */
  if (factor >= WORTH_SHRINKING && factor < WORTH_GROWING) factor = 1;
  real following = factor * work->size;
  /* A step cut short by the end of the piece says nothing against the one that was wanted. */
  if (work->size < work->wanted) following = larger(following, work->wanted);
  work->wanted = smaller(following, work->longest_allowed);
  work->refused = 0;
  work->last_size = work->size;
  work->last_error = larger(error, REMEMBERED_ERROR);
}

/* ---- Steps: time_steps.py ---- */

/* Moves to the end of a step, and decides whether its Jacobian serves the next one. */
static void accept(real end, real error, real contraction, const solver_step_info *info, workspace *work) {
  const int n = N;
  real *fact = work->facts + FACTS * work->steps;
  real *arrived = work->ends + 3 * n * work->steps;
  real *stages = work->stages + STAGED * work->steps;
  const size_t bytes = (size_t)n * sizeof *arrived;
  motion_in(work->size, 1, END_VALUES, END_INTEGRALS, END_DOUBLE_INTEGRALS, work->iterate, arrived, arrived + n,
            arrived + 2 * n, work);
  memcpy(stages, work->iterate, STAGES * bytes);
  memcpy(work->before, work->iterate, STAGES * bytes);
  memcpy(work->now, arrived, 3 * bytes);
  const real facts[FACTS] = {end,          work->size, error, (real)info->iterations, info->residual, contraction,
                             work->wanted};
  memcpy(fact, facts, sizeof facts);
  work->time = end;
  work->before_size = work->size;
  work->longest = larger(work->longest, work->size);
  work->fresh = 0;
  if (info->iterations > FEW_ITERATIONS) drop_jacobian(work);
  work->kept = work->linearised;
  work->kept_time = work->linearised_time;
  memcpy(work->kept_at, work->linearised_at, 3 * bytes);
  work->steps++;
}

/* Size of the next step, so that no tiny one is left at the end of the piece. */
static real next_size(const workspace *work) {
  const real remaining = work->stop - work->time;
  if (remaining <= work->wanted) return remaining;
  return remaining < 2 * work->wanted ? remaining / 2 : work->wanted;
}

/* Tries a step of the present size and chooses the next one: GOES_ON where it is taken, else why the motion may end. */
static steps_outcome try_step(real end, workspace *work) {
  solver_step_info info = {0, 0, 0};
  real contraction = 0;
  const int jumped = work->refused || !(work->before_size > 0);
  const solver_motion_status status = solve_step(&contraction, work, &info);
  if (work->interrupted) return INTERRUPTED;
  if (status != SOLVER_MOTION_DONE) {
    refuse(status == SOLVER_MOTION_SINGULAR ? SINGULAR_SHRINKAGE : FAILED_SHRINKAGE, work);
    if (status == SOLVER_MOTION_SINGULAR) return STEP_SINGULAR;
    return status == SOLVER_MOTION_NOT_FINITE ? STEP_NOT_FINITE : STEP_TOO_SMALL;
  }
  /* Over a very short step a small error of position is a large one of velocity. */
  const real acting = within(work->lasting / work->size, 1, MOST_LASTING);
  const real error = acting * larger_error(estimated_error(jumped, work), overlooked_error(work));
  if (work->interrupted) return INTERRUPTED;
  /* Not "error > 1": an error that is not a number must not be accepted. */
  if (!(error <= 1)) {
    /* Before the first step nothing says how the error goes with the size. */
    const int foreseen = work->last_size > 0 && isfinite(error);
    refuse(foreseen ? factor_of(error, info.iterations) : FIRST_SHRINKAGE, work);
    return STEP_TOO_SMALL;
  }
  choose_next(error, info.iterations, work);
  accept(end, error, contraction, &info, work);
  return GOES_ON;
}

/* Positions and algebraic entries of so many unknowns at some times, each in one of some steps: HeldTimes.positions. */
void steps_positions(int times, int unknowns, const real *at, const long long *numbers, const real *facts,
                     const real *begins, const real *ends, const real *stages, const unsigned char *differential,
                     real *positions) {
  enum { KNOWN = 7 }; /* facts of a step: times at its begin and its end, size; and others */
  for (int row = 0; row < times; row++) {
    const long long step = numbers[row];
    const real *fact = facts + KNOWN * step;
    const real *begin = begins + ORDERS * unknowns * step;
    const real *of_stages = stages + STAGES * unknowns * step;
    real *x = positions + row * unknowns;
    if (at[row] == fact[1]) {
      memcpy(x, ends + ORDERS * unknowns * step, (size_t)unknowns * sizeof *x);
      continue;
    }
    const real size = fact[2];
    const real share = (at[row] - fact[0]) / size;
    real values[STAGES];
    real twice[STAGES];
    for (int j = 0; j < STAGES; j++) {
      values[j] = twice[j] = 0;
      for (int power = STAGES - 1; power >= 0; power--) {
        values[j] = values[j] * share + STAGE_POLYNOMIALS[power][j];
        twice[j] = twice[j] * share + STAGE_POLYNOMIALS[power][j] / ((power + 1) * (power + 2));
      }
      twice[j] *= share * share * size * size;
    }
    for (int i = 0; i < unknowns; i++) {
      real moved = 0;
      for (int j = 0; j < STAGES; j++) moved += (differential[i] ? twice[j] : values[j]) * of_stages[j * unknowns + i];
      x[i] = differential[i] ? begin[i] + share * size * begin[unknowns + i] + moved : moved;
    }
  }
}

/* Numbers that the room has to hold. */
int steps_room(int unknowns, int inputs) {
  const int n = unknowns;
  return PLANES * n * n + 3 * n + 3 * STAGES * inputs + 4 * STAGES * n + 3 * n + n + VECTORS * n + 2 * ITERATIONS * STAGES * n;
}

int steps_record(void) { return (int)sizeof(workspace); }

/* Divides the room. */
static void divide(workspace *work) {
  real *free = work->room;
  work->inverses = free;
  free += PLANES * N * N;
  work->pair_rows = free;
  work->pair_columns = free + N;
  work->pair_pivots = (int *)(free + 2 * N);
  free += 3 * N;
  work->stage_inputs = free;
  free += 3 * STAGES * work->inputs;
  real **const of_stages[] = {&work->iterate, &work->stage_residuals, &work->stage_corrections, &work->stage_changes};
  for (int k = 0; k < 4; k++) {
    *of_stages[k] = free;
    free += STAGED;
  }
  work->transformed = free;
  free += 3 * N;
  work->solutions = free;
  free += N;
  work->vectors = free;
  free += VECTORS * N;
  for (int k = 0; k < ITERATIONS; k++) {
    work->taken[k] = free;
    work->duals[k] = free + STAGED;
    free += 2 * STAGED;
  }
}

/* Takes steps until the end, until the motion has none, or until Python is to be asked. A Jacobian that was in use before
   has its state in linearised_at. */
int steps_taken(workspace *work) {
  divide(work);
  work->steps = 0;
  work->tries = 0;
  work->interrupted = 0;
  while (work->time < work->stop) {
    if (work->tries == work->most_tries || work->steps == work->most_steps) return GOES_ON;
    work->tried_at[work->tries++] = work->time;
    work->size = work->wanted;
    if (work->size < work->shortest || work->singular_steps == SINGULAR_STEPS) return work->reason;
    work->size = next_size(work);
    const int last = work->size >= work->stop - work->time;
    const steps_outcome refusal = try_step(last ? work->stop : work->time + work->size, work);
    if (refusal == INTERRUPTED) return INTERRUPTED;
    if (refusal == GOES_ON) {
      work->singular_steps = 0;
      continue;
    }
    work->reason = refusal;
    work->rejected++;
    if (refusal == STEP_SINGULAR) work->singular_steps++;
  }
  return COMPLETED;
}
