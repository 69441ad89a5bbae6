/* Included once for each width of vectors. */
static void MADE(nitinol_wire_derivatives_increments_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_derivatives_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 20, made += 36)
    EVERY_LANE(MADE(nitinol_wire_derivatives_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_derivatives_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 88, made += 24)
    EVERY_LANE(MADE(nitinol_wire_derivatives_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17;
  b0 = GIVEN(0) - GIVEN(8) * GIVEN(16) / EACH(12.0);
  b1 = GIVEN(4) + GIVEN(8) * GIVEN(12) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH(C[5]) + EACH(C[6]) * b3;
  b5 = EACH(C[4]) + b3 * b4;
  b6 = EACH(C[3]) + b3 * b5;
  b7 = EACH(C[2]) + b3 * b6;
  b8 = EACH(C[1]) + b3 * b7;
  b9 = EACH(C[0]) + b3 * b8;
  b10 = EACH(C[9]) + b3 * b9;
  b11 = EACH(C[8]) + b3 * b10;
  b12 = EACH(C[7]) + b3 * b11;
  b13 = GIVEN(20) - EACH(C[18]) * (GIVEN(16) * GIVEN(28) + GIVEN(8) * GIVEN(36));
  b14 = GIVEN(24) + EACH(C[18]) * (GIVEN(12) * GIVEN(28) + GIVEN(8) * GIVEN(32));
  b15 = EACH(C[18]) * (GIVEN(16) * GIVEN(20) + GIVEN(0) * GIVEN(36) - (GIVEN(12) * GIVEN(24) + GIVEN(4) * GIVEN(32)));
  b15 = GIVEN(28) + b15;
  b16 = EACH(2.0) * b0 * b13 + EACH(2.0) * b1 * b14 + EACH(2.0) * b2 * b15;
  b4 = b3 * (b7 * b16 + b3 * (b6 * b16 + b3 * (b5 * b16 + b3 * (b4 * b16 + b3 * (EACH(C[6]) * b16)))));
  b4 = b11 * b16 + b3 * (b10 * b16 + b3 * (b9 * b16 + b3 * (b8 * b16 + b4)));
  b8 = EACH(C[15]) + EACH(C[16]) * b3;
  b9 = EACH(C[14]) + b3 * b8;
  b10 = EACH(C[13]) + b3 * b9;
  b11 = EACH(C[12]) + b3 * b10;
  b5 = EACH(C[11]) + b3 * b11;
  b6 = EACH(C[10]) + b3 * b5;
  b7 = EACH(C[17]) + b3 * b6;
  b17 = EACH(1.0) + b3 * b7;
  b8 = b3 * (b11 * b16 + b3 * (b10 * b16 + b3 * (b9 * b16 + b3 * (b8 * b16 + b3 * (EACH(C[16]) * b16)))));
  b8 = b7 * b16 + b3 * (b6 * b16 + b3 * (b5 * b16 + b8));
  b5 = EACH(0.5) * b8;
  b6 = b17 / EACH(2.0);
  STORE(made + 0, EACH((-1.0)) * ((b12 * b16 + b3 * b4) / b17 + (EACH(1.0) - b3 * b12) / b17 / b17 * b8));
  STORE(made + 4, b0 * b5 + b6 * b13);
  STORE(made + 8, b1 * b5 + b6 * b14);
  STORE(made + 12, b2 * b5 + b6 * b15);
  STORE(made + 16, b13);
  STORE(made + 20, b14);
  STORE(made + 24, b15);
  STORE(made + 28, b8);
  STORE(made + 32, b4);
}

static void MADE(nitinol_wire_derivatives_fwd1_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 40, made += 36)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  b0 = GIVEN(64) * GIVEN(76) + GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84);
  b1 = GIVEN(40) * GIVEN(76) + GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84);
  b2 = GIVEN(28) * b1 - GIVEN(20) * b0;
  b3 = GIVEN(32) * GIVEN(32) / EACH(2.0);
  b4 = GIVEN(52) * GIVEN(76) + GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84);
  b5 = GIVEN(36) * b2 - b3 * b4;
  b6 = GIVEN(24) * b0 - GIVEN(28) * b4;
  b7 = GIVEN(36) * b6 - b3 * b1;
  b8 = EACH(C[18]) * (b0 + (GIVEN(20) * b5 - GIVEN(24) * b7));
  b9 = GIVEN(84) * GIVEN(160) + GIVEN(72) * GIVEN(172);
  b9 = GIVEN(76) * GIVEN(152) + GIVEN(64) * GIVEN(164) + (GIVEN(80) * GIVEN(156) + GIVEN(68) * GIVEN(168)) + b9;
  b10 = GIVEN(84) * GIVEN(136) + GIVEN(48) * GIVEN(172);
  b10 = GIVEN(76) * GIVEN(128) + GIVEN(40) * GIVEN(164) + (GIVEN(80) * GIVEN(132) + GIVEN(44) * GIVEN(168)) + b10;
  b11 = EACH(0.5) * (EACH(2.0) * GIVEN(32) * GIVEN(120));
  b12 = GIVEN(84) * GIVEN(148) + GIVEN(60) * GIVEN(172);
  b12 = GIVEN(76) * GIVEN(140) + GIVEN(52) * GIVEN(164) + (GIVEN(80) * GIVEN(144) + GIVEN(56) * GIVEN(168)) + b12;
  b2 = b2 * GIVEN(124) + GIVEN(36) * (b1 * GIVEN(116) + GIVEN(28) * b10 - (b0 * GIVEN(108) + GIVEN(20) * b9));
  b2 = b2 - (b4 * b11 + b3 * b12);
  b6 = b6 * GIVEN(124) + GIVEN(36) * (b0 * GIVEN(112) + GIVEN(24) * b9 - (b4 * GIVEN(116) + GIVEN(28) * b12));
  b6 = b6 - (b1 * b11 + b3 * b10);
  b13 = b9 + (b5 * GIVEN(108) + GIVEN(20) * b2 - (b7 * GIVEN(112) + GIVEN(24) * b6));
  b14 = EACH(C[18]) * b13;
  b15 = GIVEN(20) * b4 - GIVEN(24) * b1;
  b16 = GIVEN(36) * b15 - b3 * b0;
  b15 = b15 * GIVEN(124) + GIVEN(36) * (b4 * GIVEN(108) + GIVEN(20) * b12 - (b1 * GIVEN(112) + GIVEN(24) * b10));
  b9 = b15 - (b0 * b11 + b3 * b9);
  b2 = b10 + (b16 * GIVEN(112) + GIVEN(24) * b9 - (b5 * GIVEN(116) + GIVEN(28) * b2));
  b9 = b12 + (b7 * GIVEN(116) + GIVEN(28) * b6 - (b16 * GIVEN(108) + GIVEN(20) * b9));
  b7 = EACH(C[18]) * (b4 + (GIVEN(28) * b7 - GIVEN(20) * b16));
  b4 = EACH(C[18]) * b9;
  b5 = EACH(C[18]) * (b1 + (GIVEN(24) * b16 - GIVEN(28) * b5));
  b16 = EACH(C[18]) * b2;
  STORE(made + 0, b8 * GIVEN(104) + GIVEN(16) * b14 + b2);
  STORE(made + 4, b9 - (b8 * GIVEN(100) + GIVEN(12) * b14));
  STORE(made + 8, b13 + (b7 * GIVEN(100) + GIVEN(12) * b4) - (b5 * GIVEN(104) + GIVEN(16) * b16));
  STORE(made + 12, b7 * GIVEN(96) + GIVEN(8) * b4 - (b8 * GIVEN(92) + GIVEN(4) * b14));
  STORE(made + 16, b8 * GIVEN(88) + GIVEN(0) * b14 - (b5 * GIVEN(96) + GIVEN(8) * b16));
  STORE(made + 20, b5 * GIVEN(92) + GIVEN(4) * b16 - (b7 * GIVEN(88) + GIVEN(0) * b4));
}

