/* All kernels have the arguments of CasADi, whether they need them or not. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "The solver looks for values that are not finite: compile without -ffast-math."
#endif
#ifdef PLANAR_STRIP_SINGLE
#define casadi_real float
#endif
/* Kernels are seen by the library alone. */
#if defined(__GNUC__) && !defined(_WIN32)
#define CASADI_SYMBOL_EXPORT __attribute__((visibility("hidden")))
#else
#define CASADI_SYMBOL_EXPORT
#endif
#include <math.h>
#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int int
#endif
#ifdef __cplusplus
extern "C" {
#endif
static const casadi_real planar_strip_kernels_table_0[1] = {
 1.0};
static const casadi_real planar_strip_kernels_table_1[24] = {
 0.06698729810778069,-0.06250000000000001,0.05412658773652741,-0.04296874999999998,0.18301270189221933,
 -0.12499999999999999,0.03962341226347257,0.031250000000000014,0.2500000000000001,-0.06250000000000001,
 -0.09375000000000001,0.07421875000000001,0.2500000000000001,0.06250000000000001,-0.09375000000000001,
 -0.07421875000000001,0.18301270189221933,0.12499999999999999,0.03962341226347257,-0.031250000000000014,
 0.06698729810778069,0.06250000000000001,0.05412658773652741,0.04296874999999998};
static const double planar_strip_kernels_numbers[111] = {
 0.16666666666666666,-16.666666666666668,0.06698729810778069,0.18301270189221933,0.2500000000000001,
 -0.06250000000000001,-0.12499999999999999,0.05412658773652741,0.03962341226347257,-0.09375000000000001,
 -0.04296874999999998,0.031250000000000014,0.07421875000000001,2.220446049250313e-16,0.7071067811865476,
 0.7071067811865475,0.01428571428571429,0.126984126984127,0.22857142857142856,0.26031746031746034,
 0.33333333333333337,0.19999999999999996,0.14285714285714257,0.024471741852423196,0.022704454000167518,
 0.018910309742393248,0.013802096031823582,-0.023872875703131576,-0.021023304731445713,-0.016465507592771385,
 0.07101976096010308,0.047172670296700914,0.008718397354775344,-0.018157795823999668,-0.06250000000000003,
 -0.028048202685542784,0.007473120939939961,0.11061587104123713,0.026300486239858253,-0.04161195739752335,
 -0.012784600203108981,-0.07725424859373686,0.019313562148434202,0.03620008174560281,0.13938412895876284,
 -0.026300486239858253,-0.026747417602476665,0.03841936582810897,0.059298202685542784,-0.02309812093993996,
 0.15450849718747373,-0.06987712429686843,0.04073066790283142,-0.021279065832823914,0.032959742583011514,
 -0.035359574152831426,0.005050505050505055,0.047289527441850776,0.09281760721212388,0.12679416664184331,
 0.14960663521211853,0.1568831168831169,0.014186858232555232,0.027845282163637165,0.038038249992552994,
 0.04488199056363556,0.047064935064935066,0.0015151515151515165,0.06857142857142856,0.0380952380952381,
 0.004285714285714287,0.07809523809523809,0.9999999999999998,0.16666666666666663,-0.16666666666666663,
 -0.16666666666666666,-0.28867513459481287,0.28867513459481287,0.3333333333333333,0.04638077400524685,
 0.031205357142857135,-0.005476190476190479,0.003080357142857142,-0.0023331549576278126,0.0010714285714285717,
 -0.3333333333333333,0.03348137577735969,0.07595238095238092,0.03904761904761904,-0.007380952380952386,
 0.004613862317878401,-0.0020238095238095228,0.012990596134245738,-0.001494724773128336,0.0006950654514510509,
 -0.0004530581064616681,0.0003610589957226777,-0.00016804080141429836,0.0377341790995154,0.06902448667789023,
 0.07740017264378703,0.07006615334455689,0.025104641960992356,-0.0038795782462047452,0.08333333333333333,
 0.0404283930528659,0.06549107142857141,0.08357142857142853,0.037366071428571415,-0.00828553591000876,
 0.003214285714285716};
#undef C
#define C planar_strip_kernels_numbers

/* ---- In fours ---- */

#if defined(__GNUC__) && !defined(FOURS_ONE_BY_ONE)
#define FOURS_HAVE_VECTORS
/* On x86 functions are made a second time for the wider vectors of newer processors, and chosen as the program runs,
   unless FOURS_ONCE asks for vectors that any processor has. */
#if defined(__x86_64__) && !defined(__AVX2__) && !defined(FOURS_ONCE)
#define FOURS_TWICE
#endif
#endif

#if defined(FOURS_HAVE_VECTORS) && !defined(FOURS_TWICE)
#define FOURS_IN_VECTORS
#endif
#include "fours.h"
#if defined(__GNUC__) && !defined(__clang__) && (defined(FOURS_TWICE) || !defined(__OPTIMIZE__))
/* For older processors, or without optimisation: what takes compilers longest is left out, but not what saves stack.
   Older processors compute lane after lane, since vectors of two take compilers twice as long. */
#define FOURS_PLAINLY
#pragma GCC push_options
#pragma GCC optimize("O1", "no-tree-dse", "no-dse", "no-tree-dominator-opts", "no-tree-pta", \
    "no-tree-sink", "no-tree-sra", "no-tree-slsr", "no-tree-bit-ccp", "no-tree-ch")
#endif
#define MADE(function) function##_plain
#include "planar_strip_kernels_in_fours.h"
#undef MADE
#ifdef FOURS_PLAINLY
#pragma GCC pop_options
#endif

#ifdef FOURS_TWICE
#define FOURS_IN_VECTORS
#include "fours.h"
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#ifdef __OPTIMIZE__
/* Straight-line code is as fast with this, and compilers take a fifth less time for a folder. */
#pragma GCC optimize("O1", "expensive-optimizations", "no-tree-dse", "no-dse")
#endif
#endif
#define MADE(function) function##_wide
#include "planar_strip_kernels_in_fours.h"
#undef MADE
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#define IN_FOURS(function, given) (__builtin_cpu_supports("avx2") ? function##_wide given : function##_plain given)
#else
#define IN_FOURS(function, given) function##_plain given
#endif

/* ---- Kernels ---- */

#define MADE(function) function##_once
/* An argument that is not there stands for zeros. */
#define ENTRY(argument, entry) (arg[argument] ? arg[argument][entry] : 0)
static void MADE(planar_strip_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  IN_FOURS(planar_strip_kernels_increments, (given, made, turns));
}
static void MADE(planar_strip_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns, casadi_real *columns, casadi_real *passed, int groups) {
  IN_FOURS(planar_strip_k_jacobian_columns, (w, turns, columns, passed, groups));
}
static void MADE(planar_strip_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns, casadi_real *columns, casadi_real *passed, int groups) {
  IN_FOURS(planar_strip_k_tip_jacobian_columns, (w, turns, columns, passed, groups));
}

#if defined(__GNUC__) && !defined(__clang__)
/* Straight-line code is as fast with this. Parts stay apart: compilers take longer with longer functions. No store is
   overwritten unread, and what else is left out finds nothing there. */
