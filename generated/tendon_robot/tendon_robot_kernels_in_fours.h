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

static void MADE(tendon_robot_kernels_turned_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5;
  b0 = p0[48] * LOAD(p1 + 128);
  b1 = p0[60] * LOAD(p1 + 160);
  b2 = p0[52] * LOAD(p1 + 128);
  b3 = p0[64] * LOAD(p1 + 160);
  b4 = p0[56] * LOAD(p1 + 128);
  b5 = p0[68] * LOAD(p1 + 160);
  b1 = p0[0] * LOAD(p1 + 0) + p0[12] * LOAD(p1 + 32) + p0[24] * LOAD(p1 + 64) + p0[36] * LOAD(p1 + 96) + b0 + b1;
  STORE(made + 0, b1);
  b3 = p0[4] * LOAD(p1 + 0) + p0[16] * LOAD(p1 + 32) + p0[28] * LOAD(p1 + 64) + p0[40] * LOAD(p1 + 96) + b2 + b3;
  STORE(made + 4, b3);
  b5 = p0[8] * LOAD(p1 + 0) + p0[20] * LOAD(p1 + 32) + p0[32] * LOAD(p1 + 64) + p0[44] * LOAD(p1 + 96) + b4 + b5;
  STORE(made + 8, b5);
}

static void MADE(tendon_robot_kernels_pulled_of_column)(const casadi_real *p0, const casadi_real *p1, const casadi_real *p2, const casadi_real *p3, const casadi_real *p4, const casadi_real *p5, casadi_real *made) {
  FOUR b0, b1, b2, b3;
  b0 = LOAD(p5 + 0) + (p1[0] * LOAD(p4 + 0) + p1[12] * LOAD(p4 + 4) + p1[24] * LOAD(p4 + 8));
  b1 = LOAD(p5 + 4) + (p1[4] * LOAD(p4 + 0) + p1[16] * LOAD(p4 + 4) + p1[28] * LOAD(p4 + 8));
  b2 = LOAD(p5 + 8) + (p1[8] * LOAD(p4 + 0) + p1[20] * LOAD(p4 + 4) + p1[32] * LOAD(p4 + 8));
  b3 = p0[0] * b0 + p0[4] * b1 + p0[8] * b2 + (p2[32] * LOAD(p3 + 128) + p2[40] * LOAD(p3 + 160));
  STORE(made + 0, b3);
  b3 = p0[12] * b0 + p0[16] * b1 + p0[20] * b2 + (p2[24] * LOAD(p3 + 96) + p2[44] * LOAD(p3 + 160));
  STORE(made + 4, b3);
  b3 = p0[24] * b0 + p0[28] * b1 + p0[32] * b2 + (p2[28] * LOAD(p3 + 96) + p2[36] * LOAD(p3 + 128));
  STORE(made + 8, b3);
  b3 = p0[36] * b0 + p0[40] * b1 + p0[44] * b2 + (p2[8] * LOAD(p3 + 32) + p2[16] * LOAD(p3 + 64));
  STORE(made + 12, b3);
  b3 = p0[48] * b0 + p0[52] * b1 + p0[56] * b2 + (p2[0] * LOAD(p3 + 0) + p2[20] * LOAD(p3 + 64));
  STORE(made + 16, b3);
  b2 = p0[60] * b0 + p0[64] * b1 + p0[68] * b2 + (p2[4] * LOAD(p3 + 0) + p2[12] * LOAD(p3 + 32));
  STORE(made + 20, b2);
}

