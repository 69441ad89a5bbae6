/* Included once for each width of vectors. */
static void MADE(precurved_tube_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = GIVEN(0) + (GIVEN(4) * GIVEN(20) - GIVEN(8) * GIVEN(16)) / EACH(12.0);
  b1 = GIVEN(4) + (GIVEN(8) * GIVEN(12) - GIVEN(0) * GIVEN(20)) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH(C[0]) + b3 * (EACH(C[1]) + b3 * (EACH(C[2]) + b3 * (EACH(C[3]) + b3 * (EACH(C[4]) + b3 * (EACH(C[5]) + EACH(C[6]) * b3)))));
  b4 = EACH(C[7]) + b3 * (EACH(C[8]) + b3 * (EACH(C[9]) + b3 * b4));
  b5 = EACH(C[10]) + b3 * (EACH(C[11]) + b3 * (EACH(C[12]) + b3 * (EACH(C[13]) + b3 * (EACH(C[14]) + b3 * (EACH(C[15]) + EACH(C[16]) * b3)))));
  b5 = EACH(1.0) + b3 * (EACH(C[17]) + b3 * b5);
  b6 = b5 / EACH(2.0);
  STORE(made + 0, (EACH(1.0) - b3 * b4) / b5);
  STORE(made + 4, b6 * b0);
  STORE(made + 8, b6 * b1);
  STORE(made + 12, b6 * b2);
  STORE(made + 16, b0);
  STORE(made + 20, b1);
  STORE(made + 24, b2);
  STORE(made + 28, b5);
  STORE(made + 32, b4);
}

static void MADE(precurved_tube_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(precurved_tube_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84) + GIVEN(76) * GIVEN(88);
  b1 = GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84) + GIVEN(52) * GIVEN(88);
  b2 = GIVEN(36) * GIVEN(36) / EACH(2.0);
  b3 = GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84) + GIVEN(64) * GIVEN(88);
  b4 = GIVEN(40) * (GIVEN(32) * b1 - GIVEN(24) * b0) - b2 * b3;
  b5 = GIVEN(40) * (GIVEN(28) * b0 - GIVEN(32) * b3) - b2 * b1;
  b6 = b0 + (GIVEN(24) * b4 - GIVEN(28) * b5);
  b7 = EACH(C[18]) * b6;
  b0 = GIVEN(40) * (GIVEN(24) * b3 - GIVEN(28) * b1) - b2 * b0;
  b5 = b3 + (GIVEN(32) * b5 - GIVEN(24) * b0);
  b3 = EACH(C[18]) * b5;
  b4 = b1 + (GIVEN(28) * b0 - GIVEN(32) * b4);
  b0 = EACH(C[18]) * b4;
  STORE(made + 0, GIVEN(16) * b7 - GIVEN(20) * b3 + b4);
  STORE(made + 4, b5 - GIVEN(12) * b7 + GIVEN(20) * b0);
  STORE(made + 8, b6 + GIVEN(12) * b3 - GIVEN(16) * b0);
  STORE(made + 12, GIVEN(8) * b3 - GIVEN(4) * b7);
  STORE(made + 16, GIVEN(0) * b7 - GIVEN(8) * b0);
  STORE(made + 20, GIVEN(4) * b0 - GIVEN(0) * b3);
}