static void MADE(nitinol_wire_derivatives_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 176, made += 24)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_adj1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23;
  b0 = GIVEN(64) * GIVEN(76) + GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84);
  b1 = GIVEN(40) * GIVEN(76) + GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84);
  b2 = GIVEN(28) * b1 - GIVEN(20) * b0;
  b3 = GIVEN(32) * GIVEN(32) / EACH(2.0);
  b4 = GIVEN(52) * GIVEN(76) + GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84);
  b5 = GIVEN(36) * b2 - b3 * b4;
  b6 = GIVEN(24) * b0 - GIVEN(28) * b4;
  b7 = GIVEN(36) * b6 - b3 * b1;
  b8 = EACH(C[18]) * (b0 + (GIVEN(20) * b5 - GIVEN(24) * b7));
  b9 = GIVEN(20) * b4 - GIVEN(24) * b1;
  b10 = GIVEN(36) * b9 - b3 * b0;
  b11 = EACH(C[18]) * (b4 + (GIVEN(28) * b7 - GIVEN(20) * b10));
  b12 = EACH(C[18]) * (b1 + (GIVEN(24) * b10 - GIVEN(28) * b5));
  b13 = EACH(C[18]) * (GIVEN(4) * GIVEN(108) - GIVEN(8) * GIVEN(104) - GIVEN(16) * GIVEN(96)) + GIVEN(88);
  b14 = EACH(C[18]) * (GIVEN(8) * GIVEN(100) - GIVEN(0) * GIVEN(108) + GIVEN(12) * GIVEN(96)) + GIVEN(92);
  b15 = GIVEN(24) * b13 - GIVEN(20) * b14;
  b16 = GIVEN(36) * b15;
  b17 = EACH(C[18]) * (GIVEN(0) * GIVEN(104) - GIVEN(4) * GIVEN(100) - GIVEN(12) * GIVEN(92) + GIVEN(16) * GIVEN(88));
  b17 = GIVEN(96) + b17;
  b18 = GIVEN(20) * b17 - GIVEN(28) * b13;
  b19 = GIVEN(36) * b18;
  b20 = GIVEN(28) * b14 - GIVEN(24) * b17;
  b21 = GIVEN(36) * b20;
  b22 = b13 - GIVEN(24) * b16 - b3 * b20 + GIVEN(28) * b19;
  b23 = b14 + GIVEN(20) * b16 - GIVEN(28) * b21 - b3 * b18;
  b3 = b17 - b3 * b15 + GIVEN(24) * b21 - GIVEN(20) * b19;
  STORE(made + 0, b8 * GIVEN(104) - b11 * GIVEN(108));
  STORE(made + 4, b12 * GIVEN(108) - b8 * GIVEN(100));
  STORE(made + 8, b11 * GIVEN(100) - b12 * GIVEN(104));
  STORE(made + 12, b11 * GIVEN(96) - b8 * GIVEN(92));
  STORE(made + 16, b8 * GIVEN(88) - b12 * GIVEN(96));
  STORE(made + 20, b4 * b16 - b10 * b14 + b5 * b17 - b0 * b19);
  STORE(made + 24, b10 * b13 - b1 * b16 - b7 * b17 + b0 * b21);
  STORE(made + 28, b7 * b14 - b5 * b13 - b4 * b21 + b1 * b19);
  STORE(made + 32, EACH((-1.0)) * (EACH(2.0) * GIVEN(32) * (EACH(0.5) * (b0 * b15 + b1 * b20 + b4 * b18))));
  STORE(made + 36, b9 * b15 + b6 * b20 + b2 * b18);
  STORE(made + 40, GIVEN(76) * b22);
  STORE(made + 44, GIVEN(80) * b22);
  STORE(made + 48, GIVEN(84) * b22);
  STORE(made + 52, GIVEN(76) * b23);
  STORE(made + 56, GIVEN(80) * b23);
  STORE(made + 60, GIVEN(84) * b23);
  STORE(made + 64, GIVEN(76) * b3);
  STORE(made + 68, GIVEN(80) * b3);
  STORE(made + 72, GIVEN(84) * b3);
  STORE(made + 76, GIVEN(52) * b23 + GIVEN(40) * b22 + GIVEN(64) * b3);
  STORE(made + 80, GIVEN(56) * b23 + GIVEN(44) * b22 + GIVEN(68) * b3);
  STORE(made + 84, GIVEN(60) * b23 + GIVEN(48) * b22 + GIVEN(72) * b3);
}

