/* Stability of equilibria in exact contact: the second variation over the variations that contacts admit.

   Contacts that press are constraints, and the curvature of the gap times their force is in the Jacobian already. The place
   of a point of contact follows a variation; of the second variation of -N min d the part N (dd'/dx)^2 / d'' is left to add.
   cosserat_casadi/equilibrium/contact/contact_judgement.py does the same in Python.

   All arrangements are judged as one problem with FREE unknowns and HELD constraints; each surplus unknown of a
   smaller arrangement is fixed by a constraint. */

static const real NO_UNKNOWNS[N] = {0};

typedef struct {
  const arrangement *at;
  const contact_state *state;
  workspace *work;
  memory *room;
} problem;

/* Scale of each unknown of an arrangement, zero for multipliers: root of its energy unit times the factor from an
   element with moved ends to the nominal width, in which strains are measured. */
static void scale_unknowns(const arrangement *at, const real *z, real *scale) {
  memcpy(scale, at->roots, (size_t)at->unknowns * sizeof *scale);
  for (int rod = 0; rod < RODS; rod++) {
    const rod_elements *elements = at->rods + rod;
    real *own = scale + elements->first_strain;
    for (int c = 0; c < ROD[rod].components; c++) {
      for (int e = 0; e < elements->elements; e++) {
        const real width = end_of_element(at, z, rod, e + 1) - end_of_element(at, z, rod, e);
        for (int m = 0; m < at->modes[rod].modes[c]; m++) *own++ *= nominal_width(elements, e) / width;
      }
    }
  }
}

/* Writes a row of the Jacobian as the next constraint on the free unknowns. */
static int hold(const arrangement *at, int row, const real *scale, const workspace *work, int held, real *matrix) {
  for (int i = 0, free = 0; i < at->unknowns; i++) {
    if (scale[i] != 0) matrix[free++ * N + FREE + held] = work->jacobian[i * at->size + row] / scale[i];
  }
  return held + 1;
}

/* Adds the part of the second variation by the place of a point of contact, which slides as the rod moves. */
static void add_slide(const arrangement *at, int row, real stiffness, const real *scale, const workspace *work,
                      real *matrix) {
  for (int j = 0, column = 0; j < at->unknowns; j++) {
    if (scale[j] == 0) continue;
    for (int i = 0, free = 0; i < at->unknowns; i++) {
      if (scale[i] == 0) continue;
      const real share = work->jacobian[i * at->size + row] / scale[i];
      matrix[column * N + free++] += stiffness * share * work->jacobian[j * at->size + row] / scale[j];
    }
    column++;
  }
}

#ifdef RODS_TOUCH_RODS
/* Appends the constraints of two rods that press each other, whose rows of the Jacobian begin at one; the number of all
   constraints is returned. Both places slide if the second derivative of the gap by them is positive: three of its entries
   are given. The squares of the second variation by them are completed, in the rows of the Jacobian. */
static int hold_rods(const arrangement *at, int row, int moving, const real *bends, real stiffness, const real *scale,
                     workspace *work, int held, real *matrix) {
  const real first = bends[0], mixed = bends[1], last = bends[2];
  const real half = (first - last) / 2;
  const real least = moving > 1 ? (first + last) / 2 - sqrt(half * half + mixed * mixed) : first;
  const int slides = moving > 0 && least > FLAT;
  for (int i = 0; i < (slides ? 1 : 1 + moving); i++) held = hold(at, row + i, scale, work, held, matrix);
  if (!slides) return held;
  if (moving == 1) {
    add_slide(at, row + 1, stiffness / first, scale, work, matrix);
    return held;
  }
  for (int j = 0; j < at->unknowns; j++) {
    real *rows = work->jacobian + j * at->size + row;
    rows[1] -= mixed / last * rows[2];
  }
  add_slide(at, row + 2, stiffness / last, scale, work, matrix);
  add_slide(at, row + 1, stiffness / (first - mixed * mixed / last), scale, work, matrix);
  return held;
}

