/* Included once for each width of vectors. */
static void MADE(precurved_tube_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = GIVEN(0) + (GIVEN(4) * GIVEN(20) - GIVEN(8) * GIVEN(16)) / EACH(12.0);
  b1 = GIVEN(4) + (GIVEN(8) * GIVEN(12) - GIVEN(0) * GIVEN(20)) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH((-2.8114572543455206e-15)) + b3 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3);
  b4 = b3 * (EACH((-1.6059043836821613e-10)) + b3 * (EACH(7.647163731819816e-13) + b3 * b4));
  b4 = b3 * (EACH((-2.7557319223985893e-06)) + b3 * (EACH(2.505210838544172e-08) + b4));
  b4 = EACH(0.16666666666666666) + b3 * (EACH((-0.008333333333333333)) + b3 * (EACH(0.0001984126984126984) + b4));
  b5 = EACH(3.920664999224027e-14) + b3 * (EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3);
  b5 = b3 * (EACH(1.076457782186949e-08) + b3 * (EACH((-2.446494959515793e-11)) + b3 * b5));
  b5 = b3 * (EACH(0.0005208333333333333) + b3 * (EACH((-3.1001984126984127e-06)) + b5));
  b5 = EACH(1.0) + b3 * (EACH((-0.041666666666666664)) + b5);
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
  b7 = EACH(0.08333333333333333) * b6;
  b0 = GIVEN(40) * (GIVEN(24) * b3 - GIVEN(28) * b1) - b2 * b0;
  b5 = b3 + (GIVEN(32) * b5 - GIVEN(24) * b0);
  b3 = EACH(0.08333333333333333) * b5;
  b4 = b1 + (GIVEN(28) * b0 - GIVEN(32) * b4);
  b0 = EACH(0.08333333333333333) * b4;
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
  b15 = EACH(0.08333333333333333) * GIVEN(20);
  b10 = b10 + b0 * GIVEN(24);
  b13 = b0 * GIVEN(28) - b13;
  b8 = EACH(1.0) - (b3 + b8);
  b3 = GIVEN(44) * b10 + GIVEN(56) * b13 + GIVEN(68) * b8;
  b0 = EACH(0.08333333333333333) * GIVEN(16);
  b16 = GIVEN(48) * b4 + GIVEN(60) * b9 + GIVEN(72) * b11;
  b17 = GIVEN(48) * b7 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b18 = GIVEN(48) * b10 + GIVEN(60) * b13 + GIVEN(72) * b8;
  b11 = GIVEN(52) * b4 + GIVEN(64) * b9 + GIVEN(76) * b11;
  b2 = GIVEN(52) * b7 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b8 = GIVEN(52) * b10 + GIVEN(64) * b13 + GIVEN(76) * b8;
  b13 = EACH(0.08333333333333333) * GIVEN(12);
  b10 = EACH(0.08333333333333333) * GIVEN(8);
  b1 = EACH(0.08333333333333333) * GIVEN(4);
  b7 = EACH(0.08333333333333333) * GIVEN(0);
  b9 = GIVEN(52) * GIVEN(24) + GIVEN(64) * GIVEN(28) + GIVEN(76) * GIVEN(32);
  b5 = EACH(0.5) / b5;
  b4 = GIVEN(44) * GIVEN(24) + GIVEN(56) * GIVEN(28) + GIVEN(68) * GIVEN(32);
  b19 = GIVEN(48) * GIVEN(24) + GIVEN(60) * GIVEN(28) + GIVEN(72) * GIVEN(32);
  b20 = b4 * b4 + b19 * b19 + b9 * b9;
  b21 = EACH((-2.186688975602072e-15)) + b20 * (EACH(6.576508197299464e-18) + EACH((-1.6014224506411032e-20)) * b20);
  b21 = b20 * (EACH((-1.1470745597729724e-10)) + b20 * (EACH(5.735372798864862e-13) + b20 * b21));
  b21 = b20 * (EACH((-1.6534391534391535e-06)) + b20 * (EACH(1.670140559029448e-08) + b21));
  b21 = EACH((-0.002777777777777778)) + b20 * (EACH(9.92063492063492e-05) + b21);
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
  b33 = EACH(0.08333333333333333) * (b9 + (GIVEN(24) * b31 - GIVEN(28) * b32));
  b9 = GIVEN(40) * (GIVEN(24) * b30 - GIVEN(28) * b19) - b6 * b9;
  b32 = EACH(0.08333333333333333) * (b30 + (GIVEN(32) * b32 - GIVEN(24) * b9));
  b30 = EACH((-1.0)) * b32;
  b6 = EACH((-1.0)) * b33;
  b31 = EACH(0.08333333333333333) * (b19 + (GIVEN(28) * b9 - GIVEN(32) * b31));
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
  b8 = EACH(0.08333333333333333) * (b0 + (GIVEN(24) * b5 - GIVEN(28) * b7));
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
  b14 = EACH(0.08333333333333333) * b13;
  b15 = GIVEN(24) * b4 - GIVEN(28) * b1;
  b16 = GIVEN(40) * b15 - b3 * b0;
  b17 = EACH(0.08333333333333333) * (b4 + (GIVEN(32) * b7 - GIVEN(24) * b16));
  b4 = b15 * GIVEN(132) + GIVEN(40) * (b4 * GIVEN(116) + GIVEN(24) * b12 - (b1 * GIVEN(120) + GIVEN(28) * b10));
  b9 = b4 - (b0 * b11 + b3 * b9);
  b6 = b12 + (b7 * GIVEN(124) + GIVEN(32) * b6 - (b16 * GIVEN(116) + GIVEN(24) * b9));
  b7 = EACH(0.08333333333333333) * b6;
  b2 = b10 + (b16 * GIVEN(120) + GIVEN(28) * b9 - (b5 * GIVEN(124) + GIVEN(32) * b2));
  b5 = EACH(0.08333333333333333) * (b1 + (GIVEN(28) * b16 - GIVEN(32) * b5));
  b16 = EACH(0.08333333333333333) * b2;
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
  b13 = EACH(0.08333333333333333) * GIVEN(20);
  b9 = b9 + b0 * GIVEN(24);
  b5 = b0 * GIVEN(28) - b5;
  b7 = EACH(1.0) - (b3 + b7);
  b3 = GIVEN(44) * b9 + GIVEN(56) * b5 + GIVEN(68) * b7;
  b0 = EACH(0.08333333333333333) * GIVEN(16);
  b14 = GIVEN(48) * b4 + GIVEN(60) * b8 + GIVEN(72) * b10;
  b15 = GIVEN(48) * b6 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b16 = GIVEN(48) * b9 + GIVEN(60) * b5 + GIVEN(72) * b7;
  b10 = GIVEN(52) * b4 + GIVEN(64) * b8 + GIVEN(76) * b10;
  b2 = GIVEN(52) * b6 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b7 = GIVEN(52) * b9 + GIVEN(64) * b5 + GIVEN(76) * b7;
  b5 = EACH(0.08333333333333333) * GIVEN(12);
  b9 = EACH(0.08333333333333333) * GIVEN(8);
  b1 = EACH(0.08333333333333333) * GIVEN(4);
  b6 = EACH(0.08333333333333333) * GIVEN(0);
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
  FOUR b16, b17, b18, b19;
  b0 = w[374] * TURN(140);
  b0 = w[314] * TURN(0) + w[326] * TURN(28) + w[338] * TURN(56) + w[350] * TURN(84) + w[362] * TURN(112) + b0;
  STORE(passed + 16, b0);
  b1 = w[375] * TURN(144);
  b1 = w[315] * TURN(4) + w[327] * TURN(32) + w[339] * TURN(60) + w[351] * TURN(88) + w[363] * TURN(116) + b1;
  STORE(passed + 112, b1);
  b1 = b0 + b1;
  STORE(passed + 84, b1);
  b2 = w[376] * TURN(148);
  b2 = w[316] * TURN(8) + w[328] * TURN(36) + w[340] * TURN(64) + w[352] * TURN(92) + w[364] * TURN(120) + b2;
  STORE(passed + 144, b2);
  b2 = b1 + b2;
  STORE(passed + 72, b2);
  b3 = w[377] * TURN(152);
  b3 = w[317] * TURN(12) + w[329] * TURN(40) + w[341] * TURN(68) + w[353] * TURN(96) + w[365] * TURN(124) + b3;
  STORE(passed + 200, b3);
  b3 = b2 + b3;
  STORE(passed + 60, b3);
  b4 = w[530] * TURN(156);
  b4 = w[470] * TURN(16) + w[482] * TURN(44) + w[494] * TURN(72) + w[506] * TURN(100) + w[518] * TURN(128) + b4;
  STORE(passed + 160, b4);
  b4 = b3 + b4;
  STORE(passed + 48, b4);
  b5 = w[531] * TURN(160);
  b5 = w[471] * TURN(20) + w[483] * TURN(48) + w[495] * TURN(76) + w[507] * TURN(104) + w[519] * TURN(132) + b5;
  STORE(passed + 128, b5);
  b5 = b4 + b5;
  STORE(passed + 36, b5);
  b6 = w[532] * TURN(164);
  b6 = w[472] * TURN(24) + w[484] * TURN(52) + w[496] * TURN(80) + w[508] * TURN(108) + w[520] * TURN(136) + b6;
  STORE(passed + 100, b6);
  b6 = b5 + b6;
  STORE(passed + 24, b6);
  b7 = w[370] * TURN(140);
  b7 = w[310] * TURN(0) + w[322] * TURN(28) + w[334] * TURN(56) + w[346] * TURN(84) + w[358] * TURN(112) + b7;
  STORE(passed + 12, b7);
  b8 = w[371] * TURN(144);
  b8 = w[311] * TURN(4) + w[323] * TURN(32) + w[335] * TURN(60) + w[347] * TURN(88) + w[359] * TURN(116) + b8;
  STORE(passed + 108, b8);
  b8 = b7 + b8;
  STORE(passed + 80, b8);
  b9 = w[372] * TURN(148);
  b9 = w[312] * TURN(8) + w[324] * TURN(36) + w[336] * TURN(64) + w[348] * TURN(92) + w[360] * TURN(120) + b9;
  STORE(passed + 140, b9);
  b9 = b8 + b9;
  STORE(passed + 68, b9);
  b10 = w[373] * TURN(152);
  b10 = w[313] * TURN(12) + w[325] * TURN(40) + w[337] * TURN(68) + w[349] * TURN(96) + w[361] * TURN(124) + b10;
  STORE(passed + 196, b10);
  b10 = b9 + b10;
  STORE(passed + 56, b10);
  b11 = w[526] * TURN(156);
  b11 = w[466] * TURN(16) + w[478] * TURN(44) + w[490] * TURN(72) + w[502] * TURN(100) + w[514] * TURN(128) + b11;
  STORE(passed + 156, b11);
  b11 = b10 + b11;
  STORE(passed + 44, b11);
  b12 = w[527] * TURN(160);
  b12 = w[467] * TURN(20) + w[479] * TURN(48) + w[491] * TURN(76) + w[503] * TURN(104) + w[515] * TURN(132) + b12;
  STORE(passed + 124, b12);
  b12 = b11 + b12;
  STORE(passed + 32, b12);
  b13 = w[528] * TURN(164);
  b13 = w[468] * TURN(24) + w[480] * TURN(52) + w[492] * TURN(80) + w[504] * TURN(108) + w[516] * TURN(136) + b13;
  STORE(passed + 96, b13);
  b13 = b12 + b13;
  STORE(passed + 20, b13);
  b14 = w[378] * TURN(140);
  b14 = w[318] * TURN(0) + w[330] * TURN(28) + w[342] * TURN(56) + w[354] * TURN(84) + w[366] * TURN(112) + b14;
  STORE(passed + 0, b14);
  b15 = w[379] * TURN(144);
  b15 = w[319] * TURN(4) + w[331] * TURN(32) + w[343] * TURN(60) + w[355] * TURN(88) + w[367] * TURN(116) + b15;
  STORE(passed + 116, b15);
  b15 = b14 + b15;
  STORE(passed + 88, b15);
  b14 = w[380] * TURN(148);
  b14 = w[320] * TURN(8) + w[332] * TURN(36) + w[344] * TURN(64) + w[356] * TURN(92) + w[368] * TURN(120) + b14;
  STORE(passed + 148, b14);
  b14 = b15 + b14;
  STORE(passed + 76, b14);
  b16 = w[381] * TURN(152);
  b16 = w[321] * TURN(12) + w[333] * TURN(40) + w[345] * TURN(68) + w[357] * TURN(96) + w[369] * TURN(124) + b16;
  STORE(passed + 204, b16);
  b16 = b14 + b16;
  STORE(passed + 64, b16);
  b17 = w[534] * TURN(156);
  b17 = w[474] * TURN(16) + w[486] * TURN(44) + w[498] * TURN(72) + w[510] * TURN(100) + w[522] * TURN(128) + b17;
  STORE(passed + 164, b17);
  b17 = b16 + b17;
  STORE(passed + 52, b17);
  b18 = w[535] * TURN(160);
  b18 = w[475] * TURN(20) + w[487] * TURN(48) + w[499] * TURN(76) + w[511] * TURN(104) + w[523] * TURN(132) + b18;
  STORE(passed + 132, b18);
  b18 = b17 + b18;
  STORE(passed + 40, b18);
  b19 = w[536] * TURN(164);
  b19 = w[476] * TURN(24) + w[488] * TURN(52) + w[500] * TURN(80) + w[512] * TURN(108) + w[524] * TURN(136) + b19;
  STORE(passed + 104, b19);
  b19 = b18 + b19;
  STORE(passed + 28, b19);
  b19 = w[848] * b6 - w[891] * b13 + w[934] * b19;
  STORE(passed + 92, b19);
  b18 = b19 + (w[935] * b5 - w[936] * b12 + w[937] * b18);
  STORE(passed + 120, b18);
  b17 = b18 + (w[938] * b4 - w[939] * b11 + w[940] * b17);
  STORE(passed + 152, b17);
  b16 = b17 + (w[941] * b3 - w[942] * b10 + w[943] * b16);
  STORE(passed + 192, b16);
  b14 = b16 + (w[944] * b2 - w[945] * b9 + w[946] * b14);
  STORE(passed + 136, b14);
  STORE(passed + 8, b14 + (w[947] * b1 - w[948] * b8 + w[949] * b15));
  STORE(passed + 4, w[950] * b0 - w[951] * b7);
}

