/* The way back of a control loop that has lost its track: from the last solution towards the inputs, over several turns,
   each within a budget. */

/* Newton steps that turn a point of the path into an exact solution. */
enum { SETTLING = SOLVER_SETTLING_ITERATIONS };

/* Makes the last point of a path the last solution. Returns zero, without changes, if Newton leaves the point. */
static int settle(const load_path *path, const progress *end, real *x, solver_memory *memory, workspace *work,
                  solver_info *info) {
  const newton_limits limits = {
      .max_iterations = SETTLING,
      .max_jacobians = SETTLING,
      .max_halvings = 0,
      .inexact = 0,
      .reuse_jacobian = 0,
  };
  real *settled = work->reached;
  const loads at = loads_at(path, end->point->t, work);
  memcpy(settled, end->point->x, sizeof work->reached);
  const newton_result result = newton(&at, &limits, settled, end->point->residual, end->spare, work);
  count_work(info, &result);
  if (result.status != SOLVER_CONVERGED || shape_distance(settled, end->point->x) > SAME_BRANCH) return 0;
  if (is_beyond(end->point->x, at.inputs, settled, at.inputs, work)) return 0;
  memcpy(x, settled, sizeof work->reached);
  for (int i = 0; i < INPUTS; i++) memory->inputs[i] = at.inputs[i];
  memory->has_jacobian = 0;
  return 1;
}

/* First step of the next turn, as a share of the remaining way. */
static real next_step(const progress *end) {
  const real left = 1 - end->point->t;
  return left > end->step ? end->step / left : 1;
}

solver_status solver_recover(const real *inputs, real *x, solver_memory *memory, const solver_options *options,
                             solver_workspace *work, solver_info *info) {
  const solver_options chosen = options ? *options : DEFAULT_OPTIONS;
  solver_info found = no_result();
  if (!all_finite(inputs, INPUTS) || !all_finite(x, N)) return refuse(SOLVER_NOT_FINITE, inputs, x, work, &found, info);
  if (!memory->has_inputs) return refuse(SOLVER_NOT_IN_EQUILIBRIUM, inputs, x, work, &found, info);
  const load_path path = {.grows_load = 0, .is_paced = 0, .from = memory->inputs, .to = inputs};
  const path_limits limits = {
      .max_steps = chosen.max_continuation_steps,
      .max_iterations = chosen.max_iterations,
      .first_step = memory->step,
  };
  const newton_limits start_limits = {
      .max_iterations = chosen.max_iterations,
      .max_jacobians = chosen.max_iterations,
      .max_halvings = 0,
      .inexact = 0,
      .reuse_jacobian = 0,
  };
  const newton_result start = start_path(&path, &start_limits, x, work);
  count_work(&found, &start);
  if (start.status != SOLVER_CONVERGED) return refuse(SOLVER_NOT_IN_EQUILIBRIUM, inputs, x, work, &found, info);
  const progress end = follow_path(&path, &limits, 1, work, &found);
  const int moved = end.point->t > 0 && settle(&path, &end, x, memory, work, &found);
  const int stalled = end.step == 0 || (end.point->t > 0 && !moved);
  if (!moved) found.load_factor = 0;
  memory->step = stalled ? 0 : next_step(&end);
  found.status = stalled ? SOLVER_LOAD_STALLED : SOLVER_LOST_TRACK;
  if (found.load_factor == 1) found.status = SOLVER_CONVERGED;
  return finish(x, inputs, 0, &found, info, work);
}