#pragma GCC push_options
#pragma GCC optimize("O1", "no-inline-functions-called-once", "no-tree-dse", "no-dse", "no-tree-dominator-opts", "no-tree-pta", \
    "no-tree-sink", "no-tree-sra", "no-tree-slsr", "no-tree-bit-ccp", "no-tree-ch")
#endif
static void MADE(planar_strip_kernels_pull)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  made[0] = p0[0] * p1[0];
}

static void MADE(planar_strip_kernels_variation)(const casadi_real *p0, const casadi_real *p1, const casadi_real *p2, const casadi_real *p3, casadi_real *made) {
  casadi_real a0, a1, a2, a3, a4, a5, a6;
  a0 = p2[0] * p0[0];
  a1 = 0.5 / (p1[0] * p1[0]);
  a2 = a0 * a0;
  a3 = (-1.6534391534391535e-06) + a2 * (1.670140559029448e-08 + a2 * ((-1.1470745597729724e-10) + a2 * (5.735372798864862e-13 + a2 * ((-2.186688975602072e-15) + a2 * (6.576508197299464e-18 + (-1.6014224506411032e-20) * a2)))));
  a3 = (-0.002777777777777778) + a2 * (9.92063492063492e-05 + a2 * a3);
  a2 = a1 * (p1[4] + a2 * a3);
  a3 = (-1.0) * (2.0 * (a0 * (a1 * a3 * (p3[1] * a0) * a0 - a2 * p3[1])));
  a1 = p3[2] / 2.0;
  a4 = a0 * (a2 * p3[0]);
  a5 = p3[1] / 2.0;
  a6 = p3[0] / 2.0;
  a2 = a0 * (a2 * p3[2]);
  made[0] = p2[0];
  made[1] = a3;
  made[2] = a1 - a4;
  made[3] = (-1.0) * a5;
  made[4] = (-1.0) * (a1 + a4);
  made[5] = a6 - a2;
  made[6] = a5;
  made[7] = (-1.0) * (a6 + a2);
  made[8] = a3;
}

static void MADE(planar_strip_kernels_turning)(const casadi_real *p0, casadi_real *made) {
  made[0] = p0[0];
}

static int MADE(planar_strip_k_residual)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(2, 0);
  a2 = ENTRY(0, 2);
  a3 = C[2] * a0 + C[7] * a2;
  a4 = ENTRY(0, 1);
  a5 = C[5] * a4;
  a6 = ENTRY(0, 3);
  a7 = a5 + C[10] * a6;
  a8 = C[3] * a0 + C[8] * a2;
  a9 = C[6] * a4 + C[11] * a6;
  a10 = C[4] * a0 + C[9] * a2;
  a5 = a5 + C[12] * a6;
  a11 = a3 - a7;
  w[48] = a3 + a7;
  w[49] = a8 + a9;
  w[50] = a10 + a5;
  w[51] = a10 - a5;
  w[52] = a8 - a9;
  w[53] = a11;
  w[54] = a11;
  w[55] = a11;
  MADE(planar_strip_kernels_increments)(w + 48, w + 2, 2);
  a11 = w[2] * w[3] - w[6] * w[7];
  a9 = w[2] * w[7] + w[6] * w[3];
  a8 = a11 * w[4] - a9 * w[8];
  a5 = a11 * w[8] + a9 * w[4];
  a10 = a8 * w[5] - a5 * w[9];
  a7 = a8 * w[9] + a5 * w[5];
  a3 = a10 * w[22] - a7 * w[26];
  a12 = a10 * w[26] + a7 * w[22];
  a13 = a3 * w[27] + a12 * w[23];
  a14 = a1 * ENTRY(1, 2);
  a15 = a1 * ENTRY(1, 0);
  a16 = 0.3 * (2.0 * (a3 * w[23] - a12 * w[27]) * a13) * (C[16] * a15);
  a16 = a1 * ENTRY(1, 4) - (0.3 * (1.0 - 2.0 * a13 * a13) * (C[16] * a14) + a16);
  a13 = C[17] * a14;
  a1 = C[17] * a15;
  a3 = a16 - (0.3 * (1.0 - 2.0 * a12 * a12) * a13 + 0.3 * (2.0 * a3 * a12) * a1);
  a12 = C[18] * a14;
  a17 = C[18] * a15;
  a10 = a3 - (0.3 * (1.0 - 2.0 * a7 * a7) * a12 + 0.3 * (2.0 * a10 * a7) * a17);
  a15 = a10 - (0.3 * (1.0 - 2.0 * a5 * a5) * (C[19] * a14) + 0.3 * (2.0 * a8 * a5) * (C[19] * a15));
  a17 = a15 - (0.3 * (1.0 - 2.0 * a9 * a9) * a12 + 0.3 * (2.0 * a11 * a9) * a17);
  w[60] = a17 - (0.3 * (1.0 - 2.0 * w[6] * w[6]) * a13 + 0.3 * (2.0 * w[2] * w[6]) * a1);
  w[61] = a16;
  w[62] = a17;
  w[63] = a3;
  w[64] = a15;
  w[65] = a10;
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 60, w + 42);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 61, w + 43);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 62, w + 44);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 63, w + 45);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 64, w + 46);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 65, w + 47);
  a10 = w[42] + w[43];
  a15 = w[44] + w[45];
  a3 = w[46] + w[47];
  res[0][0] = a0 + C[1] * (C[2] * a10 + C[3] * a15 + C[4] * a3);
  a0 = w[42] - w[43];
  a17 = w[44] - w[45];
  a16 = w[46] - w[47];
  res[0][1] = C[20] * a4 + C[1] * (C[5] * a0 + C[6] * a17 + C[5] * a16);
  res[0][2] = C[21] * a2 + C[1] * (C[7] * a10 + C[8] * a15 + C[9] * a3);
  res[0][3] = C[22] * a6 + C[1] * (C[10] * a0 + C[11] * a17 + C[12] * a16);
  return 0;
}

