/* Exact contact in the steps of a motion. While a section presses, its gap is zero at both stages, and a force along its
   gradient, an unknown of each, keeps it so: equations of index 3 as those of joints. Which of the sections that touch at
   the start press is the complementarity problem of the gaps at the end, 0 <= force, 0 <= gap, one of both zero. Where
   another gap comes to zero the step is cut: impulses take the speed of approach, and give back the share of it that is the
   restitution of the obstacle (F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, Wiley 1996).

   The gap of a section that slides is the least about it, so that its gradient is that of the gap at its place (E. Polak,
   Optimization, Springer 1997, section 3.1). Simulated motions, cosserat_casadi/motion/exact_contact.py, have the
   same gaps and pushes; their steps are cut at all changes of contact. */

/* Depth up to which a section without a force may come at the end of a step. */
static const real GAP_OPEN = (real)1e-9;

#ifdef CONTACT_RUBS
/* Acceleration, lengths/s^2, that counts as none, and depth that is rounding. */
static const real FALLING = (real)1e-2;
static const real GAP_ROUNDED = (real)1e-14;
#endif

#ifndef FARTHEST
/* Way along the rod, in a stretch, from which on a section that presses may have come to another valley of its gap. */
static const real FARTHEST = (real)0.05;
#endif

/* Speed of opening, over that of approach or in lengths a step, that counts as none. */
static const real STILL = (real)1e-9;

enum {
  CUTS = 32,          /* stretches between blows of one part of a step */
  SETS = 8,           /* sets of pressing sections that are tried for a stretch */
  LOOKS_IN_TIME = 2,  /* looks for blows in a stretch, at least */
  MOST_IN_TIME = 64,
  LOCATIONS = 60      /* looks at which the time of a blow is found */
};

typedef solver_touch touch;

/* The same depth for a stretch of a size, s, the gaps of which Newton's method is to know more exactly. With friction it is
   little beside what an acceleration makes of so short a stretch: what is let go for one would strike in the next. */
static real gap_open(real size) {
#ifdef CONTACT_RUBS
  const real fallen = size * size * FALLING;
  return fallen < GAP_OPEN ? fallen > GAP_ROUNDED ? fallen : GAP_ROUNDED : GAP_OPEN;
#else
  (void)size;
  return GAP_OPEN;
#endif
}

#include "square_systems.c"
#include "least_pushes.c"

/* ---- What touches ---- */

static void add_touch(int number, int slides, real place, workspace *work) {
  if (work->touch_count == TOUCHES) {
    work->too_many = 1;
    return;
  }
  touch *added = work->touches + work->touch_count++;
  memset(added, 0, sizeof *added);
  added->facing = number;
  added->slides = slides;
  added->place = added->end_place = added->places[0] = added->places[1] = place;
}

/* Adds the sections of a rod that lies at which it touches; returns their number where nothing is to be added. */
static int add_laid(int number, int add, workspace *work) {
  const facing *own = FACING + number;
  int count = 0;
  for (int k = 0; k < own->laid_count; k++) {
    section_gap gap;
    look_at(own, own->laid[k], &gap, work);
    if (gap.value > TOUCHING) continue;
    count++;
    if (add) add_touch(number, 0, own->laid[k], work);
  }
  return count;
}

/* Whether a rod lay at the end of the stretch before. */
static int lay_before(int number, const workspace *work) {
  for (int k = 0; k < work->known_count; k++) {
    if (work->known[k].facing == number && !work->known[k].slides && !FACING[number].is_body) return 1;
  }
  return 0;
}

/* Finds what touches. A rod lies where its gap is flat at a section that touches, or where it lay and touches at two of the
   sections that it is held at then. Zero where there is no room for so many. */
static int find_touching(const real *x, const real *inputs, workspace *work) {
  work->touch_count = 0;
  work->too_many = 0;
  for (int number = 0; number < FACINGS; number++) {
    const facing *own = FACING + number;
    positions_of(own, x, inputs, work->nodes, work);
    const int first = work->touch_count, had_too_many = work->too_many;
    int lies = 0, look = 0;
    real before = -1; /* place of the valley before: they come base to tip */
    section_gap lowest;
    look_along(own, work->nodes, work);
    while ((look = next_valley(own, look, TOUCHING, 0, &lowest, work)) > 0) {
      lies |= !own->is_body && lowest.bend <= FLATTEST && ABSOLUTE(lowest.slope) <= SMOOTH;
      /* Less than what counts as one along a stretch: what touches at its start is never overlooked in it. */
      if (lowest.place - before > SAME_PLACE / 2) add_touch(number, !own->is_body, lowest.place, work);
      before = lowest.place;
    }
    const int may_lie = lies || (before >= 0 && lay_before(number, work));
    const int laid = may_lie ? add_laid(number, 0, work) : 0;
    if (laid > 1 || (lies && laid > 0)) {
      work->touch_count = first;
      work->too_many = had_too_many;
      add_laid(number, 1, work);
    } else if (lies) {
      /* Where it touches between these sections alone, it is held there. */
      for (int k = first; k < work->touch_count; k++) work->touches[k].slides = 0;
    }
  }
  return !work->too_many;
}

