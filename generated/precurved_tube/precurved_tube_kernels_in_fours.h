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

static void MADE(precurved_tube_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17;
  b0 = GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84) + GIVEN(76) * GIVEN(88);
  b1 = GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84) + GIVEN(52) * GIVEN(88);
  b2 = GIVEN(32) * b1 - GIVEN(24) * b0;
  b3 = GIVEN(36) * GIVEN(36) / EACH(2.0);
  b4 = GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84) + GIVEN(64) * GIVEN(88);
  b5 = GIVEN(40) * b2 - b3 * b4;
  b6 = GIVEN(28) * b0 - GIVEN(32) * b4;
  b7 = GIVEN(40) * b6 - b3 * b1;
  b8 = EACH(C[18]) * (b0 + (GIVEN(24) * b5 - GIVEN(28) * b7));
  b9 = GIVEN(88) * GIVEN(168) + GIVEN(76) * GIVEN(180);
  b9 = GIVEN(80) * GIVEN(160) + GIVEN(68) * GIVEN(172) + (GIVEN(84) * GIVEN(164) + GIVEN(72) * GIVEN(176)) + b9;
  b10 = GIVEN(88) * GIVEN(144) + GIVEN(52) * GIVEN(180);
  b10 = GIVEN(80) * GIVEN(136) + GIVEN(44) * GIVEN(172) + (GIVEN(84) * GIVEN(140) + GIVEN(48) * GIVEN(176)) + b10;
  b11 = EACH(0.5) * (EACH(2.0) * GIVEN(36) * GIVEN(128));
  b12 = GIVEN(88) * GIVEN(156) + GIVEN(64) * GIVEN(180);
  b12 = GIVEN(80) * GIVEN(148) + GIVEN(56) * GIVEN(172) + (GIVEN(84) * GIVEN(152) + GIVEN(60) * GIVEN(176)) + b12;
  b2 = b2 * GIVEN(132) + GIVEN(40) * (b1 * GIVEN(124) + GIVEN(32) * b10 - (b0 * GIVEN(116) + GIVEN(24) * b9));
  b2 = b2 - (b4 * b11 + b3 * b12);
  b6 = b6 * GIVEN(132) + GIVEN(40) * (b0 * GIVEN(120) + GIVEN(28) * b9 - (b4 * GIVEN(124) + GIVEN(32) * b12));
  b6 = b6 - (b1 * b11 + b3 * b10);
  b13 = b9 + (b5 * GIVEN(116) + GIVEN(24) * b2 - (b7 * GIVEN(120) + GIVEN(28) * b6));
  b14 = EACH(C[18]) * b13;
  b15 = GIVEN(24) * b4 - GIVEN(28) * b1;
  b16 = GIVEN(40) * b15 - b3 * b0;
  b17 = EACH(C[18]) * (b4 + (GIVEN(32) * b7 - GIVEN(24) * b16));
  b4 = b15 * GIVEN(132) + GIVEN(40) * (b4 * GIVEN(116) + GIVEN(24) * b12 - (b1 * GIVEN(120) + GIVEN(28) * b10));
  b9 = b4 - (b0 * b11 + b3 * b9);
  b6 = b12 + (b7 * GIVEN(124) + GIVEN(32) * b6 - (b16 * GIVEN(116) + GIVEN(24) * b9));
  b7 = EACH(C[18]) * b6;
  b2 = b10 + (b16 * GIVEN(120) + GIVEN(28) * b9 - (b5 * GIVEN(124) + GIVEN(32) * b2));
  b5 = EACH(C[18]) * (b1 + (GIVEN(28) * b16 - GIVEN(32) * b5));
  b16 = EACH(C[18]) * b2;
  STORE(made + 0, b8 * GIVEN(108) + GIVEN(16) * b14 - (b17 * GIVEN(112) + GIVEN(20) * b7) + b2);
  STORE(made + 4, b6 - (b8 * GIVEN(104) + GIVEN(12) * b14) + (b5 * GIVEN(112) + GIVEN(20) * b16));
  STORE(made + 8, b13 + (b17 * GIVEN(104) + GIVEN(12) * b7) - (b5 * GIVEN(108) + GIVEN(16) * b16));
  STORE(made + 12, b17 * GIVEN(100) + GIVEN(8) * b7 - (b8 * GIVEN(96) + GIVEN(4) * b14));
  STORE(made + 16, b8 * GIVEN(92) + GIVEN(0) * b14 - (b5 * GIVEN(100) + GIVEN(8) * b16));
  STORE(made + 20, b5 * GIVEN(96) + GIVEN(4) * b16 - (b17 * GIVEN(92) + GIVEN(0) * b7));
}

static void MADE(precurved_tube_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(precurved_tube_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_increments_4_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(precurved_tube_kernels_increments_4)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 36, made += 36)
    EVERY_LANE(MADE(precurved_tube_kernels_increments_4_turn)(given + lane, made + lane))
}