static int MADE(planar_strip_k_jacobian)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a4 = a2 - a6;
  w[96] = a2 + a6;
  w[97] = a7 + a3;
  w[98] = a1 + a5;
  w[99] = a1 - a5;
  w[100] = a7 - a3;
  w[101] = a4;
  w[102] = a4;
  w[103] = a4;
  MADE(planar_strip_kernels_increments)(w + 96, w + 2, 2);
  a4 = w[2] * w[3] - w[6] * w[7];
  a3 = w[2] * w[7] + w[6] * w[3];
  a7 = a4 * w[4] - a3 * w[8];
  a5 = a4 * w[8] + a3 * w[4];
  a1 = a7 * w[5] - a5 * w[9];
  a6 = a7 * w[9] + a5 * w[5];
  a2 = a1 * w[22] - a6 * w[26];
  a0 = a1 * w[26] + a6 * w[22];
  a8 = a2 * w[27] + a0 * w[23];
  a9 = 0.3 * (1.0 - 2.0 * a8 * a8);
  a10 = ENTRY(2, 0);
  a11 = a10 * ENTRY(1, 1);
  a12 = C[16] * a11;
  a13 = a9 * a12 + a10 * ENTRY(1, 5);
  a14 = 0.3 * (1.0 - 2.0 * a0 * a0);
  a15 = C[17] * a11;
  a16 = a13 + a14 * a15;
  a17 = 0.3 * (1.0 - 2.0 * a6 * a6);
  a18 = C[18] * a11;
  a19 = a16 + a17 * a18;
  a20 = 0.3 * (1.0 - 2.0 * a5 * a5);
  a11 = C[19] * a11;
  a21 = a19 + a20 * a11;
  a22 = 0.3 * (1.0 - 2.0 * a3 * a3);
  a23 = a21 + a22 * a18;
  a24 = 0.3 * (1.0 - 2.0 * w[6] * w[6]);
  a25 = a10 * ENTRY(1, 2);
  a26 = C[16] * a25;
  a8 = 0.3 * (2.0 * (a2 * w[23] - a0 * w[27]) * a8);
  a27 = a10 * ENTRY(1, 0);
  a28 = C[16] * a27;
  a29 = a10 * ENTRY(1, 4) - (a9 * a26 + a8 * a28);
  a30 = C[17] * a25;
  a0 = 0.3 * (2.0 * a2 * a0);
  a2 = C[17] * a27;
  a31 = a29 - (a14 * a30 + a0 * a2);
  a32 = C[18] * a25;
  a6 = 0.3 * (2.0 * a1 * a6);
  a1 = C[18] * a27;
  a33 = a31 - (a17 * a32 + a6 * a1);
  a25 = C[19] * a25;
  a5 = 0.3 * (2.0 * a7 * a5);
  a27 = C[19] * a27;
  a7 = a33 - (a20 * a25 + a5 * a27);
  a3 = 0.3 * (2.0 * a4 * a3);
  a4 = a7 - (a22 * a32 + a3 * a1);
  a34 = 0.3 * (2.0 * w[2] * w[6]);
  a10 = a8 * a12 + a10 * ENTRY(1, 3);
  a12 = a10 + a0 * a15;
  a35 = a12 + a6 * a18;
  a11 = a35 + a5 * a11;
  a18 = a11 + a3 * a18;
  w[166] = (-1.0) * (a23 + a24 * a15);
  w[167] = a4 - (a24 * a30 + a34 * a2);
  w[168] = a18 + a34 * a15;
  w[169] = (-1.0) * a23;
  w[170] = a4;
  w[171] = a18;
  w[172] = (-1.0) * a21;
  w[173] = a7;
  w[174] = a11;
  w[175] = (-1.0) * a19;
  w[176] = a33;
  w[177] = a35;
  w[178] = (-1.0) * a16;
  w[179] = a31;
  w[180] = a12;
  w[181] = (-1.0) * a13;
  w[182] = a29;
  w[183] = a10;
  MADE(planar_strip_kernels_variation)(w + 10, w + 14, planar_strip_kernels_table_0, w + 166, w + 42);
  MADE(planar_strip_kernels_variation)(w + 11, w + 15, planar_strip_kernels_table_0, w + 169, w + 51);
  MADE(planar_strip_kernels_variation)(w + 12, w + 16, planar_strip_kernels_table_0, w + 172, w + 60);
  MADE(planar_strip_kernels_variation)(w + 13, w + 17, planar_strip_kernels_table_0, w + 175, w + 69);
  MADE(planar_strip_kernels_variation)(w + 30, w + 34, planar_strip_kernels_table_0, w + 178, w + 78);
  MADE(planar_strip_kernels_variation)(w + 31, w + 35, planar_strip_kernels_table_0, w + 181, w + 87);
  w[144] = a26 * a8 - a28 * a9;
  w[145] = a30 * a0 - a2 * a14;
  w[146] = a32 * a6 - a1 * a17;
  w[147] = a25 * a5 - a27 * a20;
  w[148] = a32 * a3 - a1 * a22;
  w[149] = a30 * a34 - a2 * a24;
  MADE(planar_strip_k_jacobian_columns)(w, planar_strip_kernels_table_1, w + 150, w + 184, 1);
  res[0][0] = 1.0 + w[150];
  res[0][1] = w[151];
  res[0][2] = w[152];
  res[0][3] = w[153];
  res[0][4] = w[151];
  res[0][5] = C[20] + w[155];
  res[0][6] = w[156];
  res[0][7] = w[157];
  res[0][8] = w[152];
  res[0][9] = w[156];
  res[0][10] = C[21] + w[160];
  res[0][11] = w[161];
  res[0][12] = w[153];
  res[0][13] = w[157];
  res[0][14] = w[161];
  res[0][15] = C[22] + w[165];
  return 0;
}

static int MADE(planar_strip_k_rate)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13;
  a0 = ENTRY(4, 0);
  a1 = ENTRY(2, 0);
  a2 = ENTRY(0, 0);
  a3 = ENTRY(0, 2);
  a4 = C[2] * a2 + C[7] * a3;
  a5 = ENTRY(0, 1);
  a6 = C[5] * a5;
  a7 = ENTRY(0, 3);
  a8 = a6 + C[10] * a7;
  a9 = C[3] * a2 + C[8] * a3;
  a5 = C[6] * a5 + C[11] * a7;
  a3 = C[4] * a2 + C[9] * a3;
  a7 = a6 + C[12] * a7;
  a6 = a4 - a8;
  w[48] = a4 + a8;
  w[49] = a9 + a5;
  w[50] = a3 + a7;
  w[51] = a3 - a7;
  w[52] = a9 - a5;
  w[53] = a6;
  w[54] = a6;
  w[55] = a6;
  MADE(planar_strip_kernels_increments)(w + 48, w + 2, 2);
  a6 = w[2] * w[3] - w[6] * w[7];
  a5 = w[2] * w[7] + w[6] * w[3];
  a9 = a6 * w[4] - a5 * w[8];
  a7 = a6 * w[8] + a5 * w[4];
  a3 = a9 * w[5] - a7 * w[9];
  a8 = a9 * w[9] + a7 * w[5];
  a4 = a3 * w[22] - a8 * w[26];
  a2 = a3 * w[26] + a8 * w[22];
  a10 = a4 * w[27] + a2 * w[23];
  a11 = ENTRY(1, 2) * a0 + a1 * ENTRY(3, 2);
  a12 = ENTRY(1, 0) * a0 + a1 * ENTRY(3, 0);
  a13 = 0.3 * (2.0 * (a4 * w[23] - a2 * w[27]) * a10) * (C[16] * a12);
  a13 = ENTRY(1, 4) * a0 + a1 * ENTRY(3, 4) - (0.3 * (1.0 - 2.0 * a10 * a10) * (C[16] * a11) + a13);
  a10 = C[17] * a11;
  a1 = C[17] * a12;
  a4 = a13 - (0.3 * (1.0 - 2.0 * a2 * a2) * a10 + 0.3 * (2.0 * a4 * a2) * a1);
  a2 = C[18] * a11;
  a0 = C[18] * a12;
  a3 = a4 - (0.3 * (1.0 - 2.0 * a8 * a8) * a2 + 0.3 * (2.0 * a3 * a8) * a0);
  a12 = a3 - (0.3 * (1.0 - 2.0 * a7 * a7) * (C[19] * a11) + 0.3 * (2.0 * a9 * a7) * (C[19] * a12));
  a0 = a12 - (0.3 * (1.0 - 2.0 * a5 * a5) * a2 + 0.3 * (2.0 * a6 * a5) * a0);
  w[60] = a0 - (0.3 * (1.0 - 2.0 * w[6] * w[6]) * a10 + 0.3 * (2.0 * w[2] * w[6]) * a1);
  w[61] = a13;
  w[62] = a0;
  w[63] = a4;
  w[64] = a12;
  w[65] = a3;
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 60, w + 42);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 61, w + 43);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 62, w + 44);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 63, w + 45);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 64, w + 46);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 65, w + 47);
  a3 = w[42] + w[43];
  a12 = w[44] + w[45];
  a4 = w[46] + w[47];
  res[0][0] = C[1] * (C[2] * a3 + C[3] * a12 + C[4] * a4);
  a0 = w[42] - w[43];
  a13 = w[44] - w[45];
  a1 = w[46] - w[47];
  res[0][1] = C[1] * (C[5] * a0 + C[6] * a13 + C[5] * a1);
  res[0][2] = C[1] * (C[7] * a3 + C[8] * a12 + C[9] * a4);
  res[0][3] = C[1] * (C[10] * a0 + C[11] * a13 + C[12] * a1);
  return 0;
}