#endif
/* Appends constraints for the contacts that press; returns the number of all constraints. */
static int hold_contacts(const problem *judged, const real *scale, int held, real *matrix) {
  const arrangement *at = judged->at;
  const real *z = judged->state->z;
  workspace *work = judged->work;
  const real largest = largest_force(at, z);
#ifdef RODS_TOUCH_RODS
  real bends[3 * CONTACT_TOUCHES];
#else
  real bends[CONTACT_TOUCHES];
#endif
  int row = at->unknowns;
  call(at->bends, z, judged->state->inputs, bends, 0, work);
  for (int k = 0; k < at->touches; k++) {
    const contact_entry *entry = at->touch + k;
    const int rows = entry->ends + entry->moving + entry->along;
    const real force = z[at->unknowns + entry->first_force];
    const int presses = entry->is_line || force > PRESSING * largest;
#ifdef RODS_TOUCH_RODS
    if (other_rod(entry->obstacle) >= 0) {
      const real *own = bends + at->touches + 2 * k;
      const real three[3] = {bends[k], own[0], own[1]};
      const real stiffness = force * ROD[entry->rod].energy;
      if (presses) held = hold_rods(at, row, entry->moving, three, stiffness, scale, work, held, matrix);
      row += rows;
      continue;
    }
#endif
    const int slides = !entry->is_line && entry->moving && bends[k] > FLAT;
    for (int i = 0; presses && i < (slides ? 1 : rows); i++) held = hold(at, row + i, scale, work, held, matrix);
    if (presses && slides) add_slide(at, row + 1, force / bends[k] * ROD[entry->rod].energy, scale, work, matrix);
    row += rows;
  }
  return held;
}

static void jacobian_at(const problem *judged, const real *unused, real *matrix, real *residual) {
  const arrangement *at = judged->at;
  workspace *work = judged->work;
  real *scale = judged->room->scale;
  const int n = at->size;
  int free = 0, held = 0;
  (void)unused;
  memset(matrix, 0, N * N * sizeof *matrix);
  memset(residual, 0, N * sizeof *residual);
  scale_unknowns(at, judged->state->z, scale);
  work->jacobian_of = -1;
  call(at->jacobian, judged->state->z, judged->state->inputs, work->jacobian, 0, work);
  int place[CONTACT_UNKNOWNS]; /* of each unknown in the problem of all arrangements */
  for (int i = 0; i < at->unknowns; i++) place[i] = scale[i] != 0 ? free++ : FREE + held++;
  for (int j = 0; j < at->unknowns; j++) {
    for (int i = 0; i < at->unknowns; i++) {
      const real row = scale[i] != 0 ? scale[i] : 1, column = scale[j] != 0 ? scale[j] : 1;
      /* A balance has the unit of its energy, and the scale is the root of it; factors of widths count once on either
         side. */
      const real unit = scale[i] != 0 ? at->roots[i] * at->roots[i] / row : 1;
      matrix[place[j] * N + place[i]] = unit * work->jacobian[j * n + i] / column;
    }
  }
  held = hold_contacts(judged, scale, held, matrix);
  for (; free < FREE; free++) matrix[free * N + FREE + held++] = 1;
}

/* As in Python, no equivalent equilibrium is sought in contact: an equilibrium with a variation that costs no energy is
   critical. */
static int solve(const problem *judged, const real *x) {
  (void)judged;
  (void)x;
  return 0;
}

#include "second_variation.c"

contact_status contact_stability(const contact_state *state, workspace *work, memory *room, verdict_info *info) {
  if (!is_in_equilibrium(state, work)) return CONTACT_NOT_IN_EQUILIBRIUM;
  const problem judged = {ARRANGEMENT + state->arrangement, state, work, room};
  return stability(&judged, NO_UNKNOWNS, room, info);
}
