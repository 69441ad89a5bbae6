/* Derivatives of steps in which what sticks goes on to stick, and what slips to slip, each at its stage. The law is a row for
   each tangent then: the slide is zero; or the drag turns with the slide, of which it is the opposite, and grows with the
   force along the normal. See contact_friction.c. */

/* Weight of a slipping drag against its slide; any share between zero and one works. */
static const real TURNING = (real)0.5;

/* Change of a force with that of the direction of the rod. */
static void friction_by_along(const touch *own, const real *along, const real *drag, const real *change, real *force) {
  const real *given = FACING[own->facing].coefficients;
  const real more = (inner_of_two(along, drag) > 0 ? given[1] : given[0]) - given[2];
  for (int a = 0; a < 2; a++) {
    force[a] = more * (inner_of_two(change, drag) * along[a] + inner_of_two(along, drag) * change[a]);
  }
}

/* Subtracts the change of the friction of a section by the numbers that move it from matrices of a stage: derivatives
   of slides, of the direction and of the force, with 4 + N rows; moved is null if these numbers move no section along
   the rod. */
static void take_friction(int stage, int m, const real *derivatives, const real *by_place, const real *shift, int columns,
                          real (*entries)[N], workspace *work) {
  const touch *own = work->part_touch + m;
  for (int j = 0; j < columns; j++) {
    const real *column = derivatives + (4 + N) * j;
    real change[4], by_along[2];
    for (int i = 0; i < 4; i++) change[i] = column[i] + shift[j] * by_place[i];
    friction_by_along(own, work->stage_along[stage][m], own->drags[stage], change + 2, by_along);
    for (int i = 0; i < N; i++) {
      entries[j][i] = column[4 + i] + shift[j] * by_place[4 + i] + by_along[0] * work->stage_slide_rows[stage][m][0][i] +
                      by_along[1] * work->stage_slide_rows[stage][m][1][i];
    }
    for (int a = 0; a < 2; a++) work->friction_changes[j][a] = change[a];
  }
}

/* Derivatives of the place of a section along the rod by the numbers that move it. */
static void shifts_of(const touch *own, const section_gap *gap, const real *moved, int columns, real *shift) {
  const int slides = own->slides && gap->place > 0 && gap->place < 1;
  for (int j = 0; j < columns; j++) {
    shift[j] = slides ? -moved[MOVED * j + 3] / (gap->bend * FACING[own->facing].length) : 0;
  }
}

#ifdef RODS_FACE_RODS
/* Writes the change of a section with the abscissa on the other rod behind that with the own one, as functions of friction
   take both. */
static void put_other_change(const facing *own, const section_gap *gap, real *change) {
  const other_section *other = &gap->other;
  const int count = point_count(own) + 2;
  if (!own->other) return;
  change[count - 1] = 0;
  change += count;
  memset(change, 0, (size_t)count * sizeof *change);
  memcpy(change + other->first, other->rows[1], (size_t)other->nodes * sizeof *change);
  change[count - 1] = 1;
}

/* Adds to derivatives of friction by numbers that move both sections, of 4 + N rows, what the section of the other rod adds
   as it slides with them. Follows turn_slopes and shifts_of, the second of which say how the own section slides. */
static void slide_other(const facing *own, const section_gap *gap, const real *moved, const real *shift, int columns,
                        real *derivatives, const workspace *work) {
  const other_section *other = &gap->other;
  const real *by_other = work->rubbing_by_place + 4 + N;
  real turned[3];
  if (!own->other || is_at_end(other)) return;
  turned_by_sliding(other, turned);
  for (int j = 0; j < columns; j++) {
    const real slope = moved[MOVED * j + OTHER_SLOPE] + inner(turned, gap->tangent) * shift[j];
    const real slid = slope / (other->bend * own->other->length);
    for (int i = 0; i < 4 + N; i++) derivatives[(4 + N) * j + i] += slid * by_other[i];
  }
}

