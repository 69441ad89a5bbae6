/* Included once for each width of vectors. */
static void MADE(nitinol_wire_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = GIVEN(0) - GIVEN(8) * GIVEN(16) / EACH(12.0);
  b1 = GIVEN(4) + GIVEN(8) * GIVEN(12) / EACH(12.0);
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

static void MADE(nitinol_wire_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 20, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = GIVEN(64) * GIVEN(76) + GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84);
  b1 = GIVEN(40) * GIVEN(76) + GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84);
  b2 = GIVEN(32) * GIVEN(32) / EACH(2.0);
  b3 = GIVEN(52) * GIVEN(76) + GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84);
  b4 = GIVEN(36) * (GIVEN(28) * b1 - GIVEN(20) * b0) - b2 * b3;
  b5 = GIVEN(36) * (GIVEN(24) * b0 - GIVEN(28) * b3) - b2 * b1;
  b6 = b0 + (GIVEN(20) * b4 - GIVEN(24) * b5);
  b7 = EACH(C[18]) * b6;
  b0 = GIVEN(36) * (GIVEN(20) * b3 - GIVEN(24) * b1) - b2 * b0;
  b4 = b1 + (GIVEN(24) * b0 - GIVEN(28) * b4);
  b0 = b3 + (GIVEN(28) * b5 - GIVEN(20) * b0);
  b5 = EACH(C[18]) * b0;
  b3 = EACH(C[18]) * b4;
  STORE(made + 0, GIVEN(16) * b7 + b4);
  STORE(made + 4, b0 - GIVEN(12) * b7);
  STORE(made + 8, b6 + GIVEN(12) * b5 - GIVEN(16) * b3);
  STORE(made + 12, GIVEN(8) * b5 - GIVEN(4) * b7);
  STORE(made + 16, GIVEN(0) * b7 - GIVEN(8) * b3);
  STORE(made + 20, GIVEN(4) * b3 - GIVEN(0) * b5);
}