static void MADE(tendon_robot_kernels_fold_of_column)(const casadi_real *p0, const casadi_real *p1, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = LOAD(p1 + 0) + LOAD(p1 + 72);
  b1 = LOAD(p1 + 24) + LOAD(p1 + 48);
  b2 = (LOAD(p1 + 12) + LOAD(p1 + 84)) * p0[4];
  b3 = (LOAD(p1 + 36) + LOAD(p1 + 60)) * p0[5];
  b4 = LOAD(p1 + 96) + LOAD(p1 + 168);
  b5 = LOAD(p1 + 120) + LOAD(p1 + 144);
  b6 = (LOAD(p1 + 108) + LOAD(p1 + 180)) * p0[14];
  b7 = (LOAD(p1 + 132) + LOAD(p1 + 156)) * p0[15];
  b8 = (LOAD(p1 + 132) - LOAD(p1 + 156)) * p0[19];
  STORE(made + 0, b0 * p0[0] + b1 * p0[1]);
  STORE(made + 4, (LOAD(p1 + 0) - LOAD(p1 + 72)) * p0[2] + (LOAD(p1 + 24) - LOAD(p1 + 48)) * p0[3] + b2 + b3);
  b1 = b0 * p0[6] + b1 * p0[7] + (LOAD(p1 + 12) - LOAD(p1 + 84)) * p0[8] + (LOAD(p1 + 36) - LOAD(p1 + 60)) * p0[9];
  STORE(made + 8, b1);
  STORE(made + 12, b4 * p0[10] + b5 * p0[11]);
  b7 = (LOAD(p1 + 96) - LOAD(p1 + 168)) * p0[12] + (LOAD(p1 + 120) - LOAD(p1 + 144)) * p0[13] + b6 + b7;
  STORE(made + 16, b7);
  STORE(made + 20, b4 * p0[16] + b5 * p0[17] + (LOAD(p1 + 108) - LOAD(p1 + 180)) * p0[18] + b8);
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
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21;
  MADE(tendon_robot_kernels_turned_of_column)(w + 489, turns + 0, passed + 0);
  MADE(tendon_robot_kernels_turned_of_column)(w + 490, turns + 4, passed + 12);
  STORE(passed + 500, b0 = PASSED(4) + PASSED(16));
  MADE(tendon_robot_kernels_turned_of_column)(w + 491, turns + 8, passed + 24);
  STORE(passed + 488, b1 = b0 + PASSED(28));
  MADE(tendon_robot_kernels_turned_of_column)(w + 492, turns + 12, passed + 36);
  STORE(passed + 476, b2 = b1 + PASSED(40));
  MADE(tendon_robot_kernels_turned_of_column)(w + 645, turns + 16, passed + 48);
  STORE(passed + 460, b3 = b2 + PASSED(52));
  MADE(tendon_robot_kernels_turned_of_column)(w + 646, turns + 20, passed + 60);
  STORE(passed + 552, b4 = b3 + PASSED(64));
  MADE(tendon_robot_kernels_turned_of_column)(w + 647, turns + 24, passed + 72);
  STORE(passed + 576, b5 = b4 + PASSED(76));
  MADE(tendon_robot_kernels_turned_of_column)(w + 648, turns + 28, passed + 84);
  b6 = b5 + PASSED(88);
  STORE(passed + 496, b7 = PASSED(0) + PASSED(12));
  STORE(passed + 484, b8 = b7 + PASSED(24));
  STORE(passed + 472, b9 = b8 + PASSED(36));
  STORE(passed + 456, b10 = b9 + PASSED(48));
  STORE(passed + 560, b11 = b10 + PASSED(60));
  STORE(passed + 584, b12 = b11 + PASSED(72));
  b13 = b12 + PASSED(84);
  STORE(passed + 504, b14 = PASSED(8) + PASSED(20));
  STORE(passed + 492, b15 = b14 + PASSED(32));
  STORE(passed + 480, b16 = b15 + PASSED(44));
  STORE(passed + 464, b17 = b16 + PASSED(56));
  STORE(passed + 548, b18 = b17 + PASSED(68));
  STORE(passed + 572, b19 = b18 + PASSED(80));
  b20 = b19 + PASSED(92);
  STORE(passed + 580, b21 = w[1129] * b6 - w[1130] * b13 + w[1131] * b20);
  STORE(passed + 556, b21 = b21 + (w[1132] * b5 - w[1133] * b12 + w[1134] * b19));
  STORE(passed + 540, b21 = b21 + (w[1135] * b4 - w[1136] * b11 + w[1137] * b18));
  STORE(passed + 532, b21 = b21 + (w[1138] * b3 - w[1139] * b10 + w[1140] * b17));
  STORE(passed + 524, b21 = b21 + (w[1141] * b2 - w[1142] * b9 + w[1143] * b16));
  STORE(passed + 516, b21 = b21 + (w[1144] * b1 - w[1145] * b8 + w[1146] * b15));
  STORE(passed + 508, b21 = b21 + (w[1147] * b0 - w[1148] * b7 + w[1149] * b14));
  STORE(passed + 360, b21 + (w[1150] * PASSED(4) - w[1151] * PASSED(0) + w[1152] * PASSED(8)));
  STORE(passed + 588, b21 = w[1153] * b13 - w[1154] * b6 + w[1155] * b20);
  STORE(passed + 564, b21 = b21 + (w[1156] * b12 - w[1157] * b5 + w[1158] * b19));
  STORE(passed + 544, b21 = b21 + (w[1159] * b11 - w[1160] * b4 + w[1161] * b18));
  STORE(passed + 536, b17 = b21 + (w[1162] * b10 - w[1163] * b3 + w[1164] * b17));
  STORE(passed + 528, b16 = b17 + (w[1165] * b9 - w[1166] * b2 + w[1167] * b16));
  STORE(passed + 520, b15 = b16 + (w[1168] * b8 - w[1169] * b1 + w[1170] * b15));
  STORE(passed + 512, b14 = b15 + (w[1171] * b7 - w[1172] * b0 + w[1173] * b14));
  STORE(passed + 364, b14 + (w[1174] * PASSED(0) - w[1175] * PASSED(4) + w[1176] * PASSED(8)));
  STORE(passed + 592, b20 = w[1177] * b13 + w[1178] * b6 - w[1179] * b20);
  STORE(passed + 568, b19 = b20 + (w[1180] * b12 + w[1181] * b5 - w[1182] * b19));
  STORE(passed + 468, b19 + (w[1183] * b11 + w[1184] * b4 - w[1185] * b18));
}

