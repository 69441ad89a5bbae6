/* Derivatives of a step by its start and its inputs: the implicit function theorem at its stages, with the Jacobian of
   each. */

/* Results, 2 N numbers in each column; any may be null. */
typedef struct {
  real *by_start;       /* by x, then v */
  real *by_inputs[ORDERS]; /* by inputs, their rates at the start, their accelerations */
} step_derivatives;

/* The matrix of both stages, whose unknowns are h^2 a and the values of multipliers. */
static int factorise_stages(real size, const stage_factors *found, workspace *work) {
  for (int s = 0; s < STAGES; s++) {
    const real *stiffness = work->matrices[s];
    const real *damping = stiffness + STAGE_ENTRIES;
    const real *mass = stiffness + 2 * STAGE_ENTRIES;
    for (int t = 0; t < STAGES; t++) {
      real *block = work->stage_values + (s * STAGES + t) * STAGE_ENTRIES;
      const real same = s == t;
      const real rate = STAGE_MATRIX[s][t] / size;
      for (int k = 0; k < STAGE_ENTRIES; k++) {
        const real of_shape = STAGE_MATRIX_SQUARED[s][t] * stiffness[k] + rate * damping[k] + same / (size * size) * mass[k];
        block[k] = IS_SHAPE[ENTRY_COLUMNS[k]] ? of_shape : same * stiffness[k];
      }
    }
  }
  return factorise_system(matrix_of_stages(), work->stage_values, found);
}

/* Changes of the end, x then v, by changes of the stages' unknowns at a constant start. */
static void end_changes(real size, const real *stages, real *end) {
  for (int i = 0; i < N; i++) {
    const real first = stages[i];
    const real second = stages[N + i];
    end[i] = second;
    end[N + i] = 0;
    if (!IS_SHAPE[i]) continue;
    end[i] = STAGE_MATRIX_SQUARED[1][0] * first + STAGE_MATRIX_SQUARED[1][1] * second;
    end[N + i] = (STAGE_MATRIX[1][0] * first + STAGE_MATRIX[1][1] * second) / size;
  }
}

/* Minus the change of the equations of both stages by a coordinate at the start, or by its rate. */
static void change_by_start(real size, int column, real *stages, const workspace *work) {
  const int unknown = column % N;
  const int of_rate = column >= N;
  for (int s = 0; s < STAGES; s++) {
    const real *stiffness = work->matrices[s];
    const real *damping = stiffness + STAGE_ENTRIES;
    const real share = of_rate ? STAGE_NODES[s] * size : 1;
    for (int k = ENTRY_STARTS[unknown]; k < ENTRY_STARTS[unknown + 1]; k++) {
      stages[s * N + ENTRY_ROWS[k]] = -share * stiffness[k] - (of_rate ? damping[k] : 0);
    }
  }
}

/* Minus the change of the equations of both stages by an input; rates stand behind the inputs, accelerations behind the
   rates. */
static void change_by_input(real size, int column, real *stages, const workspace *work) {
  const int count = INPUTS > 0 ? INPUTS : 1;
  const int input = column % count;
  const int changed = column / count;
  for (int s = 0; s < STAGES; s++) {
    /* Changes of the inputs and their rates at the stage by a change of the rate, or of the acceleration. */
    const real time = STAGE_NODES[s] * size;
    const real grown[ORDERS] = {1, time, time * time / 2};
    for (int order = 0; order <= changed; order++) {
      const real *matrix = work->input_matrices[s] + (order * INPUTS + input) * N;
      for (int i = 0; i < N; i++) stages[s * N + i] -= grown[changed - order] * matrix[i];
    }
  }
}

/* Solves for both stages in place. Separate elimination of rods restricts pivots and leaves errors far above rounding;
   one step of refinement removes them. */
static void solve_stage_columns(const stage_factors *factors, real *columns, workspace *work) {
  real *left = work->left_of_columns;
  memcpy(left, columns, sizeof work->left_of_columns);
  solve_system(matrix_of_stages(), FOUR, factors, columns, work);
  if (BY_FRONTS.front_count == 1 || *factors->as_a_whole) return;
  for (int lane = 0; lane < FOUR; lane++) {
    for (int s = 0; s < STAGES; s++) {
      real *rows = left + lane * STAGED + s * N;
      for (int t = 0; t < STAGES; t++) {
        const real *block = work->stage_values + (s * STAGES + t) * STAGE_ENTRIES;
        const real *solved = columns + lane * STAGED + t * N;
        for (int k = 0; k < STAGE_ENTRIES; k++) rows[ENTRY_ROWS[k]] -= block[k] * solved[ENTRY_COLUMNS[k]];
      }
    }
  }
  solve_system(matrix_of_stages(), FOUR, factors, left, work);
  for (int i = 0; i < FOUR * STAGED; i++) columns[i] += left[i];
}

