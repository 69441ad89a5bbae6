/* Many load cases at once, rows of a batch, each solved from the unloaded scene as solver.c does it: rows wait for
   evaluations of the equations, and those that wait for the same are evaluated side by side. What a row does with what it
   has waited for are the functions of solver.c. A row that leaves the common way (inputs that are not finite, a path that
   breaks off) is solved by itself.

   Uses of the scene: the equations in lanes, which are declared below, and given_of_row. */

enum { ROWS = SOLVER_ROWS_TOGETHER /* rows under way: enough of them wait for the same result */ };

/* Inputs, and parameters where there are any, of all rows; unknowns and how each row ended. */
typedef struct {
  const real *inputs;
  const real *parameters;
  real *x;
  solver_info *info;
} batch_of_rows;

/* Result that a row waits for. */
typedef enum {
  WAITS_FOR_NOTHING,
  WAITS_FOR_FIRST_TANGENT,
  WAITS_FOR_PREDICTED_RESIDUAL,
  WAITS_FOR_NEWTON_MATRIX,
  WAITS_FOR_STEP, /* and for the residual behind it */
  WAITS_FOR_RATE,
  WAITS_FOR_TANGENT_MATRIX,
  WAITS_FOR_RESOLUTION
} waiting;

typedef struct {
  waiting state;
  const real *inputs;
  real *x;            /* where the unknowns are wanted */
  solver_info *ended; /* where it is wanted how the row ended */
  load_path path;
  progress now;
  real step; /* of the load */
  int steps;
  newton_limits limits;
  newton_state newton;
  solver_info info;
  real resolution; /* the index of its nodes */
  workspace *work;
} row;

typedef solver_lanes_room lanes_room;

/* The solver's inputs of a row; they may lie in the workspace. */
static const real *given_of_row(const batch_of_rows *batch, int i, workspace *work);

/* The equations in the lanes of a room: results for x, inputs and load_factor. */
static void residual_in_lanes(lanes_room *room);
static void factors_in_lanes(lanes_room *room);
static void rate_in_lanes(lanes_room *room);
static void tangent_in_lanes(lanes_room *room);
static void resolution_in_lanes(lanes_room *room);

/* ---- One row ---- */

static void solve_by_itself(row *own) {
  memset(own->x, 0, N * sizeof *own->x);
  (void)solver_solve(own->inputs, own->x, own->work, own->ended);
  own->state = WAITS_FOR_NOTHING;
}

static void begin_row(row *own, const batch_of_rows *batch, int i) {
  own->inputs = given_of_row(batch, i, own->work);
  own->x = batch->x + (size_t)i * N;
  own->ended = batch->info + i;
  own->info = no_result();
  if (!all_finite(own->inputs, INPUTS)) {
    solve_by_itself(own);
    return;
  }
  memset(own->work->points, 0, sizeof own->work->points[0]);
  own->path.grows_load = 1;
  own->path.from = own->inputs;
  own->path.to = own->inputs;
  own->now = begin_path(0, own->work);
  own->step = FIRST_STEP;
  own->steps = 0;
  own->state = WAITS_FOR_FIRST_TANGENT;
}

static void step_along_path(row *own) {
  if (own->steps < LONG_PATH.max_steps && own->info.iterations < LONG_PATH.max_iterations) {
    own->steps++;
    own->step = admissible_step(&own->now, own->step);
    if (own->step != 0) {
      predict_next(&own->now, own->step, own->work);
      own->state = WAITS_FOR_PREDICTED_RESIDUAL;
      return;
    }
  }
  solve_by_itself(own);
}

/* Newton has ended at the next point. */
static void end_correction(row *own) {
  const newton_result *result = &own->newton.result;
  count_work(&own->info, result);
  if (!is_trusted(&own->path, result, &own->now, own->work)) {
    own->step /= 2;
    step_along_path(own);
  } else if (own->now.next->t < 1) {
    if (result->jacobians <= GROW_BELOW) own->step *= 2;
    own->state = WAITS_FOR_RATE;
  } else {
    accept_next(&own->now);
    own->now.has_jacobian = result->jacobians > 0;
    own->info.status = SOLVER_CONVERGED;
    own->info.residual_norm = result->residual_norm;
    own->info.load_factor = 1;
    own->state = WAITS_FOR_RESOLUTION;
  }
}

