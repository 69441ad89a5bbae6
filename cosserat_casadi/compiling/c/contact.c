/* Equilibrium of rods in exact contact for new inputs, from the last solution: the inputs move on in parts, each of which
   ends in contacts that hold, near the shape before, and with no obstacle between the two. */

static const contact_options DEFAULT_OPTIONS = {
    .max_iterations = CONTACT_DEFAULT_ITERATIONS,
    .max_parts = CONTACT_DEFAULT_PARTS,
};

static const contact_options LONG_WAY = {
    .max_iterations = CONTACT_SOLVE_ITERATIONS,
    .max_parts = CONTACT_SOLVE_PARTS,
};

static contact_info no_result(void) {
  const contact_info none = {.status = CONTACT_NOT_FINITE,
                             .iterations = 0,
                             .jacobians = 0,
                             .residual_norm = 0,
                             .load_factor = 0,
                             .error_estimate = -1,
                             .arrangement = 0,
                             .tries = 0,
                             .parts = 0};
  return none;
}

/* Whether a solve ended with a solution of the discrete equations for its inputs. */
static int is_solved(contact_status status) { return status == CONTACT_CONVERGED || status == CONTACT_UNRESOLVED; }

static int is_known(const contact_state *state) {
  if (!state->is_known || state->arrangement < 0 || state->arrangement >= ARRANGEMENTS) return 0;
  return all_finite(state->z, ARRANGEMENT[state->arrangement].size) && all_finite(state->inputs, INPUTS);
}

/* Moves the inputs from those of solved[0] straight towards others, in parts. Leaves the last state in solved[0] and
   its share of the way in info. */
static void move_inputs(const real *from, const real *to, const contact_options *options, workspace *work,
                        contact_info *info) {
  real done = 0;
  real step = 1;
  real *inputs = work->path_inputs;
  real index[4] = {0, 1, 1, 1}; /* of resolution; the least margins of paths of tendons, of planes and of materials */
  {
    const arrangement *at = ARRANGEMENT + work->solved[0].arrangement;
    call(at->nodes, work->solved[0].z, from, work->nodes_before, index, work);
  }
  while (info->parts < options->max_parts && info->iterations < options->max_iterations) {
    const real end = done + step > 1 - MIN_STEP ? 1 : done + step;
    for (int i = 0; i < INPUTS; i++) inputs[i] = end == 1 ? to[i] : (1 - end) * from[i] + end * to[i];
    info->parts++;
    const int found = settle(inputs, options->max_iterations, index, work, info);
    const arrangement *before = ARRANGEMENT + work->solved[0].arrangement;
    if (found < 0 || !is_near(before, work->solved[0].z, ARRANGEMENT + work->solved[found].arrangement,
                              work->solved[found].z, work)) {
      if (found >= 0) info->status = CONTACT_LOST_TRACK;
      step /= 2;
      if (step < MIN_STEP) break;
      continue;
    }
    work->solved[0] = work->solved[found];
    memcpy(work->nodes_before, work->nodes, sizeof work->nodes);
    done = end;
    info->load_factor = done;
    if (done == 1) {
      /* With too few nodes or modes for a bend the solution of the equations is no solution of the rod. */
      info->status = index[0] <= 1 ? CONTACT_CONVERGED : CONTACT_UNRESOLVED;
      if (info->status == CONTACT_CONVERGED && index[1] <= VANISHED) info->status = CONTACT_PATH_VANISHED;
      if (info->status == CONTACT_CONVERGED && index[2] <= VANISHED) info->status = CONTACT_OUT_OF_PLANE;
      if (info->status == CONTACT_CONVERGED && index[3] <= VANISHED) info->status = CONTACT_BEYOND_MATERIAL;
      return;
    }
    step *= 2;
  }
  /* A state before the end of the way is no solution for the inputs. */
  if (info->status == CONTACT_CONVERGED) info->status = CONTACT_LOST_TRACK;
}

/* Solves from a known state, and changes the state only if the equations are solved for these inputs. */
static contact_status follow(const real *inputs, contact_state *state, const contact_options *options, workspace *work,
                             contact_info *info) {
  work->solved[0].arrangement = state->arrangement;
  memcpy(work->solved[0].z, state->z, sizeof state->z);
  info->load_factor = 0;
  move_inputs(state->inputs, inputs, options, work, info);
  if (!is_solved(info->status)) return info->status;
  state->is_known = 1;
  state->arrangement = work->solved[0].arrangement;
  memcpy(state->z, work->solved[0].z, sizeof state->z);
  for (int i = 0; i < INPUTS; i++) state->inputs[i] = inputs[i];
  return info->status;
}

void contact_start(contact_state *state) {
  memset(state, 0, sizeof *state);
  state->is_known = 1;
  state->arrangement = START_ARRANGEMENT;
  memcpy(state->z, START_Z, sizeof START_Z);
  memcpy(state->inputs, START_INPUTS, sizeof START_INPUTS);
}

