/* Derivatives of steps whose pressing contacts go on pressing: gaps are equations of both stages, with second
   derivatives of the gaps in the stiffness. See cosserat_casadi/motion/contact_gap.py for the formulas. */

#ifdef CONTACT_RUBS
static void curve_friction(int stage, int m, const section_gap *gap, int by_inputs, workspace *work);
#endif

/* Derivatives by inputs, at the instant in the workspace, of the sum of positions by its weights, and of its gradient; null
   where no input moves them. */
#define by_inputs_of(own) POINTS[(own)->points].by_inputs

/* move_section by inputs. */
static void move_by_inputs(const touch *own, const section_gap *gap, real *moved, workspace *work) {
  const facing *faces = FACING + own->facing;
  real *one = work->moved_row;
  for (int row = 0; row < MOVED; row++) {
    memset(work->weights, 0, (size_t)(3 * point_count(faces)) * sizeof *work->weights);
    row_weights(faces, gap, row, work->weights);
    by_inputs_of(faces)(work->at.state, work->at.inputs, work->weights, one, work->mixed, work);
    for (int j = 0; j < INPUTS; j++) moved[MOVED * j + row] = one[j];
  }
  turn_slopes(faces, gap, INPUTS, moved);
}

/* Subtracts the changes of the forces' directions from the matrices of a stage, and stores the derivatives of the
   gaps. */
static void curve_stage(int stage, int by_inputs, workspace *work) {
  for (int m = 0; m < work->part_pressing; m++) {
    const touch *own = work->part_touch + m;
    const facing *faces = FACING + own->facing;
    const int count = 3 * point_count(faces);
    const real force = own->forces[stage];
    section_gap gap;
    gradient_at(own, own->places[stage], work->at.state, work->at.inputs, &gap, work->stage_gradients[stage][m], work);
    curve_matrices(own, &gap, force, work->matrices[stage], work);
    for (int j = 0; j < INPUTS; j++) work->gaps_by_inputs[stage][m * INPUTS + j] = 0;
#ifdef CONTACT_RUBS
    curve_friction(stage, m, &gap, by_inputs, work);
#endif
    if (!by_inputs || !by_inputs_of(faces)) continue;
    move_by_inputs(own, &gap, work->moved_by_inputs, work);
    memset(work->weights, 0, (size_t)count * sizeof *work->weights);
    add_weights(faces, &gap, 1, work->weights);
    by_inputs_of(faces)(work->at.state, work->at.inputs, work->weights, work->gaps_by_inputs[stage] + m * INPUTS, work->mixed,
                        work);
    for (int j = 0; j < INPUTS; j++) {
      for (int i = 0; i < N; i++) {
        const real turned = turning(faces, &gap, own->slides, work->moved + MOVED * i, work->moved_by_inputs + MOVED * j);
        work->input_matrices[stage][j * N + i] -= force * share_of(faces, i) * (work->mixed[j * N + i] + turned);
      }
    }
  }
}

/* Change of a gap at a stage with the unknowns of both. */
static real gap_of_stages(int stage, int m, const real *unknowns, const workspace *work) {
  const real *gradient = work->stage_gradients[stage][m];
  const real *weights = STAGE_MATRIX_SQUARED[stage];
  return weights[0] * dot(gradient, unknowns) + weights[1] * dot(gradient, unknowns + N);
}

#ifdef CONTACT_RUBS
#include "friction_sensitivity.c"
#else
/* Response of the gaps at both stages to forces at both stages, factorised. Returns zero if gaps depend on each
   other. */
static int border_stages(const stage_factors *factors, workspace *work) {
  const int count = work->part_pressing;
  const int order = STAGES * count;
  for (int first = 0; first < order; first += FOUR) {
    real *columns = work->stage_solution;
    memset(columns, 0, FOUR * STAGED * sizeof *columns);
    for (int lane = 0; lane < FOUR && first + lane < order; lane++) {
      const int stage = (first + lane) / count;
      const int m = (first + lane) % count;
      real *column = columns + lane * STAGED + stage * N;
      for (int i = 0; i < N; i++) {
        column[i] = share_of(FACING + work->part_touch[m].facing, i) * work->stage_gradients[stage][m][i];
      }
    }
    solve_stage_columns(factors, columns, work);
    for (int lane = 0; lane < FOUR && first + lane < order; lane++) {
      memcpy(work->stage_responses[first + lane], columns + lane * STAGED, STAGED * sizeof *columns);
    }
  }
  for (int j = 0; j < order; j++) {
    for (int i = 0; i < order; i++) {
      work->border[j * order + i] = gap_of_stages(i / count, i % count, work->stage_responses[j], work);
    }
  }
  return factorise_square(order, work->border, 0, work->border_pivots);
}

/* Corrects columns, computed without a change of the forces, so that their gaps change as wanted. */
static void close_stage_columns(real *columns, workspace *work) {
  const int count = work->part_pressing;
  const int order = STAGES * count;
  for (int lane = 0; lane < FOUR && count > 0; lane++) {
    real *own = columns + lane * STAGED;
    real *values = work->border_values;
    for (int i = 0; i < order; i++) {
      values[i] = work->gap_changes[lane][i] - gap_of_stages(i / count, i % count, own, work);
    }
    solve_square(order, work->border, work->border_pivots, values);
    for (int j = 0; j < order; j++) {
      for (int i = 0; i < STAGED; i++) own[i] += values[j] * work->stage_responses[j][i];
    }
  }
}

/* Minus the change of the gaps at both stages by a coordinate at the start, or by its rate. */
static void change_gaps_by_start(real size, int column, int lane, workspace *work) {
  const int count = work->part_pressing;
  for (int stage = 0; stage < STAGES; stage++) {
    const real share = column >= N ? STAGE_NODES[stage] * size : 1;
    for (int m = 0; m < count; m++) {
      work->gap_changes[lane][stage * count + m] = -share * work->stage_gradients[stage][m][column % N];
    }
  }
}

/* Minus the change of the gaps at both stages by an input, its rate or its acceleration. */
static void change_gaps_by_input(real size, int column, int lane, workspace *work) {
  const int count = work->part_pressing;
  const int inputs = INPUTS > 0 ? INPUTS : 1;
  for (int stage = 0; stage < STAGES; stage++) {
    const real time = STAGE_NODES[stage] * size;
    const real grown[ORDERS] = {1, time, time * time / 2};
    for (int m = 0; m < count; m++) {
      const real by_input = INPUTS > 0 ? work->gaps_by_inputs[stage][m * INPUTS + column % inputs] : 0;
      work->gap_changes[lane][stage * count + m] = -grown[column / inputs] * by_input;
    }
  }
}

#endif

/* The touches that press in a part of a step. */
static void press_in_part(int number, workspace *work) {
  work->part_pressing = 0;
  for (int k = 0; k < work->part_counts[number]; k++) {
    if (work->part_touches[number][k].presses) work->part_touch[work->part_pressing++] = work->part_touches[number][k];
  }
}