/* Writes minus the residual, in the order of the pivots, to the place of the step. */
static void begin_newton_step(row *own) {
  real *step = place_of_step(own->now.spare);
  own->newton.result.iterations++;
  for (int i = 0; i < N; i++) step[i] = -own->now.next->residual[i];
  permute(own->now.spare->factors.pivots, step);
  own->state = WAITS_FOR_STEP;
}

static void continue_newton(row *own, real norm_of_x) {
  if (newton_ends(&own->newton, &own->limits, norm_of_x)) {
    end_correction(own);
  } else if (own->newton.reuse_jacobian) {
    begin_newton_step(own);
  } else {
    expect_jacobian(&own->newton, own->now.spare);
    own->state = WAITS_FOR_NEWTON_MATRIX;
  }
}

static int step_serves(const row *own, const lanes_room *room, int lane) {
  return isfinite(room->squares[lane]) && serves(1, room->norms[lane], own->newton.norm);
}

static void after_step(row *own, const lanes_room *room, int lane) {
  real share = 1;
  real norm = room->norms[lane];
  real norm_of_x = room->norms_of_x[lane];
  if (!step_serves(own, room, lane)) {
    share = 0;
    norm = own->newton.norm;
    norm_of_x = norm_of(own->now.next->x);
  }
  if (weigh_step(&own->newton, &own->limits, room->squares[lane], share, norm, own->now.spare)) {
    continue_newton(own, norm_of_x);
  } else {
    end_correction(own);
  }
}

static void after_first_tangent(row *own) {
  if (isfinite(norm_of(own->now.point->tangent))) {
    step_along_path(own);
  } else {
    solve_by_itself(own);
  }
}

static void after_prediction(row *own) {
  if (!is_promising(&own->now, own->work)) {
    own->info.iterations++;
    own->step /= 2;
    step_along_path(own);
    return;
  }
  own->limits = corrector_limits(own->now.next, LONG_PATH.max_iterations - own->info.iterations);
  own->newton = begin_newton(&own->limits, own->now.next->residual);
  continue_newton(own, norm_of(own->now.next->x));
}

static void after_newton_matrix(row *own, int finite) {
  if (finite) {
    begin_newton_step(own);
    return;
  }
  own->newton.result.status = SOLVER_NOT_FINITE;
  end_correction(own);
}

static void go_on_from_next_point(row *own, int sound) {
  set_tangent(own->now.next, sound, own->now.spare, own->work);
  accept_next(&own->now);
  step_along_path(own);
}

static void after_rate(row *own) {
  const int sound = all_finite(own->work->rate, N);
  if (!sound || own->newton.result.jacobians > 0) {
    go_on_from_next_point(own, sound);
    return;
  }
  own->now.spare->count = 0;
  own->info.jacobians++;
  own->state = WAITS_FOR_TANGENT_MATRIX;
}

static void after_resolution(row *own) {
  if (!(own->resolution <= 1)) own->info.status = SOLVER_UNRESOLVED;
  memcpy(own->x, own->now.point->x, N * sizeof *own->x);
  own->info.status = within_limits(own->info.status, own->x, own->inputs, own->work);
#ifdef SOLVER_MISSING
  if (own->info.status == SOLVER_CONVERGED) {
    updated_jacobian *jacobian = own->now.has_jacobian ? own->now.jacobian : 0;
    own->info.error_estimate = estimated_error(own->x, own->inputs, jacobian, own->work);
  }
#endif
  *own->ended = own->info;
  own->state = WAITS_FOR_NOTHING;
}

/* ---- Rows together ---- */

/* Unknowns of the evaluation that a row waits for. */
static const real *unknowns_of(const row *own) {
  if (own->state == WAITS_FOR_RESOLUTION) return own->now.point->x;
  return own->now.next->x;
}