static void MADE(precurved_tube_kernels_pulls_5_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(precurved_tube_kernels_pulls_5)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 104, made += 36)
    EVERY_LANE(MADE(precurved_tube_kernels_pulls_5_turn)(given + lane, made + lane))
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
  FOUR b0, b1, b2;
  b0 = w[352] * TURN(140);
  STORE(passed + 68, b0 = w[292] * TURN(0) + w[304] * TURN(28) + w[316] * TURN(56) + w[328] * TURN(84) + w[340] * TURN(112) + b0);
  b1 = w[353] * TURN(144);
  STORE(passed + 104, b1 = w[293] * TURN(4) + w[305] * TURN(32) + w[317] * TURN(60) + w[329] * TURN(88) + w[341] * TURN(116) + b1);
  STORE(passed + 56, b1 = b0 + b1);
  b0 = w[354] * TURN(148);
  STORE(passed + 128, b0 = w[294] * TURN(8) + w[306] * TURN(36) + w[318] * TURN(64) + w[330] * TURN(92) + w[342] * TURN(120) + b0);
  STORE(passed + 44, b0 = b1 + b0);
  b1 = w[355] * TURN(152);
  STORE(passed + 172, b1 = w[295] * TURN(12) + w[307] * TURN(40) + w[319] * TURN(68) + w[331] * TURN(96) + w[343] * TURN(124) + b1);
  STORE(passed + 32, b1 = b0 + b1);
  b0 = w[508] * TURN(156);
  STORE(passed + 140, b0 = w[448] * TURN(16) + w[460] * TURN(44) + w[472] * TURN(72) + w[484] * TURN(100) + w[496] * TURN(128) + b0);
  STORE(passed + 20, b0 = b1 + b0);
  b1 = w[509] * TURN(160);
  STORE(passed + 116, b1 = w[449] * TURN(20) + w[461] * TURN(48) + w[473] * TURN(76) + w[485] * TURN(104) + w[497] * TURN(132) + b1);
  STORE(passed + 8, b1 = b0 + b1);
  b0 = w[510] * TURN(164);
  STORE(passed + 92, b0 = w[450] * TURN(24) + w[462] * TURN(52) + w[474] * TURN(80) + w[486] * TURN(108) + w[498] * TURN(136) + b0);
  STORE(passed + 84, b0 = b1 + b0);
  b1 = w[348] * TURN(140);
  STORE(passed + 72, b1 = w[288] * TURN(0) + w[300] * TURN(28) + w[312] * TURN(56) + w[324] * TURN(84) + w[336] * TURN(112) + b1);
  b2 = w[349] * TURN(144);
  STORE(passed + 100, b2 = w[289] * TURN(4) + w[301] * TURN(32) + w[313] * TURN(60) + w[325] * TURN(88) + w[337] * TURN(116) + b2);
  STORE(passed + 60, b2 = b1 + b2);
  b1 = w[350] * TURN(148);
  STORE(passed + 124, b1 = w[290] * TURN(8) + w[302] * TURN(36) + w[314] * TURN(64) + w[326] * TURN(92) + w[338] * TURN(120) + b1);
  STORE(passed + 48, b1 = b2 + b1);
  b2 = w[351] * TURN(152);
  STORE(passed + 168, b2 = w[291] * TURN(12) + w[303] * TURN(40) + w[315] * TURN(68) + w[327] * TURN(96) + w[339] * TURN(124) + b2);
  STORE(passed + 36, b2 = b1 + b2);
  b1 = w[504] * TURN(156);
  STORE(passed + 136, b1 = w[444] * TURN(16) + w[456] * TURN(44) + w[468] * TURN(72) + w[480] * TURN(100) + w[492] * TURN(128) + b1);
  STORE(passed + 24, b1 = b2 + b1);
  b2 = w[505] * TURN(160);
  STORE(passed + 112, b2 = w[445] * TURN(20) + w[457] * TURN(48) + w[469] * TURN(76) + w[481] * TURN(104) + w[493] * TURN(132) + b2);
  STORE(passed + 12, b2 = b1 + b2);
  b1 = w[506] * TURN(164);
  STORE(passed + 88, b1 = w[446] * TURN(24) + w[458] * TURN(52) + w[470] * TURN(80) + w[482] * TURN(108) + w[494] * TURN(136) + b1);
  STORE(passed + 80, b1 = b2 + b1);
  STORE(passed + 4, w[826] * b0 - w[869] * b1);
  b1 = w[356] * TURN(140);
  STORE(passed + 76, b1 = w[296] * TURN(0) + w[308] * TURN(28) + w[320] * TURN(56) + w[332] * TURN(84) + w[344] * TURN(112) + b1);
  b0 = w[357] * TURN(144);
  STORE(passed + 108, b0 = w[297] * TURN(4) + w[309] * TURN(32) + w[321] * TURN(60) + w[333] * TURN(88) + w[345] * TURN(116) + b0);
  STORE(passed + 64, b0 = b1 + b0);
  b1 = w[358] * TURN(148);
  STORE(passed + 132, b1 = w[298] * TURN(8) + w[310] * TURN(36) + w[322] * TURN(64) + w[334] * TURN(92) + w[346] * TURN(120) + b1);
  STORE(passed + 52, b1 = b0 + b1);
  b0 = w[359] * TURN(152);
  STORE(passed + 176, b0 = w[299] * TURN(12) + w[311] * TURN(40) + w[323] * TURN(68) + w[335] * TURN(96) + w[347] * TURN(124) + b0);
  STORE(passed + 40, b0 = b1 + b0);
  b1 = w[512] * TURN(156);
  STORE(passed + 144, b1 = w[452] * TURN(16) + w[464] * TURN(44) + w[476] * TURN(72) + w[488] * TURN(100) + w[500] * TURN(128) + b1);
  STORE(passed + 28, b1 = b0 + b1);
  b0 = w[513] * TURN(160);
  STORE(passed + 120, b0 = w[453] * TURN(20) + w[465] * TURN(48) + w[477] * TURN(76) + w[489] * TURN(104) + w[501] * TURN(132) + b0);
  STORE(passed + 16, b0 = b1 + b0);
  b1 = w[514] * TURN(164);
  STORE(passed + 96, b1 = w[454] * TURN(24) + w[466] * TURN(52) + w[478] * TURN(80) + w[490] * TURN(108) + w[502] * TURN(136) + b1);
  STORE(passed + 0, b0 + b1);
}

