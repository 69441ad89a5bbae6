/* A turn of a control loop: Newton from the equilibrium of the last turn, within a budget of iterations. */

static const solver_options DEFAULT_OPTIONS = {
    .max_iterations = SOLVER_DEFAULT_ITERATIONS,
    .max_continuation_steps = SOLVER_DEFAULT_CONTINUATION_STEPS,
};

/* Iterations of a turn beyond which a new Jacobian, which takes about as long as three, pays. */
enum { RENEW_ABOVE = 3 };

/* Continues from the solution for the inputs of the last turn along the straight line to the new inputs. Returns zero
   and restores x if the budget of the turn ends before. */
static int follow_last_turn(const solver_memory *memory, const solver_options *options, const real *inputs, real *x,
                            workspace *work, solver_info *info) {
  const load_path path = {.grows_load = 0, .is_paced = 0, .from = memory->inputs, .to = inputs};
  const path_limits limits = {
      .max_steps = options->max_continuation_steps,
      .max_iterations = options->max_iterations,
      .first_step = 0,
  };
  const newton_limits start_limits = {
      .max_iterations = options->max_iterations - info->iterations,
      .max_jacobians = options->max_iterations,
      .max_halvings = 0,
      .inexact = 0,
      .reuse_jacobian = 0,
  };
  if (!memory->has_inputs || options->max_continuation_steps < 1) return 0;
  const newton_result start = start_path(&path, &start_limits, x, work);
  count_work(info, &start);
  if (start.status != SOLVER_CONVERGED) return 0;
  const progress end = follow_path(&path, &limits, 1, work, info);
  if (end.point->t < 1) return 0;
  memcpy(x, end.point->x, N * sizeof *x);
  return 1;
}

/* Moves x from the inputs of the last turn to the solution for new ones; restores x if the budget ends before. */
static solver_status reach(const solver_memory *memory, const solver_options *options, const real *inputs, real *x,
                           workspace *work, solver_info *found) {
  /* The continuation keeps half of the budget. */
  const newton_limits limits = {
      .max_iterations = (options->max_iterations + 1) / 2,
      .max_jacobians = options->max_iterations,
      .max_halvings = 0,
      .inexact = 0,
      .reuse_jacobian = memory->has_jacobian,
  };
  work->updated_jacobians[0].factors = memory->jacobian;
  work->updated_jacobians[0].count = 0;
  const real *before = memory->has_inputs ? memory->inputs : inputs;
  if (!correct(&limits, before, inputs, x, work, found) && !follow_last_turn(memory, options, inputs, x, work, found)) {
    return SOLVER_LOST_TRACK;
  }
  return finish(x, inputs, 0, found, 0, work);
}

/* Ends a turn without a solution, and reports x at these inputs. */
static solver_status refuse(solver_status end, const real *inputs, const real *x, workspace *work, solver_info *found,
                            solver_info *info) {
  found->status = end;
  found->load_factor = 0;
  found->residual_norm = residual_left(x, inputs, work);
  if (info) *info = *found;
  return end;
}

SOLVER_DEVICE solver_status solver_track(const real *inputs, real *x, solver_memory *memory, const solver_options *options,
                           real *d_x_d_inputs, real *d_poses_d_inputs, solver_workspace *work, solver_info *info) {
  const solver_options chosen = options ? *options : DEFAULT_OPTIONS;
  real *reached = work->reached;
  solver_info found = no_result();
  if (!all_finite(inputs, INPUTS) || !all_finite(x, N)) return refuse(SOLVER_NOT_FINITE, inputs, x, work, &found, info);
  memcpy(reached, x, sizeof work->reached);
  solver_status end = reach(memory, &chosen, inputs, reached, work, &found);
  /* Without derivatives the Jacobian of an earlier turn serves on, as long as Newton takes few steps with it. */
  const int has_served = memory->has_jacobian && found.jacobians == 0 && found.iterations <= RENEW_ABOVE;
  const int serves_on = has_served && !d_x_d_inputs && !d_poses_d_inputs;
  if (end == SOLVER_CONVERGED && !serves_on) end = derivatives(inputs, reached, d_x_d_inputs, d_poses_d_inputs, work);
  if (end != SOLVER_CONVERGED) return refuse(end, inputs, x, work, &found, info);
  memcpy(x, reached, sizeof work->reached);
  for (int i = 0; i < INPUTS; i++) memory->inputs[i] = inputs[i];
  memory->has_inputs = 1;
  if (!serves_on) memory->jacobian = work->updated_jacobians[0].factors;
  memory->has_jacobian = 1;
  if (info) *info = found;
  return end;
}
