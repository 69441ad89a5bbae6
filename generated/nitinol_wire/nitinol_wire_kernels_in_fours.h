/* Included once for each width of vectors. */
static void MADE(nitinol_wire_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(nitinol_wire_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 156)
    EVERY_LANE(MADE(nitinol_wire_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(nitinol_wire_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_increments_4_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_increments_4)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 36, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_increments_4_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_pulls_5_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_pulls_5)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 104, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_pulls_5_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 80, made += 72)
    EVERY_LANE(MADE(nitinol_wire_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17;
  b0 = w[136] * TURN(120);
  STORE(passed + 8, b0 = w[76] * TURN(0) + w[88] * TURN(24) + w[100] * TURN(48) + w[112] * TURN(72) + w[124] * TURN(96) + b0);
  b1 = w[137] * TURN(124);
  STORE(passed + 100, b1 = w[77] * TURN(4) + w[89] * TURN(28) + w[101] * TURN(52) + w[113] * TURN(76) + w[125] * TURN(100) + b1);
  STORE(passed + 64, b1 = b0 + b1);
  b2 = w[138] * TURN(128);
  STORE(passed + 132, b2 = w[78] * TURN(8) + w[90] * TURN(32) + w[102] * TURN(56) + w[114] * TURN(80) + w[126] * TURN(104) + b2);
  STORE(passed + 52, b2 = b1 + b2);
  b3 = w[139] * TURN(132);
  STORE(passed + 148, b3 = w[79] * TURN(12) + w[91] * TURN(36) + w[103] * TURN(60) + w[115] * TURN(84) + w[127] * TURN(108) + b3);
  STORE(passed + 40, b3 = b2 + b3);
  b4 = w[292] * TURN(136);
  STORE(passed + 116, b4 = w[232] * TURN(16) + w[244] * TURN(40) + w[256] * TURN(64) + w[268] * TURN(88) + w[280] * TURN(112) + b4);
  STORE(passed + 28, b4 = b3 + b4);
  b5 = w[293] * TURN(140);
  STORE(passed + 84, b5 = w[233] * TURN(20) + w[245] * TURN(44) + w[257] * TURN(68) + w[269] * TURN(92) + w[281] * TURN(116) + b5);
  STORE(passed + 16, b5 = b4 + b5);
  b6 = w[132] * TURN(120);
  STORE(passed + 0, b6 = w[72] * TURN(0) + w[84] * TURN(24) + w[96] * TURN(48) + w[108] * TURN(72) + w[120] * TURN(96) + b6);
  b7 = w[133] * TURN(124);
  STORE(passed + 96, b7 = w[73] * TURN(4) + w[85] * TURN(28) + w[97] * TURN(52) + w[109] * TURN(76) + w[121] * TURN(100) + b7);
  STORE(passed + 68, b7 = b6 + b7);
  b8 = w[134] * TURN(128);
  STORE(passed + 128, b8 = w[74] * TURN(8) + w[86] * TURN(32) + w[98] * TURN(56) + w[110] * TURN(80) + w[122] * TURN(104) + b8);
  STORE(passed + 56, b8 = b7 + b8);
  b9 = w[135] * TURN(132);
  STORE(passed + 144, b9 = w[75] * TURN(12) + w[87] * TURN(36) + w[99] * TURN(60) + w[111] * TURN(84) + w[123] * TURN(108) + b9);
  STORE(passed + 44, b9 = b8 + b9);
  b10 = w[288] * TURN(136);
  STORE(passed + 112, b10 = w[228] * TURN(16) + w[240] * TURN(40) + w[252] * TURN(64) + w[264] * TURN(88) + w[276] * TURN(112) + b10);
  STORE(passed + 32, b10 = b9 + b10);
  b11 = w[289] * TURN(140);
  STORE(passed + 80, b11 = w[229] * TURN(20) + w[241] * TURN(44) + w[253] * TURN(68) + w[265] * TURN(92) + w[277] * TURN(116) + b11);
  STORE(passed + 20, b11 = b10 + b11);
  b12 = w[140] * TURN(120);
  STORE(passed + 12, b12 = w[80] * TURN(0) + w[92] * TURN(24) + w[104] * TURN(48) + w[116] * TURN(72) + w[128] * TURN(96) + b12);
  b13 = w[141] * TURN(124);
  STORE(passed + 104, b13 = w[81] * TURN(4) + w[93] * TURN(28) + w[105] * TURN(52) + w[117] * TURN(76) + w[129] * TURN(100) + b13);
  STORE(passed + 72, b13 = b12 + b13);
  b14 = w[142] * TURN(128);
  STORE(passed + 136, b14 = w[82] * TURN(8) + w[94] * TURN(32) + w[106] * TURN(56) + w[118] * TURN(80) + w[130] * TURN(104) + b14);
  STORE(passed + 60, b14 = b13 + b14);
  b15 = w[143] * TURN(132);
  STORE(passed + 152, b15 = w[83] * TURN(12) + w[95] * TURN(36) + w[107] * TURN(60) + w[119] * TURN(84) + w[131] * TURN(108) + b15);
  STORE(passed + 48, b15 = b14 + b15);
  b16 = w[296] * TURN(136);
  STORE(passed + 120, b16 = w[236] * TURN(16) + w[248] * TURN(40) + w[260] * TURN(64) + w[272] * TURN(88) + w[284] * TURN(112) + b16);
  STORE(passed + 36, b16 = b15 + b16);
  b17 = w[297] * TURN(140);
  STORE(passed + 88, b17 = w[237] * TURN(20) + w[249] * TURN(44) + w[261] * TURN(68) + w[273] * TURN(92) + w[285] * TURN(116) + b17);
  STORE(passed + 24, b17 = b16 + b17);
  STORE(passed + 76, b17 = w[604] * b5 - w[641] * b11 + w[678] * b17);
  STORE(passed + 108, b16 = b17 + (w[679] * b4 - w[680] * b10 + w[681] * b16));
  STORE(passed + 140, b15 = b16 + (w[682] * b3 - w[683] * b9 + w[684] * b15));
  STORE(passed + 124, b14 = b15 + (w[685] * b2 - w[686] * b8 + w[687] * b14));
  STORE(passed + 92, b13 = b14 + (w[688] * b1 - w[689] * b7 + w[690] * b13));
  STORE(passed + 4, b13 + (w[691] * b0 - w[692] * b6 + w[693] * b12));
}

static void MADE(nitinol_wire_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13;
  STORE(passed + 156, b0 = PASSED(4) + w[144] * PASSED(0) + w[156] * PASSED(8) + w[168] * PASSED(12));
  b1 = w[697] * PASSED(16) - w[698] * PASSED(20) + w[699] * PASSED(24);
  b2 = b1 + (w[700] * PASSED(28) - w[701] * PASSED(32) + w[702] * PASSED(36));
  b3 = b2 + (w[703] * PASSED(40) - w[704] * PASSED(44) + w[705] * PASSED(48));
  b4 = b3 + (w[706] * PASSED(52) - w[707] * PASSED(56) + w[708] * PASSED(60));
  b5 = b4 + (w[709] * PASSED(64) - w[710] * PASSED(68) + w[711] * PASSED(72));
  b6 = w[160] * PASSED(8);
  b7 = w[172] * PASSED(12);
  STORE(passed + 160, b7 = b5 + (w[712] * PASSED(8) - w[713] * PASSED(0) + w[714] * PASSED(12)) + w[148] * PASSED(0) + b6 + b7);
  b6 = w[718] * PASSED(16) - w[719] * PASSED(20) + w[720] * PASSED(24);
  b8 = b6 + (w[721] * PASSED(28) - w[722] * PASSED(32) + w[723] * PASSED(36));
  b9 = b8 + (w[724] * PASSED(40) - w[725] * PASSED(44) + w[726] * PASSED(48));
  b10 = b9 + (w[727] * PASSED(52) - w[728] * PASSED(56) + w[729] * PASSED(60));
  b11 = b10 + (w[730] * PASSED(64) - w[731] * PASSED(68) + w[732] * PASSED(72));
  b12 = w[164] * PASSED(8);
  b13 = w[176] * PASSED(12);
  STORE(passed + 164, b13 = b11 + (w[733] * PASSED(8) - w[734] * PASSED(0) + w[735] * PASSED(12)) + w[152] * PASSED(0) + b12 + b13);
  b13 = w[72] * b0 + w[76] * b7 + w[80] * b13 + w[212] * TURN(96) + w[220] * TURN(120);
  b7 = w[325] * PASSED(88);
  STORE(passed + 168, b7 = PASSED(76) - (w[741] * PASSED(28) + w[742] * PASSED(36)) + w[301] * PASSED(80) + w[313] * PASSED(84) + b7);
  b0 = w[329] * PASSED(88);
  STORE(passed + 172, b0 = w[741] * PASSED(32) - w[746] * PASSED(36) + b1 + w[305] * PASSED(80) + w[317] * PASSED(84) + b0);
  b1 = w[333] * PASSED(88);
  STORE(passed + 176, b1 = w[742] * PASSED(32) + w[746] * PASSED(28) + b6 + w[309] * PASSED(80) + w[321] * PASSED(84) + b1);
  b1 = w[229] * b7 + w[233] * b0 + w[237] * b1 + w[369] * TURN(116) + w[377] * TURN(140);
  STORE(passed + 232, b0 = b13 + b1);
  b7 = w[169] * PASSED(104);
  STORE(passed + 184, b7 = PASSED(92) - (w[755] * PASSED(8) + w[756] * PASSED(12)) + w[145] * PASSED(96) + w[157] * PASSED(100) + b7);
  b6 = w[173] * PASSED(104);
  STORE(passed + 188, b6 = w[755] * PASSED(0) - w[760] * PASSED(12) + b5 + w[149] * PASSED(96) + w[161] * PASSED(100) + b6);
  b5 = w[177] * PASSED(104);
  STORE(passed + 192, b5 = w[756] * PASSED(0) + w[760] * PASSED(8) + b11 + w[153] * PASSED(96) + w[165] * PASSED(100) + b5);
  b5 = w[73] * b7 + w[77] * b6 + w[81] * b5 + w[213] * TURN(100) + w[221] * TURN(124);
  b6 = w[324] * PASSED(120);
  STORE(passed + 196, b6 = PASSED(108) - (w[769] * PASSED(40) + w[770] * PASSED(48)) + w[300] * PASSED(112) + w[312] * PASSED(116) + b6);
  b7 = w[328] * PASSED(120);
  STORE(passed + 200, b7 = w[769] * PASSED(44) - w[774] * PASSED(48) + b2 + w[304] * PASSED(112) + w[316] * PASSED(116) + b7);
  b2 = w[332] * PASSED(120);
  STORE(passed + 204, b2 = w[770] * PASSED(44) + w[774] * PASSED(40) + b8 + w[308] * PASSED(112) + w[320] * PASSED(116) + b2);
  b2 = w[228] * b6 + w[232] * b7 + w[236] * b2 + w[368] * TURN(112) + w[376] * TURN(136);
  STORE(passed + 236, b7 = b5 + b2);
  b6 = w[170] * PASSED(136);
  STORE(passed + 208, b6 = PASSED(124) - (w[783] * PASSED(64) + w[784] * PASSED(72)) + w[146] * PASSED(128) + w[158] * PASSED(132) + b6);
  b8 = w[174] * PASSED(136);
  STORE(passed + 212, b8 = w[783] * PASSED(68) - w[788] * PASSED(72) + b4 + w[150] * PASSED(128) + w[162] * PASSED(132) + b8);
  b4 = w[178] * PASSED(136);
  STORE(passed + 216, b4 = w[784] * PASSED(68) + w[788] * PASSED(64) + b10 + w[154] * PASSED(128) + w[166] * PASSED(132) + b4);
  b4 = w[74] * b6 + w[78] * b8 + w[82] * b4 + w[214] * TURN(104) + w[222] * TURN(128);
  b8 = w[171] * PASSED(152);
  STORE(passed + 220, b8 = PASSED(140) - (w[797] * PASSED(52) + w[798] * PASSED(60)) + w[147] * PASSED(144) + w[159] * PASSED(148) + b8);
  b6 = w[175] * PASSED(152);
  STORE(passed + 224, b6 = w[797] * PASSED(56) - w[802] * PASSED(60) + b3 + w[151] * PASSED(144) + w[163] * PASSED(148) + b6);
  b3 = w[179] * PASSED(152);
  STORE(passed + 228, b3 = w[798] * PASSED(56) + w[802] * PASSED(52) + b9 + w[155] * PASSED(144) + w[167] * PASSED(148) + b3);
  b3 = w[75] * b8 + w[79] * b6 + w[83] * b3 + w[215] * TURN(108) + w[223] * TURN(132);
  STORE(passed + 240, b6 = b4 + b3);
  STORE(passed + 244, EACH(C[20]) * b0 + EACH(C[21]) * b7 + EACH(C[22]) * b6);
  STORE(passed + 180, EACH(C[23]) * (b13 - b1) + EACH(C[24]) * (b5 - b2) + EACH(C[23]) * (b4 - b3));
}

static void MADE(nitinol_wire_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29;
  b0 = w[108] * PASSED(156) + w[112] * PASSED(160) + w[116] * PASSED(164) + w[188] * TURN(24) + w[196] * TURN(48);
  b1 = w[265] * PASSED(168) + w[269] * PASSED(172) + w[273] * PASSED(176) + w[345] * TURN(44) + w[353] * TURN(68);
  b2 = w[109] * PASSED(184) + w[113] * PASSED(188) + w[117] * PASSED(192) + w[189] * TURN(28) + w[197] * TURN(52);
  b3 = w[264] * PASSED(196) + w[268] * PASSED(200) + w[272] * PASSED(204) + w[344] * TURN(40) + w[352] * TURN(64);
  b4 = w[110] * PASSED(208) + w[114] * PASSED(212) + w[118] * PASSED(216) + w[190] * TURN(32) + w[198] * TURN(56);
  b5 = w[111] * PASSED(220) + w[115] * PASSED(224) + w[119] * PASSED(228) + w[191] * TURN(36) + w[199] * TURN(60);
  b6 = EACH(C[25]) * (b2 - b3);
  b7 = EACH(C[26]) * (b4 - b5);
  b8 = w[84] * PASSED(156) + w[88] * PASSED(160) + w[92] * PASSED(164) + w[204] * TURN(72) + w[224] * TURN(120);
  b9 = w[241] * PASSED(168) + w[245] * PASSED(172) + w[249] * PASSED(176) + w[361] * TURN(92) + w[381] * TURN(140);
  b10 = b8 + b9;
  b11 = w[85] * PASSED(184) + w[89] * PASSED(188) + w[93] * PASSED(192) + w[205] * TURN(76) + w[225] * TURN(124);
  b12 = w[240] * PASSED(196) + w[244] * PASSED(200) + w[248] * PASSED(204) + w[360] * TURN(88) + w[380] * TURN(136);
  b13 = b11 + b12;
  b14 = w[86] * PASSED(208) + w[90] * PASSED(212) + w[94] * PASSED(216) + w[206] * TURN(80) + w[226] * TURN(128);
  b15 = w[87] * PASSED(220) + w[91] * PASSED(224) + w[95] * PASSED(228) + w[207] * TURN(84) + w[227] * TURN(132);
  b16 = b14 + b15;
  b17 = w[120] * PASSED(156) + w[124] * PASSED(160) + w[128] * PASSED(164) + w[180] * TURN(0) + w[200] * TURN(48);
  b18 = w[277] * PASSED(168) + w[281] * PASSED(172) + w[285] * PASSED(176) + w[337] * TURN(20) + w[357] * TURN(68);
  b19 = w[121] * PASSED(184) + w[125] * PASSED(188) + w[129] * PASSED(192) + w[181] * TURN(4) + w[201] * TURN(52);
  b20 = w[276] * PASSED(196) + w[280] * PASSED(200) + w[284] * PASSED(204) + w[336] * TURN(16) + w[356] * TURN(64);
  b21 = EACH(C[20]) * (b19 + b20);
  b22 = w[122] * PASSED(208) + w[126] * PASSED(212) + w[130] * PASSED(216) + w[182] * TURN(8) + w[202] * TURN(56);
  b23 = w[123] * PASSED(220) + w[127] * PASSED(224) + w[131] * PASSED(228) + w[183] * TURN(12) + w[203] * TURN(60);
  b24 = EACH(C[27]) * (b22 + b23);
  b23 = EACH(C[26]) * (b22 - b23);
  b22 = w[96] * PASSED(156) + w[100] * PASSED(160) + w[104] * PASSED(164) + w[208] * TURN(72) + w[216] * TURN(96);
  b25 = w[253] * PASSED(168) + w[257] * PASSED(172) + w[261] * PASSED(176) + w[365] * TURN(92) + w[373] * TURN(116);
  b26 = w[97] * PASSED(184) + w[101] * PASSED(188) + w[105] * PASSED(192) + w[209] * TURN(76) + w[217] * TURN(100);
  b27 = w[252] * PASSED(196) + w[256] * PASSED(200) + w[260] * PASSED(204) + w[364] * TURN(88) + w[372] * TURN(112);
  b28 = w[98] * PASSED(208) + w[102] * PASSED(212) + w[106] * PASSED(216) + w[210] * TURN(80) + w[218] * TURN(104);
  b29 = w[99] * PASSED(220) + w[103] * PASSED(224) + w[107] * PASSED(228) + w[211] * TURN(84) + w[219] * TURN(108);
  STORE(columns + 0, PASSED(244));
  STORE(columns + 8, PASSED(180) + EACH(C[28]) * (b0 + b1) + EACH(C[20]) * (b2 + b3) + EACH(C[27]) * (b4 + b5));
  b7 = EACH(C[29]) * PASSED(232) + EACH(C[30]) * PASSED(236) + EACH(C[26]) * PASSED(240) + EACH(C[31]) * (b0 - b1) + b6 + b7;
  STORE(columns + 16, b7);
  STORE(columns + 24, EACH(C[20]) * b10 + EACH(C[21]) * b13 + EACH(C[22]) * b16);
  b24 = EACH(C[23]) * (b8 - b9) + EACH(C[24]) * (b11 - b12) + EACH(C[23]) * (b14 - b15) + EACH(C[28]) * (b17 + b18) + b21 + b24;
  STORE(columns + 32, b24);
  b23 = EACH(C[29]) * b10 + EACH(C[30]) * b13 + EACH(C[26]) * b16 + EACH(C[31]) * (b17 - b18) + EACH(C[25]) * (b19 - b20) + b23;
  STORE(columns + 40, b23);
  STORE(columns + 48, EACH(C[32]) * (b22 + b25) + EACH(C[33]) * (b26 + b27) + EACH(C[34]) * (b28 + b29));
}

static void MADE(nitinol_wire_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 144, columns += 4) {
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_2)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(nitinol_wire_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9;
  b0 = w[262] * TURN(120);
  STORE(passed + 12, b0 = w[202] * TURN(0) + w[214] * TURN(24) + w[226] * TURN(48) + w[238] * TURN(72) + w[250] * TURN(96) + b0);
  b1 = w[263] * TURN(124);
  b1 = w[203] * TURN(4) + w[215] * TURN(28) + w[227] * TURN(52) + w[239] * TURN(76) + w[251] * TURN(100) + b1;
  STORE(passed + 16, b1 = b0 + b1);
  b2 = w[264] * TURN(128);
  b2 = w[204] * TURN(8) + w[216] * TURN(32) + w[228] * TURN(56) + w[240] * TURN(80) + w[252] * TURN(104) + b2;
  STORE(passed + 20, b2 = b1 + b2);
  b3 = w[265] * TURN(132);
  b3 = w[205] * TURN(12) + w[217] * TURN(36) + w[229] * TURN(60) + w[241] * TURN(84) + w[253] * TURN(108) + b3;
  STORE(passed + 24, b3 = b2 + b3);
  b4 = w[334] * TURN(136);
  b4 = w[274] * TURN(16) + w[286] * TURN(40) + w[298] * TURN(64) + w[310] * TURN(88) + w[322] * TURN(112) + b4;
  STORE(passed + 28, b4 = b3 + b4);
  b5 = w[335] * TURN(140);
  b5 = w[275] * TURN(20) + w[287] * TURN(44) + w[299] * TURN(68) + w[311] * TURN(92) + w[323] * TURN(116) + b5;
  STORE(passed + 32, b5 = b4 + b5);
  b6 = w[266] * TURN(120);
  STORE(passed + 36, b6 = w[206] * TURN(0) + w[218] * TURN(24) + w[230] * TURN(48) + w[242] * TURN(72) + w[254] * TURN(96) + b6);
  b7 = w[267] * TURN(124);
  b7 = w[207] * TURN(4) + w[219] * TURN(28) + w[231] * TURN(52) + w[243] * TURN(76) + w[255] * TURN(100) + b7;
  STORE(passed + 40, b7 = b6 + b7);
  b8 = w[557] * b7;
  b9 = w[268] * TURN(128);
  b9 = w[208] * TURN(8) + w[220] * TURN(32) + w[232] * TURN(56) + w[244] * TURN(80) + w[256] * TURN(104) + b9;
  STORE(passed + 44, b9 = b7 + b9);
  b8 = w[508] * b0 + w[515] * b1 + w[522] * b2 + w[529] * b3 + w[536] * b4 + w[543] * b5 - w[550] * b6 - b8;
  b6 = w[269] * TURN(132);
  b6 = w[209] * TURN(12) + w[221] * TURN(36) + w[233] * TURN(60) + w[245] * TURN(84) + w[257] * TURN(108) + b6;
  STORE(passed + 4, b6 = b9 + b6);
  STORE(passed + 8, b8 - w[564] * b9 - w[571] * b6);
  b6 = w[278] * TURN(16) + w[290] * TURN(40) + w[302] * TURN(64) + w[314] * TURN(88) + w[326] * TURN(112);
  STORE(passed + 0, b6);
}

static void MADE(nitinol_wire_k_tip_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10;
  b0 = PASSED(4) + (PASSED(0) + w[338] * TURN(136));
  b1 = w[339] * TURN(140);
  b1 = w[279] * TURN(20) + w[291] * TURN(44) + w[303] * TURN(68) + w[315] * TURN(92) + w[327] * TURN(116) + b1;
  b1 = b0 + b1;
  b2 = PASSED(8) - w[578] * b0 - w[585] * b1;
  b3 = w[258] * TURN(120);
  b3 = w[198] * TURN(0) + w[210] * TURN(24) + w[222] * TURN(48) + w[234] * TURN(72) + w[246] * TURN(96) + b3;
  b4 = w[259] * TURN(124);
  b4 = w[199] * TURN(4) + w[211] * TURN(28) + w[223] * TURN(52) + w[235] * TURN(76) + w[247] * TURN(100) + b4;
  b4 = b3 + b4;
  b5 = w[260] * TURN(128);
  b5 = w[200] * TURN(8) + w[212] * TURN(32) + w[224] * TURN(56) + w[236] * TURN(80) + w[248] * TURN(104) + b5;
  b5 = b4 + b5;
  b6 = w[261] * TURN(132);
  b6 = w[201] * TURN(12) + w[213] * TURN(36) + w[225] * TURN(60) + w[237] * TURN(84) + w[249] * TURN(108) + b6;
  b6 = b5 + b6;
  b7 = w[330] * TURN(136);
  b7 = w[270] * TURN(16) + w[282] * TURN(40) + w[294] * TURN(64) + w[306] * TURN(88) + w[318] * TURN(112) + b7;
  b7 = b6 + b7;
  b8 = w[331] * TURN(140);
  b8 = w[271] * TURN(20) + w[283] * TURN(44) + w[295] * TURN(68) + w[307] * TURN(92) + w[319] * TURN(116) + b8;
  b8 = b7 + b8;
  b9 = w[550] * b3 + w[557] * b4 + w[564] * b5 + w[571] * b6 + w[578] * b7 + w[585] * b8 - w[622] * PASSED(12);
  b10 = w[627] * PASSED(32);
  b10 = b9 - w[623] * PASSED(16) - w[624] * PASSED(20) - w[625] * PASSED(24) - w[626] * PASSED(28) - b10;
  b7 = w[508] * b3 + w[515] * b4 + w[522] * b5 + w[529] * b6 + w[536] * b7 + w[543] * b8;
  b0 = w[622] * PASSED(36) - b7 + w[623] * PASSED(40) + w[624] * PASSED(44) + w[625] * PASSED(4) + w[626] * b0;
  b7 = (b8 * w[139] + PASSED(32) * w[136] + b1 * w[137]) / EACH(2.0);
  b6 = (PASSED(32) * w[138] - b8 * w[137] + b1 * w[139]) / EACH(2.0);
  b5 = (b8 * w[138] + PASSED(32) * w[137] - b1 * w[136]) / EACH(2.0);
  b8 = (b8 * w[136] - PASSED(32) * w[139] + b1 * w[138]) / EACH(2.0);
  STORE(columns + 0, EACH(C[35]) * b2 + b10);
  STORE(columns + 8, b0 + w[627] * b1);
  STORE(columns + 16, EACH(C[35]) * b10 - b2);
  STORE(columns + 24, EACH((-1.0)) * (EACH(C[36]) * b7 + EACH(C[37]) * b6));
  STORE(columns + 32, EACH(C[36]) * b5 + EACH(C[37]) * b8);
  STORE(columns + 40, EACH(C[36]) * b6 - EACH(C[37]) * b7);
  STORE(columns + 48, EACH(C[36]) * b8 - EACH(C[37]) * b5);
}

static void MADE(nitinol_wire_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 144, columns += 4) {
    EVERY_LANE(MADE(nitinol_wire_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(nitinol_wire_k_tip_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}