static void MADE(nitinol_wire_derivatives_adj1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 112, made += 88)
    EVERY_LANE(MADE(nitinol_wire_derivatives_adj1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_adj1_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28;
  b0 = GIVEN(0) - GIVEN(8) * GIVEN(16) / EACH(12.0);
  b1 = GIVEN(4) + GIVEN(8) * GIVEN(12) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH(C[15]) + EACH(C[16]) * b3;
  b5 = EACH(C[14]) + b3 * b4;
  b6 = EACH(C[13]) + b3 * b5;
  b7 = EACH(C[12]) + b3 * b6;
  b8 = EACH(C[11]) + b3 * b7;
  b9 = EACH(C[10]) + b3 * b8;
  b10 = EACH(C[17]) + b3 * b9;
  b11 = EACH(1.0) + b3 * b10;
  b12 = b11 / EACH(2.0);
  b13 = EACH(C[5]) + EACH(C[6]) * b3;
  b14 = EACH(C[4]) + b3 * b13;
  b15 = EACH(C[3]) + b3 * b14;
  b16 = EACH(C[2]) + b3 * b15;
  b17 = EACH(C[1]) + b3 * b16;
  b18 = EACH(C[0]) + b3 * b17;
  b19 = EACH(C[9]) + b3 * b18;
  b20 = EACH(C[8]) + b3 * b19;
  b21 = EACH(C[7]) + b3 * b20;
  b22 = (EACH(1.0) - b3 * b21) / b11 / b11 * GIVEN(20);
  b22 = GIVEN(48) + EACH(0.5) * (b2 * GIVEN(32) + b1 * GIVEN(28) + b0 * GIVEN(24)) - b22;
  b23 = b3 * b22;
  b24 = b3 * b23;
  b25 = b3 * b24;
  b26 = b3 * b25;
  b27 = b3 * b26;
  b28 = b3 * b27;
  b11 = GIVEN(20) / b11;
  b21 = b21 * b11;
  b11 = GIVEN(52) - b3 * b11;
  b21 = b10 * b22 + b9 * b23 + b8 * b24 + b7 * b25 + b6 * b26 + b5 * b27 + b4 * b28 + EACH(C[16]) * (b3 * b28) - b21;
  b28 = b3 * b11;
  b4 = b3 * b28;
  b27 = b3 * b4;
  b5 = b3 * b27;
  b26 = b3 * b5;
  b6 = b3 * b26;
  b25 = b3 * b6;
  b3 = EACH(C[6]) * (b3 * b25);
  b3 = b21 + b20 * b11 + b19 * b28 + b18 * b4 + b17 * b27 + b16 * b5 + b15 * b26 + b14 * b6 + b13 * b25 + b3;
  b2 = GIVEN(44) + b12 * GIVEN(32) + EACH(2.0) * b2 * b3;
  b25 = EACH(C[18]) * b2;
  b0 = GIVEN(36) + b12 * GIVEN(24) + EACH(2.0) * b0 * b3;
  b3 = GIVEN(40) + b12 * GIVEN(28) + EACH(2.0) * b1 * b3;
  b1 = EACH(C[18]) * b3;
  b12 = EACH(C[18]) * b0;
  STORE(made + 0, GIVEN(16) * b25 + b0);
  STORE(made + 4, b3 - GIVEN(12) * b25);
  STORE(made + 8, b2 + GIVEN(12) * b1 - GIVEN(16) * b12);
  STORE(made + 12, GIVEN(8) * b1 - GIVEN(4) * b25);
  STORE(made + 16, GIVEN(0) * b25 - GIVEN(8) * b12);
}

static void MADE(nitinol_wire_derivatives_adj1_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 56, made += 20)
    EVERY_LANE(MADE(nitinol_wire_derivatives_adj1_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32, b33, b34, b35, b36, b37, b38, b39, b40, b41, b42, b43, b44, b45, b46, b47;
  FOUR b48, b49, b50, b51;
  b0 = GIVEN(84) * GIVEN(184) + GIVEN(72) * GIVEN(196);
  b0 = GIVEN(76) * GIVEN(176) + GIVEN(64) * GIVEN(188) + (GIVEN(80) * GIVEN(180) + GIVEN(68) * GIVEN(192)) + b0;
  b1 = GIVEN(40) * GIVEN(76) + GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84);
  b2 = GIVEN(64) * GIVEN(76) + GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84);
  b3 = GIVEN(28) * b1 - GIVEN(20) * b2;
  b4 = GIVEN(32) * GIVEN(32) / EACH(2.0);
  b5 = GIVEN(52) * GIVEN(76) + GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84);
  b6 = GIVEN(36) * b3 - b4 * b5;
  b7 = GIVEN(84) * GIVEN(160) + GIVEN(48) * GIVEN(196);
  b7 = GIVEN(76) * GIVEN(152) + GIVEN(40) * GIVEN(188) + (GIVEN(80) * GIVEN(156) + GIVEN(44) * GIVEN(192)) + b7;
  b8 = b1 * GIVEN(140) + GIVEN(28) * b7 - (b2 * GIVEN(132) + GIVEN(20) * b0);
  b9 = EACH(2.0) * GIVEN(32);
  b10 = EACH(0.5) * (b9 * GIVEN(144));
  b11 = GIVEN(84) * GIVEN(172) + GIVEN(60) * GIVEN(196);
  b11 = GIVEN(76) * GIVEN(164) + GIVEN(52) * GIVEN(188) + (GIVEN(80) * GIVEN(168) + GIVEN(56) * GIVEN(192)) + b11;
  b12 = b3 * GIVEN(148) + GIVEN(36) * b8 - (b5 * b10 + b4 * b11);
  b13 = GIVEN(24) * b2 - GIVEN(28) * b5;
  b14 = GIVEN(36) * b13 - b4 * b1;
  b15 = b2 * GIVEN(136) + GIVEN(24) * b0 - (b5 * GIVEN(140) + GIVEN(28) * b11);
  b16 = b13 * GIVEN(148) + GIVEN(36) * b15 - (b1 * b10 + b4 * b7);
  b17 = EACH(C[18]) * (b0 + (b6 * GIVEN(132) + GIVEN(20) * b12 - (b14 * GIVEN(136) + GIVEN(24) * b16)));
  b18 = EACH(C[18]) * (b2 + (GIVEN(20) * b6 - GIVEN(24) * b14));
  b19 = GIVEN(20) * b5 - GIVEN(24) * b1;
  b20 = GIVEN(36) * b19 - b4 * b2;
  b21 = b5 * GIVEN(132) + GIVEN(20) * b11 - (b1 * GIVEN(136) + GIVEN(24) * b7);
  b22 = b19 * GIVEN(148) + GIVEN(36) * b21 - (b2 * b10 + b4 * b0);
  b23 = EACH(C[18]) * (b11 + (b14 * GIVEN(140) + GIVEN(28) * b16 - (b20 * GIVEN(132) + GIVEN(20) * b22)));
  b24 = EACH(C[18]) * (b5 + (GIVEN(28) * b14 - GIVEN(20) * b20));
  b25 = EACH(C[18]) * (b7 + (b20 * GIVEN(136) + GIVEN(24) * b22 - (b6 * GIVEN(140) + GIVEN(28) * b12)));
  b26 = EACH(C[18]) * (b1 + (GIVEN(24) * b20 - GIVEN(28) * b6));
  b27 = EACH(C[18]) * (GIVEN(4) * GIVEN(108) - GIVEN(8) * GIVEN(104) - GIVEN(16) * GIVEN(96)) + GIVEN(88);
  b28 = EACH(C[18]) * (GIVEN(8) * GIVEN(100) - GIVEN(0) * GIVEN(108) + GIVEN(12) * GIVEN(96)) + GIVEN(92);
  b29 = GIVEN(24) * b27 - GIVEN(20) * b28;
  b30 = GIVEN(36) * b29;
  b31 = GIVEN(96) * GIVEN(128) + GIVEN(16) * GIVEN(208);
  b31 = GIVEN(108) * GIVEN(116) + GIVEN(4) * GIVEN(220) - (GIVEN(104) * GIVEN(120) + GIVEN(8) * GIVEN(216)) - b31;
  b31 = EACH(C[18]) * b31 + GIVEN(200);
  b32 = GIVEN(96) * GIVEN(124) + GIVEN(12) * GIVEN(208);
  b32 = GIVEN(100) * GIVEN(120) + GIVEN(8) * GIVEN(212) - (GIVEN(108) * GIVEN(112) + GIVEN(0) * GIVEN(220)) + b32;
  b32 = EACH(C[18]) * b32 + GIVEN(204);
  b33 = b27 * GIVEN(136) + GIVEN(24) * b31 - (b28 * GIVEN(132) + GIVEN(20) * b32);
  b34 = b29 * GIVEN(148) + GIVEN(36) * b33;
  b35 = EACH(C[18]) * (GIVEN(0) * GIVEN(104) - GIVEN(4) * GIVEN(100) - GIVEN(12) * GIVEN(92) + GIVEN(16) * GIVEN(88));
  b35 = GIVEN(96) + b35;
  b36 = GIVEN(92) * GIVEN(124) + GIVEN(12) * GIVEN(204);
  b36 = GIVEN(104) * GIVEN(112) + GIVEN(0) * GIVEN(216) - (GIVEN(100) * GIVEN(116) + GIVEN(4) * GIVEN(212)) - b36;
  b36 = GIVEN(208) + EACH(C[18]) * (b36 + (GIVEN(88) * GIVEN(128) + GIVEN(16) * GIVEN(200)));
  b37 = GIVEN(20) * b35 - GIVEN(28) * b27;
  b38 = GIVEN(36) * b37;
  b39 = b35 * GIVEN(132) + GIVEN(20) * b36 - (b27 * GIVEN(140) + GIVEN(28) * b31);
  b40 = b37 * GIVEN(148) + GIVEN(36) * b39;
  b41 = GIVEN(28) * b28 - GIVEN(24) * b35;
  b42 = GIVEN(36) * b41;
  b43 = b28 * GIVEN(140) + GIVEN(28) * b32 - (b35 * GIVEN(136) + GIVEN(24) * b36);
  b44 = b41 * GIVEN(148) + GIVEN(36) * b43;
  b9 = b9 * (EACH(0.5) * (b29 * b0 + b2 * b33 + (b41 * b7 + b1 * b43) + (b37 * b11 + b5 * b39)));
  b45 = b27 - GIVEN(24) * b30 - b4 * b41 + GIVEN(28) * b38;
  b46 = b31 - (b30 * GIVEN(136) + GIVEN(24) * b34) - (b41 * b10 + b4 * b43) + (b38 * GIVEN(140) + GIVEN(28) * b40);
  b47 = b28 + GIVEN(20) * b30 - GIVEN(28) * b42 - b4 * b37;
  b48 = b32 + (b30 * GIVEN(132) + GIVEN(20) * b34) - (b42 * GIVEN(140) + GIVEN(28) * b44) - (b37 * b10 + b4 * b39);
  b49 = b35 - b4 * b29 + GIVEN(24) * b42 - GIVEN(20) * b38;
  b4 = b36 - (b29 * b10 + b4 * b33) + (b42 * GIVEN(136) + GIVEN(24) * b44) - (b38 * GIVEN(132) + GIVEN(20) * b40);
  b10 = b49 * GIVEN(176) + GIVEN(64) * b4;
  b50 = b49 * GIVEN(180) + GIVEN(68) * b4;
  b51 = b49 * GIVEN(184) + GIVEN(72) * b4;
  STORE(made + 0, GIVEN(104) * b17 + b18 * GIVEN(216) - (GIVEN(108) * b23 + b24 * GIVEN(220)));
  STORE(made + 4, GIVEN(108) * b25 + b26 * GIVEN(220) - (GIVEN(100) * b17 + b18 * GIVEN(212)));
  STORE(made + 8, GIVEN(100) * b23 + b24 * GIVEN(212) - (GIVEN(104) * b25 + b26 * GIVEN(216)));
  STORE(made + 12, GIVEN(96) * b23 + b24 * GIVEN(208) - (GIVEN(92) * b17 + b18 * GIVEN(204)));
  STORE(made + 16, GIVEN(88) * b17 + b18 * GIVEN(200) - (GIVEN(96) * b25 + b26 * GIVEN(208)));
  b26 = b30 * b11 + b5 * b34 - (b28 * b22 + b20 * b32) + (b35 * b12 + b6 * b36) - (b38 * b0 + b2 * b40);
  STORE(made + 20, b26);
  b0 = b27 * b22 + b20 * b31 - (b30 * b7 + b1 * b34) - (b35 * b16 + b14 * b36) + (b42 * b0 + b2 * b44);
  STORE(made + 24, b0);
  b40 = b28 * b16 + b14 * b32 - (b27 * b12 + b6 * b31) - (b42 * b11 + b5 * b44) + (b38 * b7 + b1 * b40);
  STORE(made + 28, b40);
  b9 = EACH((-1.0)) * (EACH(0.5) * (b2 * b29 + b1 * b41 + b5 * b37) * (EACH(2.0) * GIVEN(144)) + b9);
  STORE(made + 32, b9);
  STORE(made + 36, b29 * b21 + b19 * b33 + (b41 * b15 + b13 * b43) + (b37 * b8 + b3 * b39));
  STORE(made + 40, b45 * GIVEN(188) + GIVEN(76) * b46);
  STORE(made + 44, b45 * GIVEN(192) + GIVEN(80) * b46);
  STORE(made + 48, b45 * GIVEN(196) + GIVEN(84) * b46);
  STORE(made + 52, b47 * GIVEN(188) + GIVEN(76) * b48);
  STORE(made + 56, b47 * GIVEN(192) + GIVEN(80) * b48);
  STORE(made + 60, b47 * GIVEN(196) + GIVEN(84) * b48);
  STORE(made + 64, b49 * GIVEN(188) + GIVEN(76) * b4);
  STORE(made + 68, b49 * GIVEN(192) + GIVEN(80) * b4);
  STORE(made + 72, b49 * GIVEN(196) + GIVEN(84) * b4);
  STORE(made + 76, b47 * GIVEN(164) + GIVEN(52) * b48 + (b45 * GIVEN(152) + GIVEN(40) * b46) + b10);
  STORE(made + 80, b47 * GIVEN(168) + GIVEN(56) * b48 + (b45 * GIVEN(156) + GIVEN(44) * b46) + b50);
  STORE(made + 84, b47 * GIVEN(172) + GIVEN(60) * b48 + (b45 * GIVEN(160) + GIVEN(48) * b46) + b51);
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 224, made += 88)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_adj1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32, b33, b34, b35, b36, b37, b38, b39, b40, b41, b42, b43, b44, b45, b46, b47;
  FOUR b48, b49, b50, b51, b52, b53, b54, b55, b56, b57, b58, b59, b60, b61, b62, b63;
  FOUR b64, b65, b66;
  b0 = GIVEN(0) - GIVEN(8) * GIVEN(16) / EACH(12.0);
  b1 = GIVEN(4) + GIVEN(8) * GIVEN(12) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH(C[15]) + EACH(C[16]) * b3;
  b5 = EACH(C[14]) + b3 * b4;
  b6 = EACH(C[13]) + b3 * b5;
  b7 = EACH(C[12]) + b3 * b6;
  b8 = EACH(C[11]) + b3 * b7;
  b9 = EACH(C[10]) + b3 * b8;
  b10 = EACH(C[17]) + b3 * b9;
  b11 = EACH(1.0) + b3 * b10;
  b12 = b11 / EACH(2.0);
  b13 = EACH(2.0) * b2;
  b14 = EACH(C[5]) + EACH(C[6]) * b3;
  b15 = EACH(C[4]) + b3 * b14;
  b16 = EACH(C[3]) + b3 * b15;
  b17 = EACH(C[2]) + b3 * b16;
  b18 = EACH(C[1]) + b3 * b17;
  b19 = EACH(C[0]) + b3 * b18;
  b20 = EACH(C[9]) + b3 * b19;
  b21 = EACH(C[8]) + b3 * b20;
  b22 = EACH(C[7]) + b3 * b21;
  b23 = (EACH(1.0) - b3 * b22) / b11 / b11;
  b24 = GIVEN(48) + EACH(0.5) * (b2 * GIVEN(32) + b1 * GIVEN(28) + b0 * GIVEN(24)) - b23 * GIVEN(20);
  b25 = b3 * b24;
  b26 = b3 * b25;
  b27 = b3 * b26;
  b28 = b3 * b27;
  b29 = b3 * b28;
  b30 = b3 * b29;
  b31 = GIVEN(20) / b11;
  b32 = b22 * b31;
  b33 = GIVEN(52) - b3 * b31;
  b32 = b10 * b24 + b9 * b25 + b8 * b26 + b7 * b27 + b6 * b28 + b5 * b29 + b4 * b30 + EACH(C[16]) * (b3 * b30) - b32;
  b34 = b3 * b33;
  b35 = b3 * b34;
  b36 = b3 * b35;
  b37 = b3 * b36;
  b38 = b3 * b37;
  b39 = b3 * b38;
  b40 = b3 * b39;
  b41 = EACH(C[6]) * (b3 * b40);
  b41 = b32 + b21 * b33 + b20 * b34 + b19 * b35 + b18 * b36 + b17 * b37 + b16 * b38 + b15 * b39 + b14 * b40 + b41;
  b32 = EACH(C[18]) * (GIVEN(44) + b12 * GIVEN(32) + b13 * b41);
  b42 = EACH(2.0) * b0;
  b43 = GIVEN(56) - EACH(C[18]) * (GIVEN(16) * GIVEN(64) + GIVEN(8) * GIVEN(72));
  b44 = EACH(2.0) * b1;
  b45 = GIVEN(60) + EACH(C[18]) * (GIVEN(12) * GIVEN(64) + GIVEN(8) * GIVEN(68));
  b46 = EACH(C[18]) * (GIVEN(16) * GIVEN(56) + GIVEN(0) * GIVEN(72) - (GIVEN(12) * GIVEN(60) + GIVEN(4) * GIVEN(68)));
  b46 = GIVEN(64) + b46;
  b47 = b42 * b43 + b44 * b45 + b13 * b46;
  b48 = EACH(C[16]) * b47;
  b49 = b4 * b47 + b3 * b48;
  b50 = b5 * b47 + b3 * b49;
  b51 = b6 * b47 + b3 * b50;
  b52 = b7 * b47 + b3 * b51;
  b53 = b8 * b47 + b3 * b52;
  b54 = b9 * b47 + b3 * b53;
  b55 = b10 * b47 + b3 * b54;
  b56 = EACH(0.5) * b55;
  b0 = GIVEN(32) * b46 + b2 * GIVEN(88) + (GIVEN(28) * b45 + b1 * GIVEN(84)) + (GIVEN(24) * b43 + b0 * GIVEN(80));
  b1 = EACH(C[6]) * b47;
  b2 = b14 * b47 + b3 * b1;
  b57 = b15 * b47 + b3 * b2;
  b58 = b16 * b47 + b3 * b57;
  b59 = b17 * b47 + b3 * b58;
  b60 = b18 * b47 + b3 * b59;
  b61 = b19 * b47 + b3 * b60;
  b62 = b20 * b47 + b3 * b61;
  b63 = b21 * b47 + b3 * b62;
  b23 = b23 * GIVEN(76) - GIVEN(20) * (((b22 * b47 + b3 * b63) / b11 + b23 * b55) / b11 + b23 / b11 * b55);
  b23 = GIVEN(104) + EACH(0.5) * b0 - b23;
  b0 = b24 * b47 + b3 * b23;
  b64 = b25 * b47 + b3 * b0;
  b65 = b26 * b47 + b3 * b64;
  b66 = b27 * b47 + b3 * b65;
  b6 = b28 * b50 + b6 * b66;
  b66 = b28 * b47 + b3 * b66;
  b6 = b24 * b54 + b10 * b23 + (b25 * b53 + b9 * b0) + (b26 * b52 + b8 * b64) + (b27 * b51 + b7 * b65) + b6;
  b65 = b29 * b47 + b3 * b66;
  b55 = GIVEN(76) / b11 - b31 / b11 * b55;
  b22 = b31 * b63 + b22 * b55;
  b55 = GIVEN(108) - (b31 * b47 + b3 * b55);
  b21 = b33 * b62 + b21 * b55;
  b55 = b33 * b47 + b3 * b55;
  b20 = b34 * b61 + b20 * b55;
  b55 = b34 * b47 + b3 * b55;
  b20 = b6 + (b29 * b49 + b5 * b66) + (b30 * b48 + b4 * b65) + EACH(C[16]) * (b30 * b47 + b3 * b65) - b22 + b21 + b20;
  b21 = b35 * b47 + b3 * b55;
  b22 = b36 * b47 + b3 * b21;
  b65 = b37 * b47 + b3 * b22;
  b4 = b38 * b47 + b3 * b65;
  b65 = b20 + (b35 * b60 + b19 * b55) + (b36 * b59 + b18 * b21) + (b37 * b58 + b17 * b22) + (b38 * b57 + b16 * b65);
  b16 = b39 * b47 + b3 * b4;
  b3 = b65 + (b39 * b2 + b15 * b4) + (b40 * b1 + b14 * b16) + EACH(C[6]) * (b40 * b47 + b3 * b16);
  b13 = GIVEN(100) + (GIVEN(32) * b56 + b12 * GIVEN(88)) + (b41 * (EACH(2.0) * b46) + b13 * b3);
  b46 = EACH(C[18]) * b13;
  b43 = GIVEN(92) + (GIVEN(24) * b56 + b12 * GIVEN(80)) + (b41 * (EACH(2.0) * b43) + b42 * b3);
  b3 = GIVEN(96) + (GIVEN(28) * b56 + b12 * GIVEN(84)) + (b41 * (EACH(2.0) * b45) + b44 * b3);
  b44 = EACH(C[18]) * (GIVEN(40) + b12 * GIVEN(28) + b44 * b41);
  b45 = EACH(C[18]) * b3;
  b41 = EACH(C[18]) * (GIVEN(36) + b12 * GIVEN(24) + b42 * b41);
  b42 = EACH(C[18]) * b43;
  STORE(made + 0, b32 * GIVEN(72) + GIVEN(16) * b46 + b43);
  STORE(made + 4, b3 - (b32 * GIVEN(68) + GIVEN(12) * b46));
  STORE(made + 8, b13 + (b44 * GIVEN(68) + GIVEN(12) * b45) - (b41 * GIVEN(72) + GIVEN(16) * b42));
  STORE(made + 12, b44 * GIVEN(64) + GIVEN(8) * b45 - (b32 * GIVEN(60) + GIVEN(4) * b46));
  STORE(made + 16, b32 * GIVEN(56) + GIVEN(0) * b46 - (b41 * GIVEN(64) + GIVEN(8) * b42));
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 112, made += 20)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_adj1_increments_turn)(given + lane, made + lane))
}