static void evaluate_in_lanes(waiting state, lanes_room *room) {
  switch (state) {
    case WAITS_FOR_FIRST_TANGENT:
      tangent_in_lanes(room);
      break;
    case WAITS_FOR_NEWTON_MATRIX:
    case WAITS_FOR_TANGENT_MATRIX:
      factors_in_lanes(room);
      break;
    case WAITS_FOR_RATE:
      rate_in_lanes(room);
      break;
    case WAITS_FOR_RESOLUTION:
      resolution_in_lanes(room);
      break;
    default:
      residual_in_lanes(room);
  }
}

/* Place and size of the result that a row waits for. */
static real *wanted_by(row *own, int *count) {
  *count = N;
  switch (own->state) {
    case WAITS_FOR_FIRST_TANGENT:
      return own->now.point->tangent;
    case WAITS_FOR_PREDICTED_RESIDUAL:
      return own->now.next->residual;
    case WAITS_FOR_NEWTON_MATRIX:
    case WAITS_FOR_TANGENT_MATRIX:
      *count = N * N;
      return own->now.spare->factors.factors;
    case WAITS_FOR_RATE:
      return own->work->rate;
    default:
      *count = 1;
      return &own->resolution;
  }
}

/* Pivots of a Jacobian, and whether it was finite. */
static int take_pivots(const lanes_room *room, int lane, jacobian_factors *factors) {
  for (int i = 0; i < N; i++) factors->pivots[i] = room->pivots[i * LANES + lane];
  factors->regular = room->regular[lane];
  return room->finite[lane];
}

/* A row goes on with the result that it waited for. */
static void resume(row *own, const lanes_room *room, int lane) {
  switch (own->state) {
    case WAITS_FOR_FIRST_TANGENT:
      after_first_tangent(own);
      break;
    case WAITS_FOR_PREDICTED_RESIDUAL:
      after_prediction(own);
      break;
    case WAITS_FOR_NEWTON_MATRIX:
      after_newton_matrix(own, take_pivots(room, lane, &own->now.spare->factors));
      break;
    case WAITS_FOR_STEP:
      after_step(own, room, lane);
      break;
    case WAITS_FOR_RATE:
      after_rate(own);
      break;
    case WAITS_FOR_TANGENT_MATRIX:
      go_on_from_next_point(own, take_pivots(room, lane, &own->now.spare->factors));
      break;
    case WAITS_FOR_RESOLUTION:
      after_resolution(own);
      break;
    case WAITS_FOR_NOTHING:
      break;
  }
}

/* The result that most rows wait for; none without rows under way. */
static waiting most_awaited(const row *rows) {
  int counts[WAITS_FOR_RESOLUTION + 1] = {0};
  waiting most = WAITS_FOR_NOTHING;
  for (int k = 0; k < ROWS; k++) {
    const waiting state = rows[k].state;
    if (state == WAITS_FOR_NOTHING) continue;
    counts[state]++;
    if (counts[state] > counts[most]) most = state;
  }
  return most;
}

/* The inputs of rows, and the share of their loads that acts. */
static void gather_loads(row *const *rows, lanes_room *room) {
  const real *inputs[LANES];
  for (int lane = 0; lane < LANES; lane++) {
    inputs[lane] = rows[lane]->inputs;
    room->load_factor[lane] = rows[lane]->now.next->t;
  }
  gather_lanes(inputs, INPUTS, room->inputs);
}

/* Evaluates the equations for some rows; surplus lanes repeat the first row. */
static void evaluate_rows(row *const *rows, waiting state, lanes_room *room) {
  const real *x[LANES];
  for (int lane = 0; lane < LANES; lane++) x[lane] = unknowns_of(rows[lane]);
  gather_lanes(x, N, room->x);
  gather_loads(rows, room);
  evaluate_in_lanes(state, room);
}

/* Hands out results; surplus lanes write the result of the first row again. */
static void scatter_results(row *const *rows, const lanes_room *room) {
  real *wanted[LANES];
  int numbers = 0;
  for (int lane = 0; lane < LANES; lane++) wanted[lane] = wanted_by(rows[lane], &numbers);
  scatter_lanes(room->results, numbers, wanted);
}

