/* The error of an answer: its distance from the answer with the same contacts on more modes and intervals, and its
   depth in obstacles.

   cosserat_casadi/equilibrium/contact/contact_answer_error.py does the same in Python. */

enum { WATCHED = POSE_SIZE * CONTACT_WATCHED_POSES + CONTACT_WATCHED_CABLES };

/* Forces of contacts on the richer modes: forces at the ends stay, forces along lines get more coefficients. */
static void widen_forces(const arrangement *from, const real *old, const arrangement *to, real *z) {
  for (int k = 0; k < from->touches; k++) {
    const contact_entry *own = from->touch + k;
    const real *forces = old + from->unknowns + own->first_force;
    real *target = z + to->unknowns + to->touch[k].first_force;
    memcpy(target, forces, (size_t)(own->ends + own->along) * sizeof *target);
  }
}

/* The angle between two orientations, rad, from the chord c of their unit quaternions: 4 asin(c / 2). */
static real turn_between(const real *a, const real *b) {
  real minus = 0, plus = 0;
  for (int i = 0; i < 4; i++) {
    minus += (a[i] - b[i]) * (a[i] - b[i]);
    plus += (a[i] + b[i]) * (a[i] + b[i]);
  }
  return 4 * asin(smaller(sqrt(smaller(minus, plus)) / 2, 1));
}

/* The largest difference of watched poses and cables: positions and lengths over those of rods, orientations in rad. */
static real watched_distance(const arrangement *at, const real *z, const arrangement *richer, const real *fine,
                             const real *inputs, workspace *work) {
  real one[WATCHED];
  real other[WATCHED];
  real largest = 0;
  call(at->watched, z, inputs, one, 0, work);
  call(richer->watched, fine, inputs, other, 0, work);
  for (int k = 0; k < CONTACT_WATCHED_POSES; k++) {
    const int turned = 3 * CONTACT_WATCHED_POSES + 4 * k;
    real way[3];
    for (int i = 0; i < 3; i++) way[i] = one[3 * k + i] - other[3 * k + i];
    largest = larger(largest, larger(norm_of(way, 3), turn_between(one + turned, other + turned)));
  }
  for (int i = WATCHED - CONTACT_WATCHED_CABLES; i < WATCHED; i++) largest = larger(largest, fabs(one[i] - other[i]));
  return largest;
}

/* Whether only the place of a contact is inside the obstacle, as deep as Newton's method leaves the gap there; the
   slope of the gap from the section before does not matter. */
static int is_place_of(const penetration *inside, const touch *contact) {
  const real off = smaller(fabs(inside->start - contact->start), fabs(inside->end - contact->end));
  return inside->start == inside->end && off <= TOLERANCE;
}

/* Error of poses, places and forces because contacts hold only to a tolerance; the nodes stand in the workspace. It
   counts depth and angle of stretches inside obstacles beside lines of contact, their length beyond points of contact and
   between two, and forces that pull. */
static real unmet(const arrangement *at, const real *z, workspace *work) {
  penetration found[MOST_FAULTS];
  const real largest = largest_force(at, z);
  const int count = find_penetrations(at, z, SHALLOW, found, work);
  real off = 0;
  for (int k = 0; k < at->touches; k++) off = larger(off, largest * pull_of(at, z, k, largest));
  for (int i = 0; i < count; i++) {
    real first = 1, last = 0;
    int along = 0;
    int lines = 0;
    int left = 0;
    for (int k = 0; k < at->touches; k++) {
      const touch own = touch_at(at, z, k);
      if (own.rod != found[i].rod || own.obstacle != found[i].obstacle) continue;
      first = smaller(first, own.start);
      last = larger(last, own.end);
      lines |= own.is_line;
      left |= is_place_of(found + i, &own);
      along |= own.is_line && own.start < found[i].deepest && found[i].deepest < own.end;
    }
    if (along) continue;
    off = larger(off, larger(found[i].depth, left ? 0 : found[i].angle));
    if (first <= last && !lines) {
      off = larger(off, larger(first - found[i].start, found[i].end - last));
      off = larger(off, smaller(found[i].end, last) - larger(found[i].start, first));
    }
  }
  return off;
}

/* The largest difference of places and forces of contacts; forces count relative to the largest force, or to EI/l2. */
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
#ifdef RODS_TOUCH_RODS
    places = larger(places, fabs(one.other - other.other));
#endif
    for (int i = 3 * k; i < 3 * k + 3; i++) {
      difference = larger(difference, fabs(forces[i] - work->contact_forces[i]));
    }
    for (int i = 2 * k; i < 2 * k + entry->ends; i++) {
      difference = larger(difference, fabs(point_forces[i] - work->point_forces[i]));
    }
  }
  return at->touches ? larger(places, difference / unit) : 0;
}

/* Whether waves along an element do not show in the missing modes of a richer solution, which are not empty. Where
   the ends of an element move, its unloaded turn goes with its width; coordinates count the turn that loads add. */
static int is_blind(const arrangement *at, const real *z, const real *fine) {
  int blind = 0;
  int number = 0;
  for (int rod = 0; rod < RODS; rod++) {
    for (int e = 0; e < at->rods[rod].elements; e++) {
      const real width = end_of_element(at, z, rod, e + 1) - end_of_element(at, z, rod, e);
      blind |= hides_waves(at->turned, number++, width / nominal_width(at->rods + rod, e), z, fine);
    }
  }
  return blind;
}

/* Estimated error of an equilibrium, over the length. It is 1 if the same contacts do not hold on the richer modes, or
   if these do not see rods that loads roll up. */
static real estimated_error(int number, const real *z, const real *inputs, workspace *work) {
  const arrangement *at = ARRANGEMENT + number;
  const arrangement *richer = at + ARRANGEMENTS;
  real *fine = work->solved[1].z;
  real index[4];
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
  if (is_blind(at, z, fine)) return 1;
  const real of_poses = larger(unmet(richer, fine, work), watched_distance(at, z, richer, fine, inputs, work));
  const real distance = larger(of_poses, contact_distance(at, z, richer, fine, inputs, work));
  return isfinite(distance) ? ERROR_SAFETY * distance + ERROR_FLOOR : 1;
}

contact_status contact_error_estimate(const contact_state *state, real *error_estimate, workspace *work) {
  if (!is_in_equilibrium(state, work)) return CONTACT_NOT_IN_EQUILIBRIUM;
  *error_estimate = estimated_error(state->arrangement, state->z, state->inputs, work);
  return CONTACT_CONVERGED;
}
