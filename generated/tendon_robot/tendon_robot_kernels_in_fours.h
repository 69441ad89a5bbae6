/* Included once for each width of vectors. */
static void MADE(tendon_robot_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = GIVEN(0) + (GIVEN(4) * GIVEN(20) - GIVEN(8) * GIVEN(16)) / EACH(12.0);
  b1 = GIVEN(4) + (GIVEN(8) * GIVEN(12) - GIVEN(0) * GIVEN(20)) / EACH(12.0);
  b2 = GIVEN(8) + (GIVEN(0) * GIVEN(16) - GIVEN(4) * GIVEN(12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH((-2.7557319223985893e-06)) + b3 * (EACH(2.505210838544172e-08) + b3 * (EACH((-1.6059043836821613e-10)) + b3 * (EACH(7.647163731819816e-13) + b3 * (EACH((-2.8114572543455206e-15)) + b3 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3)))));
  b4 = EACH(C[0]) + b3 * (EACH((-0.008333333333333333)) + b3 * (EACH(0.0001984126984126984) + b3 * b4));
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

static void MADE(tendon_robot_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(tendon_robot_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(tendon_robot_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = GIVEN(68) * GIVEN(80) + GIVEN(72) * GIVEN(84) + GIVEN(76) * GIVEN(88);
  b1 = GIVEN(44) * GIVEN(80) + GIVEN(48) * GIVEN(84) + GIVEN(52) * GIVEN(88);
  b2 = GIVEN(36) * GIVEN(36) / EACH(2.0);
  b3 = GIVEN(56) * GIVEN(80) + GIVEN(60) * GIVEN(84) + GIVEN(64) * GIVEN(88);
  b4 = GIVEN(40) * (GIVEN(32) * b1 - GIVEN(24) * b0) - b2 * b3;
  b5 = GIVEN(40) * (GIVEN(28) * b0 - GIVEN(32) * b3) - b2 * b1;
  b6 = b0 + (GIVEN(24) * b4 - GIVEN(28) * b5);
  b7 = EACH(C[1]) * b6;
  b0 = GIVEN(40) * (GIVEN(24) * b3 - GIVEN(28) * b1) - b2 * b0;
  b5 = b3 + (GIVEN(32) * b5 - GIVEN(24) * b0);
  b3 = EACH(C[1]) * b5;
  b4 = b1 + (GIVEN(28) * b0 - GIVEN(32) * b4);
  b0 = EACH(C[1]) * b4;
  STORE(made + 0, GIVEN(16) * b7 - GIVEN(20) * b3 + b4);
  STORE(made + 4, b5 - GIVEN(12) * b7 + GIVEN(20) * b0);
  STORE(made + 8, b6 + GIVEN(12) * b3 - GIVEN(16) * b0);
  STORE(made + 12, GIVEN(8) * b3 - GIVEN(4) * b7);
  STORE(made + 16, GIVEN(0) * b7 - GIVEN(8) * b0);
  STORE(made + 20, GIVEN(4) * b0 - GIVEN(0) * b3);
}

static void MADE(tendon_robot_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(tendon_robot_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(tendon_robot_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
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
  b15 = EACH(C[1]) * GIVEN(20);
  b10 = b10 + b0 * GIVEN(24);
  b13 = b0 * GIVEN(28) - b13;
  b8 = EACH(1.0) - (b3 + b8);
  b3 = GIVEN(44) * b10 + GIVEN(56) * b13 + GIVEN(68) * b8;
  b0 = EACH(C[1]) * GIVEN(16);
  b16 = GIVEN(48) * b4 + GIVEN(60) * b9 + GIVEN(72) * b11;
  b17 = GIVEN(48) * b7 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b18 = GIVEN(48) * b10 + GIVEN(60) * b13 + GIVEN(72) * b8;
  b11 = GIVEN(52) * b4 + GIVEN(64) * b9 + GIVEN(76) * b11;
  b2 = GIVEN(52) * b7 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b8 = GIVEN(52) * b10 + GIVEN(64) * b13 + GIVEN(76) * b8;
  b13 = EACH(C[1]) * GIVEN(12);
  b10 = EACH(C[1]) * GIVEN(8);
  b1 = EACH(C[1]) * GIVEN(4);
  b7 = EACH(C[1]) * GIVEN(0);
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
  b33 = EACH(C[1]) * (b9 + (GIVEN(24) * b31 - GIVEN(28) * b32));
  b9 = GIVEN(40) * (GIVEN(24) * b30 - GIVEN(28) * b19) - b6 * b9;
  b32 = EACH(C[1]) * (b30 + (GIVEN(32) * b32 - GIVEN(24) * b9));
  b30 = EACH((-1.0)) * b32;
  b6 = EACH((-1.0)) * b33;
  b31 = EACH(C[1]) * (b19 + (GIVEN(28) * b9 - GIVEN(32) * b31));
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

static void MADE(tendon_robot_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 156)
    EVERY_LANE(MADE(tendon_robot_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(tendon_robot_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
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
  b8 = EACH(C[1]) * (b0 + (GIVEN(24) * b5 - GIVEN(28) * b7));
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
  b14 = EACH(C[1]) * b13;
  b15 = GIVEN(24) * b4 - GIVEN(28) * b1;
  b16 = GIVEN(40) * b15 - b3 * b0;
  b17 = EACH(C[1]) * (b4 + (GIVEN(32) * b7 - GIVEN(24) * b16));
  b4 = b15 * GIVEN(132) + GIVEN(40) * (b4 * GIVEN(116) + GIVEN(24) * b12 - (b1 * GIVEN(120) + GIVEN(28) * b10));
  b9 = b4 - (b0 * b11 + b3 * b9);
  b6 = b12 + (b7 * GIVEN(124) + GIVEN(32) * b6 - (b16 * GIVEN(116) + GIVEN(24) * b9));
  b7 = EACH(C[1]) * b6;
  b2 = b10 + (b16 * GIVEN(120) + GIVEN(28) * b9 - (b5 * GIVEN(124) + GIVEN(32) * b2));
  b5 = EACH(C[1]) * (b1 + (GIVEN(28) * b16 - GIVEN(32) * b5));
  b16 = EACH(C[1]) * b2;
  STORE(made + 0, b8 * GIVEN(108) + GIVEN(16) * b14 - (b17 * GIVEN(112) + GIVEN(20) * b7) + b2);
  STORE(made + 4, b6 - (b8 * GIVEN(104) + GIVEN(12) * b14) + (b5 * GIVEN(112) + GIVEN(20) * b16));
  STORE(made + 8, b13 + (b17 * GIVEN(104) + GIVEN(12) * b7) - (b5 * GIVEN(108) + GIVEN(16) * b16));
  STORE(made + 12, b17 * GIVEN(100) + GIVEN(8) * b7 - (b8 * GIVEN(96) + GIVEN(4) * b14));
  STORE(made + 16, b8 * GIVEN(92) + GIVEN(0) * b14 - (b5 * GIVEN(100) + GIVEN(8) * b16));
  STORE(made + 20, b5 * GIVEN(96) + GIVEN(4) * b16 - (b17 * GIVEN(92) + GIVEN(0) * b7));
}

static void MADE(tendon_robot_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(tendon_robot_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(tendon_robot_kernels_chain_turn)(const casadi_real *given, casadi_real *made) {
  made[0] = given[0] * given[4] - given[1] * given[5] - given[2] * given[6] - given[3] * given[7];
  made[1] = given[0] * given[5] + given[1] * given[4] + given[2] * given[7] - given[3] * given[6];
  made[2] = given[0] * given[6] - given[1] * given[7] + given[2] * given[4] + given[3] * given[5];
  made[3] = given[0] * given[7] + given[1] * given[6] - given[2] * given[5] + given[3] * given[4];
}

static void MADE(tendon_robot_kernels_chain)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 8, made += 4)
    MADE(tendon_robot_kernels_chain_turn)(given, made);
}

static void MADE(tendon_robot_kernels_pull_turn)(const casadi_real *given, casadi_real *made) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7;
  a0 = given[17] * given[20] + given[18] * given[21] + given[19] * given[22];
  a1 = given[11] * given[20] + given[12] * given[21] + given[13] * given[22];
  a2 = given[9] * given[9] / 2.0;
  a3 = given[14] * given[20] + given[15] * given[21] + given[16] * given[22];
  a4 = given[10] * (given[8] * a1 - given[6] * a0) - a2 * a3;
  a5 = given[10] * (given[7] * a0 - given[8] * a3) - a2 * a1;
  a6 = a0 + (given[6] * a4 - given[7] * a5);
  a7 = C[1] * a6;
  a0 = given[10] * (given[6] * a3 - given[7] * a1) - a2 * a0;
  a5 = a3 + (given[8] * a5 - given[6] * a0);
  a3 = C[1] * a5;
  a4 = a1 + (given[7] * a0 - given[8] * a4);
  a0 = C[1] * a4;
  made[0] = given[4] * a7 - given[5] * a3 + a4;
  made[1] = a5 - given[3] * a7 + given[5] * a0;
  made[2] = a6 + given[3] * a3 - given[4] * a0;
  made[3] = given[2] * a3 - given[1] * a7;
  made[4] = given[0] * a7 - given[2] * a0;
  made[5] = given[1] * a0 - given[0] * a3;
}

static void MADE(tendon_robot_kernels_pull)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 23, made += 6)
    MADE(tendon_robot_kernels_pull_turn)(given, made);
}

static void MADE(tendon_robot_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
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
  b13 = EACH(C[1]) * GIVEN(20);
  b9 = b9 + b0 * GIVEN(24);
  b5 = b0 * GIVEN(28) - b5;
  b7 = EACH(1.0) - (b3 + b7);
  b3 = GIVEN(44) * b9 + GIVEN(56) * b5 + GIVEN(68) * b7;
  b0 = EACH(C[1]) * GIVEN(16);
  b14 = GIVEN(48) * b4 + GIVEN(60) * b8 + GIVEN(72) * b10;
  b15 = GIVEN(48) * b6 + GIVEN(60) * b1 + GIVEN(72) * b2;
  b16 = GIVEN(48) * b9 + GIVEN(60) * b5 + GIVEN(72) * b7;
  b10 = GIVEN(52) * b4 + GIVEN(64) * b8 + GIVEN(76) * b10;
  b2 = GIVEN(52) * b6 + GIVEN(64) * b1 + GIVEN(76) * b2;
  b7 = GIVEN(52) * b9 + GIVEN(64) * b5 + GIVEN(76) * b7;
  b5 = EACH(C[1]) * GIVEN(12);
  b9 = EACH(C[1]) * GIVEN(8);
  b1 = EACH(C[1]) * GIVEN(4);
  b6 = EACH(C[1]) * GIVEN(0);
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

static void MADE(tendon_robot_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 80, made += 72)
    EVERY_LANE(MADE(tendon_robot_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(tendon_robot_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2;
  b0 = w[505] * TURN(160);
  STORE(passed + 60, b0 = w[445] * TURN(0) + w[457] * TURN(32) + w[469] * TURN(64) + w[481] * TURN(96) + w[493] * TURN(128) + b0);
  b1 = w[506] * TURN(164);
  STORE(passed + 92, b1 = w[446] * TURN(4) + w[458] * TURN(36) + w[470] * TURN(68) + w[482] * TURN(100) + w[494] * TURN(132) + b1);
  STORE(passed + 52, b1 = b0 + b1);
  b0 = w[507] * TURN(168);
  STORE(passed + 116, b0 = w[447] * TURN(8) + w[459] * TURN(40) + w[471] * TURN(72) + w[483] * TURN(104) + w[495] * TURN(136) + b0);
  STORE(passed + 44, b0 = b1 + b0);
  b1 = w[508] * TURN(172);
  STORE(passed + 84, b1 = w[448] * TURN(12) + w[460] * TURN(44) + w[472] * TURN(76) + w[484] * TURN(108) + w[496] * TURN(140) + b1);
  STORE(passed + 36, b1 = b0 + b1);
  b0 = w[661] * TURN(176);
  STORE(passed + 192, b0 = w[601] * TURN(16) + w[613] * TURN(48) + w[625] * TURN(80) + w[637] * TURN(112) + w[649] * TURN(144) + b0);
  STORE(passed + 28, b0 = b1 + b0);
  b1 = w[662] * TURN(180);
  STORE(passed + 248, b1 = w[602] * TURN(20) + w[614] * TURN(52) + w[626] * TURN(84) + w[638] * TURN(116) + w[650] * TURN(148) + b1);
  STORE(passed + 20, b1 = b0 + b1);
  b0 = w[663] * TURN(184);
  STORE(passed + 276, b0 = w[603] * TURN(24) + w[615] * TURN(56) + w[627] * TURN(88) + w[639] * TURN(120) + w[651] * TURN(152) + b0);
  STORE(passed + 12, b0 = b1 + b0);
  b1 = w[664] * TURN(188);
  STORE(passed + 220, b1 = w[604] * TURN(28) + w[616] * TURN(60) + w[628] * TURN(92) + w[640] * TURN(124) + w[652] * TURN(156) + b1);
  STORE(passed + 76, b1 = b0 + b1);
  b0 = w[501] * TURN(160);
  STORE(passed + 64, b0 = w[441] * TURN(0) + w[453] * TURN(32) + w[465] * TURN(64) + w[477] * TURN(96) + w[489] * TURN(128) + b0);
  b2 = w[502] * TURN(164);
  STORE(passed + 88, b2 = w[442] * TURN(4) + w[454] * TURN(36) + w[466] * TURN(68) + w[478] * TURN(100) + w[490] * TURN(132) + b2);
  STORE(passed + 56, b2 = b0 + b2);
  b0 = w[503] * TURN(168);
  STORE(passed + 112, b0 = w[443] * TURN(8) + w[455] * TURN(40) + w[467] * TURN(72) + w[479] * TURN(104) + w[491] * TURN(136) + b0);
  STORE(passed + 48, b0 = b2 + b0);
  b2 = w[504] * TURN(172);
  STORE(passed + 80, b2 = w[444] * TURN(12) + w[456] * TURN(44) + w[468] * TURN(76) + w[480] * TURN(108) + w[492] * TURN(140) + b2);
  STORE(passed + 40, b2 = b0 + b2);
  b0 = w[657] * TURN(176);
  STORE(passed + 188, b0 = w[597] * TURN(16) + w[609] * TURN(48) + w[621] * TURN(80) + w[633] * TURN(112) + w[645] * TURN(144) + b0);
  STORE(passed + 32, b0 = b2 + b0);
  b2 = w[658] * TURN(180);
  STORE(passed + 244, b2 = w[598] * TURN(20) + w[610] * TURN(52) + w[622] * TURN(84) + w[634] * TURN(116) + w[646] * TURN(148) + b2);
  STORE(passed + 24, b2 = b0 + b2);
  b0 = w[659] * TURN(184);
  STORE(passed + 272, b0 = w[599] * TURN(24) + w[611] * TURN(56) + w[623] * TURN(88) + w[635] * TURN(120) + w[647] * TURN(152) + b0);
  STORE(passed + 16, b0 = b2 + b0);
  b2 = w[660] * TURN(188);
  STORE(passed + 216, b2 = w[600] * TURN(28) + w[612] * TURN(60) + w[624] * TURN(92) + w[636] * TURN(124) + w[648] * TURN(156) + b2);
  STORE(passed + 72, b2 = b0 + b2);
  STORE(passed + 8, w[985] * b1 - w[1034] * b2);
  b2 = w[509] * TURN(160);
  STORE(passed + 68, b2 = w[449] * TURN(0) + w[461] * TURN(32) + w[473] * TURN(64) + w[485] * TURN(96) + w[497] * TURN(128) + b2);
  b1 = w[510] * TURN(164);
  STORE(passed + 96, b1 = w[450] * TURN(4) + w[462] * TURN(36) + w[474] * TURN(68) + w[486] * TURN(100) + w[498] * TURN(132) + b1);
  STORE(passed + 4, b2 + b1);
  STORE(passed + 0, w[451] * TURN(8) + w[463] * TURN(40));
}

static void MADE(tendon_robot_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13;
  STORE(passed + 120, b0 = PASSED(0) + w[475] * TURN(72) + w[487] * TURN(104) + w[499] * TURN(136) + w[511] * TURN(168));
  b0 = PASSED(4) + b0;
  b1 = w[512] * TURN(172);
  b1 = w[452] * TURN(12) + w[464] * TURN(44) + w[476] * TURN(76) + w[488] * TURN(108) + w[500] * TURN(140) + b1;
  STORE(passed + 180, b2 = b0 + b1);
  b3 = w[665] * TURN(176);
  STORE(passed + 196, b3 = w[605] * TURN(16) + w[617] * TURN(48) + w[629] * TURN(80) + w[641] * TURN(112) + w[653] * TURN(144) + b3);
  STORE(passed + 236, b3 = b2 + b3);
  b4 = w[666] * TURN(180);
  STORE(passed + 252, b4 = w[606] * TURN(20) + w[618] * TURN(52) + w[630] * TURN(84) + w[642] * TURN(116) + w[654] * TURN(148) + b4);
  STORE(passed + 264, b4 = b3 + b4);
  b5 = w[667] * TURN(184);
  STORE(passed + 280, b5 = w[607] * TURN(24) + w[619] * TURN(56) + w[631] * TURN(88) + w[643] * TURN(120) + w[655] * TURN(152) + b5);
  STORE(passed + 208, b5 = b4 + b5);
  b6 = w[668] * TURN(188);
  STORE(passed + 224, b6 = w[608] * TURN(28) + w[620] * TURN(60) + w[632] * TURN(92) + w[644] * TURN(124) + w[656] * TURN(156) + b6);
  b6 = b5 + b6;
  STORE(passed + 212, b7 = PASSED(8) + w[1083] * b6);
  STORE(passed + 268, b7 = b7 + (w[1084] * PASSED(12) - w[1085] * PASSED(16) + w[1086] * b5));
  STORE(passed + 240, b7 = b7 + (w[1087] * PASSED(20) - w[1088] * PASSED(24) + w[1089] * b4));
  STORE(passed + 184, b7 = b7 + (w[1090] * PASSED(28) - w[1091] * PASSED(32) + w[1092] * b3));
  b7 = b7 + (w[1093] * PASSED(36) - w[1094] * PASSED(40) + w[1095] * b2);
  STORE(passed + 108, b8 = b7 + (w[1096] * PASSED(44) - w[1097] * PASSED(48) + w[1098] * b0));
  b8 = b8 + (w[1099] * PASSED(52) - w[1100] * PASSED(56) + w[1101] * PASSED(4));
  b9 = w[525] * PASSED(60);
  b10 = w[537] * PASSED(68);
  STORE(passed + 144, b10 = b8 + (w[1102] * PASSED(60) - w[1103] * PASSED(64) + w[1104] * PASSED(68)) + w[513] * PASSED(64) + b9 + b10);
  STORE(passed + 228, b9 = w[1108] * PASSED(72) - w[1109] * PASSED(76) + w[1110] * b6);
  STORE(passed + 284, b9 = b9 + (w[1111] * PASSED(16) - w[1112] * PASSED(12) + w[1113] * b5));
  STORE(passed + 256, b9 = b9 + (w[1114] * PASSED(24) - w[1115] * PASSED(20) + w[1116] * b4));
  STORE(passed + 200, b9 = b9 + (w[1117] * PASSED(32) - w[1118] * PASSED(28) + w[1119] * b3));
  b9 = b9 + (w[1120] * PASSED(40) - w[1121] * PASSED(36) + w[1122] * b2);
  STORE(passed + 124, b11 = b9 + (w[1123] * PASSED(48) - w[1124] * PASSED(44) + w[1125] * b0));
  b11 = b11 + (w[1126] * PASSED(56) - w[1127] * PASSED(52) + w[1128] * PASSED(4));
  b12 = w[529] * PASSED(60);
  b13 = w[541] * PASSED(68);
  STORE(passed + 148, b13 = b11 + (w[1129] * PASSED(64) - w[1130] * PASSED(60) + w[1131] * PASSED(68)) + w[517] * PASSED(64) + b12 + b13);
  STORE(passed + 232, b6 = w[1135] * PASSED(72) + w[1136] * PASSED(76) - w[1137] * b6);
  STORE(passed + 288, b5 = b6 + (w[1138] * PASSED(16) + w[1139] * PASSED(12) - w[1140] * b5));
  STORE(passed + 260, b4 = b5 + (w[1141] * PASSED(24) + w[1142] * PASSED(20) - w[1143] * b4));
  STORE(passed + 204, b3 = b4 + (w[1144] * PASSED(32) + w[1145] * PASSED(28) - w[1146] * b3));
  b2 = b3 + (w[1147] * PASSED(40) + w[1148] * PASSED(36) - w[1149] * b2);
  STORE(passed + 128, b3 = b2 + (w[1150] * PASSED(48) + w[1151] * PASSED(44) - w[1152] * b0));
  b3 = b3 + (w[1153] * PASSED(56) + w[1154] * PASSED(52) - w[1155] * PASSED(4));
  b4 = w[533] * PASSED(60);
  b5 = w[545] * PASSED(68);
  STORE(passed + 152, b5 = b3 + (w[1156] * PASSED(64) + w[1157] * PASSED(60) - w[1158] * PASSED(68)) + w[521] * PASSED(64) + b4 + b5);
  STORE(passed + 136, b5 = w[441] * b10 + w[445] * b13 + w[449] * b5 + w[581] * TURN(128) + w[589] * TURN(160));
  STORE(passed + 156, b7 = w[426] * b0 - w[437] * PASSED(44) + b7 + w[516] * PASSED(80) + w[528] * PASSED(84) + w[540] * b1);
  STORE(passed + 160, b9 = w[437] * PASSED(48) - w[407] * b0 + b9 + w[520] * PASSED(80) + w[532] * PASSED(84) + w[544] * b1);
  STORE(passed + 164, b1 = w[407] * PASSED(44) - w[426] * PASSED(48) + b2 + w[524] * PASSED(80) + w[536] * PASSED(84) + w[548] * b1);
  STORE(passed + 140, b1 = w[444] * b7 + w[448] * b9 + w[452] * b1 + w[584] * TURN(140) + w[592] * TURN(172));
  STORE(passed + 176, b1 = b5 + b1);
  STORE(passed + 132, EACH(C[2]) * b1);
  b1 = w[538] * PASSED(96);
  STORE(passed + 168, b1 = w[430] * PASSED(68) - w[439] * PASSED(60) + b8 + w[514] * PASSED(88) + w[526] * PASSED(92) + b1);
  b8 = w[542] * PASSED(96);
  STORE(passed + 172, b8 = w[439] * PASSED(64) - w[413] * PASSED(68) + b11 + w[518] * PASSED(88) + w[530] * PASSED(92) + b8);
  STORE(passed + 104, w[442] * b1 + w[446] * b8);
  b8 = w[546] * PASSED(96);
  b8 = w[413] * PASSED(60) - w[430] * PASSED(64) + b3 + w[522] * PASSED(88) + w[534] * PASSED(92) + b8;
  STORE(passed + 100, b8);
}

static void MADE(tendon_robot_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = PASSED(104) + w[450] * PASSED(100) + w[582] * TURN(132) + w[590] * TURN(164);
  b1 = w[539] * PASSED(120);
  STORE(passed + 364, b1 = w[428] * PASSED(4) - w[438] * PASSED(52) + PASSED(108) + w[515] * PASSED(112) + w[527] * PASSED(116) + b1);
  b2 = w[543] * PASSED(120);
  STORE(passed + 368, b2 = w[438] * PASSED(56) - w[410] * PASSED(4) + PASSED(124) + w[519] * PASSED(112) + w[531] * PASSED(116) + b2);
  b3 = w[547] * PASSED(120);
  STORE(passed + 372, b3 = w[410] * PASSED(52) - w[428] * PASSED(56) + PASSED(128) + w[523] * PASSED(112) + w[535] * PASSED(116) + b3);
  b4 = w[443] * b1 + w[447] * b2 + w[451] * b3 + w[583] * TURN(136) + w[591] * TURN(168);
  b5 = b0 + b4;
  STORE(passed + 392, PASSED(132) + EACH(C[3]) * b5);
  b6 = w[477] * PASSED(144) + w[481] * PASSED(148) + w[485] * PASSED(152) + w[557] * TURN(32) + w[565] * TURN(64);
  b7 = w[480] * PASSED(156) + w[484] * PASSED(160) + w[488] * PASSED(164) + w[560] * TURN(44) + w[568] * TURN(76);
  b8 = w[478] * PASSED(168) + w[482] * PASSED(172) + w[486] * PASSED(100) + w[558] * TURN(36) + w[566] * TURN(68);
  b3 = w[479] * b1 + w[483] * b2 + w[487] * b3 + w[559] * TURN(40) + w[567] * TURN(72);
  b4 = EACH(C[4]) * (PASSED(136) - PASSED(140)) + EACH(C[4]) * (b0 - b4) + EACH(C[5]) * (b6 + b7) + EACH(C[6]) * (b8 + b3);
  STORE(passed + 396, b4);
  STORE(passed + 400, EACH(C[7]) * PASSED(176) + EACH(C[8]) * b5 + EACH(C[9]) * (b6 - b7) + EACH(C[10]) * (b8 - b3));
  b3 = w[693] * PASSED(196);
  STORE(passed + 316, b3 = w[424] * PASSED(180) - w[436] * PASSED(36) + PASSED(184) + w[669] * PASSED(188) + w[681] * PASSED(192) + b3);
  b8 = w[697] * PASSED(196);
  STORE(passed + 320, b8 = w[436] * PASSED(40) - w[404] * PASSED(180) + PASSED(200) + w[673] * PASSED(188) + w[685] * PASSED(192) + b8);
  b7 = w[701] * PASSED(196);
  STORE(passed + 324, b7 = w[404] * PASSED(36) - w[424] * PASSED(40) + PASSED(204) + w[677] * PASSED(188) + w[689] * PASSED(192) + b7);
  STORE(passed + 308, b7 = w[597] * b3 + w[601] * b8 + w[605] * b7 + w[737] * TURN(144) + w[745] * TURN(176));
  b8 = w[696] * PASSED(224);
  STORE(passed + 328, b8 = w[418] * PASSED(208) - w[433] * PASSED(12) + PASSED(212) + w[672] * PASSED(216) + w[684] * PASSED(220) + b8);
  b3 = w[700] * PASSED(224);
  STORE(passed + 332, b3 = w[433] * PASSED(16) - w[395] * PASSED(208) + PASSED(228) + w[676] * PASSED(216) + w[688] * PASSED(220) + b3);
  b6 = w[704] * PASSED(224);
  STORE(passed + 336, b6 = w[395] * PASSED(12) - w[418] * PASSED(16) + PASSED(232) + w[680] * PASSED(216) + w[692] * PASSED(220) + b6);
  STORE(passed + 312, b6 = w[600] * b8 + w[604] * b3 + w[608] * b6 + w[740] * TURN(156) + w[748] * TURN(188));
  STORE(passed + 360, b6 = b7 + b6);
  STORE(passed + 304, EACH(C[2]) * b6);
  b6 = w[694] * PASSED(252);
  STORE(passed + 340, b6 = w[422] * PASSED(236) - w[435] * PASSED(28) + PASSED(240) + w[670] * PASSED(244) + w[682] * PASSED(248) + b6);
  b7 = w[698] * PASSED(252);
  STORE(passed + 344, b7 = w[435] * PASSED(32) - w[401] * PASSED(236) + PASSED(256) + w[674] * PASSED(244) + w[686] * PASSED(248) + b7);
  b3 = w[702] * PASSED(252);
  STORE(passed + 348, b3 = w[401] * PASSED(28) - w[422] * PASSED(32) + PASSED(260) + w[678] * PASSED(244) + w[690] * PASSED(248) + b3);
  STORE(passed + 300, w[598] * b6 + w[602] * b7 + w[606] * b3 + w[738] * TURN(148) + w[746] * TURN(180));
  b3 = w[695] * PASSED(280);
  STORE(passed + 352, b3 = w[420] * PASSED(264) - w[434] * PASSED(20) + PASSED(268) + w[671] * PASSED(272) + w[683] * PASSED(276) + b3);
  b7 = w[699] * PASSED(280);
  STORE(passed + 356, b7 = w[434] * PASSED(24) - w[398] * PASSED(264) + PASSED(284) + w[675] * PASSED(272) + w[687] * PASSED(276) + b7);
  STORE(passed + 296, w[599] * b3 + w[603] * b7);
  b7 = w[398] * PASSED(20) - w[420] * PASSED(24) + PASSED(288) + w[679] * PASSED(272) + w[691] * PASSED(276);
  STORE(passed + 292, b7);
}

static void MADE(tendon_robot_k_jacobian_columns_3)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10;
  STORE(passed + 380, b0 = PASSED(292) + w[703] * PASSED(280));
  b1 = PASSED(296) + w[607] * b0 + w[739] * TURN(152) + w[747] * TURN(184);
  b2 = PASSED(300) + b1;
  STORE(passed + 404, PASSED(304) + EACH(C[3]) * b2);
  b3 = w[633] * PASSED(316) + w[637] * PASSED(320) + w[641] * PASSED(324) + w[713] * TURN(48) + w[721] * TURN(80);
  b4 = w[636] * PASSED(328) + w[640] * PASSED(332) + w[644] * PASSED(336) + w[716] * TURN(60) + w[724] * TURN(92);
  b5 = w[634] * PASSED(340) + w[638] * PASSED(344) + w[642] * PASSED(348) + w[714] * TURN(52) + w[722] * TURN(84);
  b6 = w[635] * PASSED(352) + w[639] * PASSED(356) + w[643] * b0 + w[715] * TURN(56) + w[723] * TURN(88);
  b7 = EACH(C[6]) * (b5 + b6);
  b7 = EACH(C[4]) * (PASSED(308) - PASSED(312)) + EACH(C[4]) * (PASSED(300) - b1) + EACH(C[5]) * (b3 + b4) + b7;
  STORE(passed + 408, b7);
  STORE(passed + 412, EACH(C[7]) * PASSED(360) + EACH(C[8]) * b2 + EACH(C[9]) * (b3 - b4) + EACH(C[10]) * (b5 - b6));
  b6 = w[453] * PASSED(144) + w[457] * PASSED(148) + w[461] * PASSED(152) + w[573] * TURN(96) + w[593] * TURN(160);
  b5 = w[456] * PASSED(156) + w[460] * PASSED(160) + w[464] * PASSED(164) + w[576] * TURN(108) + w[596] * TURN(172);
  b4 = b6 + b5;
  b3 = w[454] * PASSED(168) + w[458] * PASSED(172) + w[462] * PASSED(100) + w[574] * TURN(100) + w[594] * TURN(164);
  b2 = w[455] * PASSED(364) + w[459] * PASSED(368) + w[463] * PASSED(372) + w[575] * TURN(104) + w[595] * TURN(168);
  b7 = b3 + b2;
  STORE(passed + 416, EACH(C[2]) * b4 + EACH(C[3]) * b7);
  b1 = w[489] * PASSED(144) + w[493] * PASSED(148) + w[497] * PASSED(152) + w[549] * TURN(0) + w[569] * TURN(64);
  b8 = w[492] * PASSED(156) + w[496] * PASSED(160) + w[500] * PASSED(164) + w[552] * TURN(12) + w[572] * TURN(76);
  b9 = w[490] * PASSED(168) + w[494] * PASSED(172) + w[498] * PASSED(100) + w[550] * TURN(4) + w[570] * TURN(68);
  b10 = w[491] * PASSED(364) + w[495] * PASSED(368) + w[499] * PASSED(372) + w[551] * TURN(8) + w[571] * TURN(72);
  b2 = EACH(C[4]) * (b6 - b5) + EACH(C[4]) * (b3 - b2) + EACH(C[5]) * (b1 + b8) + EACH(C[6]) * (b9 + b10);
  STORE(passed + 420, b2);
  STORE(passed + 424, EACH(C[7]) * b4 + EACH(C[8]) * b7 + EACH(C[9]) * (b1 - b8) + EACH(C[10]) * (b9 - b10));
  b10 = w[609] * PASSED(316) + w[613] * PASSED(320) + w[617] * PASSED(324) + w[729] * TURN(112) + w[749] * TURN(176);
  b9 = w[612] * PASSED(328) + w[616] * PASSED(332) + w[620] * PASSED(336) + w[732] * TURN(124) + w[752] * TURN(188);
  STORE(passed + 384, b8 = b10 + b9);
  b1 = w[610] * PASSED(340) + w[614] * PASSED(344) + w[618] * PASSED(348) + w[730] * TURN(116) + w[750] * TURN(180);
  b0 = w[611] * PASSED(352) + w[615] * PASSED(356) + w[619] * b0 + w[731] * TURN(120) + w[751] * TURN(184);
  STORE(passed + 388, b7 = b1 + b0);
  STORE(passed + 428, EACH(C[2]) * b8 + EACH(C[3]) * b7);
  STORE(passed + 376, EACH(C[4]) * (b10 - b9) + EACH(C[4]) * (b1 - b0));
}

static void MADE(tendon_robot_k_jacobian_columns_4)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23;
  b0 = w[645] * PASSED(316) + w[649] * PASSED(320) + w[653] * PASSED(324) + w[705] * TURN(16) + w[725] * TURN(80);
  b1 = w[648] * PASSED(328) + w[652] * PASSED(332) + w[656] * PASSED(336) + w[708] * TURN(28) + w[728] * TURN(92);
  b2 = w[646] * PASSED(340) + w[650] * PASSED(344) + w[654] * PASSED(348) + w[706] * TURN(20) + w[726] * TURN(84);
  b3 = w[647] * PASSED(352) + w[651] * PASSED(356) + w[655] * PASSED(380) + w[707] * TURN(24) + w[727] * TURN(88);
  b4 = w[465] * PASSED(144) + w[469] * PASSED(148) + w[473] * PASSED(152) + w[577] * TURN(96) + w[585] * TURN(128);
  b5 = w[468] * PASSED(156) + w[472] * PASSED(160) + w[476] * PASSED(164) + w[580] * TURN(108) + w[588] * TURN(140);
  b6 = b4 + b5;
  b7 = w[466] * PASSED(168) + w[470] * PASSED(172) + w[474] * PASSED(100) + w[578] * TURN(100) + w[586] * TURN(132);
  b8 = w[467] * PASSED(364) + w[471] * PASSED(368) + w[475] * PASSED(372) + w[579] * TURN(104) + w[587] * TURN(136);
  b9 = b7 + b8;
  b10 = w[501] * PASSED(144) + w[505] * PASSED(148) + w[509] * PASSED(152) + w[553] * TURN(0) + w[561] * TURN(32);
  b11 = w[504] * PASSED(156) + w[508] * PASSED(160) + w[512] * PASSED(164) + w[556] * TURN(12) + w[564] * TURN(44);
  b12 = w[502] * PASSED(168) + w[506] * PASSED(172) + w[510] * PASSED(100) + w[554] * TURN(4) + w[562] * TURN(36);
  b13 = w[503] * PASSED(364) + w[507] * PASSED(368) + w[511] * PASSED(372) + w[555] * TURN(8) + w[563] * TURN(40);
  b14 = w[621] * PASSED(316) + w[625] * PASSED(320) + w[629] * PASSED(324) + w[733] * TURN(112) + w[741] * TURN(144);
  b15 = w[624] * PASSED(328) + w[628] * PASSED(332) + w[632] * PASSED(336) + w[736] * TURN(124) + w[744] * TURN(156);
  b16 = b14 + b15;
  b17 = w[622] * PASSED(340) + w[626] * PASSED(344) + w[630] * PASSED(348) + w[734] * TURN(116) + w[742] * TURN(148);
  b18 = w[623] * PASSED(352) + w[627] * PASSED(356) + w[631] * PASSED(380) + w[735] * TURN(120) + w[743] * TURN(152);
  b19 = b17 + b18;
  b20 = w[657] * PASSED(316) + w[661] * PASSED(320) + w[665] * PASSED(324) + w[709] * TURN(16) + w[717] * TURN(48);
  b21 = w[660] * PASSED(328) + w[664] * PASSED(332) + w[668] * PASSED(336) + w[712] * TURN(28) + w[720] * TURN(60);
  b22 = w[658] * PASSED(340) + w[662] * PASSED(344) + w[666] * PASSED(348) + w[710] * TURN(20) + w[718] * TURN(52);
  b23 = w[659] * PASSED(352) + w[663] * PASSED(356) + w[667] * PASSED(380) + w[711] * TURN(24) + w[719] * TURN(56);
  STORE(columns + 0, PASSED(392));
  STORE(columns + 20, PASSED(396));
  STORE(columns + 40, PASSED(400));
  STORE(columns + 60, PASSED(404));
  STORE(columns + 80, PASSED(408));
  STORE(columns + 100, PASSED(412));
  STORE(columns + 120, PASSED(416));
  STORE(columns + 140, PASSED(420));
  STORE(columns + 160, PASSED(424));
  STORE(columns + 180, PASSED(428));
  STORE(columns + 200, PASSED(376) + EACH(C[5]) * (b0 + b1) + EACH(C[6]) * (b2 + b3));
  b3 = EACH(C[7]) * PASSED(384) + EACH(C[8]) * PASSED(388) + EACH(C[9]) * (b0 - b1) + EACH(C[10]) * (b2 - b3);
  STORE(columns + 220, b3);
  STORE(columns + 240, EACH(C[11]) * b6 + EACH(C[12]) * b9);
  b8 = EACH(C[13]) * (b4 - b5) + EACH(C[13]) * (b7 - b8) + EACH(C[14]) * (b10 + b11) + EACH(C[15]) * (b12 + b13);
  STORE(columns + 260, b8);
  STORE(columns + 280, EACH(C[16]) * b6 + EACH(C[17]) * b9 + EACH(C[18]) * (b10 - b11) + EACH(C[19]) * (b12 - b13));
  STORE(columns + 300, EACH(C[11]) * b16 + EACH(C[12]) * b19);
  b18 = EACH(C[13]) * (b14 - b15) + EACH(C[13]) * (b17 - b18) + EACH(C[14]) * (b20 + b21) + EACH(C[15]) * (b22 + b23);
  STORE(columns + 320, b18);
  STORE(columns + 340, EACH(C[16]) * b16 + EACH(C[17]) * b19 + EACH(C[18]) * (b20 - b21) + EACH(C[19]) * (b22 - b23));
}

static void MADE(tendon_robot_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 192, columns += 4) {
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_2)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_3)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_4)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_0)(casadi_real *w) {
  FOR_FOURS(i, 18) {
    STORE(w + 66 + i, LOAD(w + 1 + i) + LOAD(w + 19 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_2)(casadi_real *w) {
  FOR_FOURS(i, 36) {
    STORE(w + 208 + i, LOAD(tendon_robot_kernels_table_3 + i) * LOAD(w + 244 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_3)(casadi_real *w) {
  FOR_FOURS(i, 60) {
    STORE(w + 370 + i, LOAD(w + 84 + i) + LOAD(w + 144 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_7)(casadi_real *w) {
  FOR_FOURS(i, 24) {
    STORE(w + 430 + i, SPREAD(w[204]) * LOAD(w + 108 + i));
    STORE(w + 454 + i, SPREAD(w[205]) * LOAD(w + 76 + i));
    STORE(w + 478 + i, SPREAD(w[206]) * LOAD(w + 132 + i));
    STORE(w + 502 + i, SPREAD(w[207]) * LOAD(w + 166 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_8)(casadi_real *w) {
  FOR_FOURS(i, 12) {
    STORE(w + 78 + i, LOAD(w + 442 + i) + LOAD(w + 466 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_9)(casadi_real *w) {
  FOR_FOURS(i, 24) {
    STORE(w + 108 + i, LOAD(w + 132 + i) + LOAD(w + 478 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_10)(casadi_real *w) {
  FOR_FOURS(i, 24) {
    STORE(w + 132 + i, LOAD(w + 160 + i) + LOAD(w + 502 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_11)(casadi_real *w) {
  FOR_FOURS(i, 19) {
    FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
    b0 = EACH(2.0) * LOAD(w + 787 + i);
    b1 = b0 * LOAD(w + 787 + i);
    b2 = EACH(2.0) * LOAD(w + 806 + i) * LOAD(w + 806 + i);
    b3 = EACH(2.0) * LOAD(w + 825 + i);
    b4 = b3 * LOAD(w + 787 + i);
    b5 = EACH(2.0) * LOAD(w + 844 + i);
    b6 = b5 * LOAD(w + 806 + i);
    b7 = b3 * LOAD(w + 806 + i);
    b8 = b5 * LOAD(w + 787 + i);
    b3 = EACH(1.0) - b3 * LOAD(w + 825 + i);
    b0 = b0 * LOAD(w + 806 + i);
    b5 = b5 * LOAD(w + 825 + i);
    STORE(w + 430 + i, EACH(1.0) - b1 - b2);
    STORE(w + 449 + i, b4 + b6);
    STORE(w + 468 + i, b7 - b8);
    STORE(w + 487 + i, b4 - b6);
    STORE(w + 506 + i, b3 - b2);
    STORE(w + 525 + i, b0 + b5);
    STORE(w + 730 + i, b7 + b8);
    STORE(w + 749 + i, b0 - b5);
    STORE(w + 768 + i, b3 - b1);
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_12)(casadi_real *w) {
  FOR_FOURS(i, 20) {
    FOUR b0, b1, b2;
    b0 = EACH(0.4) * LOAD(w + 863 + i);
    b1 = EACH(0.4) * LOAD(w + 883 + i);
    b2 = EACH(0.4) * LOAD(w + 903 + i);
    STORE(w + 66 + i, b0);
    STORE(w + 156 + i, b1);
    STORE(w + 176 + i, b2);
    STORE(w + 787 + i, b1 * LOAD(w + 410 + i) - b2 * LOAD(w + 390 + i));
    STORE(w + 807 + i, b2 * LOAD(w + 370 + i) - b0 * LOAD(w + 410 + i));
    STORE(w + 827 + i, b0 * LOAD(w + 390 + i) - b1 * LOAD(w + 370 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_14)(casadi_real *w) {
  FOR_FOURS(i, 36) {
    STORE(w + 244 + i, LOAD(w + 208 + i) + LOAD(w + 280 + i) + LOAD(w + 316 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_15)(casadi_real *w) {
  FOR_FOURS(i, 18) {
    STORE(w + 66 + i, LOAD(w + 244 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_17)(casadi_real *w) {
  FOR_FOURS(i, 18) {
    STORE(w + 66 + i, EACH((-1.0)) * LOAD(w + 104 + i));
  }
}

static void MADE(tendon_robot_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = w[313] * TURN(160);
  STORE(passed + 28, b0 = w[253] * TURN(0) + w[265] * TURN(32) + w[277] * TURN(64) + w[289] * TURN(96) + w[301] * TURN(128) + b0);
  b1 = w[314] * TURN(164);
  b1 = w[254] * TURN(4) + w[266] * TURN(36) + w[278] * TURN(68) + w[290] * TURN(100) + w[302] * TURN(132) + b1;
  STORE(passed + 32, b1 = b0 + b1);
  b2 = w[315] * TURN(168);
  b2 = w[255] * TURN(8) + w[267] * TURN(40) + w[279] * TURN(72) + w[291] * TURN(104) + w[303] * TURN(136) + b2;
  STORE(passed + 36, b2 = b1 + b2);
  b3 = w[316] * TURN(172);
  b3 = w[256] * TURN(12) + w[268] * TURN(44) + w[280] * TURN(76) + w[292] * TURN(108) + w[304] * TURN(140) + b3;
  STORE(passed + 40, b3 = b2 + b3);
  b4 = w[580] * b3;
  b5 = w[385] * TURN(176);
  b5 = w[325] * TURN(16) + w[337] * TURN(48) + w[349] * TURN(80) + w[361] * TURN(112) + w[373] * TURN(144) + b5;
  STORE(passed + 44, b5 = b3 + b5);
  b3 = w[386] * TURN(180);
  b3 = w[326] * TURN(20) + w[338] * TURN(52) + w[350] * TURN(84) + w[362] * TURN(116) + w[374] * TURN(148) + b3;
  STORE(passed + 48, b3 = b5 + b3);
  b6 = w[387] * TURN(184);
  b6 = w[327] * TURN(24) + w[339] * TURN(56) + w[351] * TURN(88) + w[363] * TURN(120) + w[375] * TURN(152) + b6;
  STORE(passed + 52, b6 = b3 + b6);
  b7 = w[388] * TURN(188);
  b7 = w[328] * TURN(28) + w[340] * TURN(60) + w[352] * TURN(92) + w[364] * TURN(124) + w[376] * TURN(156) + b7;
  STORE(passed + 56, b7 = b6 + b7);
  b7 = w[608] * b7;
  b8 = w[317] * TURN(160);
  STORE(passed + 12, b8 = w[257] * TURN(0) + w[269] * TURN(32) + w[281] * TURN(64) + w[293] * TURN(96) + w[305] * TURN(128) + b8);
  b7 = w[559] * b0 + w[566] * b1 + w[573] * b2 + b4 + b4 + w[587] * b5 + w[594] * b3 + w[601] * b6 + b7;
  b6 = w[318] * TURN(164);
  b6 = w[258] * TURN(4) + w[270] * TURN(36) + w[282] * TURN(68) + w[294] * TURN(100) + w[306] * TURN(132) + b6;
  STORE(passed + 16, b6 = b8 + b6);
  b3 = w[319] * TURN(168);
  b3 = w[259] * TURN(8) + w[271] * TURN(40) + w[283] * TURN(72) + w[295] * TURN(104) + w[307] * TURN(136) + b3;
  STORE(passed + 20, b3 = b6 + b3);
  b5 = w[320] * TURN(172);
  b5 = w[260] * TURN(12) + w[272] * TURN(44) + w[284] * TURN(76) + w[296] * TURN(108) + w[308] * TURN(140) + b5;
  STORE(passed + 24, b5 = b3 + b5);
  b4 = w[636] * b5;
  b2 = w[389] * TURN(176);
  b2 = w[329] * TURN(16) + w[341] * TURN(48) + w[353] * TURN(80) + w[365] * TURN(112) + w[377] * TURN(144) + b2;
  STORE(passed + 4, b2 = b5 + b2);
  STORE(passed + 8, b7 - w[615] * b8 - w[622] * b6 - w[629] * b3 - b4 - b4 - w[643] * b2);
  STORE(passed + 0, w[330] * TURN(20));
}

static void MADE(tendon_robot_k_tip_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13;
  b0 = w[390] * TURN(180);
  b0 = PASSED(0) + w[342] * TURN(52) + w[354] * TURN(84) + w[366] * TURN(116) + w[378] * TURN(148) + b0;
  b0 = PASSED(4) + b0;
  b1 = w[391] * TURN(184);
  b1 = w[331] * TURN(24) + w[343] * TURN(56) + w[355] * TURN(88) + w[367] * TURN(120) + w[379] * TURN(152) + b1;
  b1 = b0 + b1;
  b2 = w[392] * TURN(188);
  b2 = w[332] * TURN(28) + w[344] * TURN(60) + w[356] * TURN(92) + w[368] * TURN(124) + w[380] * TURN(156) + b2;
  b2 = b1 + b2;
  b3 = w[309] * TURN(160);
  b3 = w[249] * TURN(0) + w[261] * TURN(32) + w[273] * TURN(64) + w[285] * TURN(96) + w[297] * TURN(128) + b3;
  b4 = w[310] * TURN(164);
  b4 = w[250] * TURN(4) + w[262] * TURN(36) + w[274] * TURN(68) + w[286] * TURN(100) + w[298] * TURN(132) + b4;
  b4 = b3 + b4;
  b5 = w[311] * TURN(168);
  b5 = w[251] * TURN(8) + w[263] * TURN(40) + w[275] * TURN(72) + w[287] * TURN(104) + w[299] * TURN(136) + b5;
  b5 = b4 + b5;
  b6 = w[312] * TURN(172);
  b6 = w[252] * TURN(12) + w[264] * TURN(44) + w[276] * TURN(76) + w[288] * TURN(108) + w[300] * TURN(140) + b6;
  b6 = b5 + b6;
  b7 = w[580] * b6;
  b8 = w[381] * TURN(176);
  b8 = w[321] * TURN(16) + w[333] * TURN(48) + w[345] * TURN(80) + w[357] * TURN(112) + w[369] * TURN(144) + b8;
  b8 = b6 + b8;
  b9 = w[382] * TURN(180);
  b9 = w[322] * TURN(20) + w[334] * TURN(52) + w[346] * TURN(84) + w[358] * TURN(116) + w[370] * TURN(148) + b9;
  b9 = b8 + b9;
  b10 = w[383] * TURN(184);
  b10 = w[323] * TURN(24) + w[335] * TURN(56) + w[347] * TURN(88) + w[359] * TURN(120) + w[371] * TURN(152) + b10;
  b10 = b9 + b10;
  b11 = w[384] * TURN(188);
  b11 = w[324] * TURN(28) + w[336] * TURN(60) + w[348] * TURN(92) + w[360] * TURN(124) + w[372] * TURN(156) + b11;
  b11 = b10 + b11;
  b12 = w[608] * b11;
  b12 = w[559] * b3 + w[566] * b4 + w[573] * b5 + b7 + b7 + w[587] * b8 + w[594] * b9 + w[601] * b10 + b12;
  b7 = w[716] * PASSED(24);
  b13 = w[718] * b0;
  b13 = w[665] * PASSED(12) - b12 + w[714] * PASSED(16) + w[715] * PASSED(20) + b7 + b7 + w[717] * PASSED(4) + b13;
  b6 = w[636] * b6;
  b7 = w[664] * b11;
  b7 = w[615] * b3 + w[622] * b4 + w[629] * b5 + b6 + b6 + w[643] * b8 + w[650] * b9 + w[657] * b10 + b7;
  b10 = w[716] * PASSED(40);
  b9 = w[718] * PASSED(48);
  b9 = b7 - w[665] * PASSED(28) - w[714] * PASSED(32) - w[715] * PASSED(36) - b10 - b10 - w[717] * PASSED(44) - b9;
  STORE(columns + 0, PASSED(8) - w[650] * b0 - w[657] * b1 - w[664] * b2);
  STORE(columns + 20, b13 + w[719] * b1 + w[720] * b2);
  STORE(columns + 40, b9 - w[719] * PASSED(52) - w[720] * PASSED(56));
  STORE(columns + 60, EACH((-1.0)) * ((b11 * w[171] + PASSED(56) * w[168] + b2 * w[169]) / EACH(2.0)));
  STORE(columns + 80, (b11 * w[170] + PASSED(56) * w[169] - b2 * w[168]) / EACH(2.0));
  STORE(columns + 100, (PASSED(56) * w[170] - b11 * w[169] + b2 * w[171]) / EACH(2.0));
  STORE(columns + 120, (b11 * w[168] - PASSED(56) * w[171] + b2 * w[170]) / EACH(2.0));
}

static void MADE(tendon_robot_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 192, columns += 4) {
    EVERY_LANE(MADE(tendon_robot_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(tendon_robot_k_tip_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}
