/* Coulomb's friction of exact contact in the steps of a motion. The point of a section that touches slides along the surface
   with the velocity u. A force of friction is that of a drag w, of the size of a force along the normal f:

     |w| <= f and u = 0 where it sticks,   w = -f u / |u| where it slips,   for each stage of a step,

   and the force is the coefficients times the drag: one in all directions, or one along the rod, one back, one across.
   Stages and blows are the same problem: gaps, or their rates, and velocities are linear in the forces of all that touches,
   with the law between them. Newton's method for it takes w as the projection of w - r u to the disk of the radius f
   (P. Alart, A. Curnier, Computer Methods in Applied Mechanics and Engineering 92, 1991). By stages a stiffly accurate
   method whose work of friction is never positive takes energy, and what sticks at the end has no velocity to rounding
   (V. Acary, B. Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, Springer 2008). Blows: J. J. Moreau,
   Unilateral contact and dry friction in finite freedom dynamics, Springer 1988. */

/* Residual of the law, over the largest force, up to which it holds; and rounding, over the terms of its sum. */
static const real LAW_HOLDS = (real)1e-12;
static const real LAW_ROUNDING = (real)1e-13;

/* Share of a section's compliance that Newton's matrix, not its residual, adds for sticking sections: how several of
   them share the force on a rod that does not stretch is not determined. */
static const real YIELDING = (real)1e-9;

/* Shares of a section's compliance by which drags yield as they leave given drags, for use if Newton's method goes
   round in circles: each such law has one solution, and the sequence of solutions converges to one without them. */
static const real RELUCTANCES[] = {(real)1e-6, (real)1e-4, (real)1e-2, 1};

/* Cosine between the axis of the tangents and the normal above which another axis is taken. */
static const real UPRIGHT = (real)0.9;

/* Way in a stretch, over the length, up to which a section that slides at its start counts as at rest. */
static const real STANDS = (real)1e-8;

/* Size of a stretch that ends as a section comes to rest or turns back: share of the time of the first guess, addition
   to the second guess so that it is reached, and share of a part of a step that is not shortened for it. */
static const real MOST_OF_A_TURN = (real)0.9;
static const real BEYOND_TURN = (real)1e-6;
static const real LEAST_OF_A_TURN = (real)1e-4;

/* Largest rise of the slope at an end of a rod above zero, over its rise to zero, in a stretch that ends where a
   section runs out onto that end. */
static const real BEYOND_END = (real)1e-2;

/* Share of a stretch from which on it ends where something lifts off. */
static const real MOST_OF_A_LIFT_OFF = (real)0.999;

/* Search for the end of a stretch: size of a stretch in which a section turned, 0 before; whether the present size is
   one at which it just turns; share of the stretch at lift-off by the last look, 0 before; number of looks. */
typedef struct {
  real turned_after;
  int is_aimed;
  real lifted_after;
  int looks;
} turn_search;

enum {
  ROWS = 3,         /* of a touching section: along the normal, and along both tangents */
  LAW_TURNS = 60,   /* iterations of the law */
  RELUCTANT = 60,   /* laws with drags that leave given drags reluctantly, in sequence */
  HALVINGS = 8,     /* of a step of these */
  TURNS = SETS,     /* tries of a stretch after which it must end where a section comes to rest */
  LOOKS_FOR_A_TURN = 6,
  NARROWINGS = 20   /* bisections for the largest restitution of a blow that adds no energy */
};

static real inner_of_two(const real *a, const real *b) { return a[0] * b[0] + a[1] * b[1]; }

#ifdef STRETCHES_ARE_TOLD
static void tell_blow(real taken, const workspace *work);
static void tell_stretch(const step_start *start, workspace *work);
#endif
static void respond_to(const facing *own, const real *row, const stage_factors *factors, real *response, workspace *work);
static void force_along(int k, const real *row, real *force, const workspace *work);
static void instant_in(const step_start *start, real share, const real *unknowns, instant *at);
static real wanted_of(int k, real still, const workspace *work);

static int rubs(const touch *own) { return FACING[own->facing].rubbing != 0; }

/* ---- Sliding ---- */

static void both_tangents(const real *normal, const real *axis, real tangents[2][3]) {
  const real share = inner(normal, axis);
  for (int i = 0; i < 3; i++) tangents[0][i] = axis[i] - share * normal[i];
  const real length = SQUARE_ROOT(inner(tangents[0], tangents[0]));
  for (int i = 0; i < 3; i++) tangents[0][i] /= length;
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    tangents[1][i] = normal[j] * tangents[0][k] - normal[k] * tangents[0][j];
  }
}