static void MADE(precurved_tube_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18;
  b0 = PASSED(4) + w[912] * PASSED(0);
  b1 = b0 + (w[913] * PASSED(8) - w[914] * PASSED(12) + w[915] * PASSED(16));
  b2 = b1 + (w[916] * PASSED(20) - w[917] * PASSED(24) + w[918] * PASSED(28));
  STORE(passed + 164, b3 = b2 + (w[919] * PASSED(32) - w[920] * PASSED(36) + w[921] * PASSED(40)));
  b3 = b3 + (w[922] * PASSED(44) - w[923] * PASSED(48) + w[924] * PASSED(52));
  b4 = b3 + (w[925] * PASSED(56) - w[926] * PASSED(60) + w[927] * PASSED(64));
  b5 = w[372] * PASSED(68);
  b6 = w[384] * PASSED(76);
  STORE(passed + 204, b6 = b4 + (w[928] * PASSED(68) - w[929] * PASSED(72) + w[930] * PASSED(76)) + w[360] * PASSED(72) + b5 + b6);
  b5 = w[934] * PASSED(80) - w[935] * PASSED(84) + w[936] * PASSED(0);
  b7 = b5 + (w[937] * PASSED(12) - w[938] * PASSED(8) + w[939] * PASSED(16));
  b8 = b7 + (w[940] * PASSED(24) - w[941] * PASSED(20) + w[942] * PASSED(28));
  STORE(passed + 180, b9 = b8 + (w[943] * PASSED(36) - w[944] * PASSED(32) + w[945] * PASSED(40)));
  b9 = b9 + (w[946] * PASSED(48) - w[947] * PASSED(44) + w[948] * PASSED(52));
  b10 = b9 + (w[949] * PASSED(60) - w[950] * PASSED(56) + w[951] * PASSED(64));
  b11 = w[376] * PASSED(68);
  b12 = w[388] * PASSED(76);
  STORE(passed + 208, b12 = b10 + (w[952] * PASSED(72) - w[953] * PASSED(68) + w[954] * PASSED(76)) + w[364] * PASSED(72) + b11 + b12);
  b11 = w[958] * PASSED(80) + w[959] * PASSED(84) - w[960] * PASSED(0);
  b13 = b11 + (w[961] * PASSED(12) + w[962] * PASSED(8) - w[963] * PASSED(16));
  b14 = b13 + (w[964] * PASSED(24) + w[965] * PASSED(20) - w[966] * PASSED(28));
  STORE(passed + 184, b15 = b14 + (w[967] * PASSED(36) + w[968] * PASSED(32) - w[969] * PASSED(40)));
  b15 = b15 + (w[970] * PASSED(48) + w[971] * PASSED(44) - w[972] * PASSED(52));
  b16 = b15 + (w[973] * PASSED(60) + w[974] * PASSED(56) - w[975] * PASSED(64));
  b17 = w[380] * PASSED(68);
  b18 = w[392] * PASSED(76);
  STORE(passed + 212, b18 = b16 + (w[976] * PASSED(72) + w[977] * PASSED(68) - w[978] * PASSED(76)) + w[368] * PASSED(72) + b17 + b18);
  STORE(passed + 188, b18 = w[288] * b6 + w[292] * b12 + w[296] * b18 + w[428] * TURN(112) + w[436] * TURN(140));
  b12 = w[542] * PASSED(96);
  STORE(passed + 216, b12 = w[271] * PASSED(16) - w[281] * PASSED(8) + b0 + w[518] * PASSED(88) + w[530] * PASSED(92) + b12);
  b0 = w[546] * PASSED(96);
  STORE(passed + 220, b0 = w[281] * PASSED(12) - w[257] * PASSED(16) + b5 + w[522] * PASSED(88) + w[534] * PASSED(92) + b0);
  b5 = w[550] * PASSED(96);
  STORE(passed + 224, b5 = w[257] * PASSED(8) - w[271] * PASSED(12) + b11 + w[526] * PASSED(88) + w[538] * PASSED(92) + b5);
  STORE(passed + 192, b5 = w[446] * b12 + w[450] * b0 + w[454] * b5 + w[586] * TURN(136) + w[594] * TURN(164));
  STORE(passed + 272, b5 = b18 + b5);
  b18 = w[385] * PASSED(108);
  STORE(passed + 228, b18 = w[279] * PASSED(76) - w[286] * PASSED(68) + b4 + w[361] * PASSED(100) + w[373] * PASSED(104) + b18);
  b4 = w[389] * PASSED(108);
  STORE(passed + 232, b4 = w[286] * PASSED(72) - w[268] * PASSED(76) + b10 + w[365] * PASSED(100) + w[377] * PASSED(104) + b4);
  b10 = w[393] * PASSED(108);
  STORE(passed + 236, b10 = w[268] * PASSED(68) - w[279] * PASSED(72) + b16 + w[369] * PASSED(100) + w[381] * PASSED(104) + b10);
  STORE(passed + 196, b10 = w[289] * b18 + w[293] * b4 + w[297] * b10 + w[429] * TURN(116) + w[437] * TURN(144));
  b4 = w[541] * PASSED(120);
  STORE(passed + 240, b4 = w[273] * PASSED(28) - w[282] * PASSED(20) + b1 + w[517] * PASSED(112) + w[529] * PASSED(116) + b4);
  b1 = w[545] * PASSED(120);
  STORE(passed + 244, b1 = w[282] * PASSED(24) - w[260] * PASSED(28) + b7 + w[521] * PASSED(112) + w[533] * PASSED(116) + b1);
  b7 = w[549] * PASSED(120);
  STORE(passed + 248, b7 = w[260] * PASSED(20) - w[273] * PASSED(24) + b13 + w[525] * PASSED(112) + w[537] * PASSED(116) + b7);
  STORE(passed + 200, b7 = w[445] * b4 + w[449] * b1 + w[453] * b7 + w[585] * TURN(132) + w[593] * TURN(160));
  STORE(passed + 276, b7 = b10 + b7);
  STORE(passed + 160, EACH(C[20]) * b5 + EACH(C[21]) * b7);
  b7 = w[386] * PASSED(132);
  STORE(passed + 252, b7 = w[278] * PASSED(64) - w[285] * PASSED(56) + b3 + w[362] * PASSED(124) + w[374] * PASSED(128) + b7);
  b3 = w[390] * PASSED(132);
  STORE(passed + 256, b3 = w[285] * PASSED(60) - w[267] * PASSED(64) + b9 + w[366] * PASSED(124) + w[378] * PASSED(128) + b3);
  b9 = w[394] * PASSED(132);
  STORE(passed + 260, b9 = w[267] * PASSED(56) - w[278] * PASSED(60) + b15 + w[370] * PASSED(124) + w[382] * PASSED(128) + b9);
  STORE(passed + 156, w[290] * b7 + w[294] * b3 + w[298] * b9 + w[430] * TURN(120) + w[438] * TURN(148));
  b9 = w[540] * PASSED(144);
  STORE(passed + 264, b9 = w[275] * PASSED(40) - w[283] * PASSED(32) + b2 + w[516] * PASSED(136) + w[528] * PASSED(140) + b9);
  b2 = w[544] * PASSED(144);
  STORE(passed + 268, b2 = w[283] * PASSED(36) - w[263] * PASSED(40) + b8 + w[520] * PASSED(136) + w[532] * PASSED(140) + b2);
  STORE(passed + 152, w[444] * b9 + w[448] * b2);
  b2 = w[548] * PASSED(144);
  b2 = w[263] * PASSED(32) - w[275] * PASSED(36) + b14 + w[524] * PASSED(136) + w[536] * PASSED(140) + b2;
  STORE(passed + 148, b2);
}

