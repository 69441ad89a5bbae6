/* Search for an arrangement of contacts that holds: forces that pull and sections inside obstacles decide which
   arrangement is tried next. cosserat_casadi/equilibrium/contact/contact_search.py tries all arrangements in this way;
   here the search tries those of the library, up to a bounded number. */

enum { MOST_OPTIONS = 6 };

/* Replacement of a contact at fault: one or two contacts, or none. */
typedef struct {
  int count;
  touch touches[2];
} option;

typedef struct {
  int touch; /* number of the contact; -1 for a stretch inside an obstacle without a contact */
  int options;
  option option[MOST_OPTIONS];
} change;

/* Room for the contacts of an arrangement and those that may come. */
enum { TOUCH_ROOM = MOST_TOUCHES + 1 };

static touch point(int rod, int obstacle, real X) {
  const touch made = {.rod = rod, .obstacle = obstacle, .is_line = 0, .start = X, .end = X};
  return made;
}

static touch line(int rod, int obstacle, real start, real end) {
  const touch made = {.rod = rod, .obstacle = obstacle, .is_line = 1, .start = start, .end = end};
  return made;
}

static int comes_before(const touch *a, const touch *b) {
  if (a->rod != b->rod) return ROD[a->rod].rank < ROD[b->rod].rank;
  if (a->start != b->start) return a->start < b->start;
  return a->obstacle < b->obstacle;
}

/* Adds a contact in order; zero where there are more than any arrangement has. */
static int add_touch(candidate *to, touch added) {
  if (to->count == MOST_TOUCHES) return 0;
  int k = to->count;
  while (k > 0 && comes_before(&added, to->touches + k - 1)) {
    to->touches[k] = to->touches[k - 1];
    k--;
  }
  to->touches[k] = added;
  to->count++;
  return 1;
}

/* Writes the places of contacts into z. Returns zero if the arrangement has other contacts, or another order of them
   along a rod. */
static int set_places(const arrangement *at, const candidate *wanted, real *z) {
  if (at->touches != wanted->count) return 0;
  for (int k = 0; k < at->touches; k++) {
    const contact_entry *entry = at->touch + k;
    const touch *own = wanted->touches + k;
    const int moving = entry->is_line ? 1 + (own->end < 1) : own->start < 1;
    if (entry->rod != own->rod || entry->obstacle != own->obstacle) return 0;
#ifdef RODS_TOUCH_RODS
    if (other_rod(entry->obstacle) >= 0) {
      if (!set_places_of_rods(entry, own, z + at->unknowns + at->forces + entry->first_place)) return 0;
      continue;
    }
#endif
    if (entry->is_line != own->is_line || entry->moving != moving) return 0;
    real *places = z + at->unknowns + at->forces + entry->first_place;
    if (moving > 0) places[0] = own->start;
    if (moving > 1) places[1] = own->end;
  }
  return is_in_order(at, z);
}

static void offer(change *to, int count, touch first, touch second) {
  option *added = to->option + to->options++;
  added->count = count;
  added->touches[0] = first;
  added->touches[1] = second;
}

/* Adds the replacements of a contact that pulls. */
static void instead_of_pulling(touch own, change *made) {
  const touch first = point(own.rod, own.obstacle, own.start);
  const touch last = point(own.rod, own.obstacle, own.end);
  const touch between = point(own.rod, own.obstacle, (own.start + own.end) / 2);
  if (!own.is_line) {
    offer(made, 0, own, own);
    return;
  }
  offer(made, 2, first, last);
  offer(made, 1, between, between);
  offer(made, 1, first, first);
  offer(made, 1, last, last);
  if (own.end == 1) {
    /* A rod that curls up leaves before its tip. */
    const touch shorter = line(own.rod, own.obstacle, own.start, own.start + SHORTER * (own.end - own.start));
    offer(made, 1, shorter, shorter);
  }
}

/* Adds contacts that hold off a stretch inside an obstacle, further ones or in place of the contact beside it. */
static void instead_of_entering(const penetration *inside, const touch *beside, change *made) {
  const real here = inside->deepest < 1 - AT_TIP ? inside->deepest : 1;
  const touch deepest = point(inside->rod, inside->obstacle, here);
  if (!beside) {
    offer(made, 1, deepest, deepest);
    return;
  }
  const real start = smaller(inside->start, beside->start);
  const real end = larger(inside->end, beside->end);
  const touch lying = line(inside->rod, inside->obstacle, start, end);
  if (beside->is_line) {
    offer(made, 1, lying, lying);
    offer(made, 2, *beside, deepest);
  } else if (beside->end == 1) {
    /* A tip that lifts off leaves a section inwards to carry the rod, or the rod lies down. */
    const touch inwards = point(inside->rod, inside->obstacle, smaller(here, 1 - 2 * NEAR_CONTACT));
    offer(made, 1, inwards, inwards);
    offer(made, 1, lying, lying);
    offer(made, 2, inwards, *beside);
  } else {
    offer(made, 1, lying, lying);
    offer(made, 2, *beside, deepest);
    offer(made, 1, deepest, deepest);
  }
}