/* The axis of the tangents: an axis of the world across the normal, or the last axis while it is across. */
static void choose_axis(touch *own, const real *normal) {
  int best = 0;
  if (inner(own->axis, own->axis) > 0 && ABSOLUTE(inner(own->axis, normal)) < UPRIGHT) return;
  for (int i = 1; i < 3; i++) best = ABSOLUTE(normal[i]) < ABSOLUTE(normal[best]) ? i : best;
  for (int i = 0; i < 3; i++) own->axis[i] = (real)(i == best);
  own->drag[0] = own->drag[1] = 0;
}

static rubbed section_of(const touch *own, const section_gap *gap, const real *x, const real *inputs, workspace *work) {
  const int count = point_count(FACING + own->facing);
  const rubbed at = {x, inputs, x + N, inputs + INPUTS, work->section, own->axis};
  memset(work->section, 0, (size_t)count * sizeof *work->section);
  memcpy(work->section + gap->first, gap->rows[0], (size_t)gap->nodes * sizeof *work->section);
  work->section[count] = gap->place;
#ifdef RODS_FACE_RODS
  put_other_section(FACING + own->facing, gap, work->section);
#endif
  return at;
}

/* Slide of a touching section at a state; velocities stand behind the positions as in an instant. */
static void slide_at(const touch *own, const section_gap *gap, const real *x, const real *inputs, real *slide,
                     real rows[2][N], real *along, workspace *work) {
  const rubbed at = section_of(own, gap, x, inputs, work);
  rubbing_of(FACING + own->facing, &at, slide, rows[0], along, work);
}

/* Slide of a section by its number, at the start of a stretch or for a blow. */
static void note_slide(int k, const section_gap *gap, const real *x, const real *inputs, workspace *work) {
  touch *own = work->touches + k;
  memset(work->slide_rows[k], 0, sizeof work->slide_rows[k]);
  memset(work->slides[k], 0, sizeof work->slides[k]);
  if (!rubs(own)) return;
  choose_axis(own, gap->normal);
  slide_at(own, gap, x, inputs, work->slides[k], work->slide_rows[k], work->along[k], work);
}

/* Coefficients that turn a drag into a force; the direction of the drag tells whether the rod slides along or back. */
static void coefficients_of(const touch *own, const real *along, const real *drag, real matrix[2][2]) {
  const real *given = FACING[own->facing].coefficients;
  const real more = (inner_of_two(along, drag) > 0 ? given[1] : given[0]) - given[2];
  for (int a = 0; a < 2; a++) {
    for (int b = 0; b < 2; b++) matrix[a][b] = (a == b ? given[2] : 0) + more * along[a] * along[b];
  }
}

static void friction_of(const touch *own, const real *along, const real *drag, real *force) {
  real matrix[2][2];
  coefficients_of(own, along, drag, matrix);
  for (int a = 0; a < 2; a++) force[a] = inner_of_two(matrix[a], drag);
}

/* ---- The law of several contacts ---- */

/* The forces, along normals and tangents, of normal forces and drags. */
static void pushes_of(int count, const int *members, const real *forces, real *pushes, const workspace *work) {
  for (int q = 0; q < count; q++) {
    const touch *own = work->touches + members[q];
    pushes[ROWS * q] = forces[ROWS * q];
    pushes[ROWS * q + 1] = pushes[ROWS * q + 2] = 0;
    if (rubs(own)) friction_of(own, work->law_along[q], forces + ROWS * q + 1, pushes + ROWS * q + 1);
  }
}

/* Drag minus r times slide of a pressing section, for the projection of Newton's method. Returns its length. */
static real tried_drag(int q, const workspace *work, real tried[2]) {
  for (int a = 0; a < 2; a++) {
    tried[a] = work->law_forces[ROWS * q + 1 + a] - work->law_scales[q] * work->law_slides[q][a];
  }
  return SQUARE_ROOT(inner_of_two(tried, tried));
}

/* Residuals of gaps and the law at the present forces, as forces. Gives the largest one beyond rounding, and returns
   the norm. Drags leave law_held reluctantly. */
