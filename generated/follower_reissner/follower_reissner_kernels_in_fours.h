/* Included once for each width of vectors. */
static void MADE(follower_reissner_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = GIVEN(0) + (GIVEN(4) * GIVEN(20) - GIVEN(8) * GIVEN(16)) / EACH(12.0);
  b1 = GIVEN(4) + (GIVEN(8) * GIVEN(12) - GIVEN(0) * GIVEN(20)) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH((-2.7557319223985893e-06)) + b3 * (EACH(2.505210838544172e-08) + b3 * (EACH((-1.6059043836821613e-10)) + b3 * (EACH(7.647163731819816e-13) + b3 * (EACH((-2.8114572543455206e-15)) + b3 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3)))));
  b4 = EACH(0.16666666666666666) + b3 * (EACH((-0.008333333333333333)) + b3 * (EACH(0.0001984126984126984) + b3 * b4));
  b5 = EACH(0.0005208333333333333) + b3 * (EACH((-3.1001984126984127e-06)) + b3 * (EACH(1.076457782186949e-08) + b3 * (EACH((-2.446494959515793e-11)) + b3 * (EACH(3.920664999224027e-14) + b3 * (EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3)))));
  b5 = EACH(1.0) + b3 * (EACH((-0.041666666666666664)) + b3 * b5);
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
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(follower_reissner_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84) + GIVEN(76) * GIVEN(88);
  b1 = GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84) + GIVEN(52) * GIVEN(88);
  b2 = GIVEN(36) * GIVEN(36) / EACH(2.0);
  b3 = GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84) + GIVEN(64) * GIVEN(88);
  b4 = GIVEN(40) * (GIVEN(32) * b1 - GIVEN(24) * b0) - b2 * b3;
  b5 = GIVEN(40) * (GIVEN(28) * b0 - GIVEN(32) * b3) - b2 * b1;
  b6 = b0 + (GIVEN(24) * b4 - GIVEN(28) * b5);
  b7 = EACH(C[0]) * b6;
  b0 = GIVEN(40) * (GIVEN(24) * b3 - GIVEN(28) * b1) - b2 * b0;
  b5 = b3 + (GIVEN(32) * b5 - GIVEN(24) * b0);
  b3 = EACH(C[0]) * b5;
  b4 = b1 + (GIVEN(28) * b0 - GIVEN(32) * b4);
  b0 = EACH(C[0]) * b4;
  STORE(made + 0, GIVEN(16) * b7 - GIVEN(20) * b3 + b4);
  STORE(made + 4, b5 - GIVEN(12) * b7 + GIVEN(20) * b0);
  STORE(made + 8, b6 + GIVEN(12) * b3 - GIVEN(16) * b0);
  STORE(made + 12, GIVEN(8) * b3 - GIVEN(4) * b7);
  STORE(made + 16, GIVEN(0) * b7 - GIVEN(8) * b0);
  STORE(made + 20, GIVEN(4) * b0 - GIVEN(0) * b3);
}