/* Hands out steps, and the products behind them where steps are taken. */
static void scatter_steps(row *const *rows, const lanes_room *room) {
  real *steps[LANES];
  real *x[LANES];
  real *residuals[LANES];
  for (int lane = 0; lane < LANES; lane++) {
    row *own = rows[lane];
    const int moves = step_serves(own, room, lane);
    steps[lane] = place_of_step(own->now.spare);
    x[lane] = moves ? own->now.next->x : own->work->trial;
    residuals[lane] = moves ? own->now.next->residual : own->work->trial_residual;
  }
  scatter_lanes(room->steps, N, steps);
  scatter_lanes(room->x, N, x);
  scatter_lanes(room->results, N, residuals);
}

/* Takes quasi-Newton steps from the iterates of rows. */
static void take_steps(row *const *rows, lanes_room *room) {
  const real *factors[LANES];
  const real *steps[LANES];
  const real *x[LANES];
  updates_in_lanes updates;
  for (int lane = 0; lane < LANES; lane++) {
    updated_jacobian *jacobian = rows[lane]->now.spare;
    factors[lane] = jacobian->factors.factors;
    steps[lane] = place_of_step(jacobian);
    x[lane] = rows[lane]->now.next->x;
    updates.counts[lane] = jacobian->count;
    updates.steps[lane] = jacobian->steps[0];
    updates.squares[lane] = jacobian->squares;
  }
  gather_lanes(factors, N * N, room->factors);
  gather_lanes(steps, N, room->steps);
  gather_lanes(x, N, room->x);
  substitute_in_lanes(N, room->factors, room->steps);
  complete_steps_in_lanes(N, &updates, room->earlier_steps[0], room->steps);
  add_in_lanes(N, room->steps, room->x);
  squares_in_lanes(N, room->steps, room->squares);
  squares_in_lanes(N, room->x, room->norms_of_x);
  gather_loads(rows, room);
  residual_in_lanes(room);
  squares_in_lanes(N, room->results, room->norms);
  for (int lane = 0; lane < LANES; lane++) {
    room->norms_of_x[lane] = SQUARE_ROOT(room->norms_of_x[lane]);
    room->norms[lane] = SQUARE_ROOT(room->norms[lane]);
  }
  scatter_steps(rows, room);
}

/* Computes the result that some rows wait for, and hands it out. */
static void serve(row *rows, waiting state, lanes_room *room) {
  row *served[LANES];
  int count = 0;
  for (int k = 0; k < ROWS && count < LANES; k++) {
    if (rows[k].state == state) served[count++] = rows + k;
  }
  for (int lane = count; lane < LANES; lane++) served[lane] = served[0];
  if (state == WAITS_FOR_STEP) {
    take_steps(served, room);
  } else {
    evaluate_rows(served, state, room);
    scatter_results(served, room);
  }
  for (int lane = 0; lane < count; lane++) resume(served[lane], room, lane);
}

/* Rows first to last of a batch. */
static void solve_side_by_side(const batch_of_rows *batch, int first, int last, solver_batch_workspace *work) {
  row rows[ROWS];
  lanes_room *room = &work->room;
  int begun = first;
  for (int k = 0; k < ROWS; k++) {
    rows[k].state = WAITS_FOR_NOTHING;
    rows[k].work = work->of_rows + k;
  }
  for (int i = 0; i < (INPUTS + 1) * LANES; i++) room->inputs_rate[i] = 0;
  for (int lane = 0; lane < LANES; lane++) room->load_factor_rate[lane] = 1;
  for (;;) {
    for (int k = 0; k < ROWS; k++) {
      while (begun < last && rows[k].state == WAITS_FOR_NOTHING) begin_row(rows + k, batch, begun++);
    }
    const waiting state = most_awaited(rows);
    if (state == WAITS_FOR_NOTHING) break;
    serve(rows, state, room);
  }
}