static real misses_of_law(int count, const int *members, real reluctance, real *excess, workspace *work) {
  const int order = ROWS * count;
  const real *answers = work->law_answers;
  const real *forces = work->law_forces;
  real *misses = work->law_misses;
  real sum = 0;
  *excess = 0;
  pushes_of(count, members, forces, work->law_pushes, work);
  for (int i = 0; i < order; i++) {
    const int q = i / ROWS;
    const real weight = i % ROWS == 0 ? 1 / answers[i * order + i] : work->law_scales[q];
    real value = work->law_open[i];
    real terms = ABSOLUTE(value);
    for (int j = 0; j < order; j++) {
      const real term = answers[j * order + i] * work->law_pushes[j];
      value += term;
      terms += ABSOLUTE(term);
    }
    if (i % ROWS > 0 && reluctance > 0) value += reluctance / weight * (forces[i] - work->law_held[i]);
    misses[i] = weight * value;
    work->law_terms[i] = LAW_ROUNDING * ABSOLUTE(weight) * terms;
    /* Its slide in a stretch is within the rounding of positions. */
    if (i % ROWS > 0) work->law_terms[i] = larger(work->law_terms[i], weight * STAGE_ROUNDING / work->stretch_size);
    if (i % ROWS > 0) work->law_slides[q][i % ROWS - 1] = value;
  }
  for (int q = 0; q < count; q++) {
    const real bound = larger(forces[ROWS * q], 0);
    real tried[2];
    const real length = tried_drag(q, work, tried);
    work->law_slips[q] = length > bound;
    for (int a = 0; a < 2 && length > bound; a++) {
      misses[ROWS * q + 1 + a] = forces[ROWS * q + 1 + a] - bound * tried[a] / length;
    }
  }
  for (int i = 0; i < order; i++) {
    *excess = larger(*excess, ABSOLUTE(misses[i]) - work->law_terms[i] - LAW_HOLDS * ABSOLUTE(forces[i - i % ROWS]));
    sum += misses[i] * misses[i];
  }
  return SQUARE_ROOT(sum);
}

/* Newton's matrix of the residuals of the law. */
static void matrix_of_law(int count, const int *members, real reluctance, real *matrix, workspace *work) {
  const int order = ROWS * count;
  const real *answers = work->law_answers;
  const real *forces = work->law_forces;
  for (int q = 0; q < count; q++) {
    const touch *own = work->touches + members[q];
    const int first = ROWS * q;
    real by_drag[2][2] = {{0, 0}, {0, 0}};
    if (rubs(own)) coefficients_of(own, work->law_along[q], forces + first + 1, by_drag);
    for (int i = 0; i < order; i++) {
      matrix[first * order + i] = answers[first * order + i];
      for (int b = 0; b < 2; b++) {
        matrix[(first + 1 + b) * order + i] =
            answers[(first + 1) * order + i] * by_drag[0][b] + answers[(first + 2) * order + i] * by_drag[1][b];
      }
    }
    for (int slot = first + 1; slot < first + ROWS; slot++) matrix[slot * order + slot] += reluctance / work->law_scales[q];
  }
  for (int q = 0; q < count; q++) {
    const int normal = ROWS * q, first = normal + 1;
    const real bound = larger(forces[normal], 0);
    const real yields = answers[normal * order + normal];
    real tried[2];
    const real length = tried_drag(q, work, tried);
    const real way[2] = {length > 0 ? tried[0] / length : 0, length > 0 ? tried[1] / length : 0};
    const real share = work->law_slips[q] ? bound / length : 1;
    for (int j = 0; j < order; j++) {
      real *column = matrix + j * order + first;
      const real along = work->law_slips[q] ? inner_of_two(way, column) : 0;
      matrix[j * order + normal] /= yields;
      for (int a = 0; a < 2; a++) column[a] = share * work->law_scales[q] * (column[a] - along * way[a]);
    }
    for (int a = 0; a < 2; a++) {
      if (work->law_slips[q] && bound > 0) matrix[normal * order + first + a] -= way[a];
      for (int b = 0; b < 2; b++) {
        const real turns = (a == b) - share * ((a == b) - way[a] * way[b]);
        matrix[(first + b) * order + first + a] += work->law_slips[q] ? turns : YIELDING * (a == b);
      }
    }
  }
}

/* Newton's method for the law, from the present forces. It halves steps until the residual falls, since kinks may send
   it round in circles. Returns zero without a solution. */
static int iterate_law(int count, const int *members, real reluctance, workspace *work) {
  const int order = ROWS * count;
  real *steps = work->law_values;
  real excess;
  real missed = misses_of_law(count, members, reluctance, &excess, work);
  for (int turn = 0; turn < LAW_TURNS; turn++) {
    if (!isfinite(missed)) return 0;
    if (excess <= 0) return 1;
    matrix_of_law(count, members, reluctance, work->law_matrix, work);
    if (!factorise_square(order, work->law_matrix, 0, work->law_pivots)) return 0;
    for (int i = 0; i < order; i++) steps[i] = -work->law_misses[i];
    solve_square(order, work->law_matrix, work->law_pivots, steps);
    real share = 1;
    for (int i = 0; i < order; i++) work->law_forces[i] += steps[i];
    const real before = missed;
    missed = misses_of_law(count, members, reluctance, &excess, work);
    for (int halving = 0; halving < HALVINGS && excess > 0 && !(missed < before); halving++) {
      share /= 2;
      for (int i = 0; i < order; i++) work->law_forces[i] -= share * steps[i];
      missed = misses_of_law(count, members, reluctance, &excess, work);
    }
  }
  return 0;
}