static int MADE(planar_strip_k_tangent)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0;
  a0 = ENTRY(0, 2);
  res[0][0] = (-2.5000000000000004) * a0 + 16.66666666666667 * ENTRY(0, 4);
  res[0][1] = 2.5000000000000004 * a0;
  res[0][2] = 0.0;
  res[0][3] = 0.0;
  return 0;
}

static int MADE(planar_strip_k_resolution_index)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a5 = fmax(fmax(fmax(fmax(fabs(a2 + a6), fabs(a7 + a3)), fabs(a1 + a5)), fabs(a1 - a5)), fabs(a7 - a3));
  res[0][0] = fmax(0.0, fmax(a5, fabs(a2 - a6)) / 2.0);
  return 0;
}

static void MADE(planar_strip_k_richer_balance_part_0)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14;
  res[0][0] = 0.0;
  res[0][1] = 0.0;
  res[0][2] = 0.0;
  res[0][3] = 0.0;
  a0 = ENTRY(2, 0);
  w[124] = 0.11111111111111109 * a0;
  w[127] = a1 = ENTRY(0, 0) + ENTRY(1, 0);
  w[129] = a2 = ENTRY(0, 2) + ENTRY(1, 2);
  w[126] = a3 = ENTRY(2, 2);
  a4 = C[23] * a1 + C[24] * a2 + C[25] * a0 + C[26] * a3;
  w[128] = a5 = ENTRY(0, 1) + ENTRY(1, 1);
  a6 = C[27] * a5;
  w[130] = a7 = ENTRY(0, 3) + ENTRY(1, 3);
  w[125] = a8 = ENTRY(2, 1);
  a9 = a6 + C[28] * a7 + C[29] * a8;
  a10 = C[30] * a1 + C[31] * a2 + C[32] * a0 + C[33] * a3;
  a11 = C[34] * a5;
  a12 = a11 + C[35] * a7 + C[36] * a8;
  a13 = C[37] * a1 + C[38] * a2 + C[39] * a0 + C[40] * a3;
  a5 = C[41] * a5 + C[42] * a7 + C[43] * a8;
  a14 = C[44] * a1 + C[45] * a2 + C[46] * a0 + C[47] * a3;
  a11 = a11 + C[48] * a7 + C[49] * a8;
  a3 = C[50] * a1 + C[51] * a2 + C[52] * a0 + C[53] * a3;
  a8 = a6 + C[54] * a7 + C[55] * a8;
  a7 = a4 - a9;
  w[72] = a4 + a9;
  w[73] = a10 + a12;
  w[74] = a13 + a5;
  w[75] = a14 + a11;
  w[76] = a3 + a8;
  w[77] = a3 - a8;
  w[78] = a14 - a11;
  w[79] = a13 - a5;
  w[80] = a10 - a12;
  w[81] = a7;
  w[82] = a7;
  w[83] = a7;
  MADE(planar_strip_kernels_increments)(w + 72, w + 2, 3);
  w[118] = a7 = w[2] * w[3] - w[6] * w[7];
  w[116] = a12 = w[2] * w[7] + w[6] * w[3];
  w[115] = a10 = a7 * w[4] - a12 * w[8];
  w[113] = a12 = a7 * w[8] + a12 * w[4];
  w[112] = a7 = a10 * w[5] - a12 * w[9];
  w[111] = a12 = a10 * w[9] + a12 * w[5];
  w[110] = a10 = a7 * w[22] - a12 * w[26];
  w[109] = a12 = a7 * w[26] + a12 * w[22];
  w[108] = a7 = a10 * w[23] - a12 * w[27];
  w[106] = a12 = a10 * w[27] + a12 * w[23];
  a10 = a7 * w[24] - a12 * w[28];
  a12 = a7 * w[28] + a12 * w[24];
  a7 = a10 * w[25] - a12 * w[29];
  a5 = a10 * w[29] + a12 * w[25];
  a13 = a7 * w[42] - a5 * w[46];
  a11 = a7 * w[46] + a5 * w[42];
  w[139] = a14 = a13 * w[47] + a11 * w[43];
  w[137] = a8 = 1.0 - 2.0 * a14 * a14;
  w[107] = a3 = ENTRY(3, 2);
  w[138] = a9 = a13 * w[43] - a11 * w[47];
  w[133] = a14 = 2.0 * a9 * a14;
  w[103] = a9 = ENTRY(3, 0);
  w[122] = a14 = ENTRY(3, 4) - (0.3 * a8 * (C[56] * a3) + 0.3 * a14 * (C[56] * a9));
  w[136] = a8 = 1.0 - 2.0 * a11 * a11;
  w[120] = a4 = C[57] * a3;
  w[132] = a11 = 2.0 * a13 * a11;
  w[121] = a13 = C[57] * a9;
  w[123] = a13 = a14 - (0.3 * a8 * a4 + 0.3 * a11 * a13);
  w[135] = a11 = 1.0 - 2.0 * a5 * a5;
  w[117] = a4 = C[58] * a3;
  w[131] = a5 = 2.0 * a7 * a5;
  w[119] = a9 = C[58] * a9;
  w[105] = a13 - (0.3 * a11 * a4 + 0.3 * a5 * a9);
  w[134] = a9 = 1.0 - 2.0 * a12 * a12;
  w[114] = a3 = C[59] * a3;
  w[104] = 0.3 * a9 * a3;
  w[102] = 2.0 * a10 * a12;
}

