/* Steps of a simulated motion with friction of exact contact. Exported libraries have the same steps: step.c with
   contact_steps.c and contact_friction.c. Functions and tables of the model come from Python,
   cosserat_casadi/motion/rubbing_library.py, so one library serves all models of a size. A step is a sequence of
   stretches, cut at blows and where sliding stops or turns back; each stretch is written for Python. One motion steps at
   a time. */

/* Low optimisation: the user waits for this compilation, and most time of a step goes into functions of the model. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O1", "tree-loop-vectorize", "tree-slp-vectorize", "vect-cost-model=dynamic")
#endif

#define STEPS_IN_CONTACT
#define CONTACT_RUBS
#define STRETCHES_ARE_TOLD

#include "rubbing_steps.h"
#include "solver.h"
#include "python_kernels.c"

/* ---- The model ---- */

/* A touching section in a state. section holds the weights of the points, then the abscissa X, and that of another rod; the
   part of axis along the surface is the first tangent. */
typedef struct {
  const real *x;
  const real *inputs;
  const real *v;
  const real *rate;
  const real *section;
  const real *axis;
} rubbed;

#include "facings.c"

/* A model, and the stretches of its last step. */
typedef struct {
  int facing_count;
  const int *is_shape;
  const real *displacements;
  const facing *facings;
  kernel *residual;
  kernel *matrices; /* stiffness, damping and mass */
  real deepest;
  real farthest; /* way along a rod of a section that presses, in a stretch */
  /* Pairs of a gap and a push, of elastic stops and cables. */
  kernel *gaps; /* (x, inputs) -> gaps, then their gradients; null without pairs */
  int pair_count;
  const int *pair_rows;      /* of their equations, which are the entries of their pushes */
  const real *pair_softness; /* gap that a unit of a push closes */
  int *pair_closed;          /* whether a pair has no gap in the present stretch; else it has no push */
  real *told;     /* MOST_TOLD rows of TOLD_ROW numbers */
  int told_count; /* rows that the last step wrote */
} model;

static model *AT; /* the model of the present step */

static const real *INPUTS_JERK; /* change of the accelerations of inputs in the present step, units/s^3 */

#define FACINGS AT->facing_count
#define FACING AT->facings
#define IS_SHAPE AT->is_shape
#define DISPLACEMENTS AT->displacements
#define DEEPEST AT->deepest
#define FARTHEST AT->farthest

static void positions_of(const facing *own, const real *x, const real *inputs, real *positions, workspace *work) {
  (void)work;
  memcpy(positions, positions_at(own->points, x, inputs), (size_t)(3 * own->points->count) * sizeof *positions);
}

/* Results of a function of points; rate is null where the function has no rates of inputs. */
static void answer(kernel *function, const real *x, const real *inputs, const real *third, int third_count,
                   const real *rate, int count, real *result) {
  writing to = {function, 0, 0};
  put(&to, x, N);
  put(&to, inputs, INPUTS);
  put(&to, third, third_count);
  if (rate) put(&to, rate, INPUTS);
  memcpy(result, result_of(function, count), (size_t)count * sizeof *result);
}

static void velocities_of(const facing *own, const real *x, const real *inputs, const real *v, const real *rate,
                          real *velocities, workspace *work) {
  (void)work;
  answer(own->points->velocities, x, inputs, v, N, rate, 3 * own->points->count, velocities);
}

static void gradient_of(const facing *own, const real *x, const real *inputs, const real *weights, real *by_x,
                        workspace *work) {
  (void)work;
  answer(own->points->gradient, x, inputs, weights, 3 * own->points->count, 0, N, by_x);
}

static void hessian_of(const facing *own, const real *x, const real *inputs, const real *weights, real *by_x,
                       workspace *work) {
  (void)work;
  answer(own->points->hessian, x, inputs, weights, 3 * own->points->count, 0, N * N, by_x);
}

static void rubbing_of(const facing *own, const rubbed *at, real *sliding, real *by_velocity, real *along,
                       workspace *work) {
  writing to = {own->rubbing, 0, 0};
  (void)work;
  put(&to, at->x, N);
  put(&to, at->inputs, INPUTS);
  put(&to, at->v, N);
  put(&to, at->rate, INPUTS);
  put(&to, at->section, own->points->count + (own->other ? 2 : 1));
  put(&to, at->axis, 3);
  const real *found = result_of(own->rubbing, 4 + 2 * N);
  memcpy(sliding, found, 2 * sizeof *found);
  memcpy(by_velocity, found + 2, 2 * N * sizeof *found);
  memcpy(along, found + 2 + 2 * N, 2 * sizeof *found);
}

/* ---- Tables of a step: one dense block, column after column ---- */

