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
static const casadi_real planar_strip_kernels_table_0[24] = {
 0.066987298107780688,-0.062500000000000014,0.054126587736527412,-0.042968749999999979,0.18301270189221933,
 -0.12499999999999999,0.039623412263472567,0.031250000000000014,0.25000000000000011,-0.062500000000000014,
 -0.093750000000000014,0.074218750000000014,0.25000000000000011,0.062500000000000014,-0.093750000000000014,
 -0.074218750000000014,0.18301270189221933,0.12499999999999999,0.039623412263472567,-0.031250000000000014,
 0.066987298107780688,0.062500000000000014,0.054126587736527412,0.042968749999999979};
static const double planar_strip_kernels_numbers[89] = {
 0.16666666666666666,-1.1164549684630112,-3.050211698203655,-4.166666666666668,1.0416666666666667,
 2.0833333333333326,-0.90210979560879,-0.6603902043912093,0.7161458333333328,-0.5208333333333335,
 -1.2369791666666667,2.220446049250313e-16,0.7071067811865476,0.7071067811865475,0.06698729810778069,
 0.05412658773652741,-0.06250000000000001,-0.04296874999999998,0.18301270189221933,0.03962341226347257,
 -0.12499999999999999,0.031250000000000014,0.2500000000000001,-0.09375000000000001,0.07421875000000001,
 0.01428571428571429,0.126984126984127,0.22857142857142856,0.26031746031746034,0.33333333333333337,
 0.19999999999999987,0.14285714285714252,0.005050505050505055,0.047289527441850776,0.09281760721212388,
 0.12679416664184331,0.14960663521211853,0.1568831168831169,0.3978812617188595,1.041666666666667,
 0.014186858232555232,0.027845282163637165,0.038038249992552994,0.04488199056363556,0.047064935064935066,
 0.0015151515151515165,0.06857142857142856,0.0380952380952381,0.004285714285714287,0.07809523809523809,
 0.9999999999999998,0.16666666666666663,-0.16666666666666663,-0.16666666666666666,-0.28867513459481287,
 0.28867513459481287,0.3333333333333333,0.04638077400524685,0.031205357142857135,-0.005476190476190479,
 0.003080357142857142,-0.0023331549576278126,0.0010714285714285717,-0.3333333333333333,0.03348137577735969,
 0.07595238095238092,0.03904761904761904,-0.007380952380952386,0.004613862317878401,-0.0020238095238095228,
 0.012990596134245738,-0.001494724773128336,0.0006950654514510509,-0.0004530581064616681,0.0003610589957226777,
 -0.00016804080141429836,0.0377341790995154,0.06902448667789023,0.07740017264378703,0.07006615334455689,
 0.025104641960992356,-0.0038795782462047452,0.08333333333333333,0.0404283930528659,0.06549107142857141,
 0.08357142857142853,0.037366071428571415,-0.00828553591000876,0.003214285714285716};
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
static void MADE(planar_strip_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  IN_FOURS(planar_strip_kernels_pulls, (given, made, turns));
}
static void MADE(planar_strip_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  IN_FOURS(planar_strip_kernels_variations, (given, made, turns));
}
static void MADE(planar_strip_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  IN_FOURS(planar_strip_kernels_fwd1_pulls, (given, made, turns));
}
static void MADE(planar_strip_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  IN_FOURS(planar_strip_kernels_turnings, (given, made, turns));
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
static int MADE(planar_strip_k_residual)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35, a36, a37, a38, a39, a40, a41, a42, a43, a44, a45;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = a2 + a6;
  a8 = C[18] * a0 + C[19] * a1;
  a9 = C[20] * a3 + C[21] * a5;
  a10 = a8 + a9;
  a11 = C[22] * a0 + C[23] * a1;
  a4 = a4 + C[24] * a5;
  a12 = a11 + a4;
  a4 = a11 - a4;
  a9 = a8 - a9;
  a6 = a2 - a6;
  w[48] = a7;
  w[49] = a10;
  w[50] = a12;
  w[51] = a4;
  w[52] = a9;
  w[53] = a6;
  w[54] = a6;
  w[55] = a6;
  MADE(planar_strip_kernels_increments)(w + 48, w + 0, 2);
  a2 = w[0] * w[1] - w[4] * w[5];
  a8 = w[0] * w[5] + w[4] * w[1];
  a11 = a2 * w[2] - a8 * w[6];
  a13 = a2 * w[6] + a8 * w[2];
  a14 = a11 * w[3] - a13 * w[7];
  a15 = a11 * w[7] + a13 * w[3];
  a16 = a14 * w[20] - a15 * w[24];
  a17 = a14 * w[24] + a15 * w[20];
  a18 = a16 * w[25] + a17 * w[21];
  a19 = 0.3 * (1.0 - 2.0 * a18 * a18);
  a20 = ENTRY(2, 0);
  a21 = a20 * ENTRY(1, 1);
  a22 = C[25] * a21;
  a23 = a19 * a22 + a20 * ENTRY(1, 5);
  a24 = 1.0 - 2.0 * a17 * a17;
  a25 = 0.3 * a24;
  a26 = C[26] * a21;
  a27 = a23 + a25 * a26;
  a28 = 1.0 - 2.0 * a15 * a15;
  a29 = 0.3 * a28;
  a30 = C[27] * a21;
  a31 = a27 + a29 * a30;
  a32 = 1.0 - 2.0 * a13 * a13;
  a33 = 0.3 * a32;
  a21 = C[28] * a21;
  a34 = a31 + a33 * a21;
  a35 = 1.0 - 2.0 * a8 * a8;
  a36 = 0.3 * a35;
  a37 = a34 + a36 * a30;
  a38 = 1.0 - 2.0 * w[4] * w[4];
  a39 = 0.3 * a38;
  a40 = a20 * ENTRY(1, 2);
  a18 = 0.3 * (2.0 * (a16 * w[21] - a17 * w[25]) * a18);
  a41 = a20 * ENTRY(1, 0);
  a19 = a20 * ENTRY(1, 4) - (a19 * (C[25] * a40) + a18 * (C[25] * a41));
  a42 = C[26] * a40;
  a17 = 2.0 * a16 * a17;
  a16 = 0.3 * a17;
  a43 = C[26] * a41;
  a25 = a19 - (a25 * a42 + a16 * a43);
  a44 = C[27] * a40;
  a15 = 2.0 * a14 * a15;
  a14 = 0.3 * a15;
  a45 = C[27] * a41;
  a29 = a25 - (a29 * a44 + a14 * a45);
  a13 = 2.0 * a11 * a13;
  a11 = 0.3 * a13;
  a41 = a29 - (a33 * (C[28] * a40) + a11 * (C[28] * a41));
  a8 = 2.0 * a2 * a8;
  a2 = 0.3 * a8;
  a45 = a41 - (a36 * a44 + a2 * a45);
  a44 = 2.0 * w[0] * w[4];
  a36 = 0.3 * a44;
  a20 = a18 * a22 + a20 * ENTRY(1, 3);
  a16 = a20 + a16 * a26;
  a14 = a16 + a14 * a30;
  a21 = a14 + a11 * a21;
  a30 = a21 + a2 * a30;
  a2 = (-1.0) * a13;
  a31 = (-1.0) * a31;
  w[48] = a7;
  w[52] = w[8];
  w[56] = w[12];
  w[60] = w[16];
  w[64] = 1.0;
  w[68] = 0.0;
  w[72] = 1.0;
  w[76] = 0.0;
  w[80] = 1.0;
  w[84] = (-1.0) * (a37 + a39 * a26);
  w[88] = a45 - (a39 * a42 + a36 * a43);
  w[92] = a30 + a36 * a26;
  w[49] = a6;
  w[53] = w[29];
  w[57] = w[33];
  w[61] = w[37];
  w[65] = a24;
  w[69] = (-1.0) * a17;
  w[73] = 1.0;
  w[77] = a17;
  w[81] = a24;
  w[85] = (-1.0) * a23;
  w[89] = a19;
  w[93] = a20;
  w[50] = a10;
  w[54] = w[9];
  w[58] = w[13];
  w[62] = w[17];
  w[66] = a38;
  w[70] = (-1.0) * a44;
  w[74] = 1.0;
  w[78] = a44;
  w[82] = a38;
  w[86] = (-1.0) * a37;
  w[90] = a45;
  w[94] = a30;
  w[51] = a9;
  w[55] = w[28];
  w[59] = w[32];
  w[63] = w[36];
  w[67] = a28;
  w[71] = (-1.0) * a15;
  w[75] = 1.0;
  w[79] = a15;
  w[83] = a28;
  w[87] = (-1.0) * a27;
  w[91] = a25;
  w[95] = a16;
  w[96] = a12;
  w[100] = w[10];
  w[104] = w[14];
  w[108] = w[18];
  w[112] = a35;
  w[116] = (-1.0) * a8;
  w[120] = 1.0;
  w[124] = a8;
  w[128] = a35;
  w[132] = (-1.0) * a34;
  w[136] = a41;
  w[140] = a21;
  w[97] = a4;
  w[101] = w[11];
  w[105] = w[15];
  w[109] = w[19];
  w[113] = a32;
  w[117] = a2;
  w[121] = 1.0;
  w[125] = a13;
  w[129] = a32;
  w[133] = a31;
  w[137] = a29;
  w[141] = a14;
  w[98] = a4;
  w[102] = w[11];
  w[106] = w[15];
  w[110] = w[19];
  w[114] = a32;
  w[118] = a2;
  w[122] = 1.0;
  w[126] = a13;
  w[130] = a32;
  w[134] = a31;
  w[138] = a29;
  w[142] = a14;
  w[99] = a4;
  w[103] = w[11];
  w[107] = w[15];
  w[111] = w[19];
  w[115] = a32;
  w[119] = a2;
  w[123] = 1.0;
  w[127] = a13;
  w[131] = a32;
  w[135] = a31;
  w[139] = a29;
  w[143] = a14;
  MADE(planar_strip_kernels_pulls)(w + 48, w + 40, 2);
  a14 = w[40] + w[41];
  a29 = w[42] + w[43];
  a31 = w[44] + w[45];
  res[0][0] = a0 + (C[1] * a14 + C[2] * a29 + C[3] * a31);
  a0 = w[40] - w[41];
  a32 = w[42] - w[43];
  a13 = w[44] - w[45];
  res[0][1] = C[29] * a3 + (C[4] * a0 + C[5] * a32 + C[4] * a13);
  res[0][2] = C[30] * a1 + (C[6] * a14 + C[7] * a29 + 1.5625 * a31);
  res[0][3] = C[31] * a5 + (C[8] * a0 + C[9] * a32 + C[10] * a13);
  return 0;
}