static void MADE(planar_strip_k_richer_balance_part_1)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22;
  a0 = C[59] * w[103];
  a1 = w[105] - (w[104] + 0.3 * w[102] * a0);
  a2 = 1.0 - 2.0 * w[106] * w[106];
  a3 = C[60] * w[107];
  a4 = 2.0 * w[108] * w[106];
  a5 = C[60] * w[103];
  a6 = a1 - (0.3 * a2 * a3 + 0.3 * a4 * a5);
  a7 = 1.0 - 2.0 * w[109] * w[109];
  a8 = 2.0 * w[110] * w[109];
  a9 = a6 - (0.3 * a7 * (C[61] * w[107]) + 0.3 * a8 * (C[61] * w[103]));
  a10 = 1.0 - 2.0 * w[111] * w[111];
  a11 = 2.0 * w[112] * w[111];
  a5 = a9 - (0.3 * a10 * a3 + 0.3 * a11 * a5);
  a3 = 1.0 - 2.0 * w[113] * w[113];
  a12 = 2.0 * w[115] * w[113];
  a0 = a5 - (0.3 * a3 * w[114] + 0.3 * a12 * a0);
  a13 = 1.0 - 2.0 * w[116] * w[116];
  a14 = 2.0 * w[118] * w[116];
  a15 = a0 - (0.3 * a13 * w[117] + 0.3 * a14 * w[119]);
  a16 = 1.0 - 2.0 * w[6] * w[6];
  a17 = 2.0 * w[2] * w[6];
  w[92] = a15 - (0.3 * a16 * w[120] + 0.3 * a17 * w[121]);
  w[93] = w[122];
  w[94] = a15;
  w[95] = w[123];
  w[96] = a0;
  w[97] = w[105];
  w[98] = a5;
  w[99] = a1;
  w[100] = a9;
  w[101] = a6;
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 92, w + 62);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 93, w + 63);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 94, w + 64);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 95, w + 65);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 96, w + 66);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 97, w + 67);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 98, w + 68);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 99, w + 69);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 100, w + 70);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 101, w + 71);
  a6 = w[62] + w[63];
  a9 = w[64] + w[65];
  a1 = w[66] + w[67];
  a5 = w[68] + w[69];
  a0 = w[70] + w[71];
  a15 = 9.000000000000002 * (w[124] + C[1] * (C[25] * a6 + C[32] * a9 + C[39] * a1 + C[46] * a5 + C[52] * a0));
  res[0][4] = (-1.0) * a15;
  a15 = w[62] - w[63];
  a18 = w[64] - w[65];
  a19 = w[66] - w[67];
  a20 = w[68] - w[69];
  a21 = w[70] - w[71];
  a22 = 0.0909090909090908 * w[125] + C[1] * (C[29] * a15 + C[36] * a18 + C[43] * a19 + C[49] * a20 + C[55] * a21);
  res[0][5] = (-1.0) * (11.000000000000012 * a22);
  a22 = 0.07692307692307677 * w[126] + C[1] * (C[26] * a6 + C[33] * a9 + C[40] * a1 + C[47] * a5 + C[53] * a0);
  res[0][6] = (-1.0) * (13.000000000000025 * a22);
  res[0][7] = w[127] + C[1] * (C[23] * a6 + C[30] * a9 + C[37] * a1 + C[44] * a5 + C[50] * a0);
  a22 = 0.33333333333333326 * w[128] + C[1] * (C[27] * a15 + C[34] * a18 + C[41] * a19 + C[34] * a20 + C[27] * a21);
  res[0][8] = a22;
  a0 = C[21] * w[129] + C[1] * (C[24] * a6 + C[31] * a9 + C[38] * a1 + C[45] * a5 + C[51] * a0);
  res[0][9] = a0;
  a21 = 0.1428571428571429 * w[130] + C[1] * (C[28] * a15 + C[35] * a18 + C[42] * a19 + C[48] * a20 + C[54] * a21);
  res[0][10] = a21;
  a4 = C[62] * a17 + C[63] * a14 + C[64] * a12 + C[65] * a11 + C[66] * a8 + C[65] * a4 + C[64] * w[102];
  a4 = a4 + C[63] * w[131] + C[62] * w[132] + C[67] * w[133];
  a8 = C[64] * w[134];
  a11 = C[63] * w[135];
  a11 = C[67] + C[62] * a16 + C[63] * a13 + C[64] * a3 + C[65] * a10 + C[66] * a7 + C[65] * a2 + a8 + a11;
  a11 = a11 + C[62] * w[136] + C[67] * w[137];
  res[0][11] = (C[13] * a4 + a11) / 0.3;
  res[0][12] = 0.0;
  res[0][13] = (C[13] * a11 - a4) / 0.3;
  res[0][14] = C[14] * w[138] - C[15] * w[139];
  res[0][15] = 0.0;
  res[0][16] = C[14] * w[139] + C[15] * w[138];
  res[0][17] = 0.0;
}

static int MADE(planar_strip_k_richer_balance)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  MADE(planar_strip_k_richer_balance_part_0)(arg, res, w);
  MADE(planar_strip_k_richer_balance_part_1)(arg, res, w);
  return 0;
}

static int MADE(planar_strip_k_watched)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a4 = a2 - a6;
  w[42] = a2 + a6;
  w[43] = a7 + a3;
  w[44] = a1 + a5;
  w[45] = a1 - a5;
  w[46] = a7 - a3;
  w[47] = a4;
  w[48] = a4;
  w[49] = a4;
  MADE(planar_strip_kernels_increments)(w + 42, w + 2, 2);
  a4 = w[2] * w[3] - w[6] * w[7];
  a3 = w[2] * w[7] + w[6] * w[3];
  a7 = a4 * w[4] - a3 * w[8];
  a5 = a4 * w[8] + a3 * w[4];
  a1 = a7 * w[5] - a5 * w[9];
  a6 = a7 * w[9] + a5 * w[5];
  a2 = C[68] * (2.0 * a1 * a6);
  a0 = a1 * w[22] - a6 * w[26];
  a1 = a1 * w[26] + a6 * w[22];
  a8 = C[69] * (2.0 * a0 * a1);
  a9 = a0 * w[23] - a1 * w[27];
  a0 = a0 * w[27] + a1 * w[23];
  a10 = C[70] * (2.0 * a9 * a0);
  a10 = C[69] * (2.0 * w[2] * w[6]) + C[68] * (2.0 * a4 * a3) + C[71] * (2.0 * a7 * a5) + a2 + a8 + a10;
  a5 = C[71] * (1.0 - 2.0 * a5 * a5);
  a6 = C[68] * (1.0 - 2.0 * a6 * a6);
  a1 = C[69] * (1.0 - 2.0 * a1 * a1);
  a8 = C[70] * (1.0 - 2.0 * a0 * a0);
  a8 = C[70] + C[69] * (1.0 - 2.0 * w[6] * w[6]) + C[68] * (1.0 - 2.0 * a3 * a3) + a5 + a6 + a1 + a8;
  res[0][0] = (C[13] * a10 + a8) / 0.3;
  res[0][1] = 0.0;
  res[0][2] = (C[13] * a8 - a10) / 0.3;
  res[0][3] = C[14] * a9 - C[15] * a0;
  res[0][4] = 0.0;
  res[0][5] = C[14] * a0 + C[15] * a9;
  res[0][6] = 0.0;
  return 0;
}