#endif
/* Takes the change of the friction of a section that presses from the matrices of a stage, and notes that of its slide and
   the rows of the law. Follows the matrices of the gap, which say how the section moves. */
static void curve_friction(int stage, int m, const section_gap *gap, int by_inputs, workspace *work) {
  const touch *own = work->part_touch + m;
  const facing *faces = FACING + own->facing;
  const int count = point_count(faces);
  real *slide = work->stage_slides[stage][m];
  real force[2];
  memset(work->stage_slide_rows[stage][m], 0, sizeof work->stage_slide_rows[stage][m]);
  memset(work->slide_by_x[stage][m], 0, sizeof work->slide_by_x[stage][m]);
  memset(work->slide_by_inputs[stage][m], 0, sizeof work->slide_by_inputs[stage][m]);
  memset(work->slide_by_rates[stage][m], 0, sizeof work->slide_by_rates[stage][m]);
  slide[0] = slide[1] = 0;
  if (!rubs(own)) return;
  slide_at(own, gap, work->at.state, work->at.inputs, slide, work->stage_slide_rows[stage][m], work->stage_along[stage][m],
           work);
  friction_of(own, work->stage_along[stage][m], own->drags[stage], force);
  memset(work->section_change, 0, (size_t)count * sizeof *work->section_change);
  memcpy(work->section_change + gap->first, gap->rows[1], (size_t)gap->nodes * sizeof *work->section_change);
  work->section_change[count] = 1;
#ifdef RODS_FACE_RODS
  put_other_change(faces, gap, work->section_change);
#endif
  const rubbed at = section_of(own, gap, work->at.state, work->at.inputs, work);
  faces->rubbing_derivatives(&at, work->section_change, force, work->rubbing_by_x, work->rubbing_by_place,
                             work->rubbing_by_inputs, work->rubbing_by_rates, work);
  shifts_of(own, gap, work->moved, N, work->shift);
#ifdef RODS_FACE_RODS
  slide_other(faces, gap, work->moved, work->shift, N, work->rubbing_by_x, work);
#endif
  take_friction(stage, m, work->rubbing_by_x, work->rubbing_by_place, work->shift, N, work->friction_entries, work);
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    const int i = ENTRY_ROWS[k];
    work->matrices[stage][k] -= share_of(faces, i) * work->friction_entries[ENTRY_COLUMNS[k]][i];
  }
  for (int a = 0; a < 2; a++) {
    for (int i = 0; i < N; i++) work->slide_by_x[stage][m][a][i] = work->friction_changes[i][a];
  }
  if (!by_inputs) return;
  memset(work->shift, 0, sizeof work->shift);
  if (by_inputs_of(faces)) {
    move_by_inputs(own, gap, work->moved_by_inputs, work);
    shifts_of(own, gap, work->moved_by_inputs, INPUTS, work->shift);
#ifdef RODS_FACE_RODS
    slide_other(faces, gap, work->moved_by_inputs, work->shift, INPUTS, work->rubbing_by_inputs, work);
#endif
  }
  take_friction(stage, m, work->rubbing_by_inputs, work->rubbing_by_place, work->shift, INPUTS, work->friction_entries, work);
  for (int j = 0; j < INPUTS; j++) {
    for (int i = 0; i < N; i++) {
      work->input_matrices[stage][j * N + i] -= share_of(faces, i) * work->friction_entries[j][i];
    }
    for (int a = 0; a < 2; a++) {
      work->slide_by_inputs[stage][m][a][j] = work->friction_changes[j][a];
      work->slide_by_rates[stage][m][a][j] = work->rubbing_by_rates[2 * j + a];
    }
  }
}