/* Looks at a section that touches, of one that slides next to a place. */
static void follow_touch(const touch *own, real near, const real *x, const real *inputs, section_gap *gap,
                         workspace *work) {
  const facing *faces = FACING + own->facing;
  positions_of(faces, x, inputs, work->nodes, work);
  fit_nodes(faces, work->nodes, work);
  if (own->slides) {
    look_lowest(faces, near, gap, work);
  } else {
    look_at(faces, own->place, gap, work);
  }
  weigh_nodes(faces, gap);
}

/* Gap and gradient of a section that touches. */
static void gradient_at(const touch *own, real near, const real *x, const real *inputs, section_gap *gap, real *gradient,
                        workspace *work) {
  const facing *faces = FACING + own->facing;
  const int count = 3 * point_count(faces);
  follow_touch(own, near, x, inputs, gap, work);
  memset(work->weights, 0, (size_t)count * sizeof *work->weights);
  add_weights(faces, gap, 1, work->weights);
  gradient_of(faces, x, inputs, work->weights, gradient, work);
}

/* Rate of a gap, of velocities and of inputs in motion, 1/s. */
static real rate_of(const touch *own, const instant *at, const section_gap *gap, workspace *work) {
  const facing *faces = FACING + own->facing;
  real rate = 0;
  velocities_of(faces, at->state, at->inputs, at->state + N, at->inputs + INPUTS, work->nodes, work);
  for (int i = 0; i < gap->nodes; i++) rate += gap->rows[0][i] * inner(gap->normal, work->nodes + 3 * (gap->first + i));
#ifdef RODS_FACE_RODS
  for (int i = 0; faces->other && i < gap->other.nodes; i++) {
    rate -= gap->other.rows[0][i] * inner(gap->normal, work->nodes + 3 * (gap->other.first + i));
  }
#endif
  return rate / faces->length;
}

#ifdef CONTACT_RUBS
#include "contact_friction.c"
#endif

/* ---- Blows ---- */

static void mark_constraints(const real *matrices, int *is_constraint);

/* The masses at an instant, factorised, with constraints differentiated twice. Zero where masses do not say what they do. */
static int factorise_masses(const instant *at, const stage_factors *factors, workspace *work) {
  const real *stiffness = work->matrices[0];
  const real *mass = stiffness + 2 * STAGE_ENTRIES;
  matrices_at(at, work->matrices[0], work);
  if (!all_finite(work->matrices[0], MATRICES * STAGE_ENTRIES)) return 0;
  mark_constraints(work->matrices[0], work->is_constraint);
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    const int constraint = work->is_constraint[ENTRY_ROWS[k]];
    const int of_shape = IS_SHAPE[ENTRY_COLUMNS[k]];
    work->stage_values[k] = of_shape && !constraint ? mass[k] : of_shape || !constraint ? stiffness[k] : 0;
  }
  return factorise_system(matrix_of_masses(), work->stage_values, factors);
}

/* What a unit impulse of a pair along a row does to velocities, all joints closed. */
static void respond_to(const facing *own, const real *row, const stage_factors *factors, real *response, workspace *work) {
  for (int i = 0; i < N; i++) work->stage_solution[i] = work->is_constraint[i] ? 0 : share_of(own, i) * row[i];
  solve_system(matrix_of_masses(), 1, factors, work->stage_solution, work);
  for (int i = 0; i < N; i++) response[i] = IS_SHAPE[i] ? work->stage_solution[i] : 0;
}

/* The same of all gaps, and by how much gaps open then. Of rods with other units of energy one answers more than the
   other. */
static void respond(const stage_factors *factors, workspace *work) {
  const int count = work->touch_count;
  for (int j = 0; j < count; j++) {
    respond_to(FACING + work->touches[j].facing, work->gradients[j], factors, work->responses[j], work);
    for (int k = 0; k < count; k++) work->compliance[j * count + k] = dot(work->gradients[k], work->responses[j]);
  }
}

