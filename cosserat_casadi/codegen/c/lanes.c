/* Many rows of inputs at once, each solved from the unloaded scene as solver.c does it: rows wait for evaluations of the
   equations, and those that wait for the same are evaluated side by side. What a row does with what it has waited for
   are the functions of solver.c. A row that leaves the common way (inputs that are not finite, a path that breaks off) is
   solved by itself.

   Uses of the scene: the equations in lanes, which are declared below, and write_judgement, write_results. */

enum {
  ROWS = 4 * LANES, /* under way: enough of them wait for the same */
  WIDEST = N * N > RESULTS ? N * N : RESULTS,
  KERNEL_REALS = sizeof ((workspace *)0)->kernel_reals / sizeof(real),
  KERNEL_INTEGERS = sizeof ((workspace *)0)->kernel_integers / sizeof(int)
};

/* What a row waits for. */
typedef enum {
  WAITS_FOR_NOTHING,
  WAITS_FOR_FIRST_TANGENT,
  WAITS_FOR_PREDICTED_RESIDUAL,
  WAITS_FOR_TRIAL_RESIDUAL,
  WAITS_FOR_NEWTON_MATRIX,
  WAITS_FOR_RATE,
  WAITS_FOR_TANGENT_MATRIX,
  WAITS_FOR_RESOLUTION,
  WAITS_FOR_RESULTS
} waiting;

typedef struct {
  waiting state;
  const real *inputs;
  real *results;
  load_path path;
  progress now;
  real step; /* of the load */
  int steps;
  newton_limits limits;
  newton_state newton;
  solver_info info;
  workspace work;
} row;

/* Arrays of lanes. */
typedef struct {
  real x[N * LANES];
  real inputs[(INPUTS + 1) * LANES];
  real load_factor[LANES];
  real inputs_rate[(INPUTS + 1) * LANES];
  real load_factor_rate[LANES];
  real results[WIDEST * LANES];
  int pivots[N * LANES];
  int regular[LANES];
  int finite[LANES];
  real reals[KERNEL_REALS * LANES];
  int integers[KERNEL_INTEGERS];
} lanes_room;

typedef struct {
  row rows[ROWS];
  lanes_room room;
} side_by_side;

/* The equations in the lanes of a room: results for x, inputs and load_factor. */
static void residual_in_lanes(lanes_room *room);
static void factors_in_lanes(lanes_room *room);
static void rate_in_lanes(lanes_room *room);
static void tangent_in_lanes(lanes_room *room);
static void resolution_in_lanes(lanes_room *room);
static void results_in_lanes(lanes_room *room);

/* ---- One row ---- */

static void solve_by_itself(row *own) {
  real x[N];
  memset(x, 0, sizeof x);
  solver_solve(own->inputs, x, &own->work, &own->info);
  write_results(x, own->inputs, &own->info, own->results);
  own->state = WAITS_FOR_NOTHING;
}

static void begin_row(row *own, const real *inputs, real *results) {
  own->inputs = inputs;
  own->results = results;
  own->info = no_result();
  if (!all_finite(inputs, INPUTS)) {
    solve_by_itself(own);
    return;
  }
  memset(own->work.points, 0, sizeof own->work.points[0]);
  own->path.grows_load = 1;
  own->path.from = inputs;
  own->path.to = inputs;
  own->now = begin_path(0, &own->work);
  own->step = FIRST_STEP;
  own->steps = 0;
  own->state = WAITS_FOR_FIRST_TANGENT;
}