/* Whether a state is a solution. */
static int is_in_equilibrium(const contact_state *state, workspace *work) {
  if (!is_known(state)) return 0;
  const arrangement *at = ARRANGEMENT + state->arrangement;
  const real norm = residual_at(at, state->z, state->inputs, work->residual, work);
  return norm <= 10 * TOLERANCE * (1 + norm_of(state->z, at->size));
}

#if CONTACT_ESTIMATES_ERRORS
#include "contact_error.c"
#endif

contact_status contact_solve(const real *inputs, contact_state *state, workspace *work, contact_info *info) {
  contact_info found = no_result();
  contact_status status = CONTACT_NOT_FINITE;
  if (all_finite(inputs, INPUTS)) {
    work->jacobian_of = -1;
    if (is_known(state)) status = follow(inputs, state, &LONG_WAY, work, &found);
    if (!is_solved(status)) {
      contact_state own;
      contact_start(&own);
      found = no_result();
      work->jacobian_of = -1;
      status = follow(inputs, &own, &LONG_WAY, work, &found);
      if (is_solved(status)) *state = own;
    }
  }
  found.status = status;
  found.arrangement = state->arrangement;
#if CONTACT_ESTIMATES_ERRORS
  if (info && status == CONTACT_CONVERGED) {
    found.error_estimate = estimated_error(state->arrangement, state->z, inputs, work);
  }
#endif
  if (info) *info = found;
  return status;
}

/* Writes the rates of a contact's places and of its forces at sections into an entry of d_contacts_d_inputs; a place at
   the tip stays there. */
static void contact_rates(const arrangement *at, const real *z_rate, int number, real *rates) {
  const contact_entry *entry = at->touch + number;
  const real *forces = z_rate + at->unknowns + entry->first_force;
  const real *places = z_rate + at->unknowns + at->forces + entry->first_place;
  const real unit = ROD[entry->rod].force_unit;
  const int is_line = entry->ends > 1;
  rates[0] = entry->moving > 0 ? places[0] : 0;
  rates[1] = !is_line ? rates[0] : entry->moving > 1 ? places[1] : 0;
  rates[2] = unit * forces[0];
  rates[3] = is_line ? unit * forces[1] : 0;
#ifdef RODS_TOUCH_RODS
  rates[4] = 0;
  if (other_rod(entry->obstacle) >= 0) {
    rates[0] = rates[1] = entry->held[0] < 0 ? places[0] : 0;
    rates[4] = entry->held[1] < 0 ? places[entry->moving - 1] : 0;
  }
#endif
}

/* Derivatives by the implicit function theorem, within the arrangement of contacts; either may be null. */
static contact_status derivatives(const real *inputs, const contact_state *state, real *d_poses_d_inputs,
                                  real *d_contacts_d_inputs, workspace *work) {
  const arrangement *at = ARRANGEMENT + state->arrangement;
  const int n = at->size;
  real *z_rate = work->step;
  real *inputs_rate = work->path_inputs;
  if (!linearise(at, state->z, inputs, work)) return CONTACT_SINGULAR;
  for (int j = 0; j < INPUTS; j++) inputs_rate[j] = 0;
  for (int j = 0; j < INPUTS; j++) {
    inputs_rate[j] = 1;
    for (int i = 0; i < n; i++) z_rate[i] = 0;
    call_rate(at->rate, state->z, inputs, z_rate, inputs_rate, work->residual, work);
    for (int i = 0; i < n; i++) z_rate[i] = -work->residual[i];
    solve_square(n, work->jacobian, work->pivots, z_rate);
    if (!all_finite(z_rate, n)) return CONTACT_SINGULAR;
    for (int k = 0; d_contacts_d_inputs && k < at->touches; k++) {
      contact_rates(at, z_rate, k, d_contacts_d_inputs + (k * INPUTS + j) * CONTACT_RATES);
    }
    if (d_poses_d_inputs) {
      call_rate(at->tip_rate, state->z, inputs, z_rate, inputs_rate, work->poses, work);
      if (!all_finite(work->poses, POSES * POSE_SIZE)) return CONTACT_SINGULAR;
    }
    inputs_rate[j] = 0;
    for (int r = 0; d_poses_d_inputs && r < POSES; r++) {
      memcpy(d_poses_d_inputs + (r * INPUTS + j) * POSE_SIZE, work->poses + r * POSE_SIZE, POSE_SIZE * sizeof *z_rate);
    }
  }
  return CONTACT_CONVERGED;
}

/* The Jacobian of the turn before serves only in its own arrangement. */
static void recall(const contact_memory *memory, workspace *work) {
  work->jacobian_of = -1;
  if (!memory || !memory->has_jacobian || memory->arrangement < 0 || memory->arrangement >= ARRANGEMENTS) return;
  work->jacobian_of = memory->arrangement;
  memcpy(work->jacobian, memory->jacobian, sizeof memory->jacobian);
  memcpy(work->pivots, memory->pivots, sizeof memory->pivots);
}