static void MADE(precurved_tube_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18;
  b0 = PASSED(152) + w[452] * PASSED(148) + w[584] * TURN(128) + w[592] * TURN(156);
  b1 = PASSED(156) + b0;
  b2 = w[387] * PASSED(176);
  STORE(passed + 288, b2 = w[277] * PASSED(52) - w[284] * PASSED(44) + PASSED(164) + w[363] * PASSED(168) + w[375] * PASSED(172) + b2);
  b3 = w[391] * PASSED(176);
  STORE(passed + 292, b3 = w[284] * PASSED(48) - w[266] * PASSED(52) + PASSED(180) + w[367] * PASSED(168) + w[379] * PASSED(172) + b3);
  b4 = w[395] * PASSED(176);
  STORE(passed + 296, b4 = w[266] * PASSED(44) - w[277] * PASSED(48) + PASSED(184) + w[371] * PASSED(168) + w[383] * PASSED(172) + b4);
  b5 = w[291] * b2 + w[295] * b3 + w[299] * b4 + w[431] * TURN(124) + w[439] * TURN(152);
  STORE(passed + 324, PASSED(160) + EACH(C[22]) * b1 + EACH(C[23]) * b5);
  b6 = PASSED(188) - PASSED(192);
  b7 = PASSED(196) - PASSED(200);
  b0 = PASSED(156) - b0;
  b8 = w[324] * PASSED(204) + w[328] * PASSED(208) + w[332] * PASSED(212) + w[404] * TURN(28) + w[412] * TURN(56);
  b9 = w[482] * PASSED(216) + w[486] * PASSED(220) + w[490] * PASSED(224) + w[562] * TURN(52) + w[570] * TURN(80);
  b10 = b8 + b9;
  b11 = w[325] * PASSED(228) + w[329] * PASSED(232) + w[333] * PASSED(236) + w[405] * TURN(32) + w[413] * TURN(60);
  b12 = w[481] * PASSED(240) + w[485] * PASSED(244) + w[489] * PASSED(248) + w[561] * TURN(48) + w[569] * TURN(76);
  b13 = b11 + b12;
  b14 = w[326] * PASSED(252) + w[330] * PASSED(256) + w[334] * PASSED(260) + w[406] * TURN(36) + w[414] * TURN(64);
  b15 = w[480] * PASSED(264) + w[484] * PASSED(268) + w[488] * PASSED(148) + w[560] * TURN(44) + w[568] * TURN(72);
  b16 = b14 + b15;
  b17 = w[327] * b2 + w[331] * b3 + w[335] * b4 + w[407] * TURN(40) + w[415] * TURN(68);
  b18 = EACH(C[24]) * b6 + EACH(C[25]) * b7 + EACH(C[26]) * b0 + EACH(C[27]) * b10 + EACH(C[28]) * b13 + EACH(C[29]) * b16 + EACH(C[30]) * b17;
  STORE(passed + 328, b18);
  b15 = EACH(C[31]) * (b14 - b15);
  b15 = EACH(C[32]) * PASSED(272) + EACH(C[33]) * PASSED(276) + EACH(C[34]) * b1 + EACH(C[35]) * (b8 - b9) + EACH(C[36]) * (b11 - b12) + b15;
  STORE(passed + 332, b15 + EACH(C[25]) * b5);
  b17 = EACH(C[37]) * b6 + EACH(C[38]) * b7 + EACH(C[39]) * b0 + EACH(C[40]) * b10 + EACH(C[41]) * b13 + EACH(C[42]) * b16 + EACH(C[43]) * b17;
  STORE(passed + 336, b17);
  b17 = w[300] * PASSED(204) + w[304] * PASSED(208) + w[308] * PASSED(212) + w[420] * TURN(84) + w[440] * TURN(140);
  b16 = w[458] * PASSED(216) + w[462] * PASSED(220) + w[466] * PASSED(224) + w[578] * TURN(108) + w[598] * TURN(164);
  STORE(passed + 300, b13 = b17 + b16);
  b10 = w[301] * PASSED(228) + w[305] * PASSED(232) + w[309] * PASSED(236) + w[421] * TURN(88) + w[441] * TURN(144);
  b0 = w[457] * PASSED(240) + w[461] * PASSED(244) + w[465] * PASSED(248) + w[577] * TURN(104) + w[597] * TURN(160);
  STORE(passed + 304, b7 = b10 + b0);
  b6 = w[302] * PASSED(252) + w[306] * PASSED(256) + w[310] * PASSED(260) + w[422] * TURN(92) + w[442] * TURN(148);
  b5 = w[456] * PASSED(264) + w[460] * PASSED(268) + w[464] * PASSED(148) + w[576] * TURN(100) + w[596] * TURN(156);
  STORE(passed + 308, b15 = b6 + b5);
  STORE(passed + 312, b4 = w[303] * b2 + w[307] * b3 + w[311] * b4 + w[423] * TURN(96) + w[443] * TURN(152));
  STORE(passed + 340, EACH(C[20]) * b13 + EACH(C[21]) * b7 + EACH(C[22]) * b15 + EACH(C[23]) * b4);
  STORE(passed + 316, b16 = b17 - b16);
  STORE(passed + 320, b0 = b10 - b0);
  STORE(passed + 284, EACH(C[24]) * b16 + EACH(C[25]) * b0);
  STORE(passed + 280, b6 - b5);
}