#include "motion.h"

static const real TOLERANCE = 0;
static const real UNITS[N] = {0};

static int NUMBERS[MATRICES * STAGE_ENTRIES + 3 * INPUTS + 3 * N];
static int ENTRY_ROWS[STAGE_ENTRIES], ENTRY_COLUMNS[STAGE_ENTRIES], NO_FRONTS[STAGE_ENTRIES];
static const stage_front FRONT = {NUMBERS, 0, N, 0, 0};
static const elimination BY_FRONTS = {&FRONT, 0, NO_FRONTS, ENTRY_ROWS, ENTRY_COLUMNS, 1, 0, STAGE_ENTRIES};
#define AS_A_WHOLE BY_FRONTS

static void ask(kernel *function, const real *state, const real *inputs, int count, real *entries) {
  writing to = {function, 0, 0};
  put(&to, state, 3 * N);
  put(&to, inputs, 3 * INPUTS);
  memcpy(entries, result_of(function, count), (size_t)count * sizeof *entries);
}

/* Gaps of elastic stops and cables, then their gradients, column after column; null without any. */
static const real *gaps_at(const real *x, const real *inputs) {
  writing to = {AT->gaps, 0, 0};
  if (!AT->gaps) return 0;
  put(&to, x, N);
  put(&to, inputs, INPUTS);
  return result_of(AT->gaps, AT->pair_count * (1 + N));
}

static void residual_of(const real *state, const real *inputs, const real *factor, const real *constants, real *entries,
                        workspace *work) {
  (void)factor, (void)constants, (void)work;
  ask(AT->residual, state, inputs, N, entries);
  const real *gaps = gaps_at(state, inputs);
  for (int k = 0; k < AT->pair_count; k++) {
    const int row = AT->pair_rows[k];
    entries[row] = AT->pair_closed[k] ? -gaps[k] : AT->pair_softness[k] * state[row];
  }
}

static void matrices_of(const real *state, const real *inputs, const real *factor, const real *constants, real *entries,
                        workspace *work) {
  (void)factor, (void)constants, (void)work;
  ask(AT->matrices, state, inputs, MATRICES * STAGE_ENTRIES, entries);
  const real *gradients = gaps_at(state, inputs) + AT->pair_count;
  for (int k = 0; k < AT->pair_count; k++) {
    const int row = AT->pair_rows[k];
    for (int i = 0; i < N; i++) entries[i * N + row] = AT->pair_closed[k] ? -gradients[i * AT->pair_count + k] : 0;
    if (!AT->pair_closed[k]) entries[row * N + row] = AT->pair_softness[k];
  }
}

static const motion_part MOTION_RESIDUAL_PARTS[] = {{residual_of, NUMBERS, NUMBERS, 0, NUMBERS, 3 * N, 3 * INPUTS, N}};
static const motion_part MOTION_MATRIX_PARTS[] = {
    {matrices_of, NUMBERS, NUMBERS, 0, NUMBERS, 3 * N, 3 * INPUTS, MATRICES *STAGE_ENTRIES}};
#define MOTION_INPUT_PARTS MOTION_MATRIX_PARTS
enum { MOTION_RESIDUAL_PART_COUNT = 1, MOTION_MATRIX_PART_COUNT = 1, MOTION_INPUT_PART_COUNT = 0 };
static const int FEELS_ACCELERATION[INPUTS + 1] = {0};

#include "elimination.c"
#include "contact_ways.c"
#include "step.c"
#include "motion.c"

/* ---- Elastic stops and cables ---- */

/* The equations of the model hardly round the corner between a gap and a push, so that Newton's method with one
   Jacobian for a step does not pass it. Here each pair is closed or open in all of a stretch, as at its end. */

/* Finds which pairs are closed at a state; returns whether that is new. */
static int find_closed(const real *x, const real *inputs) {
  int is_new = 0;
  const real *gaps = gaps_at(x, inputs);
  for (int k = 0; k < AT->pair_count; k++) {
    const int closed = AT->pair_softness[k] * x[AT->pair_rows[k]] > gaps[k];
    is_new |= closed != AT->pair_closed[k];
    AT->pair_closed[k] = closed;
  }
  return is_new;
}

/* ---- Stretches that are told ---- */

enum {
  MOST_TOLD = CUTS,
  /* Head of a stretch: size, s; energy that its blow took, J; whether it has a blow; number of contacts. */
  HEAD = 4,
  /* Then x and v at the begin, unknowns of the stages, x, v and a at the end; powers that friction takes at the stages,
     and powers that moving inputs put in there, W. */
  OF_STRETCH = HEAD + 2 * N + STAGED + 3 * N + 2 * STAGES,
  /* Then each contact: facing; whether it slides, presses, slips, is struck; places at the begin and at the end; gap that
     it keeps; forces at the stages; axis of the tangents; friction at each stage along both tangents; impulse, N s. */
  OF_TOUCH = 18,
  TOLD_ROW = OF_STRETCH + OF_TOUCH * TOUCHES
};

