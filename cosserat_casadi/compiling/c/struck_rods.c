/* Another rod in the place of an obstacle, as exported steps and simulated motions have it: its nodes stand behind those of
   the own rod. cosserat_casadi/motion/rods_facing.py has the formulas. Includers say where is room for the point that the
   other rod is seen from, for the positions of its sections that are looked at first, and for a ball about those of each of
   its elements: seen_from_of, looked_at_of, balls_of. */

/* Distance of a section of the other rod from the point of view, with derivatives along that rod. */
static void surface_of_point(const real *from, const real *point, real *distance, real *normal, real *curvature) {
  real way[3];
  for (int i = 0; i < 3; i++) way[i] = point[i] - from[i];
  const real length = SQUARE_ROOT(inner(way, way));
  /* If both coincide, the direction is unknown. */
  *distance = length > NEXT_TO_NOTHING ? length : NEXT_TO_NOTHING;
  for (int i = 0; i < 3; i++) normal[i] = way[i] / *distance;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) curvature[3 * i + j] = ((i == j) - normal[i] * normal[j]) / *distance;
  }
}

static real way_between(const real *a, const real *b) {
  const real way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return SQUARE_ROOT(inner(way, way));
}

/* How far a point is outside of the ball about an element. */
static real way_to_ball(const facing *rod, int element, const real *point, workspace *work) {
  const real *ball = balls_of(rod, work) + 4 * element;
  (void)rod, (void)work;
  return way_between(ball, point) - ball[3];
}

/* Finds the section of a rod nearest to a point: first among the sections looked at, then next to that one. It begins
   with the element of the nearest ball, and skips elements whose balls are farther than the best section. */
static void find_nearest(const facing *rod, const real *point, section_gap *nearest, workspace *work) {
  const real taper = rod->radius_at_tip - rod->radius_at_base;
  const real widest = taper > 0 ? taper : 0;
  int first = 0, look = 0;
  real least = INFINITY;
  for (int e = 0; e < rod->elements; e++) {
    const real way = way_to_ball(rod, e, point, work);
    if (way < least) {
      least = way;
      first = e;
    }
  }
  least = INFINITY;
  for (int k = 0; k < rod->elements; k++) {
    const int e = (first + k) % rod->elements;
    if (way_to_ball(rod, e, point, work) - widest >= least) continue;
    for (int i = e * LOOKS; i <= (e + 1) * LOOKS; i++) {
      const real distance = way_between(looked_at_of(rod, work) + 3 * i, point) - taper * place_of_look(rod, i);
      if (!(distance < least)) continue;
      least = distance;
      look = i;
    }
  }
  memcpy(seen_from_of(rod, work), point, 3 * sizeof *point);
  look_lowest_by(rod, look, nearest, work);
}

/* Computes the positions of the sections of a rod that are looked at first, and a ball about those of each element: its
   centre is the middle section, its radius the largest distance from it. */
static void place_looks(const facing *rod, const real *nodes, workspace *work) {
  real *looked_at = looked_at_of(rod, work);
  (void)work;
  for (int i = 0; i <= rod->elements * LOOKS; i++) {
    const int e = i / LOOKS < rod->elements ? i / LOOKS : rod->elements - 1;
    const real *weights = rod->looks + (i - e * LOOKS) * rod->nodes;
    real *at = looked_at + 3 * i;
    at[0] = at[1] = at[2] = 0;
    for (int k = 0; k < rod->nodes; k++) {
      for (int j = 0; j < 3; j++) at[j] += weights[k] * nodes[3 * (e * rod->nodes + k) + j];
    }
  }
  for (int e = 0; e < rod->elements; e++) {
    real *ball = balls_of(rod, work) + 4 * e;
    memcpy(ball, looked_at + 3 * (e * LOOKS + LOOKS / 2), 3 * sizeof *ball);
    ball[3] = 0;
    for (int i = e * LOOKS; i <= (e + 1) * LOOKS; i++) {
      const real distance = way_between(ball, looked_at + 3 * i);
      if (distance > ball[3]) ball[3] = distance;
    }
  }
}

/* Sets the positions of the other rod, if there is one, for the searches that follow. */
static void fit_other(const facing *own, const real *nodes, workspace *work) {
  if (!own->other) return;
  const real *of_other = nodes + 3 * own->elements * own->nodes;
  fit_nodes(own->other, of_other, work);
  place_looks(own->other, of_other, work);
}

/* Whether a section of the other rod stays at an end of that rod. */
static int is_at_end(const other_section *other) { return other->place <= AT_END || other->place >= 1 - AT_END; }

/* Abscissa of the other section of a gap; 0 where there is none. */
static real place_on_other(const facing *own, const section_gap *gap) { return own->other ? gap->other.place : 0; }