static void MADE(tendon_robot_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3;
  b0 = PASSED(468) + (w[1186] * PASSED(456) + w[1187] * PASSED(460) - w[1188] * PASSED(464));
  b1 = b0 + (w[1189] * PASSED(472) + w[1190] * PASSED(476) - w[1191] * PASSED(480));
  b2 = b1 + (w[1192] * PASSED(484) + w[1193] * PASSED(488) - w[1194] * PASSED(492));
  b3 = b2 + (w[1195] * PASSED(496) + w[1196] * PASSED(500) - w[1197] * PASSED(504));
  STORE(passed + 368, b3 + (w[1198] * PASSED(0) + w[1199] * PASSED(4) - w[1200] * PASSED(8)));
  MADE(tendon_robot_kernels_pulled_of_column)(w + 489, w + 561, w + 597, turns + 0, passed + 0, passed + 360, passed + 96);
  STORE(passed + 372, w[474] * PASSED(8) - w[483] * PASSED(4) + PASSED(508));
  STORE(passed + 376, w[483] * PASSED(0) - w[457] * PASSED(8) + PASSED(512));
  STORE(passed + 380, w[457] * PASSED(4) - w[474] * PASSED(0) + b3);
  MADE(tendon_robot_kernels_pulled_of_column)(w + 490, w + 562, w + 598, turns + 4, passed + 12, passed + 372, passed + 120);
  STORE(passed + 384, w[472] * PASSED(504) - w[482] * PASSED(500) + PASSED(516));
  STORE(passed + 388, w[482] * PASSED(496) - w[454] * PASSED(504) + PASSED(520));
  STORE(passed + 392, w[454] * PASSED(500) - w[472] * PASSED(496) + b2);
  MADE(tendon_robot_kernels_pulled_of_column)(w + 491, w + 563, w + 599, turns + 8, passed + 24, passed + 384, passed + 144);
  STORE(passed + 396, w[470] * PASSED(492) - w[481] * PASSED(488) + PASSED(524));
  STORE(passed + 400, w[481] * PASSED(484) - w[451] * PASSED(492) + PASSED(528));
  STORE(passed + 404, w[451] * PASSED(488) - w[470] * PASSED(484) + b1);
  MADE(tendon_robot_kernels_pulled_of_column)(w + 492, w + 564, w + 600, turns + 12, passed + 36, passed + 396, passed + 168);
  STORE(passed + 408, w[468] * PASSED(480) - w[480] * PASSED(476) + PASSED(532));
  STORE(passed + 412, w[480] * PASSED(472) - w[448] * PASSED(480) + PASSED(536));
  STORE(passed + 416, w[448] * PASSED(476) - w[468] * PASSED(472) + b0);
  MADE(tendon_robot_kernels_pulled_of_column)(w + 645, w + 717, w + 753, turns + 16, passed + 48, passed + 408, passed + 192);
  STORE(passed + 420, w[466] * PASSED(464) - w[479] * PASSED(460) + PASSED(540));
  STORE(passed + 424, w[479] * PASSED(456) - w[445] * PASSED(464) + PASSED(544));
  STORE(passed + 428, w[445] * PASSED(460) - w[466] * PASSED(456) + PASSED(468));
  MADE(tendon_robot_kernels_pulled_of_column)(w + 646, w + 718, w + 754, turns + 20, passed + 60, passed + 420, passed + 216);
  STORE(passed + 432, w[464] * PASSED(548) - w[478] * PASSED(552) + PASSED(556));
  STORE(passed + 436, w[478] * PASSED(560) - w[442] * PASSED(548) + PASSED(564));
  STORE(passed + 440, w[442] * PASSED(552) - w[464] * PASSED(560) + PASSED(568));
  MADE(tendon_robot_kernels_pulled_of_column)(w + 647, w + 719, w + 755, turns + 24, passed + 72, passed + 432, passed + 240);
  STORE(passed + 444, w[462] * PASSED(572) - w[477] * PASSED(576) + PASSED(580));
  STORE(passed + 448, w[477] * PASSED(584) - w[439] * PASSED(572) + PASSED(588));
  STORE(passed + 452, w[439] * PASSED(576) - w[462] * PASSED(584) + PASSED(592));
  MADE(tendon_robot_kernels_pulled_of_column)(w + 648, w + 720, w + 756, turns + 28, passed + 84, passed + 444, passed + 264);
  MADE(tendon_robot_kernels_fold_of_column)(tendon_robot_kernels_table_0, passed + 96, passed + 288);
  MADE(tendon_robot_kernels_fold_of_column)(tendon_robot_kernels_table_0, passed + 100, passed + 312);
  MADE(tendon_robot_kernels_fold_of_column)(tendon_robot_kernels_table_1, passed + 104, passed + 336);
  STORE(columns + 0, EACH(C[2]) * PASSED(288));
  STORE(columns + 20, EACH(C[2]) * PASSED(292));
  STORE(columns + 40, EACH(C[2]) * PASSED(296));
  STORE(columns + 60, EACH(C[2]) * PASSED(300));
  STORE(columns + 80, EACH(C[2]) * PASSED(304));
  STORE(columns + 100, EACH(C[2]) * PASSED(308));
  STORE(columns + 120, EACH(C[2]) * PASSED(312));
  STORE(columns + 140, EACH(C[2]) * PASSED(316));
  STORE(columns + 160, EACH(C[2]) * PASSED(320));
  STORE(columns + 180, EACH(C[2]) * PASSED(324));
  STORE(columns + 200, EACH(C[2]) * PASSED(328));
  STORE(columns + 220, EACH(C[2]) * PASSED(332));
  STORE(columns + 240, EACH(C[2]) * PASSED(336));
  STORE(columns + 260, EACH(C[2]) * PASSED(340));
  STORE(columns + 280, EACH(C[2]) * PASSED(344));
  STORE(columns + 300, EACH(C[2]) * PASSED(348));
  STORE(columns + 320, EACH(C[2]) * PASSED(352));
  STORE(columns + 340, EACH(C[2]) * PASSED(356));
}