/* Gradients of the gaps of all that touches, at an instant. */
static int gradients_at(const real *x, const real *inputs, workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    touch *own = work->touches + k;
    section_gap gap;
    gradient_at(own, own->place, x, inputs, &gap, work->gradients[k], work);
    own->place = gap.place;
    own->gap = gap.value;
#ifdef RODS_FACE_RODS
    own->other_place = place_on_other(FACING + own->facing, &gap);
#endif
#ifdef CONTACT_RUBS
    note_slide(k, &gap, x, inputs, work);
#endif
    if (!all_finite(work->gradients[k], N) || !isfinite(gap.value)) return 0;
  }
  return 1;
}

/* Rate that a blow is to take from a gap, with what it gives back. */
static real wanted_of(int k, real still, const workspace *work) {
  const real restitution = work->touches[k].presses ? 0 : FACING[work->touches[k].facing].restitution;
  return work->rates[k] - (work->rates[k] < -still ? -restitution * work->rates[k] : 0);
}

/* Takes speeds of approach from what touches, at an instant, in place: by the smallest changes in the metric of the mass. Of
   what pressed before, as known says, the rate is no approach but the inexactness of a step: it is taken from both sides.
   Zero where that is not settled. */
static int strike(instant *at, real size, workspace *work) {
  const stage_factors factors = {work->stage_rows, work->stage_columns, work->stage_matrix, work->stage_pivots,
                                 &work->stages_as_a_whole};
  const int count = work->touch_count;
  const real *x = at->state;
  real *v = at->state + N;
  real *rates = work->rates;
  if (!gradients_at(x, at->inputs, work) || !factorise_masses(at, &factors, work)) return 0;
  respond(&factors, work);
  /* Rates of what pressed, first: nothing of it is a blow. */
  int known = 0;
  real fastest = 1 / size;
  for (int k = 0; k < count; k++) {
    section_gap gap;
    follow_touch(work->touches + k, work->touches[k].place, x, at->inputs, &gap, work);
    rates[k] = rate_of(work->touches + k, at, &gap, work);
    if (!isfinite(rates[k])) return 0;
    fastest = larger(fastest, ABSOLUTE(rates[k]));
    if (work->touches[k].presses) work->active[known++] = k;
  }
  for (int i = 0; i < known; i++) work->pushes[i] = -rates[work->active[i]];
  if (known > 0 && solve_active(work->compliance, count, work->active, known, work->pushes, work)) {
    for (int m = 0; m < known; m++) {
      const int own = work->active[m];
      for (int i = 0; i < N; i++) v[i] += work->pushes[m] * work->responses[own][i];
      for (int k = 0; k < count; k++) rates[k] += work->pushes[m] * work->compliance[own * count + k];
    }
  }
  /* Newton's law of impact: what closes leaves with a share of its speed. */
  const real still = STILL * fastest;
#ifdef CONTACT_RUBS
  return strike_with_friction(at, still, &factors, work);
#else
  for (int k = 0; k < count; k++) work->wanted[k] = wanted_of(k, still, work);
  if (!least_pushes(work->compliance, work->wanted, count, still, work->pushes, work)) return 0;
  for (int k = 0; k < count; k++) {
    for (int i = 0; i < N; i++) v[i] += work->pushes[k] * work->responses[k][i];
  }
  return all_finite(at->state, 2 * N);
#endif
}

/* ---- Forces in the stages ---- */

/* Takes the forces of what presses from the equations of a stage, and notes the gaps. */
static void push_in_stage(int stage, const instant *at, real *residual, workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    touch *own = work->touches + k;
    section_gap gap;
    if (!own->presses) continue;
    gradient_at(own, own->places[stage], at->state, at->inputs, &gap, work->stage_gradients[stage][k], work);
    if (gap.bend > FLATTEST) own->places[stage] = gap.place;
    work->stage_gaps[stage][k] = gap.value - own->height;
    for (int i = 0; i < N; i++) {
      residual[i] -= own->forces[stage] * share_of(FACING + own->facing, i) * work->stage_gradients[stage][k][i];
    }
#ifdef CONTACT_RUBS
    rub_in_stage(stage, k, &gap, at, residual, work);
#endif
  }
}

/* Derivatives of a section by unknowns, MOVED numbers for each: of its position, and of the slope of the gap, over lengths. */
static void move_section(const touch *own, const section_gap *gap, real *moved, workspace *work) {
  const facing *faces = FACING + own->facing;
  real *one = work->moved_row;
  for (int row = 0; row < MOVED; row++) {
    memset(work->weights, 0, (size_t)(3 * point_count(faces)) * sizeof *work->weights);
    row_weights(faces, gap, row, work->weights);
    gradient_of(faces, work->at.state, work->at.inputs, work->weights, one, work);
    for (int i = 0; i < N; i++) moved[MOVED * i + row] = one[i];
  }
  turn_slopes(faces, gap, N, moved);
}