/* Solves laws with drags that leave the last solution reluctantly, in sequence, until the plain law holds (R. T.
   Rockafellar, SIAM Journal on Control and Optimization 14, 1976). */
static int iterate_reluctantly(int count, const int *members, real reluctance, workspace *work) {
  const size_t size = (size_t)(ROWS * count) * sizeof *work->law_forces;
  real excess;
  for (int turn = 0; turn < RELUCTANT; turn++) {
    memcpy(work->law_held, work->law_forces, size);
    if (!iterate_law(count, members, reluctance, work)) return 0;
    misses_of_law(count, members, 0, &excess, work);
    if (excess <= 0) return 1;
  }
  return 0;
}

/* Finds the normal forces that close the gaps of so many pressing sections, and drags that obey the law. open holds
   gaps, or their rates, and slides without forces; law_answers their changes by forces; law_forces is the first guess.
   Returns zero without a solution. */
static int settle_law(int count, const int *members, workspace *work) {
  const int order = ROWS * count;
  const size_t size = (size_t)order * sizeof *work->law_forces;
  for (int q = 0; q < count; q++) {
    const real *given = FACING[work->touches[members[q]].facing].coefficients;
    real slides = 0;
    for (int slot = ROWS * q + 1; slot < ROWS * q + ROWS; slot++) {
      slides = larger(slides, ABSOLUTE(work->law_answers[slot * order + slot]));
    }
    slides *= larger(given[0], larger(given[1], given[2]));
    work->law_scales[q] = slides > 0 ? 1 / slides : 1;
    if (!(ABSOLUTE(work->law_answers[ROWS * q * (order + 1)]) > 0)) return 0;
  }
  memcpy(work->law_starts, work->law_forces, size);
  if (iterate_law(count, members, 0, work)) return 1;
  for (size_t k = 0; k < sizeof RELUCTANCES / sizeof *RELUCTANCES; k++) {
    memcpy(work->law_forces, work->law_starts, size);
    if (iterate_reluctantly(count, members, RELUCTANCES[k], work)) return 1;
  }
  return 0;
}

/* ---- In stages ---- */

/* Subtracts the friction of a pressing section from the equations of a stage, and stores its slide. */
static void rub_in_stage(int stage, int k, const section_gap *gap, const instant *at, real *residual, workspace *work) {
  const touch *own = work->touches + k;
  real(*rows)[N] = work->stage_slide_rows[stage][k];
  real force[2];
  if (!rubs(own)) return;
  slide_at(own, gap, at->state, at->inputs, work->stage_slides[stage][k], rows, work->stage_along[stage][k], work);
  friction_of(own, work->stage_along[stage][k], own->drags[stage], force);
  for (int i = 0; i < N; i++) {
    residual[i] -= share_of(FACING + own->facing, i) * (force[0] * rows[0][i] + force[1] * rows[1][i]);
  }
}

static const real *row_of(int k, int row, const workspace *work) {
  return row == 0 ? work->gradients[k] : work->slide_rows[k][row - 1];
}

static real *response_of(int k, int row, workspace *work) {
  return row == 0 ? work->responses[k] : work->slide_responses[k][row - 1];
}

/* Changes of positions by unit forces along normals and tangents, by the factorised matrix of the step, and the changes
   of gaps and slides. */
static void answer_slides(const stage_factors *factors, workspace *work) {
  const int count = work->touch_count;
  const int order = ROWS * count;
  for (int j = 0; j < order; j++) {
    real *response = response_of(j / ROWS, j % ROWS, work);
    if (j % ROWS > 0) {
      force_along(j / ROWS, row_of(j / ROWS, j % ROWS, work), response, work);
      solve_system(complex_matrix(), 2, factors, response, work);
    }
    for (int i = 0; i < order; i++) {
      const real *row = row_of(i / ROWS, i % ROWS, work);
      work->complex_answers[0][j * order + i] = dot(row, response);
      work->complex_answers[1][j * order + i] = dot(row, response + N);
    }
  }
}

/* Change of a gap or a slide at a stage by a complex change along the eigenvector; a slide is a velocity. */
static real at_stage(int stage, int row, real whole, real imaginary, real size) {
  const real rate = row > 0 ? RATE[0] / size : 1;
  const real rate_imaginary = row > 0 ? RATE[1] / size : 0;
  const real product = rate * whole - rate_imaginary * imaginary;
  const real product_imaginary = rate * imaginary + rate_imaginary * whole;
  return FROM_EIGENVECTOR[stage][0] * product - FROM_EIGENVECTOR[stage][1] * product_imaginary;
}