static void MADE(tendon_robot_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 192, columns += 4) {
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(tendon_robot_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_0)(casadi_real *w) {
  FOR_FOURS(i, 18) {
    STORE(w + 66 + i, LOAD(w + 1 + i) + LOAD(w + 19 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_2)(casadi_real *w) {
  FOR_FOURS(i, 36) {
    STORE(w + 208 + i, LOAD(tendon_robot_kernels_table_8 + i) * LOAD(w + 244 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_3)(casadi_real *w) {
  FOR_FOURS(i, 60) {
    STORE(w + 388 + i, LOAD(w + 84 + i) + LOAD(w + 144 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_4)(casadi_real *w) {
  FOR_FOURS(i, 16) {
    STORE(w + 66 + i, LOAD(w + 280 + i) + LOAD(w + 296 + i));
    STORE(w + 144 + i, LOAD(w + 448 + i) - LOAD(w + 288 + i));
    STORE(w + 160 + i, LOAD(w + 316 + i) + LOAD(w + 332 + i));
    STORE(w + 176 + i, LOAD(w + 464 + i) - LOAD(w + 324 + i));
    STORE(w + 244 + i, LOAD(w + 352 + i) + LOAD(w + 368 + i));
    STORE(w + 260 + i, LOAD(w + 480 + i) - LOAD(w + 360 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_8)(casadi_real *w) {
  FOR_FOURS(i, 24) {
    STORE(w + 502 + i, SPREAD(w[204]) * LOAD(w + 82 + i));
    STORE(w + 526 + i, SPREAD(w[205]) * LOAD(w + 106 + i));
    STORE(w + 550 + i, SPREAD(w[206]) * LOAD(w + 598 + i));
    STORE(w + 574 + i, SPREAD(w[207]) * LOAD(w + 478 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_9)(casadi_real *w) {
  FOR_FOURS(i, 12) {
    STORE(w + 94 + i, LOAD(w + 514 + i) + LOAD(w + 538 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_10)(casadi_real *w) {
  FOR_FOURS(i, 24) {
    STORE(w + 110 + i, LOAD(w + 448 + i) + LOAD(w + 550 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_11)(casadi_real *w) {
  FOR_FOURS(i, 24) {
    STORE(w + 448 + i, LOAD(w + 472 + i) + LOAD(w + 574 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_12)(casadi_real *w) {
  FOR_FOURS(i, 19) {
    FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
    b0 = EACH(2.0) * LOAD(w + 671 + i);
    b1 = b0 * LOAD(w + 671 + i);
    b2 = EACH(2.0) * LOAD(w + 690 + i) * LOAD(w + 690 + i);
    b3 = EACH(2.0) * LOAD(w + 709 + i);
    b4 = b3 * LOAD(w + 671 + i);
    b5 = EACH(2.0) * LOAD(w + 926 + i);
    b6 = b5 * LOAD(w + 690 + i);
    b7 = b3 * LOAD(w + 690 + i);
    b8 = b5 * LOAD(w + 671 + i);
    b3 = EACH(1.0) - b3 * LOAD(w + 709 + i);
    b0 = b0 * LOAD(w + 690 + i);
    b5 = b5 * LOAD(w + 709 + i);
    STORE(w + 500 + i, EACH(1.0) - b1 - b2);
    STORE(w + 519 + i, b4 + b6);
    STORE(w + 538 + i, b7 - b8);
    STORE(w + 557 + i, b4 - b6);
    STORE(w + 576 + i, b3 - b2);
    STORE(w + 595 + i, b0 + b5);
    STORE(w + 614 + i, b7 + b8);
    STORE(w + 633 + i, b0 - b5);
    STORE(w + 652 + i, b3 - b1);
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_13)(casadi_real *w) {
  FOR_FOURS(i, 20) {
    FOUR b0, b1, b2;
    b0 = EACH(0.4) * LOAD(w + 965 + i);
    b1 = EACH(0.4) * LOAD(w + 985 + i);
    b2 = EACH(0.4) * LOAD(w + 1005 + i);
    STORE(w + 82 + i, b0);
    STORE(w + 472 + i, b1);
    STORE(w + 671 + i, b2);
    STORE(w + 691 + i, b1 * LOAD(w + 428 + i) - b2 * LOAD(w + 408 + i));
    STORE(w + 711 + i, b2 * LOAD(w + 388 + i) - b0 * LOAD(w + 428 + i));
    STORE(w + 945 + i, b0 * LOAD(w + 408 + i) - b1 * LOAD(w + 388 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_15)(casadi_real *w) {
  FOR_FOURS(i, 16) {
    STORE(w + 66 + i, LOAD(w + 260 + i) + LOAD(w + 276 + i));
    STORE(w + 82 + i, LOAD(w + 260 + i) - LOAD(w + 276 + i));
    STORE(w + 144 + i, LOAD(w + 292 + i) + LOAD(w + 308 + i));
    STORE(w + 160 + i, LOAD(w + 292 + i) - LOAD(w + 308 + i));
    STORE(w + 176 + i, LOAD(w + 324 + i) + LOAD(w + 340 + i));
    STORE(w + 244 + i, LOAD(w + 324 + i) - LOAD(w + 340 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_16)(casadi_real *w) {
  FOR_FOURS(i, 36) {
    STORE(w + 144 + i, LOAD(w + 280 + i) + EACH(C[2]) * LOAD(w + 244 + i) + LOAD(w + 316 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_17)(casadi_real *w) {
  FOR_FOURS(i, 18) {
    STORE(w + 66 + i, LOAD(w + 84 + i));
  }
}

static void MADE(tendon_robot_k_richer_balance_loop_19)(casadi_real *w) {
  FOR_FOURS(i, 18) {
    STORE(w + 66 + i, EACH((-1.0)) * LOAD(w + 84 + i));
  }
}

static void MADE(tendon_robot_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22;
  MADE(tendon_robot_kernels_turned_of_column)(w + 326, turns + 0, passed + 0);
  MADE(tendon_robot_kernels_turned_of_column)(w + 327, turns + 4, passed + 12);
  b0 = PASSED(4) + PASSED(16);
  MADE(tendon_robot_kernels_turned_of_column)(w + 328, turns + 8, passed + 24);
  b1 = b0 + PASSED(28);
  MADE(tendon_robot_kernels_turned_of_column)(w + 329, turns + 12, passed + 36);
  b2 = b1 + PASSED(40);
  b3 = w[705] * b2;
  MADE(tendon_robot_kernels_turned_of_column)(w + 398, turns + 16, passed + 48);
  b4 = b2 + PASSED(52);
  MADE(tendon_robot_kernels_turned_of_column)(w + 399, turns + 20, passed + 60);
  b5 = b4 + PASSED(64);
  MADE(tendon_robot_kernels_turned_of_column)(w + 400, turns + 24, passed + 72);
  b6 = b5 + PASSED(76);
  MADE(tendon_robot_kernels_turned_of_column)(w + 401, turns + 28, passed + 84);
  b7 = b6 + PASSED(88);
  b3 = w[648] * PASSED(4) + w[667] * b0 + w[686] * b1 + b3 + b3 + w[724] * b4 + w[743] * b5 + w[762] * b6;
  b8 = PASSED(8) + PASSED(20);
  b9 = b8 + PASSED(32);
  b10 = b9 + PASSED(44);
  b11 = w[785] * b10;
  b12 = b10 + PASSED(56);
  b13 = b12 + PASSED(68);
  b14 = w[787] * b13;
  b15 = b13 + PASSED(80);
  b16 = w[788] * b15;
  b17 = b15 + PASSED(92);
  b16 = b3 + w[781] * b7 - w[782] * PASSED(8) - w[783] * b8 - w[784] * b9 - b11 - b11 - w[786] * b12 - b14 - b16;
  b14 = PASSED(0) + PASSED(12);
  b11 = b14 + PASSED(24);
  b3 = b11 + PASSED(36);
  b18 = w[705] * b3;
  b19 = b3 + PASSED(48);
  b20 = b19 + PASSED(60);
  b21 = b20 + PASSED(72);
  b22 = b21 + PASSED(84);
  b18 = w[648] * PASSED(0) + w[667] * b14 + w[686] * b11 + b18 + b18 + w[724] * b19 + w[743] * b20 + w[762] * b21;
  b10 = w[793] * b10;
  b13 = w[795] * b13;
  b15 = w[796] * b15;
  b15 = w[790] * PASSED(8) - (b18 + w[781] * b22) + w[791] * b8 + w[792] * b9 + b10 + b10 + w[794] * b12 + b13 + b15;
  b3 = w[785] * b3;
  b21 = w[782] * PASSED(0) + w[783] * b14 + w[784] * b11 + b3 + b3 + w[786] * b19 + w[787] * b20 + w[788] * b21;
  b2 = w[793] * b2;
  b5 = w[795] * b5;
  b6 = w[796] * b6;
  b6 = b21 + w[789] * b22 - w[790] * PASSED(4) - w[791] * b0 - w[792] * b1 - b2 - b2 - w[794] * b4 - b5 - b6;
  STORE(columns + 0, b16 - w[789] * b17);
  STORE(columns + 20, b15 + w[797] * b17);
  STORE(columns + 40, b6 - w[797] * b7);
  STORE(columns + 60, EACH((-1.0)) * ((b22 * w[227] + b7 * w[224] + b17 * w[225]) / EACH(2.0)));
  STORE(columns + 80, (b22 * w[226] + b7 * w[225] - b17 * w[224]) / EACH(2.0));
  STORE(columns + 100, (b7 * w[226] - b22 * w[225] + b17 * w[227]) / EACH(2.0));
  STORE(columns + 120, (b22 * w[224] - b7 * w[227] + b17 * w[226]) / EACH(2.0));
}

static void MADE(tendon_robot_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 192, columns += 4) {
    EVERY_LANE(MADE(tendon_robot_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