/* Takes the change of a force's direction, as normals turn and sections slide, from the stiffness at the instant in the
   workspace. */
static void curve_matrices(const touch *own, const section_gap *gap, real force, real *stiffness, workspace *work) {
  const facing *faces = FACING + own->facing;
  move_section(own, gap, work->moved, work);
  memset(work->weights, 0, (size_t)(3 * point_count(faces)) * sizeof *work->weights);
  add_weights(faces, gap, 1, work->weights);
  hessian_of(faces, work->at.state, work->at.inputs, work->weights, work->second, work);
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    const int i = ENTRY_ROWS[k];
    const int j = ENTRY_COLUMNS[k];
    const real turned = turning(faces, gap, own->slides, work->moved + MOVED * i, work->moved + MOVED * j);
    stiffness[k] -= force * share_of(faces, i) * (work->second[j * N + i] + turned);
  }
}

/* The same of all that presses, at the middle of a step, by the mean forces. */
static void curve_middle(workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    const touch *own = work->touches + k;
    section_gap gap;
    if (!own->presses || own->forces[0] + own->forces[1] == 0) continue;
    follow_touch(own, own->place, work->at.state, work->at.inputs, &gap, work);
    curve_matrices(own, &gap, (own->forces[0] + own->forces[1]) / 2, work->matrices[0], work);
  }
}

/* First iterate of the forces. */
static void guess_forces(workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    touch *own = work->touches + k;
    for (int stage = 0; stage < STAGES; stage++) {
      own->forces[stage] = own->force;
      own->places[stage] = own->place;
#ifdef CONTACT_RUBS
      memcpy(own->drags[stage], own->drag, sizeof own->drag);
#endif
    }
  }
}

/* A unit force of a section that touches along a row, real part first, for a complex matrix. */
static void force_along(int k, const real *row, real *force, const workspace *work) {
  for (int i = 0; i < N; i++) force[i] = share_of(FACING + work->touches[k].facing, i) * row[i];
  memset(force + N, 0, N * sizeof *force);
}

/* What unit forces do to positions by the factorised matrix of the step, and how gaps answer, for all that touches. */
static void answer_gaps(const stage_factors *factors, workspace *work) {
  const int count = work->touch_count;
  for (int k = 0; k < count; k++) {
    real *response = work->responses[k];
    force_along(k, work->gradients[k], response, work);
    solve_system(complex_matrix(), 2, factors, response, work);
    for (int j = 0; j < count; j++) {
      work->answers[0][j * count + k] = dot(work->gradients[j], response);
      work->answers[1][j * count + k] = dot(work->gradients[j], response + N);
    }
  }
}

/* The complex system of the gaps of what presses, as a real one of twice the size. Zero where it is singular. */
static int factorise_border(workspace *work) {
  const int count = work->touch_count;
  int pressing = 0;
  for (int k = 0; k < count; k++) {
    if (work->touches[k].presses) work->active[pressing++] = k;
  }
  work->pressing = pressing;
  const int order = 2 * pressing;
  for (int j = 0; j < pressing; j++) {
    for (int i = 0; i < pressing; i++) {
      const real whole = work->answers[0][work->active[i] * count + work->active[j]];
      const real imaginary = work->answers[1][work->active[i] * count + work->active[j]];
      work->border[j * order + i] = whole;
      work->border[j * order + pressing + i] = imaginary;
      work->border[(pressing + j) * order + i] = -imaginary;
      work->border[(pressing + j) * order + pressing + i] = whole;
    }
  }
  for (int i = 0; i < pressing; i++) work->border_members[i] = work->active[i];
  return factorise_square(order, work->border, 0, work->border_pivots);
}

/* What the corrections of a step need of its contacts, for the factorised matrix at hand. Zero where gaps depend on each
   other. */
static int border_step(const stage_factors *factors, workspace *work) {
  answer_gaps(factors, work);
  if (!factorise_border(work)) return 0;
#ifdef CONTACT_RUBS
  answer_slides(factors, work);
  answers_of_stages(work);
#endif
  return 1;
}