static void MADE(precurved_tube_k_jacobian_columns_3)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27;
  b0 = w[336] * PASSED(204) + w[340] * PASSED(208) + w[344] * PASSED(212) + w[396] * TURN(0) + w[416] * TURN(56);
  b1 = w[494] * PASSED(216) + w[498] * PASSED(220) + w[502] * PASSED(224) + w[554] * TURN(24) + w[574] * TURN(80);
  b2 = b0 + b1;
  b3 = w[337] * PASSED(228) + w[341] * PASSED(232) + w[345] * PASSED(236) + w[397] * TURN(4) + w[417] * TURN(60);
  b4 = w[493] * PASSED(240) + w[497] * PASSED(244) + w[501] * PASSED(248) + w[553] * TURN(20) + w[573] * TURN(76);
  b5 = b3 + b4;
  b6 = w[338] * PASSED(252) + w[342] * PASSED(256) + w[346] * PASSED(260) + w[398] * TURN(8) + w[418] * TURN(64);
  b7 = w[492] * PASSED(264) + w[496] * PASSED(268) + w[500] * PASSED(148) + w[552] * TURN(16) + w[572] * TURN(72);
  b8 = b6 + b7;
  b9 = w[339] * PASSED(288) + w[343] * PASSED(292) + w[347] * PASSED(296) + w[399] * TURN(12) + w[419] * TURN(68);
  b4 = EACH(C[36]) * (b3 - b4);
  b7 = EACH(C[31]) * (b6 - b7);
  b6 = EACH(C[25]) * PASSED(312);
  b3 = EACH(C[42]) * b8;
  b10 = EACH(C[43]) * b9;
  b11 = w[312] * PASSED(204) + w[316] * PASSED(208) + w[320] * PASSED(212) + w[424] * TURN(84) + w[432] * TURN(112);
  b12 = w[470] * PASSED(216) + w[474] * PASSED(220) + w[478] * PASSED(224) + w[582] * TURN(108) + w[590] * TURN(136);
  b13 = b11 + b12;
  b14 = w[313] * PASSED(228) + w[317] * PASSED(232) + w[321] * PASSED(236) + w[425] * TURN(88) + w[433] * TURN(116);
  b15 = w[469] * PASSED(240) + w[473] * PASSED(244) + w[477] * PASSED(248) + w[581] * TURN(104) + w[589] * TURN(132);
  b16 = b14 + b15;
  b17 = w[314] * PASSED(252) + w[318] * PASSED(256) + w[322] * PASSED(260) + w[426] * TURN(92) + w[434] * TURN(120);
  b18 = w[468] * PASSED(264) + w[472] * PASSED(268) + w[476] * PASSED(148) + w[580] * TURN(100) + w[588] * TURN(128);
  b19 = b17 + b18;
  b20 = w[315] * PASSED(288) + w[319] * PASSED(292) + w[323] * PASSED(296) + w[427] * TURN(96) + w[435] * TURN(124);
  b12 = b11 - b12;
  b15 = b14 - b15;
  b18 = b17 - b18;
  b17 = w[348] * PASSED(204) + w[352] * PASSED(208) + w[356] * PASSED(212) + w[400] * TURN(0) + w[408] * TURN(28);
  b14 = w[506] * PASSED(216) + w[510] * PASSED(220) + w[514] * PASSED(224) + w[558] * TURN(24) + w[566] * TURN(52);
  b11 = b17 + b14;
  b21 = w[349] * PASSED(228) + w[353] * PASSED(232) + w[357] * PASSED(236) + w[401] * TURN(4) + w[409] * TURN(32);
  b22 = w[505] * PASSED(240) + w[509] * PASSED(244) + w[513] * PASSED(248) + w[557] * TURN(20) + w[565] * TURN(48);
  b23 = b21 + b22;
  b24 = w[350] * PASSED(252) + w[354] * PASSED(256) + w[358] * PASSED(260) + w[402] * TURN(8) + w[410] * TURN(36);
  b25 = w[504] * PASSED(264) + w[508] * PASSED(268) + w[512] * PASSED(148) + w[556] * TURN(16) + w[564] * TURN(44);
  b26 = b24 + b25;
  b27 = w[351] * PASSED(288) + w[355] * PASSED(292) + w[359] * PASSED(296) + w[403] * TURN(12) + w[411] * TURN(40);
  b14 = b17 - b14;
  b22 = b21 - b22;
  b25 = b24 - b25;
  STORE(columns + 0, PASSED(324));
  STORE(columns + 16, PASSED(328));
  STORE(columns + 32, PASSED(332));
  STORE(columns + 48, PASSED(336));
  STORE(columns + 64, PASSED(340));
  b9 = PASSED(284) + EACH(C[26]) * PASSED(280) + EACH(C[27]) * b2 + EACH(C[28]) * b5 + EACH(C[29]) * b8 + EACH(C[30]) * b9;
  STORE(columns + 80, b9);
  b6 = EACH(C[32]) * PASSED(300) + EACH(C[33]) * PASSED(304) + EACH(C[34]) * PASSED(308) + EACH(C[35]) * (b0 - b1) + b4 + b7 + b6;
  STORE(columns + 96, b6);
  b10 = EACH(C[37]) * PASSED(316) + EACH(C[38]) * PASSED(320) + EACH(C[39]) * PASSED(280) + EACH(C[40]) * b2 + EACH(C[41]) * b5 + b3 + b10;
  STORE(columns + 112, b10);
  STORE(columns + 128, EACH(C[44]) * b13 + EACH(C[45]) * b16 + EACH(C[46]) * b19 + EACH(C[47]) * b20);
  b10 = EACH(C[48]) * b12 + EACH(C[49]) * b15 + EACH(C[50]) * b18 + EACH(C[51]) * b11 + EACH(C[52]) * b23 + EACH(C[53]) * b26 + EACH(C[54]) * b27;
  STORE(columns + 144, b10);
  b10 = EACH(C[55]) * b13 + EACH(C[56]) * b16 + EACH(C[57]) * b19 + EACH(C[58]) * b14 + EACH(C[59]) * b22 + EACH(C[60]) * b25 + EACH(C[49]) * b20;
  STORE(columns + 160, b10);
  b27 = EACH(C[61]) * b12 + EACH(C[62]) * b15 + EACH(C[63]) * b18 + EACH(C[64]) * b11 + EACH(C[65]) * b23 + EACH(C[66]) * b26 + EACH(C[67]) * b27;
  STORE(columns + 176, b27);
  b20 = EACH(C[68]) * b13 + EACH(C[69]) * b16 + EACH(C[70]) * b19 + EACH(C[71]) * b14 + EACH(C[72]) * b22 + EACH(C[73]) * b25 + EACH(C[74]) * b20;
  STORE(columns + 192, b20);
}