static int MADE(planar_strip_k_jacobian)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35, a36, a37, a38, a39, a40, a41, a42, a43, a44, a45, a46, a47;
  casadi_real a48, a49, a50, a51, a52;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = a2 + a6;
  a8 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  a9 = a8 + a3;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  a4 = a1 + a5;
  a5 = a1 - a5;
  a3 = a8 - a3;
  a6 = a2 - a6;
  w[112] = a7;
  w[113] = a9;
  w[114] = a4;
  w[115] = a5;
  w[116] = a3;
  w[117] = a6;
  w[118] = a6;
  w[119] = a6;
  MADE(planar_strip_kernels_increments)(w + 112, w + 0, 2);
  a2 = w[0] * w[1] - w[4] * w[5];
  a8 = w[0] * w[5] + w[4] * w[1];
  a1 = a2 * w[2] - a8 * w[6];
  a0 = a2 * w[6] + a8 * w[2];
  a10 = a1 * w[3] - a0 * w[7];
  a11 = a1 * w[7] + a0 * w[3];
  a12 = a10 * w[20] - a11 * w[24];
  a13 = a10 * w[24] + a11 * w[20];
  a14 = a12 * w[25] + a13 * w[21];
  a15 = 0.3 * (1.0 - 2.0 * a14 * a14);
  a16 = ENTRY(2, 0);
  a17 = a16 * ENTRY(1, 1);
  a18 = C[25] * a17;
  a19 = a15 * a18 + a16 * ENTRY(1, 5);
  a20 = 1.0 - 2.0 * a13 * a13;
  a21 = 0.3 * a20;
  a22 = C[26] * a17;
  a23 = a19 + a21 * a22;
  a24 = 1.0 - 2.0 * a11 * a11;
  a25 = 0.3 * a24;
  a26 = C[27] * a17;
  a27 = a23 + a25 * a26;
  a28 = 1.0 - 2.0 * a0 * a0;
  a29 = 0.3 * a28;
  a17 = C[28] * a17;
  a30 = a27 + a29 * a17;
  a31 = 1.0 - 2.0 * a8 * a8;
  a32 = 0.3 * a31;
  a33 = a30 + a32 * a26;
  a34 = 1.0 - 2.0 * w[4] * w[4];
  a35 = 0.3 * a34;
  a36 = a16 * ENTRY(1, 2);
  a37 = C[25] * a36;
  a14 = 0.3 * (2.0 * (a12 * w[21] - a13 * w[25]) * a14);
  a38 = a16 * ENTRY(1, 0);
  a39 = C[25] * a38;
  a40 = a16 * ENTRY(1, 4) - (a15 * a37 + a14 * a39);
  a41 = C[26] * a36;
  a13 = 2.0 * a12 * a13;
  a12 = 0.3 * a13;
  a42 = C[26] * a38;
  a43 = a40 - (a21 * a41 + a12 * a42);
  a44 = C[27] * a36;
  a11 = 2.0 * a10 * a11;
  a10 = 0.3 * a11;
  a45 = C[27] * a38;
  a46 = a43 - (a25 * a44 + a10 * a45);
  a36 = C[28] * a36;
  a0 = 2.0 * a1 * a0;
  a1 = 0.3 * a0;
  a38 = C[28] * a38;
  a47 = a46 - (a29 * a36 + a1 * a38);
  a8 = 2.0 * a2 * a8;
  a2 = 0.3 * a8;
  a48 = a47 - (a32 * a44 + a2 * a45);
  a49 = 2.0 * w[0] * w[4];
  a50 = 0.3 * a49;
  a16 = a14 * a18 + a16 * ENTRY(1, 3);
  a18 = a16 + a12 * a22;
  a51 = a18 + a10 * a26;
  a17 = a51 + a1 * a17;
  a26 = a17 + a2 * a26;
  a52 = (-1.0) * a13;
  a19 = (-1.0) * a19;
  w[112] = a7;
  w[116] = w[8];
  w[120] = w[12];
  w[124] = w[16];
  w[128] = 1.0;
  w[132] = 0.0;
  w[136] = 1.0;
  w[140] = 0.0;
  w[144] = 1.0;
  w[148] = (-1.0) * (a33 + a35 * a22);
  w[152] = a48 - (a35 * a41 + a50 * a42);
  w[156] = a26 + a50 * a22;
  w[113] = a9;
  w[117] = w[9];
  w[121] = w[13];
  w[125] = w[17];
  w[129] = a34;
  w[133] = (-1.0) * a49;
  w[137] = 1.0;
  w[141] = a49;
  w[145] = a34;
  w[149] = (-1.0) * a33;
  w[153] = a48;
  w[157] = a26;
  w[114] = a4;
  w[118] = w[10];
  w[122] = w[14];
  w[126] = w[18];
  w[130] = a31;
  w[134] = (-1.0) * a8;
  w[138] = 1.0;
  w[142] = a8;
  w[146] = a31;
  w[150] = (-1.0) * a30;
  w[154] = a47;
  w[158] = a17;
  w[115] = a5;
  w[119] = w[11];
  w[123] = w[15];
  w[127] = w[19];
  w[131] = a28;
  w[135] = (-1.0) * a0;
  w[139] = 1.0;
  w[143] = a0;
  w[147] = a28;
  w[151] = (-1.0) * a27;
  w[155] = a46;
  w[159] = a51;
  w[160] = a3;
  w[164] = w[28];
  w[168] = w[32];
  w[172] = w[36];
  w[176] = a24;
  w[180] = (-1.0) * a11;
  w[184] = 1.0;
  w[188] = a11;
  w[192] = a24;
  w[196] = (-1.0) * a23;
  w[200] = a43;
  w[204] = a18;
  w[161] = a6;
  w[165] = w[29];
  w[169] = w[33];
  w[173] = w[37];
  w[177] = a20;
  w[181] = a52;
  w[185] = 1.0;
  w[189] = a13;
  w[193] = a20;
  w[197] = a19;
  w[201] = a40;
  w[205] = a16;
  w[162] = a6;
  w[166] = w[29];
  w[170] = w[33];
  w[174] = w[37];
  w[178] = a20;
  w[182] = a52;
  w[186] = 1.0;
  w[190] = a13;
  w[194] = a20;
  w[198] = a19;
  w[202] = a40;
  w[206] = a16;
  w[163] = a6;
  w[167] = w[29];
  w[171] = w[33];
  w[175] = w[37];
  w[179] = a20;
  w[183] = a52;
  w[187] = 1.0;
  w[191] = a13;
  w[195] = a20;
  w[199] = a19;
  w[203] = a40;
  w[207] = a16;
  MADE(planar_strip_kernels_variations)(w + 112, w + 40, 2);
  w[214] = a37 * a14 - a39 * a15;
  w[215] = a41 * a12 - a42 * a21;
  w[216] = a44 * a10 - a45 * a25;
  w[217] = a36 * a1 - a38 * a29;
  w[218] = a44 * a2 - a45 * a32;
  w[219] = a41 * a50 - a42 * a35;
  MADE(planar_strip_k_jacobian_columns)(w, planar_strip_kernels_table_0 + 0, w + 220, w + 236, 1);
  res[0][0] = 1.0 + w[220];
  res[0][1] = w[221];
  res[0][2] = w[222];
  res[0][3] = w[223];
  res[0][4] = w[221];
  res[0][5] = C[29] + w[225];
  res[0][6] = w[226];
  res[0][7] = w[227];
  res[0][8] = w[222];
  res[0][9] = w[226];
  res[0][10] = C[30] + w[230];
  res[0][11] = w[231];
  res[0][12] = w[223];
  res[0][13] = w[227];
  res[0][14] = w[231];
  res[0][15] = C[31] + w[235];
  return 0;
}