static void MADE(follower_reissner_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(follower_reissner_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
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
  b15 = EACH(C[0]) * GIVEN(20);
  b10 = b10 + b0 * GIVEN(24);
  b13 = b0 * GIVEN(28) - b13;
  b8 = EACH(1.0) - (b3 + b8);
  b3 = GIVEN(44) * b10 + GIVEN(56) * b13 + GIVEN(68) * b8;
  b0 = EACH(C[0]) * GIVEN(16);
  b16 = GIVEN(48) * b4 + GIVEN(60) * b9 + GIVEN(72) * b11;
  b17 = GIVEN(48) * b7 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b18 = GIVEN(48) * b10 + GIVEN(60) * b13 + GIVEN(72) * b8;
  b11 = GIVEN(52) * b4 + GIVEN(64) * b9 + GIVEN(76) * b11;
  b2 = GIVEN(52) * b7 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b8 = GIVEN(52) * b10 + GIVEN(64) * b13 + GIVEN(76) * b8;
  b13 = EACH(C[0]) * GIVEN(12);
  b10 = EACH(C[0]) * GIVEN(8);
  b1 = EACH(C[0]) * GIVEN(4);
  b7 = EACH(C[0]) * GIVEN(0);
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
  b33 = EACH(C[0]) * (b9 + (GIVEN(24) * b31 - GIVEN(28) * b32));
  b9 = GIVEN(40) * (GIVEN(24) * b30 - GIVEN(28) * b19) - b6 * b9;
  b32 = EACH(C[0]) * (b30 + (GIVEN(32) * b32 - GIVEN(24) * b9));
  b30 = EACH((-1.0)) * b32;
  b6 = EACH((-1.0)) * b33;
  b31 = EACH(C[0]) * (b19 + (GIVEN(28) * b9 - GIVEN(32) * b31));
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

static void MADE(follower_reissner_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 156)
    EVERY_LANE(MADE(follower_reissner_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
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
  b8 = EACH(C[0]) * (b0 + (GIVEN(24) * b5 - GIVEN(28) * b7));
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
  b14 = EACH(C[0]) * b13;
  b15 = GIVEN(24) * b4 - GIVEN(28) * b1;
  b16 = GIVEN(40) * b15 - b3 * b0;
  b17 = EACH(C[0]) * (b4 + (GIVEN(32) * b7 - GIVEN(24) * b16));
  b4 = b15 * GIVEN(132) + GIVEN(40) * (b4 * GIVEN(116) + GIVEN(24) * b12 - (b1 * GIVEN(120) + GIVEN(28) * b10));
  b9 = b4 - (b0 * b11 + b3 * b9);
  b6 = b12 + (b7 * GIVEN(124) + GIVEN(32) * b6 - (b16 * GIVEN(116) + GIVEN(24) * b9));
  b7 = EACH(C[0]) * b6;
  b2 = b10 + (b16 * GIVEN(120) + GIVEN(28) * b9 - (b5 * GIVEN(124) + GIVEN(32) * b2));
  b5 = EACH(C[0]) * (b1 + (GIVEN(28) * b16 - GIVEN(32) * b5));
  b16 = EACH(C[0]) * b2;
  STORE(made + 0, b8 * GIVEN(108) + GIVEN(16) * b14 - (b17 * GIVEN(112) + GIVEN(20) * b7) + b2);
  STORE(made + 4, b6 - (b8 * GIVEN(104) + GIVEN(12) * b14) + (b5 * GIVEN(112) + GIVEN(20) * b16));
  STORE(made + 8, b13 + (b17 * GIVEN(104) + GIVEN(12) * b7) - (b5 * GIVEN(108) + GIVEN(16) * b16));
  STORE(made + 12, b17 * GIVEN(100) + GIVEN(8) * b7 - (b8 * GIVEN(96) + GIVEN(4) * b14));
  STORE(made + 16, b8 * GIVEN(92) + GIVEN(0) * b14 - (b5 * GIVEN(100) + GIVEN(8) * b16));
  STORE(made + 20, b5 * GIVEN(96) + GIVEN(4) * b16 - (b17 * GIVEN(92) + GIVEN(0) * b7));
}

static void MADE(follower_reissner_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(follower_reissner_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
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
  b13 = EACH(C[0]) * GIVEN(20);
  b9 = b9 + b0 * GIVEN(24);
  b5 = b0 * GIVEN(28) - b5;
  b7 = EACH(1.0) - (b3 + b7);
  b3 = GIVEN(44) * b9 + GIVEN(56) * b5 + GIVEN(68) * b7;
  b0 = EACH(C[0]) * GIVEN(16);
  b14 = GIVEN(48) * b4 + GIVEN(60) * b8 + GIVEN(72) * b10;
  b15 = GIVEN(48) * b6 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b16 = GIVEN(48) * b9 + GIVEN(60) * b5 + GIVEN(72) * b7;
  b10 = GIVEN(52) * b4 + GIVEN(64) * b8 + GIVEN(76) * b10;
  b2 = GIVEN(52) * b6 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b7 = GIVEN(52) * b9 + GIVEN(64) * b5 + GIVEN(76) * b7;
  b5 = EACH(C[0]) * GIVEN(12);
  b9 = EACH(C[0]) * GIVEN(8);
  b1 = EACH(C[0]) * GIVEN(4);
  b6 = EACH(C[0]) * GIVEN(0);
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

static void MADE(follower_reissner_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 80, made += 72)
    EVERY_LANE(MADE(follower_reissner_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14;
  b0 = w[283] * TURN(100);
  STORE(passed + 20, b0 = w[223] * TURN(0) + w[235] * TURN(20) + w[247] * TURN(40) + w[259] * TURN(60) + w[271] * TURN(80) + b0);
  b1 = w[284] * TURN(104);
  STORE(passed + 112, b1 = w[224] * TURN(4) + w[236] * TURN(24) + w[248] * TURN(44) + w[260] * TURN(64) + w[272] * TURN(84) + b1);
  STORE(passed + 84, b1 = b0 + b1);
  b0 = w[285] * TURN(108);
  STORE(passed + 140, b0 = w[225] * TURN(8) + w[237] * TURN(28) + w[249] * TURN(48) + w[261] * TURN(68) + w[273] * TURN(88) + b0);
  STORE(passed + 72, b0 = b1 + b0);
  b2 = w[286] * TURN(112);
  STORE(passed + 128, b2 = w[226] * TURN(12) + w[238] * TURN(32) + w[250] * TURN(52) + w[262] * TURN(72) + w[274] * TURN(92) + b2);
  STORE(passed + 60, b2 = b0 + b2);
  b3 = w[439] * TURN(116);
  STORE(passed + 100, b3 = w[379] * TURN(16) + w[391] * TURN(36) + w[403] * TURN(56) + w[415] * TURN(76) + w[427] * TURN(96) + b3);
  STORE(passed + 44, b3 = b2 + b3);
  b4 = w[279] * TURN(100);
  STORE(passed + 24, b4 = w[219] * TURN(0) + w[231] * TURN(20) + w[243] * TURN(40) + w[255] * TURN(60) + w[267] * TURN(80) + b4);
  b5 = w[280] * TURN(104);
  STORE(passed + 108, b5 = w[220] * TURN(4) + w[232] * TURN(24) + w[244] * TURN(44) + w[256] * TURN(64) + w[268] * TURN(84) + b5);
  STORE(passed + 80, b5 = b4 + b5);
  b4 = w[281] * TURN(108);
  STORE(passed + 136, b4 = w[221] * TURN(8) + w[233] * TURN(28) + w[245] * TURN(48) + w[257] * TURN(68) + w[269] * TURN(88) + b4);
  STORE(passed + 68, b4 = b5 + b4);
  b6 = w[282] * TURN(112);
  STORE(passed + 124, b6 = w[222] * TURN(12) + w[234] * TURN(32) + w[246] * TURN(52) + w[258] * TURN(72) + w[270] * TURN(92) + b6);
  STORE(passed + 56, b6 = b4 + b6);
  b7 = w[435] * TURN(116);
  STORE(passed + 96, b7 = w[375] * TURN(16) + w[387] * TURN(36) + w[399] * TURN(56) + w[411] * TURN(76) + w[423] * TURN(96) + b7);
  STORE(passed + 40, b7 = b6 + b7);
  b8 = w[287] * TURN(100);
  STORE(passed + 28, b8 = w[227] * TURN(0) + w[239] * TURN(20) + w[251] * TURN(40) + w[263] * TURN(60) + w[275] * TURN(80) + b8);
  b9 = w[288] * TURN(104);
  STORE(passed + 116, b9 = w[228] * TURN(4) + w[240] * TURN(24) + w[252] * TURN(44) + w[264] * TURN(64) + w[276] * TURN(84) + b9);
  STORE(passed + 0, b9 = b8 + b9);
  b8 = w[289] * TURN(108);
  STORE(passed + 144, b8 = w[229] * TURN(8) + w[241] * TURN(28) + w[253] * TURN(48) + w[265] * TURN(68) + w[277] * TURN(88) + b8);
  STORE(passed + 76, b8 = b9 + b8);
  b9 = w[290] * TURN(112);
  STORE(passed + 132, b9 = w[230] * TURN(12) + w[242] * TURN(32) + w[254] * TURN(52) + w[266] * TURN(72) + w[278] * TURN(92) + b9);
  STORE(passed + 64, b9 = b8 + b9);
  b10 = w[443] * TURN(116);
  STORE(passed + 104, b10 = w[383] * TURN(16) + w[395] * TURN(36) + w[407] * TURN(56) + w[419] * TURN(76) + w[431] * TURN(96) + b10);
  STORE(passed + 48, b10 = b9 + b10);
  b11 = w[808] * b7 - w[809] * b10;
  STORE(passed + 88, b12 = EACH(C[1]) * b11);
  b13 = w[809] * b3 - w[811] * b7;
  STORE(passed + 52, b14 = EACH(C[1]) * b13);
  STORE(passed + 92, b14 = w[745] * b3 - w[776] * b7 + w[807] * b10 + (w[154] * b12 - w[150] * b14) - (w[813] * b10 - w[814] * b3));
  STORE(passed + 32, b12 = EACH(C[2]) * b11);
  STORE(passed + 36, b10 = EACH(C[2]) * b13);
  STORE(passed + 120, b10 = b14 + (w[815] * b2 - w[816] * b6 + w[817] * b9 + (w[165] * b12 - w[161] * b10)));
  STORE(passed + 8, b11 = EACH(C[3]) * b11);
  STORE(passed + 12, b13 = EACH(C[3]) * b13);
  STORE(passed + 16, b10 + (w[820] * b0 - w[821] * b4 + w[822] * b8 + (w[173] * b11 - w[169] * b13)));
  STORE(passed + 4, w[825] * b1 - w[826] * b5);
}

static void MADE(follower_reissner_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11;
  b0 = PASSED(16) + (PASSED(4) + w[827] * PASSED(0) + (w[181] * PASSED(8) - w[177] * PASSED(12)));
  b1 = w[830] * PASSED(20) - w[831] * PASSED(24) + w[832] * PASSED(28) + (w[189] * PASSED(32) - w[185] * PASSED(36));
  STORE(passed + 160, b1 = b0 + b1 + w[291] * PASSED(24) + w[303] * PASSED(20) + w[315] * PASSED(28));
  b2 = w[811] * PASSED(48) - w[808] * PASSED(44);
  STORE(passed + 228, b3 = EACH(C[1]) * b2);
  b4 = w[814] * PASSED(40) - w[842] * PASSED(48);
  b4 = w[838] * PASSED(40) - w[839] * PASSED(44) + w[840] * PASSED(48) + (w[190] * PASSED(52) - w[154] * b3) - b4;
  STORE(passed + 232, b5 = EACH(C[2]) * b2);
  b6 = b4 + (w[843] * PASSED(56) - w[844] * PASSED(60) + w[845] * PASSED(64) + (w[194] * PASSED(36) - w[165] * b5));
  STORE(passed + 236, b2 = EACH(C[3]) * b2);
  b7 = b6 + (w[847] * PASSED(68) - w[848] * PASSED(72) + w[849] * PASSED(76) + (w[198] * PASSED(12) - w[173] * b2));
  b8 = b7 + (w[851] * PASSED(80) - w[852] * PASSED(84) + w[853] * PASSED(0) + (w[202] * PASSED(12) - w[181] * b2));
  b9 = b8 + (w[855] * PASSED(24) - w[856] * PASSED(20) + w[857] * PASSED(28) + (w[206] * PASSED(36) - w[189] * b5));
  STORE(passed + 164, b9 = b9 + w[295] * PASSED(24) + w[307] * PASSED(20) + w[319] * PASSED(28));
  b10 = w[842] * PASSED(44) - w[813] * PASSED(40);
  b10 = w[862] * PASSED(40) + w[863] * PASSED(44) - w[864] * PASSED(48) + (w[150] * b3 - w[190] * PASSED(88)) - b10;
  b3 = b10 + (w[865] * PASSED(56) + w[866] * PASSED(60) - w[867] * PASSED(64) + (w[161] * b5 - w[194] * PASSED(32)));
  b11 = b3 + (w[868] * PASSED(68) + w[869] * PASSED(72) - w[870] * PASSED(76) + (w[169] * b2 - w[198] * PASSED(8)));
  b2 = b11 + (w[871] * PASSED(80) + w[872] * PASSED(84) - w[873] * PASSED(0) + (w[177] * b2 - w[202] * PASSED(8)));
  b5 = b2 + (w[874] * PASSED(24) + w[875] * PASSED(20) - w[876] * PASSED(28) + (w[185] * b5 - w[206] * PASSED(32)));
  STORE(passed + 168, b5 = b5 + w[299] * PASSED(24) + w[311] * PASSED(20) + w[323] * PASSED(28));
  b5 = w[219] * b1 + w[223] * b9 + w[227] * b5 + w[359] * TURN(80) + w[367] * TURN(100);
  b9 = w[471] * PASSED(104);
  STORE(passed + 172, b9 = w[882] * PASSED(64) - w[883] * PASSED(60) + PASSED(92) + w[447] * PASSED(96) + w[459] * PASSED(100) + b9);
  b1 = w[475] * PASSED(104);
  STORE(passed + 176, b1 = w[883] * PASSED(56) - w[887] * PASSED(64) + b4 + w[451] * PASSED(96) + w[463] * PASSED(100) + b1);
  b4 = w[479] * PASSED(104);
  STORE(passed + 180, b4 = w[887] * PASSED(60) - w[882] * PASSED(56) + b10 + w[455] * PASSED(96) + w[467] * PASSED(100) + b4);
  b4 = w[375] * b9 + w[379] * b1 + w[383] * b4 + w[515] * TURN(96) + w[523] * TURN(116);
  STORE(passed + 220, b1 = b5 + b4);
  b9 = w[316] * PASSED(116);
  STORE(passed + 184, b9 = w[896] * PASSED(28) - w[897] * PASSED(20) + b0 + w[292] * PASSED(108) + w[304] * PASSED(112) + b9);
  b0 = w[320] * PASSED(116);
  STORE(passed + 188, b0 = w[897] * PASSED(24) - w[901] * PASSED(28) + b8 + w[296] * PASSED(108) + w[308] * PASSED(112) + b0);
  b8 = w[324] * PASSED(116);
  STORE(passed + 192, b8 = w[901] * PASSED(20) - w[896] * PASSED(24) + b2 + w[300] * PASSED(108) + w[312] * PASSED(112) + b8);
  STORE(passed + 152, b8 = w[220] * b9 + w[224] * b0 + w[228] * b8 + w[360] * TURN(84) + w[368] * TURN(104));
  b0 = w[318] * PASSED(132);
  STORE(passed + 196, b0 = w[910] * PASSED(76) - w[911] * PASSED(72) + PASSED(120) + w[294] * PASSED(124) + w[306] * PASSED(128) + b0);
  b9 = w[322] * PASSED(132);
  STORE(passed + 200, b9 = w[911] * PASSED(68) - w[915] * PASSED(76) + b6 + w[298] * PASSED(124) + w[310] * PASSED(128) + b9);
  b6 = w[326] * PASSED(132);
  STORE(passed + 204, b6 = w[915] * PASSED(72) - w[910] * PASSED(68) + b3 + w[302] * PASSED(124) + w[314] * PASSED(128) + b6);
  STORE(passed + 156, b6 = w[222] * b0 + w[226] * b9 + w[230] * b6 + w[362] * TURN(92) + w[370] * TURN(112));
  b9 = w[317] * PASSED(144);
  STORE(passed + 208, b9 = w[924] * PASSED(0) - w[925] * PASSED(84) + PASSED(16) + w[293] * PASSED(136) + w[305] * PASSED(140) + b9);
  b0 = w[321] * PASSED(144);
  STORE(passed + 212, b0 = w[925] * PASSED(80) - w[929] * PASSED(0) + b7 + w[297] * PASSED(136) + w[309] * PASSED(140) + b0);
  b7 = w[325] * PASSED(144);
  STORE(passed + 216, b7 = w[929] * PASSED(84) - w[924] * PASSED(80) + b11 + w[301] * PASSED(136) + w[313] * PASSED(140) + b7);
  STORE(passed + 224, b7 = w[221] * b9 + w[225] * b0 + w[229] * b7 + w[361] * TURN(88) + w[369] * TURN(108));
  STORE(passed + 240, EACH(C[4]) * b1 + EACH(C[5]) * (b8 + b6) + EACH(C[6]) * b7);
  STORE(passed + 148, b5 - b4);
}

static void MADE(follower_reissner_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10;
  b0 = PASSED(152) - PASSED(156);
  b1 = w[255] * PASSED(160) + w[259] * PASSED(164) + w[263] * PASSED(168) + w[335] * TURN(20) + w[343] * TURN(40);
  b2 = w[411] * PASSED(172) + w[415] * PASSED(176) + w[419] * PASSED(180) + w[491] * TURN(36) + w[499] * TURN(56);
  b3 = b1 + b2;
  b4 = w[256] * PASSED(184) + w[260] * PASSED(188) + w[264] * PASSED(192) + w[336] * TURN(24) + w[344] * TURN(44);
  b5 = w[258] * PASSED(196) + w[262] * PASSED(200) + w[266] * PASSED(204) + w[338] * TURN(32) + w[346] * TURN(52);
  b6 = b4 + b5;
  b7 = w[257] * PASSED(208) + w[261] * PASSED(212) + w[265] * PASSED(216) + w[337] * TURN(28) + w[345] * TURN(48);
  STORE(passed + 244, EACH(C[7]) * PASSED(148) + EACH(C[8]) * b0 + EACH(C[9]) * b3 + EACH(C[10]) * b6 + EACH(C[11]) * b7);
  b5 = EACH(C[12]) * PASSED(220) + EACH(C[13]) * (b1 - b2) + EACH(C[14]) * (b4 - b5) + EACH(C[8]) * PASSED(224);
  STORE(passed + 248, b5);
  STORE(passed + 252, EACH(C[15]) * PASSED(148) + EACH(C[16]) * b0 + EACH(C[17]) * b3 + EACH(C[18]) * b6 + EACH(C[19]) * b7);
  b7 = w[231] * PASSED(160) + w[235] * PASSED(164) + w[239] * PASSED(168) + w[351] * TURN(60) + w[371] * TURN(100);
  b6 = w[387] * PASSED(172) + w[391] * PASSED(176) + w[395] * PASSED(180) + w[507] * TURN(76) + w[527] * TURN(116);
  b3 = b7 + b6;
  b0 = w[232] * PASSED(184) + w[236] * PASSED(188) + w[240] * PASSED(192) + w[352] * TURN(64) + w[372] * TURN(104);
  b5 = w[234] * PASSED(196) + w[238] * PASSED(200) + w[242] * PASSED(204) + w[354] * TURN(72) + w[374] * TURN(112);
  b4 = w[233] * PASSED(208) + w[237] * PASSED(212) + w[241] * PASSED(216) + w[353] * TURN(68) + w[373] * TURN(108);
  STORE(passed + 256, EACH(C[4]) * b3 + EACH(C[5]) * (b0 + b5) + EACH(C[6]) * b4);
  b6 = b7 - b6;
  b5 = b0 - b5;
  b0 = w[267] * PASSED(160) + w[271] * PASSED(164) + w[275] * PASSED(168) + w[327] * TURN(0) + w[347] * TURN(40);
  b7 = w[423] * PASSED(172) + w[427] * PASSED(176) + w[431] * PASSED(180) + w[483] * TURN(16) + w[503] * TURN(56);
  b2 = b0 + b7;
  b1 = w[268] * PASSED(184) + w[272] * PASSED(188) + w[276] * PASSED(192) + w[328] * TURN(4) + w[348] * TURN(44);
  b8 = w[270] * PASSED(196) + w[274] * PASSED(200) + w[278] * PASSED(204) + w[330] * TURN(12) + w[350] * TURN(52);
  b9 = b1 + b8;
  b10 = w[269] * PASSED(208) + w[273] * PASSED(212) + w[277] * PASSED(216) + w[329] * TURN(8) + w[349] * TURN(48);
  STORE(passed + 260, EACH(C[7]) * b6 + EACH(C[8]) * b5 + EACH(C[9]) * b2 + EACH(C[10]) * b9 + EACH(C[11]) * b10);
  STORE(passed + 264, EACH(C[12]) * b3 + EACH(C[13]) * (b0 - b7) + EACH(C[14]) * (b1 - b8) + EACH(C[8]) * b4);
  STORE(passed + 268, EACH(C[15]) * b6 + EACH(C[16]) * b5 + EACH(C[17]) * b2 + EACH(C[18]) * b9 + EACH(C[19]) * b10);
  b10 = w[243] * PASSED(160) + w[247] * PASSED(164) + w[251] * PASSED(168) + w[355] * TURN(60) + w[363] * TURN(80);
  b9 = w[399] * PASSED(172) + w[403] * PASSED(176) + w[407] * PASSED(180) + w[511] * TURN(76) + w[519] * TURN(96);
  b2 = w[244] * PASSED(184) + w[248] * PASSED(188) + w[252] * PASSED(192) + w[356] * TURN(64) + w[364] * TURN(84);
  b5 = w[246] * PASSED(196) + w[250] * PASSED(200) + w[254] * PASSED(204) + w[358] * TURN(72) + w[366] * TURN(92);
  b6 = w[245] * PASSED(208) + w[249] * PASSED(212) + w[253] * PASSED(216) + w[357] * TURN(68) + w[365] * TURN(88);
  STORE(passed + 272, EACH(C[20]) * (b10 + b9) + EACH(C[21]) * (b2 + b5) + EACH(C[22]) * b6);
}

static void MADE(follower_reissner_k_jacobian_columns_3)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  b0 = w[978] * PASSED(40) + w[979] * PASSED(44) + w[980] * PASSED(48);
  b1 = w[981] * PASSED(24) + w[982] * PASSED(20) + w[983] * PASSED(28);
  b2 = w[984] * PASSED(56) + w[985] * PASSED(60) + w[986] * PASSED(64);
  b3 = w[987] * PASSED(80) + w[988] * PASSED(84) + w[989] * PASSED(0);
  b4 = w[990] * PASSED(68) + w[991] * PASSED(72) + w[992] * PASSED(76);
  b5 = w[999] * PASSED(56) + w[1000] * PASSED(60) + w[1001] * PASSED(64);
  b5 = EACH(C[23]) * (w[996] * PASSED(24) + w[997] * PASSED(20) + w[998] * PASSED(28) + b5);
  b6 = w[1005] * PASSED(68) + w[1006] * PASSED(72) + w[1007] * PASSED(76);
  b6 = EACH(C[23]) * (w[1002] * PASSED(80) + w[1003] * PASSED(84) + w[1004] * PASSED(0) + b6);
  b7 = w[1014] * PASSED(56) + w[1015] * PASSED(60) + w[1016] * PASSED(64);
  b7 = EACH(C[24]) * (w[1011] * PASSED(24) + w[1012] * PASSED(20) + w[1013] * PASSED(28) + b7);
  b8 = w[1020] * PASSED(68) + w[1021] * PASSED(72) + w[1022] * PASSED(76);
  b8 = EACH(C[24]) * (w[1017] * PASSED(80) + w[1018] * PASSED(84) + w[1019] * PASSED(0) + b8);
  b9 = w[155] * PASSED(228) + w[147] * PASSED(88) + w[151] * PASSED(52);
  b10 = w[203] * PASSED(232) + w[182] * PASSED(32) + w[186] * PASSED(36);
  b11 = w[191] * PASSED(232) + w[158] * PASSED(32) + w[162] * PASSED(36);
  b12 = w[199] * PASSED(236) + w[174] * PASSED(8) + w[178] * PASSED(12);
  b13 = w[195] * PASSED(236) + w[166] * PASSED(8) + w[170] * PASSED(12);
  b14 = w[192] * PASSED(232) + w[159] * PASSED(32) + w[163] * PASSED(36);
  b14 = EACH(C[23]) * (w[204] * PASSED(232) + w[183] * PASSED(32) + w[187] * PASSED(36) + b14);
  b15 = w[196] * PASSED(236) + w[167] * PASSED(8) + w[171] * PASSED(12);
  b15 = EACH(C[23]) * (w[200] * PASSED(236) + w[175] * PASSED(8) + w[179] * PASSED(12) + b15);
  b15 = EACH(C[23]) * (PASSED(88) + (w[156] * PASSED(228) + w[148] * PASSED(88) + w[152] * PASSED(52))) + b14 + b15;
  b14 = w[193] * PASSED(232) + w[160] * PASSED(32) + w[164] * PASSED(36);
  b14 = EACH(C[24]) * (w[205] * PASSED(232) + w[184] * PASSED(32) + w[188] * PASSED(36) + b14);
  b16 = w[197] * PASSED(236) + w[168] * PASSED(8) + w[172] * PASSED(12);
  b16 = EACH(C[24]) * (w[201] * PASSED(236) + w[176] * PASSED(8) + w[180] * PASSED(12) + b16);
  b16 = EACH(C[24]) * (PASSED(52) + (w[157] * PASSED(228) + w[149] * PASSED(88) + w[153] * PASSED(52))) + b14 + b16;
  STORE(columns + 0, PASSED(240));
  STORE(columns + 12, PASSED(244));
  STORE(columns + 24, PASSED(248));
  STORE(columns + 36, PASSED(252));
  STORE(columns + 48, PASSED(256));
  STORE(columns + 60, PASSED(260));
  STORE(columns + 72, PASSED(264));
  STORE(columns + 84, PASSED(268));
  STORE(columns + 96, PASSED(272));
  STORE(columns + 108, EACH(C[23]) * b0 + EACH(C[23]) * (b1 + b2) + EACH(C[23]) * (b3 + b4));
  STORE(columns + 120, EACH(C[25]) * (b1 - b2) - EACH(C[26]) * b0 + EACH(C[27]) * (b3 - b4));
  STORE(columns + 132, EACH(C[23]) * (w[993] * PASSED(40) + w[994] * PASSED(44) + w[995] * PASSED(48)) + b5 + b6);
  b8 = EACH(C[24]) * (w[1008] * PASSED(40) + w[1009] * PASSED(44) + w[1010] * PASSED(48)) + b7 + b8;
  STORE(columns + 144, b8);
  b8 = EACH((-1.0)) * (EACH(C[23]) * (PASSED(228) + b9) + EACH(C[23]) * (b10 + b11) + EACH(C[23]) * (b12 + b13));
  STORE(columns + 156, b8);
  STORE(columns + 168, EACH(C[26]) * (b9 - PASSED(228)) + EACH(C[25]) * (b11 - b10) + EACH(C[27]) * (b13 - b12));
  STORE(columns + 180, EACH((-1.0)) * b15);
  STORE(columns + 192, EACH((-1.0)) * b16);
}

static void MADE(follower_reissner_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 120, columns += 4) {
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_2)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_3)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(follower_reissner_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  b0 = w[283] * TURN(100);
  b0 = w[223] * TURN(0) + w[235] * TURN(20) + w[247] * TURN(40) + w[259] * TURN(60) + w[271] * TURN(80) + b0;
  b1 = w[284] * TURN(104);
  b1 = b0 + (w[224] * TURN(4) + w[236] * TURN(24) + w[248] * TURN(44) + w[260] * TURN(64) + w[272] * TURN(84) + b1);
  b2 = w[285] * TURN(108);
  b2 = b1 + (w[225] * TURN(8) + w[237] * TURN(28) + w[249] * TURN(48) + w[261] * TURN(68) + w[273] * TURN(88) + b2);
  b3 = w[286] * TURN(112);
  b3 = w[226] * TURN(12) + w[238] * TURN(32) + w[250] * TURN(52) + w[262] * TURN(72) + w[274] * TURN(92) + b3;
  b3 = b2 + b3;
  b4 = w[355] * TURN(116);
  b4 = w[295] * TURN(16) + w[307] * TURN(36) + w[319] * TURN(56) + w[331] * TURN(76) + w[343] * TURN(96) + b4;
  b4 = b3 + b4;
  b5 = w[287] * TURN(100);
  b5 = w[227] * TURN(0) + w[239] * TURN(20) + w[251] * TURN(40) + w[263] * TURN(60) + w[275] * TURN(80) + b5;
  b6 = w[288] * TURN(104);
  b6 = b5 + (w[228] * TURN(4) + w[240] * TURN(24) + w[252] * TURN(44) + w[264] * TURN(64) + w[276] * TURN(84) + b6);
  b7 = w[289] * TURN(108);
  b7 = b6 + (w[229] * TURN(8) + w[241] * TURN(28) + w[253] * TURN(48) + w[265] * TURN(68) + w[277] * TURN(88) + b7);
  b8 = w[578] * b7;
  b9 = w[290] * TURN(112);
  b9 = w[230] * TURN(12) + w[242] * TURN(32) + w[254] * TURN(52) + w[266] * TURN(72) + w[278] * TURN(92) + b9;
  b9 = b7 + b9;
  b8 = w[529] * b0 + w[536] * b1 + w[543] * b2 + w[550] * b3 + w[557] * b4 - w[564] * b5 - w[571] * b6 - b8;
  b10 = w[359] * TURN(116);
  b10 = w[299] * TURN(16) + w[311] * TURN(36) + w[323] * TURN(56) + w[335] * TURN(76) + w[347] * TURN(96) + b10;
  b10 = b9 + b10;
  b11 = w[279] * TURN(100);
  b11 = w[219] * TURN(0) + w[231] * TURN(20) + w[243] * TURN(40) + w[255] * TURN(60) + w[267] * TURN(80) + b11;
  b12 = w[280] * TURN(104);
  b12 = b11 + (w[220] * TURN(4) + w[232] * TURN(24) + w[244] * TURN(44) + w[256] * TURN(64) + w[268] * TURN(84) + b12);
  b13 = w[281] * TURN(108);
  b13 = b12 + (w[221] * TURN(8) + w[233] * TURN(28) + w[245] * TURN(48) + w[257] * TURN(68) + w[269] * TURN(88) + b13);
  b14 = w[282] * TURN(112);
  b14 = w[222] * TURN(12) + w[234] * TURN(32) + w[246] * TURN(52) + w[258] * TURN(72) + w[270] * TURN(92) + b14;
  b14 = b13 + b14;
  b15 = w[351] * TURN(116);
  b15 = w[291] * TURN(16) + w[303] * TURN(36) + w[315] * TURN(56) + w[327] * TURN(76) + w[339] * TURN(96) + b15;
  b15 = b14 + b15;
  b7 = w[625] * b7;
  b7 = w[593] * b5 - (w[529] * b11 + w[536] * b12 + w[543] * b13 + w[550] * b14 + w[557] * b15) + w[624] * b6 + b7;
  b2 = w[625] * b2;
  b2 = w[564] * b11 + w[571] * b12 + w[578] * b13 + w[585] * b14 + w[592] * b15 - w[593] * b0 - w[624] * b1 - b2;
  STORE(columns + 0, b8 - w[585] * b9 - w[592] * b10);
  STORE(columns + 12, b7 + w[626] * b9 + w[627] * b10);
  STORE(columns + 24, b2 - w[626] * b3 - w[627] * b4);
  STORE(columns + 36, EACH((-1.0)) * ((b15 * w[143] + b4 * w[144] + b10 * w[146]) / EACH(2.0)));
  STORE(columns + 48, (b15 * w[145] + b4 * w[146] - b10 * w[144]) / EACH(2.0));
  STORE(columns + 60, (b4 * w[145] - b15 * w[146] + b10 * w[143]) / EACH(2.0));
  STORE(columns + 72, (b15 * w[144] - b4 * w[143] + b10 * w[145]) / EACH(2.0));
}

static void MADE(follower_reissner_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 120, columns += 4) {
    EVERY_LANE(MADE(follower_reissner_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