#ifdef STEPS_IN_CONTACT
#include "contact_sensitivity.c"
#endif

/* Solves for columns of a derivative, four at a time. */
static void differentiate_columns(void (*change)(real, int, real *, const workspace *), real size, int first, int last,
                                  const stage_factors *factors, real *columns, workspace *work) {
  real *stages = work->stage_solution;
  for (int j = first; j < last; j += FOUR) {
    memset(stages, 0, FOUR * STAGED * sizeof *stages);
    for (int lane = 0; lane < FOUR && j + lane < last; lane++) change(size, j + lane, stages + lane * STAGED, work);
    solve_stage_columns(factors, stages, work);
#ifdef STEPS_IN_CONTACT
    for (int lane = 0; lane < FOUR && j + lane < last; lane++) {
      (change == change_by_start ? change_gaps_by_start : change_gaps_by_input)(size, j + lane, lane, work);
    }
    close_stage_columns(stages, work);
#endif
    for (int lane = 0; lane < FOUR && j + lane < last; lane++) {
      end_changes(size, stages + lane * STAGED, columns + (j + lane - first) * 2 * N);
    }
  }
}

/* Columns of coordinates and of their rates; multipliers at the start do not enter the step. */
static void differentiate_by_start(real size, const stage_factors *factors, real *by_start, workspace *work) {
  differentiate_columns(change_by_start, size, 0, 2 * N, factors, by_start, work);
  for (int j = 0; j < N; j++) {
    real *by_x = by_start + j * 2 * N;
    real *by_v = by_start + (N + j) * 2 * N;
    if (IS_SHAPE[j]) {
      by_x[j] += 1;
      by_v[j] += size;
      by_v[N + j] += 1;
    } else {
      memset(by_x, 0, 2 * N * sizeof *by_x);
      memset(by_v, 0, 2 * N * sizeof *by_v);
    }
  }
}

/* Multiplies the columns of a matrix by the derivative by the start. */
static void carry_on(const real *by_start, int count, real *columns, workspace *work) {
  real *carried = work->carried;
  for (int j = 0; j < count; j++) {
    real *column = columns + j * 2 * N;
    memset(carried, 0, sizeof work->carried);
    for (int k = 0; k < 2 * N; k++) {
      const real *factor = by_start + k * 2 * N;
      for (int i = 0; column[k] != 0 && i < 2 * N; i++) carried[i] += factor[i] * column[k];
    }
    memcpy(column, carried, sizeof work->carried);
  }
}

static void add_columns(const real *columns, real factor, real *sum) {
  for (int i = 0; i < 2 * N * INPUTS; i++) sum[i] += factor * columns[i];
}

/* Derivatives of one part of a step. Returns zero if it has none. */
static int differentiate_part(const step_start *start, const real *unknowns, const step_derivatives *own, workspace *work) {
  const stage_factors factors = {work->stage_rows, work->stage_columns, work->stage_matrix, work->stage_pivots,
                                 &work->stages_as_a_whole};
  for (int s = 0; s < STAGES; s++) {
    stage_at(start, s, unknowns, &work->at);
    matrices_at(&work->at, work->matrices[s], work);
    if (!all_finite(work->matrices[s], MATRICES * STAGE_ENTRIES)) return 0;
#ifdef STEPS_IN_CONTACT
    const int by_inputs = own->by_inputs[0] || own->by_inputs[1] || own->by_inputs[2];
    if (by_inputs) input_matrices_at(&work->at, work->input_matrices[s], work);
    curve_stage(s, by_inputs, work);
#endif
    if (!own->by_inputs[0] && !own->by_inputs[1] && !own->by_inputs[2]) continue;
#ifndef STEPS_IN_CONTACT
    input_matrices_at(&work->at, work->input_matrices[s], work);
#endif
    if (!all_finite(work->input_matrices[s], (int)ORDERS * N * INPUTS)) return 0;
  }
  if (!factorise_stages(start->size, &factors, work)) return 0;
#ifdef STEPS_IN_CONTACT
  if (!border_stages(&factors, work)) return 0;
#endif
  if (own->by_start) differentiate_by_start(start->size, &factors, own->by_start, work);
  for (int order = 0; order < ORDERS; order++) {
    const int first = order * INPUTS;
    real *columns = own->by_inputs[order];
    if (columns) differentiate_columns(change_by_input, start->size, first, first + INPUTS, &factors, columns, work);
  }
  return 1;
}