static void MADE(nitinol_wire_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 88, made += 24)
    EVERY_LANE(MADE(nitinol_wire_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32;
  b0 = GIVEN(36) * GIVEN(28);
  b1 = b0 * GIVEN(28);
  b2 = GIVEN(36) * GIVEN(24);
  b3 = b2 * GIVEN(24);
  b4 = EACH(1.0) - (b1 + b3);
  b5 = GIVEN(32) * GIVEN(32);
  b6 = b5 / EACH(2.0);
  b7 = b6 * GIVEN(28);
  b8 = GIVEN(36) * GIVEN(20);
  b9 = b7 + b8 * GIVEN(24);
  b10 = b6 * GIVEN(24);
  b11 = b8 * GIVEN(28) - b10;
  b12 = GIVEN(40) * b4 + GIVEN(52) * b9 + GIVEN(64) * b11;
  b10 = b10 + b0 * GIVEN(20);
  b13 = b6 * GIVEN(20);
  b0 = b0 * GIVEN(24) - b13;
  b8 = b8 * GIVEN(20);
  b3 = EACH(1.0) - (b3 + b8);
  b14 = GIVEN(40) * b10 + GIVEN(52) * b0 + GIVEN(64) * b3;
  b15 = EACH(C[18]) * GIVEN(16);
  b16 = GIVEN(44) * b4 + GIVEN(56) * b9 + GIVEN(68) * b11;
  b17 = GIVEN(44) * b10 + GIVEN(56) * b0 + GIVEN(68) * b3;
  b11 = GIVEN(48) * b4 + GIVEN(60) * b9 + GIVEN(72) * b11;
  b3 = GIVEN(48) * b10 + GIVEN(60) * b0 + GIVEN(72) * b3;
  b7 = b2 * GIVEN(20) - b7;
  b8 = EACH(1.0) - (b1 + b8);
  b2 = b13 + b2 * GIVEN(28);
  b13 = GIVEN(40) * b7 + GIVEN(52) * b8 + GIVEN(64) * b2;
  b1 = EACH(C[18]) * GIVEN(12);
  b0 = GIVEN(44) * b7 + GIVEN(56) * b8 + GIVEN(68) * b2;
  b2 = GIVEN(48) * b7 + GIVEN(60) * b8 + GIVEN(72) * b2;
  b8 = EACH(C[18]) * GIVEN(8);
  b7 = EACH(C[18]) * GIVEN(4);
  b10 = EACH(C[18]) * GIVEN(0);
  b9 = GIVEN(48) * GIVEN(20) + GIVEN(60) * GIVEN(24) + GIVEN(72) * GIVEN(28);
  b5 = EACH(0.5) / b5;
  b4 = GIVEN(40) * GIVEN(20) + GIVEN(52) * GIVEN(24) + GIVEN(64) * GIVEN(28);
  b18 = GIVEN(44) * GIVEN(20) + GIVEN(56) * GIVEN(24) + GIVEN(68) * GIVEN(28);
  b19 = b4 * b4 + b18 * b18 + b9 * b9;
  b20 = EACH((-1.6534391534391535e-06)) + b19 * (EACH(1.670140559029448e-08) + b19 * (EACH((-1.1470745597729724e-10)) + b19 * (EACH(5.735372798864862e-13) + b19 * (EACH((-2.186688975602072e-15)) + b19 * (EACH(6.576508197299464e-18) + EACH((-1.6014224506411032e-20)) * b19)))));
  b20 = EACH((-0.002777777777777778)) + b19 * (EACH(9.92063492063492e-05) + b19 * b20);
  b21 = b5 * b20 * (GIVEN(76) * b4 + GIVEN(80) * b18 + GIVEN(84) * b9);
  b20 = b5 * (GIVEN(36) + b19 * b20);
  b19 = b21 * b9 - b20 * GIVEN(84);
  b5 = b9 * b19;
  b22 = b21 * b18 - b20 * GIVEN(80);
  b23 = b18 * b22;
  b24 = GIVEN(84) / EACH(2.0);
  b25 = b4 * b22;
  b20 = b21 * b4 - b20 * GIVEN(76);
  b21 = b18 * b20;
  b26 = b4 * b19;
  b27 = GIVEN(80) / EACH(2.0);
  b28 = b9 * b20;
  b20 = b4 * b20;
  b4 = GIVEN(76) / EACH(2.0);
  b19 = b18 * b19;
  b22 = b9 * b22;
  b9 = GIVEN(64) * GIVEN(76) + GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84);
  b18 = GIVEN(40) * GIVEN(76) + GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84);
  b29 = GIVEN(52) * GIVEN(76) + GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84);
  b30 = GIVEN(36) * (GIVEN(28) * b18 - GIVEN(20) * b9) - b6 * b29;
  b31 = GIVEN(36) * (GIVEN(24) * b9 - GIVEN(28) * b29) - b6 * b18;
  b32 = EACH(C[18]) * (b9 + (GIVEN(20) * b30 - GIVEN(24) * b31));
  b9 = GIVEN(36) * (GIVEN(20) * b29 - GIVEN(24) * b18) - b6 * b9;
  b31 = EACH(C[18]) * (b29 + (GIVEN(28) * b31 - GIVEN(20) * b9));
  b29 = EACH((-1.0)) * b31;
  b6 = EACH((-1.0)) * b32;
  b30 = EACH(C[18]) * (b18 + (GIVEN(24) * b9 - GIVEN(28) * b30));
  b9 = EACH((-1.0)) * b30;
  STORE(made + 0, b12 + b14 * b15);
  STORE(made + 4, b16 + b17 * b15);
  STORE(made + 8, b11 + b3 * b15);
  STORE(made + 12, b13 - b14 * b1);
  STORE(made + 16, b0 - b17 * b1);
  STORE(made + 20, b2 - b3 * b1);
  STORE(made + 24, b13 * b1 - b12 * b15 + b14);
  STORE(made + 28, b0 * b1 - b16 * b15 + b17);
  STORE(made + 32, b2 * b1 - b11 * b15 + b3);
  STORE(made + 36, b13 * b8 - b14 * b7);
  STORE(made + 40, b0 * b8 - b17 * b7);
  STORE(made + 44, b2 * b8 - b3 * b7);
  STORE(made + 48, b14 * b10 - b12 * b8);
  STORE(made + 52, b17 * b10 - b16 * b8);
  STORE(made + 56, b3 * b10 - b11 * b8);
  STORE(made + 60, b12 * b7 - b13 * b10);
  STORE(made + 64, b16 * b7 - b0 * b10);
  STORE(made + 68, b11 * b7 - b2 * b10);
  STORE(made + 72, EACH((-1.0)) * (EACH(2.0) * (b5 + b23)));
  STORE(made + 76, b24 + b25 + b21);
  STORE(made + 80, b26 - b27 + b28);
  STORE(made + 84, b21 - b24 + b25);
  STORE(made + 88, EACH((-1.0)) * (EACH(2.0) * (b5 + b20)));
  STORE(made + 92, b4 + b19 + b22);
  STORE(made + 96, b27 + b28 + b26);
  STORE(made + 100, b22 - b4 + b19);
  STORE(made + 104, EACH((-1.0)) * (EACH(2.0) * (b23 + b20)));
  STORE(made + 108, b32);
  STORE(made + 112, b29);
  STORE(made + 116, b6);
  STORE(made + 120, b30);
  STORE(made + 124, b31);
  STORE(made + 128, b9);
  STORE(made + 132, b6);
  STORE(made + 136, b31);
  STORE(made + 140, b32);
  STORE(made + 144, b9);
  STORE(made + 148, b29);
  STORE(made + 152, b30);
}