static void take_step(row *own) {
  if (own->steps < LONG_PATH.max_steps && own->info.iterations < LONG_PATH.max_iterations) {
    own->steps++;
    own->step = admissible_step(&own->now, own->step);
    if (own->step != 0) {
      predict_next(&own->now, own->step, &own->work);
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
  if (!is_trusted(result, &own->now, &own->work)) {
    own->step /= 2;
    take_step(own);
  } else if (own->now.next->t < 1) {
    if (result->jacobians <= GROW_BELOW) own->step *= 2;
    own->state = WAITS_FOR_RATE;
  } else {
    accept_next(&own->now);
    own->info.status = SOLVER_CONVERGED;
    own->info.residual_norm = result->residual_norm;
    own->info.load_factor = 1;
    own->state = WAITS_FOR_RESOLUTION;
  }
}

static void continue_newton(row *own);

static void weigh_newton_step(row *own, real length, real norm) {
  if (weigh_step(&own->newton, &own->limits, own->work.step, length, norm, own->now.spare)) {
    continue_newton(own);
  } else {
    end_correction(own);
  }
}

static void take_newton_step(row *own) {
  workspace *work = &own->work;
  const path_point *next = own->now.next;
  own->newton.result.iterations++;
  if (!newton_step(own->now.spare, next->residual, work->step, work)) {
    weigh_newton_step(own, 0, own->newton.norm);
    return;
  }
  for (int i = 0; i < N; i++) work->trial[i] = next->x[i] + work->step[i];
  own->state = WAITS_FOR_TRIAL_RESIDUAL;
}

static void continue_newton(row *own) {
  if (newton_ends(&own->newton, &own->limits, own->now.next->x)) {
    end_correction(own);
  } else if (own->newton.reuse_jacobian) {
    take_newton_step(own);
  } else {
    expect_jacobian(&own->newton, own->now.spare);
    own->state = WAITS_FOR_NEWTON_MATRIX;
  }
}

static void after_first_tangent(row *own) {
  if (isfinite(norm_of(own->now.point->tangent))) {
    take_step(own);
  } else {
    solve_by_itself(own);
  }
}

static void after_prediction(row *own) {
  if (!is_promising(&own->now, &own->work)) {
    own->info.iterations++;
    own->step /= 2;
    take_step(own);
    return;
  }
  own->limits = corrector_limits(own->now.next, LONG_PATH.max_iterations - own->info.iterations);
  own->newton = begin_newton(&own->limits, own->now.next->residual);
  continue_newton(own);
}

static void after_trial(row *own) {
  path_point *next = own->now.next;
  const real norm = norm_of(own->work.trial_residual);
  if (!serves(1, norm, own->newton.norm)) {
    weigh_newton_step(own, 0, own->newton.norm);
    return;
  }
  memcpy(next->x, own->work.trial, sizeof next->x);
  memcpy(next->residual, own->work.trial_residual, sizeof next->residual);
  weigh_newton_step(own, 1, norm);
}

static void after_newton_matrix(row *own, int finite) {
  if (finite) {
    take_newton_step(own);
    return;
  }
  own->newton.result.status = SOLVER_NOT_FINITE;
  end_correction(own);
}

static void go_on_from_next_point(row *own, int sound) {
  set_tangent(own->now.next, sound, own->now.spare, &own->work);
  accept_next(&own->now);
  take_step(own);
}

static void after_rate(row *own) {
  const int sound = all_finite(own->work.rate, N);
  if (!sound || own->newton.result.jacobians > 0) {
    go_on_from_next_point(own, sound);
    return;
  }
  own->now.spare->count = 0;
  own->info.jacobians++;
  own->state = WAITS_FOR_TANGENT_MATRIX;
}

static void after_resolution(row *own, real index) {
  if (index <= 1) {
    own->state = WAITS_FOR_RESULTS;
    return;
  }
  own->info.status = SOLVER_UNRESOLVED;
  write_results(own->now.point->x, own->inputs, &own->info, own->results);
  own->state = WAITS_FOR_NOTHING;
}

/* ---- Rows together ---- */

/* The unknowns at which a row waits to be evaluated. */
static const real *unknowns_of(const row *own) {
  if (own->state == WAITS_FOR_TRIAL_RESIDUAL) return own->work.trial;
  if (own->state == WAITS_FOR_RESOLUTION || own->state == WAITS_FOR_RESULTS) return own->now.point->x;
  return own->now.next->x;
}

static void into_lane(const real *entries, int count, int lane, real *in_lanes) {
  for (int i = 0; i < count; i++) in_lanes[i * LANES + lane] = entries[i];
}

static void out_of_lane(const real *in_lanes, int count, int lane, real *entries) {
  for (int i = 0; i < count; i++) entries[i] = in_lanes[i * LANES + lane];
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
    case WAITS_FOR_RESULTS:
      results_in_lanes(room);
      break;
    default:
      residual_in_lanes(room);
  }
}

static int take_factors(const lanes_room *room, int lane, jacobian_factors *factors) {
  out_of_lane(room->results, N * N, lane, factors->factors);
  for (int i = 0; i < N; i++) factors->pivots[i] = room->pivots[i * LANES + lane];
  factors->regular = room->regular[lane];
  return room->finite[lane];
}

/* A row goes on with what has been evaluated in its lane. */
static void resume(row *own, const lanes_room *room, int lane) {
  const real *results = room->results;
  switch (own->state) {
    case WAITS_FOR_FIRST_TANGENT:
      out_of_lane(results, N, lane, own->now.point->tangent);
      after_first_tangent(own);
      break;
    case WAITS_FOR_PREDICTED_RESIDUAL:
      out_of_lane(results, N, lane, own->now.next->residual);
      after_prediction(own);
      break;
    case WAITS_FOR_TRIAL_RESIDUAL:
      out_of_lane(results, N, lane, own->work.trial_residual);
      after_trial(own);
      break;
    case WAITS_FOR_NEWTON_MATRIX:
      after_newton_matrix(own, take_factors(room, lane, &own->now.spare->factors));
      break;
    case WAITS_FOR_RATE:
      out_of_lane(results, N, lane, own->work.rate);
      after_rate(own);
      break;
    case WAITS_FOR_TANGENT_MATRIX:
      go_on_from_next_point(own, take_factors(room, lane, &own->now.spare->factors));
      break;
    case WAITS_FOR_RESOLUTION:
      after_resolution(own, results[lane]);
      break;
    case WAITS_FOR_RESULTS:
      write_judgement(&own->info, own->results);
      out_of_lane(results + JUDGED * LANES, RESULTS - JUDGED, lane, own->results + JUDGED);
      own->state = WAITS_FOR_NOTHING;
      break;
    case WAITS_FOR_NOTHING:
      break;
  }
}

/* What most rows wait for; nothing where none is under way. */
static waiting most_awaited(const row *rows) {
  int counts[WAITS_FOR_RESULTS + 1] = {0};
  waiting most = WAITS_FOR_NOTHING;
  for (int k = 0; k < ROWS; k++) {
    const waiting state = rows[k].state;
    if (state == WAITS_FOR_NOTHING) continue;
    counts[state]++;
    if (counts[state] > counts[most]) most = state;
  }
  return most;
}

/* Evaluates rows that wait for the same; lanes that are left over repeat the first. */
static void serve(side_by_side *all, waiting state) {
  row *served[LANES];
  lanes_room *room = &all->room;
  int count = 0;
  for (int k = 0; k < ROWS && count < LANES; k++) {
    if (all->rows[k].state == state) served[count++] = all->rows + k;
  }
  for (int lane = 0; lane < LANES; lane++) {
    const row *own = served[lane < count ? lane : 0];
    into_lane(unknowns_of(own), N, lane, room->x);
    into_lane(own->inputs, INPUTS, lane, room->inputs);
    room->load_factor[lane] = own->now.next->t;
  }
  evaluate_in_lanes(state, room);
  for (int lane = 0; lane < count; lane++) resume(served[lane], room, lane);
}

static void solve_side_by_side(int count, const real *inputs, real *results, side_by_side *all) {
  int begun = 0;
  for (int k = 0; k < ROWS; k++) all->rows[k].state = WAITS_FOR_NOTHING;
  for (int i = 0; i < (INPUTS + 1) * LANES; i++) all->room.inputs_rate[i] = 0;
  for (int lane = 0; lane < LANES; lane++) all->room.load_factor_rate[lane] = 1;
  for (;;) {
    for (int k = 0; k < ROWS; k++) {
      while (begun < count && all->rows[k].state == WAITS_FOR_NOTHING) {
        begin_row(all->rows + k, inputs + (size_t)begun * INPUTS, results + (size_t)begun * RESULTS);
        begun++;
      }
    }
    const waiting state = most_awaited(all->rows);
    if (state == WAITS_FOR_NOTHING) return;
    serve(all, state);
  }
}
