/* Static equilibrium of a clamped rod under a dead tip wrench and its weight, by single shooting: the tuned program.
 *
 * State along the rod: position r, orientation R, internal force n and internal moment m, the last two in world axes.
 * The tangent t is the last column of R. With dots for d/ds and w the curvature in world axes:
 *
 *     r' = R (e3 + diag(1/GA, 1/GA, 1/EA) R^T n)      Reissner; r' = t for Kirchhoff
 *     R' = w^ R,  w = R diag(1/EI, 1/EI, 1/GJ) R^T m
 *     n' = -weight,  m' = -r' x n
 *
 * The stiffnesses are equal in all directions of the section, so R diag(c, c, d) R^T v = c v + (d - c) (t.v) t: only
 * the tangent enters. Of R the columns t and a (local x) are integrated, the other is their cross product; a quaternion
 * instead takes a sixth longer for a step. Everything is dimensionless inside: lengths in L, forces in EI/L^2, moments
 * in EI/L.
 *
 * The unknowns are m and n at the base; Newton with a Jacobian by forward differences finds them. All trajectories of
 * an iteration advance together, one lane each, in loops of a fixed length that a compiler vectorises by itself,
 * provided that everything in them is inlined.
 */
#include "common.h"

/* 6: base moment and base force, as in a shooting code for any load. 3: the base force is known beforehand, since all
 * forces are dead, and only the moment is sought. */
#ifndef UNKNOWNS
#define UNKNOWNS 6
#endif
#if UNKNOWNS != 3 && UNKNOWNS != 6
#error "UNKNOWNS must be 3 or 6"
#endif

/* One lane for the point itself, one for each unknown, and for six unknowns a spare one that makes the number even. */
#define LANES (UNKNOWNS == 6 ? 8 : 4)

enum { MAX_ITERATIONS = 30, MAX_LOAD_STEPS = 200, COARSEST = 4 };

static const double TOLERANCE = 1e-11;   /* on the end condition, relative to the load */
static const double DIFFERENCE = 1e-7;   /* of the forward differences */
static const double SHORTEST = 1.0 / 64; /* of the line search and of the load steps */

typedef struct {
    double x, y, z;
} Vector;

/* Dimensionless; compliances in units of those of bending. */
typedef struct {
    int shears;
    int steps;
    double torsion, shear, extension;
    Vector force, moment, weight;
} Problem;

typedef struct {
    Vector r, t, a, m;
} State;

typedef struct {
    double rx[LANES], ry[LANES], rz[LANES];
    double tx[LANES], ty[LANES], tz[LANES];
    double ax[LANES], ay[LANES], az[LANES];
    double mx[LANES], my[LANES], mz[LANES];
    double nx[LANES], ny[LANES], nz[LANES];
} Batch;

/* The end condition at a point: violation, its size, and where `linearised` its Jacobian. The curvature is what Newton
 * last left of the size, over its square. */
typedef struct {
    int linearised;
    double violation[UNKNOWNS], jacobian[UNKNOWNS][UNKNOWNS], size, curvature;
    Vector r, t, a;
} Shot;

/* Vectors */

INLINE Vector vector(double x, double y, double z)
{
    const Vector v = {x, y, z};
    return v;
}

/* a + h b */
INLINE Vector along(Vector a, double h, Vector b)
{
    return vector(a.x + h * b.x, a.y + h * b.y, a.z + h * b.z);
}