static void MADE(precurved_tube_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(precurved_tube_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32, b33;
  b0 = GIVEN(40) * GIVEN(32);
  b1 = b0 * GIVEN(32);
  b2 = GIVEN(40) * GIVEN(28);
  b3 = b2 * GIVEN(28);
  b4 = EACH(1.0) - (b1 + b3);
  b5 = GIVEN(36) * GIVEN(36);
  b6 = b5 / EACH(2.0);
  b7 = b6 * GIVEN(32);
  b8 = GIVEN(40) * GIVEN(24);
  b9 = b7 + b8 * GIVEN(28);
  b10 = b6 * GIVEN(28);
  b11 = b8 * GIVEN(32) - b10;
  b12 = GIVEN(44) * b4 + GIVEN(56) * b9 + GIVEN(68) * b11;
  b7 = b2 * GIVEN(24) - b7;
  b8 = b8 * GIVEN(24);
  b1 = EACH(1.0) - (b1 + b8);
  b13 = b6 * GIVEN(24);
  b2 = b13 + b2 * GIVEN(32);
  b14 = GIVEN(44) * b7 + GIVEN(56) * b1 + GIVEN(68) * b2;
  b15 = EACH(C[18]) * GIVEN(20);
  b10 = b10 + b0 * GIVEN(24);
  b13 = b0 * GIVEN(28) - b13;
  b8 = EACH(1.0) - (b3 + b8);
  b3 = GIVEN(44) * b10 + GIVEN(56) * b13 + GIVEN(68) * b8;
  b0 = EACH(C[18]) * GIVEN(16);
  b16 = GIVEN(48) * b4 + GIVEN(60) * b9 + GIVEN(72) * b11;
  b17 = GIVEN(48) * b7 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b18 = GIVEN(48) * b10 + GIVEN(60) * b13 + GIVEN(72) * b8;
  b11 = GIVEN(52) * b4 + GIVEN(64) * b9 + GIVEN(76) * b11;
  b2 = GIVEN(52) * b7 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b8 = GIVEN(52) * b10 + GIVEN(64) * b13 + GIVEN(76) * b8;
  b13 = EACH(C[18]) * GIVEN(12);
  b10 = EACH(C[18]) * GIVEN(8);
  b1 = EACH(C[18]) * GIVEN(4);
  b7 = EACH(C[18]) * GIVEN(0);
  b9 = GIVEN(52) * GIVEN(24) + GIVEN(64) * GIVEN(28) + GIVEN(76) * GIVEN(32);
  b5 = EACH(0.5) / b5;
  b4 = GIVEN(44) * GIVEN(24) + GIVEN(56) * GIVEN(28) + GIVEN(68) * GIVEN(32);
  b19 = GIVEN(48) * GIVEN(24) + GIVEN(60) * GIVEN(28) + GIVEN(72) * GIVEN(32);
  b20 = b4 * b4 + b19 * b19 + b9 * b9;
  b21 = EACH((-1.6534391534391535e-06)) + b20 * (EACH(1.670140559029448e-08) + b20 * (EACH((-1.1470745597729724e-10)) + b20 * (EACH(5.735372798864862e-13) + b20 * (EACH((-2.186688975602072e-15)) + b20 * (EACH(6.576508197299464e-18) + EACH((-1.6014224506411032e-20)) * b20)))));
  b21 = EACH((-0.002777777777777778)) + b20 * (EACH(9.92063492063492e-05) + b20 * b21);
  b22 = b5 * b21 * (GIVEN(80) * b4 + GIVEN(84) * b19 + GIVEN(88) * b9);
  b21 = b5 * (GIVEN(40) + b20 * b21);
  b20 = b22 * b9 - b21 * GIVEN(88);
  b5 = b9 * b20;
  b23 = b22 * b19 - b21 * GIVEN(84);
  b24 = b19 * b23;
  b25 = GIVEN(88) / EACH(2.0);
  b26 = b4 * b23;
  b21 = b22 * b4 - b21 * GIVEN(80);
  b22 = b19 * b21;
  b27 = b4 * b20;
  b28 = GIVEN(84) / EACH(2.0);
  b29 = b9 * b21;
  b21 = b4 * b21;
  b4 = GIVEN(80) / EACH(2.0);
  b20 = b19 * b20;
  b23 = b9 * b23;
  b9 = GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84) + GIVEN(76) * GIVEN(88);
  b19 = GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84) + GIVEN(52) * GIVEN(88);
  b30 = GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84) + GIVEN(64) * GIVEN(88);
  b31 = GIVEN(40) * (GIVEN(32) * b19 - GIVEN(24) * b9) - b6 * b30;
  b32 = GIVEN(40) * (GIVEN(28) * b9 - GIVEN(32) * b30) - b6 * b19;
  b33 = EACH(C[18]) * (b9 + (GIVEN(24) * b31 - GIVEN(28) * b32));
  b9 = GIVEN(40) * (GIVEN(24) * b30 - GIVEN(28) * b19) - b6 * b9;
  b32 = EACH(C[18]) * (b30 + (GIVEN(32) * b32 - GIVEN(24) * b9));
  b30 = EACH((-1.0)) * b32;
  b6 = EACH((-1.0)) * b33;
  b31 = EACH(C[18]) * (b19 + (GIVEN(28) * b9 - GIVEN(32) * b31));
  b9 = EACH((-1.0)) * b31;
  STORE(made + 0, b12 - b14 * b15 + b3 * b0);
  STORE(made + 4, b16 - b17 * b15 + b18 * b0);
  STORE(made + 8, b11 - b2 * b15 + b8 * b0);
  STORE(made + 12, b12 * b15 + b14 - b3 * b13);
  STORE(made + 16, b16 * b15 + b17 - b18 * b13);
  STORE(made + 20, b11 * b15 + b2 - b8 * b13);
  STORE(made + 24, b14 * b13 - b12 * b0 + b3);
  STORE(made + 28, b17 * b13 - b16 * b0 + b18);
  STORE(made + 32, b2 * b13 - b11 * b0 + b8);
  STORE(made + 36, b14 * b10 - b3 * b1);
  STORE(made + 40, b17 * b10 - b18 * b1);
  STORE(made + 44, b2 * b10 - b8 * b1);
  STORE(made + 48, b3 * b7 - b12 * b10);
  STORE(made + 52, b18 * b7 - b16 * b10);
  STORE(made + 56, b8 * b7 - b11 * b10);
  STORE(made + 60, b12 * b1 - b14 * b7);
  STORE(made + 64, b16 * b1 - b17 * b7);
  STORE(made + 68, b11 * b1 - b2 * b7);
  STORE(made + 72, EACH((-1.0)) * (EACH(2.0) * (b5 + b24)));
  STORE(made + 76, b25 + b26 + b22);
  STORE(made + 80, b27 - b28 + b29);
  STORE(made + 84, b22 - b25 + b26);
  STORE(made + 88, EACH((-1.0)) * (EACH(2.0) * (b5 + b21)));
  STORE(made + 92, b4 + b20 + b23);
  STORE(made + 96, b28 + b29 + b27);
  STORE(made + 100, b23 - b4 + b20);
  STORE(made + 104, EACH((-1.0)) * (EACH(2.0) * (b24 + b21)));
  STORE(made + 108, b33);
  STORE(made + 112, b30);
  STORE(made + 116, b6);
  STORE(made + 120, b31);
  STORE(made + 124, b32);
  STORE(made + 128, b9);
  STORE(made + 132, b6);
  STORE(made + 136, b32);
  STORE(made + 140, b33);
  STORE(made + 144, b9);
  STORE(made + 148, b30);
  STORE(made + 152, b31);
}