/* Corrections along the eigenvector that close the gaps of what presses, from those without; moves the forces. */
static void close_gaps(real *solution, workspace *work) {
#ifdef CONTACT_RUBS
  settle_stages(solution, work);
#else
  const int pressing = work->pressing;
  real *values = work->border_values;
  for (int m = 0; m < pressing; m++) {
    const int k = work->border_members[m];
    const real first = work->stage_gaps[0][k];
    const real second = work->stage_gaps[1][k];
    values[m] = TO_EIGENVECTOR[0][0] * first + TO_EIGENVECTOR[1][0] * second - dot(work->gradients[k], solution);
    values[pressing + m] =
        TO_EIGENVECTOR[0][1] * first + TO_EIGENVECTOR[1][1] * second - dot(work->gradients[k], solution + N);
  }
  solve_square(2 * pressing, work->border, work->border_pivots, values);
  for (int m = 0; m < pressing; m++) {
    const int k = work->border_members[m];
    const real whole = values[m];
    const real imaginary = values[pressing + m];
    const real *response = work->responses[k];
    for (int i = 0; i < N; i++) {
      solution[i] += response[i] * whole - response[N + i] * imaginary;
      solution[N + i] += response[i] * imaginary + response[N + i] * whole;
    }
    for (int stage = 0; stage < STAGES; stage++) {
      work->touches[k].forces[stage] += FROM_EIGENVECTOR[stage][1] * imaginary - FROM_EIGENVECTOR[stage][0] * whole;
    }
  }
#endif
}

/* ---- Stretches between blows ---- */

static solver_motion_status solve_step(const step_start *start, const solver_step_options *options, real *unknowns,
                                       solver_step_memory *memory, workspace *work, solver_step_info *info);
static void guess_stages(const real *before, real ratio, const solver_state *state, real *unknowns);
#ifdef STRETCHES_ARE_TOLD
static int find_closed(const real *x, const real *inputs);
#endif

/* Whether those that press do, and the others are open, at the end of a stretch that was solved with these; else others are
   chosen, by how the gaps at the end answer to forces that last all along. Negative where nothing settles it. */
static int choose_pressing(const step_start *start, const real *unknowns, workspace *work) {
  const int count = work->touch_count;
  const real whole = TO_EIGENVECTOR[0][0] + TO_EIGENVECTOR[1][0];
  const real imaginary = TO_EIGENVECTOR[0][1] + TO_EIGENVECTOR[1][1];
  real *wanted = work->wanted;
  const real open = gap_open(start->size);
  int holds = 1, closed = 1;
  stage_at(start, STAGES - 1, unknowns, &work->at);
  for (int k = 0; k < count; k++) {
    touch *own = work->touches + k;
    section_gap gap;
    follow_touch(own, own->presses ? own->places[1] : own->place, work->at.state, work->at.inputs, &gap, work);
    own->gap = gap.value;
    own->end_place = gap.place;
#ifdef RODS_FACE_RODS
    own->other_end_place = place_on_other(FACING + own->facing, &gap);
#endif
    own->force = own->presses ? STAGE_MATRIX[1][0] * own->forces[0] + STAGE_MATRIX[1][1] * own->forces[1] : 0;
    closed &= !own->presses || ABSOLUTE(gap.value - own->height) <= TOUCHING;
    holds &= own->presses ? own->force >= 0 : gap.value - own->height >= -open;
#ifdef CONTACT_RUBS
    note_friction(k, &gap, work);
#endif
  }
  if (!closed) return -1;
#ifdef CONTACT_RUBS
  if (work->friction_lost) return -1;
#endif
  if (holds) return 1;
  for (int j = 0; j < count; j++) {
    for (int k = 0; k < count; k++) {
      const real share = work->answers[0][k * count + j];
      const real share_imaginary = work->answers[1][k * count + j];
      work->compliance[j * count + k] = FROM_EIGENVECTOR[1][0] * (whole * share - imaginary * share_imaginary) -
                                        FROM_EIGENVECTOR[1][1] * (whole * share_imaginary + imaginary * share);
    }
  }
  for (int j = 0; j < count; j++) {
    wanted[j] = work->touches[j].gap - work->touches[j].height;
    for (int k = 0; k < count; k++) wanted[j] -= work->compliance[k * count + j] * work->touches[k].force;
  }
  if (!least_pushes(work->compliance, wanted, count, open / 10, work->pushes, work)) return -1;
  for (int k = 0; k < count; k++) {
    touch *own = work->touches + k;
    const int presses = work->pushes[k] > 0;
    own->force = work->pushes[k];
    own->presses = presses;
  }
  return 0;
}

/* Lets go all that presses, whose gaps may depend on each other; zero where nothing does. */
static int release_all(workspace *work) {
  int released = 0;
  for (int k = 0; k < work->touch_count; k++) {
    touch *own = work->touches + k;
    released |= own->presses;
    own->presses = 0;
    own->force = 0;
  }
  return released;
}