static int MADE(planar_strip_k_igm)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35, a36, a37, a38, a39, a40;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a4 = a2 - a6;
  w[48] = a2 + a6;
  w[49] = a7 + a3;
  w[50] = a1 + a5;
  w[51] = a1 - a5;
  w[52] = a7 - a3;
  w[53] = a4;
  w[54] = a4;
  w[55] = a4;
  MADE(planar_strip_kernels_increments)(w + 48, w + 2, 2);
  a4 = w[2] * w[3] - w[6] * w[7];
  a3 = w[2] * w[7] + w[6] * w[3];
  a7 = a4 * w[4] - a3 * w[8];
  a5 = a4 * w[8] + a3 * w[4];
  a1 = a7 * w[5] - a5 * w[9];
  a6 = a7 * w[9] + a5 * w[5];
  a2 = a1 * w[22] - a6 * w[26];
  a0 = a1 * w[26] + a6 * w[22];
  a8 = a2 * w[27] + a0 * w[23];
  a9 = 0.3 * (1.0 - 2.0 * a8 * a8);
  a10 = ENTRY(2, 2);
  a11 = 2.0 * a10;
  a12 = a11 * a10;
  a13 = ENTRY(2, 3);
  a14 = 2.0 * a13 * a13;
  a15 = 1.0 - a12 - a14;
  a16 = ENTRY(3, 0);
  a17 = ENTRY(2, 1);
  a18 = 2.0 * a17;
  a19 = a18 * a10;
  a20 = 2.0 * ENTRY(2, 0);
  a21 = a20 * a13;
  a22 = a19 + a21;
  a23 = ENTRY(3, 1);
  a24 = a18 * a13;
  a10 = a20 * a10;
  a25 = a24 - a10;
  a26 = ENTRY(3, 2);
  a27 = a15 * a16 + a22 * a23 + a25 * a26;
  a8 = 0.3 * (2.0 * (a2 * w[23] - a0 * w[27]) * a8);
  a10 = a24 + a10;
  a13 = a11 * a13;
  a20 = a20 * a17;
  a11 = a13 - a20;
  a17 = 1.0 - a18 * a17;
  a12 = a17 - a12;
  a18 = a10 * a16 + a11 * a23 + a12 * a26;
  a21 = a19 - a21;
  a19 = ENTRY(3, 3);
  a14 = a17 - a14;
  a17 = ENTRY(3, 4);
  a20 = a13 + a20;
  a13 = ENTRY(3, 5);
  a24 = a9 * (C[16] * a27) - a8 * (C[16] * a18) + (a21 * a19 + a14 * a17 + a20 * a13);
  a28 = 0.3 * (1.0 - 2.0 * a0 * a0);
  a29 = C[17] * a27;
  a0 = 0.3 * (2.0 * a2 * a0);
  a2 = C[17] * a18;
  a30 = a28 * a29 - a0 * a2;
  a31 = a24 + a30;
  a32 = 0.3 * (1.0 - 2.0 * a6 * a6);
  a33 = C[18] * a27;
  a6 = 0.3 * (2.0 * a1 * a6);
  a1 = C[18] * a18;
  a34 = a32 * a33 - a6 * a1;
  a35 = a31 + a34;
  a36 = 0.3 * (1.0 - 2.0 * a5 * a5);
  a5 = 0.3 * (2.0 * a7 * a5);
  a7 = a36 * (C[19] * a27) - a5 * (C[19] * a18);
  a37 = a35 + a7;
  a38 = 0.3 * (1.0 - 2.0 * a3 * a3);
  a3 = 0.3 * (2.0 * a4 * a3);
  a1 = a38 * a33 - a3 * a1;
  a33 = a37 + a1;
  a4 = 0.3 * (1.0 - 2.0 * w[6] * w[6]);
  a39 = 0.3 * (2.0 * w[2] * w[6]);
  a2 = a4 * a29 - a39 * a2;
  w[60] = a33 + a2;
  w[61] = a24;
  w[62] = a33;
  w[63] = a31;
  w[64] = a37;
  w[65] = a35;
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 60, w + 42);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 61, w + 43);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 62, w + 44);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 63, w + 45);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 64, w + 46);
  MADE(planar_strip_kernels_pull)(planar_strip_kernels_table_0, w + 65, w + 47);
  a35 = w[42] + w[43];
  a37 = w[44] + w[45];
  a31 = w[46] + w[47];
  if (res[0]) res[0][0] = C[1] * (C[2] * a35 + C[3] * a37 + C[4] * a31);
  a33 = w[42] - w[43];
  a29 = w[44] - w[45];
  a40 = w[46] - w[47];
  if (res[0]) res[0][1] = C[1] * (C[5] * a33 + C[6] * a29 + C[5] * a40);
  if (res[0]) res[0][2] = C[1] * (C[7] * a35 + C[8] * a37 + C[9] * a31);
  if (res[0]) res[0][3] = C[1] * (C[10] * a33 + C[11] * a29 + C[12] * a40);
  a26 = a21 * a16 + a14 * a23 + a20 * a26;
  if (res[1]) res[1][0] = (-1.0) * (a15 * a27 + a21 * a26 + a10 * a18);
  if (res[1]) res[1][1] = (-1.0) * (a22 * a27 + a14 * a26 + a11 * a18);
  if (res[1]) res[1][2] = (-1.0) * (a25 * a27 + a20 * a26 + a12 * a18);
  a18 = C[16] * a26;
  a23 = C[17] * a26;
  a16 = C[18] * a26;
  a40 = C[19] * a26;
  a28 = C[70] * a26 + a4 * a23 + a38 * a16 + a36 * a40 + a32 * a16 + a28 * a23;
  a28 = a15 * a19 + a22 * a17 + a25 * a13 - a9 * a18 - a28;
  a24 = C[70] * a27 + a2 + a1 + a7 + a34 + a30 + a24;
  a13 = a39 * a23 + a3 * a16 + a5 * a40 + a6 * a16 + a0 * a23 + (a8 * a18 + (a10 * a19 + a11 * a17 + a12 * a13));
  if (res[2]) res[2][0] = (-1.0) * (a15 * a28 + a21 * a24 + a10 * a13);
  if (res[2]) res[2][1] = (-1.0) * (a22 * a28 + a14 * a24 + a11 * a13);
  if (res[2]) res[2][2] = (-1.0) * (a25 * a28 + a20 * a24 + a12 * a13);
  return 0;
}

