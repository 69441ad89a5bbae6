/* A step of a motion by Radau IIA with two stages. See the library's header for what each public function promises.

   cosserat_casadi/numerics/step_matrices.py holds the linear system in Python, stage_newton.c Newton's method. The unknowns
   of a stage are the accelerations of coordinates, and the values of multipliers and tensions. */

/* ---- Equations ---- */

static void evaluate_motion(const motion_part *parts, int count, const instant *at, real *results, workspace *work) {
  for (int k = 0; k < count; k++) {
    const motion_part *own = parts + k;
    for (int i = 0; i < own->state_count; i++) work->motion_state[i] = at->state[own->state[i]];
    for (int i = 0; i < own->input_count; i++) work->motion_inputs[i] = at->inputs[own->inputs[i]];
    own->kernel(work->motion_state, work->motion_inputs, 0, own->constants, work->motion_entries, work);
    for (int i = 0; i < own->entry_count; i++) results[own->entries[i]] = work->motion_entries[i];
  }
}

static void motion_residual_at(const instant *at, real *residual, workspace *work) {
  evaluate_motion(MOTION_RESIDUAL_PARTS, MOTION_RESIDUAL_PART_COUNT, at, residual, work);
}

/* Entries of stiffness, damping and mass, one after the other. */
static void matrices_at(const instant *at, real *matrices, workspace *work) {
  memset(matrices, 0, MATRICES * STAGE_ENTRIES * sizeof *matrices);
  evaluate_motion(MOTION_MATRIX_PARTS, MOTION_MATRIX_PART_COUNT, at, matrices, work);
}

/* Derivatives of the residual by the inputs, by their rates, by their accelerations, N x INPUTS each. */
static void input_matrices_at(const instant *at, real *matrices, workspace *work) {
  memset(matrices, 0, (int)ORDERS * N * SOLVER_INPUT_ROOM * sizeof *matrices);
  evaluate_motion(MOTION_INPUT_PARTS, MOTION_INPUT_PART_COUNT, at, matrices, work);
}

/* Start of a step. */
typedef struct {
  const real *x;
  const real *v;
  const real *inputs;
  const real *inputs_rate;         /* may be null */
  const real *inputs_acceleration; /* may be null */
  real size;                       /* s */
#ifdef STRETCHES_ARE_TOLD
  real since; /* time since inputs had this acceleration, s */
#endif
} step_start;

/* The inputs and their rates at a time after the start of the step, s. */
static void inputs_after(const step_start *start, real time, real *inputs, real *rates) {
  for (int i = 0; i < INPUTS; i++) {
    const real rate = start->inputs_rate ? start->inputs_rate[i] : 0;
    const real acceleration = start->inputs_acceleration ? start->inputs_acceleration[i] : 0;
    inputs[i] = start->inputs[i] + time * (rate + time / 2 * acceleration);
    rates[i] = rate + time * acceleration;
#ifdef STRETCHES_ARE_TOLD
    const real jerk = INPUTS_JERK[i];
    inputs[i] += time * time / 2 * jerk * (start->since + time / 3);
    rates[i] += time * jerk * (start->since + time / 2);
#endif
  }
}

/* The inputs after a share of the step. */
static void inputs_of(const step_start *start, real share, instant *at) {
  inputs_after(start, share * start->size, at->inputs, at->inputs + INPUTS);
  for (int i = 0; i < INPUTS; i++) {
    at->inputs[2 * INPUTS + i] = start->inputs_acceleration ? start->inputs_acceleration[i] : 0;
#ifdef STRETCHES_ARE_TOLD
    at->inputs[2 * INPUTS + i] += (start->since + share * start->size) * INPUTS_JERK[i];
#endif
  }
}

/* Evaluates the polynomial of the step after a share of it, from its values and its integrals there. */
static void motion_in(const step_start *start, real share, const real *values, const real *integrals,
                      const real *double_integrals, const real *unknowns, instant *at) {
  const real h = start->size;
  real *x = at->state;
  real *v = at->state + N;
  real *a = at->state + 2 * N;
  for (int i = 0; i < N; i++) {
    const real first = unknowns[i];
    const real second = unknowns[N + i];
    if (IS_SHAPE[i]) {
      x[i] = start->x[i] + share * h * start->v[i] + h * h * (double_integrals[0] * first + double_integrals[1] * second);
      v[i] = start->v[i] + h * (integrals[0] * first + integrals[1] * second);
      a[i] = values[0] * first + values[1] * second;
    } else {
      x[i] = values[0] * first + values[1] * second;
      v[i] = 0;
      a[i] = 0;
    }
  }
  inputs_of(start, share, at);
}

static void stage_at(const step_start *start, int stage, const real *unknowns, instant *at) {
  const real values[STAGES] = {(real)(stage == 0), (real)(stage == 1)};
  motion_in(start, STAGE_NODES[stage], values, STAGE_MATRIX[stage], STAGE_MATRIX_SQUARED[stage], unknowns, at);
}