/* Changes of gaps and slides of pressing sections at both stages by forces at both stages. */
static void answers_of_stages(workspace *work) {
  const int pressing = work->pressing;
  const int all = ROWS * work->touch_count;
  const int order = ROWS * pressing * STAGES;
  for (int j = 0; j < order; j++) {
    const int stage = j / (ROWS * pressing);
    const int column = ROWS * work->border_members[j / ROWS % pressing] + j % ROWS;
    for (int i = 0; i < order; i++) {
      const int row = ROWS * work->border_members[i / ROWS % pressing] + i % ROWS;
      const real whole = work->complex_answers[0][column * all + row];
      const real imaginary = work->complex_answers[1][column * all + row];
      work->law_answers[j * order + i] = at_stage(
          i / (ROWS * pressing), i % ROWS, TO_EIGENVECTOR[stage][0] * whole - TO_EIGENVECTOR[stage][1] * imaginary,
          TO_EIGENVECTOR[stage][0] * imaginary + TO_EIGENVECTOR[stage][1] * whole, work->stretch_size);
    }
  }
}

/* Corrects the corrections along the eigenvector so that pressing sections obey the law at both stages; updates the
   forces. */
static void settle_stages(real *solution, workspace *work) {
  const int pressing = work->pressing;
  const int count = STAGES * pressing;
  const int order = ROWS * count;
  real *forces = work->law_forces;
  real *before = work->law_pushes;
  int *members = work->law_members;
  if (pressing == 0) return;
  for (int q = 0; q < count; q++) {
    const int stage = q / pressing;
    const int k = members[q] = work->border_members[q % pressing];
    const touch *own = work->touches + k;
    forces[ROWS * q] = own->forces[stage];
    for (int a = 0; a < 2; a++) {
      forces[ROWS * q + 1 + a] = own->drags[stage][a];
      work->law_along[q][a] = work->stage_along[stage][k][a];
    }
    for (int row = 0; row < ROWS; row++) {
      const real *own_row = row_of(k, row, work);
      const real slide = row > 0 && rubs(own) ? work->stage_slides[stage][k][row - 1] : 0;
      const real present = row == 0 ? work->stage_gaps[stage][k] : slide;
      work->law_open[ROWS * q + row] =
          present - at_stage(stage, row, dot(own_row, solution), dot(own_row, solution + N), work->stretch_size);
    }
  }
  pushes_of(count, members, forces, before, work);
  for (int i = 0; i < order; i++) {
    for (int j = 0; j < order; j++) work->law_open[i] -= work->law_answers[j * order + i] * before[j];
  }
  memcpy(work->law_before, before, (size_t)order * sizeof *before);
  work->friction_lost = !settle_law(count, members, work);
  pushes_of(count, members, forces, work->law_pushes, work);
  for (int j = 0; j < ROWS * pressing; j++) {
    const real *response = response_of(work->border_members[j / ROWS], j % ROWS, work);
    real whole = 0, imaginary = 0;
    for (int stage = 0; stage < STAGES; stage++) {
      const int entry = stage * ROWS * pressing + j;
      const real change = work->law_pushes[entry] - work->law_before[entry];
      whole -= TO_EIGENVECTOR[stage][0] * change;
      imaginary -= TO_EIGENVECTOR[stage][1] * change;
    }
    for (int i = 0; i < N; i++) {
      solution[i] += response[i] * whole - response[N + i] * imaginary;
      solution[N + i] += response[i] * imaginary + response[N + i] * whole;
    }
  }
  for (int q = 0; q < count; q++) {
    touch *own = work->touches + members[q];
    own->forces[q / pressing] = forces[ROWS * q];
    memcpy(own->drags[q / pressing], forces + ROWS * q + 1, sizeof own->drags[0]);
    own->slips[q / pressing] = work->law_slips[q];
  }
}

/* Stores the friction of a touching section: the mean over a stretch, and its end as the guess of the next stretch. */
static void note_friction(int k, const section_gap *gap, workspace *work) {
  touch *own = work->touches + k;
  real tangents[2][3], force[2];
  real mean[2] = {0, 0};
  memset(own->drag, 0, sizeof own->drag);
  memset(own->friction, 0, sizeof own->friction);
  if (!own->presses || !rubs(own)) return;
  memcpy(own->drag, own->drags[STAGES - 1], sizeof own->drag);
  for (int stage = 0; stage < STAGES; stage++) {
    friction_of(own, work->stage_along[stage][k], own->drags[stage], force);
    for (int a = 0; a < 2; a++) mean[a] += STAGE_MATRIX[STAGES - 1][stage] * force[a];
  }
  both_tangents(gap->normal, own->axis, tangents);
  for (int i = 0; i < 3; i++) {
    own->friction[i] = FACING[own->facing].force_unit * (mean[0] * tangents[0][i] + mean[1] * tangents[1][i]);
  }
}

