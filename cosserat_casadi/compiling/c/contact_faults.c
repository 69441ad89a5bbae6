/* Faults of an arrangement of contacts: forces that pull, and stretches of rods inside an obstacle.
   cosserat_casadi/equilibrium/contact/contact_search.py looks for the same faults. */

enum { MOST_FAULTS = 16 };

/* A stretch of a rod that is inside an obstacle. */
typedef struct {
  int rod;
  int obstacle;
  real start;
  real end;
  real deepest;
  real depth;
  real angle; /* largest one between the rod and the obstacle, rad */
  int touch; /* number of its contact; -1 without one */
} penetration;

/* A contact of an arrangement at the places in z. */
static touch touch_at(const arrangement *at, const real *z, int number) {
  const contact_entry *entry = at->touch + number;
  const real *places = z + at->unknowns + at->forces + entry->first_place;
  touch made = {.rod = entry->rod, .obstacle = entry->obstacle, .is_line = entry->is_line, .start = 1, .end = 1};
#ifdef RODS_TOUCH_RODS
  if (other_rod(entry->obstacle) >= 0) return touch_of_rods(entry, places);
#endif
  if (entry->moving > 0) made.start = places[0];
  if (entry->ends == 1) made.end = made.start;
  else if (entry->moving > 1) made.end = places[1];
  return made;
}

/* The scale of forces: the largest force at a section or along a line, or EI/l2. The coefficients of a line are forces
   per length, which on a short line exceed any force. */
static real largest_force(const arrangement *at, const real *z) {
  real largest = 1;
  for (int number = 0; number < at->touches; number++) {
    const contact_entry *entry = at->touch + number;
    const real *forces = z + at->unknowns + entry->first_force;
    for (int i = 0; i < entry->ends; i++) largest = larger(largest, fabs(forces[i]));
    if (!entry->is_line) continue;
    const touch own = touch_at(at, z, number);
    real mean = 0;
    for (int k = 0; k <= SAMPLES; k++) {
      mean += fabs(polynomial(0, forces + entry->ends, entry->along, (real)k / SAMPLES)) / (SAMPLES + 1);
    }
    largest = larger(largest, mean * (own.end - own.start));
  }
  return largest;
}

/* The least force of a contact, at a section or along a line, relative to the largest force: there it opens first. If
   only `opening` ends count, the tip of a line is left out, since its force may be zero. */
static real least_force(const arrangement *at, const real *z, int number, real largest, int opening) {
  const contact_entry *entry = at->touch + number;
  const real *forces = z + at->unknowns + entry->first_force;
  real least = forces[0];
  if (entry->is_line) {
    const touch own = touch_at(at, z, number);
    if (!opening || entry->moving > 1) least = smaller(least, forces[1]);
    for (int k = 0; k <= SAMPLES; k++) {
      const real along = polynomial(0, forces + entry->ends, entry->along, (real)k / SAMPLES);
      least = smaller(least, along * (own.end - own.start));
    }
  }
  return least / largest;
}

/* The largest pull of a contact, relative to the largest force. */
static real pull_of(const arrangement *at, const real *z, int number, real largest) {
  return larger(-least_force(at, z, number, largest, 0), 0);
}

/* Gap of the section at an abscissa; the nodes stand in the workspace. */
static real gap_of_section(const arrangement *at, const real *z, const pair_entry *pair, real X, workspace *work) {
  real position[3];
  position_at(at, z, work->nodes, pair->rod, X, position);
#ifdef RODS_TOUCH_RODS
  real place;
  if (other_rod(pair->obstacle) >= 0) return gap_from_rod(at, z, pair->rod, pair->obstacle, position, X, &place, work);
#endif
  return gap_at(pair, position, X, work);
}

/* Abscissa of the least gap between two abscissae, by golden sections: J. Kiefer, Sequential minimax search for a
   maximum, Proc. AMS 4 (1953). */
static real lowest_between(const arrangement *at, const real *z, const pair_entry *pair, real first, real last,
                           workspace *work) {
  const real share = 0.38196601125010515;
  real inner[2] = {first + share * (last - first), last - share * (last - first)};
  real gaps[2];
  for (int i = 0; i < 2; i++) gaps[i] = gap_of_section(at, z, pair, inner[i], work);
  for (int k = 0; k < GOLDEN_SECTIONS; k++) {
    if (gaps[1] < gaps[0]) {
      first = inner[0];
      inner[0] = inner[1];
      gaps[0] = gaps[1];
      inner[1] = last - share * (last - first);
      gaps[1] = gap_of_section(at, z, pair, inner[1], work);
    } else {
      last = inner[1];
      inner[1] = inner[0];
      gaps[1] = gaps[0];
      inner[0] = first + share * (last - first);
      gaps[0] = gap_of_section(at, z, pair, inner[0], work);
    }
  }
  return (inner[0] + inner[1]) / 2;
}

/* Whether an abscissa is within a line of contact of this rod and obstacle. */
static int is_on_line(const arrangement *at, const real *z, const pair_entry *pair, real X) {
  for (int k = 0; k < at->touches; k++) {
    const touch own = touch_at(at, z, k);
    if (own.rod != pair->rod || own.obstacle != pair->obstacle || !own.is_line) continue;
    if (own.start <= X && X < own.end) return 1;
  }
  return 0;
}