static void MADE(planar_strip_k_rate_part_0)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  w[257] = a7 = a2 + a6;
  a8 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  w[269] = a9 = a8 + a3;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  w[280] = a4 = a1 + a5;
  w[286] = a5 = a1 - a5;
  w[274] = a3 = a8 - a3;
  w[263] = a6 = a2 - a6;
  w[48] = a7;
  w[49] = a9;
  w[50] = a4;
  w[51] = a5;
  w[52] = a3;
  w[53] = a6;
  w[54] = a6;
  w[55] = a6;
  MADE(planar_strip_kernels_increments)(w + 48, w + 0, 2);
  a6 = w[0] * w[1] - w[4] * w[5];
  a3 = w[0] * w[5] + w[4] * w[1];
  a5 = a6 * w[2] - a3 * w[6];
  a4 = a6 * w[6] + a3 * w[2];
  a9 = a5 * w[3] - a4 * w[7];
  a7 = a5 * w[7] + a4 * w[3];
  a2 = a9 * w[20] - a7 * w[24];
  a8 = a9 * w[24] + a7 * w[20];
  a1 = a2 * w[25] + a8 * w[21];
  a0 = 0.3 * (1.0 - 2.0 * a1 * a1);
  a10 = ENTRY(2, 0);
  a11 = ENTRY(1, 1);
  a12 = a10 * a11;
  a13 = C[25] * a12;
  a14 = ENTRY(1, 5);
  w[243] = a15 = a0 * a13 + a10 * a14;
  w[264] = a16 = 1.0 - 2.0 * a8 * a8;
  a16 = 0.3 * a16;
  a17 = C[26] * a12;
  w[249] = a15 = a15 + a16 * a17;
  w[275] = a18 = 1.0 - 2.0 * a7 * a7;
  a18 = 0.3 * a18;
  a19 = C[27] * a12;
  w[255] = a15 = a15 + a18 * a19;
  w[287] = a20 = 1.0 - 2.0 * a4 * a4;
  a20 = 0.3 * a20;
  a12 = C[28] * a12;
  w[252] = a15 = a15 + a20 * a12;
  w[281] = a21 = 1.0 - 2.0 * a3 * a3;
  a21 = 0.3 * a21;
  w[246] = a15 = a15 + a21 * a19;
  w[270] = a22 = 1.0 - 2.0 * w[4] * w[4];
  a22 = 0.3 * a22;
  w[258] = (-1.0) * (a15 + a22 * a17);
  a15 = ENTRY(1, 4);
  a23 = ENTRY(1, 2);
  a24 = a10 * a23;
  a1 = 0.3 * (2.0 * (a2 * w[21] - a8 * w[25]) * a1);
  a25 = ENTRY(1, 0);
  a26 = a10 * a25;
  w[265] = a27 = a10 * a15 - (a0 * (C[25] * a24) + a1 * (C[25] * a26));
  a28 = C[26] * a24;
  w[242] = a8 = 2.0 * a2 * a8;
  a8 = 0.3 * a8;
  a2 = C[26] * a26;
  w[276] = a27 = a27 - (a16 * a28 + a8 * a2);
  a29 = C[27] * a24;
  w[248] = a7 = 2.0 * a9 * a7;
  a7 = 0.3 * a7;
  a9 = C[27] * a26;
  w[288] = a27 = a27 - (a18 * a29 + a7 * a9);
  w[254] = a4 = 2.0 * a5 * a4;
  a4 = 0.3 * a4;
  w[282] = a26 = a27 - (a20 * (C[28] * a24) + a4 * (C[28] * a26));
  w[251] = a3 = 2.0 * a6 * a3;
  a3 = 0.3 * a3;
  w[271] = a9 = a26 - (a21 * a29 + a3 * a9);
  w[245] = a29 = 2.0 * w[0] * w[4];
  a29 = 0.3 * a29;
  w[259] = a9 - (a22 * a28 + a29 * a2);
  a2 = ENTRY(1, 3);
  w[266] = a13 = a1 * a13 + a10 * a2;
  w[277] = a13 = a13 + a8 * a17;
  w[289] = a13 = a13 + a7 * a19;
  w[283] = a12 = a13 + a4 * a12;
  w[272] = a19 = a12 + a3 * a19;
  w[260] = a19 + a29 * a17;
  a17 = ENTRY(4, 0);
  a11 = a11 * a17 + a10 * ENTRY(3, 1);
  a19 = C[25] * a11;
  w[244] = a14 = a0 * a19 + (a14 * a17 + a10 * ENTRY(3, 5));
  a12 = C[26] * a11;
  w[250] = a14 = a14 + a16 * a12;
  a13 = C[27] * a11;
  w[256] = a14 = a14 + a18 * a13;
  a11 = C[28] * a11;
  w[253] = a14 = a14 + a20 * a11;
  w[247] = a14 = a14 + a21 * a13;
  w[261] = (-1.0) * (a14 + a22 * a12);
  a23 = a23 * a17 + a10 * ENTRY(3, 2);
  a25 = a25 * a17 + a10 * ENTRY(3, 0);
  w[267] = a0 = a15 * a17 + a10 * ENTRY(3, 4) - (a0 * (C[25] * a23) + a1 * (C[25] * a25));
  a15 = C[26] * a23;
  a14 = C[26] * a25;
  w[278] = a16 = a0 - (a16 * a15 + a8 * a14);
  a0 = C[27] * a23;
  a28 = C[27] * a25;
  w[290] = a18 = a16 - (a18 * a0 + a7 * a28);
  w[284] = a25 = a18 - (a20 * (C[28] * a23) + a4 * (C[28] * a25));
  w[273] = a28 = a25 - (a21 * a0 + a3 * a28);
  w[262] = a28 - (a22 * a15 + a29 * a14);
  w[268] = a10 = a1 * a19 + (a2 * a17 + a10 * ENTRY(3, 3));
  w[279] = a8 = a10 + a8 * a12;
  w[291] = a7 = a8 + a7 * a13;
  w[285] = a11 = a7 + a4 * a11;
  w[240] = a11 + a3 * a13;
  w[241] = a29 * a12;
}

static void MADE(planar_strip_k_rate_part_1)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5;
  a0 = (-1.0) * w[254];
  a1 = (-1.0) * w[255];
  a2 = (-1.0) * w[256];
  w[48] = w[257];
  w[52] = w[8];
  w[56] = w[12];
  w[60] = w[16];
  w[64] = 1.0;
  w[68] = 0.0;
  w[72] = 1.0;
  w[76] = 0.0;
  w[80] = 1.0;
  w[84] = w[258];
  w[88] = w[259];
  w[92] = w[260];
  w[96] = 0.0;
  w[100] = 0.0;
  w[104] = 0.0;
  w[108] = 0.0;
  w[112] = 0.0;
  w[116] = 0.0;
  w[120] = 0.0;
  w[124] = 0.0;
  w[128] = 0.0;
  w[132] = w[261];
  w[136] = w[262];
  w[140] = w[240] + w[241];
  w[49] = w[263];
  w[53] = w[29];
  w[57] = w[33];
  w[61] = w[37];
  w[65] = w[264];
  w[69] = (-1.0) * w[242];
  w[73] = 1.0;
  w[77] = w[242];
  w[81] = w[264];
  w[85] = (-1.0) * w[243];
  w[89] = w[265];
  w[93] = w[266];
  w[97] = 0.0;
  w[101] = 0.0;
  w[105] = 0.0;
  w[109] = 0.0;
  w[113] = 0.0;
  w[117] = 0.0;
  w[121] = 0.0;
  w[125] = 0.0;
  w[129] = 0.0;
  w[133] = (-1.0) * w[244];
  w[137] = w[267];
  w[141] = w[268];
  w[50] = w[269];
  w[54] = w[9];
  w[58] = w[13];
  w[62] = w[17];
  w[66] = w[270];
  w[70] = (-1.0) * w[245];
  w[74] = 1.0;
  w[78] = w[245];
  w[82] = w[270];
  w[86] = (-1.0) * w[246];
  w[90] = w[271];
  w[94] = w[272];
  w[98] = 0.0;
  w[102] = 0.0;
  w[106] = 0.0;
  w[110] = 0.0;
  w[114] = 0.0;
  w[118] = 0.0;
  w[122] = 0.0;
  w[126] = 0.0;
  w[130] = 0.0;
  w[134] = (-1.0) * w[247];
  w[138] = w[273];
  w[142] = w[240];
  w[51] = w[274];
  w[55] = w[28];
  w[59] = w[32];
  w[63] = w[36];
  w[67] = w[275];
  w[71] = (-1.0) * w[248];
  w[75] = 1.0;
  w[79] = w[248];
  w[83] = w[275];
  w[87] = (-1.0) * w[249];
  w[91] = w[276];
  w[95] = w[277];
  w[99] = 0.0;
  w[103] = 0.0;
  w[107] = 0.0;
  w[111] = 0.0;
  w[115] = 0.0;
  w[119] = 0.0;
  w[123] = 0.0;
  w[127] = 0.0;
  w[131] = 0.0;
  w[135] = (-1.0) * w[250];
  w[139] = w[278];
  w[143] = w[279];
  w[144] = w[280];
  w[148] = w[10];
  w[152] = w[14];
  w[156] = w[18];
  w[160] = w[281];
  w[164] = (-1.0) * w[251];
  w[168] = 1.0;
  w[172] = w[251];
  w[176] = w[281];
  w[180] = (-1.0) * w[252];
  w[184] = w[282];
  w[188] = w[283];
  w[192] = 0.0;
  w[196] = 0.0;
  w[200] = 0.0;
  w[204] = 0.0;
  w[208] = 0.0;
  w[212] = 0.0;
  w[216] = 0.0;
  w[220] = 0.0;
  w[224] = 0.0;
  w[228] = (-1.0) * w[253];
  w[232] = w[284];
  w[236] = w[285];
  w[145] = w[286];
  w[149] = w[11];
  w[153] = w[15];
  w[157] = w[19];
  w[161] = w[287];
  w[165] = a0;
  w[169] = 1.0;
  w[173] = w[254];
  w[177] = w[287];
  w[181] = a1;
  w[185] = w[288];
  w[189] = w[289];
  w[193] = 0.0;
  w[197] = 0.0;
  w[201] = 0.0;
  w[205] = 0.0;
  w[209] = 0.0;
  w[213] = 0.0;
  w[217] = 0.0;
  w[221] = 0.0;
  w[225] = 0.0;
  w[229] = a2;
  w[233] = w[290];
  w[237] = w[291];
  w[146] = w[286];
  w[150] = w[11];
  w[154] = w[15];
  w[158] = w[19];
  w[162] = w[287];
  w[166] = a0;
  w[170] = 1.0;
  w[174] = w[254];
  w[178] = w[287];
  w[182] = a1;
  w[186] = w[288];
  w[190] = w[289];
  w[194] = 0.0;
  w[198] = 0.0;
  w[202] = 0.0;
  w[206] = 0.0;
  w[210] = 0.0;
  w[214] = 0.0;
  w[218] = 0.0;
  w[222] = 0.0;
  w[226] = 0.0;
  w[230] = a2;
  w[234] = w[290];
  w[238] = w[291];
  w[147] = w[286];
  w[151] = w[11];
  w[155] = w[15];
  w[159] = w[19];
  w[163] = w[287];
  w[167] = a0;
  w[171] = 1.0;
  w[175] = w[254];
  w[179] = w[287];
  w[183] = a1;
  w[187] = w[288];
  w[191] = w[289];
  w[195] = 0.0;
  w[199] = 0.0;
  w[203] = 0.0;
  w[207] = 0.0;
  w[211] = 0.0;
  w[215] = 0.0;
  w[219] = 0.0;
  w[223] = 0.0;
  w[227] = 0.0;
  w[231] = a2;
  w[235] = w[290];
  w[239] = w[291];
  MADE(planar_strip_kernels_fwd1_pulls)(w + 48, w + 40, 2);
  a2 = w[40] + w[41];
  a1 = w[42] + w[43];
  a0 = w[44] + w[45];
  res[0][0] = C[1] * a2 + C[2] * a1 + C[3] * a0;
  a3 = w[40] - w[41];
  a4 = w[42] - w[43];
  a5 = w[44] - w[45];
  res[0][1] = C[4] * a3 + C[5] * a4 + C[4] * a5;
  res[0][2] = C[6] * a2 + C[7] * a1 + 1.5625 * a0;
  res[0][3] = C[8] * a3 + C[9] * a4 + C[10] * a5;
}