static void MADE(precurved_tube_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11;
  b0 = PASSED(8) + (PASSED(4) + w[952] * PASSED(0)) + w[382] * PASSED(12) + w[394] * PASSED(16) + w[406] * PASSED(0);
  STORE(passed + 232, b0);
  b1 = w[956] * PASSED(20) - w[957] * PASSED(24) + w[958] * PASSED(28);
  b2 = b1 + (w[959] * PASSED(32) - w[960] * PASSED(36) + w[961] * PASSED(40));
  b3 = b2 + (w[962] * PASSED(44) - w[963] * PASSED(48) + w[964] * PASSED(52));
  STORE(passed + 172, b3);
  b3 = b3 + (w[965] * PASSED(56) - w[966] * PASSED(60) + w[967] * PASSED(64));
  STORE(passed + 208, b3);
  b3 = b3 + (w[968] * PASSED(68) - w[969] * PASSED(72) + w[970] * PASSED(76));
  b4 = b3 + (w[971] * PASSED(80) - w[972] * PASSED(84) + w[973] * PASSED(88));
  b5 = w[398] * PASSED(16);
  b6 = w[410] * PASSED(0);
  b6 = b4 + (w[974] * PASSED(12) - w[975] * PASSED(16) + w[976] * PASSED(0)) + w[386] * PASSED(12) + b5 + b6;
  STORE(passed + 236, b6);
  b5 = w[980] * PASSED(20) + w[981] * PASSED(24) - w[982] * PASSED(28);
  b7 = b5 + (w[983] * PASSED(32) + w[984] * PASSED(36) - w[985] * PASSED(40));
  b8 = b7 + (w[986] * PASSED(44) + w[987] * PASSED(48) - w[988] * PASSED(52));
  STORE(passed + 180, b8);
  b8 = b8 + (w[989] * PASSED(56) + w[990] * PASSED(60) - w[991] * PASSED(64));
  STORE(passed + 212, b8);
  b8 = b8 + (w[992] * PASSED(68) + w[993] * PASSED(72) - w[994] * PASSED(76));
  b9 = b8 + (w[995] * PASSED(80) + w[996] * PASSED(84) - w[997] * PASSED(88));
  b10 = w[402] * PASSED(16);
  b11 = w[414] * PASSED(0);
  b11 = b9 + (w[998] * PASSED(12) + w[999] * PASSED(16) - w[1000] * PASSED(0)) + w[390] * PASSED(12) + b10 + b11;
  STORE(passed + 240, b11);
  b11 = w[310] * b0 + w[314] * b6 + w[318] * b11 + w[450] * TURN(112) + w[458] * TURN(140);
  STORE(passed + 216, b11);
  b6 = w[564] * PASSED(104);
  b6 = w[287] * PASSED(40) - w[303] * PASSED(36) + PASSED(92) + w[540] * PASSED(96) + w[552] * PASSED(100) + b6;
  STORE(passed + 244, b6);
  b0 = w[568] * PASSED(104);
  b0 = w[303] * PASSED(32) - w[260] * PASSED(40) + b1 + w[544] * PASSED(96) + w[556] * PASSED(100) + b0;
  STORE(passed + 248, b0);
  b1 = w[572] * PASSED(104);
  b1 = w[260] * PASSED(36) - w[287] * PASSED(32) + b5 + w[548] * PASSED(96) + w[560] * PASSED(100) + b1;
  STORE(passed + 252, b1);
  b1 = w[468] * b6 + w[472] * b0 + w[476] * b1 + w[608] * TURN(136) + w[616] * TURN(164);
  STORE(passed + 220, b1);
  b1 = b11 + b1;
  STORE(passed + 296, b1);
  b11 = w[407] * PASSED(116);
  b11 = w[300] * PASSED(0) - w[308] * PASSED(16) + PASSED(8) + w[383] * PASSED(108) + w[395] * PASSED(112) + b11;
  STORE(passed + 256, b11);
  b0 = w[411] * PASSED(116);
  b0 = w[308] * PASSED(12) - w[281] * PASSED(0) + b4 + w[387] * PASSED(108) + w[399] * PASSED(112) + b0;
  STORE(passed + 260, b0);
  b4 = w[415] * PASSED(116);
  b4 = w[281] * PASSED(16) - w[300] * PASSED(12) + b9 + w[391] * PASSED(108) + w[403] * PASSED(112) + b4;
  STORE(passed + 264, b4);
  b4 = w[311] * b11 + w[315] * b0 + w[319] * b4 + w[451] * TURN(116) + w[459] * TURN(144);
  STORE(passed + 224, b4);
  b0 = w[563] * PASSED(132);
  b0 = w[290] * PASSED(52) - w[304] * PASSED(48) + PASSED(120) + w[539] * PASSED(124) + w[551] * PASSED(128) + b0;
  STORE(passed + 268, b0);
  b11 = w[567] * PASSED(132);
  b11 = w[304] * PASSED(44) - w[265] * PASSED(52) + b2 + w[543] * PASSED(124) + w[555] * PASSED(128) + b11;
  STORE(passed + 272, b11);
  b2 = w[571] * PASSED(132);
  b2 = w[265] * PASSED(48) - w[290] * PASSED(44) + b7 + w[547] * PASSED(124) + w[559] * PASSED(128) + b2;
  STORE(passed + 276, b2);
  b2 = w[467] * b0 + w[471] * b11 + w[475] * b2 + w[607] * TURN(132) + w[615] * TURN(160);
  STORE(passed + 228, b2);
  b2 = b4 + b2;
  STORE(passed + 300, b2);
  STORE(passed + 188, EACH((-0.3078728181867266)) * b1 + EACH((-0.862640467105971)) * b2);
  b2 = w[408] * PASSED(148);
  b2 = w[298] * PASSED(88) - w[307] * PASSED(84) + PASSED(136) + w[384] * PASSED(140) + w[396] * PASSED(144) + b2;
  STORE(passed + 280, b2);
  b1 = w[412] * PASSED(148);
  b1 = w[307] * PASSED(80) - w[278] * PASSED(88) + b3 + w[388] * PASSED(140) + w[400] * PASSED(144) + b1;
  STORE(passed + 284, b1);
  b3 = w[416] * PASSED(148);
  b3 = w[278] * PASSED(84) - w[298] * PASSED(80) + b8 + w[392] * PASSED(140) + w[404] * PASSED(144) + b3;
  STORE(passed + 288, b3);
  STORE(passed + 184, w[312] * b2 + w[316] * b1 + w[320] * b3 + w[452] * TURN(120) + w[460] * TURN(148));
  b3 = w[562] * PASSED(164);
  b3 = w[293] * PASSED(64) - w[305] * PASSED(60) + PASSED(152) + w[538] * PASSED(156) + w[550] * PASSED(160) + b3;
  STORE(passed + 292, b3);
  STORE(passed + 176, w[466] * b3);
  STORE(passed + 168, w[305] * PASSED(56) - w[270] * PASSED(64));
}

