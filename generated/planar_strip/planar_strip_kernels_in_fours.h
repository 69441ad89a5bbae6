/* Included once for each width of vectors. */
static void MADE(planar_strip_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2;
  b0 = LOAD(given + 0) * LOAD(given + 0);
  b1 = EACH((-2.8114572543455206e-15)) + b0 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b0);
  b1 = b0 * (EACH((-1.6059043836821613e-10)) + b0 * (EACH(7.647163731819816e-13) + b0 * b1));
  b1 = b0 * (EACH((-2.7557319223985893e-06)) + b0 * (EACH(2.505210838544172e-08) + b1));
  b1 = EACH(0.16666666666666666) + b0 * (EACH((-0.008333333333333333)) + b0 * (EACH(0.0001984126984126984) + b1));
  b2 = EACH(3.920664999224027e-14) + b0 * (EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b0);
  b2 = b0 * (EACH(1.076457782186949e-08) + b0 * (EACH((-2.446494959515793e-11)) + b0 * b2));
  b2 = b0 * (EACH(0.0005208333333333333) + b0 * (EACH((-3.1001984126984127e-06)) + b2));
  b2 = EACH(1.0) + b0 * (EACH((-0.041666666666666664)) + b2);
  STORE(made + 0, (EACH(1.0) - b0 * b1) / b2);
  STORE(made + 4, b2 / EACH(2.0) * LOAD(given + 0));
  STORE(made + 8, LOAD(given + 0));
  STORE(made + 12, b2);
  STORE(made + 16, b1);
}