/* Adds the change of a later part of a step by the inputs, their rates, or their accelerations, at its start. */
static void add_part(const step_derivatives *later, real time, const step_derivatives *wanted, workspace *work) {
  if (wanted->by_start) carry_on(later->by_start, 2 * N, wanted->by_start, work);
  const real grown[ORDERS] = {1, time, time * time / 2};
  for (int changed = 0; changed < ORDERS; changed++) {
    real *columns = wanted->by_inputs[changed];
    if (!columns) continue;
    carry_on(later->by_start, INPUTS, columns, work);
    for (int order = 0; order <= changed; order++) {
      add_columns(later->by_inputs[order], grown[changed - order], columns);
    }
  }
}

/* Derivatives of a step in parts from its start, work->begin. Returns zero if it has none. */
static int differentiate_step(const step_start *whole, int count, const step_derivatives *wanted, workspace *work) {
  const step_derivatives later = {work->by_start,
                                  {work->by_inputs, work->by_inputs_rate, work->by_inputs_acceleration}};
  work->end = work->begin;
#ifdef STEPS_IN_CONTACT
  /* A blow has no derivative. */
  if (work->was_cut) return 0;
#endif
  for (int number = 0; number < count; number++) {
    const real *unknowns = work->parts_unknowns[number];
    const step_start start = part_of_step(whole, number, count, work);
#ifdef STEPS_IN_CONTACT
    press_in_part(number, work);
#endif
    if (!differentiate_part(&start, unknowns, number == 0 ? wanted : &later, work)) return 0;
    if (number > 0) add_part(&later, (real)number * start.size, wanted, work);
    stage_at(&start, STAGES - 1, unknowns, &work->at);
    memcpy(work->end.x, work->at.state, sizeof work->end.x);
    memcpy(work->end.v, work->at.state + N, sizeof work->end.v);
  }
  if (wanted->by_start && !all_finite(wanted->by_start, 4 * N * N)) return 0;
  for (int order = 0; order < ORDERS; order++) {
    const real *columns = wanted->by_inputs[order];
    if (columns && !all_finite(columns, 2 * N * INPUTS)) return 0;
  }
  return 1;
}

/* If the step needed many iterations, the next step begins with a Jacobian from those at its stages. */
static void keep_jacobian_of_stages(real size, solver_step_memory *memory, workspace *work) {
  const stage_factors factors = kept_factors(memory);
  if (memory->jacobian_size > 0) return;
  for (int k = 0; k < MATRICES * STAGE_ENTRIES; k++) {
    work->matrices[0][k] = (real)0.5 * (work->matrices[0][k] + work->matrices[1][k]);
  }
  if (!factorise_step(work->matrices[0], size, &factors, work)) return;
  memory->jacobian_size = size;
  memory->first_iterations = 0;
}

SOLVER_DEVICE solver_motion_status solver_step_sensitivity(const real *inputs, const real *inputs_rate, real dt, solver_state *state,
                                             solver_step_memory *memory, const solver_step_options *options,
                                             real *d_end_d_start, real *d_end_d_inputs, real *d_end_d_inputs_rate,
                                             real *d_end_d_inputs_acceleration, workspace *work,
                                             solver_step_info *info) {
  const step_derivatives wanted = {d_end_d_start, {d_end_d_inputs, d_end_d_inputs_rate, d_end_d_inputs_acceleration}};
  const solver_step_options chosen = chosen_options(options);
  const step_start whole = {work->begin.x, work->begin.v, inputs, inputs_rate, chosen.inputs_acceleration, dt};
  solver_step_info found = no_step();
  work->begin = *state;
  found.status = take_step(&whole, state, memory, &chosen, work, &found);
  if (info) *info = found;
  if (found.status != SOLVER_MOTION_DONE) return found.status;
  if (!differentiate_step(&whole, found.parts, &wanted, work)) return SOLVER_MOTION_SINGULAR;
  keep_jacobian_of_stages(memory->size, memory, work);
  return SOLVER_MOTION_DONE;
}