static void MADE(precurved_tube_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20;
  b0 = PASSED(168) + PASSED(172) + w[542] * PASSED(156) + w[554] * PASSED(160) + w[566] * PASSED(164);
  STORE(passed + 312, b0);
  b1 = w[570] * PASSED(164);
  b1 = w[270] * PASSED(60) - w[293] * PASSED(56) + PASSED(180) + w[546] * PASSED(156) + w[558] * PASSED(160) + b1;
  STORE(passed + 316, b1);
  b2 = PASSED(176) + w[470] * b0 + w[474] * b1 + w[606] * TURN(128) + w[614] * TURN(156);
  b3 = PASSED(184) + b2;
  b4 = w[409] * PASSED(204);
  b4 = w[296] * PASSED(76) - w[306] * PASSED(72) + PASSED(192) + w[385] * PASSED(196) + w[397] * PASSED(200) + b4;
  STORE(passed + 320, b4);
  b5 = w[413] * PASSED(204);
  b5 = w[306] * PASSED(68) - w[275] * PASSED(76) + PASSED(208) + w[389] * PASSED(196) + w[401] * PASSED(200) + b5;
  STORE(passed + 324, b5);
  b6 = w[417] * PASSED(204);
  b6 = w[275] * PASSED(72) - w[296] * PASSED(68) + PASSED(212) + w[393] * PASSED(196) + w[405] * PASSED(200) + b6;
  STORE(passed + 328, b6);
  b7 = w[313] * b4 + w[317] * b5 + w[321] * b6 + w[453] * TURN(124) + w[461] * TURN(152);
  STORE(passed + 372, PASSED(188) + EACH((-1.2465515919238348)) * b3 + EACH((-1.383567886009182)) * b7);
  b8 = PASSED(216) - PASSED(220);
  b9 = PASSED(224) - PASSED(228);
  b2 = PASSED(184) - b2;
  b10 = w[346] * PASSED(232) + w[350] * PASSED(236) + w[354] * PASSED(240) + w[426] * TURN(28) + w[434] * TURN(56);
  b11 = w[504] * PASSED(244) + w[508] * PASSED(248) + w[512] * PASSED(252) + w[584] * TURN(52) + w[592] * TURN(80);
  b12 = b10 + b11;
  b13 = EACH((-0.030488993727104185)) * b12;
  b14 = w[347] * PASSED(256) + w[351] * PASSED(260) + w[355] * PASSED(264) + w[427] * TURN(32) + w[435] * TURN(60);
  b15 = w[503] * PASSED(268) + w[507] * PASSED(272) + w[511] * PASSED(276) + w[583] * TURN(48) + w[591] * TURN(76);
  b16 = b14 + b15;
  b17 = EACH((-0.23936467114405355)) * b16;
  b18 = w[348] * PASSED(280) + w[352] * PASSED(284) + w[356] * PASSED(288) + w[428] * TURN(36) + w[436] * TURN(64);
  b19 = w[502] * PASSED(292) + w[506] * b0 + w[510] * b1 + w[582] * TURN(44) + w[590] * TURN(72);
  b20 = b18 + b19;
  b17 = EACH(0.2926283213231745) * b8 + EACH(0.6575298694832539) * b9 + EACH(0.5272980147574515) * b2 + b13 + b17;
  b13 = w[349] * b4 + w[353] * b5 + w[357] * b6 + w[429] * TURN(40) + w[437] * TURN(68);
  STORE(passed + 376, b17 + EACH((-0.49982838059565815)) * b20 + EACH((-0.6157456363734538)) * b13);
  b3 = EACH(0.2636490073787256) * b3;
  b11 = EACH(0.08693794183334577) * (b10 - b11);
  b15 = EACH(0.5473523222401194) * (b14 - b15);
  b19 = EACH(0.6342902640734651) * (b18 - b19);
  b19 = EACH((-0.2636490073787259)) * PASSED(296) + EACH((-0.3287649347416268)) * PASSED(300) + b3 + b11 + b15 + b19;
  STORE(passed + 380, b19 + EACH(0.6575298694832545) * b7);
  b12 = EACH((-0.16096153946370667)) * b12;
  b12 = EACH(0.22376735429621533) * b8 + EACH(0.0003981622408899688) * b9 + EACH((-0.5020832175145834)) * b2 + b12;
  b13 = b12 + EACH((-0.6908841576464848)) * b16 + EACH(0.04883694552217567) * b20 + EACH(0.8778849639695244) * b13;
  STORE(passed + 384, b13);
  b13 = w[322] * PASSED(232) + w[326] * PASSED(236) + w[330] * PASSED(240) + w[442] * TURN(84) + w[462] * TURN(140);
  b20 = w[480] * PASSED(244) + w[484] * PASSED(248) + w[488] * PASSED(252) + w[600] * TURN(108) + w[620] * TURN(164);
  b16 = b13 + b20;
  STORE(passed + 332, b16);
  b12 = w[323] * PASSED(256) + w[327] * PASSED(260) + w[331] * PASSED(264) + w[443] * TURN(88) + w[463] * TURN(144);
  b2 = w[479] * PASSED(268) + w[483] * PASSED(272) + w[487] * PASSED(276) + w[599] * TURN(104) + w[619] * TURN(160);
  b9 = b12 + b2;
  STORE(passed + 336, b9);
  b8 = w[324] * PASSED(280) + w[328] * PASSED(284) + w[332] * PASSED(288) + w[444] * TURN(92) + w[464] * TURN(148);
  b1 = w[478] * PASSED(292) + w[482] * b0 + w[486] * b1 + w[598] * TURN(100) + w[618] * TURN(156);
  b0 = b8 + b1;
  STORE(passed + 340, b0);
  b6 = w[325] * b4 + w[329] * b5 + w[333] * b6 + w[445] * TURN(96) + w[465] * TURN(152);
  STORE(passed + 352, b6);
  b6 = EACH((-1.383567886009182)) * b6;
  b6 = EACH((-0.3078728181867266)) * b16 + EACH((-0.862640467105971)) * b9 + EACH((-1.2465515919238348)) * b0 + b6;
  STORE(passed + 388, b6);
  b20 = b13 - b20;
  STORE(passed + 356, b20);
  b2 = b12 - b2;
  STORE(passed + 360, b2);
  b1 = b8 - b1;
  STORE(passed + 364, b1);
  b8 = w[358] * PASSED(232) + w[362] * PASSED(236) + w[366] * PASSED(240) + w[418] * TURN(0) + w[438] * TURN(56);
  STORE(passed + 344, b8);
  b12 = w[516] * PASSED(244) + w[520] * PASSED(248) + w[524] * PASSED(252) + w[576] * TURN(24) + w[596] * TURN(80);
  STORE(passed + 348, b12);
  b12 = b8 + b12;
  STORE(passed + 368, b12);
  b12 = EACH((-0.030488993727104185)) * b12;
  b12 = EACH(0.2926283213231745) * b20 + EACH(0.6575298694832539) * b2 + EACH(0.5272980147574515) * b1 + b12;
  STORE(passed + 308, b12);
  STORE(passed + 304, w[359] * PASSED(256) + w[363] * PASSED(260) + w[367] * PASSED(264));
}