static int MADE(planar_strip_k_rate)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  MADE(planar_strip_k_rate_part_0)(arg, res, w);
  MADE(planar_strip_k_rate_part_1)(arg, res, w);
  return 0;
}

static int MADE(planar_strip_k_tangent)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0;
  a0 = ENTRY(0, 2);
  res[0][0] = (-2.5) * a0 + 16.666666666666668 * ENTRY(0, 4);
  res[0][1] = 2.5 * a0;
  res[0][2] = 0.0;
  res[0][3] = 0.0;
  return 0;
}

static int MADE(planar_strip_k_resolution_index)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  a5 = fmax(fmax(fmax(fmax(fabs(a2 + a6), fabs(a7 + a3)), fabs(a1 + a5)), fabs(a1 - a5)), fabs(a7 - a3));
  res[0][0] = fmax(0.0, fmax(a5, fabs(a2 - a6)) / 2.0);
  return 0;
}

static void MADE(planar_strip_k_richer_balance_part_0)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35;
  res[0][0] = 0.0;
  res[0][1] = 0.0;
  res[0][2] = 0.0;
  res[0][3] = 0.0;
  a0 = ENTRY(2, 0);
  w[274] = 0.11111111111111108 * a0;
  w[277] = a1 = ENTRY(0, 0) + ENTRY(1, 0);
  w[279] = a2 = ENTRY(0, 2) + ENTRY(1, 2);
  w[276] = a3 = ENTRY(2, 2);
  a4 = 0.024471741852423196 * a1 + 0.022704454000167518 * a2 + 0.018910309742393248 * a0 + 0.013802096031823582 * a3;
  w[278] = a5 = ENTRY(0, 1) + ENTRY(1, 1);
  a6 = (-0.023872875703131576) * a5;
  w[280] = a7 = ENTRY(0, 3) + ENTRY(1, 3);
  w[275] = a8 = ENTRY(2, 1);
  a9 = a6 + (-0.021023304731445713) * a7 + (-0.016465507592771385) * a8;
  w[236] = a10 = a4 + a9;
  a11 = 0.07101976096010308 * a1 + 0.047172670296700914 * a2 + 0.008718397354775344 * a0 + (-0.018157795823999668) * a3;
  a12 = (-0.06250000000000003) * a5;
  a13 = a12 + (-0.028048202685542784) * a7 + 0.007473120939939961 * a8;
  w[243] = a14 = a11 + a13;
  a15 = 0.11061587104123713 * a1 + 0.026300486239858253 * a2 + (-0.04161195739752335) * a0 + (-0.012784600203108981) * a3;
  a5 = (-0.07725424859373686) * a5 + 0.019313562148434202 * a7 + 0.03620008174560281 * a8;
  w[250] = a16 = a15 + a5;
  a17 = 0.13938412895876284 * a1 + (-0.026300486239858253) * a2 + (-0.026747417602476665) * a0 + 0.03841936582810897 * a3;
  a12 = a12 + 0.059298202685542784 * a7 + (-0.02309812093993996) * a8;
  w[258] = a18 = a17 + a12;
  a3 = 0.15450849718747373 * a1 + (-0.06987712429686843) * a2 + 0.04073066790283142 * a0 + (-0.021279065832823914) * a3;
  a8 = a6 + 0.032959742583011514 * a7 + (-0.035359574152831426) * a8;
  w[266] = a7 = a3 + a8;
  w[270] = a8 = a3 - a8;
  w[262] = a12 = a17 - a12;
  w[254] = a5 = a15 - a5;
  w[246] = a13 = a11 - a13;
  w[239] = a9 = a4 - a9;
  w[72] = a10;
  w[73] = a14;
  w[74] = a16;
  w[75] = a18;
  w[76] = a7;
  w[77] = a8;
  w[78] = a12;
  w[79] = a5;
  w[80] = a13;
  w[81] = a9;
  w[82] = a9;
  w[83] = a9;
  MADE(planar_strip_kernels_increments)(w + 72, w + 0, 3);
  a9 = w[0] * w[1] - w[4] * w[5];
  a13 = w[0] * w[5] + w[4] * w[1];
  a5 = a9 * w[2] - a13 * w[6];
  a12 = a9 * w[6] + a13 * w[2];
  a8 = a5 * w[3] - a12 * w[7];
  a7 = a5 * w[7] + a12 * w[3];
  a18 = a8 * w[20] - a7 * w[24];
  a16 = a8 * w[24] + a7 * w[20];
  a14 = a18 * w[21] - a16 * w[25];
  a10 = a18 * w[25] + a16 * w[21];
  a4 = a14 * w[22] - a10 * w[26];
  a11 = a14 * w[26] + a10 * w[22];
  a15 = a4 * w[23] - a11 * w[27];
  a17 = a4 * w[27] + a11 * w[23];
  a3 = a15 * w[40] - a17 * w[44];
  a6 = a15 * w[44] + a17 * w[40];
  w[284] = a0 = a3 * w[45] + a6 * w[41];
  w[282] = a2 = 1.0 - 2.0 * a0 * a0;
  a2 = 0.3 * a2;
  a1 = ENTRY(3, 1);
  a19 = C[32] * a1;
  w[219] = a20 = a2 * a19 + ENTRY(3, 5);
  w[240] = a21 = 1.0 - 2.0 * a6 * a6;
  a21 = 0.3 * a21;
  a22 = C[33] * a1;
  w[223] = a20 = a20 + a21 * a22;
  w[247] = a23 = 1.0 - 2.0 * a17 * a17;
  a23 = 0.3 * a23;
  a24 = C[34] * a1;
  w[227] = a20 = a20 + a23 * a24;
  w[255] = a25 = 1.0 - 2.0 * a11 * a11;
  a25 = 0.3 * a25;
  a26 = C[35] * a1;
  w[231] = a20 = a20 + a25 * a26;
  w[263] = a27 = 1.0 - 2.0 * a10 * a10;
  a27 = 0.3 * a27;
  a28 = C[36] * a1;
  w[235] = a20 = a20 + a27 * a28;
  w[271] = a29 = 1.0 - 2.0 * a16 * a16;
  a29 = 0.3 * a29;
  a1 = C[37] * a1;
  w[233] = a20 = a20 + a29 * a1;
  w[267] = a30 = 1.0 - 2.0 * a7 * a7;
  a30 = 0.3 * a30;
  w[229] = a20 = a20 + a30 * a28;
  w[259] = a31 = 1.0 - 2.0 * a12 * a12;
  a31 = 0.3 * a31;
  w[225] = a20 = a20 + a31 * a26;
  w[251] = a32 = 1.0 - 2.0 * a13 * a13;
  a32 = 0.3 * a32;
  w[221] = a20 = a20 + a32 * a24;
  w[244] = a33 = 1.0 - 2.0 * w[4] * w[4];
  a33 = 0.3 * a33;
  w[237] = (-1.0) * (a20 + a33 * a22);
  a20 = ENTRY(3, 2);
  w[283] = a34 = a3 * w[41] - a6 * w[45];
  w[281] = a0 = 2.0 * a34 * a0;
  a0 = 0.3 * a0;
  a34 = ENTRY(3, 0);
  w[241] = a2 = ENTRY(3, 4) - (a2 * (C[32] * a20) + a0 * (C[32] * a34));
  a35 = C[33] * a20;
  w[218] = a6 = 2.0 * a3 * a6;
  a6 = 0.3 * a6;
  a3 = C[33] * a34;
  w[248] = a21 = a2 - (a21 * a35 + a6 * a3);
  a2 = C[34] * a20;
  w[222] = a17 = 2.0 * a15 * a17;
  a17 = 0.3 * a17;
  a15 = C[34] * a34;
  w[256] = a23 = a21 - (a23 * a2 + a17 * a15);
  a21 = C[35] * a20;
  w[226] = a11 = 2.0 * a4 * a11;
  a11 = 0.3 * a11;
  a4 = C[35] * a34;
  w[264] = a25 = a23 - (a25 * a21 + a11 * a4);
  a23 = C[36] * a20;
  w[230] = a10 = 2.0 * a14 * a10;
  a10 = 0.3 * a10;
  a14 = C[36] * a34;
  w[272] = a27 = a25 - (a27 * a23 + a10 * a14);
  w[234] = a16 = 2.0 * a18 * a16;
  a16 = 0.3 * a16;
  w[268] = a34 = a27 - (a29 * (C[37] * a20) + a16 * (C[37] * a34));
  w[232] = a7 = 2.0 * a8 * a7;
  a7 = 0.3 * a7;
  w[260] = a14 = a34 - (a30 * a23 + a7 * a14);
  w[228] = a12 = 2.0 * a5 * a12;
  a12 = 0.3 * a12;
  w[252] = a4 = a14 - (a31 * a21 + a12 * a4);
  w[224] = a13 = 2.0 * a9 * a13;
  a13 = 0.3 * a13;
  w[245] = a15 = a4 - (a32 * a2 + a13 * a15);
  w[220] = a2 = 2.0 * w[0] * w[4];
  a2 = 0.3 * a2;
  w[238] = a15 - (a33 * a35 + a2 * a3);
  w[242] = a19 = a0 * a19 + ENTRY(3, 3);
  w[249] = a6 = a19 + a6 * a22;
  w[257] = a17 = a6 + a17 * a24;
  w[265] = a11 = a17 + a11 * a26;
  w[273] = a10 = a11 + a10 * a28;
  w[269] = a1 = a10 + a16 * a1;
  w[261] = a28 = a1 + a7 * a28;
  w[253] = a26 = a28 + a12 * a26;
  w[216] = a26 + a13 * a24;
  w[217] = a2 * a22;
}