static void MADE(nitinol_wire_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 88, made += 156)
    EVERY_LANE(MADE(nitinol_wire_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_turned_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2;
  b0 = p0[48] * LOAD(p1 + 96);
  b1 = p0[52] * LOAD(p1 + 96);
  b2 = p0[56] * LOAD(p1 + 96);
  b0 = p0[0] * LOAD(p1 + 0) + p0[12] * LOAD(p1 + 24) + p0[24] * LOAD(p1 + 48) + p0[36] * LOAD(p1 + 72) + b0;
  STORE(made + 0, b0);
  b1 = p0[4] * LOAD(p1 + 0) + p0[16] * LOAD(p1 + 24) + p0[28] * LOAD(p1 + 48) + p0[40] * LOAD(p1 + 72) + b1;
  STORE(made + 4, b1);
  b2 = p0[8] * LOAD(p1 + 0) + p0[20] * LOAD(p1 + 24) + p0[32] * LOAD(p1 + 48) + p0[44] * LOAD(p1 + 72) + b2;
  STORE(made + 8, b2);
}

static void MADE(nitinol_wire_kernels_pulled_of_column)(const casadi_real *p0, const casadi_real *p1, const casadi_real *p2, const casadi_real *p3, const casadi_real *p4, const casadi_real *p5, casadi_real *made) {
  FOUR b0, b1, b2, b3;
  b0 = LOAD(p5 + 0) + (p1[0] * LOAD(p4 + 0) + p1[12] * LOAD(p4 + 4) + p1[24] * LOAD(p4 + 8));
  b1 = LOAD(p5 + 4) + (p1[4] * LOAD(p4 + 0) + p1[16] * LOAD(p4 + 4) + p1[28] * LOAD(p4 + 8));
  b2 = LOAD(p5 + 8) + (p1[8] * LOAD(p4 + 0) + p1[20] * LOAD(p4 + 4) + p1[32] * LOAD(p4 + 8));
  STORE(made + 0, p0[0] * b0 + p0[4] * b1 + p0[8] * b2 + p2[32] * LOAD(p3 + 96));
  STORE(made + 4, p0[12] * b0 + p0[16] * b1 + p0[20] * b2 + p2[24] * LOAD(p3 + 72));
  b3 = p0[24] * b0 + p0[28] * b1 + p0[32] * b2 + (p2[28] * LOAD(p3 + 72) + p2[36] * LOAD(p3 + 96));
  STORE(made + 8, b3);
  b3 = p0[36] * b0 + p0[40] * b1 + p0[44] * b2 + (p2[8] * LOAD(p3 + 24) + p2[16] * LOAD(p3 + 48));
  STORE(made + 12, b3);
  b3 = p0[48] * b0 + p0[52] * b1 + p0[56] * b2 + (p2[0] * LOAD(p3 + 0) + p2[20] * LOAD(p3 + 48));
  STORE(made + 16, b3);
  b2 = p0[60] * b0 + p0[64] * b1 + p0[68] * b2 + (p2[4] * LOAD(p3 + 0) + p2[12] * LOAD(p3 + 24));
  STORE(made + 20, b2);
}

static void MADE(nitinol_wire_kernels_fold_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = LOAD(p1 + 0) + LOAD(p1 + 120);
  b1 = LOAD(p1 + 24) + LOAD(p1 + 96);
  b2 = LOAD(p1 + 48) + LOAD(p1 + 72);
  b3 = (LOAD(p1 + 48) - LOAD(p1 + 72)) * p0[5];
  b4 = (LOAD(p1 + 12) + LOAD(p1 + 132)) * p0[6];
  b5 = (LOAD(p1 + 36) + LOAD(p1 + 108)) * p0[7];
  b6 = (LOAD(p1 + 60) + LOAD(p1 + 84)) * p0[8];
  b7 = (LOAD(p1 + 36) - LOAD(p1 + 108)) * p0[13];
  b8 = (LOAD(p1 + 60) - LOAD(p1 + 84)) * p0[14];
  STORE(made + 0, b0 * p0[0] + b1 * p0[1] + b2 * p0[2]);
  b6 = (LOAD(p1 + 0) - LOAD(p1 + 120)) * p0[3] + (LOAD(p1 + 24) - LOAD(p1 + 96)) * p0[4] + b3 + b4 + b5 + b6;
  STORE(made + 4, b6);
  b8 = b0 * p0[9] + b1 * p0[10] + b2 * p0[11] + (LOAD(p1 + 12) - LOAD(p1 + 132)) * p0[12] + b7 + b8;
  STORE(made + 8, b8);
}

static void MADE(nitinol_wire_kernels_fold_6_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0;
  b0 = (LOAD(p1 + 48) + LOAD(p1 + 72)) * p0[2];
  STORE(made + 0, (LOAD(p1 + 0) + LOAD(p1 + 120)) * p0[0] + (LOAD(p1 + 24) + LOAD(p1 + 96)) * p0[1] + b0);
}

static void MADE(nitinol_wire_kernels_increments_11_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_increments_11)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 36, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_increments_11_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_pulls_12_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_pulls_12)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 104, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_pulls_12_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  b0 = GIVEN(36) * GIVEN(28);
  b1 = b0 * GIVEN(28);
  b2 = GIVEN(36) * GIVEN(24);
  b3 = b2 * GIVEN(24);
  b4 = EACH(1.0) - (b1 + b3);
  b5 = GIVEN(32) * GIVEN(32) / EACH(2.0);
  b6 = b5 * GIVEN(28);
  b7 = GIVEN(36) * GIVEN(20);
  b8 = b6 + b7 * GIVEN(24);
  b9 = b5 * GIVEN(24);
  b10 = b7 * GIVEN(28) - b9;
  b11 = GIVEN(40) * b4 + GIVEN(52) * b8 + GIVEN(64) * b10;
  b9 = b9 + b0 * GIVEN(20);
  b5 = b5 * GIVEN(20);
  b0 = b0 * GIVEN(24) - b5;
  b7 = b7 * GIVEN(20);
  b3 = EACH(1.0) - (b3 + b7);
  b12 = GIVEN(40) * b9 + GIVEN(52) * b0 + GIVEN(64) * b3;
  b13 = EACH(C[18]) * GIVEN(16);
  b14 = GIVEN(44) * b4 + GIVEN(56) * b8 + GIVEN(68) * b10;
  b15 = GIVEN(44) * b9 + GIVEN(56) * b0 + GIVEN(68) * b3;
  b10 = GIVEN(48) * b4 + GIVEN(60) * b8 + GIVEN(72) * b10;
  b3 = GIVEN(48) * b9 + GIVEN(60) * b0 + GIVEN(72) * b3;
  b6 = b2 * GIVEN(20) - b6;
  b7 = EACH(1.0) - (b1 + b7);
  b2 = b5 + b2 * GIVEN(28);
  b5 = GIVEN(40) * b6 + GIVEN(52) * b7 + GIVEN(64) * b2;
  b1 = EACH(C[18]) * GIVEN(12);
  b0 = GIVEN(44) * b6 + GIVEN(56) * b7 + GIVEN(68) * b2;
  b2 = GIVEN(48) * b6 + GIVEN(60) * b7 + GIVEN(72) * b2;
  b7 = EACH(C[18]) * GIVEN(8);
  b6 = EACH(C[18]) * GIVEN(4);
  b9 = EACH(C[18]) * GIVEN(0);
  STORE(made + 0, b11 + b12 * b13);
  STORE(made + 4, b14 + b15 * b13);
  STORE(made + 8, b10 + b3 * b13);
  STORE(made + 12, b5 - b12 * b1);
  STORE(made + 16, b0 - b15 * b1);
  STORE(made + 20, b2 - b3 * b1);
  STORE(made + 24, b5 * b1 - b11 * b13 + b12);
  STORE(made + 28, b0 * b1 - b14 * b13 + b15);
  STORE(made + 32, b2 * b1 - b10 * b13 + b3);
  STORE(made + 36, b5 * b7 - b12 * b6);
  STORE(made + 40, b0 * b7 - b15 * b6);
  STORE(made + 44, b2 * b7 - b3 * b6);
  STORE(made + 48, b12 * b9 - b11 * b7);
  STORE(made + 52, b15 * b9 - b14 * b7);
  STORE(made + 56, b3 * b9 - b10 * b7);
  STORE(made + 60, b11 * b6 - b5 * b9);
  STORE(made + 64, b14 * b6 - b0 * b9);
  STORE(made + 68, b10 * b6 - b2 * b9);
}