static int MADE(planar_strip_k_tip)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a4 = a2 - a6;
  w[42] = a2 + a6;
  w[43] = a7 + a3;
  w[44] = a1 + a5;
  w[45] = a1 - a5;
  w[46] = a7 - a3;
  w[47] = a4;
  w[48] = a4;
  w[49] = a4;
  MADE(planar_strip_kernels_increments)(w + 42, w + 2, 2);
  a4 = w[2] * w[3] - w[6] * w[7];
  a3 = w[2] * w[7] + w[6] * w[3];
  a7 = a4 * w[4] - a3 * w[8];
  a5 = a4 * w[8] + a3 * w[4];
  a1 = a7 * w[5] - a5 * w[9];
  a6 = a7 * w[9] + a5 * w[5];
  a2 = C[68] * (2.0 * a1 * a6);
  a0 = a1 * w[22] - a6 * w[26];
  a1 = a1 * w[26] + a6 * w[22];
  a8 = C[69] * (2.0 * a0 * a1);
  a9 = a0 * w[23] - a1 * w[27];
  a0 = a0 * w[27] + a1 * w[23];
  a10 = C[70] * (2.0 * a9 * a0);
  a10 = C[69] * (2.0 * w[2] * w[6]) + C[68] * (2.0 * a4 * a3) + C[71] * (2.0 * a7 * a5) + a2 + a8 + a10;
  a5 = C[71] * (1.0 - 2.0 * a5 * a5);
  a6 = C[68] * (1.0 - 2.0 * a6 * a6);
  a1 = C[69] * (1.0 - 2.0 * a1 * a1);
  a8 = C[70] * (1.0 - 2.0 * a0 * a0);
  a8 = C[70] + C[69] * (1.0 - 2.0 * w[6] * w[6]) + C[68] * (1.0 - 2.0 * a3 * a3) + a5 + a6 + a1 + a8;
  if (res[0]) res[0][0] = a10 + a8 - C[72] * a10;
  if (res[0]) res[0][1] = 0.0;
  if (res[0]) res[0][2] = a8 - a10 - C[72] * a8;
  if (res[1]) res[1][0] = C[14] * a9 - C[15] * a0;
  if (res[1]) res[1][1] = 0.0;
  if (res[1]) res[1][2] = C[14] * a0 + C[15] * a9;
  if (res[1]) res[1][3] = 0.0;
  return 0;
}

static int MADE(planar_strip_k_tip_jacobian)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8;
  MADE(planar_strip_kernels_turning)(planar_strip_kernels_table_0, w + 42);
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a4 = a2 - a6;
  w[43] = a2 + a6;
  w[44] = a7 + a3;
  w[45] = a1 + a5;
  w[46] = a1 - a5;
  w[47] = a7 - a3;
  w[48] = a4;
  w[49] = a4;
  w[50] = a4;
  MADE(planar_strip_kernels_increments)(w + 43, w + 2, 2);
  w[52] = C[69] * (1.0 - 2.0 * w[6] * w[6]);
  a4 = w[2] * w[7] + w[6] * w[3];
  w[53] = C[68] * (1.0 - 2.0 * a4 * a4);
  a3 = w[2] * w[3] - w[6] * w[7];
  a7 = a3 * w[8] + a4 * w[4];
  w[54] = C[71] * (1.0 - 2.0 * a7 * a7);
  a5 = a3 * w[4] - a4 * w[8];
  a1 = a5 * w[9] + a7 * w[5];
  w[55] = C[68] * (1.0 - 2.0 * a1 * a1);
  a6 = a5 * w[5] - a7 * w[9];
  a2 = a6 * w[26] + a1 * w[22];
  w[56] = C[69] * (1.0 - 2.0 * a2 * a2);
  a0 = a6 * w[22] - a1 * w[26];
  w[64] = a8 = a0 * w[27] + a2 * w[23];
  w[57] = C[70] * (1.0 - 2.0 * a8 * a8);
  w[58] = C[69] * (2.0 * w[2] * w[6]);
  w[59] = C[68] * (2.0 * a3 * a4);
  w[60] = C[71] * (2.0 * a5 * a7);
  w[61] = C[68] * (2.0 * a6 * a1);
  w[62] = C[69] * (2.0 * a0 * a2);
  w[65] = a2 = a0 * w[23] - a2 * w[27];
  w[63] = C[70] * (2.0 * a2 * a8);
  MADE(planar_strip_k_tip_jacobian_columns)(w, planar_strip_kernels_table_1, w + 66, w + 94, 1);
  if (res[0]) res[0][0] = w[66];
  if (res[0]) res[0][1] = w[70];
  if (res[0]) res[0][2] = w[74];
  if (res[0]) res[0][3] = w[78];
  if (res[0]) res[0][4] = w[82];
  if (res[0]) res[0][5] = w[86];
  if (res[0]) res[0][6] = w[90];
  if (res[0]) res[0][7] = w[67];
  if (res[0]) res[0][8] = w[71];
  if (res[0]) res[0][9] = w[75];
  if (res[0]) res[0][10] = w[79];
  if (res[0]) res[0][11] = w[83];
  if (res[0]) res[0][12] = w[87];
  if (res[0]) res[0][13] = w[91];
  if (res[0]) res[0][14] = w[68];
  if (res[0]) res[0][15] = w[72];
  if (res[0]) res[0][16] = w[76];
  if (res[0]) res[0][17] = w[80];
  if (res[0]) res[0][18] = w[84];
  if (res[0]) res[0][19] = w[88];
  if (res[0]) res[0][20] = w[92];
  if (res[0]) res[0][21] = w[69];
  if (res[0]) res[0][22] = w[73];
  if (res[0]) res[0][23] = w[77];
  if (res[0]) res[0][24] = w[81];
  if (res[0]) res[0][25] = w[85];
  if (res[0]) res[0][26] = w[89];
  if (res[0]) res[0][27] = w[93];
  if (res[1]) res[1][0] = 0.0;
  if (res[1]) res[1][1] = 0.0;
  if (res[1]) res[1][2] = 0.0;
  if (res[1]) res[1][3] = 0.0;
  if (res[1]) res[1][4] = 0.0;
  if (res[1]) res[1][5] = 0.0;
  if (res[1]) res[1][6] = 0.0;
  if (res[1]) res[1][7] = 0.0;
  if (res[1]) res[1][8] = 0.0;
  if (res[1]) res[1][9] = 0.0;
  if (res[1]) res[1][10] = 0.0;
  if (res[1]) res[1][11] = 0.0;
  if (res[1]) res[1][12] = 0.0;
  if (res[1]) res[1][13] = 0.0;
  if (res[1]) res[1][14] = 0.0;
  if (res[1]) res[1][15] = 0.0;
  if (res[1]) res[1][16] = 0.0;
  if (res[1]) res[1][17] = 0.0;
  if (res[1]) res[1][18] = 0.0;
  if (res[1]) res[1][19] = 0.0;
  if (res[1]) res[1][20] = 0.0;
  if (res[1]) res[1][21] = 0.0;
  if (res[1]) res[1][22] = 0.0;
  if (res[1]) res[1][23] = 0.0;
  if (res[1]) res[1][24] = 0.0;
  if (res[1]) res[1][25] = 0.0;
  if (res[1]) res[1][26] = 0.0;
  if (res[1]) res[1][27] = 0.0;
  if (res[1]) res[1][28] = 0.0;
  if (res[1]) res[1][29] = 0.0;
  if (res[1]) res[1][30] = 0.0;
  if (res[1]) res[1][31] = 0.0;
  if (res[1]) res[1][32] = 0.0;
  if (res[1]) res[1][33] = 0.0;
  if (res[1]) res[1][34] = 0.0;
  if (res[1]) res[1][35] = 0.0;
  if (res[1]) res[1][36] = 0.0;
  if (res[1]) res[1][37] = 0.0;
  if (res[1]) res[1][38] = 0.0;
  if (res[1]) res[1][39] = 0.0;
  if (res[1]) res[1][40] = 0.0;
  if (res[1]) res[1][41] = 0.0;
  return 0;
}