static void MADE(planar_strip_k_richer_balance_part_1)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10;
  a0 = (-1.0) * w[234];
  a1 = (-1.0) * w[235];
  w[72] = w[236];
  w[76] = w[8];
  w[80] = w[12];
  w[84] = w[16];
  w[88] = 1.0;
  w[92] = 0.0;
  w[96] = 1.0;
  w[100] = 0.0;
  w[104] = 1.0;
  w[108] = w[237];
  w[112] = w[238];
  w[116] = w[216] + w[217];
  w[73] = w[239];
  w[77] = w[49];
  w[81] = w[53];
  w[85] = w[57];
  w[89] = w[240];
  w[93] = (-1.0) * w[218];
  w[97] = 1.0;
  w[101] = w[218];
  w[105] = w[240];
  w[109] = (-1.0) * w[219];
  w[113] = w[241];
  w[117] = w[242];
  w[74] = w[243];
  w[78] = w[9];
  w[82] = w[13];
  w[86] = w[17];
  w[90] = w[244];
  w[94] = (-1.0) * w[220];
  w[98] = 1.0;
  w[102] = w[220];
  w[106] = w[244];
  w[110] = (-1.0) * w[221];
  w[114] = w[245];
  w[118] = w[216];
  w[75] = w[246];
  w[79] = w[48];
  w[83] = w[52];
  w[87] = w[56];
  w[91] = w[247];
  w[95] = (-1.0) * w[222];
  w[99] = 1.0;
  w[103] = w[222];
  w[107] = w[247];
  w[111] = (-1.0) * w[223];
  w[115] = w[248];
  w[119] = w[249];
  w[120] = w[250];
  w[124] = w[10];
  w[128] = w[14];
  w[132] = w[18];
  w[136] = w[251];
  w[140] = (-1.0) * w[224];
  w[144] = 1.0;
  w[148] = w[224];
  w[152] = w[251];
  w[156] = (-1.0) * w[225];
  w[160] = w[252];
  w[164] = w[253];
  w[121] = w[254];
  w[125] = w[31];
  w[129] = w[35];
  w[133] = w[39];
  w[137] = w[255];
  w[141] = (-1.0) * w[226];
  w[145] = 1.0;
  w[149] = w[226];
  w[153] = w[255];
  w[157] = (-1.0) * w[227];
  w[161] = w[256];
  w[165] = w[257];
  w[122] = w[258];
  w[126] = w[11];
  w[130] = w[15];
  w[134] = w[19];
  w[138] = w[259];
  w[142] = (-1.0) * w[228];
  w[146] = 1.0;
  w[150] = w[228];
  w[154] = w[259];
  w[158] = (-1.0) * w[229];
  w[162] = w[260];
  w[166] = w[261];
  w[123] = w[262];
  w[127] = w[30];
  w[131] = w[34];
  w[135] = w[38];
  w[139] = w[263];
  w[143] = (-1.0) * w[230];
  w[147] = 1.0;
  w[151] = w[230];
  w[155] = w[263];
  w[159] = (-1.0) * w[231];
  w[163] = w[264];
  w[167] = w[265];
  w[168] = w[266];
  w[172] = w[28];
  w[176] = w[32];
  w[180] = w[36];
  w[184] = w[267];
  w[188] = (-1.0) * w[232];
  w[192] = 1.0;
  w[196] = w[232];
  w[200] = w[267];
  w[204] = (-1.0) * w[233];
  w[208] = w[268];
  w[212] = w[269];
  w[169] = w[270];
  w[173] = w[29];
  w[177] = w[33];
  w[181] = w[37];
  w[185] = w[271];
  w[189] = a0;
  w[193] = 1.0;
  w[197] = w[234];
  w[201] = w[271];
  w[205] = a1;
  w[209] = w[272];
  w[213] = w[273];
  w[170] = w[270];
  w[174] = w[29];
  w[178] = w[33];
  w[182] = w[37];
  w[186] = w[271];
  w[190] = a0;
  w[194] = 1.0;
  w[198] = w[234];
  w[202] = w[271];
  w[206] = a1;
  w[210] = w[272];
  w[214] = w[273];
  w[171] = w[270];
  w[175] = w[29];
  w[179] = w[33];
  w[183] = w[37];
  w[187] = w[271];
  w[191] = a0;
  w[195] = 1.0;
  w[199] = w[234];
  w[203] = w[271];
  w[207] = a1;
  w[211] = w[272];
  w[215] = w[273];
  MADE(planar_strip_kernels_pulls)(w + 72, w + 60, 3);
  a1 = w[60] + w[61];
  a0 = w[62] + w[63];
  a2 = w[64] + w[65];
  a3 = w[66] + w[67];
  a4 = w[68] + w[69];
  a5 = (-1.0) * (9.000000000000004 * (w[274] + ((-0.3151718290398874) * a1 + (-0.14530662257958904) * a0 + 0.6935326232920558 * a2 + 0.445790293374611 * a3 + (-0.6788444650471902) * a4)));
  res[0][4] = a5;
  a5 = w[60] - w[61];
  a6 = w[62] - w[63];
  a7 = w[64] - w[65];
  a8 = w[66] - w[67];
  a9 = w[68] - w[69];
  a10 = 11.000000000000014 * (0.09090909090909079 * w[275] + (0.27442512654618967 * a5 + (-0.12455201566566598) * a6 + (-0.6033346957600467) * a7 + 0.38496868233233256 * a8 + 0.5893262358805237 * a9));
  res[0][5] = (-1.0) * a10;
  a10 = 13.000000000000027 * (0.07692307692307676 * w[276] + ((-0.2300349338637263) * a1 + 0.3026299303999944 * a0 + 0.21307667005181632 * a2 + (-0.640322763801816) * a3 + 0.35465109721373184 * a4));
  res[0][6] = (-1.0) * a10;
  res[0][7] = w[277] + ((-0.4078623642070532) * a1 + (-1.1836626826683845) * a0 + (-1.8435978506872852) * a2 + (-2.32306881597938) * a3 + (-2.5751416197912285) * a4);
  res[0][8] = 0.33333333333333315 * w[278] + (C[38] * a5 + C[39] * a6 + 1.2875708098956142 * a7 + C[39] * a8 + C[38] * a9);
  res[0][9] = 0.19999999999999993 * w[279] + ((-0.3784075666694586) * a1 + (-0.7862111716116817) * a0 + (-0.4383414373309708) * a2 + 0.4383414373309708 * a3 + 1.1646187382811404 * a4);
  res[0][10] = 0.14285714285714288 * w[280] + (0.35038841219076183 * a5 + 0.4674700447590463 * a6 + (-0.3218927024739033) * a7 + (-0.9883033780923796) * a8 + (-0.5493290430501918) * a9);
  a9 = C[40] * w[220] + C[41] * w[224] + C[42] * w[228] + C[43] * w[232] + C[44] * w[234] + C[43] * w[230];
  a9 = a9 + C[42] * w[226] + C[41] * w[222] + C[40] * w[218] + C[45] * w[281];
  a8 = C[43] * w[263];
  a7 = C[42] * w[255];
  a7 = C[45] + C[40] * w[244] + C[41] * w[251] + C[42] * w[259] + C[43] * w[267] + C[44] * w[271] + a8 + a7;
  a7 = a7 + C[41] * w[247] + C[40] * w[240] + C[45] * w[282];
  res[0][11] = (C[11] * a9 + a7) / 0.3;
  res[0][12] = 0.0;
  res[0][13] = (C[11] * a7 - a9) / 0.3;
  res[0][14] = C[12] * w[283] - C[13] * w[284];
  res[0][15] = 0.0;
  res[0][16] = C[12] * w[284] + C[13] * w[283];
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
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  a4 = a2 - a6;
  w[40] = a2 + a6;
  w[41] = a7 + a3;
  w[42] = a1 + a5;
  w[43] = a1 - a5;
  w[44] = a7 - a3;
  w[45] = a4;
  w[46] = a4;
  w[47] = a4;
  MADE(planar_strip_kernels_increments)(w + 40, w + 0, 2);
  a4 = w[0] * w[1] - w[4] * w[5];
  a3 = w[0] * w[5] + w[4] * w[1];
  a7 = a4 * w[2] - a3 * w[6];
  a5 = a4 * w[6] + a3 * w[2];
  a1 = a7 * w[3] - a5 * w[7];
  a6 = a7 * w[7] + a5 * w[3];
  a2 = C[46] * (2.0 * a1 * a6);
  a0 = a1 * w[20] - a6 * w[24];
  a1 = a1 * w[24] + a6 * w[20];
  a8 = C[47] * (2.0 * a0 * a1);
  a9 = a0 * w[21] - a1 * w[25];
  a0 = a0 * w[25] + a1 * w[21];
  a10 = C[48] * (2.0 * a9 * a0);
  a10 = C[47] * (2.0 * w[0] * w[4]) + C[46] * (2.0 * a4 * a3) + C[49] * (2.0 * a7 * a5) + a2 + a8 + a10;
  a5 = C[49] * (1.0 - 2.0 * a5 * a5);
  a6 = C[46] * (1.0 - 2.0 * a6 * a6);
  a1 = C[47] * (1.0 - 2.0 * a1 * a1);
  a8 = C[48] * (1.0 - 2.0 * a0 * a0);
  a8 = C[48] + C[47] * (1.0 - 2.0 * w[4] * w[4]) + C[46] * (1.0 - 2.0 * a3 * a3) + a5 + a6 + a1 + a8;
  res[0][0] = (C[11] * a10 + a8) / 0.3;
  res[0][1] = 0.0;
  res[0][2] = (C[11] * a8 - a10) / 0.3;
  res[0][3] = C[12] * a9 - C[13] * a0;
  res[0][4] = 0.0;
  res[0][5] = C[12] * a0 + C[13] * a9;
  res[0][6] = 0.0;
  return 0;
}