/* ---- Newton's method for the stages ---- */

static real larger(real a, real b) { return a > b ? a : b; }

#ifdef STEPS_IN_CONTACT
#include "contact_steps.c"
#endif

/* The matrix of the step at the eigenvalue of the method, K + p C + p^2 M; it has no units of time (C. L. Bottasso et al.,
   Multibody System Dynamics 19, 2008). Zero where it is singular to rounding. */
static int factorise_step(const real *matrices, real size, const stage_factors *found, workspace *work) {
  const real *stiffness = matrices;
  const real *damping = matrices + STAGE_ENTRIES;
  const real *mass = matrices + 2 * STAGE_ENTRIES;
  const real rate = RATE[0] / size;
  const real rate_imaginary = RATE[1] / size;
  const real square = rate * rate - rate_imaginary * rate_imaginary;
  const real square_imaginary = 2 * rate * rate_imaginary;
  real *values = work->stage_values;
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    values[k] = stiffness[k] + rate * damping[k] + square * mass[k];
    values[STAGE_ENTRIES + k] = rate_imaginary * damping[k] + square_imaginary * mass[k];
  }
  return factorise_system(complex_matrix(), values, found);
}

/* Corrections of h^2 a, of the values of multipliers, by the factorised matrix. */
static void corrections_of(const stage_factors *factors, const real *residuals, real *corrections, workspace *work) {
  real *solution = work->stage_solution;
  for (int i = 0; i < N; i++) {
    solution[i] = TO_EIGENVECTOR[0][0] * residuals[i] + TO_EIGENVECTOR[1][0] * residuals[N + i];
    solution[N + i] = TO_EIGENVECTOR[0][1] * residuals[i] + TO_EIGENVECTOR[1][1] * residuals[N + i];
  }
  solve_system(complex_matrix(), 2, factors, solution, work);
#ifdef STEPS_IN_CONTACT
  close_gaps(solution, work);
#endif
  for (int i = 0; i < N; i++) {
    real whole = solution[i];
    real imaginary = solution[N + i];
    if (IS_SHAPE[i]) {
      /* Factor from a change of h^2 a to a change of position. */
      whole = SHARE[0] * solution[i] - SHARE[1] * solution[N + i];
      imaginary = SHARE[0] * solution[N + i] + SHARE[1] * solution[i];
    }
    for (int stage = 0; stage < STAGES; stage++) {
      corrections[stage * N + i] = FROM_EIGENVECTOR[stage][1] * imaginary - FROM_EIGENVECTOR[stage][0] * whole;
    }
  }
}

/* Residuals of all stages. Returns the largest entry, or one that is not finite. */
static real residuals_of_stages(const step_start *start, const real *unknowns, real *residuals, workspace *work) {
  real largest = 0;
  for (int stage = 0; stage < STAGES; stage++) {
    stage_at(start, stage, unknowns, &work->at);
    motion_residual_at(&work->at, residuals + stage * N, work);
#ifdef STEPS_IN_CONTACT
    push_in_stage(stage, &work->at, residuals + stage * N, work);
#endif
  }
  for (int i = 0; i < STAGED; i++) {
    if (!isfinite(residuals[i])) return residuals[i];
    largest = larger(largest, ABSOLUTE(residuals[i]));
  }
  return largest;
}

#include "stage_newton.c"

/* ---- Steps ---- */

static stage_factors kept_factors(solver_step_memory *memory) {
  const stage_factors kept = {memory->rows, memory->columns, memory->matrix, memory->pivots, &memory->as_a_whole};
  return kept;
}

/* First iterate: the polynomial of the last step, which was so many times as long, or a constant acceleration. */
static void guess_stages(const real *before, real ratio, const solver_state *state, real *unknowns) {
  for (int stage = 0; stage < STAGES; stage++) {
    const real share = 1 + STAGE_NODES[stage] * ratio;
    for (int i = 0; i < N; i++) {
      real guess = IS_SHAPE[i] ? state->a[i] : state->x[i];
      if (before) {
        guess = (STAGE_POLYNOMIALS[0][0] + share * STAGE_POLYNOMIALS[1][0]) * before[i] +
                (STAGE_POLYNOMIALS[0][1] + share * STAGE_POLYNOMIALS[1][1]) * before[N + i];
      }
      unknowns[stage * N + i] = guess;
    }
  }
}