/* Whether a section that presses is elsewhere at the end of a stretch: the gap may have another valley there. */
static int slides_too_far(const workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    const touch *own = work->touches + k;
    if (own->presses && ABSOLUTE(own->end_place - own->place) > FARTHEST) return 1;
  }
  return 0;
}

/* Solves a stretch with the forces of what touches at its start. */
static solver_motion_status solve_stretch(const step_start *start, const solver_step_options *options, real *unknowns,
                                          solver_step_memory *memory, workspace *work, solver_step_info *info) {
  int tried_again = 0;
#ifdef CONTACT_RUBS
  solver_step_options exact = *options;
  if (exact.tolerance > gap_open(start->size) / 10) exact.tolerance = gap_open(start->size) / 10;
  options = &exact;
  work->stretch_size = start->size;
  work->friction_lost = 0;
#endif
#ifdef STRETCHES_ARE_TOLD
  if (find_closed(start->x, start->inputs)) memory->jacobian_size = 0;
#endif
  for (int set = 0; set < SETS; set++) {
    if (set > 0) {
      /* Where places slide far within the step, gradients at its end serve better than those at its start. */
      section_gap gap;
      stage_at(start, STAGES - 1, unknowns, &work->at);
      for (int k = 0; k < work->touch_count; k++) {
        gradient_at(work->touches + k, work->touches[k].place, work->at.state, work->at.inputs, &gap, work->gradients[k],
                    work);
#ifdef CONTACT_RUBS
        note_slide(k, &gap, work->at.state, work->at.inputs, work);
#endif
        if (!all_finite(work->gradients[k], N)) return SOLVER_MOTION_NOT_FINITE;
      }
    }
    const solver_motion_status status = solve_step(start, options, unknowns, memory, work, info);
    if (status == SOLVER_MOTION_SINGULAR && release_all(work)) continue;
    if (status == SOLVER_MOTION_NOT_SOLVED && work->pressing > 0 && !tried_again) {
      tried_again = 1;
      continue;
    }
    if (status != SOLVER_MOTION_DONE) return status;
    const int holds = choose_pressing(start, unknowns, work);
#ifdef STRETCHES_ARE_TOLD
    if (holds >= 0 && find_closed(work->at.state, work->at.inputs)) {
      memory->jacobian_size = 0;
      continue;
    }
#endif
    if (holds > 0) return slides_too_far(work) ? SOLVER_MOTION_NOT_SOLVED : SOLVER_MOTION_DONE;
    if (holds < 0) return SOLVER_MOTION_NOT_SOLVED;
  }
  return SOLVER_MOTION_NOT_SOLVED;
}

/* The instant after a share of a stretch, by its polynomial. */
static void instant_in(const step_start *start, real share, const real *unknowns, instant *at) {
  real values[STAGES], integrals[STAGES], double_integrals[STAGES];
  for (int j = 0; j < STAGES; j++) {
    const real constant = STAGE_POLYNOMIALS[0][j];
    const real slope = STAGE_POLYNOMIALS[1][j];
    values[j] = constant + share * slope;
    integrals[j] = share * (constant + share / 2 * slope);
    double_integrals[j] = share * share * (constant / 2 + share / 6 * slope);
  }
  motion_in(start, share, values, integrals, double_integrals, unknowns, at);
}

/* Whether one of the sections that touch is this one, or of one that slides next to it. */
static int is_touch(int number, real place, const workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    const touch *own = work->touches + k;
    if (own->facing != number) continue;
    if (!own->slides && (FACING[number].is_body || own->place == place)) return 1;
    if (own->slides && (ABSOLUTE(own->place - place) <= SAME_PLACE || ABSOLUTE(own->end_place - place) <= SAME_PLACE)) {
      return 1;
    }
  }
  return 0;
}

static int lies_now(int number, const workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    if (work->touches[k].facing == number && !work->touches[k].slides && !FACING[number].is_body) return 1;
  }
  return 0;
}

/* The least gap of all that does not touch, up to a bound beyond which nobody asks; not finite where a position is not. */
static real lowest_other(const instant *at, workspace *work) {
  real lowest = SAME_PLACE;
  for (int number = 0; number < FACINGS; number++) {
    const facing *own = FACING + number;
    positions_of(own, at->state, at->inputs, work->nodes, work);
    if (!all_finite(work->nodes, 3 * point_count(own))) return NAN;
    if (lies_now(number, work)) {
      fit_nodes(own, work->nodes, work);
      for (int k = 0; k < own->laid_count; k++) {
        section_gap gap;
        if (is_touch(number, own->laid[k], work)) continue;
        look_at(own, own->laid[k], &gap, work);
        if (!(gap.value > lowest)) lowest = gap.value;
      }
      continue;
    }
    int look = 0;
    section_gap gap;
    look_along(own, work->nodes, work);
    while ((look = next_valley(own, look, lowest, 0, &gap, work)) > 0) {
      if (!is_touch(number, gap.place, work)) lowest = gap.value;
    }
  }
  return lowest;
}