static void MADE(planar_strip_k_igm_part_0)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  w[172] = a7 = a2 + a6;
  a8 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  w[178] = a9 = a8 + a3;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  w[184] = a4 = a1 + a5;
  w[187] = a5 = a1 - a5;
  w[181] = a3 = a8 - a3;
  w[174] = a6 = a2 - a6;
  w[48] = a7;
  w[49] = a9;
  w[50] = a4;
  w[51] = a5;
  w[52] = a3;
  w[53] = a6;
  w[54] = a6;
  w[55] = a6;
  MADE(planar_strip_kernels_increments)(w + 48, w + 0, 2);
  a6 = ENTRY(2, 2);
  a3 = 2.0 * a6;
  a5 = a3 * a6;
  a4 = ENTRY(2, 3);
  a9 = 2.0 * a4 * a4;
  w[190] = a7 = 1.0 - a5 - a9;
  w[162] = a2 = ENTRY(3, 3);
  a8 = ENTRY(2, 1);
  a1 = 2.0 * a8;
  a0 = a1 * a6;
  a10 = 2.0 * ENTRY(2, 0);
  a11 = a10 * a4;
  w[193] = a12 = a0 + a11;
  w[164] = a13 = ENTRY(3, 4);
  a14 = a1 * a4;
  a6 = a10 * a6;
  w[195] = a15 = a14 - a6;
  w[166] = a16 = ENTRY(3, 5);
  w[154] = a17 = w[0] * w[1] - w[4] * w[5];
  w[155] = a18 = w[0] * w[5] + w[4] * w[1];
  w[150] = a19 = a17 * w[2] - a18 * w[6];
  w[151] = a17 = a17 * w[6] + a18 * w[2];
  a20 = a19 * w[3] - a17 * w[7];
  a19 = a19 * w[7] + a17 * w[3];
  a21 = a20 * w[20] - a19 * w[24];
  a22 = a20 * w[24] + a19 * w[20];
  a23 = a21 * w[25] + a22 * w[21];
  a24 = 0.3 * (1.0 - 2.0 * a23 * a23);
  w[191] = a11 = a0 - a11;
  a0 = ENTRY(3, 0);
  a1 = 1.0 - a1 * a8;
  w[194] = a9 = a1 - a9;
  a25 = ENTRY(3, 1);
  a4 = a3 * a4;
  a8 = a10 * a8;
  w[196] = a10 = a4 + a8;
  a3 = ENTRY(3, 2);
  w[192] = a26 = a11 * a0 + a9 * a25 + a10 * a3;
  w[160] = a27 = C[25] * a26;
  w[176] = a27 = a7 * a2 + a12 * a13 + a15 * a16 - a24 * a27;
  w[175] = a28 = 1.0 - 2.0 * a22 * a22;
  a28 = 0.3 * a28;
  w[168] = a29 = C[26] * a26;
  w[201] = a30 = a28 * a29;
  w[183] = a30 = a27 - a30;
  w[182] = a27 = 1.0 - 2.0 * a19 * a19;
  a27 = 0.3 * a27;
  w[169] = a31 = C[27] * a26;
  w[200] = a32 = a27 * a31;
  w[189] = a32 = a30 - a32;
  w[188] = a17 = 1.0 - 2.0 * a17 * a17;
  w[149] = a17 = 0.3 * a17;
  w[170] = a26 = C[28] * a26;
  w[199] = a26 = a17 * a26;
  w[186] = a26 = a32 - a26;
  w[185] = a18 = 1.0 - 2.0 * a18 * a18;
  w[152] = a18 = 0.3 * a18;
  w[198] = a31 = a18 * a31;
  w[180] = a31 = a26 - a31;
  w[179] = a26 = 1.0 - 2.0 * w[4] * w[4];
  w[156] = a26 = 0.3 * a26;
  w[197] = a29 = a26 * a29;
  w[173] = a31 - a29;
  w[148] = a15 = a7 * a0 + a12 * a25 + a15 * a3;
  w[159] = a23 = 0.3 * (2.0 * (a21 * w[21] - a22 * w[25]) * a23);
  w[161] = a6 = a14 + a6;
  w[163] = a8 = a4 - a8;
  w[165] = a5 = a1 - a5;
  w[145] = a3 = a6 * a0 + a8 * a25 + a5 * a3;
  w[177] = a16 = a24 * (C[25] * a15) - a23 * (C[25] * a3) + (a11 * a2 + a9 * a13 + a10 * a16);
  w[157] = a10 = C[26] * a15;
  w[171] = a22 = 2.0 * a21 * a22;
  w[167] = a22 = 0.3 * a22;
  w[158] = a3 = C[26] * a3;
  w[202] = a3 = a28 * a10 - a22 * a3;
  w[147] = a16 + a3;
  w[153] = a15 = C[27] * a15;
  w[146] = a27 * a15;
  w[144] = 2.0 * a20 * a19;
}