static void MADE(nitinol_wire_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 76, made += 72)
    EVERY_LANE(MADE(nitinol_wire_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26;
  MADE(nitinol_wire_kernels_turned_of_column)(w + 270, turns + 0, passed + 0);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 271, turns + 4, passed + 12);
  b0 = PASSED(4) + PASSED(16);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 272, turns + 8, passed + 24);
  b1 = b0 + PASSED(28);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 273, turns + 12, passed + 36);
  b2 = b1 + PASSED(40);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 426, turns + 16, passed + 48);
  b3 = b2 + PASSED(52);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 427, turns + 20, passed + 60);
  b4 = b3 + PASSED(64);
  b5 = PASSED(0) + PASSED(12);
  b6 = b5 + PASSED(24);
  b7 = b6 + PASSED(36);
  b8 = b7 + PASSED(48);
  b9 = b8 + PASSED(60);
  b10 = PASSED(8) + PASSED(20);
  b11 = b10 + PASSED(32);
  b12 = b11 + PASSED(44);
  b13 = b12 + PASSED(56);
  b14 = b13 + PASSED(68);
  b15 = w[848] * b4 - w[849] * b9 + w[850] * b14;
  b16 = b15 + (w[851] * b3 - w[852] * b8 + w[853] * b13);
  b17 = b16 + (w[854] * b2 - w[855] * b7 + w[856] * b12);
  b18 = b17 + (w[857] * b1 - w[858] * b6 + w[859] * b11);
  b19 = b18 + (w[860] * b0 - w[861] * b5 + w[862] * b10);
  STORE(passed + 244, b19 + (w[863] * PASSED(4) - w[864] * PASSED(0) + w[865] * PASSED(8)));
  b20 = w[866] * b4 - w[867] * b9 + w[868] * b14;
  b21 = b20 + (w[869] * b3 - w[870] * b8 + w[871] * b13);
  b22 = b21 + (w[872] * b2 - w[873] * b7 + w[874] * b12);
  b23 = b22 + (w[875] * b1 - w[876] * b6 + w[877] * b11);
  b24 = b23 + (w[878] * b0 - w[879] * b5 + w[880] * b10);
  STORE(passed + 248, b24 + (w[881] * PASSED(4) - w[882] * PASSED(0) + w[883] * PASSED(8)));
  b14 = w[884] * b4 - w[885] * b9 + w[886] * b14;
  b9 = b14 + (w[887] * b3 - w[888] * b8 + w[889] * b13);
  b4 = b9 + (w[890] * b2 - w[891] * b7 + w[892] * b12);
  b25 = b4 + (w[893] * b1 - w[894] * b6 + w[895] * b11);
  b26 = b25 + (w[896] * b0 - w[897] * b5 + w[898] * b10);
  STORE(passed + 252, b26 + (w[899] * PASSED(4) - w[900] * PASSED(0) + w[901] * PASSED(8)));
  MADE(nitinol_wire_kernels_pulled_of_column)(w + 270, w + 342, w + 378, turns + 0, passed + 0, passed + 244, passed + 72);
  STORE(passed + 256, b19 - (w[263] * PASSED(4) + w[256] * PASSED(8)));
  STORE(passed + 260, w[263] * PASSED(0) - w[243] * PASSED(8) + b24);
  STORE(passed + 264, w[256] * PASSED(0) + w[243] * PASSED(4) + b26);
  MADE(nitinol_wire_kernels_pulled_of_column)(w + 271, w + 343, w + 379, turns + 4, passed + 12, passed + 256, passed + 96);
  STORE(passed + 268, b18 - (w[262] * b0 + w[254] * b10));
  STORE(passed + 272, w[262] * b5 - w[240] * b10 + b23);
  STORE(passed + 276, w[254] * b5 + w[240] * b0 + b25);
  MADE(nitinol_wire_kernels_pulled_of_column)(w + 272, w + 344, w + 380, turns + 8, passed + 24, passed + 268, passed + 120);
  STORE(passed + 280, b17 - (w[261] * b1 + w[252] * b11));
  STORE(passed + 284, w[261] * b6 - w[237] * b11 + b22);
  STORE(passed + 288, w[252] * b6 + w[237] * b1 + b4);
  MADE(nitinol_wire_kernels_pulled_of_column)(w + 273, w + 345, w + 381, turns + 12, passed + 36, passed + 280, passed + 144);
  STORE(passed + 292, b16 - (w[260] * b2 + w[250] * b12));
  STORE(passed + 296, w[260] * b7 - w[234] * b12 + b21);
  STORE(passed + 300, w[250] * b7 + w[234] * b2 + b9);
  MADE(nitinol_wire_kernels_pulled_of_column)(w + 426, w + 498, w + 534, turns + 16, passed + 48, passed + 292, passed + 168);
  STORE(passed + 304, b15 - (w[259] * b3 + w[248] * b13));
  STORE(passed + 308, w[259] * b8 - w[231] * b13 + b20);
  STORE(passed + 312, w[248] * b8 + w[231] * b3 + b14);
  MADE(nitinol_wire_kernels_pulled_of_column)(w + 427, w + 499, w + 535, turns + 20, passed + 60, passed + 304, passed + 192);
  MADE(nitinol_wire_kernels_fold_of_column)(nitinol_wire_kernels_table_0, passed + 72, passed + 216);
  MADE(nitinol_wire_kernels_fold_of_column)(nitinol_wire_kernels_table_0, passed + 76, passed + 228);
  MADE(nitinol_wire_kernels_fold_6_of_column)(nitinol_wire_kernels_table_1, passed + 80, passed + 240);
  STORE(columns + 0, EACH(C[20]) * PASSED(216));
  STORE(columns + 8, EACH(C[20]) * PASSED(220));
  STORE(columns + 16, EACH(C[20]) * PASSED(224));
  STORE(columns + 24, EACH(C[20]) * PASSED(228));
  STORE(columns + 32, EACH(C[20]) * PASSED(232));
  STORE(columns + 40, EACH(C[20]) * PASSED(236));
  STORE(columns + 48, EACH(C[20]) * PASSED(240));
}