/* Speed of a section times the size of the stretch, over the length, up to which the section counts as at rest. */
static const real AT_REST = (real)1e-10;

/* The blow at the begin of the present stretch: its energy, J, and impulses, N s. */
static real BLOW_TAKES;
static int IS_STRUCK;
static real IMPULSES[TOUCHES];
static int ARE_STRUCK[TOUCHES];

/* Keeps a blow for the row of the stretch that begins with it. */
static void tell_blow(real taken, const workspace *work) {
  BLOW_TAKES = taken;
  IS_STRUCK = 1;
  for (int k = 0; k < work->touch_count; k++) {
    IMPULSES[k] = work->blow[ROWS * k] * FACING[work->touches[k].facing].force_unit;
    ARE_STRUCK[k] = !work->touches[k].presses && IMPULSES[k] > 0;
  }
}

/* Whether a section slips in a stretch: it moves at the begin or the end, or has no friction. */
static int slips_in(int k, real size, const workspace *work) {
  const real *ends[2] = {work->start_slides[k], work->stage_slides[STAGES - 1][k]};
  if (!rubs(work->touches + k)) return 1;
  return SQUARE_ROOT(larger(inner_of_two(ends[0], ends[0]), inner_of_two(ends[1], ends[1]))) * size > AT_REST;
}

static real *tell(real *to, const real *values, int count) {
  memcpy(to, values, (size_t)count * sizeof *values);
  return to + count;
}

/* Writes the row of a solved stretch. */
static void tell_stretch(const step_start *start, workspace *work) {
  if (AT->told_count == MOST_TOLD) return;
  const real *unknowns = work->iterate;
  real *row = AT->told + AT->told_count++ * TOLD_ROW;
  const real head[HEAD] = {start->size, IS_STRUCK ? BLOW_TAKES : 0, IS_STRUCK, work->touch_count};
  real *to = tell(row, head, HEAD);
  to = tell(to, start->x, N);
  to = tell(to, start->v, N);
  to = tell(to, unknowns, STAGED);
  real *powers = to + 3 * N;
  real *put_in = powers + STAGES;
  for (int stage = 0; stage < STAGES; stage++) {
    stage_at(start, stage, unknowns, &work->at);
    push_in_stage(stage, &work->at, work->stage_residuals, work);
    powers[stage] = put_in[stage] = 0;
    for (int k = 0; k < work->touch_count; k++) {
      const touch *own = work->touches + k;
      const facing *faces = FACING + own->facing;
      real force[2];
      if (!own->presses || !rubs(own)) continue;
      friction_of(own, work->stage_along[stage][k], own->drags[stage], force);
      for (int a = 0; a < 2; a++) {
        const real push = force[a] * faces->force_unit * faces->length;
        const real slide = work->stage_slides[stage][k][a];
        /* A sticking point moves by rounding alone. */
        if (own->slips[stage]) powers[stage] -= push * slide;
        put_in[stage] -= push * (slide - dot(work->stage_slide_rows[stage][k][a], work->at.state + N));
      }
    }
  }
  /* The last stage is the end. */
  tell(to, work->at.state, 3 * N);
  to = put_in + STAGES;
  for (int k = 0; k < work->touch_count; k++) {
    const touch *own = work->touches + k;
    real friction[STAGES][2] = {{0}};
    for (int stage = 0; stage < STAGES && own->presses && rubs(own); stage++) {
      friction_of(own, work->stage_along[stage][k], own->drags[stage], friction[stage]);
    }
    const real of_touch[OF_TOUCH] = {own->facing,
                                     own->slides,
                                     own->presses,
                                     slips_in(k, start->size, work),
                                     IS_STRUCK && ARE_STRUCK[k],
                                     own->place,
                                     own->end_place,
                                     own->height,
                                     own->forces[0],
                                     own->forces[1],
                                     own->axis[0],
                                     own->axis[1],
                                     own->axis[2],
                                     friction[0][0],
                                     friction[0][1],
                                     friction[1][0],
                                     friction[1][1],
                                     IS_STRUCK ? IMPULSES[k] : 0};
    to = tell(to, of_touch, OF_TOUCH);
  }
  IS_STRUCK = 0;
}

/* ---- Memory from one motion to the next ---- */