static void MADE(planar_strip_k_igm_part_1)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20;
  a0 = 0.3 * w[144];
  a1 = C[27] * w[145];
  a2 = w[146] - a0 * a1;
  a3 = w[147] + a2;
  a4 = 2.0 * w[150] * w[151];
  a5 = 0.3 * a4;
  a6 = w[149] * (C[28] * w[148]) - a5 * (C[28] * w[145]);
  a7 = a3 + a6;
  a8 = 2.0 * w[154] * w[155];
  a9 = 0.3 * a8;
  a1 = w[152] * w[153] - a9 * a1;
  a10 = a7 + a1;
  a11 = 2.0 * w[0] * w[4];
  a12 = 0.3 * a11;
  a13 = w[156] * w[157] - a12 * w[158];
  a14 = w[159] * w[160] + (w[161] * w[162] + w[163] * w[164] + w[165] * w[166]);
  a15 = w[167] * w[168];
  a16 = a14 + a15;
  a0 = a0 * w[169];
  a17 = a16 + a0;
  a5 = a5 * w[170];
  a18 = a17 + a5;
  a9 = a9 * w[169];
  a19 = a18 + a9;
  a12 = a12 * w[168];
  a20 = (-1.0) * a4;
  w[48] = w[172];
  w[52] = w[8];
  w[56] = w[12];
  w[60] = w[16];
  w[64] = 1.0;
  w[68] = 0.0;
  w[72] = 1.0;
  w[76] = 0.0;
  w[80] = 1.0;
  w[84] = w[173];
  w[88] = a10 + a13;
  w[92] = a19 + a12;
  w[49] = w[174];
  w[53] = w[29];
  w[57] = w[33];
  w[61] = w[37];
  w[65] = w[175];
  w[69] = (-1.0) * w[171];
  w[73] = 1.0;
  w[77] = w[171];
  w[81] = w[175];
  w[85] = w[176];
  w[89] = w[177];
  w[93] = a14;
  w[50] = w[178];
  w[54] = w[9];
  w[58] = w[13];
  w[62] = w[17];
  w[66] = w[179];
  w[70] = (-1.0) * a11;
  w[74] = 1.0;
  w[78] = a11;
  w[82] = w[179];
  w[86] = w[180];
  w[90] = a10;
  w[94] = a19;
  w[51] = w[181];
  w[55] = w[28];
  w[59] = w[32];
  w[63] = w[36];
  w[67] = w[182];
  w[71] = (-1.0) * w[144];
  w[75] = 1.0;
  w[79] = w[144];
  w[83] = w[182];
  w[87] = w[183];
  w[91] = w[147];
  w[95] = a16;
  w[96] = w[184];
  w[100] = w[10];
  w[104] = w[14];
  w[108] = w[18];
  w[112] = w[185];
  w[116] = (-1.0) * a8;
  w[120] = 1.0;
  w[124] = a8;
  w[128] = w[185];
  w[132] = w[186];
  w[136] = a7;
  w[140] = a18;
  w[97] = w[187];
  w[101] = w[11];
  w[105] = w[15];
  w[109] = w[19];
  w[113] = w[188];
  w[117] = a20;
  w[121] = 1.0;
  w[125] = a4;
  w[129] = w[188];
  w[133] = w[189];
  w[137] = a3;
  w[141] = a17;
  w[98] = w[187];
  w[102] = w[11];
  w[106] = w[15];
  w[110] = w[19];
  w[114] = w[188];
  w[118] = a20;
  w[122] = 1.0;
  w[126] = a4;
  w[130] = w[188];
  w[134] = w[189];
  w[138] = a3;
  w[142] = a17;
  w[99] = w[187];
  w[103] = w[11];
  w[107] = w[15];
  w[111] = w[19];
  w[115] = w[188];
  w[119] = a20;
  w[123] = 1.0;
  w[127] = a4;
  w[131] = w[188];
  w[135] = w[189];
  w[139] = a3;
  w[143] = a17;
  MADE(planar_strip_kernels_pulls)(w + 48, w + 40, 2);
  a17 = w[40] + w[41];
  a3 = w[42] + w[43];
  a4 = w[44] + w[45];
  if (res[0]) res[0][0] = C[1] * a17 + C[2] * a3 + C[3] * a4;
  a20 = w[40] - w[41];
  a18 = w[42] - w[43];
  a7 = w[44] - w[45];
  if (res[0]) res[0][1] = C[4] * a20 + C[5] * a18 + C[4] * a7;
  if (res[0]) res[0][2] = C[6] * a17 + C[7] * a3 + 1.5625 * a4;
  if (res[0]) res[0][3] = C[8] * a20 + C[9] * a18 + C[10] * a7;
  if (res[1]) res[1][0] = (-1.0) * (w[190] * w[148] + w[191] * w[192] + w[161] * w[145]);
  if (res[1]) res[1][1] = (-1.0) * (w[193] * w[148] + w[194] * w[192] + w[163] * w[145]);
  if (res[1]) res[1][2] = (-1.0) * (w[195] * w[148] + w[196] * w[192] + w[165] * w[145]);
  a7 = w[176] - (C[48] * w[192] + w[197] + w[198] + w[199] + w[200] + w[201]);
  a2 = C[48] * w[148] + a13 + a1 + a6 + a2 + w[202] + w[177];
  a14 = a12 + a9 + a5 + a0 + a15 + a14;
  if (res[2]) res[2][0] = (-1.0) * (w[190] * a7 + w[191] * a2 + w[161] * a14);
  if (res[2]) res[2][1] = (-1.0) * (w[193] * a7 + w[194] * a2 + w[163] * a14);
  if (res[2]) res[2][2] = (-1.0) * (w[195] * a7 + w[196] * a2 + w[165] * a14);
}

static int MADE(planar_strip_k_igm)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  MADE(planar_strip_k_igm_part_0)(arg, res, w);
  MADE(planar_strip_k_igm_part_1)(arg, res, w);
  return 0;
}

static int MADE(planar_strip_k_tip)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  a4 = a2 - a6;
  w[40] = a2 + a6;
  w[41] = a7 + a3;
  w[42] = a1 + a5;
  w[43] = a1 - a5;
  w[44] = a7 - a3;
  w[45] = a4;
  w[46] = a4;
  w[47] = a4;
  MADE(planar_strip_kernels_increments)(w + 40, w + 0, 2);
  a4 = w[0] * w[1] - w[4] * w[5];
  a3 = w[0] * w[5] + w[4] * w[1];
  a7 = a4 * w[2] - a3 * w[6];
  a5 = a4 * w[6] + a3 * w[2];
  a1 = a7 * w[3] - a5 * w[7];
  a6 = a7 * w[7] + a5 * w[3];
  a2 = C[46] * (2.0 * a1 * a6);
  a0 = a1 * w[20] - a6 * w[24];
  a1 = a1 * w[24] + a6 * w[20];
  a8 = C[47] * (2.0 * a0 * a1);
  a9 = a0 * w[21] - a1 * w[25];
  a0 = a0 * w[25] + a1 * w[21];
  a10 = C[48] * (2.0 * a9 * a0);
  a10 = C[47] * (2.0 * w[0] * w[4]) + C[46] * (2.0 * a4 * a3) + C[49] * (2.0 * a7 * a5) + a2 + a8 + a10;
  a5 = C[49] * (1.0 - 2.0 * a5 * a5);
  a6 = C[46] * (1.0 - 2.0 * a6 * a6);
  a1 = C[47] * (1.0 - 2.0 * a1 * a1);
  a8 = C[48] * (1.0 - 2.0 * a0 * a0);
  a8 = C[48] + C[47] * (1.0 - 2.0 * w[4] * w[4]) + C[46] * (1.0 - 2.0 * a3 * a3) + a5 + a6 + a1 + a8;
  if (res[0]) res[0][0] = a10 + a8 - C[50] * a10;
  if (res[0]) res[0][1] = 0.0;
  if (res[0]) res[0][2] = a8 - a10 - C[50] * a8;
  if (res[1]) res[1][0] = C[12] * a9 - C[13] * a0;
  if (res[1]) res[1][1] = 0.0;
  if (res[1]) res[1][2] = C[12] * a0 + C[13] * a9;
  if (res[1]) res[1][3] = 0.0;
  return 0;
}

