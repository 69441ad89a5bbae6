/* Included once for each width of vectors. */
static void MADE(follower_reissner_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 20, made += 36)
    EVERY_LANE(MADE(follower_reissner_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 88, made += 24)
    EVERY_LANE(MADE(follower_reissner_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 88, made += 156)
    EVERY_LANE(MADE(follower_reissner_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_turned_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2;
  b0 = p0[48] * LOAD(p1 + 80);
  b1 = p0[52] * LOAD(p1 + 80);
  b2 = p0[56] * LOAD(p1 + 80);
  b0 = p0[0] * LOAD(p1 + 0) + p0[12] * LOAD(p1 + 20) + p0[24] * LOAD(p1 + 40) + p0[36] * LOAD(p1 + 60) + b0;
  STORE(made + 0, b0);
  b1 = p0[4] * LOAD(p1 + 0) + p0[16] * LOAD(p1 + 20) + p0[28] * LOAD(p1 + 40) + p0[40] * LOAD(p1 + 60) + b1;
  STORE(made + 4, b1);
  b2 = p0[8] * LOAD(p1 + 0) + p0[20] * LOAD(p1 + 20) + p0[32] * LOAD(p1 + 40) + p0[44] * LOAD(p1 + 60) + b2;
  STORE(made + 8, b2);
}

static void MADE(follower_reissner_kernels_pulled_of_column)(const casadi_real *p0, const casadi_real *p1, const casadi_real *p2, const casadi_real *p3, const casadi_real *p4, const casadi_real *p5, casadi_real *made) {
  FOUR b0, b1, b2, b3;
  b0 = LOAD(p5 + 0) + (p1[0] * LOAD(p4 + 0) + p1[12] * LOAD(p4 + 4) + p1[24] * LOAD(p4 + 8));
  b1 = LOAD(p5 + 4) + (p1[4] * LOAD(p4 + 0) + p1[16] * LOAD(p4 + 4) + p1[28] * LOAD(p4 + 8));
  b2 = LOAD(p5 + 8) + (p1[8] * LOAD(p4 + 0) + p1[20] * LOAD(p4 + 4) + p1[32] * LOAD(p4 + 8));
  STORE(made + 0, p0[0] * b0 + p0[4] * b1 + p0[8] * b2 + p2[32] * LOAD(p3 + 80));
  STORE(made + 4, p0[12] * b0 + p0[16] * b1 + p0[20] * b2 + p2[24] * LOAD(p3 + 60));
  b3 = p0[24] * b0 + p0[28] * b1 + p0[32] * b2 + (p2[28] * LOAD(p3 + 60) + p2[36] * LOAD(p3 + 80));
  STORE(made + 8, b3);
  b3 = p0[36] * b0 + p0[40] * b1 + p0[44] * b2 + (p2[8] * LOAD(p3 + 20) + p2[16] * LOAD(p3 + 40));
  STORE(made + 12, b3);
  b3 = p0[48] * b0 + p0[52] * b1 + p0[56] * b2 + (p2[0] * LOAD(p3 + 0) + p2[20] * LOAD(p3 + 40));
  STORE(made + 16, b3);
  b2 = p0[60] * b0 + p0[64] * b1 + p0[68] * b2 + (p2[4] * LOAD(p3 + 0) + p2[12] * LOAD(p3 + 20));
  STORE(made + 20, b2);
}

static void MADE(follower_reissner_kernels_fold_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5;
  b0 = LOAD(p1 + 0) + LOAD(p1 + 96);
  b1 = LOAD(p1 + 0) - LOAD(p1 + 96);
  b2 = LOAD(p1 + 24) - LOAD(p1 + 72);
  b3 = LOAD(p1 + 12) + LOAD(p1 + 108);
  b4 = LOAD(p1 + 36) + LOAD(p1 + 84);
  b5 = LOAD(p1 + 48) * p0[11];
  STORE(made + 0, b0 * p0[0] + (LOAD(p1 + 24) + LOAD(p1 + 72)) * p0[1] + LOAD(p1 + 48) * p0[2]);
  STORE(made + 4, b1 * p0[3] + b2 * p0[4] + b3 * p0[5] + b4 * p0[6] + LOAD(p1 + 60) * p0[7]);
  b5 = b0 * p0[8] + (LOAD(p1 + 12) - LOAD(p1 + 108)) * p0[9] + (LOAD(p1 + 36) - LOAD(p1 + 84)) * p0[10] + b5;
  STORE(made + 8, b5);
  STORE(made + 12, b1 * p0[12] + b2 * p0[13] + b3 * p0[14] + b4 * p0[15] + LOAD(p1 + 60) * p0[16]);
}

static void MADE(follower_reissner_kernels_fold_6_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0;
  b0 = (LOAD(p1 + 0) + LOAD(p1 + 96)) * p0[0] + (LOAD(p1 + 24) + LOAD(p1 + 72)) * p0[1] + LOAD(p1 + 48) * p0[2];
  STORE(made + 0, b0);
}

static void MADE(follower_reissner_kernels_increments_11_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_increments_11)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(follower_reissner_kernels_increments_11_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_pulls_12_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_pulls_12)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(follower_reissner_kernels_pulls_12_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 76, made += 72)
    EVERY_LANE(MADE(follower_reissner_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26;
  MADE(follower_reissner_kernels_turned_of_column)(w + 263, turns + 0, passed + 0);
  MADE(follower_reissner_kernels_turned_of_column)(w + 264, turns + 4, passed + 12);
  STORE(passed + 304, b0 = PASSED(4) + PASSED(16));
  MADE(follower_reissner_kernels_turned_of_column)(w + 265, turns + 8, passed + 24);
  STORE(passed + 316, b1 = b0 + PASSED(28));
  MADE(follower_reissner_kernels_turned_of_column)(w + 266, turns + 12, passed + 36);
  STORE(passed + 292, b2 = b1 + PASSED(40));
  MADE(follower_reissner_kernels_turned_of_column)(w + 419, turns + 16, passed + 48);
  STORE(passed + 280, b3 = b2 + PASSED(52));
  STORE(passed + 300, b4 = PASSED(0) + PASSED(12));
  STORE(passed + 312, b5 = b4 + PASSED(24));
  STORE(passed + 288, b6 = b5 + PASSED(36));
  STORE(passed + 276, b7 = b6 + PASSED(48));
  STORE(passed + 308, b8 = PASSED(8) + PASSED(20));
  STORE(passed + 320, b9 = b8 + PASSED(32));
  STORE(passed + 296, b10 = b9 + PASSED(44));
  STORE(passed + 284, b11 = b10 + PASSED(56));
  b12 = w[233] * b7 - w[247] * b11;
  STORE(passed + 328, b13 = EACH(C[19]) * b12);
  b14 = w[247] * b3 - w[235] * b7;
  STORE(passed + 332, b15 = EACH(C[19]) * b14);
  b16 = w[826] * b3 - w[827] * b7 + w[828] * b11 + (w[169] * b13 - w[165] * b15) - (w[249] * b11 - w[257] * b3);
  STORE(passed + 340, b17 = EACH(C[20]) * b12);
  STORE(passed + 344, b18 = EACH(C[20]) * b14);
  b19 = b16 + (w[836] * b2 - w[837] * b6 + w[838] * b10 + (w[180] * b17 - w[176] * b18));
  STORE(passed + 352, b12 = EACH(C[21]) * b12);
  STORE(passed + 356, b14 = EACH(C[21]) * b14);
  b20 = b19 + (w[841] * b1 - w[842] * b5 + w[843] * b9 + (w[188] * b12 - w[184] * b14));
  b21 = b20 + (w[846] * b0 - w[847] * b4 + w[848] * b8 + (w[196] * b12 - w[192] * b14));
  b22 = b21 + (w[851] * PASSED(4) - w[852] * PASSED(0) + w[853] * PASSED(8) + (w[204] * b17 - w[200] * b18));
  STORE(passed + 216, b22);
  b22 = w[235] * b11 - w[233] * b3;
  STORE(passed + 324, b23 = EACH(C[19]) * b22);
  b15 = w[856] * b7 - w[857] * b3 + w[858] * b11 + (w[205] * b15 - w[169] * b23) - (w[257] * b7 - w[237] * b11);
  STORE(passed + 336, b24 = EACH(C[20]) * b22);
  b25 = b15 + (w[861] * b6 - w[862] * b2 + w[863] * b10 + (w[209] * b18 - w[180] * b24));
  STORE(passed + 348, b22 = EACH(C[21]) * b22);
  b26 = b25 + (w[865] * b5 - w[866] * b1 + w[867] * b9 + (w[213] * b14 - w[188] * b22));
  b14 = b26 + (w[869] * b4 - w[870] * b0 + w[871] * b8 + (w[217] * b14 - w[196] * b22));
  b18 = b14 + (w[873] * PASSED(0) - w[874] * PASSED(4) + w[875] * PASSED(8) + (w[221] * b18 - w[204] * b24));
  STORE(passed + 220, b18);
  b13 = w[877] * b7 + w[878] * b3 - w[879] * b11 + (w[165] * b23 - w[205] * b13) - (w[237] * b3 - w[249] * b7);
  b23 = b13 + (w[880] * b6 + w[881] * b2 - w[882] * b10 + (w[176] * b24 - w[209] * b17));
  b11 = b23 + (w[883] * b5 + w[884] * b1 - w[885] * b9 + (w[184] * b22 - w[213] * b12));
  b12 = b11 + (w[886] * b4 + w[887] * b0 - w[888] * b8 + (w[192] * b22 - w[217] * b12));
  b17 = b12 + (w[889] * PASSED(0) + w[890] * PASSED(4) - w[891] * PASSED(8) + (w[200] * b24 - w[221] * b17));
  STORE(passed + 224, b17);
  MADE(follower_reissner_kernels_pulled_of_column)(w + 263, w + 335, w + 371, turns + 0, passed + 0, passed + 216, passed + 60);
  STORE(passed + 228, w[255] * PASSED(8) - w[261] * PASSED(4) + b21);
  STORE(passed + 232, w[261] * PASSED(0) - w[245] * PASSED(8) + b14);
  STORE(passed + 236, w[245] * PASSED(4) - w[255] * PASSED(0) + b12);
  MADE(follower_reissner_kernels_pulled_of_column)(w + 264, w + 336, w + 372, turns + 4, passed + 12, passed + 228, passed + 84);
  STORE(passed + 240, w[254] * b8 - w[260] * b0 + b20);
  STORE(passed + 244, w[260] * b4 - w[244] * b8 + b26);
  STORE(passed + 248, w[244] * b0 - w[254] * b4 + b11);
  MADE(follower_reissner_kernels_pulled_of_column)(w + 265, w + 337, w + 373, turns + 8, passed + 24, passed + 240, passed + 108);
  STORE(passed + 252, w[252] * b9 - w[259] * b1 + b19);
  STORE(passed + 256, w[259] * b5 - w[241] * b9 + b25);
  STORE(passed + 260, w[241] * b1 - w[252] * b5 + b23);
  MADE(follower_reissner_kernels_pulled_of_column)(w + 266, w + 338, w + 374, turns + 12, passed + 36, passed + 252, passed + 132);
  STORE(passed + 264, w[250] * b10 - w[258] * b2 + b16);
  STORE(passed + 268, w[258] * b6 - w[238] * b10 + b15);
  STORE(passed + 272, w[238] * b2 - w[250] * b6 + b13);
}

static void MADE(follower_reissner_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  MADE(follower_reissner_kernels_pulled_of_column)(w + 419, w + 491, w + 527, turns + 16, passed + 48, passed + 264, passed + 156);
  MADE(follower_reissner_kernels_fold_of_column)(follower_reissner_kernels_table_0, passed + 60, passed + 180);
  MADE(follower_reissner_kernels_fold_of_column)(follower_reissner_kernels_table_0, passed + 64, passed + 196);
  MADE(follower_reissner_kernels_fold_6_of_column)(follower_reissner_kernels_table_1, passed + 68, passed + 212);
  b0 = w[1014] * PASSED(276) + w[1015] * PASSED(280) + w[1016] * PASSED(284);
  b1 = w[1017] * PASSED(0) + w[1018] * PASSED(4) + w[1019] * PASSED(8);
  b2 = w[1020] * PASSED(288) + w[1021] * PASSED(292) + w[1022] * PASSED(296);
  b3 = w[1023] * PASSED(300) + w[1024] * PASSED(304) + w[1025] * PASSED(308);
  b4 = w[1026] * PASSED(312) + w[1027] * PASSED(316) + w[1028] * PASSED(320);
  b5 = w[1035] * PASSED(288) + w[1036] * PASSED(292) + w[1037] * PASSED(296);
  b5 = EACH(C[22]) * (w[1032] * PASSED(0) + w[1033] * PASSED(4) + w[1034] * PASSED(8) + b5);
  b6 = w[1041] * PASSED(312) + w[1042] * PASSED(316) + w[1043] * PASSED(320);
  b6 = EACH(C[22]) * (w[1038] * PASSED(300) + w[1039] * PASSED(304) + w[1040] * PASSED(308) + b6);
  b7 = w[1050] * PASSED(288) + w[1051] * PASSED(292) + w[1052] * PASSED(296);
  b7 = EACH(C[23]) * (w[1047] * PASSED(0) + w[1048] * PASSED(4) + w[1049] * PASSED(8) + b7);
  b8 = w[1056] * PASSED(312) + w[1057] * PASSED(316) + w[1058] * PASSED(320);
  b8 = EACH(C[23]) * (w[1053] * PASSED(300) + w[1054] * PASSED(304) + w[1055] * PASSED(308) + b8);
  b9 = w[170] * PASSED(324) + w[157] * PASSED(328) + w[166] * PASSED(332);
  b10 = w[218] * PASSED(336) + w[197] * PASSED(340) + w[201] * PASSED(344);
  b11 = w[206] * PASSED(336) + w[173] * PASSED(340) + w[177] * PASSED(344);
  b12 = w[214] * PASSED(348) + w[189] * PASSED(352) + w[193] * PASSED(356);
  b13 = w[210] * PASSED(348) + w[181] * PASSED(352) + w[185] * PASSED(356);
  b14 = w[207] * PASSED(336) + w[174] * PASSED(340) + w[178] * PASSED(344);
  b14 = EACH(C[22]) * (w[219] * PASSED(336) + w[198] * PASSED(340) + w[202] * PASSED(344) + b14);
  b15 = w[211] * PASSED(348) + w[182] * PASSED(352) + w[186] * PASSED(356);
  b15 = EACH(C[22]) * (w[215] * PASSED(348) + w[190] * PASSED(352) + w[194] * PASSED(356) + b15);
  b15 = EACH(C[22]) * (PASSED(328) + (w[171] * PASSED(324) + w[160] * PASSED(328) + w[167] * PASSED(332))) + b14 + b15;
  b14 = w[208] * PASSED(336) + w[175] * PASSED(340) + w[179] * PASSED(344);
  b14 = EACH(C[23]) * (w[220] * PASSED(336) + w[199] * PASSED(340) + w[203] * PASSED(344) + b14);
  b16 = w[212] * PASSED(348) + w[183] * PASSED(352) + w[187] * PASSED(356);
  b16 = EACH(C[23]) * (w[216] * PASSED(348) + w[191] * PASSED(352) + w[195] * PASSED(356) + b16);
  b16 = EACH(C[23]) * (PASSED(332) + (w[172] * PASSED(324) + w[162] * PASSED(328) + w[168] * PASSED(332))) + b14 + b16;
  STORE(columns + 0, EACH(C[24]) * PASSED(180));
  STORE(columns + 12, EACH(C[24]) * PASSED(184));
  STORE(columns + 24, EACH(C[24]) * PASSED(188));
  STORE(columns + 36, EACH(C[24]) * PASSED(192));
  STORE(columns + 48, EACH(C[24]) * PASSED(196));
  STORE(columns + 60, EACH(C[24]) * PASSED(200));
  STORE(columns + 72, EACH(C[24]) * PASSED(204));
  STORE(columns + 84, EACH(C[24]) * PASSED(208));
  STORE(columns + 96, EACH(C[24]) * PASSED(212));
  STORE(columns + 108, EACH(C[22]) * b0 + EACH(C[22]) * (b1 + b2) + EACH(C[22]) * (b3 + b4));
  STORE(columns + 120, EACH(C[25]) * (b1 - b2) - EACH(C[26]) * b0 + EACH(C[27]) * (b3 - b4));
  b6 = EACH(C[22]) * (w[1029] * PASSED(276) + w[1030] * PASSED(280) + w[1031] * PASSED(284)) + b5 + b6;
  STORE(columns + 132, b6);
  b8 = EACH(C[23]) * (w[1044] * PASSED(276) + w[1045] * PASSED(280) + w[1046] * PASSED(284)) + b7 + b8;
  STORE(columns + 144, b8);
  b8 = EACH((-1.0)) * (EACH(C[22]) * (PASSED(324) + b9) + EACH(C[22]) * (b10 + b11) + EACH(C[22]) * (b12 + b13));
  STORE(columns + 156, b8);
  STORE(columns + 168, EACH(C[26]) * (b9 - PASSED(324)) + EACH(C[25]) * (b11 - b10) + EACH(C[27]) * (b13 - b12));
  STORE(columns + 180, EACH((-1.0)) * b15);
  STORE(columns + 192, EACH((-1.0)) * b16);
}

static void MADE(follower_reissner_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 100, columns += 4) {
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(follower_reissner_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12;
  MADE(follower_reissner_kernels_turned_of_column)(w + 233, turns + 0, passed + 0);
  MADE(follower_reissner_kernels_turned_of_column)(w + 234, turns + 4, passed + 12);
  b0 = PASSED(4) + PASSED(16);
  MADE(follower_reissner_kernels_turned_of_column)(w + 235, turns + 8, passed + 24);
  b1 = b0 + PASSED(28);
  MADE(follower_reissner_kernels_turned_of_column)(w + 236, turns + 12, passed + 36);
  b2 = b1 + PASSED(40);
  MADE(follower_reissner_kernels_turned_of_column)(w + 305, turns + 16, passed + 48);
  b3 = b2 + PASSED(52);
  b4 = PASSED(8) + PASSED(20);
  b5 = w[610] * b4;
  b6 = b4 + PASSED(32);
  b5 = w[544] * PASSED(4) + w[560] * b0 + w[576] * b1 + w[592] * b2 + w[608] * b3 - w[609] * PASSED(8) - b5;
  b7 = b6 + PASSED(44);
  b8 = b7 + PASSED(56);
  b9 = PASSED(0) + PASSED(12);
  b10 = b9 + PASSED(24);
  b11 = b10 + PASSED(36);
  b12 = b11 + PASSED(48);
  b4 = w[615] * b4;
  b4 = w[614] * PASSED(8) - (w[544] * PASSED(0) + w[560] * b9 + w[576] * b10 + w[592] * b11 + w[608] * b12) + b4;
  b0 = w[615] * b0;
  b0 = w[609] * PASSED(0) + w[610] * b9 + w[611] * b10 + w[612] * b11 + w[613] * b12 - w[614] * PASSED(4) - b0;
  STORE(columns + 0, b5 - w[611] * b6 - w[612] * b7 - w[613] * b8);
  STORE(columns + 12, b4 + w[616] * b6 + w[617] * b7 + w[618] * b8);
  STORE(columns + 24, b0 - w[616] * b1 - w[617] * b2 - w[618] * b3);
  STORE(columns + 36, EACH((-1.0)) * ((b12 * w[153] + b3 * w[154] + b8 * w[156]) / EACH(2.0)));
  STORE(columns + 48, (b12 * w[155] + b3 * w[156] - b8 * w[154]) / EACH(2.0));
  STORE(columns + 60, (b3 * w[155] - b12 * w[156] + b8 * w[153]) / EACH(2.0));
  STORE(columns + 72, (b12 * w[154] - b3 * w[153] + b8 * w[155]) / EACH(2.0));
}

static void MADE(follower_reissner_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 100, columns += 4) {
    EVERY_LANE(MADE(follower_reissner_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