#ifdef RODS_TOUCH_RODS
/* Adds contacts that hold off a stretch of a rod inside another rod, further ones or in place of the contact beside it. */
static void instead_of_meeting(const arrangement *at, const real *z, const penetration *inside, const touch *beside,
                               change *made, workspace *work) {
  real position[3], place;
  position_at(at, z, work->nodes, inside->rod, inside->deepest, position);
  (void)gap_from_rod(at, z, inside->rod, inside->obstacle, position, inside->deepest, &place, work);
  const touch met = of_rods(inside->rod, inside->obstacle, at_end(inside->deepest), at_end(place));
  if (!beside) {
    offer(made, 1, met, met);
    return;
  }
  /* An end that lifts off leaves a section inwards to touch; two rods may touch at two places. */
  const int is_held = is_end(beside->start) || is_end(beside->other);
  if (is_held) offer(made, 1, met, met);
  offer(made, 2, *beside, met);
  if (!is_held) offer(made, 1, met, met);
}

/* Adds replacements of a contact of rods whose equations have no solution near by: at the other kind of place on either
   rod. */
static void instead_of_failing(touch own, change *made) {
  for (int ways = 1; ways < 4; ways++) {
    touch other = own;
    if (ways & 2) other.start = other.end = otherwise_at(own.start);
    if (ways & 1) other.other = otherwise_at(own.other);
    offer(made, 1, other, other);
  }
}

#endif
/* Queues a candidate to be tried next, or last; drops it if the queue is full. */
static void push(workspace *work, int next, const candidate *added) {
  if (work->waiting == CANDIDATES) return;
  if (next) {
    work->queue[work->waiting++] = *added;
    return;
  }
  memmove(work->queue + 1, work->queue, (size_t)work->waiting * sizeof *work->queue);
  work->queue[0] = *added;
  work->waiting++;
}

/* Writes the contacts of an arrangement with some replaced. Returns zero if no arrangement has so many. */
static int changed(const arrangement *at, const real *z, const change *changes, const int *chosen, int count, int from,
                   candidate *made) {
  made->count = 0;
  made->from = from;
  for (int k = 0; k < at->touches; k++) {
    int replaced = 0;
    for (int i = 0; i < count; i++) replaced |= changes[i].touch == k;
    if (!replaced && !add_touch(made, touch_at(at, z, k))) return 0;
  }
  for (int i = 0; i < count; i++) {
    const option *taken = changes[i].option + chosen[i];
    for (int k = 0; k < taken->count; k++) {
      if (!add_touch(made, taken->touches[k])) return 0;
    }
  }
  return 1;
}

/* Finds the faults of a solved arrangement. Returns the number of changes, zero if the arrangement holds, and gives the
   largest depth of a line of contact in its obstacle. */
static int find_faults(const arrangement *at, const real *z, change *changes, real *depth_of_lines, workspace *work) {
  penetration found[MOST_FAULTS];
  int is_pulling[TOUCH_ROOM] = {0};
  const real largest = largest_force(at, z);
  int count = 0;
  for (int k = 0; k < at->touches; k++) {
    if (pull_of(at, z, k, largest) <= ACCEPTED) continue;
    is_pulling[k] = 1;
    changes[count].touch = k;
    changes[count].options = 0;
    instead_of_pulling(touch_at(at, z, k), changes + count++);
  }
  const int inside = join_at_contacts(at, z, found, find_penetrations(at, z, ACCEPTED, found, work));
  for (int i = 0; i < inside && count < MOST_FAULTS; i++) {
    const int number = found[i].touch;
    touch beside;
    if (number >= 0) {
      beside = touch_at(at, z, number);
      /* Depth along a line of contact is the error of its polynomials, which no change of contacts mends. */
      if (beside.is_line && beside.start < found[i].deepest && found[i].deepest < beside.end) {
        *depth_of_lines = larger(*depth_of_lines, found[i].depth);
        continue;
      }
      if (is_pulling[number]) continue;
    }
    changes[count].touch = number;
    changes[count].options = 0;
#ifdef RODS_TOUCH_RODS
    if (other_rod(found[i].obstacle) >= 0) {
      instead_of_meeting(at, z, found + i, number < 0 ? 0 : &beside, changes + count++, work);
      continue;
    }
#endif
    instead_of_entering(found + i, number < 0 ? 0 : &beside, changes + count++);
  }
  return count;
}

/* Queues the replacements of an arrangement at fault; the likeliest is tried first. */
static void push_instead(const arrangement *at, const real *z, const change *changes, int count, int from,
                         workspace *work) {
  int chosen[MOST_FAULTS] = {0};
  candidate made;
  /* The queue is last in, first out: first each fault changed in another way, then all faults in the likeliest way. */
  for (int i = count - 1; i >= 0; i--) {
    for (int k = changes[i].options - 1; k > 0; k--) {
      chosen[i] = k;
      if (changed(at, z, changes, chosen, count, from, &made)) push(work, 1, &made);
    }
    chosen[i] = 0;
  }
  if (changed(at, z, changes, chosen, count, from, &made)) push(work, 1, &made);
}