static int MADE(planar_strip_k_tip_jacobian)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18;
  a0 = ENTRY(0, 0);
  a1 = ENTRY(0, 2);
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = a2 + a6;
  a8 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  a9 = a8 + a3;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  a4 = a1 + a5;
  a5 = a1 - a5;
  a3 = a8 - a3;
  a6 = a2 - a6;
  w[48] = a7;
  w[49] = a9;
  w[50] = a4;
  w[51] = a5;
  w[52] = a3;
  w[53] = a6;
  w[54] = a6;
  w[55] = a6;
  MADE(planar_strip_kernels_increments)(w + 48, w + 0, 2);
  a2 = 1.0 - 2.0 * w[4] * w[4];
  a8 = 2.0 * w[0] * w[4];
  a1 = w[0] * w[5] + w[4] * w[1];
  a0 = 1.0 - 2.0 * a1 * a1;
  a10 = w[0] * w[1] - w[4] * w[5];
  a11 = 2.0 * a10 * a1;
  a12 = a10 * w[6] + a1 * w[2];
  a13 = 1.0 - 2.0 * a12 * a12;
  a1 = a10 * w[2] - a1 * w[6];
  a10 = 2.0 * a1 * a12;
  a14 = a1 * w[7] + a12 * w[3];
  a15 = 1.0 - 2.0 * a14 * a14;
  a12 = a1 * w[3] - a12 * w[7];
  a1 = 2.0 * a12 * a14;
  a16 = a12 * w[24] + a14 * w[20];
  a17 = 1.0 - 2.0 * a16 * a16;
  a14 = a12 * w[20] - a14 * w[24];
  a12 = 2.0 * a14 * a16;
  a18 = (-1.0) * a12;
  w[48] = a7;
  w[52] = w[8];
  w[56] = w[12];
  w[60] = w[16];
  w[64] = 1.0;
  w[68] = 0.0;
  w[72] = 1.0;
  w[76] = 0.0;
  w[80] = 1.0;
  w[49] = a9;
  w[53] = w[9];
  w[57] = w[13];
  w[61] = w[17];
  w[65] = a2;
  w[69] = (-1.0) * a8;
  w[73] = 1.0;
  w[77] = a8;
  w[81] = a2;
  w[50] = a4;
  w[54] = w[10];
  w[58] = w[14];
  w[62] = w[18];
  w[66] = a0;
  w[70] = (-1.0) * a11;
  w[74] = 1.0;
  w[78] = a11;
  w[82] = a0;
  w[51] = a5;
  w[55] = w[11];
  w[59] = w[15];
  w[63] = w[19];
  w[67] = a13;
  w[71] = (-1.0) * a10;
  w[75] = 1.0;
  w[79] = a10;
  w[83] = a13;
  w[84] = a3;
  w[88] = w[28];
  w[92] = w[32];
  w[96] = w[36];
  w[100] = a15;
  w[104] = (-1.0) * a1;
  w[108] = 1.0;
  w[112] = a1;
  w[116] = a15;
  w[85] = a6;
  w[89] = w[29];
  w[93] = w[33];
  w[97] = w[37];
  w[101] = a17;
  w[105] = a18;
  w[109] = 1.0;
  w[113] = a12;
  w[117] = a17;
  w[86] = a6;
  w[90] = w[29];
  w[94] = w[33];
  w[98] = w[37];
  w[102] = a17;
  w[106] = a18;
  w[110] = 1.0;
  w[114] = a12;
  w[118] = a17;
  w[87] = a6;
  w[91] = w[29];
  w[95] = w[33];
  w[99] = w[37];
  w[103] = a17;
  w[107] = a18;
  w[111] = 1.0;
  w[115] = a12;
  w[119] = a17;
  MADE(planar_strip_kernels_turnings)(w + 48, w + 40, 2);
  w[121] = C[47] * a2;
  w[123] = C[46] * a0;
  w[125] = C[49] * a13;
  w[127] = C[46] * a15;
  w[129] = C[47] * a17;
  w[138] = a17 = a14 * w[25] + a16 * w[21];
  w[131] = C[48] * (1.0 - 2.0 * a17 * a17);
  w[132] = C[47] * a8;
  w[133] = C[46] * a11;
  w[134] = C[49] * a10;
  w[135] = C[46] * a1;
  w[136] = C[47] * a12;
  w[139] = a16 = a14 * w[21] - a16 * w[25];
  w[137] = C[48] * (2.0 * a16 * a17);
  MADE(planar_strip_k_tip_jacobian_columns)(w, planar_strip_kernels_table_0 + 0, w + 140, w + 168, 1);
  if (res[0]) res[0][0] = w[140];
  if (res[0]) res[0][1] = w[144];
  if (res[0]) res[0][2] = w[148];
  if (res[0]) res[0][3] = w[152];
  if (res[0]) res[0][4] = w[156];
  if (res[0]) res[0][5] = w[160];
  if (res[0]) res[0][6] = w[164];
  if (res[0]) res[0][7] = w[141];
  if (res[0]) res[0][8] = w[145];
  if (res[0]) res[0][9] = w[149];
  if (res[0]) res[0][10] = w[153];
  if (res[0]) res[0][11] = w[157];
  if (res[0]) res[0][12] = w[161];
  if (res[0]) res[0][13] = w[165];
  if (res[0]) res[0][14] = w[142];
  if (res[0]) res[0][15] = w[146];
  if (res[0]) res[0][16] = w[150];
  if (res[0]) res[0][17] = w[154];
  if (res[0]) res[0][18] = w[158];
  if (res[0]) res[0][19] = w[162];
  if (res[0]) res[0][20] = w[166];
  if (res[0]) res[0][21] = w[143];
  if (res[0]) res[0][22] = w[147];
  if (res[0]) res[0][23] = w[151];
  if (res[0]) res[0][24] = w[155];
  if (res[0]) res[0][25] = w[159];
  if (res[0]) res[0][26] = w[163];
  if (res[0]) res[0][27] = w[167];
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
  a2 = C[14] * a0 + C[15] * a1;
  a3 = ENTRY(0, 1);
  a4 = C[16] * a3;
  a5 = ENTRY(0, 3);
  a6 = a4 + C[17] * a5;
  a7 = C[18] * a0 + C[19] * a1;
  a3 = C[20] * a3 + C[21] * a5;
  a1 = C[22] * a0 + C[23] * a1;
  a5 = a4 + C[24] * a5;
  a4 = a2 - a6;
  w[40] = a2 + a6;
  w[41] = a7 + a3;
  w[42] = a1 + a5;
  w[43] = a1 - a5;
  w[44] = a7 - a3;
  w[45] = a4;
  w[46] = a4;
  w[47] = a4;
  MADE(planar_strip_kernels_increments)(w + 40, w + 0, 2);
  a4 = 2.0 * w[0] * w[4];
  a3 = w[0] * w[1] - w[4] * w[5];
  a7 = w[0] * w[5] + w[4] * w[1];
  a5 = 2.0 * a3 * a7;
  a1 = a3 * w[2] - a7 * w[6];
  a6 = a3 * w[6] + a7 * w[2];
  a2 = 2.0 * a1 * a6;
  a0 = a1 * w[3] - a6 * w[7];
  a8 = a1 * w[7] + a6 * w[3];
  a9 = 2.0 * a0 * a8;
  a10 = a0 * w[20] - a8 * w[24];
  a11 = a0 * w[24] + a8 * w[20];
  a12 = 2.0 * a10 * a11;
  a13 = a10 * w[21] - a11 * w[25];
  a14 = a10 * w[25] + a11 * w[21];
  a15 = 2.0 * a13 * a14;
  a16 = 2.0 * ENTRY(2, 0) - 1.0;
  a17 = 2.0 * a16;
  a18 = a17 * a16 - 1.0;
  a19 = C[51] * a18;
  a20 = a17 * a18 - a16;
  a21 = a17 * a20 - a18;
  a22 = C[52] * a21;
  a23 = a17 * a21 - a20;
  a17 = a17 * a23 - a21;
  a24 = C[53] * a17;
  a25 = C[0] + C[54] * a16 + a19 + a22 + C[55] * a23 + a24;
  a26 = C[52] * a18;
  a27 = C[0] * a17;
  a28 = C[0] + C[52] * a16 + a26 + C[56] * a20 + a22 + C[52] * a23 + a27;
  a29 = (C[57] * a4 + C[58] * a5 + C[59] * a2 + C[60] * a9 + C[61] * a12 + C[62] * a15) * a28;
  a30 = C[0] + C[63] * a18 + C[56] * a21 + a24;
  a31 = (C[64] * a4 + C[65] * a5 + C[66] * a2 + C[67] * a9 + C[68] * a12 + C[69] * a15) * a30;
  a27 = C[0] + C[51] * a16 + a26 + C[63] * a20 + a22 + C[51] * a23 + a27;
  a31 = (C[70] * a4 + C[71] * a5 + C[72] * a2 + C[73] * a9 + C[74] * a12 + C[75] * a15) * a25 + a29 + a31;
  a24 = C[0] + C[55] * a16 + a19 + a22 + C[54] * a23 + a24;
  a22 = (C[76] * a4 + C[77] * a5 + C[78] * a2 + C[79] * a9 + C[80] * a12 + C[81] * a15) * a24;
  a18 = C[0] * a18;
  a21 = C[0] * a21;
  a17 = C[82] * a17;
  a19 = C[82] + C[0] * a16 + a18 + C[0] * a20 + a21 + C[0] * a23 + a17;
  a22 = a31 + (C[83] * a4 + C[84] * a5 + C[85] * a2 + C[86] * a9 + C[87] * a12 + C[88] * a15) * a27 + a22;
  a15 = a22 + (C[47] * a4 + C[46] * a5 + C[49] * a2 + C[46] * a9 + C[47] * a12 + C[48] * a15) * a19;
  a12 = 1.0 - 2.0 * w[4] * w[4];
  a9 = 1.0 - 2.0 * a7 * a7;
  a2 = 1.0 - 2.0 * a6 * a6;
  a5 = 1.0 - 2.0 * a8 * a8;
  a4 = 1.0 - 2.0 * a11 * a11;
  a22 = 1.0 - 2.0 * a14 * a14;
  a31 = (C[62] + C[57] * a12 + C[58] * a9 + C[59] * a2 + C[60] * a5 + C[61] * a4 + C[62] * a22) * a28;
  a31 = (0.008165292531919034 + C[70] * a12 + C[71] * a9 + C[72] * a2 + C[73] * a5 + C[74] * a4 + C[75] * a22) * a25 + a31;
  a31 = a31 + (0.006309523809523807 + C[64] * a12 + C[65] * a9 + C[66] * a2 + C[67] * a5 + C[68] * a4 + C[69] * a22) * a30;
  a31 = a31 + (C[88] + C[83] * a12 + C[84] * a9 + C[85] * a2 + C[86] * a5 + C[87] * a4 + C[88] * a22) * a27;
  a31 = a31 + (0.0044537550871285815 + C[76] * a12 + C[77] * a9 + C[78] * a2 + C[79] * a5 + C[80] * a4 + C[81] * a22) * a24;
  a22 = a31 + (C[48] + C[47] * a12 + C[46] * a9 + C[49] * a2 + C[46] * a5 + C[47] * a4 + C[48] * a22) * a19;
  if (res[0]) res[0][0] = a15 + a22 - C[50] * a15;
  if (res[0]) res[0][1] = 0.0;
  if (res[0]) res[0][2] = a22 - a15 - C[50] * a22;
  a1 = C[82] + C[53] * a16 + a18 + C[53] * a20 + a21 + C[53] * a23 + a17 + w[0] * a25 + a3 * a28 + a1 * a30;
  a13 = a1 + a0 * a27 + a10 * a24 + a13 * a19;
  a19 = w[4] * a25 + a7 * a28 + a6 * a30 + a8 * a27 + a11 * a24 + a14 * a19;
  a14 = sqrt(a13 * a13 + a19 * a19);
  a13 = a13 / a14;
  a14 = a19 / a14;
  if (res[1]) res[1][0] = C[12] * a13 - C[13] * a14;
  if (res[1]) res[1][1] = 0.0;
  if (res[1]) res[1][2] = C[12] * a14 + C[13] * a13;
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