static void MADE(planar_strip_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 4, made += 20)
    EVERY_LANE(MADE(planar_strip_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
  STORE(made + 0, LOAD(given + 24) * LOAD(given + 40));
}

static void MADE(planar_strip_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 48, made += 4)
    EVERY_LANE(MADE(planar_strip_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = LOAD(given + 24) * LOAD(given + 4);
  b1 = EACH(0.5) / (LOAD(given + 8) * LOAD(given + 8));
  b2 = b0 * b0;
  b3 = EACH((-2.186688975602072e-15)) + b2 * (EACH(6.576508197299464e-18) + EACH((-1.6014224506411032e-20)) * b2);
  b3 = b2 * (EACH((-1.1470745597729724e-10)) + b2 * (EACH(5.735372798864862e-13) + b2 * b3));
  b3 = b2 * (EACH((-1.6534391534391535e-06)) + b2 * (EACH(1.670140559029448e-08) + b3));
  b3 = EACH((-0.002777777777777778)) + b2 * (EACH(9.92063492063492e-05) + b3);
  b2 = b1 * (LOAD(given + 12) + b2 * b3);
  b3 = EACH((-1.0)) * (EACH(2.0) * (b0 * (b1 * b3 * (LOAD(given + 40) * b0) * b0 - b2 * LOAD(given + 40))));
  b1 = LOAD(given + 44) / EACH(2.0);
  b4 = b0 * (b2 * LOAD(given + 36));
  b5 = LOAD(given + 40) / EACH(2.0);
  b6 = LOAD(given + 36) / EACH(2.0);
  b2 = b0 * (b2 * LOAD(given + 44));
  STORE(made + 0, LOAD(given + 24));
  STORE(made + 4, b3);
  STORE(made + 8, b1 - b4);
  STORE(made + 12, EACH((-1.0)) * b5);
  STORE(made + 16, EACH((-1.0)) * (b1 + b4));
  STORE(made + 20, b6 - b2);
  STORE(made + 24, b5);
  STORE(made + 28, EACH((-1.0)) * (b6 + b2));
  STORE(made + 32, b3);
}

static void MADE(planar_strip_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 48, made += 36)
    EVERY_LANE(MADE(planar_strip_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  STORE(made + 0, LOAD(given + 40) * LOAD(given + 72) + LOAD(given + 24) * LOAD(given + 88));
}

static void MADE(planar_strip_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 96, made += 4)
    EVERY_LANE(MADE(planar_strip_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9;
  b0 = EACH(w[40]) * LOAD(turns + 0);
  b1 = b0 + EACH(w[41]) * LOAD(turns + 4);
  b2 = b1 + EACH(w[42]) * LOAD(turns + 8);
  b3 = b2 + EACH(w[43]) * LOAD(turns + 12);
  b4 = b3 + EACH(w[76]) * LOAD(turns + 16);
  b5 = EACH(w[214]) * (b4 + EACH(w[77]) * LOAD(turns + 20));
  b4 = b5 + EACH(w[215]) * b4;
  b3 = b4 + EACH(w[216]) * b3;
  b2 = b3 + EACH(w[217]) * b2;
  b1 = b2 + EACH(w[218]) * b1;
  b0 = EACH(w[40]) * (b1 + EACH(w[219]) * b0);
  b5 = EACH(w[77]) * b5;
  b6 = b0 + b5;
  b1 = EACH(w[41]) * b1;
  b4 = EACH(w[76]) * b4;
  b7 = b1 + b4;
  b2 = EACH(w[42]) * b2;
  b3 = EACH(w[43]) * b3;
  b8 = b2 + b3;
  b9 = EACH((-1.1164549684630114)) * b6 + EACH((-3.0502116982036553)) * b7 + EACH((-4.166666666666669)) * b8;
  b0 = b5 - b0;
  b1 = b4 - b1;
  b2 = b3 - b2;
  b8 = EACH((-0.9021097956087902)) * b6 + EACH((-0.6603902043912094)) * b7 + EACH(1.5625000000000002) * b8;
  STORE(columns + 0, EACH((-1.0)) * b9);
  b9 = EACH(1.0416666666666667) * b0 + EACH(2.083333333333333) * b1 + EACH(1.041666666666667) * b2;
  STORE(columns + 4, b9);
  STORE(columns + 8, EACH((-1.0)) * b8);
  b2 = EACH(0.716145833333333) * b0 + EACH((-0.5208333333333336)) * b1 + EACH((-1.236979166666667)) * b2;
  STORE(columns + 12, b2);
}

static void MADE(planar_strip_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns, casadi_real *columns,
    casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 24, columns += 4) {
    EVERY_LANE(MADE(planar_strip_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}

static int MADE(planar_strip_k_jacobian)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35, a36, a37, a38, a39, a40, a41, a42, a43, a44, a45, a46, a47;
  casadi_real a48, a49, a50, a51, a52;
  a0 = arg[0] ? arg[0][0] : 0.0;
  a1 = arg[0] ? arg[0][2] : 0.0;
  a2 = 0.06698729810778069 * a0 + 0.05412658773652741 * a1;
  a3 = arg[0] ? arg[0][1] : 0.0;
  a4 = arg[0] ? arg[0][3] : 0.0;
  a5 = (-0.0625) * a3 + (-0.04296874999999998) * a4;
  a6 = a2 + a5;
  a7 = 0.18301270189221933 * a0 + 0.03962341226347257 * a1;
  a8 = (-0.12499999999999999) * a3 + 0.031250000000000014 * a4;
  a9 = a7 + a8;
  a1 = 0.2500000000000001 * a0 + (-0.09375000000000001) * a1;
  a4 = (-0.06250000000000001) * a3 + 0.07421875000000001 * a4;
  a3 = a1 + a4;
  a4 = a1 - a4;
  a8 = a7 - a8;
  a5 = a2 - a5;
  w[112] = a6;
  w[113] = a9;
  w[114] = a3;
  w[115] = a4;
  w[116] = a8;
  w[117] = a5;
  w[118] = a5;
  w[119] = a5;
  MADE(planar_strip_kernels_increments)(w + 112, w + 0, 2);
  a2 = arg[2] ? arg[2][0] : 0.0;
  a7 = arg[1] ? arg[1][3] : 0.0;
  a1 = arg[1] ? arg[1][5] : 0.0;
  a0 = w[0] * w[1] - w[4] * w[5];
  a10 = w[0] * w[5] + w[4] * w[1];
  a11 = a0 * w[2] - a10 * w[6];
  a12 = a0 * w[6] + a10 * w[2];
  a13 = a11 * w[3] - a12 * w[7];
  a14 = a11 * w[7] + a12 * w[3];
  a15 = a13 * w[20] - a14 * w[24];
  a16 = a13 * w[24] + a14 * w[20];
  a17 = a15 * w[25] + a16 * w[21];
  a18 = 0.3 * (1.0 - 2.0 * a17 * a17);
  a19 = a2 * (arg[1] ? arg[1][1] : 0.0);
  a20 = 0.014285714285714282 * a19;
  a21 = a2 * (2.220446049250313e-16 * a7 - a1) - a18 * a20;
  a22 = 1.0 - 2.0 * a16 * a16;
  a23 = 0.3 * a22;
  a24 = 0.12698412698412698 * a19;
  a25 = a21 - a23 * a24;
  a26 = 1.0 - 2.0 * a14 * a14;
  a27 = 0.3 * a26;
  a28 = 0.22857142857142854 * a19;
  a29 = a25 - a27 * a28;
  a30 = 1.0 - 2.0 * a12 * a12;
  a31 = 0.3 * a30;
  a19 = 0.26031746031746034 * a19;
  a32 = a29 - a31 * a19;
  a33 = 1.0 - 2.0 * a10 * a10;
  a34 = 0.3 * a33;
  a35 = a32 - a34 * a28;
  a36 = 1.0 - 2.0 * w[4] * w[4];
  a37 = 0.3 * a36;
  a38 = arg[1] ? arg[1][0] : 0.0;
  a39 = arg[1] ? arg[1][2] : 0.0;
  a40 = a2 * (2.220446049250313e-16 * a38 - a39);
  a41 = 0.014285714285714282 * a40;
  a17 = 0.3 * (2.0 * (a15 * w[21] - a16 * w[25]) * a17);
  a39 = a2 * (a38 + 2.220446049250313e-16 * a39);
  a38 = 0.014285714285714282 * a39;
  a42 = a18 * a41 - a17 * a38 + a2 * (arg[1] ? arg[1][4] : 0.0);
  a43 = 0.12698412698412698 * a40;
  a16 = 2.0 * a15 * a16;
  a15 = 0.3 * a16;
  a44 = 0.12698412698412698 * a39;
  a45 = a42 + (a23 * a43 - a15 * a44);
  a46 = 0.22857142857142854 * a40;
  a14 = 2.0 * a13 * a14;
  a13 = 0.3 * a14;
  a47 = 0.22857142857142854 * a39;
  a48 = a45 + (a27 * a46 - a13 * a47);
  a40 = 0.26031746031746034 * a40;
  a12 = 2.0 * a11 * a12;
  a11 = 0.3 * a12;
  a39 = 0.26031746031746034 * a39;
  a49 = a48 + (a31 * a40 - a11 * a39);
  a10 = 2.0 * a0 * a10;
  a0 = 0.3 * a10;
  a50 = a49 + (a34 * a46 - a0 * a47);
  a51 = 2.0 * w[0] * w[4];
  a52 = 0.3 * a51;
  a1 = a17 * a20 + a2 * (a7 + 2.220446049250313e-16 * a1);
  a7 = a1 + a15 * a24;
  a2 = a7 + a13 * a28;
  a19 = a2 + a11 * a19;
  a28 = a19 + a0 * a28;
  a20 = (-1.0) * a16;
  w[112] = a6;
  w[116] = w[8];
  w[120] = w[12];
  w[124] = w[16];
  w[128] = 1.0;
  w[132] = 0.0;
  w[136] = 1.0;
  w[140] = 0.0;
  w[144] = 1.0;
  w[148] = a35 - a37 * a24;
  w[152] = a50 + (a37 * a43 - a52 * a44);
  w[156] = a28 + a52 * a24;
  w[113] = a9;
  w[117] = w[9];
  w[121] = w[13];
  w[125] = w[17];
  w[129] = a36;
  w[133] = (-1.0) * a51;
  w[137] = 1.0;
  w[141] = a51;
  w[145] = a36;
  w[149] = a35;
  w[153] = a50;
  w[157] = a28;
  w[114] = a3;
  w[118] = w[10];
  w[122] = w[14];
  w[126] = w[18];
  w[130] = a33;
  w[134] = (-1.0) * a10;
  w[138] = 1.0;
  w[142] = a10;
  w[146] = a33;
  w[150] = a32;
  w[154] = a49;
  w[158] = a19;
  w[115] = a4;
  w[119] = w[11];
  w[123] = w[15];
  w[127] = w[19];
  w[131] = a30;
  w[135] = (-1.0) * a12;
  w[139] = 1.0;
  w[143] = a12;
  w[147] = a30;
  w[151] = a29;
  w[155] = a48;
  w[159] = a2;
  w[160] = a8;
  w[164] = w[28];
  w[168] = w[32];
  w[172] = w[36];
  w[176] = a26;
  w[180] = (-1.0) * a14;
  w[184] = 1.0;
  w[188] = a14;
  w[192] = a26;
  w[196] = a25;
  w[200] = a45;
  w[204] = a7;
  w[161] = a5;
  w[165] = w[29];
  w[169] = w[33];
  w[173] = w[37];
  w[177] = a22;
  w[181] = a20;
  w[185] = 1.0;
  w[189] = a16;
  w[193] = a22;
  w[197] = a21;
  w[201] = a42;
  w[205] = a1;
  w[162] = a5;
  w[166] = w[29];
  w[170] = w[33];
  w[174] = w[37];
  w[178] = a22;
  w[182] = a20;
  w[186] = 1.0;
  w[190] = a16;
  w[194] = a22;
  w[198] = a21;
  w[202] = a42;
  w[206] = a1;
  w[163] = a5;
  w[167] = w[29];
  w[171] = w[33];
  w[175] = w[37];
  w[179] = a22;
  w[183] = a20;
  w[187] = 1.0;
  w[191] = a16;
  w[195] = a22;
  w[199] = a21;
  w[203] = a42;
  w[207] = a1;
  MADE(planar_strip_kernels_variations)(w + 112, w + 40, 2);
  w[214] = a38 * a18 + a41 * a17;
  w[215] = a44 * a23 + a43 * a15;
  w[216] = a47 * a27 + a46 * a13;
  w[217] = a39 * a31 + a40 * a11;
  w[218] = a47 * a34 + a46 * a0;
  w[219] = a44 * a37 + a43 * a52;
  MADE(planar_strip_k_jacobian_columns)(w, planar_strip_kernels_table_0 + 0, w + 220, w + 236, 1);
  res[0][0] = 1.0 + w[220];
  res[0][1] = w[221];
  res[0][2] = w[222];
  res[0][3] = w[223];
  res[0][4] = w[221];
  res[0][5] = 0.33333333333333337 + w[225];
  res[0][6] = w[226];
  res[0][7] = w[227];
  res[0][8] = w[222];
  res[0][9] = w[226];
  res[0][10] = 0.19999999999999996 + w[230];
  res[0][11] = w[231];
  res[0][12] = w[223];
  res[0][13] = w[227];
  res[0][14] = w[231];
  res[0][15] = 0.14285714285714257 + w[235];
  return 0;
}