/* Looks for blows that a stretch takes: so many that nothing thin is passed between two; zero where these are too many. */
static int looks_in(const step_start *start, const real *unknowns, workspace *work) {
  int looks = LOOKS_IN_TIME;
  instant_in(start, 1, unknowns, &work->at);
  for (int number = 0; number < FACINGS; number++) {
    const facing *own = FACING + number;
    const real longest = way_of_points(own, start->x, start->inputs, work->at.state, work->at.inputs, work);
    if (!(longest < (real)MOST_IN_TIME * own->stride)) return 0;
    while (looks * own->stride < longest) looks++;
  }
  return looks;
}

/* The share of a stretch after which another gap comes to zero, to less than what touches: 1 where none does. Zero where
   what moves is too fast to be looked at. */
static real first_blow(const step_start *start, const real *unknowns, workspace *work) {
  const int looks = looks_in(start, unknowns, work);
  real before = 0;
  if (looks == 0) return 0;
  for (int look = 1; look <= looks; look++) {
    real low = before, high = (real)look / (real)looks;
    instant_in(start, high, unknowns, &work->at);
    real gap = lowest_other(&work->at, work);
    if (!isfinite(gap)) return 0;
    before = high;
    if (gap >= -TOUCHING) continue;
    for (int k = 0; k < LOCATIONS; k++) {
      const real middle = (low + high) / 2;
      instant_in(start, middle, unknowns, &work->at);
      gap = lowest_other(&work->at, work);
      if (ABSOLUTE(gap) <= TOUCHING / 4) return middle;
      if (gap > 0) {
        low = middle;
      } else {
        high = middle;
      }
      /* A valley has come that was none before, below zero already. */
      if (high - low <= (real)1e-9) break;
    }
    return high;
  }
  return 1;
}

/* The accelerations at the stages of the first share of a stretch. */
static void shorten(real share, real *unknowns) {
  for (int i = 0; i < N; i++) {
    const real first = unknowns[i];
    const real second = unknowns[N + i];
    for (int stage = 0; stage < STAGES; stage++) {
      const real at = share * STAGE_NODES[stage];
      unknowns[stage * N + i] = (STAGE_POLYNOMIALS[0][0] + at * STAGE_POLYNOMIALS[1][0]) * first +
                                (STAGE_POLYNOMIALS[0][1] + at * STAGE_POLYNOMIALS[1][1]) * second;
    }
  }
}

/* Those that touch now and pressed before go on to press. */
static void know_touches(workspace *work) {
  const touch *before = work->known;
  for (int k = 0; k < work->touch_count; k++) {
    touch *own = work->touches + k;
    for (int i = 0; i < work->known_count; i++) {
      const int is_same = own->slides ? ABSOLUTE(before[i].place - own->place) <= SAME_PLACE : before[i].place == own->place;
      if (!before[i].presses || before[i].facing != own->facing || before[i].slides != own->slides || !is_same) continue;
      own->presses = 1;
      own->height = before[i].height;
      own->force = before[i].force;
#ifdef CONTACT_RUBS
      memcpy(own->axis, before[i].axis, sizeof own->axis);
      memcpy(own->drag, before[i].drag, sizeof own->drag);
#endif
    }
  }
}

/* Gradients of the gaps of all that touches, at the start of a stretch. */
static int gradients_at_start(const step_start *start, const real *x, const real *v, workspace *work) {
  instant *at = &work->at;
  memcpy(at->state, x, N * sizeof *x);
  memcpy(at->state + N, v, N * sizeof *v);
  memset(at->state + 2 * N, 0, N * sizeof *v);
  inputs_of(start, 0, at);
  return gradients_at(at->state, at->inputs, work);
}

/* What touches at the start of a stretch, and the blows that are struck there: x and v of the start are written over then.
   Zero where nothing settles it. */
static int begin_stretch(const step_start *start, real *x, real *v, workspace *work) {
  instant *at = &work->at;
  int strikes = 0;
  if (!find_touching(x, start->inputs, work)) return 0;
  know_touches(work);
  if (work->touch_count == 0) return 1;
  if (!gradients_at_start(start, x, v, work)) return 0;
  for (int k = 0; k < work->touch_count; k++) {
    touch *own = work->touches + k;
    section_gap gap;
    follow_touch(own, own->place, at->state, at->inputs, &gap, work);
    const real rate = rate_of(own, at, &gap, work);
    if (!isfinite(rate)) return 0;
    if (!own->presses) own->height = own->gap;
    strikes |= !own->presses && rate < -STILL / start->size;
  }
  if (!strikes) return 1;
  work->was_cut = 1;
#ifdef CONTACT_RUBS
  work->stretch_size = start->size;
#endif
  if (!strike(at, start->size, work)) return 0;
  memcpy(x, at->state, N * sizeof *x);
  memcpy(v, at->state + N, N * sizeof *v);
  return 1;
}