enum {
  /* Numbers of a contact in carried memory: facing; whether it slides, presses; place, gap that it keeps, force, axis, drag. */
  OF_CARRIED_TOUCH = 11,
  CARRIED = 2 * STAGED + 2 * STAGE_ENTRIES + 2 + N + 3 + OF_CARRIED_TOUCH * TOUCHES
};

/* The next number of carried memory, and whether numbers are read into a memory; else they are written from one. */
typedef struct {
  real *next;
  int reads;
} carrying;

static void carry(carrying *row, real *own, int count) {
  if (row->reads) {
    memcpy(own, row->next, (size_t)count * sizeof *own);
  } else {
    memcpy(row->next, own, (size_t)count * sizeof *own);
  }
  row->next += count;
}

/* Numbers from a file are clipped to their range, so that no index leaves an array. */
static void carry_whole(carrying *row, int *own, int most) {
  real number = (real)*own;
  carry(row, &number, 1);
  *own = (int)clipped(number, 0, (real)most);
}

/* ---- For Python ---- */

/* Writes the memory of a motion into CARRIED numbers, or reads it from them, so that steps go on to the last bit. */
void rubbing_carry(const model *of, solver_step_memory *memory, real *numbers, int reads) {
  carrying row = {numbers, reads};
  carry(&row, memory->rows, N);
  carry(&row, memory->columns, N);
  carry(&row, memory->matrix, 2 * STAGE_ENTRIES);
  carry(&row, memory->unknowns, STAGED);
  carry(&row, &memory->size, 1);
  carry(&row, &memory->jacobian_size, 1);
  for (int i = 0; i < N; i++) carry_whole(&row, memory->pivots + i, N - 1);
  carry_whole(&row, &memory->as_a_whole, 1);
  carry_whole(&row, &memory->first_iterations, MAX_STEP_ITERATIONS);
  carry_whole(&row, &memory->touch_count, TOUCHES);
  for (int k = 0; k < memory->touch_count; k++) {
    solver_touch *own = memory->touches + k;
    carry_whole(&row, &own->facing, of->facing_count - 1);
    carry_whole(&row, &own->slides, 1);
    carry_whole(&row, &own->presses, 1);
    carry(&row, &own->place, 1);
    carry(&row, &own->height, 1);
    carry(&row, &own->force, 1);
    carry(&row, own->axis, 3);
    carry(&row, own->drag, 2);
  }
}

/* Writes 12 sizes: bytes of memory and workspace; MOST_TOLD; numbers of a row, a stretch, a contact; most contacts; CARRIED;
   bytes of the four records. */
void rubbing_sizes(long long *sizes) {
  const long long found[] = {sizeof(solver_step_memory), sizeof(workspace), MOST_TOLD, TOLD_ROW,
                             OF_STRETCH, OF_TOUCH, TOUCHES, CARRIED,
                             sizeof(model), sizeof(facing), sizeof(moving_points), sizeof(kernel)};
  memcpy(sizes, found, sizeof found);
}

/* Begins a motion with accelerations, of N numbers, and contacts that press. known has four numbers for each contact:
   facing, whether it slides, place, gap that it keeps. */
void rubbing_begin(solver_step_memory *memory, const real *accelerations, int count, const real *known) {
  memset(memory, 0, sizeof *memory);
  memcpy(memory->unknowns + N, accelerations, N * sizeof *accelerations);
  memory->touch_count = count < TOUCHES ? count : TOUCHES;
  for (int k = 0; k < memory->touch_count; k++, known += 4) {
    solver_touch *own = memory->touches + k;
    own->facing = (int)known[0];
    own->slides = known[1] != 0;
    own->presses = 1;
    own->place = own->end_place = known[2];
    own->height = known[3];
  }
}

/* Takes one step of the given size, s, as solver_step does, and writes its stretches into the model's rows. counts takes
   the numbers of iterations and Jacobians. */
int rubbing_step(model *of, const real *inputs, const real *rates, const real *accelerations, const real *jerks, real size,
                 solver_state *state, solver_step_memory *memory, workspace *work, int *counts) {
  AT = of;
  INPUTS_JERK = jerks;
  for (int i = 0; i < (int)(sizeof NUMBERS / sizeof *NUMBERS); i++) NUMBERS[i] = i;
  for (int k = 0; k < STAGE_ENTRIES; k++) {
    ENTRY_ROWS[k] = k % N;
    ENTRY_COLUMNS[k] = k / N;
  }
  const solver_step_options options = {STEP_TOLERANCE, STEP_ITERATIONS, 1, accelerations};
  solver_step_info info;
  of->told_count = 0;
  IS_STRUCK = 0;
  const solver_motion_status status = solver_step(inputs, rates, size, state, memory, &options, work, &info);
  counts[0] = info.iterations;
  counts[1] = info.jacobians;
  return status;
}