/* Weights of the changes of slide, drag and normal force in the law of a section at a stage. */
static void law_of(int stage, int m, real by_slide[2][2], real by_drag[2][2], real by_force[2], const workspace *work) {
  const touch *own = work->part_touch + m;
  const real *drag = own->drags[stage];
  const real *slide = work->stage_slides[stage][m];
  const real length = SQUARE_ROOT(inner_of_two(drag, drag));
  const real speed = SQUARE_ROOT(inner_of_two(slide, slide));
  const int slips = rubs(own) && own->slips[stage];
  for (int a = 0; a < 2; a++) {
    by_force[a] = slips && length > 0 ? -drag[a] / length : 0;
    for (int b = 0; b < 2; b++) {
      const real across = (a == b) - (length > 0 ? drag[a] * drag[b] / (length * length) : 0);
      const real sticks = rubs(own) ? 0 : 1;
      by_slide[a][b] = slips ? (speed > 0 ? TURNING * length / speed * across : 0) : rubs(own) ? (a == b) : 0;
      by_drag[a][b] = slips ? (a == b) - TURNING * across : sticks * (a == b);
    }
  }
}

/* Changes of the gap and of both slides of a section at a stage with the unknowns of both. */
static void rows_of_stages(int stage, int m, const real *unknowns, real *rows, workspace *work) {
  const real size = work->stretch_size;
  rows[0] = gap_of_stages(stage, m, unknowns, work);
  for (int a = 0; a < 2; a++) {
    rows[1 + a] = 0;
    for (int t = 0; t < STAGES; t++) {
      rows[1 + a] += STAGE_MATRIX_SQUARED[stage][t] * dot(work->slide_by_x[stage][m][a], unknowns + t * N) +
                     STAGE_MATRIX[stage][t] / size * dot(work->stage_slide_rows[stage][m][a], unknowns + t * N);
    }
  }
}

/* Turns rows of gap and slides into rows of the law, in place. */
static void obey_law(real by_slide[2][2], real *rows) {
  const real slide[2] = {rows[1], rows[2]};
  for (int a = 0; a < 2; a++) rows[1 + a] = inner_of_two(by_slide[a], slide);
}

/* Response of gaps and the law at both stages to forces and drags at both stages, factorised. Returns zero if they
   depend on each other. */
static int border_stages(const stage_factors *factors, workspace *work) {
  const int count = work->part_pressing;
  const int order = ROWS * count * STAGES;
  for (int first = 0; first < order; first += FOUR) {
    real *columns = work->stage_solution;
    memset(columns, 0, FOUR * STAGED * sizeof *columns);
    for (int lane = 0; lane < FOUR && first + lane < order; lane++) {
      const int stage = (first + lane) / (ROWS * count);
      const int m = (first + lane) / ROWS % count;
      const int row = (first + lane) % ROWS;
      const touch *own = work->part_touch + m;
      real *column = columns + lane * STAGED + stage * N;
      real by_drag[2][2];
      if (row == 0) {
        for (int i = 0; i < N; i++) column[i] = share_of(FACING + own->facing, i) * work->stage_gradients[stage][m][i];
      } else if (rubs(own)) {
        coefficients_of(own, work->stage_along[stage][m], own->drags[stage], by_drag);
        for (int a = 0; a < 2; a++) {
          for (int i = 0; i < N; i++) {
            const real pushed = share_of(FACING + own->facing, i) * work->stage_slide_rows[stage][m][a][i];
            column[i] += by_drag[a][row - 1] * pushed;
          }
        }
      }
    }
    solve_stage_columns(factors, columns, work);
    for (int lane = 0; lane < FOUR && first + lane < order; lane++) {
      memcpy(work->border_responses[first + lane], columns + lane * STAGED, STAGED * sizeof *columns);
    }
  }
  real *matrix = work->law_matrix;
  for (int q = 0; q < STAGES * count; q++) {
    const int stage = q / count, m = q % count, row = ROWS * q;
    real by_slide[2][2], by_drag[2][2], by_force[2];
    real most = 0;
    law_of(stage, m, by_slide, by_drag, by_force, work);
    for (int j = 0; j < order; j++) {
      real *rows = matrix + j * order + row;
      rows_of_stages(stage, m, work->border_responses[j], rows, work);
      obey_law(by_slide, rows);
      if (j / ROWS == q) most = larger(most, larger(ABSOLUTE(rows[1]), ABSOLUTE(rows[2])));
    }
    /* Several sticking sections share the force that holds a rod which does not stretch. */
    const real yielding = most > 0 ? YIELDING * most : 1;
    const int sticks = rubs(work->part_touch + m) && !work->part_touch[m].slips[stage];
    for (int a = 0; a < 2; a++) {
      matrix[row * order + row + 1 + a] += by_force[a];
      for (int b = 0; b < 2; b++) {
        matrix[(row + 1 + b) * order + row + 1 + a] += by_drag[a][b] + (sticks && a == b ? yielding : 0);
      }
    }
  }
  return factorise_square(order, matrix, 0, work->law_pivots);
}