static void MADE(precurved_tube_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 156)
    EVERY_LANE(MADE(precurved_tube_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_turned_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5;
  b0 = p0[48] * LOAD(p1 + 112);
  b1 = p0[60] * LOAD(p1 + 140);
  b2 = p0[52] * LOAD(p1 + 112);
  b3 = p0[64] * LOAD(p1 + 140);
  b4 = p0[56] * LOAD(p1 + 112);
  b5 = p0[68] * LOAD(p1 + 140);
  b1 = p0[0] * LOAD(p1 + 0) + p0[12] * LOAD(p1 + 28) + p0[24] * LOAD(p1 + 56) + p0[36] * LOAD(p1 + 84) + b0 + b1;
  STORE(made + 0, b1);
  b3 = p0[4] * LOAD(p1 + 0) + p0[16] * LOAD(p1 + 28) + p0[28] * LOAD(p1 + 56) + p0[40] * LOAD(p1 + 84) + b2 + b3;
  STORE(made + 4, b3);
  b5 = p0[8] * LOAD(p1 + 0) + p0[20] * LOAD(p1 + 28) + p0[32] * LOAD(p1 + 56) + p0[44] * LOAD(p1 + 84) + b4 + b5;
  STORE(made + 8, b5);
}

static void MADE(precurved_tube_kernels_pulled_of_column)(const casadi_real *p0, const casadi_real *p1, const casadi_real *p2, const casadi_real *p3, const casadi_real *p4, const casadi_real *p5, casadi_real *made) {
  FOUR b0, b1, b2, b3;
  b0 = LOAD(p5 + 0) + (p1[0] * LOAD(p4 + 0) + p1[12] * LOAD(p4 + 4) + p1[24] * LOAD(p4 + 8));
  b1 = LOAD(p5 + 4) + (p1[4] * LOAD(p4 + 0) + p1[16] * LOAD(p4 + 4) + p1[28] * LOAD(p4 + 8));
  b2 = LOAD(p5 + 8) + (p1[8] * LOAD(p4 + 0) + p1[20] * LOAD(p4 + 4) + p1[32] * LOAD(p4 + 8));
  b3 = p0[0] * b0 + p0[4] * b1 + p0[8] * b2 + (p2[32] * LOAD(p3 + 112) + p2[40] * LOAD(p3 + 140));
  STORE(made + 0, b3);
  b3 = p0[12] * b0 + p0[16] * b1 + p0[20] * b2 + (p2[24] * LOAD(p3 + 84) + p2[44] * LOAD(p3 + 140));
  STORE(made + 4, b3);
  b3 = p0[24] * b0 + p0[28] * b1 + p0[32] * b2 + (p2[28] * LOAD(p3 + 84) + p2[36] * LOAD(p3 + 112));
  STORE(made + 8, b3);
  b3 = p0[36] * b0 + p0[40] * b1 + p0[44] * b2 + (p2[8] * LOAD(p3 + 28) + p2[16] * LOAD(p3 + 56));
  STORE(made + 12, b3);
  b3 = p0[48] * b0 + p0[52] * b1 + p0[56] * b2 + (p2[0] * LOAD(p3 + 0) + p2[20] * LOAD(p3 + 56));
  STORE(made + 16, b3);
  b2 = p0[60] * b0 + p0[64] * b1 + p0[68] * b2 + (p2[4] * LOAD(p3 + 0) + p2[12] * LOAD(p3 + 28));
  STORE(made + 20, b2);
}

static void MADE(precurved_tube_kernels_fold_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13;
  b0 = LOAD(p1 + 0) + LOAD(p1 + 144);
  b1 = LOAD(p1 + 24) + LOAD(p1 + 120);
  b2 = LOAD(p1 + 48) + LOAD(p1 + 96);
  b3 = LOAD(p1 + 0) - LOAD(p1 + 144);
  b4 = LOAD(p1 + 24) - LOAD(p1 + 120);
  b5 = LOAD(p1 + 48) - LOAD(p1 + 96);
  b6 = LOAD(p1 + 12) + LOAD(p1 + 156);
  b7 = LOAD(p1 + 36) + LOAD(p1 + 132);
  b8 = LOAD(p1 + 60) + LOAD(p1 + 108);
  b9 = (LOAD(p1 + 36) - LOAD(p1 + 132)) * p0[15];
  b10 = (LOAD(p1 + 60) - LOAD(p1 + 108)) * p0[16];
  b11 = LOAD(p1 + 72) * p0[17];
  b12 = LOAD(p1 + 84) * p0[24];
  STORE(made + 0, b0 * p0[0] + b1 * p0[1] + b2 * p0[2] + LOAD(p1 + 72) * p0[3]);
  b13 = b3 * p0[4] + b4 * p0[5] + b5 * p0[6] + b6 * p0[7] + b7 * p0[8] + b8 * p0[9] + LOAD(p1 + 84) * p0[10];
  STORE(made + 4, b13);
  b11 = b0 * p0[11] + b1 * p0[12] + b2 * p0[13] + (LOAD(p1 + 12) - LOAD(p1 + 156)) * p0[14] + b9 + b10 + b11;
  STORE(made + 8, b11);
  b12 = b3 * p0[18] + b4 * p0[19] + b5 * p0[20] + b6 * p0[21] + b7 * p0[22] + b8 * p0[23] + b12;
  STORE(made + 12, b12);
}

static void MADE(precurved_tube_kernels_fold_6_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  b0 = LOAD(p1 + 0) + LOAD(p1 + 144);
  b1 = LOAD(p1 + 24) + LOAD(p1 + 120);
  b2 = LOAD(p1 + 48) + LOAD(p1 + 96);
  b3 = LOAD(p1 + 0) - LOAD(p1 + 144);
  b4 = LOAD(p1 + 24) - LOAD(p1 + 120);
  b5 = LOAD(p1 + 48) - LOAD(p1 + 96);
  b6 = LOAD(p1 + 12) + LOAD(p1 + 156);
  b7 = LOAD(p1 + 36) + LOAD(p1 + 132);
  b8 = LOAD(p1 + 60) + LOAD(p1 + 108);
  b9 = LOAD(p1 + 12) - LOAD(p1 + 156);
  b10 = LOAD(p1 + 36) - LOAD(p1 + 132);
  b11 = LOAD(p1 + 60) - LOAD(p1 + 108);
  b12 = LOAD(p1 + 72) * p0[17];
  b13 = LOAD(p1 + 84) * p0[24];
  b14 = LOAD(p1 + 72) * p0[31];
  STORE(made + 0, b0 * p0[0] + b1 * p0[1] + b2 * p0[2] + LOAD(p1 + 72) * p0[3]);
  b15 = b3 * p0[4] + b4 * p0[5] + b5 * p0[6] + b6 * p0[7] + b7 * p0[8] + b8 * p0[9] + LOAD(p1 + 84) * p0[10];
  STORE(made + 4, b15);
  b12 = b0 * p0[11] + b1 * p0[12] + b2 * p0[13] + b9 * p0[14] + b10 * p0[15] + b11 * p0[16] + b12;
  STORE(made + 8, b12);
  b13 = b3 * p0[18] + b4 * p0[19] + b5 * p0[20] + b6 * p0[21] + b7 * p0[22] + b8 * p0[23] + b13;
  STORE(made + 12, b13);
  b14 = b0 * p0[25] + b1 * p0[26] + b2 * p0[27] + b9 * p0[28] + b10 * p0[29] + b11 * p0[30] + b14;
  STORE(made + 16, b14);
}

static void MADE(precurved_tube_kernels_increments_11_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = (GIVEN(12) * GIVEN(12) + GIVEN(16) * GIVEN(16) + GIVEN(20) * GIVEN(20)) / EACH(240.0);
  b0 = EACH(1.0) + (GIVEN(0) * GIVEN(24) + GIVEN(4) * GIVEN(28) + GIVEN(8) * GIVEN(32)) / EACH(360.0) - b0;
  b1 = (GIVEN(0) * GIVEN(12) + GIVEN(4) * GIVEN(16) + GIVEN(8) * GIVEN(20)) / EACH(240.0);
  b2 = (GIVEN(0) * GIVEN(0) + GIVEN(4) * GIVEN(4) + GIVEN(8) * GIVEN(8)) / EACH(720.0);
  b3 = EACH(C[18]) - EACH(2.0) * b2;
  b2 = EACH(C[18]) + b2;
  b4 = b2 * GIVEN(4) + GIVEN(28) / EACH(240.0);
  b5 = b2 * GIVEN(8) + GIVEN(32) / EACH(240.0);
  b6 = b0 * GIVEN(0) + b1 * GIVEN(12) + b3 * GIVEN(24) + (b4 * GIVEN(20) - b5 * GIVEN(16));
  b2 = b2 * GIVEN(0) + GIVEN(24) / EACH(240.0);
  b5 = b0 * GIVEN(4) + b1 * GIVEN(16) + b3 * GIVEN(28) + (b5 * GIVEN(12) - b2 * GIVEN(20));
  b4 = b0 * GIVEN(8) + b1 * GIVEN(20) + b3 * GIVEN(32) + (b2 * GIVEN(16) - b4 * GIVEN(12));
  b2 = b6 * b6 + b5 * b5 + b4 * b4;
  b3 = EACH(C[0]) + b2 * (EACH(C[1]) + b2 * (EACH(C[2]) + b2 * (EACH(C[3]) + b2 * (EACH(C[4]) + b2 * (EACH(C[5]) + EACH(C[6]) * b2)))));
  b3 = EACH(C[7]) + b2 * (EACH(C[8]) + b2 * (EACH(C[9]) + b2 * b3));
  b1 = EACH(C[10]) + b2 * (EACH(C[11]) + b2 * (EACH(C[12]) + b2 * (EACH(C[13]) + b2 * (EACH(C[14]) + b2 * (EACH(C[15]) + EACH(C[16]) * b2)))));
  b1 = EACH(1.0) + b2 * (EACH(C[17]) + b2 * b1);
  b0 = b1 / EACH(2.0);
  STORE(made + 0, (EACH(1.0) - b2 * b3) / b1);
  STORE(made + 4, b0 * b6);
  STORE(made + 8, b0 * b5);
  STORE(made + 12, b0 * b4);
  STORE(made + 16, b6);
  STORE(made + 20, b5);
  STORE(made + 24, b4);
  STORE(made + 28, b1);
  STORE(made + 32, b3);
}

static void MADE(precurved_tube_kernels_increments_11)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 36, made += 36)
    EVERY_LANE(MADE(precurved_tube_kernels_increments_11_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_pulls_12_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  b0 = (GIVEN(0) * GIVEN(0) + GIVEN(4) * GIVEN(4) + GIVEN(8) * GIVEN(8)) / EACH(720.0);
  b1 = EACH(C[18]) + b0;
  b2 = GIVEN(80) * GIVEN(92) + GIVEN(84) * GIVEN(96) + GIVEN(88) * GIVEN(100);
  b3 = GIVEN(56) * GIVEN(92) + GIVEN(60) * GIVEN(96) + GIVEN(64) * GIVEN(100);
  b4 = GIVEN(48) * GIVEN(48) / EACH(2.0);
  b5 = GIVEN(68) * GIVEN(92) + GIVEN(72) * GIVEN(96) + GIVEN(76) * GIVEN(100);
  b6 = GIVEN(52) * (GIVEN(44) * b3 - GIVEN(36) * b2) - b4 * b5;
  b7 = GIVEN(52) * (GIVEN(40) * b2 - GIVEN(44) * b5) - b4 * b3;
  b8 = b2 + (GIVEN(36) * b6 - GIVEN(40) * b7);
  b2 = GIVEN(52) * (GIVEN(36) * b5 - GIVEN(40) * b3) - b4 * b2;
  b7 = b5 + (GIVEN(44) * b7 - GIVEN(36) * b2);
  b5 = GIVEN(16) * b8 - GIVEN(20) * b7;
  b6 = b3 + (GIVEN(40) * b2 - GIVEN(44) * b6);
  b2 = GIVEN(12) * b7 - GIVEN(16) * b6;
  b3 = GIVEN(20) * b6 - GIVEN(12) * b8;
  b4 = EACH(2.0) * (EACH((-1.0)) * (GIVEN(32) * b8 + GIVEN(28) * b7 + GIVEN(24) * b6));
  b4 = EACH(0.001388888888888889) * (GIVEN(0) * b5 + GIVEN(8) * b2 + GIVEN(4) * b3 + b4);
  b9 = EACH(C[19]) * (GIVEN(20) * b8 + GIVEN(16) * b7 + GIVEN(12) * b6);
  b10 = (GIVEN(12) * GIVEN(12) + GIVEN(16) * GIVEN(16) + GIVEN(20) * GIVEN(20)) / EACH(240.0);
  b10 = EACH(1.0) + (GIVEN(0) * GIVEN(24) + GIVEN(4) * GIVEN(28) + GIVEN(8) * GIVEN(32)) / EACH(360.0) - b10;
  b11 = GIVEN(8) * b8 + GIVEN(4) * b7 + GIVEN(0) * b6;
  b12 = EACH(0.002777777777777778) * b11;
  b13 = b1 * GIVEN(8) + GIVEN(32) / EACH(240.0);
  b14 = b1 * GIVEN(4) + GIVEN(28) / EACH(240.0);
  b15 = (GIVEN(0) * GIVEN(12) + GIVEN(4) * GIVEN(16) + GIVEN(8) * GIVEN(20)) / EACH(240.0);
  b11 = EACH(C[19]) * b11;
  b16 = b1 * GIVEN(0) + GIVEN(24) / EACH(240.0);
  b0 = EACH(C[18]) - EACH(2.0) * b0;
  STORE(made + 0, b1 * b5 + EACH(2.0) * GIVEN(0) * b4 + GIVEN(12) * b9 + b10 * b6 + GIVEN(24) * b12);
  STORE(made + 4, b10 * b7 + b1 * b3 + EACH(2.0) * GIVEN(4) * b4 + GIVEN(16) * b9 + GIVEN(28) * b12);
  STORE(made + 8, b10 * b8 + b1 * b2 + EACH(2.0) * GIVEN(8) * b4 + GIVEN(20) * b9 + GIVEN(32) * b12);
  STORE(made + 12, b13 * b7 - b14 * b8 + b15 * b6 + GIVEN(0) * b9 - EACH(2.0) * GIVEN(12) * b11);
  STORE(made + 16, b16 * b8 + b15 * b7 - b13 * b6 + GIVEN(4) * b9 - EACH(2.0) * GIVEN(16) * b11);
  STORE(made + 20, b15 * b8 - b16 * b7 + b14 * b6 + GIVEN(8) * b9 - EACH(2.0) * GIVEN(20) * b11);
  STORE(made + 24, EACH(C[19]) * b5 + b0 * b6 + GIVEN(0) * b12);
  STORE(made + 28, b0 * b7 + EACH(C[19]) * b3 + GIVEN(4) * b12);
  STORE(made + 32, b0 * b8 + EACH(C[19]) * b2 + GIVEN(8) * b12);
}

static void MADE(precurved_tube_kernels_pulls_12)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 104, made += 36)
    EVERY_LANE(MADE(precurved_tube_kernels_pulls_12_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_chain_turn)(const casadi_real *given, casadi_real *made) {
  made[0] = given[0] * given[4] - given[1] * given[5] - given[2] * given[6] - given[3] * given[7];
  made[1] = given[0] * given[5] + given[1] * given[4] + given[2] * given[7] - given[3] * given[6];
  made[2] = given[0] * given[6] - given[1] * given[7] + given[2] * given[4] + given[3] * given[5];
  made[3] = given[0] * given[7] + given[1] * given[6] - given[2] * given[5] + given[3] * given[4];
}

static void MADE(precurved_tube_kernels_chain)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 8, made += 4)
    MADE(precurved_tube_kernels_chain_turn)(given, made);
}