INLINE double dot(Vector a, Vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

INLINE Vector cross(Vector a, Vector b)
{
    return vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static double largest(Vector a)
{
    return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
}

/* Integration */

INLINE State rate(const Problem *rod, const State *y, Vector n, const int shears)
{
    const Vector t = y->t, w = along(y->m, (rod->torsion - 1) * dot(t, y->m), t);
    State d;
    d.r = t;
    if (shears) {
        const double stretch = 1 + (rod->extension - rod->shear) * dot(t, n);
        d.r = vector(stretch * t.x + rod->shear * n.x, stretch * t.y + rod->shear * n.y,
                     stretch * t.z + rod->shear * n.z);
    }
    d.t = cross(w, t);
    d.a = cross(w, y->a);
    d.m = cross(n, d.r);
    return d;
}

/* y + h d; the position does not enter the rates, so the stages go without. */
INLINE State stage(const State *y, double h, const State *d)
{
    const State s = {y->r, along(y->t, h, d->t), along(y->a, h, d->a), along(y->m, h, d->m)};
    return s;
}

/* a + 2 b + 2 c + d */
INLINE Vector weighted(Vector a, Vector b, Vector c, Vector d)
{
    return vector(a.x + 2 * (b.x + c.x) + d.x, a.y + 2 * (b.y + c.y) + d.y, a.z + 2 * (b.z + c.z) + d.z);
}

/* One step of the classical Runge-Kutta method in each lane. The rate of n is constant, its step therefore exact. */
INLINE void step(const Problem *rod, Batch *b, double h, const int lanes, const int shears)
{
    const double half = 0.5 * h, sixth = h / 6;
    const Vector weight = rod->weight;
    for (int k = 0; k < lanes; k++) {
        const State y = {{b->rx[k], b->ry[k], b->rz[k]},
                         {b->tx[k], b->ty[k], b->tz[k]},
                         {b->ax[k], b->ay[k], b->az[k]},
                         {b->mx[k], b->my[k], b->mz[k]}};
        const Vector start = {b->nx[k], b->ny[k], b->nz[k]};
        const Vector middle = along(start, -half, weight), end = along(start, -h, weight);

        const State d1 = rate(rod, &y, start, shears);
        const State y2 = stage(&y, half, &d1);
        const State d2 = rate(rod, &y2, middle, shears);
        const State y3 = stage(&y, half, &d2);
        const State d3 = rate(rod, &y3, middle, shears);
        const State y4 = stage(&y, h, &d3);
        const State d4 = rate(rod, &y4, end, shears);

        const Vector r = along(y.r, sixth, weighted(d1.r, d2.r, d3.r, d4.r));
        const Vector t = along(y.t, sixth, weighted(d1.t, d2.t, d3.t, d4.t));
        const Vector a = along(y.a, sixth, weighted(d1.a, d2.a, d3.a, d4.a));
        const Vector m = along(y.m, sixth, weighted(d1.m, d2.m, d3.m, d4.m));
        b->rx[k] = r.x, b->ry[k] = r.y, b->rz[k] = r.z;
        b->tx[k] = t.x, b->ty[k] = t.y, b->tz[k] = t.z;
        b->ax[k] = a.x, b->ay[k] = a.y, b->az[k] = a.z;
        b->mx[k] = m.x, b->my[k] = m.y, b->mz[k] = m.z;
        b->nx[k] = end.x, b->ny[k] = end.y, b->nz[k] = end.z;
    }
}

INLINE void march(const Problem *rod, Batch *b, const int lanes, const int shears)
{
    const double h = 1.0 / rod->steps;
    for (int i = 0; i < rod->steps; i++) {
        step(rod, b, h, lanes, shears);
    }
}

static void integrate(const Problem *rod, Batch *b, int together)
{
    if (together && rod->shears) {
        march(rod, b, LANES, 1);
    } else if (together) {
        march(rod, b, LANES, 0);
    } else if (rod->shears) {
        march(rod, b, 1, 1);
    } else {
        march(rod, b, 1, 0);
    }
}

/* End condition */

static void at_base(const Problem *rod, double load, const double *u, Batch *b, int lane)
{
    double *const m[3] = {b->mx, b->my, b->mz}, *const n[3] = {b->nx, b->ny, b->nz};
    const double known[3] = {load * (rod->force.x + rod->weight.x), load * (rod->force.y + rod->weight.y),
                             load * (rod->force.z + rod->weight.z)};
    b->rx[lane] = b->ry[lane] = b->rz[lane] = 0;
    b->tx[lane] = b->ty[lane] = b->ay[lane] = b->az[lane] = 0;
    b->tz[lane] = b->ax[lane] = 1;
    for (int i = 0; i < 3; i++) {
        m[i][lane] = u[i];
        n[i][lane] = UNKNOWNS == 6 ? u[(i + 3) % UNKNOWNS] : known[i];
    }
}

static void violation_of(const Problem *rod, double load, const Batch *b, int lane, double *violation)
{
    const double all[6] = {b->mx[lane] - load * rod->moment.x, b->my[lane] - load * rod->moment.y,
                           b->mz[lane] - load * rod->moment.z, b->nx[lane] - load * rod->force.x,
                           b->ny[lane] - load * rod->force.y,  b->nz[lane] - load * rod->force.z};
    memcpy(violation, all, UNKNOWNS * sizeof *violation);
}

static void shoot(const Problem *rod, double load, const double *u, int linearised, Shot *shot)
{
    Problem loaded = *rod;
    loaded.weight = vector(load * rod->weight.x, load * rod->weight.y, load * rod->weight.z);
    Batch b;
    double moved[UNKNOWNS], increment[UNKNOWNS];
    memcpy(moved, u, sizeof moved);
    at_base(rod, load, u, &b, 0);
    if (linearised) {
        for (int j = 0; j < UNKNOWNS; j++) {
            moved[j] = u[j] + DIFFERENCE * fmax(1, fabs(u[j]));
            increment[j] = moved[j] - u[j];
            at_base(rod, load, moved, &b, j + 1);
            moved[j] = u[j];
        }
        for (int lane = UNKNOWNS + 1; lane < LANES; lane++) {
            at_base(rod, load, u, &b, lane);
        }
    }
    integrate(&loaded, &b, linearised);

    violation_of(rod, load, &b, 0, shot->violation);
    shot->linearised = linearised;
    shot->size = 0;
    for (int i = 0; i < UNKNOWNS; i++) {
        shot->size += shot->violation[i] * shot->violation[i];
    }
    shot->size = sqrt(shot->size);
    shot->r = vector(b.rx[0], b.ry[0], b.rz[0]);
    shot->t = vector(b.tx[0], b.ty[0], b.tz[0]);
    shot->a = vector(b.ax[0], b.ay[0], b.az[0]);
    if (linearised) {
        for (int j = 0; j < UNKNOWNS; j++) {
            double column[UNKNOWNS];
            violation_of(rod, load, &b, j + 1, column);
            for (int i = 0; i < UNKNOWNS; i++) {
                shot->jacobian[i][j] = (column[i] - shot->violation[i]) / increment[j];
            }
        }
    }
}

/* Newton */

/* Newton with halved steps where the violation does not fall. A shot with its Jacobian takes three to four times as
 * long as one without, so both are computed at once unless the last contraction promises that the next shot ends it. */
static int newton(const Problem *rod, double load, double *u, Shot *shot, int *iterations)
{
    const double scale = fmax(1, load * fmax(largest(rod->force), largest(rod->moment)));
    const double goal = TOLERANCE * scale;
    shoot(rod, load, u, 1, shot);
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        if (shot->size <= goal) {
            return 1;
        }
        if (!shot->linearised) {
            shoot(rod, load, u, 1, shot);
        }
        double correction[UNKNOWNS], trial[UNKNOWNS];
        for (int k = 0; k < UNKNOWNS; k++) {
            correction[k] = -shot->violation[k];
        }
        if (!eliminate(UNKNOWNS, shot->jacobian, correction)) {
            return 0;
        }
        ++*iterations;
        const double before = shot->size;
        const int last = before * (shot->curvature * before + DIFFERENCE) <= goal;
        for (double fraction = 1;; fraction /= 2) {
            if (fraction < SHORTEST) {
                return 0;
            }
            for (int k = 0; k < UNKNOWNS; k++) {
                trial[k] = u[k] + fraction * correction[k];
            }
            shoot(rod, load, trial, !last, shot);
            if (shot->size < before) {
                break;
            }
        }
        memcpy(u, trial, sizeof trial);
        shot->curvature = shot->size / (before * before);
    }
    return 0;
}

/* The base moment of the straight rod, with a shorter lever where the load is large: in the plane, m^2 / 2 + n.t is
 * constant along an elastica, hence m <= sqrt(2 f) at its base under a transverse tip force f; this and the lever of
 * the straight rod, m = f, are the ends of m = f / (1 + f^2 / 4)^(1/4). */
static Vector base_moment(const Problem *rod)
{
    const Vector e3 = {0, 0, 1};
    const Vector straight = cross(e3, along(rod->force, 0.5, rod->weight));
    return along(rod->moment, 1 / sqrt(sqrt(1 + dot(straight, straight) / 4)), straight);
}

/* From a guess at the base; in steps of the load if Newton fails on all of it. */
static int follow(const Problem *rod, double *u, Shot *shot, int *iterations)
{
    const Vector n = along(rod->force, 1, rod->weight), m = base_moment(rod);
    const double guess[6] = {m.x, m.y, m.z, n.x, n.y, n.z};
    double done = 0, increment = 1;
    for (int i = 0; i < MAX_LOAD_STEPS; i++) {
        const double ahead = fmin(1, done + increment);
        double found[UNKNOWNS];
        for (int k = 0; k < UNKNOWNS; k++) {
            found[k] = done > 0 ? u[k] * ahead / done : guess[k] * ahead;
        }
        if (newton(rod, ahead, found, shot, iterations)) {
            memcpy(u, found, sizeof found);
            done = ahead;
            if (done >= 1) {
                return 1;
            }
        } else if ((increment /= 2) < SHORTEST) {
            return 0;
        }
    }
    return 0;
}

/* Nested: Newton starts from the solution with an eighth of the steps, where there are enough of them. */
static int solution(const Problem *rod, int nested, Shot *shot, int *iterations)
{
    double u[UNKNOWNS];
    *iterations = 0;
    shot->curvature = HUGE_VAL;
    if (nested && rod->steps >= 8 * COARSEST) {
        Problem coarse = *rod;
        coarse.steps = rod->steps / 8;
        if (follow(&coarse, u, shot, iterations) && newton(rod, 1, u, shot, iterations)) {
            return 1;
        }
    }
    return follow(rod, u, shot, iterations);
}

/* Program */

static void solve(const Task *task, Answer *answer)
{
    const double length = task->length, bending = task->bending_x;
    const double force = length * length / bending, moment = length / bending, weight = force * length;
    const Problem rod = {
        .shears = task->shears,
        .steps = task->steps,
        .torsion = bending / task->torsion,
        .shear = bending / (task->shear_x * length * length),
        .extension = bending / (task->extension * length * length),
        .force = {force * task->force[0], force * task->force[1], force * task->force[2]},
        .moment = {moment * task->moment[0], moment * task->moment[1], moment * task->moment[2]},
        .weight = {weight * task->weight[0], weight * task->weight[1], weight * task->weight[2]},
    };
    Shot shot;
    answer->converged = solution(&rod, task->nested, &shot, &answer->iterations);
    if (answer->converged) {
        const Vector r = shot.r, t = shot.t, a = shot.a, b = cross(t, a);
        const double tip[3] = {length * r.x, length * r.y, length * r.z};
        const double rotation[3][3] = {{a.x, b.x, t.x}, {a.y, b.y, t.y}, {a.z, b.z, t.z}};
        memcpy(answer->tip, tip, sizeof tip);
        memcpy(answer->rotation, rotation, sizeof rotation);
    }
}

int main(int argc, char **argv)
{
    return run(argc, argv, NESTED, solve);
}