/* ---- Turns ---- */

/* Stores the slides of touching sections at the start of a stretch, after its blows. */
static void note_starts(const real *x, const real *v, const real *inputs, const real *rates, workspace *work) {
  instant *at = &work->at;
  memcpy(at->state, x, N * sizeof *x);
  memcpy(at->state + N, v, N * sizeof *v);
  memcpy(at->inputs, inputs, INPUTS * sizeof *inputs);
  memcpy(at->inputs + INPUTS, rates, INPUTS * sizeof *rates);
  for (int k = 0; k < work->touch_count; k++) {
    section_gap gap;
    if (!rubs(work->touches + k)) continue;
    follow_touch(work->touches + k, work->touches[k].place, at->state, at->inputs, &gap, work);
    note_slide(k, &gap, at->state, at->inputs, work);
    memcpy(work->start_slides[k], work->slides[k], sizeof work->start_slides[k]);
  }
}

/* Speeds of a section at the stages along its direction at the start, over its speed there; zero where it sticks.
   Returns zero if it does not press, or does not slide at the start. */
static int goes_on(int k, real size, real shares[STAGES], const workspace *work) {
  const touch *own = work->touches + k;
  const real *start = work->start_slides[k];
  const real square = inner_of_two(start, start);
  if (!own->presses || !rubs(own) || !(SQUARE_ROOT(square) * size > STANDS)) return 0;
  for (int stage = 0; stage < STAGES; stage++) {
    shares[stage] = own->slips[stage] ? inner_of_two(start, work->stage_slides[stage][k]) / square : 0;
  }
  return 1;
}

/* The share of a stretch, above one, after which the polynomial through these speeds at the stages is zero; at most
   most. */
static real stops_after(const real shares[STAGES], real most) {
  /* Quotients of differences over 0, 1/3 and 1. */
  const real first = (shares[0] - 1) / STAGE_NODES[0];
  const real second = ((shares[1] - shares[0]) / (1 - STAGE_NODES[0]) - first);
  const real slope = first - second * STAGE_NODES[0];
  const real root = slope * slope - 4 * second;
  /* The first root above zero. */
  const real stops = root >= 0 && slope < SQUARE_ROOT(root) ? 2 / (SQUARE_ROOT(root) - slope) : most;
  return stops > 1 ? (stops < most ? stops : most) : 1;
}

/* Factor on the size of a solved stretch so that it ends where a section comes to rest or turns back, since the law
   changes there: 1 if no section does, or if the stretch ends there already. The search shortens the stretch until all
   sections slide on, then extends it to the end of their slide, at most to the end of the step. */
static real size_to_the_turn(const step_start *start, real whole, real rest, turn_search *search, workspace *work) {
  int turned = 0;
  real shorter = MOST_OF_A_TURN, stops = search->turned_after / start->size;
  for (int k = 0; k < work->touch_count; k++) {
    real shares[STAGES];
    if (!goes_on(k, start->size, shares, work)) continue;
    if (shares[0] > 0 && shares[1] > 0) {
      if (search->turned_after > 0) stops = stops_after(shares, stops);
      continue;
    }
    turned = 1;
    const real lasts = shares[0] > 0 && shares[0] < 1 ? STAGE_NODES[0] / (1 - shares[0]) : STAGE_NODES[0];
    if (MOST_OF_A_TURN * lasts < shorter) shorter = MOST_OF_A_TURN * lasts;
  }
  if (!turned) {
    if (!(search->turned_after > 0)) return 1;
    search->is_aimed = 1;
    const real aimed = stops * (1 + BEYOND_TURN);
    return aimed * start->size < rest ? aimed : rest / start->size;
  }
  if (search->is_aimed || start->size * shorter < LEAST_OF_A_TURN * whole) return 1;
  search->turned_after = start->size;
  return shorter;
}

/* The share of a solved stretch after which a force comes to zero: it pulls at the end, but presses in the mean.
   Sections of a lying rod are left out, since rounding decides how they share its weight. A force that removes a rate
   of the gap left by the last stretch pulls at the end too, the more the shorter the stretch is: if this share falls
   from look to look, nothing lifts off. */
