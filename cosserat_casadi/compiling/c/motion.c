/* The equations of motion at an instant: inverse dynamics, their linearisation, and a start at rest. */

/* Makes an instant from its vectors; null stands for zeros. */
static void set_instant(const real *x, const real *v, const real *a, const real *inputs, const real *inputs_rate,
                        const real *inputs_acceleration, instant *at) {
  const real *state[] = {x, v, a};
  const real *given[] = {inputs, inputs_rate, inputs_acceleration};
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < N; i++) at->state[k * N + i] = state[k] ? state[k][i] : 0;
    for (int i = 0; i < INPUTS; i++) at->inputs[k * INPUTS + i] = given[k] ? given[k][i] : 0;
  }
}

SOLVER_DEVICE void solver_inverse_dynamics(const real *x, const real *v, const real *a, const real *inputs, const real *inputs_rate,
                             const real *inputs_acceleration, real *residual, workspace *work) {
  set_instant(x, v, a, inputs, inputs_rate, inputs_acceleration, &work->at);
  motion_residual_at(&work->at, residual, work);
}

SOLVER_DEVICE void solver_residual_units(real *units) { memcpy(units, UNITS, sizeof UNITS); }

static void fill_dense(const real *entries, real *matrix) {
  if (!matrix) return;
  memset(matrix, 0, N * N * sizeof *matrix);
  for (int k = 0; k < STAGE_ENTRIES; k++) matrix[ENTRY_COLUMNS[k] * N + ENTRY_ROWS[k]] = entries[k];
}

SOLVER_DEVICE void solver_linearise(const solver_state *state, const real *inputs, const real *inputs_rate, real *stiffness,
                      real *damping, real *mass, real *d_residual_d_inputs, real *d_residual_d_inputs_rate,
                      real *d_residual_d_inputs_acceleration, workspace *work) {
  real *by_inputs[ORDERS] = {d_residual_d_inputs, d_residual_d_inputs_rate, d_residual_d_inputs_acceleration};
  set_instant(state->x, state->v, state->a, inputs, inputs_rate, 0, &work->at);
  if (stiffness || damping || mass) {
    matrices_at(&work->at, work->matrices[0], work);
    fill_dense(work->matrices[0], stiffness);
    fill_dense(work->matrices[0] + STAGE_ENTRIES, damping);
    fill_dense(work->matrices[0] + 2 * STAGE_ENTRIES, mass);
  }
  if (by_inputs[0] || by_inputs[1] || by_inputs[2]) {
    const size_t count = N * INPUTS;
    input_matrices_at(&work->at, work->input_matrices[0], work);
    for (int order = 0; order < ORDERS; order++) {
      const real *matrix = work->input_matrices[0] + (size_t)order * count;
      if (by_inputs[order]) memcpy(by_inputs[order], matrix, count * sizeof *matrix);
    }
  }
}

/* Marks the rows that depend on positions only: rows of supports, joints and cables. */
static void mark_constraints(const real *matrices, int *is_constraint) {
  for (int i = 0; i < N; i++) is_constraint[i] = 1;
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    const int moves = matrices[STAGE_ENTRIES + k] != 0 || matrices[2 * STAGE_ENTRIES + k] != 0;
    if (moves || (!IS_SHAPE[ENTRY_COLUMNS[k]] && matrices[k] != 0)) is_constraint[ENTRY_ROWS[k]] = 0;
  }
}

/* Accelerations and multipliers at rest by the balance, with constraints differentiated twice at zero velocity. If
   masses do not determine them they stay: they are only the first guess of a step. */
static void accelerate(const int *is_constraint, solver_state *state, const real *residual, workspace *work) {
  const stage_factors factors = {work->stage_rows, work->stage_columns, work->stage_matrix, work->stage_pivots,
                                 &work->stages_as_a_whole};
  const real *stiffness = work->matrices[0];
  const real *mass = stiffness + 2 * STAGE_ENTRIES;
  real *change = work->stage_solution;
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    const int constraint = is_constraint[ENTRY_ROWS[k]];
    const int of_shape = IS_SHAPE[ENTRY_COLUMNS[k]];
    work->stage_values[k] = of_shape && !constraint ? mass[k] : of_shape || !constraint ? stiffness[k] : 0;
  }
  if (!factorise_system(matrix_of_masses(), work->stage_values, &factors)) return;
  for (int i = 0; i < N; i++) change[i] = is_constraint[i] ? 0 : -residual[i];
  solve_system(matrix_of_masses(), 1, &factors, change, work);
  if (!all_finite(change, N)) return;
  for (int i = 0; i < N; i++) {
    if (IS_SHAPE[i]) state->a[i] += change[i];
    else state->x[i] += change[i];
  }
}

SOLVER_DEVICE solver_motion_status solver_rest(const real *inputs, const real *x, solver_state *state, workspace *work) {
  real *residual = work->stage_residuals;
  int *is_constraint = work->is_constraint;
  if (!all_finite(inputs, INPUTS) || !all_finite(x, N)) return SOLVER_MOTION_NOT_FINITE;
  set_instant(x, 0, 0, inputs, 0, 0, &work->at);
  motion_residual_at(&work->at, residual, work);
  matrices_at(&work->at, work->matrices[0], work);
  if (!all_finite(residual, N) || !all_finite(work->matrices[0], MATRICES * STAGE_ENTRIES)) return SOLVER_MOTION_NOT_FINITE;
  mark_constraints(work->matrices[0], is_constraint);
  for (int i = 0; i < N; i++) {
    if (is_constraint[i] && ABSOLUTE(residual[i]) > CLOSED) return SOLVER_MOTION_INCONSISTENT;
  }
  memcpy(state->x, x, sizeof state->x);
  memset(state->v, 0, sizeof state->v);
  memset(state->a, 0, sizeof state->a);
  if (norm_of(residual) > 10 * TOLERANCE * (1 + norm_of(x))) accelerate(is_constraint, state, residual, work);
  return SOLVER_MOTION_DONE;
}