/* Computes the Jacobian in the middle of the step by the guess, which is nearest to the Jacobians of both stages. */
static solver_motion_status renew_jacobian(const step_start *start, const real *unknowns, solver_step_memory *memory,
                                           workspace *work, solver_step_info *info) {
  const stage_factors factors = kept_factors(memory);
  memory->jacobian_size = 0;
  motion_in(start, (real)0.5, MIDDLE_VALUES, MIDDLE_INTEGRALS, MIDDLE_DOUBLE_INTEGRALS, unknowns, &work->at);
  matrices_at(&work->at, work->matrices[0], work);
#ifdef STEPS_IN_CONTACT
  curve_middle(work);
#endif
  info->jacobians++;
  if (!all_finite(work->matrices[0], MATRICES * STAGE_ENTRIES)) return SOLVER_MOTION_NOT_FINITE;
  if (!factorise_step(work->matrices[0], start->size, &factors, work)) return SOLVER_MOTION_SINGULAR;
  memory->jacobian_size = start->size;
  return SOLVER_MOTION_DONE;
}

/* Whether the next step keeps a Jacobian: a new one would save few iterations, or iterations are hardly more than when
   it was new. */
static int serves_on(const solver_step_memory *memory, int iterations) {
  return iterations <= FEW_ITERATIONS || iterations <= memory->first_iterations + 1;
}

/* Solves one step from a guess in unknowns, with the kept Jacobian if there is one for its size, else with a new one.
   If the kept one fails, it tries a new one. */
static solver_motion_status solve_step(const step_start *start, const solver_step_options *options, real *unknowns,
                                       solver_step_memory *memory, workspace *work, solver_step_info *info) {
  const stage_factors factors = kept_factors(memory);
  const int kept = memory->jacobian_size == start->size;
  /* Positions have the rounding error of the length of a rod, however little the rod bends. */
  const real rounding = STAGE_ROUNDING * larger(1, weighted_length(start->x, 1, work));
  const real allowed = larger(options->tolerance, rounding);
  real contraction;
  solver_motion_status status = SOLVER_MOTION_NOT_SOLVED;
  for (int attempt = kept ? 0 : 1; attempt < 2 && status != SOLVER_MOTION_DONE; attempt++) {
    const int iterations = info->iterations;
    memcpy(work->iterate, unknowns, sizeof work->iterate);
#ifdef STEPS_IN_CONTACT
    guess_forces(work);
#endif
    if (attempt == 1) {
      status = renew_jacobian(start, unknowns, memory, work, info);
      if (status != SOLVER_MOTION_DONE) return status;
    }
#ifdef STEPS_IN_CONTACT
    if (!border_step(&factors, work)) return SOLVER_MOTION_SINGULAR;
#endif
    status = solve_stages(start, &factors, allowed, options->max_iterations, work->iterate, &contraction, work, info);
    const int needed = info->iterations - iterations;
    if (attempt == 1) memory->first_iterations = needed;
    if (status != SOLVER_MOTION_DONE || !serves_on(memory, needed)) memory->jacobian_size = 0;
  }
  memcpy(unknowns, work->iterate, sizeof work->iterate);
  return status;
}

/* Whether the state is the end of the last step, by its polynomial. */
static int continues(const solver_step_memory *memory, const solver_state *state) {
  if (!(memory->size > 0)) return 0;
  for (int i = 0; i < N; i++) {
    if (IS_SHAPE[i] && memory->unknowns[N + i] != state->a[i]) return 0;
  }
  return 1;
}

/* Makes the start of a part of a step from the state in work->end, with inputs and rates at that time. */
static step_start part_of_step(const step_start *whole, int number, int count, workspace *work) {
  const real size = whole->size / (real)count;
  const step_start own = {.x = work->end.x,
                          .v = work->end.v,
                          .inputs = work->part_of_inputs,
                          .inputs_rate = work->part_of_rates,
                          .inputs_acceleration = whole->inputs_acceleration,
                          .size = size};
  inputs_after(whole, (real)number * size, work->part_of_inputs, work->part_of_rates);
  return own;
}

/* Solves the step in so many parts. Leaves their unknowns in the workspace, and the end in work->end. */
static solver_motion_status take_parts(int count, const step_start *whole, const solver_state *state,
                                       const solver_step_options *options, solver_step_memory *memory,
                                       workspace *work, solver_step_info *info) {
  work->end = *state;
#ifdef STEPS_IN_CONTACT
  recall_touches(memory, state, work);
#endif
  for (int number = 0; number < count; number++) {
    real *unknowns = work->parts_unknowns[number];
    const step_start start = part_of_step(whole, number, count, work);
    if (number > 0) {
      guess_stages(unknowns - STAGED, 1, &work->end, unknowns);
    } else if (count == 1 && continues(memory, state)) {
      guess_stages(memory->unknowns, start.size / memory->size, state, unknowns);
    } else {
      guess_stages(0, 1, state, unknowns);
    }
#ifdef STEPS_IN_CONTACT
    const solver_motion_status status = part_in_contact(&start, number, memory, options, unknowns, work, info);
    if (status != SOLVER_MOTION_DONE) return status;
    if (is_inside(work->at.state, work->at.inputs, DEEPEST, work)) return SOLVER_MOTION_NOT_SOLVED;
#else
    const solver_motion_status status = solve_step(&start, options, unknowns, memory, work, info);
    if (status != SOLVER_MOTION_DONE) return status;
    /* The last stage is the end. */
    stage_at(&start, STAGES - 1, unknowns, &work->at);
    if (is_beyond(start.x, start.inputs, work->at.state, work->at.inputs, work)) return SOLVER_MOTION_NOT_SOLVED;
#endif
    memcpy(work->end.x, work->at.state, sizeof work->end.x);
    memcpy(work->end.v, work->at.state + N, sizeof work->end.v);
    memcpy(work->end.a, work->at.state + 2 * N, sizeof work->end.a);
  }
  return all_finite(work->at.state, 3 * N) ? SOLVER_MOTION_DONE : SOLVER_MOTION_NOT_FINITE;
}