static int MADE(planar_strip_k_shape)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[2] * a0 + C[7] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[5] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[10] * a5;
  a7 = C[3] * a0 + C[8] * a1;
  a3 = C[6] * a3 + C[11] * a5;
  a1 = C[4] * a0 + C[9] * a1;
  a5 = a4 + C[12] * a5;
  a4 = a2 - a6;
  w[42] = a2 + a6;
  w[43] = a7 + a3;
  w[44] = a1 + a5;
  w[45] = a1 - a5;
  w[46] = a7 - a3;
  w[47] = a4;
  w[48] = a4;
  w[49] = a4;
  MADE(planar_strip_kernels_increments)(w + 42, w + 2, 2);
  a4 = 2.0 * w[2] * w[6];
  a3 = w[2] * w[3] - w[6] * w[7];
  a7 = w[2] * w[7] + w[6] * w[3];
  a5 = 2.0 * a3 * a7;
  a1 = a3 * w[4] - a7 * w[8];
  a6 = a3 * w[8] + a7 * w[4];
  a2 = 2.0 * a1 * a6;
  a0 = a1 * w[5] - a6 * w[9];
  a8 = a1 * w[9] + a6 * w[5];
  a9 = 2.0 * a0 * a8;
  a10 = a0 * w[22] - a8 * w[26];
  a11 = a0 * w[26] + a8 * w[22];
  a12 = 2.0 * a10 * a11;
  a13 = a10 * w[23] - a11 * w[27];
  a14 = a10 * w[27] + a11 * w[23];
  a15 = 2.0 * a13 * a14;
  a16 = 2.0 * ENTRY(2, 0) - 1.0;
  a17 = 2.0 * a16;
  a18 = a17 * a16 - 1.0;
  a19 = C[73] * a18;
  a20 = a17 * a18 - a16;
  a21 = a17 * a20 - a18;
  a22 = C[74] * a21;
  a23 = a17 * a21 - a20;
  a17 = a17 * a23 - a21;
  a24 = C[75] * a17;
  a25 = C[0] + C[76] * a16 + a19 + a22 + C[77] * a23 + a24;
  a26 = C[74] * a18;
  a27 = C[0] * a17;
  a28 = C[0] + C[74] * a16 + a26 + C[78] * a20 + a22 + C[74] * a23 + a27;
  a29 = (C[79] * a4 + C[80] * a5 + C[81] * a2 + C[82] * a9 + C[83] * a12 + C[84] * a15) * a28;
  a30 = C[0] + C[85] * a18 + C[78] * a21 + a24;
  a31 = (C[86] * a4 + C[87] * a5 + C[88] * a2 + C[89] * a9 + C[90] * a12 + C[91] * a15) * a30;
  a27 = C[0] + C[73] * a16 + a26 + C[85] * a20 + a22 + C[73] * a23 + a27;
  a31 = (C[92] * a4 + C[93] * a5 + C[94] * a2 + C[95] * a9 + C[96] * a12 + C[97] * a15) * a25 + a29 + a31;
  a24 = C[0] + C[77] * a16 + a19 + a22 + C[76] * a23 + a24;
  a22 = (C[98] * a4 + C[99] * a5 + C[100] * a2 + C[101] * a9 + C[102] * a12 + C[103] * a15) * a24;
  a18 = C[0] * a18;
  a21 = C[0] * a21;
  a17 = C[104] * a17;
  a19 = C[104] + C[0] * a16 + a18 + C[0] * a20 + a21 + C[0] * a23 + a17;
  a22 = a31 + (C[105] * a4 + C[106] * a5 + C[107] * a2 + C[108] * a9 + C[109] * a12 + C[110] * a15) * a27 + a22;
  a15 = a22 + (C[69] * a4 + C[68] * a5 + C[71] * a2 + C[68] * a9 + C[69] * a12 + C[70] * a15) * a19;
  a12 = 1.0 - 2.0 * w[6] * w[6];
  a9 = 1.0 - 2.0 * a7 * a7;
  a2 = 1.0 - 2.0 * a6 * a6;
  a5 = 1.0 - 2.0 * a8 * a8;
  a4 = 1.0 - 2.0 * a11 * a11;
  a22 = 1.0 - 2.0 * a14 * a14;
  a31 = (C[84] + C[79] * a12 + C[80] * a9 + C[81] * a2 + C[82] * a5 + C[83] * a4 + C[84] * a22) * a28;
  a31 = (0.008165292531919034 + C[92] * a12 + C[93] * a9 + C[94] * a2 + C[95] * a5 + C[96] * a4 + C[97] * a22) * a25 + a31;
  a31 = a31 + (0.006309523809523807 + C[86] * a12 + C[87] * a9 + C[88] * a2 + C[89] * a5 + C[90] * a4 + C[91] * a22) * a30;
  a31 = a31 + (C[110] + C[105] * a12 + C[106] * a9 + C[107] * a2 + C[108] * a5 + C[109] * a4 + C[110] * a22) * a27;
  a31 = a31 + (0.0044537550871285815 + C[98] * a12 + C[99] * a9 + C[100] * a2 + C[101] * a5 + C[102] * a4 + C[103] * a22) * a24;
  a22 = a31 + (C[70] + C[69] * a12 + C[68] * a9 + C[71] * a2 + C[68] * a5 + C[69] * a4 + C[70] * a22) * a19;
  if (res[0]) res[0][0] = a15 + a22 - C[72] * a15;
  if (res[0]) res[0][1] = 0.0;
  if (res[0]) res[0][2] = a22 - a15 - C[72] * a22;
  a1 = C[104] + C[75] * a16 + a18 + C[75] * a20 + a21 + C[75] * a23 + a17 + w[2] * a25 + a3 * a28 + a1 * a30;
  a13 = a1 + a0 * a27 + a10 * a24 + a13 * a19;
  a19 = w[6] * a25 + a7 * a28 + a6 * a30 + a8 * a27 + a11 * a24 + a14 * a19;
  a14 = sqrt(a13 * a13 + a19 * a19);
  a13 = a13 / a14;
  a14 = a19 / a14;
  if (res[1]) res[1][0] = C[14] * a13 - C[15] * a14;
  if (res[1]) res[1][1] = 0.0;
  if (res[1]) res[1][2] = C[14] * a14 + C[15] * a13;
  if (res[1]) res[1][3] = 0.0;
  return 0;
}

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
#undef MADE
#undef ENTRY

#define KERNEL(kernel)                                                                                             \
  CASADI_SYMBOL_EXPORT int kernel(const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w,      \
                                  int mem) {                                                                       \
    (void)iw;                                                                                                      \
    (void)mem;                                                                                                     \
    return kernel##_once(arg, res, w);                                                                             \
  }
KERNEL(planar_strip_k_residual)
KERNEL(planar_strip_k_jacobian)
KERNEL(planar_strip_k_rate)
KERNEL(planar_strip_k_tangent)
KERNEL(planar_strip_k_resolution_index)
KERNEL(planar_strip_k_richer_balance)
KERNEL(planar_strip_k_watched)
KERNEL(planar_strip_k_igm)
KERNEL(planar_strip_k_tip)
KERNEL(planar_strip_k_tip_jacobian)
KERNEL(planar_strip_k_shape)
#ifdef __cplusplus
} /* extern "C" */
#endif