static void MADE(precurved_tube_k_jacobian_columns_3)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24;
  b0 = PASSED(304) + w[419] * TURN(4) + w[439] * TURN(60);
  b1 = w[515] * PASSED(268) + w[519] * PASSED(272) + w[523] * PASSED(276) + w[575] * TURN(20) + w[595] * TURN(76);
  b2 = b0 + b1;
  b3 = w[360] * PASSED(280) + w[364] * PASSED(284) + w[368] * PASSED(288) + w[420] * TURN(8) + w[440] * TURN(64);
  b4 = w[514] * PASSED(292) + w[518] * PASSED(312) + w[522] * PASSED(316) + w[574] * TURN(16) + w[594] * TURN(72);
  b5 = b3 + b4;
  b6 = w[361] * PASSED(320) + w[365] * PASSED(324) + w[369] * PASSED(328) + w[421] * TURN(12) + w[441] * TURN(68);
  b7 = EACH((-0.6157456363734538)) * b6;
  b8 = EACH(0.2636490073787256) * PASSED(340);
  b9 = EACH(0.08693794183334577) * (PASSED(344) - PASSED(348));
  b1 = EACH(0.5473523222401194) * (b0 - b1);
  b4 = EACH(0.6342902640734651) * (b3 - b4);
  b4 = EACH((-0.2636490073787259)) * PASSED(332) + EACH((-0.3287649347416268)) * PASSED(336) + b8 + b9 + b1 + b4;
  b1 = EACH((-0.5020832175145834)) * PASSED(364);
  b9 = EACH((-0.16096153946370667)) * PASSED(368);
  b8 = EACH((-0.6908841576464848)) * b2;
  b3 = EACH(0.04883694552217567) * b5;
  b3 = EACH(0.22376735429621533) * PASSED(356) + EACH(0.0003981622408899688) * PASSED(360) + b1 + b9 + b8 + b3;
  b8 = w[334] * PASSED(232) + w[338] * PASSED(236) + w[342] * PASSED(240) + w[446] * TURN(84) + w[454] * TURN(112);
  b9 = w[492] * PASSED(244) + w[496] * PASSED(248) + w[500] * PASSED(252) + w[604] * TURN(108) + w[612] * TURN(136);
  b1 = b8 + b9;
  b0 = w[335] * PASSED(256) + w[339] * PASSED(260) + w[343] * PASSED(264) + w[447] * TURN(88) + w[455] * TURN(116);
  b10 = w[491] * PASSED(268) + w[495] * PASSED(272) + w[499] * PASSED(276) + w[603] * TURN(104) + w[611] * TURN(132);
  b11 = b0 + b10;
  b12 = w[336] * PASSED(280) + w[340] * PASSED(284) + w[344] * PASSED(288) + w[448] * TURN(92) + w[456] * TURN(120);
  b13 = w[490] * PASSED(292) + w[494] * PASSED(312) + w[498] * PASSED(316) + w[602] * TURN(100) + w[610] * TURN(128);
  b14 = b12 + b13;
  b15 = w[337] * PASSED(320) + w[341] * PASSED(324) + w[345] * PASSED(328) + w[449] * TURN(96) + w[457] * TURN(124);
  b16 = EACH((-0.35505625469361274)) * b1 + EACH((-0.9948455183595666)) * b11 + EACH((-1.4375934261348153)) * b14;
  b9 = b8 - b9;
  b10 = b0 - b10;
  b13 = b12 - b13;
  b12 = w[370] * PASSED(232) + w[374] * PASSED(236) + w[378] * PASSED(240) + w[422] * TURN(0) + w[430] * TURN(28);
  b0 = w[528] * PASSED(244) + w[532] * PASSED(248) + w[536] * PASSED(252) + w[580] * TURN(24) + w[588] * TURN(52);
  b8 = b12 + b0;
  b17 = EACH((-0.03516162286063546)) * b8;
  b18 = w[371] * PASSED(256) + w[375] * PASSED(260) + w[379] * PASSED(264) + w[423] * TURN(4) + w[431] * TURN(32);
  b19 = w[527] * PASSED(268) + w[531] * PASSED(272) + w[535] * PASSED(276) + w[579] * TURN(20) + w[587] * TURN(48);
  b20 = b18 + b19;
  b21 = EACH((-0.27604880529215886)) * b20;
  b22 = w[372] * PASSED(280) + w[376] * PASSED(284) + w[380] * PASSED(288) + w[424] * TURN(8) + w[432] * TURN(36);
  b23 = w[526] * PASSED(292) + w[530] * PASSED(312) + w[534] * PASSED(316) + w[578] * TURN(16) + w[586] * TURN(44);
  b24 = b22 + b23;
  b21 = EACH(0.3374754432632949) * b9 + EACH(0.7583004377681345) * b10 + EACH(0.6081097361235956) * b13 + b17 + b21;
  b17 = w[373] * PASSED(320) + w[377] * PASSED(324) + w[381] * PASSED(328) + w[425] * TURN(12) + w[433] * TURN(40);
  b0 = b12 - b0;
  b12 = EACH((-0.30405486806179793)) * b1 + EACH((-0.37915021888406714)) * b11 + EACH(0.30405486806179755) * b14;
  b19 = b18 - b19;
  b23 = b22 - b23;
  b22 = EACH(0.7583004377681353) * b15;
  b8 = EACH((-0.18562990291997722)) * b8;
  b8 = EACH(0.25806110200649807) * b9 + EACH(0.0004591830965898181) * b10 + EACH((-0.5790306133720645)) * b13 + b8;
  b13 = EACH(0.2785807252546341) * b0;
  b13 = EACH((-0.20388507926950417)) * b1 + EACH(0.2515084481783076) * b11 + EACH(0.20388507926950444) * b14 + b13;
  STORE(columns + 0, PASSED(372));
  STORE(columns + 16, PASSED(376));
  STORE(columns + 32, PASSED(380));
  STORE(columns + 48, PASSED(384));
  STORE(columns + 64, PASSED(388));
  b7 = PASSED(308) + EACH((-0.23936467114405355)) * b2 + EACH((-0.49982838059565815)) * b5 + b7;
  STORE(columns + 80, b7);
  STORE(columns + 96, b4 + EACH(0.6575298694832545) * PASSED(352));
  STORE(columns + 112, b3 + EACH(0.8778849639695244) * b6);
  STORE(columns + 128, b16 + EACH((-1.5956083249377244)) * b15);
  STORE(columns + 144, b21 + EACH((-0.5764302085812367)) * b24 + EACH((-0.7101125093872261)) * b17);
  b22 = b12 + EACH(0.10026172560449083) * b0 + EACH(0.63123749175726) * b19 + EACH(0.7314992173617505) * b23 + b22;
  STORE(columns + 160, b22);
  b17 = b8 + EACH((-0.7967664793724494)) * b20 + EACH(0.0563215131167018) * b24 + EACH(1.0124263297898857) * b17;
  STORE(columns + 176, b17);
  b15 = b13 + EACH(0.6037782802109372) * b19 + EACH((-0.9623179290030771)) * b23 + EACH((-0.5030168963566155)) * b15;
  STORE(columns + 192, b15);
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
  b0 = w[320] * TURN(140);
  b0 = w[260] * TURN(0) + w[272] * TURN(28) + w[284] * TURN(56) + w[296] * TURN(84) + w[308] * TURN(112) + b0;
  STORE(passed + 36, b0);
  b1 = w[321] * TURN(144);
  b1 = w[261] * TURN(4) + w[273] * TURN(32) + w[285] * TURN(60) + w[297] * TURN(88) + w[309] * TURN(116) + b1;
  b1 = b0 + b1;
  STORE(passed + 40, b1);
  b2 = w[322] * TURN(148);
  b2 = w[262] * TURN(8) + w[274] * TURN(36) + w[286] * TURN(64) + w[298] * TURN(92) + w[310] * TURN(120) + b2;
  b2 = b1 + b2;
  STORE(passed + 44, b2);
  b3 = w[323] * TURN(152);
  b3 = w[263] * TURN(12) + w[275] * TURN(40) + w[287] * TURN(68) + w[299] * TURN(96) + w[311] * TURN(124) + b3;
  b3 = b2 + b3;
  STORE(passed + 48, b3);
  b4 = w[392] * TURN(156);
  b4 = w[332] * TURN(16) + w[344] * TURN(44) + w[356] * TURN(72) + w[368] * TURN(100) + w[380] * TURN(128) + b4;
  b4 = b3 + b4;
  STORE(passed + 52, b4);
  b5 = w[393] * TURN(160);
  b5 = w[333] * TURN(20) + w[345] * TURN(48) + w[357] * TURN(76) + w[369] * TURN(104) + w[381] * TURN(132) + b5;
  b5 = b4 + b5;
  STORE(passed + 56, b5);
  b6 = w[394] * TURN(164);
  b6 = w[334] * TURN(24) + w[346] * TURN(52) + w[358] * TURN(80) + w[370] * TURN(108) + w[382] * TURN(136) + b6;
  b6 = b5 + b6;
  STORE(passed + 60, b6);
  b7 = w[324] * TURN(140);
  b7 = w[264] * TURN(0) + w[276] * TURN(28) + w[288] * TURN(56) + w[300] * TURN(84) + w[312] * TURN(112) + b7;
  STORE(passed + 16, b7);
  b8 = w[615] * b7;
  b9 = w[325] * TURN(144);
  b9 = w[265] * TURN(4) + w[277] * TURN(32) + w[289] * TURN(60) + w[301] * TURN(88) + w[313] * TURN(116) + b9;
  b9 = b7 + b9;
  STORE(passed + 20, b9);
  b8 = w[566] * b0 + w[573] * b1 + w[580] * b2 + w[587] * b3 + w[594] * b4 + w[601] * b5 + w[608] * b6 - b8;
  b6 = w[326] * TURN(148);
  b6 = w[266] * TURN(8) + w[278] * TURN(36) + w[290] * TURN(64) + w[302] * TURN(92) + w[314] * TURN(120) + b6;
  b6 = b9 + b6;
  STORE(passed + 24, b6);
  b5 = w[327] * TURN(152);
  b5 = w[267] * TURN(12) + w[279] * TURN(40) + w[291] * TURN(68) + w[303] * TURN(96) + w[315] * TURN(124) + b5;
  b5 = b6 + b5;
  STORE(passed + 28, b5);
  b4 = w[396] * TURN(156);
  b4 = w[336] * TURN(16) + w[348] * TURN(44) + w[360] * TURN(72) + w[372] * TURN(100) + w[384] * TURN(128) + b4;
  b4 = b5 + b4;
  STORE(passed + 32, b4);
  b3 = w[397] * TURN(160);
  b3 = w[337] * TURN(20) + w[349] * TURN(48) + w[361] * TURN(76) + w[373] * TURN(104) + w[385] * TURN(132) + b3;
  b3 = b4 + b3;
  STORE(passed + 8, b3);
  STORE(passed + 12, b8 - w[622] * b9 - w[629] * b6 - w[636] * b5 - w[643] * b4 - w[650] * b3);
  STORE(passed + 0, w[338] * TURN(24));
  STORE(passed + 4, w[350] * TURN(52));
}

