/* The error of an answer: its distance to that of the same contacts on modes and intervals added.

   cosserat_casadi/equilibrium/contact/contact_answer_error.py does the same in Python. */

/* Forces of contacts on the richer modes: those at the ends stay, and those along lines have coefficients more. */
static void widen_forces(const arrangement *from, const real *old, const arrangement *to, real *z) {
  for (int k = 0; k < from->touches; k++) {
    const contact_entry *own = from->touch + k;
    const real *forces = old + from->unknowns + own->first_force;
    real *target = z + to->unknowns + to->touch[k].first_force;
    memcpy(target, forces, (size_t)(own->ends + own->along) * sizeof *target);
  }
}

/* The angle between two orientations, rad: half of it has its sine at half of the chord of unit quaternions. */
static real turn_between(const real *a, const real *b) {
  real minus = 0, plus = 0;
  for (int i = 0; i < 4; i++) {
    minus += (a[i] - b[i]) * (a[i] - b[i]);
    plus += (a[i] + b[i]) * (a[i] + b[i]);
  }
  return 4 * asin(smaller(sqrt(smaller(minus, plus)) / 2, 1));
}

/* The largest difference of the poses of tips and bodies: positions over the length, orientations in rad. */
static real tip_distance(const arrangement *at, const real *z, const arrangement *richer, const real *fine,
                         const real *inputs, workspace *work) {
  real poses[POSE_SIZE * CONTACT_POSES];
  real largest = 0;
  call(at->tips, z, inputs, poses, 0, work);
  call(richer->tips, fine, inputs, work->poses, 0, work);
  for (int r = 0; r < POSES; r++) {
    const real *one = poses + POSE_SIZE * r;
    const real *other = work->poses + POSE_SIZE * r;
    real way[3];
    for (int i = 0; i < 3; i++) way[i] = one[i] - other[i];
    largest = larger(largest, norm_of(way, 3) / POSED_LENGTH[r]);
    largest = larger(largest, turn_between(one + 3, other + 3));
  }
  return largest;
}

/* The largest difference of places and forces of contacts; forces count relative to the largest, or to EI/l2. */
static real contact_distance(const arrangement *at, const real *z, const arrangement *richer, const real *fine,
                             const real *inputs, workspace *work) {
  real forces[3 * TOUCH_ROOM];
  real point_forces[2 * TOUCH_ROOM];
  real unit = 0, places = 0, difference = 0;
  call(at->contacts, z, inputs, forces, point_forces, work);
  call(richer->contacts, fine, inputs, work->contact_forces, work->point_forces, work);
  for (int k = 0; k < at->touches; k++) {
    const contact_entry *entry = at->touch + k;
    const touch one = touch_at(at, z, k);
    const touch other = touch_at(richer, fine, k);
    unit = larger(unit, larger(ROD[entry->rod].force_unit, norm_of(work->contact_forces + 3 * k, 3)));
    places = larger(places, larger(fabs(one.start - other.start), fabs(one.end - other.end)));
    for (int i = 3 * k; i < 3 * k + 3; i++) {
      difference = larger(difference, fabs(forces[i] - work->contact_forces[i]));
    }
    for (int i = 2 * k; i < 2 * k + entry->ends; i++) {
      difference = larger(difference, fabs(point_forces[i] - work->point_forces[i]));
    }
  }
  return at->touches ? larger(places, difference / unit) : 0;
}

/* Estimated error of an equilibrium; the whole length, 1, where the same contacts do not hold on the richer modes. */
static real estimated_error(int number, const real *z, const real *inputs, workspace *work) {
  const arrangement *at = ARRANGEMENT + number;
  const arrangement *richer = at + ARRANGEMENTS;
  real *fine = work->solved[1].z;
  real index[3];
  real depth_of_lines = 0;
  change changes[MOST_FAULTS + TOUCH_ROOM];
  contact_info info = no_result();
  memcpy(fine + richer->unknowns + richer->forces, z + at->unknowns + at->forces, (size_t)at->places * sizeof *z);
  project(at, z, richer, fine);
  widen_forces(at, z, richer, fine);
  work->jacobian_of = -1;
  if (newton(richer, inputs, fine, MAX_ITERATIONS, work, &info).status != CONTACT_CONVERGED) return 1;
  call(richer->nodes, fine, inputs, work->nodes, index, work);
  if (find_faults(richer, fine, changes, &depth_of_lines, work) > 0) return 1;
  const real of_tips = tip_distance(at, z, richer, fine, inputs, work);
  const real distance = larger(of_tips, contact_distance(at, z, richer, fine, inputs, work));
  return isfinite(distance) ? ERROR_SAFETY * distance + ERROR_FLOOR : 1;
}

contact_status contact_error_estimate(const contact_state *state, real *error_estimate, workspace *work) {
  if (!is_in_equilibrium(state, work)) return CONTACT_NOT_IN_EQUILIBRIUM;
  *error_estimate = estimated_error(state->arrangement, state->z, state->inputs, work);
  return CONTACT_CONVERGED;
}