static int bounded(int value, int largest) { return value < 1 ? 1 : value > largest ? largest : value; }

static solver_step_options chosen_options(const solver_step_options *options) {
  solver_step_options chosen = {STEP_TOLERANCE, STEP_ITERATIONS, STEP_PARTS, 0};
  if (options) {
    chosen.tolerance = options->tolerance > 0 ? options->tolerance : 0;
    chosen.max_iterations = bounded(options->max_iterations, MAX_STEP_ITERATIONS);
    chosen.max_parts = bounded(options->max_parts, MAX_STEP_PARTS);
    chosen.inputs_acceleration = options->inputs_acceleration;
  }
  return chosen;
}

static int state_is_finite(const solver_state *state) {
  return all_finite(state->x, N) && all_finite(state->v, N) && all_finite(state->a, N);
}

/* Whether an input changes whose acceleration acts on the rods, but no accelerations are given. */
static int misses_acceleration(const step_start *start) {
  if (!start->inputs_rate || start->inputs_acceleration) return 0;
  for (int i = 0; i < INPUTS; i++) {
    if (FEELS_ACCELERATION[i] && start->inputs_rate[i] != 0) return 1;
  }
  return 0;
}

/* Takes a step, whole or in parts; the state changes only if the step is done. */
static solver_motion_status take_step(const step_start *whole, solver_state *state, solver_step_memory *memory,
                                      const solver_step_options *chosen, workspace *work, solver_step_info *info) {
  if (!(whole->size > 0) || !isfinite(whole->size)) return SOLVER_MOTION_BAD_STEP;
  if (!all_finite(whole->inputs, INPUTS) || !state_is_finite(state)) return SOLVER_MOTION_NOT_FINITE;
  if (whole->inputs_rate && !all_finite(whole->inputs_rate, INPUTS)) return SOLVER_MOTION_NOT_FINITE;
  if (whole->inputs_acceleration && !all_finite(whole->inputs_acceleration, INPUTS)) return SOLVER_MOTION_NOT_FINITE;
  if (misses_acceleration(whole)) return SOLVER_MOTION_NO_ACCELERATION;
  solver_motion_status status = SOLVER_MOTION_NOT_SOLVED;
  for (int count = 1; count <= chosen->max_parts && status != SOLVER_MOTION_DONE; count *= 2) {
    info->parts = count;
    status = take_parts(count, whole, state, chosen, memory, work, info);
  }
#ifdef STRAINS_HAVE_LIMITS
  if (status == SOLVER_MOTION_DONE) status = step_within_limits(&work->at, work);
#endif
  if (status != SOLVER_MOTION_DONE) {
    memory->jacobian_size = 0;
    return status;
  }
  *state = work->end;
  memory->size = whole->size / (real)info->parts;
#ifdef STEPS_IN_CONTACT
  keep_touches(memory, work);
#endif
  memcpy(memory->unknowns, work->parts_unknowns[info->parts - 1], sizeof memory->unknowns);
  return status;
}

static solver_step_info no_step(void) {
  const solver_step_info none = {
      .status = SOLVER_MOTION_NOT_FINITE, .iterations = 0, .jacobians = 0, .parts = 0, .residual = 0, .error_left = 0};
  return none;
}

SOLVER_DEVICE solver_motion_status solver_step(const real *inputs, const real *inputs_rate, real dt, solver_state *state,
                                 solver_step_memory *memory, const solver_step_options *options, workspace *work,
                                 solver_step_info *info) {
  const solver_step_options chosen = chosen_options(options);
  const step_start whole = {.x = state->x,
                            .v = state->v,
                            .inputs = inputs,
                            .inputs_rate = inputs_rate,
                            .inputs_acceleration = chosen.inputs_acceleration,
                            .size = dt};
  solver_step_info found = no_step();
  found.status = take_step(&whole, state, memory, &chosen, work, &found);
  if (info) *info = found;
  return found.status;
}