static void MADE(precurved_tube_k_tip_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12;
  b0 = PASSED(0) + PASSED(4) + w[362] * TURN(80) + w[374] * TURN(108) + w[386] * TURN(136) + w[398] * TURN(164);
  b0 = PASSED(8) + b0;
  b1 = w[316] * TURN(140);
  b1 = w[256] * TURN(0) + w[268] * TURN(28) + w[280] * TURN(56) + w[292] * TURN(84) + w[304] * TURN(112) + b1;
  b2 = w[317] * TURN(144);
  b2 = w[257] * TURN(4) + w[269] * TURN(32) + w[281] * TURN(60) + w[293] * TURN(88) + w[305] * TURN(116) + b2;
  b2 = b1 + b2;
  b3 = w[318] * TURN(148);
  b3 = w[258] * TURN(8) + w[270] * TURN(36) + w[282] * TURN(64) + w[294] * TURN(92) + w[306] * TURN(120) + b3;
  b3 = b2 + b3;
  b4 = w[319] * TURN(152);
  b4 = w[259] * TURN(12) + w[271] * TURN(40) + w[283] * TURN(68) + w[295] * TURN(96) + w[307] * TURN(124) + b4;
  b4 = b3 + b4;
  b5 = w[388] * TURN(156);
  b5 = w[328] * TURN(16) + w[340] * TURN(44) + w[352] * TURN(72) + w[364] * TURN(100) + w[376] * TURN(128) + b5;
  b5 = b4 + b5;
  b6 = w[389] * TURN(160);
  b6 = w[329] * TURN(20) + w[341] * TURN(48) + w[353] * TURN(76) + w[365] * TURN(104) + w[377] * TURN(132) + b6;
  b6 = b5 + b6;
  b7 = w[390] * TURN(164);
  b7 = w[330] * TURN(24) + w[342] * TURN(52) + w[354] * TURN(80) + w[366] * TURN(108) + w[378] * TURN(136) + b7;
  b7 = b6 + b7;
  b8 = w[566] * b1 + w[573] * b2 + w[580] * b3 + w[587] * b4 + w[594] * b5 + w[601] * b6 + w[608] * b7;
  b9 = w[704] * PASSED(32);
  b10 = w[705] * PASSED(8);
  b11 = w[706] * b0;
  b12 = w[658] * PASSED(36);
  b12 = w[615] * b1 + w[622] * b2 + w[629] * b3 + w[636] * b4 + w[643] * b5 + w[650] * b6 + w[657] * b7 - b12;
  b6 = w[705] * PASSED(56);
  b5 = w[706] * PASSED(60);
  STORE(columns + 0, PASSED(12) - w[657] * b0);
  b11 = w[658] * PASSED(16) - b8 + w[701] * PASSED(20) + w[702] * PASSED(24) + w[703] * PASSED(28) + b9 + b10 + b11;
  STORE(columns + 16, b11);
  b5 = b12 - w[701] * PASSED(40) - w[702] * PASSED(44) - w[703] * PASSED(48) - w[704] * PASSED(52) - b6 - b5;
  STORE(columns + 32, b5);
  STORE(columns + 48, EACH((-1.0)) * ((b7 * w[185] + PASSED(60) * w[182] + b0 * w[183]) / EACH(2.0)));
  STORE(columns + 64, (b7 * w[184] + PASSED(60) * w[183] - b0 * w[182]) / EACH(2.0));
  STORE(columns + 80, (PASSED(60) * w[184] - b7 * w[183] + b0 * w[185]) / EACH(2.0));
  STORE(columns + 96, (b7 * w[182] - PASSED(60) * w[185] + b0 * w[184]) / EACH(2.0));
}

static void MADE(precurved_tube_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 168, columns += 4) {
    EVERY_LANE(MADE(precurved_tube_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(precurved_tube_k_tip_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}