/* Corrects columns, computed without a change of the forces, so that gaps and slides change as wanted. */
static void close_stage_columns(real *columns, workspace *work) {
  const int count = work->part_pressing;
  const int order = ROWS * count * STAGES;
  for (int lane = 0; lane < FOUR && count > 0; lane++) {
    real *own = columns + lane * STAGED;
    real *values = work->law_values;
    for (int q = 0; q < STAGES * count; q++) {
      real by_slide[2][2], by_drag[2][2], by_force[2], rows[ROWS];
      law_of(q / count, q % count, by_slide, by_drag, by_force, work);
      rows_of_stages(q / count, q % count, own, rows, work);
      for (int row = 0; row < ROWS; row++) values[ROWS * q + row] = work->row_changes[lane][ROWS * q + row] - rows[row];
      obey_law(by_slide, values + ROWS * q);
    }
    solve_square(order, work->law_matrix, work->law_pivots, values);
    for (int j = 0; j < order; j++) {
      for (int i = 0; i < STAGED; i++) own[i] += values[j] * work->border_responses[j][i];
    }
  }
}

/* Minus the change of gaps and slides at both stages by a coordinate at the start, or by its rate. */
static void change_gaps_by_start(real size, int column, int lane, workspace *work) {
  const int count = work->part_pressing;
  const int of_rate = column >= N;
  for (int q = 0; q < STAGES * count; q++) {
    const int stage = q / count, m = q % count;
    const real share = of_rate ? STAGE_NODES[stage] * size : 1;
    real *rows = work->row_changes[lane] + ROWS * q;
    rows[0] = -share * work->stage_gradients[stage][m][column % N];
    for (int a = 0; a < 2; a++) {
      rows[1 + a] = -share * work->slide_by_x[stage][m][a][column % N];
      if (of_rate) rows[1 + a] -= work->stage_slide_rows[stage][m][a][column % N];
    }
  }
}

/* Minus the change of gaps and slides at both stages by an input, its rate or its acceleration. */
static void change_gaps_by_input(real size, int column, int lane, workspace *work) {
  const int count = work->part_pressing;
  const int inputs = INPUTS > 0 ? INPUTS : 1;
  const int order = column / inputs, input = column % inputs;
  for (int q = 0; q < STAGES * count; q++) {
    const int stage = q / count, m = q % count;
    const real time = STAGE_NODES[stage] * size;
    const real grown[ORDERS] = {1, time, time * time / 2};
    real *rows = work->row_changes[lane] + ROWS * q;
    rows[0] = INPUTS > 0 ? -grown[order] * work->gaps_by_inputs[stage][m * INPUTS + input] : 0;
    for (int a = 0; a < 2; a++) {
      rows[1 + a] = -grown[order] * work->slide_by_inputs[stage][m][a][input];
      if (order > 0) rows[1 + a] -= grown[order - 1] * work->slide_by_rates[stage][m][a][input];
    }
  }
}