static real share_to_lift_off(turn_search *search, const workspace *work) {
  real share = 1;
  for (int k = 0; k < work->touch_count; k++) {
    const touch *own = work->touches + k;
    const real first = own->forces[0], last = own->forces[STAGES - 1];
    if (!own->presses || !(own->slides || FACING[own->facing].is_body) || !(first > 0 && last < 0)) continue;
    const real zero = STAGE_NODES[0] + (1 - STAGE_NODES[0]) * first / (first - last);
    if (zero < share) share = zero;
  }
  if (share <= search->lifted_after) return 1;
  search->lifted_after = share < 1 ? share : 0;
  return share;
}

#ifdef RODS_FACE_RODS
/* A touch, or the touch as the other rod sees it, with the place on that rod. */
static touch touch_of_side(const touch *own, int of_other) {
  touch side = *own;
  if (!of_other) return side;
  side.of_other = 1;
  side.place = own->other_place;
  side.end_place = own->other_end_place;
  side.other_end_place = own->end_place;
  return side;
}

#endif
/* Inward slope of a gap at an end of a rod after a share of a solved stretch: negative if the gap is smaller inside. */
static real slope_at_end(const step_start *start, real share, const touch *own, const real *unknowns, workspace *work) {
  const facing *faces = FACING + own->facing;
  section_gap gap;
  instant_in(start, share, unknowns, &work->at);
  positions_of(faces, work->at.state, work->at.inputs, work->nodes, work);
  fit_nodes(faces, work->nodes, work);
#ifdef RODS_FACE_RODS
  if (own->of_other) {
    /* The other rod is seen from the section that touches. */
    look_lowest(faces, own->other_end_place, &gap, work);
    faces = faces->other;
  }
#endif
  look_at(faces, own->end_place, &gap, work);
  return own->end_place > 0 ? -gap.slope : gap.slope;
}

/* The share of a solved stretch after which a sliding section runs out onto an end of the rod. It has no speed there,
   and a stretch beyond would take the energy of its slide. */