static void MADE(precurved_tube_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  b0 = GIVEN(40) * GIVEN(32);
  b1 = b0 * GIVEN(32);
  b2 = GIVEN(40) * GIVEN(28);
  b3 = b2 * GIVEN(28);
  b4 = EACH(1.0) - (b1 + b3);
  b5 = GIVEN(36) * GIVEN(36) / EACH(2.0);
  b6 = b5 * GIVEN(32);
  b7 = GIVEN(40) * GIVEN(24);
  b8 = b6 + b7 * GIVEN(28);
  b9 = b5 * GIVEN(28);
  b10 = b7 * GIVEN(32) - b9;
  b11 = GIVEN(44) * b4 + GIVEN(56) * b8 + GIVEN(68) * b10;
  b6 = b2 * GIVEN(24) - b6;
  b7 = b7 * GIVEN(24);
  b1 = EACH(1.0) - (b1 + b7);
  b5 = b5 * GIVEN(24);
  b2 = b5 + b2 * GIVEN(32);
  b12 = GIVEN(44) * b6 + GIVEN(56) * b1 + GIVEN(68) * b2;
  b13 = EACH(C[18]) * GIVEN(20);
  b9 = b9 + b0 * GIVEN(24);
  b5 = b0 * GIVEN(28) - b5;
  b7 = EACH(1.0) - (b3 + b7);
  b3 = GIVEN(44) * b9 + GIVEN(56) * b5 + GIVEN(68) * b7;
  b0 = EACH(C[18]) * GIVEN(16);
  b14 = GIVEN(48) * b4 + GIVEN(60) * b8 + GIVEN(72) * b10;
  b15 = GIVEN(48) * b6 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b16 = GIVEN(48) * b9 + GIVEN(60) * b5 + GIVEN(72) * b7;
  b10 = GIVEN(52) * b4 + GIVEN(64) * b8 + GIVEN(76) * b10;
  b2 = GIVEN(52) * b6 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b7 = GIVEN(52) * b9 + GIVEN(64) * b5 + GIVEN(76) * b7;
  b5 = EACH(C[18]) * GIVEN(12);
  b9 = EACH(C[18]) * GIVEN(8);
  b1 = EACH(C[18]) * GIVEN(4);
  b6 = EACH(C[18]) * GIVEN(0);
  STORE(made + 0, b11 - b12 * b13 + b3 * b0);
  STORE(made + 4, b14 - b15 * b13 + b16 * b0);
  STORE(made + 8, b10 - b2 * b13 + b7 * b0);
  STORE(made + 12, b11 * b13 + b12 - b3 * b5);
  STORE(made + 16, b14 * b13 + b15 - b16 * b5);
  STORE(made + 20, b10 * b13 + b2 - b7 * b5);
  STORE(made + 24, b12 * b5 - b11 * b0 + b3);
  STORE(made + 28, b15 * b5 - b14 * b0 + b16);
  STORE(made + 32, b2 * b5 - b10 * b0 + b7);
  STORE(made + 36, b12 * b9 - b3 * b1);
  STORE(made + 40, b15 * b9 - b16 * b1);
  STORE(made + 44, b2 * b9 - b7 * b1);
  STORE(made + 48, b3 * b6 - b11 * b9);
  STORE(made + 52, b16 * b6 - b14 * b9);
  STORE(made + 56, b7 * b6 - b10 * b9);
  STORE(made + 60, b11 * b1 - b12 * b6);
  STORE(made + 64, b14 * b1 - b15 * b6);
  STORE(made + 68, b10 * b1 - b2 * b6);
}