static void MADE(precurved_tube_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 168, columns += 4) {
    EVERY_LANE(MADE(precurved_tube_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(precurved_tube_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(precurved_tube_k_jacobian_columns_2)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(precurved_tube_k_jacobian_columns_3)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(precurved_tube_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9;
  b0 = w[319] * TURN(140);
  STORE(passed + 24, b0 = w[259] * TURN(0) + w[271] * TURN(28) + w[283] * TURN(56) + w[295] * TURN(84) + w[307] * TURN(112) + b0);
  b1 = w[320] * TURN(144);
  b1 = w[260] * TURN(4) + w[272] * TURN(32) + w[284] * TURN(60) + w[296] * TURN(88) + w[308] * TURN(116) + b1;
  STORE(passed + 28, b1 = b0 + b1);
  b2 = w[321] * TURN(148);
  b2 = w[261] * TURN(8) + w[273] * TURN(36) + w[285] * TURN(64) + w[297] * TURN(92) + w[309] * TURN(120) + b2;
  STORE(passed + 32, b2 = b1 + b2);
  b3 = w[322] * TURN(152);
  b3 = w[262] * TURN(12) + w[274] * TURN(40) + w[286] * TURN(68) + w[298] * TURN(96) + w[310] * TURN(124) + b3;
  STORE(passed + 36, b3 = b2 + b3);
  b4 = w[391] * TURN(156);
  b4 = w[331] * TURN(16) + w[343] * TURN(44) + w[355] * TURN(72) + w[367] * TURN(100) + w[379] * TURN(128) + b4;
  STORE(passed + 40, b4 = b3 + b4);
  b5 = w[392] * TURN(160);
  b5 = w[332] * TURN(20) + w[344] * TURN(48) + w[356] * TURN(76) + w[368] * TURN(104) + w[380] * TURN(132) + b5;
  STORE(passed + 44, b5 = b4 + b5);
  b6 = w[393] * TURN(164);
  b6 = w[333] * TURN(24) + w[345] * TURN(52) + w[357] * TURN(80) + w[369] * TURN(108) + w[381] * TURN(136) + b6;
  STORE(passed + 48, b6 = b5 + b6);
  b7 = w[323] * TURN(140);
  STORE(passed + 12, b7 = w[263] * TURN(0) + w[275] * TURN(28) + w[287] * TURN(56) + w[299] * TURN(84) + w[311] * TURN(112) + b7);
  b8 = w[614] * b7;
  b9 = w[324] * TURN(144);
  b9 = w[264] * TURN(4) + w[276] * TURN(32) + w[288] * TURN(60) + w[300] * TURN(88) + w[312] * TURN(116) + b9;
  STORE(passed + 16, b9 = b7 + b9);
  b8 = w[565] * b0 + w[572] * b1 + w[579] * b2 + w[586] * b3 + w[593] * b4 + w[600] * b5 + w[607] * b6 - b8;
  b6 = w[325] * TURN(148);
  b6 = w[265] * TURN(8) + w[277] * TURN(36) + w[289] * TURN(64) + w[301] * TURN(92) + w[313] * TURN(120) + b6;
  STORE(passed + 20, b6 = b9 + b6);
  b5 = w[326] * TURN(152);
  b5 = w[266] * TURN(12) + w[278] * TURN(40) + w[290] * TURN(68) + w[302] * TURN(96) + w[314] * TURN(124) + b5;
  STORE(passed + 4, b5 = b6 + b5);
  STORE(passed + 8, b8 - w[621] * b9 - w[628] * b6 - w[635] * b5);
  b5 = w[335] * TURN(16) + w[347] * TURN(44) + w[359] * TURN(72) + w[371] * TURN(100) + w[383] * TURN(128);
  STORE(passed + 0, b5);
}

static void MADE(precurved_tube_k_tip_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11;
  b0 = PASSED(4) + (PASSED(0) + w[395] * TURN(156));
  b1 = w[396] * TURN(160);
  b1 = w[336] * TURN(20) + w[348] * TURN(48) + w[360] * TURN(76) + w[372] * TURN(104) + w[384] * TURN(132) + b1;
  b1 = b0 + b1;
  b2 = w[397] * TURN(164);
  b2 = w[337] * TURN(24) + w[349] * TURN(52) + w[361] * TURN(80) + w[373] * TURN(108) + w[385] * TURN(136) + b2;
  b2 = b1 + b2;
  b3 = w[315] * TURN(140);
  b3 = w[255] * TURN(0) + w[267] * TURN(28) + w[279] * TURN(56) + w[291] * TURN(84) + w[303] * TURN(112) + b3;
  b4 = w[316] * TURN(144);
  b4 = w[256] * TURN(4) + w[268] * TURN(32) + w[280] * TURN(60) + w[292] * TURN(88) + w[304] * TURN(116) + b4;
  b4 = b3 + b4;
  b5 = w[317] * TURN(148);
  b5 = w[257] * TURN(8) + w[269] * TURN(36) + w[281] * TURN(64) + w[293] * TURN(92) + w[305] * TURN(120) + b5;
  b5 = b4 + b5;
  b6 = w[318] * TURN(152);
  b6 = w[258] * TURN(12) + w[270] * TURN(40) + w[282] * TURN(68) + w[294] * TURN(96) + w[306] * TURN(124) + b6;
  b6 = b5 + b6;
  b7 = w[387] * TURN(156);
  b7 = w[327] * TURN(16) + w[339] * TURN(44) + w[351] * TURN(72) + w[363] * TURN(100) + w[375] * TURN(128) + b7;
  b7 = b6 + b7;
  b8 = w[388] * TURN(160);
  b8 = w[328] * TURN(20) + w[340] * TURN(48) + w[352] * TURN(76) + w[364] * TURN(104) + w[376] * TURN(132) + b8;
  b8 = b7 + b8;
  b9 = w[389] * TURN(164);
  b9 = w[329] * TURN(24) + w[341] * TURN(52) + w[353] * TURN(80) + w[365] * TURN(108) + w[377] * TURN(136) + b9;
  b9 = b8 + b9;
  b10 = w[565] * b3 + w[572] * b4 + w[579] * b5 + w[586] * b6 + w[593] * b7 + w[600] * b8 + w[607] * b9;
  b10 = w[657] * PASSED(12) - b10 + w[700] * PASSED(16) + w[701] * PASSED(20) + w[702] * PASSED(4) + w[703] * b0;
  b11 = w[657] * PASSED(24);
  b11 = w[614] * b3 + w[621] * b4 + w[628] * b5 + w[635] * b6 + w[642] * b7 + w[649] * b8 + w[656] * b9 - b11;
  b8 = w[704] * PASSED(44);
  b7 = w[705] * PASSED(48);
  STORE(columns + 0, PASSED(8) - w[642] * b0 - w[649] * b1 - w[656] * b2);
  STORE(columns + 16, b10 + w[704] * b1 + w[705] * b2);
  b7 = b11 - w[700] * PASSED(28) - w[701] * PASSED(32) - w[702] * PASSED(36) - w[703] * PASSED(40) - b8 - b7;
  STORE(columns + 32, b7);
  STORE(columns + 48, EACH((-1.0)) * ((b9 * w[185] + PASSED(48) * w[182] + b2 * w[183]) / EACH(2.0)));
  STORE(columns + 64, (b9 * w[184] + PASSED(48) * w[183] - b2 * w[182]) / EACH(2.0));
  STORE(columns + 80, (PASSED(48) * w[184] - b9 * w[183] + b2 * w[185]) / EACH(2.0));
  STORE(columns + 96, (b9 * w[182] - PASSED(48) * w[185] + b2 * w[184]) / EACH(2.0));
}

static void MADE(precurved_tube_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 168, columns += 4) {
    EVERY_LANE(MADE(precurved_tube_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(precurved_tube_k_tip_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}