/* Rate of the direction from the other section as that section slides. */
static void turned_by_sliding(const other_section *other, real *turned) {
  for (int i = 0; i < 3; i++) turned[i] = inner(other->curvature + 3 * i, other->tangent);
}

/* Evaluates the surface of the other rod at a point by its nearest section, which slides as the point moves. For a
   section of the other rod itself, the surface is the point of view. Returns zero for an obstacle. */
static int surface_of_rod(const facing *own, const real *point, real *distance, section_gap *gap, workspace *work) {
  const facing *rod = own->other;
  if (!rod) {
    if (own->surface) return 0;
    surface_of_point(seen_from_of(own, work), point, distance, gap->normal, gap->curvature);
    return 1;
  }
  section_gap nearest;
  find_nearest(rod, point, &nearest, work);
  memcpy(&gap->other, &nearest, sizeof gap->other);
  gap->other.first += own->elements * own->nodes;
  *distance = nearest.value * rod->length;
  for (int i = 0; i < 3; i++) gap->normal[i] = -nearest.normal[i];
  memcpy(gap->curvature, nearest.curvature, sizeof gap->curvature);
  if (is_at_end(&gap->other)) return 1;
  real turned[3];
  turned_by_sliding(&gap->other, turned);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) gap->curvature[3 * i + j] -= turned[i] * turned[j] / (nearest.bend * rod->length);
  }
  return 1;
}

static real distance_from_other(const facing *own, const real *point, workspace *work) {
  section_gap nearest;
  find_nearest(own->other, point, &nearest, work);
  return nearest.value * own->other->length;
}

/* Weights of its nodes for the section of the other rod, if there is one. */
static void weigh_other(const facing *own, section_gap *gap) {
  section_gap section;
  if (!own->other) return;
  section.place = gap->other.place;
  section.first = gap->other.first - own->elements * own->nodes;
  weigh_nodes(own->other, &section);
  memcpy(gap->other.rows, section.rows, sizeof section.rows);
}

/* Adds the weights of the other rod's nodes, if there is one, to the weights of a gap. */
static void add_other(const facing *own, const section_gap *gap, real times, real *weights) {
  const other_section *other = &gap->other;
  for (int i = 0; own->other && i < other->nodes; i++) {
    const real share = times * other->rows[0][i] / own->length;
    for (int k = 0; k < 3; k++) weights[3 * (other->first + i) + k] -= share * gap->normal[k];
  }
}

/* ---- How the other rod, if there is one, takes part in derivatives of a gap ---- */

/* Adds the other rod's part of a row of row_weights: minus its section along an axis, nothing for the slope along the
   first rod, its tangent along the normal for the last row. */
static void add_row_of_other(const facing *own, const section_gap *gap, int row, const real *direction, real *weights) {
  const other_section *other = &gap->other;
  if (!own->other || row == OWN_SLOPE) return;
  const int is_slope = row == OTHER_SLOPE;
  for (int i = 0; i < other->nodes; i++) {
    const real share = is_slope ? other->rows[1][i] : -other->rows[0][i];
    for (int k = 0; k < 3; k++) weights[3 * (other->first + i) + k] = share * direction[k];
  }
}

/* Adds to the derivatives of both slopes what the turning normal adds, from those of the way between both sections, where the
   section of the other rod slides. The curvature of the gap has in it that this section slides as the way changes. */
static void turn_slope_of_other(const facing *own, const section_gap *gap, real *moved) {
  const other_section *other = &gap->other;
  real turned[3];
  if (!own->other || is_at_end(other)) return;
  turned_by_sliding(other, turned);
  moved[OWN_SLOPE] -= inner(gap->tangent, turned) / (other->bend * own->other->length) * moved[OTHER_SLOPE];
  moved[OTHER_SLOPE] += inner(turned, moved);
}

/* Part of the second derivative of the distance by two numbers that move both sections, since the other section
   slides. */
static real turning_beside_other(const facing *own, const section_gap *gap, const real *moved, const real *more) {
  const other_section *other = &gap->other;
  real sum = 0;
  for (int k = 0; k < 3; k++) sum += moved[k] * inner(other->curvature + 3 * k, more);
  return is_at_end(other) ? sum : sum - moved[OTHER_SLOPE] * more[OTHER_SLOPE] / (other->bend * own->other->length);
}

/* ---- Friction ---- */

#ifdef CONTACT_RUBS
/* Writes weights of the other rod's nodes and its abscissa behind those of the own rod. */
static void put_other_section(const facing *own, const section_gap *gap, real *section) {
  const other_section *other = &gap->other;
  if (!own->other) return;
  memcpy(section + other->first, other->rows[0], (size_t)other->nodes * sizeof *section);
  section[point_count(own) + 1] = other->place;
}
#endif