static void MADE(nitinol_wire_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 120, columns += 4) {
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(nitinol_wire_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  MADE(nitinol_wire_kernels_turned_of_column)(w + 229, turns + 0, passed + 0);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 230, turns + 4, passed + 12);
  b0 = PASSED(4) + PASSED(16);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 231, turns + 8, passed + 24);
  b1 = b0 + PASSED(28);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 232, turns + 12, passed + 36);
  b2 = b1 + PASSED(40);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 301, turns + 16, passed + 48);
  b3 = b2 + PASSED(52);
  MADE(nitinol_wire_kernels_turned_of_column)(w + 302, turns + 20, passed + 60);
  b4 = b3 + PASSED(64);
  b5 = w[621] * PASSED(8);
  b6 = PASSED(8) + PASSED(20);
  b7 = w[622] * b6;
  b8 = b6 + PASSED(32);
  b7 = w[540] * PASSED(4) + w[556] * b0 + w[572] * b1 + w[588] * b2 + w[604] * b3 + w[620] * b4 - b5 - b7;
  b5 = b8 + PASSED(44);
  b9 = b5 + PASSED(56);
  b10 = b9 + PASSED(68);
  b7 = b7 - w[623] * b8 - w[624] * b5 - w[625] * b9 - w[626] * b10;
  b11 = PASSED(0) + PASSED(12);
  b12 = b11 + PASSED(24);
  b13 = b12 + PASSED(36);
  b14 = b13 + PASSED(48);
  b15 = b14 + PASSED(60);
  b16 = w[627] * PASSED(4);
  b0 = w[628] * b0;
  b0 = w[621] * PASSED(0) + w[622] * b11 + w[623] * b12 + w[624] * b13 + w[625] * b14 + w[626] * b15 - b16 - b0;
  b3 = b0 - w[629] * b1 - w[630] * b2 - w[631] * b3 - w[632] * b4;
  b14 = w[540] * PASSED(0) + w[556] * b11 + w[572] * b12 + w[588] * b13 + w[604] * b14 + w[620] * b15;
  b13 = (b15 * w[163] + b4 * w[160] + b10 * w[161]) / EACH(2.0);
  b12 = (b4 * w[162] - b15 * w[161] + b10 * w[163]) / EACH(2.0);
  b11 = (b15 * w[162] + b4 * w[161] - b10 * w[160]) / EACH(2.0);
  b4 = (b15 * w[160] - b4 * w[163] + b10 * w[162]) / EACH(2.0);
  STORE(columns + 0, EACH(C[21]) * b7 + b3);
  b10 = w[627] * PASSED(8) - b14 + w[628] * b6 + w[629] * b8 + w[630] * b5 + w[631] * b9 + w[632] * b10;
  STORE(columns + 8, b10);
  STORE(columns + 16, EACH(C[21]) * b3 - b7);
  STORE(columns + 24, EACH((-1.0)) * (EACH(C[22]) * b13 + EACH(C[23]) * b12));
  STORE(columns + 32, EACH(C[22]) * b11 + EACH(C[23]) * b4);
  STORE(columns + 40, EACH(C[22]) * b12 - EACH(C[23]) * b13);
  STORE(columns + 48, EACH(C[22]) * b4 - EACH(C[23]) * b11);
}

static void MADE(nitinol_wire_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 120, columns += 4) {
    EVERY_LANE(MADE(nitinol_wire_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