static void MADE(precurved_tube_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 80, made += 72)
    EVERY_LANE(MADE(precurved_tube_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32;
  MADE(precurved_tube_kernels_turned_of_column)(w + 334, turns + 0, passed + 0);
  MADE(precurved_tube_kernels_turned_of_column)(w + 335, turns + 4, passed + 12);
  b0 = PASSED(4) + PASSED(16);
  MADE(precurved_tube_kernels_turned_of_column)(w + 336, turns + 8, passed + 24);
  b1 = b0 + PASSED(28);
  MADE(precurved_tube_kernels_turned_of_column)(w + 337, turns + 12, passed + 36);
  b2 = b1 + PASSED(40);
  MADE(precurved_tube_kernels_turned_of_column)(w + 490, turns + 16, passed + 48);
  b3 = b2 + PASSED(52);
  MADE(precurved_tube_kernels_turned_of_column)(w + 491, turns + 20, passed + 60);
  b4 = b3 + PASSED(64);
  MADE(precurved_tube_kernels_turned_of_column)(w + 492, turns + 24, passed + 72);
  b5 = b4 + PASSED(76);
  b6 = PASSED(0) + PASSED(12);
  b7 = b6 + PASSED(24);
  b8 = b7 + PASSED(36);
  b9 = b8 + PASSED(48);
  b10 = b9 + PASSED(60);
  b11 = b10 + PASSED(72);
  b12 = PASSED(8) + PASSED(20);
  b13 = b12 + PASSED(32);
  b14 = b13 + PASSED(44);
  b15 = b14 + PASSED(56);
  b16 = b15 + PASSED(68);
  b17 = b16 + PASSED(80);
  b18 = w[956] * b5 - w[957] * b11 + w[958] * b17;
  b19 = b18 + (w[959] * b4 - w[960] * b10 + w[961] * b16);
  b20 = b19 + (w[962] * b3 - w[963] * b9 + w[964] * b15);
  b21 = b20 + (w[965] * b2 - w[966] * b8 + w[967] * b14);
  b22 = b21 + (w[968] * b1 - w[969] * b7 + w[970] * b13);
  b23 = b22 + (w[971] * b0 - w[972] * b6 + w[973] * b12);
  STORE(passed + 304, b23 + (w[974] * PASSED(4) - w[975] * PASSED(0) + w[976] * PASSED(8)));
  b24 = w[977] * b11 - w[978] * b5 + w[979] * b17;
  b25 = b24 + (w[980] * b10 - w[981] * b4 + w[982] * b16);
  b26 = b25 + (w[983] * b9 - w[984] * b3 + w[985] * b15);
  b27 = b26 + (w[986] * b8 - w[987] * b2 + w[988] * b14);
  b28 = b27 + (w[989] * b7 - w[990] * b1 + w[991] * b13);
  b29 = b28 + (w[992] * b6 - w[993] * b0 + w[994] * b12);
  STORE(passed + 308, b29 + (w[995] * PASSED(0) - w[996] * PASSED(4) + w[997] * PASSED(8)));
  b17 = w[998] * b11 + w[999] * b5 - w[1000] * b17;
  b5 = b17 + (w[1001] * b10 + w[1002] * b4 - w[1003] * b16);
  b11 = b5 + (w[1004] * b9 + w[1005] * b3 - w[1006] * b15);
  b30 = b11 + (w[1007] * b8 + w[1008] * b2 - w[1009] * b14);
  b31 = b30 + (w[1010] * b7 + w[1011] * b1 - w[1012] * b13);
  b32 = b31 + (w[1013] * b6 + w[1014] * b0 - w[1015] * b12);
  STORE(passed + 312, b32 + (w[1016] * PASSED(0) + w[1017] * PASSED(4) - w[1018] * PASSED(8)));
  MADE(precurved_tube_kernels_pulled_of_column)(w + 334, w + 406, w + 442, turns + 0, passed + 0, passed + 304, passed + 84);
  STORE(passed + 316, w[325] * PASSED(8) - w[332] * PASSED(4) + b23);
  STORE(passed + 320, w[332] * PASSED(0) - w[314] * PASSED(8) + b29);
  STORE(passed + 324, w[314] * PASSED(4) - w[325] * PASSED(0) + b32);
  MADE(precurved_tube_kernels_pulled_of_column)(w + 335, w + 407, w + 443, turns + 4, passed + 12, passed + 316, passed + 108);
  STORE(passed + 328, w[324] * b12 - w[331] * b0 + b22);
  STORE(passed + 332, w[331] * b6 - w[313] * b12 + b28);
  STORE(passed + 336, w[313] * b0 - w[324] * b6 + b31);
  MADE(precurved_tube_kernels_pulled_of_column)(w + 336, w + 408, w + 444, turns + 8, passed + 24, passed + 328, passed + 132);
  STORE(passed + 340, w[323] * b13 - w[330] * b1 + b21);
  STORE(passed + 344, w[330] * b7 - w[312] * b13 + b27);
  STORE(passed + 348, w[312] * b1 - w[323] * b7 + b30);
  MADE(precurved_tube_kernels_pulled_of_column)(w + 337, w + 409, w + 445, turns + 12, passed + 36, passed + 340, passed + 156);
  STORE(passed + 352, w[321] * b14 - w[329] * b2 + b20);
  STORE(passed + 356, w[329] * b8 - w[309] * b14 + b26);
  STORE(passed + 360, w[309] * b2 - w[321] * b8 + b11);
  MADE(precurved_tube_kernels_pulled_of_column)(w + 490, w + 562, w + 598, turns + 16, passed + 48, passed + 352, passed + 180);
  STORE(passed + 364, w[319] * b15 - w[328] * b3 + b19);
  STORE(passed + 368, w[328] * b9 - w[306] * b15 + b25);
  STORE(passed + 372, w[306] * b3 - w[319] * b9 + b5);
  MADE(precurved_tube_kernels_pulled_of_column)(w + 491, w + 563, w + 599, turns + 20, passed + 60, passed + 364, passed + 204);
  STORE(passed + 376, w[317] * b16 - w[327] * b4 + b18);
  STORE(passed + 380, w[327] * b10 - w[303] * b16 + b24);
  STORE(passed + 384, w[303] * b4 - w[317] * b10 + b17);
  MADE(precurved_tube_kernels_pulled_of_column)(w + 492, w + 564, w + 600, turns + 24, passed + 72, passed + 376, passed + 228);
  MADE(precurved_tube_kernels_fold_of_column)(precurved_tube_kernels_table_0, passed + 84, passed + 252);
  MADE(precurved_tube_kernels_fold_of_column)(precurved_tube_kernels_table_0, passed + 88, passed + 268);
  MADE(precurved_tube_kernels_fold_6_of_column)(precurved_tube_kernels_table_1, passed + 92, passed + 284);
  STORE(columns + 0, EACH(C[20]) * PASSED(252));
  STORE(columns + 16, EACH(C[20]) * PASSED(256));
  STORE(columns + 32, EACH(C[20]) * PASSED(260));
  STORE(columns + 48, EACH(C[20]) * PASSED(264));
  STORE(columns + 64, EACH(C[20]) * PASSED(268));
  STORE(columns + 80, EACH(C[20]) * PASSED(272));
  STORE(columns + 96, EACH(C[20]) * PASSED(276));
  STORE(columns + 112, EACH(C[20]) * PASSED(280));
  STORE(columns + 128, EACH(C[20]) * PASSED(284));
  STORE(columns + 144, EACH(C[20]) * PASSED(288));
  STORE(columns + 160, EACH(C[20]) * PASSED(292));
  STORE(columns + 176, EACH(C[20]) * PASSED(296));
  STORE(columns + 192, EACH(C[20]) * PASSED(300));
}

static void MADE(precurved_tube_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 168, columns += 4) {
    EVERY_LANE(MADE(precurved_tube_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_0)(casadi_real *w) {
  FOR_FOURS(i, 13) {
    STORE(w + 43 + i, LOAD(w + 1 + i) + LOAD(w + 14 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_2)(casadi_real *w) {
  FOR_FOURS(i, 22) {
    STORE(w + 128 + i, LOAD(precurved_tube_kernels_table_8 + i) * LOAD(w + 150 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_3)(casadi_real *w) {
  FOR_FOURS(i, 15) {
    STORE(w + 150 + i, LOAD(w + 172 + i) + LOAD(w + 187 + i));
    STORE(w + 271 + i, LOAD(w + 346 + i) - LOAD(w + 361 + i));
    STORE(w + 286 + i, LOAD(w + 205 + i) + LOAD(w + 220 + i));
    STORE(w + 301 + i, LOAD(w + 376 + i) - LOAD(w + 391 + i));
    STORE(w + 316 + i, LOAD(w + 238 + i) + LOAD(w + 253 + i));
    STORE(w + 331 + i, LOAD(w + 406 + i) - LOAD(w + 421 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_4)(casadi_real *w) {
  FOR_FOURS(i, 62) {
    STORE(w + 346 + i, LOAD(precurved_tube_kernels_table_21 + i) + LOAD(w + 436 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_5)(casadi_real *w) {
  FOR_FOURS(i, 12) {
    FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14;
    b0 = EACH(2.0) * LOAD(w + 540 + i);
    b1 = b0 * LOAD(w + 540 + i);
    b2 = EACH(2.0) * LOAD(w + 552 + i) * LOAD(w + 552 + i);
    b3 = EACH(2.0) * LOAD(w + 564 + i);
    b4 = b3 * LOAD(w + 540 + i);
    b5 = EACH(2.0) * LOAD(w + 576 + i);
    b6 = b5 * LOAD(w + 552 + i);
    b7 = b3 * LOAD(w + 552 + i);
    b8 = b5 * LOAD(w + 540 + i);
    b3 = EACH(1.0) - b3 * LOAD(w + 564 + i);
    b0 = b0 * LOAD(w + 552 + i);
    b5 = b5 * LOAD(w + 564 + i);
    b9 = b7 + b8;
    b10 = b0 - b5;
    b11 = b3 - b1;
    b12 = EACH(0.15) * b9;
    b13 = EACH(0.15) * b10;
    b14 = EACH(0.15) * b11;
    STORE(w + 241 + i, EACH(1.0) - b1 - b2);
    STORE(w + 253 + i, b4 + b6);
    STORE(w + 286 + i, b7 - b8);
    STORE(w + 298 + i, b4 - b6);
    STORE(w + 408 + i, b3 - b2);
    STORE(w + 420 + i, b0 + b5);
    STORE(w + 432 + i, b9);
    STORE(w + 444 + i, b10);
    STORE(w + 456 + i, b11);
    STORE(w + 468 + i, b12);
    STORE(w + 480 + i, b13);
    STORE(w + 492 + i, b14);
    STORE(w + 504 + i, b13 * LOAD(w + 80 + i) - b14 * LOAD(w + 68 + i));
    STORE(w + 516 + i, b14 * LOAD(w + 56 + i) - b12 * LOAD(w + 80 + i));
    STORE(w + 528 + i, b12 * LOAD(w + 68 + i) - b13 * LOAD(w + 56 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_8)(casadi_real *w) {
  FOR_FOURS(i, 15) {
    STORE(w + 46 + i, LOAD(w + 165 + i) + LOAD(w + 180 + i));
    STORE(w + 61 + i, LOAD(w + 165 + i) - LOAD(w + 180 + i));
    STORE(w + 76 + i, LOAD(w + 195 + i) + LOAD(w + 210 + i));
    STORE(w + 91 + i, LOAD(w + 195 + i) - LOAD(w + 210 + i));
    STORE(w + 106 + i, LOAD(w + 241 + i) + LOAD(w + 256 + i));
    STORE(w + 150 + i, LOAD(w + 241 + i) - LOAD(w + 256 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_9)(casadi_real *w) {
  FOR_FOURS(i, 22) {
    STORE(w + 53 + i, LOAD(w + 150 + i) + EACH(C[20]) * LOAD(w + 94 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_10)(casadi_real *w) {
  FOR_FOURS(i, 9) {
    STORE(w + 75 + i, LOAD(w + 84 + i));
  }
}

static void MADE(precurved_tube_k_richer_balance_loop_12)(casadi_real *w) {
  FOR_FOURS(i, 9) {
    STORE(w + 75 + i, EACH((-1.0)) * LOAD(w + 84 + i));
  }
}

static void MADE(precurved_tube_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21;
  MADE(precurved_tube_kernels_turned_of_column)(w + 301, turns + 0, passed + 0);
  MADE(precurved_tube_kernels_turned_of_column)(w + 302, turns + 4, passed + 12);
  b0 = PASSED(4) + PASSED(16);
  MADE(precurved_tube_kernels_turned_of_column)(w + 303, turns + 8, passed + 24);
  b1 = b0 + PASSED(28);
  MADE(precurved_tube_kernels_turned_of_column)(w + 304, turns + 12, passed + 36);
  b2 = b1 + PASSED(40);
  MADE(precurved_tube_kernels_turned_of_column)(w + 373, turns + 16, passed + 48);
  b3 = b2 + PASSED(52);
  MADE(precurved_tube_kernels_turned_of_column)(w + 374, turns + 20, passed + 60);
  b4 = b3 + PASSED(64);
  MADE(precurved_tube_kernels_turned_of_column)(w + 375, turns + 24, passed + 72);
  b5 = b4 + PASSED(76);
  b6 = w[623] * PASSED(4) + w[642] * b0 + w[661] * b1 + w[680] * b2 + w[699] * b3 + w[718] * b4 + w[737] * b5;
  b7 = PASSED(8) + PASSED(20);
  b8 = b7 + PASSED(32);
  b9 = b8 + PASSED(44);
  b10 = b9 + PASSED(56);
  b11 = b10 + PASSED(68);
  b12 = b11 + PASSED(80);
  b13 = w[744] * b12;
  b14 = PASSED(0) + PASSED(12);
  b15 = b14 + PASSED(24);
  b16 = b15 + PASSED(36);
  b17 = b16 + PASSED(48);
  b18 = b17 + PASSED(60);
  b19 = b18 + PASSED(72);
  b20 = w[623] * PASSED(0) + w[642] * b14 + w[661] * b15 + w[680] * b16 + w[699] * b17 + w[718] * b18 + w[737] * b19;
  b21 = w[751] * b12;
  b18 = w[738] * PASSED(0) + w[739] * b14 + w[740] * b15 + w[741] * b16 + w[742] * b17 + w[743] * b18 + w[744] * b19;
  b17 = w[751] * b5;
  b13 = b6 - w[738] * PASSED(8) - w[739] * b7 - w[740] * b8 - w[741] * b9 - w[742] * b10 - w[743] * b11 - b13;
  STORE(columns + 0, b13);
  b21 = w[745] * PASSED(8) - b20 + w[746] * b7 + w[747] * b8 + w[748] * b9 + w[749] * b10 + w[750] * b11 + b21;
  STORE(columns + 16, b21);
  b17 = b18 - w[745] * PASSED(4) - w[746] * b0 - w[747] * b1 - w[748] * b2 - w[749] * b3 - w[750] * b4 - b17;
  STORE(columns + 32, b17);
  STORE(columns + 48, EACH((-1.0)) * ((b19 * w[218] + b5 * w[215] + b12 * w[216]) / EACH(2.0)));
  STORE(columns + 64, (b19 * w[217] + b5 * w[216] - b12 * w[215]) / EACH(2.0));
  STORE(columns + 80, (b5 * w[217] - b19 * w[216] + b12 * w[218]) / EACH(2.0));
  STORE(columns + 96, (b19 * w[215] - b5 * w[218] + b12 * w[217]) / EACH(2.0));
}

static void MADE(precurved_tube_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 168, columns += 4) {
    EVERY_LANE(MADE(precurved_tube_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