static real share_to_the_end(const step_start *start, const real *unknowns, workspace *work) {
  real share = 1;
#ifdef RODS_FACE_RODS
  for (int k = 0; k < 2 * work->touch_count; k++) {
    const touch side = touch_of_side(work->touches + k / 2, k % 2);
    const touch *own = &side;
#else
  for (int k = 0; k < work->touch_count; k++) {
    const touch *own = work->touches + k;
#endif
    const int is_out = own->end_place == 0 || own->end_place == 1;
    if (!own->presses || !own->slides || FACING[own->facing].is_body || !is_out || own->place == own->end_place) continue;
    const real first = slope_at_end(start, 0, own, unknowns, work), last = slope_at_end(start, 1, own, unknowns, work);
    if (!(first < 0) || !(last > -BEYOND_END * first)) continue;
    real low = 0, high = 1;
    while (high - low > BEYOND_END / 4) {
      const real middle = (low + high) / 2;
      if (slope_at_end(start, middle, own, unknowns, work) > 0) {
        high = middle;
      } else {
        low = middle;
      }
    }
    if (high < share) share = high;
  }
  return share;
}

/* Factor on the size of a stretch so that it ends where a section runs out onto an end, lifts off, comes to rest or
   turns back, after so many looks. A stretch with the factor one is accepted. */
static real to_the_turn(const step_start *start, real whole, real rest, const real *unknowns, turn_search *search,
                        workspace *work) {
  real share = 1;
  if (search->looks++ < LOOKS_FOR_A_TURN) {
    const real to_end = share_to_the_end(start, unknowns, work);
    share = share_to_lift_off(search, work);
    if (to_end < share) share = to_end;
    if (share < MOST_OF_A_LIFT_OFF && start->size * share > LEAST_OF_A_TURN * whole) {
      search->turned_after = 0;
      search->is_aimed = 0;
    } else {
      share = size_to_the_turn(start, whole, rest, search, work);
    }
  }
#ifdef STRETCHES_ARE_TOLD
  if (share == 1) tell_stretch(start, work);
#endif
  return share;
}

/* ---- In blows ---- */

/* Impulses of a blow: tries which touching sections are struck, first those without friction. */
static int settle_blow(const real *wanted, real still, workspace *work) {
  const int count = work->touch_count;
  const int all = ROWS * count;
  const real *answers = work->complex_answers[0];
  int *members = work->law_members;
  int *struck = work->law_slips + count;
  if (!least_pushes(work->compliance, wanted, count, still, work->pushes, work)) return 0;
  for (int k = 0; k < count; k++) struck[k] = work->pushes[k] > 0;
  for (int turn = 0; turn < LAW_TURNS; turn++) {
    int own = 0, worst = -1;
    real least = 0;
    for (int k = 0; k < count; k++) {
      if (struck[k]) members[own++] = k;
    }
    const int order = ROWS * own;
    for (int i = 0; i < order; i++) {
      const int k = members[i / ROWS];
      const int row = i % ROWS;
      work->law_open[i] = row == 0 ? wanted[k] : work->slides[k][row - 1];
      work->law_forces[i] = row == 0 ? work->pushes[k] : 0;
      for (int j = 0; j < order; j++) {
        work->law_answers[j * order + i] = answers[(ROWS * members[j / ROWS] + j % ROWS) * all + ROWS * k + row];
      }
      if (row == 0) memcpy(work->law_along[i / ROWS], work->along[k], sizeof work->along[k]);
    }
    if (own > 0 && !settle_law(own, members, work)) return 0;
    pushes_of(own, members, work->law_forces, work->law_pushes, work);
    memset(work->blow, 0, (size_t)all * sizeof *work->blow);
    for (int i = 0; i < order; i++) work->blow[ROWS * members[i / ROWS] + i % ROWS] = work->law_pushes[i];
    for (int q = 0; q < own; q++) {
      if (work->law_forces[ROWS * q] < least) {
        least = work->law_forces[ROWS * q];
        worst = members[q];
      }
    }
    for (int k = 0; k < count && least == 0; k++) {
      real opening = wanted[k];
      for (int j = 0; j < all; j++) opening += answers[j * all + ROWS * k] * work->blow[j];
      if (!struck[k] && opening < -still && (worst < 0 || opening < work->rates_after[worst])) worst = k;
      work->rates_after[k] = opening;
    }
    if (worst < 0) return 1;
    struck[worst] = !struck[worst];
  }
  return 0;
}

/* Energy that the impulses of a blow add, their work on the mean velocity, J; 0 at rounding. */
static real energy_given(const workspace *work) {
  const int all = ROWS * work->touch_count;
  real sum = 0, terms = 0;
  for (int i = 0; i < all; i++) {
    const facing *faces = FACING + work->touches[i / ROWS].facing;
    const real before = i % ROWS == 0 ? work->rates[i / ROWS] : work->slides[i / ROWS][i % ROWS - 1];
    real change = 0;
    for (int j = 0; j < all; j++) change += work->complex_answers[0][j * all + i] * work->blow[j];
    const real push = faces->force_unit * faces->length * work->blow[i];
    sum += push * (before + change / 2);
    terms += ABSOLUTE(push * before) + ABSOLUTE(push * change);
  }
  return ABSOLUTE(sum) > LAW_HOLDS * terms ? sum : 0;
}

/* Impulses of a blow with a share of its restitution. */
static int give_back(real share, real still, workspace *work) {
  for (int k = 0; k < work->touch_count; k++) {
    work->wanted[k] = share * wanted_of(k, still, work) + (1 - share) * work->rates[k];
  }
  return settle_blow(work->wanted, still, work);
}

/* Impulses of a blow with the largest share of its restitution that adds no energy; friction may make it less than
   one. */
static int give_most(real still, workspace *work) {
  real least = 0, most = 1;
  if (!give_back(most, still, work)) return 0;
  if (!(energy_given(work) > 0)) return 1;
  for (int narrowing = 0; narrowing < NARROWINGS; narrowing++) {
    const real share = (least + most) / 2;
    if (!give_back(share, still, work)) return 0;
    if (energy_given(work) > 0) {
      most = share;
    } else {
      least = share;
    }
  }
  return give_back(least, still, work);
}

/* A blow with friction: Newton's law of impact along normals and Coulomb's law along tangents, for velocities after
   it. */
static int strike_with_friction(instant *at, real still, const stage_factors *factors, workspace *work) {
  const int count = work->touch_count;
  const int all = ROWS * count;
  real *v = at->state + N;
  for (int k = 0; k < count; k++) {
    section_gap gap;
    follow_touch(work->touches + k, work->touches[k].place, at->state, at->inputs, &gap, work);
    note_slide(k, &gap, at->state, at->inputs, work);
    for (int row = 1; row < ROWS; row++) {
      respond_to(FACING + work->touches[k].facing, row_of(k, row, work), factors, response_of(k, row, work), work);
    }
  }
  for (int j = 0; j < all; j++) {
    for (int i = 0; i < all; i++) {
      work->complex_answers[0][j * all + i] = dot(row_of(i / ROWS, i % ROWS, work), response_of(j / ROWS, j % ROWS, work));
    }
  }
  if (!give_most(still, work)) return 0;
#ifdef STRETCHES_ARE_TOLD
  tell_blow(-energy_given(work), work);
#endif
  for (int j = 0; j < all; j++) {
    const real *response = response_of(j / ROWS, j % ROWS, work);
    for (int i = 0; i < N; i++) v[i] += work->blow[j] * response[i];
  }
  return all_finite(at->state, 2 * N);
}
