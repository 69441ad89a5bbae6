/* What both shooting programs share: command line, clock, line of JSON, linear equations. */
#ifndef COMMON_H
#define COMMON_H

#define _POSIX_C_SOURCE 199309L

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The rates are evaluated four times in a step: too large, for GCC's -O2, to be inlined unasked. As calls they make the
 * plain program's step half as long again, and keep the tuned program's lanes from being vectorised. */
#ifdef __GNUC__
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif

enum { MOST_STEPS = 10000000 };

/* What a program can do beyond the rest of the command line. */
enum { UNEQUAL_STIFFNESSES = 1, NESTED = 2 };

/* A rod and its loads in SI units, as on the command line. */
typedef struct {
    int shears, steps, nested;
    double length, bending_x, bending_y, torsion, shear_x, shear_y, extension;
    double force[3], moment[3], weight[3];
} Task;

/* The rotation's columns are the axes of the section at the tip. */
typedef struct {
    int converged, iterations;
    double tip[3], rotation[3][3];
} Answer;

/* Elimination with row pivoting, in place; x holds the right side and then the solution. Zero if singular. */
INLINE int eliminate(const int size, double a[size][size], double *x)
{
    for (int j = 0; j < size; j++) {
        int pivot = j;
        for (int i = j + 1; i < size; i++) {
            if (fabs(a[i][j]) > fabs(a[pivot][j])) {
                pivot = i;
            }
        }
        if (!(fabs(a[pivot][j]) > 0)) {
            return 0;
        }
        if (pivot != j) {
            for (int k = j; k < size; k++) {
                const double kept = a[j][k];
                a[j][k] = a[pivot][k];
                a[pivot][k] = kept;
            }
            const double kept = x[j];
            x[j] = x[pivot];
            x[pivot] = kept;
        }
        for (int i = j + 1; i < size; i++) {
            const double factor = a[i][j] / a[j][j];
            for (int k = j + 1; k < size; k++) {
                a[i][k] -= factor * a[j][k];
            }
            x[i] -= factor * x[j];
        }
    }
    for (int i = size - 1; i >= 0; i--) {
        for (int k = i + 1; k < size; k++) {
            x[i] -= a[i][k] * x[k];
        }
        x[i] /= a[i][i];
    }
    return 1;
}

static int number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

/* All of `count` arguments from `first` on; zero if there are fewer or one is no number. */
static int numbers(int argc, char **argv, int first, int count, double *values)
{
    for (int i = 0; i < count; i++) {
        if (first + i >= argc || !number(argv[first + i], &values[i])) {
            return 0;
        }
    }
    return 1;
}

/* Zero if the arguments are not as the usage says. */
static int parse(int argc, char **argv, int abilities, Task *task, double *repeat)
{
    double given[6], other[2];
    if (argc < 2 || (strcmp(argv[1], "kirchhoff") != 0 && strcmp(argv[1], "reissner") != 0) ||
        !numbers(argc, argv, 2, 6, given) || !numbers(argc, argv, 8, 3, task->force) ||
        !numbers(argc, argv, 11, 3, task->moment)) {
        return 0;
    }
    for (int i = 0; i < 6; i++) {
        if (given[i] <= 0) {
            return 0;
        }
    }
    if (given[5] < 1 || given[5] > MOST_STEPS || given[5] != floor(given[5])) {
        return 0;
    }
    task->shears = strcmp(argv[1], "reissner") == 0;
    task->length = given[0];
    task->bending_x = task->bending_y = given[1];
    task->torsion = given[2];
    task->shear_x = task->shear_y = given[3];
    task->extension = given[4];
    task->steps = (int)given[5];
    task->nested = 0;
    task->weight[0] = task->weight[1] = task->weight[2] = 0;
    *repeat = 1;
    for (int i = 14; i < argc;) {
        if (strcmp(argv[i], "--repeat") == 0 && numbers(argc, argv, i + 1, 1, repeat) && *repeat >= 1) {
            i += 2;
        } else if (strcmp(argv[i], "--weight") == 0 && numbers(argc, argv, i + 1, 3, task->weight)) {
            i += 4;
        } else if ((abilities & UNEQUAL_STIFFNESSES) && strcmp(argv[i], "--y") == 0 &&
                   numbers(argc, argv, i + 1, 2, other) && other[0] > 0 && other[1] > 0) {
            task->bending_y = other[0];
            task->shear_y = other[1];
            i += 3;
        } else if ((abilities & NESTED) && strcmp(argv[i], "--nested") == 0) {
            task->nested = 1;
            i += 1;
        } else {
            return 0;
        }
    }
    return 1;
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Solve as often as told and print the answer and the best time; returns the exit status. */
static int run(int argc, char **argv, int abilities, void (*solve)(const Task *, Answer *))
{
    Task task;
    Answer answer = {0};
    double repeat, best = HUGE_VAL;
    if (!parse(argc, argv, abilities, &task, &repeat)) {
        fprintf(stderr, "usage: %s kirchhoff|reissner L EI GJ GA EA steps Fx Fy Fz Mx My Mz\n", argv[0]);
        fprintf(stderr, "       [--weight wx wy wz]%s%s [--repeat N]\n",
                abilities & UNEQUAL_STIFFNESSES ? " [--y EIy GAy]" : "", abilities & NESTED ? " [--nested]" : "");
        return 2;
    }
    for (double i = 0; i < repeat; i++) {
        const double begin = seconds();
        solve(&task, &answer);
        best = fmin(best, seconds() - begin);
    }
    if (answer.converged) {
        const double *r = answer.tip, *x = answer.rotation[0], *y = answer.rotation[1], *z = answer.rotation[2];
        printf("{\"status\": \"converged\", \"iterations\": %d, ", answer.iterations);
        printf("\"tip\": [%.17g, %.17g, %.17g], ", r[0], r[1], r[2]);
        printf("\"rotation\": [[%.17g, %.17g, %.17g], [%.17g, %.17g, %.17g], [%.17g, %.17g, %.17g]], ", x[0], x[1],
               x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    } else {
        printf("{\"status\": \"failed\", \"iterations\": %d, \"tip\": null, ", answer.iterations);
    }
    printf("\"cold_us\": %.3f}\n", 1e6 * best);
    return answer.converged ? 0 : 1;
}

#endif
