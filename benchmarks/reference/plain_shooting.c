/* Static equilibrium of a clamped rod under a dead tip wrench and its weight, by single shooting: the plain program.
 *
 * State along the rod, 13 numbers: position r, orientation Q (unit quaternion; R is its matrix), internal force n and
 * internal moment m, the last two in world axes. With dots for d/ds:
 *
 *     r' = R (e3 + diag(1/GAx, 1/GAy, 1/EA) R^T n)      r' = R e3 for Kirchhoff
 *     Q' = Q (0, K) / 2,  K = diag(1/EIx, 1/EIy, 1/GJ) R^T m
 *     n' = -weight,  m' = -r' x n
 *
 * The unknowns are n and m at the base. Newton with a halving line search finds those that leave the tip wrench at the
 * end; its Jacobian by forward differences takes six integrations, the trial point a seventh. SI units throughout; for
 * Newton, forces are measured in EI/L^2 and moments in EI/L.
 */
#include "common.h"

enum { UNKNOWNS = 6, MAX_ITERATIONS = 30, MAX_LOAD_STEPS = 200 };

static const double TOLERANCE = 1e-11;   /* on the end condition, relative to the load */
static const double DIFFERENCE = 1e-7;   /* of the forward differences */
static const double SHORTEST = 1.0 / 64; /* of the line search and of the load steps */

typedef struct {
    double x, y, z;
} Vector;

typedef struct {
    double w, x, y, z;
} Quaternion;

typedef struct {
    Vector r;
    Quaternion q;
    Vector n, m;
} State;

/* The columns of R. */
typedef struct {
    Vector x, y, z;
} Axes;

typedef struct {
    int shears, steps;
    double length;
    Vector weight;
    double bend_x, bend_y, twist, shear_x, shear_y, stretch; /* compliances */
    double units[UNKNOWNS];                                  /* of force and moment */
    double tip[UNKNOWNS];                                    /* force and moment there, in these units */
} Rod;

/* Vectors */

INLINE double dot(Vector a, Vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

INLINE Vector cross(Vector a, Vector b)
{
    const Vector c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return c;
}

/* a + h b */
INLINE Vector along(Vector a, double h, Vector b)
{
    const Vector c = {a.x + h * b.x, a.y + h * b.y, a.z + h * b.z};
    return c;
}

INLINE Axes axes_of(Quaternion q)
{
    const Axes R = {
        {1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y)},
        {2 * (q.x * q.y - q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + q.w * q.x)},
        {2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)},
    };
    return R;
}

/* q (0, v) */
INLINE Quaternion times(Quaternion q, Vector v)
{
    const Quaternion p = {-q.x * v.x - q.y * v.y - q.z * v.z, q.w * v.x + q.y * v.z - q.z * v.y,
                          q.w * v.y + q.z * v.x - q.x * v.z, q.w * v.z + q.x * v.y - q.y * v.x};
    return p;
}

/* Integration */

INLINE State rate(const Rod *rod, const State *s)
{
    const Axes R = axes_of(s->q);
    const Vector half_curvature = {0.5 * rod->bend_x * dot(R.x, s->m), 0.5 * rod->bend_y * dot(R.y, s->m),
                                   0.5 * rod->twist * dot(R.z, s->m)};
    State d;
    d.r = R.z;
    if (rod->shears) {
        d.r = along(d.r, rod->shear_x * dot(R.x, s->n), R.x);
        d.r = along(d.r, rod->shear_y * dot(R.y, s->n), R.y);
        d.r = along(d.r, rod->stretch * dot(R.z, s->n), R.z);
    }
    d.q = times(s->q, half_curvature);
    d.n.x = -rod->weight.x;
    d.n.y = -rod->weight.y;
    d.n.z = -rod->weight.z;
    d.m = cross(s->n, d.r);
    return d;
}

/* s + h d */
INLINE State after(const State *s, double h, const State *d)
{
    const State next = {
        along(s->r, h, d->r),
        {s->q.w + h * d->q.w, s->q.x + h * d->q.x, s->q.y + h * d->q.y, s->q.z + h * d->q.z},
        along(s->n, h, d->n),
        along(s->m, h, d->m),
    };
    return next;
}

/* Classical Runge-Kutta from base to tip. The norm of the quaternion keeps to the order of the method by itself. */
static State integrate(const Rod *rod, State s)
{
    const double h = rod->length / rod->steps;
    for (int i = 0; i < rod->steps; i++) {
        const State d1 = rate(rod, &s), s2 = after(&s, h / 2, &d1);
        const State d2 = rate(rod, &s2), s3 = after(&s, h / 2, &d2);
        const State d3 = rate(rod, &s3), s4 = after(&s, h, &d3);
        const State d4 = rate(rod, &s4);
        s = after(&s, h / 6, &d1);
        s = after(&s, h / 3, &d2);
        s = after(&s, h / 3, &d3);
        s = after(&s, h / 6, &d4);
    }
    return s;
}

/* Newton */