/* Queues neighbours of contacts whose equations have no solution near by, to be tried last. */
static void push_beside(const candidate *failed, workspace *work) {
  for (int k = 0; k < failed->count; k++) {
    const touch own = failed->touches[k];
    change options = {.touch = k, .options = 0};
#ifdef RODS_TOUCH_RODS
    if (other_rod(own.obstacle) >= 0) {
      instead_of_failing(own, &options);
    } else
#endif
    if (own.is_line) {
      instead_of_pulling(own, &options);
    } else if (own.end == 1) {
      const touch inwards = point(own.rod, own.obstacle, 1 - 2 * NEAR_CONTACT);
      const touch lying = line(own.rod, own.obstacle, LIES_FROM, 1);
      offer(&options, 1, inwards, inwards);
      offer(&options, 1, lying, lying);
    } else {
      const touch tip = point(own.rod, own.obstacle, 1);
      offer(&options, 1, tip, tip);
    }
    offer(&options, 0, own, own);
    for (int i = 0; i < options.options; i++) {
      candidate made = {.count = 0, .from = failed->from};
      int fits = 1;
      for (int j = 0; j < failed->count; j++) {
        if (j != k) fits = fits && add_touch(&made, failed->touches[j]);
      }
      for (int j = 0; j < options.option[i].count; j++) fits = fits && add_touch(&made, options.option[i].touches[j]);
      if (fits) push(work, 0, &made);
    }
  }
}

/* Whether an arrangement was tried already from nearly equal places. */
static int was_tried(int number, const real *z, int tries, const workspace *work) {
  const arrangement *at = ARRANGEMENT + number;
  const int first = at->unknowns + at->forces;
  for (int k = 0; k < tries; k++) {
    if (work->tried[k].arrangement != number) continue;
    int alike = 1;
    for (int i = 0; i < at->places; i++) alike = alike && fabs(z[first + i] - work->tried[k].places[i]) < ALIKE;
    if (alike) return 1;
  }
  return 0;
}

/* Writes the guess of an arrangement with the wanted contacts; -1 if the library has none. */
static int guess(const candidate *wanted, const real *inputs, real *z, workspace *work) {
  const arrangement *from = ARRANGEMENT + work->solved[wanted->from].arrangement;
  const real *old = work->solved[wanted->from].z;
  for (int number = 0; number < ARRANGEMENTS; number++) {
    const arrangement *to = ARRANGEMENT + number;
    if (!set_places(to, wanted, z)) continue;
    if (to == from) {
      memcpy(z, old, (size_t)to->size * sizeof *z);
      (void)set_places(to, wanted, z);
      return number;
    }
    project(from, old, to, z);
    fit_forces(to, inputs, z, work);
    return number;
  }
  return -1;
}

/* Finds contacts that hold for these inputs, starting with the contacts of the last solution, solved[0]. Leaves the
   arrangement and z in solved[result] and the positions of the nodes in the workspace; returns -1 if none holds. */
static int settle(const real *inputs, int max_iterations, real *index, workspace *work, contact_info *info) {
  candidate first = {.count = 0, .from = 0};
  const arrangement *start = ARRANGEMENT + work->solved[0].arrangement;
  for (int k = 0; k < start->touches; k++) (void)add_touch(&first, touch_at(start, work->solved[0].z, k));
  work->waiting = 0;
  push(work, 1, &first);
  int tries = 0;
  int solved = 1;
  info->status = CONTACT_CONTACT_UNSETTLED;
  while (work->waiting > 0 && tries < TRIES && info->iterations < max_iterations) {
    const candidate next = work->queue[--work->waiting];
    real *z = work->solved[solved].z;
    const int number = guess(&next, inputs, z, work);
    if (number < 0 || was_tried(number, z, tries, work)) continue;
    const arrangement *at = ARRANGEMENT + number;
    work->tried[tries].arrangement = number;
    memcpy(work->tried[tries].places, z + at->unknowns + at->forces, (size_t)at->places * sizeof *z);
    tries++;
    info->tries++;
    const newton_result result = newton(at, inputs, z, max_iterations, work, info);
    info->residual_norm = result.residual_norm;
    if (result.status != CONTACT_CONVERGED) {
      push_beside(&next, work);
      continue;
    }
    work->solved[solved].arrangement = number;
    call(at->nodes, z, inputs, work->nodes, index, work);
    change changes[MOST_FAULTS + TOUCH_ROOM];
    real depth_of_lines = 0;
    const int faults = find_faults(at, z, changes, &depth_of_lines, work);
    if (faults == 0) {
      /* If polynomials do not follow the obstacle, the modes do not resolve the rod. */
      *index = larger(*index, depth_of_lines / ACCEPTED);
      info->status = CONTACT_CONVERGED;
      return solved;
    }
    push_instead(at, z, changes, faults < MOST_FAULTS ? faults : MOST_FAULTS, solved, work);
    solved++;
  }
  return -1;
}