/* Distance of an abscissa from the nearest end of its element. */
static real distance_from_end(const arrangement *at, const real *z, int rod, real X) {
  const int e = element_at(at, z, rod, X);
  const real before = X - end_of_element(at, z, rod, e);
  const real behind = end_of_element(at, z, rod, e + 1) - X;
  return before > 0 && behind > 0 ? smaller(before, behind) : 0;
}

/* Step along a rod to the next section to look at. A gap changes by at most the change of X, apart from stretch and
   taper of the rod. Steps are shorter beside ends of elements, where a lying rod starts to enter an obstacle. */
static real step_along(const arrangement *at, const real *z, const pair_entry *pair, real X, real gap) {
  if (is_on_line(at, z, pair, X)) return LOOKED_ALONG;
  const real least = smaller(larger(distance_from_end(at, z, pair->rod, X), BESIDE_END), CLOSEST);
  return smaller(larger(gap / FASTEST, least), FARTHEST);
}

/* Adds a section to the stretches inside obstacles; it joins the last stretch if the rod has not left the obstacle. */
static int add_inside(penetration *found, int count, int joins, const pair_entry *pair, real X, real depth, real angle) {
  if (joins) {
    penetration *own = found + count - 1;
    own->end = X;
    own->angle = larger(own->angle, angle);
    if (depth > own->depth) {
      own->depth = depth;
      own->deepest = X;
    }
    return count;
  }
  if (count == MOST_FAULTS) return count;
  const penetration begun = {pair->rod, pair->obstacle, X, X, X, depth, angle, -1};
  found[count] = begun;
  return count + 1;
}

/* Appends the stretches of one rod that are deeper inside one obstacle than admitted. Returns the number of all
   stretches. */
static int find_inside(const arrangement *at, const real *z, const pair_entry *pair, real admitted, penetration *found,
                       int count, workspace *work) {
  real X = first_section(pair->rod), before = X, before_last = X;
  real gap_before = HUGE_VAL, gap_before_last = HUGE_VAL;
  int is_inside = 0;
  for (;;) {
    const real gap = gap_of_section(at, z, pair, X, work);
    /* Between the last three sections the rod may enter for less than a step. */
    if (gap_before <= gap && gap_before <= gap_before_last && gap_before >= -admitted &&
        gap_before < FASTEST * (X - before_last) && !is_on_line(at, z, pair, before)) {
      const real lowest = lowest_between(at, z, pair, before_last, X, work);
      const real least = gap_of_section(at, z, pair, lowest, work);
      if (least < -admitted) count = add_inside(found, count, 0, pair, lowest, -least, 0);
    }
    const real angle = X > before ? fabs(gap - gap_before) / (X - before) : 0;
    if (is_inside) found[count - 1].angle = larger(found[count - 1].angle, angle);
    if (gap < -admitted) {
      count = add_inside(found, count, is_inside, pair, X, -gap, angle);
      if (count == MOST_FAULTS) return count;
    }
    is_inside = gap < -admitted;
    if (X == 1) return count;
    before_last = before;
    gap_before_last = gap_before;
    before = X;
    gap_before = gap;
    X = smaller(X + step_along(at, z, pair, X, gap), 1);
  }
}

/* Finds the stretches that are deeper inside obstacles than admitted; the nodes stand in the workspace. Returns their
   number. */
static int find_penetrations(const arrangement *at, const real *z, real admitted, penetration *found, workspace *work) {
  int count = 0;
#ifdef RODS_TOUCH_RODS
  sample_rods(at, z, work->nodes, work->samples[0]);
#endif
  for (int p = 0; p < PAIRS; p++) count = find_inside(at, z, PAIR + p, admitted, found, count, work);
  return count;
}

/* Assigns to each stretch inside an obstacle its contact, and joins the stretches at one contact. Returns their
   number. */
static int join_at_contacts(const arrangement *at, const real *z, penetration *found, int count) {
  int kept = 0;
  for (int i = 0; i < count; i++) {
    penetration own = found[i];
    for (int k = 0; k < at->touches && own.touch < 0; k++) {
      const touch other = touch_at(at, z, k);
      if (other.rod != own.rod || other.obstacle != own.obstacle) continue;
      if (other.start - NEAR_CONTACT <= own.end && own.start <= other.end + NEAR_CONTACT) own.touch = k;
    }
    int joined = 0;
    for (int j = 0; j < kept && own.touch >= 0; j++) {
      if (found[j].touch != own.touch) continue;
      found[j].start = smaller(found[j].start, own.start);
      found[j].end = larger(found[j].end, own.end);
      if (own.depth > found[j].depth) {
        found[j].depth = own.depth;
        found[j].deepest = own.deepest;
      }
      joined = 1;
    }
    if (!joined) found[kept++] = own;
  }
  return kept;
}

/* The least gap of a rod away from its contacts with this obstacle; the nodes stand in the workspace. */
static real least_gap(const arrangement *at, const real *z, const pair_entry *pair, workspace *work) {
  real least = HUGE_VAL;
  for (real X = first_section(pair->rod);;) {
    const real gap = gap_of_section(at, z, pair, X, work);
    int is_near_contact = 0;
    for (int k = 0; k < at->touches; k++) {
      const touch own = touch_at(at, z, k);
      if (own.rod != pair->rod || own.obstacle != pair->obstacle) continue;
      is_near_contact |= own.start - NEAR_CONTACT < X && X < own.end + NEAR_CONTACT;
    }
    if (!is_near_contact) least = smaller(least, gap);
    if (X == 1) return least;
    X = smaller(X + step_along(at, z, pair, X, gap), 1);
  }
}