/* The tip for the base force and moment u, and what is left there beyond its load. Returns the size of that. */
static double shoot(const Rod *rod, const double *u, double *violation, State *tip)
{
    const double *unit = rod->units;
    const State base = {
        .q = {.w = 1},
        .n = {u[0] * unit[0], u[1] * unit[1], u[2] * unit[2]},
        .m = {u[3] * unit[3], u[4] * unit[4], u[5] * unit[5]},
    };
    *tip = integrate(rod, base);
    const double wrench[UNKNOWNS] = {tip->n.x, tip->n.y, tip->n.z, tip->m.x, tip->m.y, tip->m.z};
    double squares = 0;
    for (int i = 0; i < UNKNOWNS; i++) {
        violation[i] = wrench[i] / unit[i] - rod->tip[i];
        squares += violation[i] * violation[i];
    }
    return sqrt(squares);
}

/* From u to the solution; zero if it is not found. */
static int newton(const Rod *rod, double *u, State *tip, int *iterations)
{
    double violation[UNKNOWNS], jacobian[UNKNOWNS][UNKNOWNS], goal = TOLERANCE;
    for (int i = 0; i < UNKNOWNS; i++) {
        goal = fmax(goal, TOLERANCE * fabs(rod->tip[i]));
    }
    double size = shoot(rod, u, violation, tip);
    for (int i = 0; i < MAX_ITERATIONS && !(size <= goal); i++) {
        double moved[UNKNOWNS], shifted[UNKNOWNS], correction[UNKNOWNS];
        memcpy(moved, u, sizeof moved);
        for (int j = 0; j < UNKNOWNS; j++) {
            moved[j] = u[j] + DIFFERENCE * fmax(1, fabs(u[j]));
            shoot(rod, moved, shifted, tip);
            for (int k = 0; k < UNKNOWNS; k++) {
                jacobian[k][j] = (shifted[k] - violation[k]) / (moved[j] - u[j]);
            }
            moved[j] = u[j];
            correction[j] = -violation[j];
        }
        if (!eliminate(UNKNOWNS, jacobian, correction)) {
            return 0;
        }
        ++*iterations;
        const double before = size;
        for (double fraction = 1;; fraction /= 2) {
            if (fraction < SHORTEST) {
                return 0;
            }
            for (int j = 0; j < UNKNOWNS; j++) {
                moved[j] = u[j] + fraction * correction[j];
            }
            size = shoot(rod, moved, violation, tip);
            if (size < before) {
                break;
            }
        }
        memcpy(u, moved, sizeof moved);
    }
    return size <= goal;
}

/* Program */

/* The rod with a part of its loads. */
static Rod loaded(const Task *task, double part)
{
    const double L = task->length, moment = 0.5 * (task->bending_x + task->bending_y) / L, force = moment / L;
    Rod rod = {
        .shears = task->shears,
        .steps = task->steps,
        .length = L,
        .weight = {part * task->weight[0], part * task->weight[1], part * task->weight[2]},
        .bend_x = 1 / task->bending_x,
        .bend_y = 1 / task->bending_y,
        .twist = 1 / task->torsion,
        .shear_x = 1 / task->shear_x,
        .shear_y = 1 / task->shear_y,
        .stretch = 1 / task->extension,
        .units = {force, force, force, moment, moment, moment},
    };
    for (int i = 0; i < 3; i++) {
        rod.tip[i] = part * task->force[i] / force;
        rod.tip[i + 3] = part * task->moment[i] / moment;
    }
    return rod;
}

/* The base force and moment of the rod as if it stayed straight: its tip is at L e3, its weight acts at L e3 / 2. */
static void straight(const Rod *rod, double *u)
{
    const double scale = rod->length / rod->units[0];
    const double weight[3] = {scale * rod->weight.x, scale * rod->weight.y, scale * rod->weight.z};
    for (int i = 0; i < 3; i++) {
        u[i] = rod->tip[i] + weight[i];
    }
    u[3] = rod->tip[3] - (rod->tip[1] + weight[1] / 2);
    u[4] = rod->tip[4] + (rod->tip[0] + weight[0] / 2);
    u[5] = rod->tip[5];
}

/* From the straight rod with all of the load; where that fails, the load grows in steps. */
static void solve(const Task *task, Answer *answer)
{
    double u[UNKNOWNS], done = 0, increment = 1;
    State tip;
    answer->converged = answer->iterations = 0;
    for (int i = 0; i < MAX_LOAD_STEPS && done < 1; i++) {
        const double ahead = fmin(1, done + increment);
        const Rod rod = loaded(task, ahead);
        double found[UNKNOWNS];
        if (done > 0) {
            for (int k = 0; k < UNKNOWNS; k++) {
                found[k] = u[k] * ahead / done;
            }
        } else {
            straight(&rod, found);
        }
        if (newton(&rod, found, &tip, &answer->iterations)) {
            memcpy(u, found, sizeof u);
            done = ahead;
        } else if ((increment /= 2) < SHORTEST) {
            return;
        }
    }
    if (done < 1) {
        return;
    }
    answer->converged = 1;
    const Axes R = axes_of(tip.q);
    const double r[3] = {tip.r.x, tip.r.y, tip.r.z};
    const double rotation[3][3] = {{R.x.x, R.y.x, R.z.x}, {R.x.y, R.y.y, R.z.y}, {R.x.z, R.y.z, R.z.z}};
    memcpy(answer->tip, r, sizeof r);
    memcpy(answer->rotation, rotation, sizeof rotation);
}

int main(int argc, char **argv)
{
    return run(argc, argv, UNEQUAL_STIFFNESSES, solve);
}