/* Notes what touches at the end of a stretch, for the next one. */
static void note_touches(workspace *work) {
  memcpy(work->known, work->touches, sizeof work->known);
  for (int k = 0; k < work->touch_count; k++) work->known[k].place = work->touches[k].end_place;
  work->known_count = work->touch_count;
}

/* What touched at the end of the last step, where this one goes on from there. */
static void recall_touches(const solver_step_memory *memory, const solver_state *state, workspace *work) {
  int goes_on = 1;
  for (int i = 0; i < N; i++) goes_on &= !IS_SHAPE[i] || memory->unknowns[N + i] == state->a[i];
  work->was_cut = 0;
  work->known_count = goes_on ? memory->touch_count : 0;
  memcpy(work->known, memory->touches, sizeof work->known);
}

static void keep_touches(solver_step_memory *memory, workspace *work) {
  note_touches(work);
  memcpy(memory->touches, work->known, sizeof memory->touches);
  memory->touch_count = work->known_count;
  /* After a cut the polynomial is that of the last stretch. */
  if (work->was_cut) memory->size = 0;
}

/* A part of a step, from the state in work->end to that in work->at; leaves the unknowns of its last stretch. */
static solver_motion_status part_in_contact(const step_start *whole, int number, solver_step_memory *memory,
                                            const solver_step_options *options, real *unknowns, workspace *work,
                                            solver_step_info *info) {
  real done = 0;
  if (number > 0) note_touches(work);
  for (int cut = 0; cut < CUTS; cut++) {
    step_start start = *whole;
    real share = 1;
    start.size = whole->size - done;
    inputs_after(whole, done, work->stretch_inputs, work->stretch_rates);
    start.inputs = work->stretch_inputs;
    start.inputs_rate = work->stretch_rates;
#ifdef STRETCHES_ARE_TOLD
    start.since = done;
#endif
    if (cut > 0) guess_stages(0, 1, &work->end, unknowns);
    if (!begin_stretch(&start, work->end.x, work->end.v, work)) return SOLVER_MOTION_NOT_SOLVED;
#ifdef CONTACT_RUBS
    turn_search search;
    memset(&search, 0, sizeof search);
    note_starts(work->end.x, work->end.v, work->stretch_inputs, work->stretch_rates, work);
#endif
    for (int tries = 0;; tries++) {
      const solver_motion_status status = solve_stretch(&start, options, unknowns, memory, work, info);
      if (status != SOLVER_MOTION_DONE && work->touch_count > 0 && tries < SETS) {
        /* What presses may slide, or come and go, faster than the step: a part of it does not. */
        work->was_cut = 1;
        start.size /= 2;
        guess_stages(0, 1, &work->end, unknowns);
        if (!gradients_at_start(&start, work->end.x, work->end.v, work)) return SOLVER_MOTION_NOT_SOLVED;
        continue;
      }
      if (status != SOLVER_MOTION_DONE) return status;
      share = first_blow(&start, unknowns, work);
      if (!(share > 0) || (share < 1 && tries == SETS)) return SOLVER_MOTION_NOT_SOLVED;
#ifdef CONTACT_RUBS
      /* The last try is taken where it ends. */
      if (tries == TURNS) search.looks = LOOKS_FOR_A_TURN;
      if (share == 1) share = to_the_turn(&start, whole->size, whole->size - done, unknowns, &search, work);
#endif
      if (share == 1) break;
      work->was_cut = 1;
      start.size *= share;
      shorten(share, unknowns);
    }
    stage_at(&start, STAGES - 1, unknowns, &work->at);
    done += start.size;
    work->part_counts[number] = work->touch_count;
    memcpy(work->part_touches[number], work->touches, sizeof work->touches);
    if (done >= whole->size * (1 - (real)1e-12)) return SOLVER_MOTION_DONE;
    memcpy(work->end.x, work->at.state, sizeof work->end.x);
    memcpy(work->end.v, work->at.state + N, sizeof work->end.v);
    memcpy(work->end.a, work->at.state + 2 * N, sizeof work->end.a);
    note_touches(work);
  }
  return SOLVER_MOTION_NOT_SOLVED;
}