static void remember(contact_memory *memory, const workspace *work) {
  if (!memory) return;
  memory->has_jacobian = work->jacobian_of >= 0;
  memory->arrangement = work->jacobian_of;
  if (!memory->has_jacobian) return;
  memcpy(memory->jacobian, work->jacobian, sizeof memory->jacobian);
  memcpy(memory->pivots, work->pivots, sizeof memory->pivots);
}

contact_status contact_track(const real *inputs, contact_state *state, contact_memory *memory,
                             const contact_options *options, real *d_poses_d_inputs, workspace *work,
                             contact_info *info) {
  const contact_options chosen = options ? *options : DEFAULT_OPTIONS;
  contact_info found = no_result();
  contact_status status = CONTACT_NOT_FINITE;
  contact_state reached = *state;
  if (all_finite(inputs, INPUTS)) {
    recall(memory, work);
    status = is_known(state) ? follow(inputs, &reached, &chosen, work, &found) : CONTACT_NOT_IN_EQUILIBRIUM;
  }
  if (status == CONTACT_CONVERGED && d_poses_d_inputs) status = derivatives(inputs, &reached, d_poses_d_inputs, 0, work);
  if (status == CONTACT_CONVERGED) {
    *state = reached;
    remember(memory, work);
  }
  found.status = status;
  found.arrangement = state->arrangement;
  if (info) *info = found;
  return status;
}

contact_status contact_solve_sensitivity(const contact_state *state, real *d_poses_d_inputs, workspace *work) {
  if (!is_in_equilibrium(state, work)) return CONTACT_NOT_IN_EQUILIBRIUM;
  return derivatives(state->inputs, state, d_poses_d_inputs, 0, work);
}

contact_status contact_contact_sensitivity(const contact_state *state, real *d_contacts_d_inputs, workspace *work) {
  if (!is_in_equilibrium(state, work)) return CONTACT_NOT_IN_EQUILIBRIUM;
  return derivatives(state->inputs, state, 0, d_contacts_d_inputs, work);
}

contact_status contact_margins(const contact_state *state, real *force, real *gap, workspace *work) {
  if (!is_in_equilibrium(state, work)) return CONTACT_NOT_IN_EQUILIBRIUM;
  const arrangement *at = ARRANGEMENT + state->arrangement;
  const real largest = largest_force(at, state->z);
  real index[4];
  call(at->nodes, state->z, state->inputs, work->nodes, index, work);
  *force = *gap = HUGE_VAL;
#ifdef RODS_TOUCH_RODS
  sample_rods(at, state->z, work->nodes, work->samples[0]);
#endif
  for (int k = 0; k < at->touches; k++) *force = smaller(*force, least_force(at, state->z, k, largest, 1));
  for (int p = 0; p < PAIRS; p++) *gap = smaller(*gap, least_gap(at, state->z, PAIR + p, work));
  return CONTACT_CONVERGED;
}

int contact_contacts(const contact_state *state, contact_contact *contacts, workspace *work) {
  if (!is_known(state)) return 0;
  const arrangement *at = ARRANGEMENT + state->arrangement;
  call(at->contacts, state->z, state->inputs, work->contact_forces, work->point_forces, work);
  for (int k = 0; k < at->touches; k++) {
    const touch own = touch_at(at, state->z, k);
    contact_contact *named = contacts + k;
    named->rod = own.rod;
    named->obstacle = own.obstacle;
    named->is_line = own.is_line;
    /* A body has one section, without an abscissa. */
    named->from = own.rod < RODS ? own.start : 0;
    named->to = own.rod < RODS ? own.end : 0;
#ifdef RODS_TOUCH_RODS
    named->other_place = own.other;
#endif
    memcpy(named->force, work->contact_forces + 3 * k, sizeof named->force);
    memcpy(named->point_forces, work->point_forces + 2 * k, sizeof named->point_forces);
  }
  return at->touches;
}

void contact_poses(const contact_state *state, contact_pose *poses, workspace *work) {
  const arrangement *at = ARRANGEMENT + state->arrangement;
  call(at->tips, state->z, state->inputs, work->poses, 0, work);
  for (int r = 0; r < POSES; r++) {
    memcpy(poses[r].position, work->poses + POSE_SIZE * r, sizeof poses[r].position);
    memcpy(poses[r].quaternion, work->poses + POSE_SIZE * r + 3, sizeof poses[r].quaternion);
  }
}

#if CONTACT_ACTUATORS
void contact_actuators(const contact_state *state, real *efforts, real *conjugates, workspace *work) {
  call(ARRANGEMENT[state->arrangement].actuators, state->z, state->inputs, efforts, conjugates, work);
}
#endif
